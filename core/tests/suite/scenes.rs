//! Scenes that several tests use, and the same scenes for the reference.

use midair::{Array, Complex32, Complex64, Medium, Problem, Request, Rng, Scene};

use crate::oracle;

/// Returns a scene with the default medium.
pub(crate) fn scene(array: Array, points: Vec<[f64; 3]>, pressures: Option<Vec<f64>>) -> Scene {
    Scene::new(array, Medium::default(), points, Request { pressures, ..Request::default() }).expect("a valid scene")
}

/// Returns the array of a preset with one board.
pub(crate) fn preset(name: &str) -> Array {
    Array::preset(name, [1, 1]).expect("a known preset")
}

/// Returns `count` points as in figures 3 and 4 of the paper: uniformly distributed over the array's square, at z = 150 mm.
pub(crate) fn random_points(count: usize, half: f64, seed: u64) -> Vec<[f64; 3]> {
    let mut rng = Rng::new(seed);
    let mut coordinate = || (2.0 * rng.uniform() - 1.0) * half;
    (0..count).map(|_| [coordinate(), coordinate(), 0.15]).collect()
}

/// Returns the 38 points of fig. 2.
pub(crate) fn smiley() -> Vec<[f64; 3]> {
    use std::f64::consts::{PI, TAU};
    let at = |r: f64, angle: f64| [r * angle.cos(), r * angle.sin(), 0.15];
    let circle = (0..30).map(|i| at(0.045, TAU * f64::from(i) / 30.0));
    let eyes = [[-0.0135, 0.0135, 0.15], [0.0135, 0.0135, 0.15]];
    let mouth = (1..=6).map(|i| at(0.027, -PI * f64::from(i) / 7.0));
    circle.chain(eyes).chain(mouth).collect()
}

/// Returns a scene's array and medium for the reference.
pub(crate) fn model(scene: &Scene) -> oracle::Model {
    let (array, medium) = (scene.array(), scene.medium());
    oracle::Model {
        positions: array.positions().to_vec(),
        normals: array.normals().to_vec(),
        response: (0..array.len())
            .map(|i| {
                let on = array.mask().is_none_or(|mask| mask[i]);
                if on { array.response().map_or(Complex64::ONE, |response| response[i]) } else { Complex64::ZERO }
            })
            .collect(),
        source_pressure: array.transducer().source_pressure,
        directivity: match array.transducer().directivity.name() {
            ("point", None) => oracle::Directivity::Point,
            ("piston", Some(radius)) => oracle::Directivity::Piston(radius),
            ("sinc", Some(width)) => oracle::Directivity::Sinc(width),
            ("cos", Some(exponent)) => oracle::Directivity::Cos(exponent),
            ("t4010a1", None) => oracle::Directivity::T4010a1,
            other => panic!("the oracle lacks {other:?}"),
        },
        frequency: medium.frequency,
        sound_speed: medium.sound_speed,
        absorption: medium.absorption,
    }
}

/// Returns the reference's propagation matrix G of a scene, transducer by transducer.
pub(crate) fn propagation(scene: &Scene) -> Vec<Vec<Complex64>> {
    oracle::propagation(&model(scene), scene.points())
}

/// Returns the problem of a scene.
pub(crate) fn problem(scene: &Scene) -> Problem {
    Problem::new(scene).expect("a solvable scene")
}

/// Converts a drive to double precision.
pub(crate) fn widen(drive: &[Complex32]) -> Vec<Complex64> {
    drive.iter().map(|q| Complex64::new(f64::from(q.re), f64::from(q.im))).collect()
}
