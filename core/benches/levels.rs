//! The level of `uniform` or `best` in groups of scenes: one line a scene, for `bench/ablation.py`.
//!
//! `cargo bench -p midair --bench levels -- uniform spaced dense` prints `group|scene|level|unevenness|error`. The level is
//! that of the weakest point, relative to its target; the unevenness is the largest deviation from the mean level, or the
//! largest leak of a quiet point if this is more; the error is that of least squares at the targets.
#![forbid(unsafe_code)]

use std::f64::consts::{PI, TAU};

use midair::{Aim, Array, Control, Options, Problem, Quantization, Request, Rng, Scene, Workspace, solve, solvers};

type Place = [f64; 3];

/// The scenes of a group: an array, the points, and their targets.
type Case = (Array, Vec<Place>, Option<Vec<f64>>);

fn board(name: &str, phases: Option<u32>) -> Array {
    let array = Array::preset(name, if name == "autd3" { [2, 2] } else { [1, 1] }).expect("boards");
    array.with_quantization(phases.map(|phases| Quantization::new(Some(phases), None).expect("phases")))
}

/// Returns points at least 8.6 mm from each other, above the array's middle.
fn drawn(rng: &mut Rng, count: usize) -> Vec<Place> {
    let mut points: Vec<Place> = Vec::new();
    while points.len() < count {
        let at = [0.12, 0.12, 0.04].map(|side| side * (rng.uniform() - 0.5));
        let apart =
            |other: &Place| at.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>() > 0.0086_f64.powi(2);
        if points.iter().all(apart) {
            points.push(at);
        }
    }
    points
}

fn ring(count: usize, radius: f64) -> Vec<Place> {
    let angles = (0..count).map(|k| TAU * k as f64 / count as f64);
    angles.map(|angle| [radius * angle.cos(), radius * angle.sin(), 0.0]).collect()
}

fn lattice(sides: [usize; 3], pitch: f64) -> Vec<Place> {
    let middle = sides.map(|side| (side as f64 - 1.0) / 2.0);
    let places =
        (0..sides.iter().product()).map(|k: usize| [k % sides[0], k / sides[0] % sides[1], k / sides[0] / sides[1]]);
    places.map(|place| [0, 1, 2].map(|axis| pitch * (place[axis] as f64 - middle[axis]))).collect()
}

fn disc(radius: f64, pitch: f64) -> Vec<Place> {
    let side = 2 * (radius / pitch) as usize + 1;
    let mut points = lattice([side, side, 1], pitch);
    points.retain(|point| point[0].hypot(point[1]) <= radius + 1e-9);
    points
}

fn line(count: usize, step: Place) -> Vec<Place> {
    let middle = (count as f64 - 1.0) / 2.0;
    (0..count).map(|k| step.map(|part| part * (k as f64 - middle))).collect()
}

/// Returns points on a sphere, by the golden angle.
fn shell(count: usize, radius: f64) -> Vec<Place> {
    let place = |k: usize| {
        let height = 1.0 - (2 * k + 1) as f64 / count as f64;
        let angle = PI * (3.0 - 5.0_f64.sqrt()) * k as f64;
        let side = (1.0 - height * height).sqrt();
        [side * angle.cos(), side * angle.sin(), height].map(|part| radius * part)
    };
    (0..count).map(place).collect()
}

fn cloud(rng: &mut Rng, count: usize, side: f64) -> Vec<Place> {
    (0..count).map(|_| [0; 3].map(|_| side * (rng.uniform() - 0.5))).collect()
}

fn cases(group: &str) -> Vec<Case> {
    let mut rng = Rng::new(7);
    let autd3 = || board("autd3", None);
    let paper = || board("paper20", None);
    let even = |array: Array, points: Vec<Place>| (array, points, None);
    let beside = |lit: Vec<Place>, quiet: Vec<Place>| {
        let targets = lit.iter().map(|_| 1.0).chain(quiet.iter().map(|_| 0.0)).collect();
        (autd3(), lit.into_iter().chain(quiet).collect(), Some(targets))
    };
    match group {
        "few" => [2, 3, 2, 3, 2, 3].map(|count| even(paper(), drawn(&mut rng, count))).into(),
        "spaced" => [4, 8, 16, 32, 64]
            .iter()
            .flat_map(|&m| [autd3(), paper()].map(|array| even(array, drawn(&mut rng, m))))
            .collect(),
        "regular" => vec![
            even(autd3(), lattice([5, 5, 1], 0.02)),
            even(autd3(), lattice([3, 3, 3], 0.025)),
            even(autd3(), line(9, [0.015, 0.0, 0.0])),
            even(paper(), ring(8, 0.04)),
            even(paper(), ring(16, 0.05)),
            even(paper(), lattice([4, 4, 1], 0.02)),
        ],
        "unequal" => {
            let mut unlike = |array, count| {
                let points = drawn(&mut rng, count);
                (array, points, Some((0..count).map(|_| 10.0_f64.powf(rng.uniform())).collect()))
            };
            vec![
                unlike(autd3(), 16),
                unlike(autd3(), 32),
                unlike(autd3(), 64),
                unlike(paper(), 16),
                unlike(paper(), 48),
            ]
        }
        "many" | "wanted" => vec![
            even(paper(), drawn(&mut rng, 96)),
            even(paper(), drawn(&mut rng, 128)),
            even(board("sonicsurface", None), drawn(&mut rng, 80)),
            even(board("dragonfly", None), drawn(&mut rng, 40)),
        ],
        "dense" => vec![
            even(autd3(), disc(0.015, 0.002)),
            even(autd3(), ring(78, 0.02)),
            even(autd3(), line(33, [0.002, 0.0006, 0.0])),
            even(autd3(), line(30, [0.0, 0.0, 0.002])),
            even(autd3(), shell(70, 0.01)),
            even(autd3(), shell(40, 0.008)),
            even(autd3(), shell(120, 0.015)),
            even(autd3(), cloud(&mut rng, 60, 0.012)),
            even(autd3(), cloud(&mut rng, 60, 0.02)),
            even(autd3(), lattice([4, 4, 4], 0.006)),
            even(paper(), disc(0.018, 0.003)),
            even(paper(), cloud(&mut rng, 40, 0.015)),
            even(paper(), shell(60, 0.014)),
            even(paper(), lattice([7, 7, 1], 0.004)),
        ],
        "quiet" => vec![
            beside(ring(12, 0.02), disc(0.01, 0.002)),
            beside(ring(16, 0.025), disc(0.014, 0.002)),
            beside(vec![[-0.03, 0.0, 0.0], [0.03, 0.0, 0.0]], disc(0.012, 0.002)),
            beside(line(8, [0.012, 0.0, 0.0]), line(8, [0.0, 0.012, 0.012])),
            {
                let points = disc(0.03, 0.008);
                let lit = |point: &Place| ((point[0] + point[1]) / 0.008).round() as i64 % 2 == 0;
                let targets = points.iter().map(|point| f64::from(lit(point))).collect();
                (autd3(), points, Some(targets))
            },
        ],
        "2 phases" | "4 phases" | "16 phases" => {
            let phases = group.split(' ').next().and_then(|count| count.parse().ok());
            let sizes = [("autd3", 8), ("sonicsurface", 16), ("paper20", 16), ("paper20", 4), ("paper20", 32)];
            sizes.map(|(name, count)| even(board(name, phases), drawn(&mut rng, count))).into()
        }
        "pictures" => {
            let mut points = lattice([19, 19, 1], 0.06 / 18.0);
            let picture = |value: fn(f64, f64) -> f64, points: &[Place]| {
                let targets = points.iter().map(|point| 300.0 * value(point[0] / 0.03, point[1] / 0.03));
                (autd3(), points.to_vec(), Some(targets.collect()))
            };
            points.rotate_left(1);
            vec![
                picture(|x, y| if (3.0 * x).sin() * (2.0 * y + 0.5).cos() > 0.0 { 1.0 } else { 0.15 }, &points),
                picture(|x, y| 0.55 + 0.45 * (2.0 * x + y).sin() * (1.5 * y - x).cos(), &points),
                picture(|x, y| if x.abs() < 0.2 && y.abs() < 0.8 { 1.0 } else { 0.05 }, &points),
            ]
        }
        other => panic!("there is no group {other}"),
    }
}

fn main() {
    let names: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with('-')).collect();
    // `cargo test` runs benches, too, without names.
    let (method, groups) = names.split_first().map_or(("uniform", &[][..]), |(method, groups)| (method, groups));
    let solver = solvers::find(method).and_then(|entry| entry.configure(&Options::new())).expect("a method").solver;
    for group in groups {
        for (scene, (array, mut points, pressures)) in cases(group).into_iter().enumerate() {
            let middle = array.positions().iter().fold([0.0; 2], |sum, place| [sum[0] + place[0], sum[1] + place[1]]);
            for point in &mut points {
                let count = array.len() as f64;
                *point = [point[0] + middle[0] / count, point[1] + middle[1] / count, point[2] + 0.17];
            }
            let aim = if ["wanted", "pictures"].contains(&group.as_str()) { Aim::Target } else { Aim::Max };
            let request = Request { pressures, ..Request::default() };
            let problem = Problem::new(&Scene::new(array, None, points, request).expect("a scene")).expect("a problem");
            let (problem, mut work) = (problem.with_aim(aim), Workspace::new());
            let solution =
                solve(&problem, &*solver, aim == Aim::Max, &mut work, &mut Control::none()).expect("an answer");
            let pairs = || solution.pressures.iter().map(|p| f64::from(p.norm())).zip(solution.targets());
            let levels: Vec<f64> = pairs().filter(|(_, target)| **target > 0.0).map(|(p, target)| p / target).collect();
            let level = levels.iter().sum::<f64>() / levels.len() as f64;
            let lowest = levels.iter().copied().fold(f64::INFINITY, f64::min);
            let loudest = level * solution.targets().iter().copied().fold(0.0, f64::max);
            let leaks = pairs().filter(|(_, target)| **target == 0.0).map(|(p, _)| p / loudest);
            let uneven = levels.iter().map(|x| (x / level - 1.0).abs()).chain(leaks).fold(0.0, f64::max);
            let missed: f64 = pairs().map(|(p, target)| (p - target).powi(2)).sum();
            let error = (missed / pairs().map(|(_, target)| target * target).sum::<f64>()).sqrt();
            println!("{group}|{scene}|{lowest:.6}|{uneven:.2e}|{error:.6}");
        }
    }
}
