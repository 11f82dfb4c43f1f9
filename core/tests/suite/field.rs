//! The field of a drive: on planes, at points, on transducers, over threads, and stopped.

use std::ops::ControlFlow;

use midair::{
    Array, Complex32, Complex64, Control, Directivity, Error, InstructionSet, Medium, Model, Plane, Progress, Request,
    Rng, Scene, Transducer,
};

use crate::oracle;
use crate::scenes::{model, preset, random_points, scene, widen};

/// A drive of random phases and amplitudes, every seventh transducer off.
fn random_drive(count: usize, seed: u64) -> Vec<Complex32> {
    let mut rng = Rng::new(seed);
    let mut random = |high: f64| (high * rng.uniform()) as f32;
    (0..count)
        .map(|i| if i % 7 == 3 { Complex32::ZERO } else { Complex32::from_polar(random(1.0), random(6.0)) })
        .collect()
}

fn field(scene: &Scene, drive: &[Complex32], points: &[[f64; 3]]) -> Vec<Complex32> {
    midair::field(&Model::of(scene, InstructionSet::best()), drive, points, &mut Control::none()).expect("a field")
}

/// Real air and transducers.
fn real() -> Scene {
    let transducer = Transducer { directivity: Directivity::T4010a1, ..Transducer::default() };
    let array = preset("autd3").with_transducer(transducer).expect("a transducer");
    let response = (0..array.len()).map(|i| Complex64::from_polar(1.0 - 1e-3 * i as f64, 0.1 * i as f64)).collect();
    let array = array.with_response(Some(response)).expect("responses");
    let medium = Medium { absorption: 0.15, sound_speed: 346.0, ..Medium::default() };
    Scene::new(array, medium, vec![[0.0, 0.0, 0.15]], Request::default()).expect("a scene")
}

fn assert_field(scene: &Scene, points: &[[f64; 3]]) {
    let drive = random_drive(scene.array().len(), 1);
    let propagation = oracle::propagation(&model(scene), points);
    let exact = oracle::field(&propagation, &widen(&drive));
    for ((found, exact), reach) in
        widen(&field(scene, &drive, points)).iter().zip(exact).zip(oracle::reach(&propagation))
    {
        // Within 0.3 m an entry is good to 3e-5 of its modulus, and so is the sum to that part of all moduli.
        assert!((found - exact).norm() < 3e-5 * reach, "{found} for {exact} where {reach} is the most");
    }
}

#[test]
fn planes_and_points_have_the_oracles_field() {
    for scene in [real(), scene(preset("paper20"), vec![[0.0, 0.0, 0.15]], None)] {
        assert_field(&scene, &Plane::new(0.15, 0.1, 40, [0.01, -0.02]).expect("a plane").points());
        assert_field(&scene, &random_points(300, 0.1, 1));
    }
}

#[test]
fn a_plane_is_sampled_from_end_to_end_x_fastest() {
    let plane = Plane::new(0.2, 0.1, 5, [0.01, -0.02]).expect("a plane");
    for (axis, first) in [(0, -0.04), (1, -0.07)] {
        for (i, x) in plane.axis(axis).into_iter().enumerate() {
            assert!((x - (first + 0.025 * i as f64)).abs() < 1e-15);
        }
    }
    let points = plane.points();
    assert_eq!(points.len(), 25);
    for (k, point) in points.into_iter().enumerate() {
        assert_eq!(point, [plane.axis(0)[k % 5], plane.axis(1)[k / 5], 0.2]);
    }
}

#[test]
fn a_picture_without_a_plane_is_taken_around_the_points() {
    let plane = |points: &[[f64; 3]]| Plane::around(points);
    let wide = plane(&[[0.0, 0.1, 0.2], [0.08, 0.0, 0.3], [0.02, 0.05, 0.1]]);
    for (value, wanted) in [(wide.z, 0.2), (wide.size, 0.125), (wide.center[0], 0.04), (wide.center[1], 0.05)] {
        assert!((value - wanted).abs() < 1e-15, "{value} for {wanted}");
    }
    let narrow = plane(&[[0.0, 0.0, 0.15], [0.01, 0.0, 0.150_000_9]]);
    assert_eq!((narrow.z, narrow.size, narrow.pixels), (0.15, 0.04, 200));
}

#[test]
fn a_point_has_the_same_bits_in_any_company() {
    let scene = real();
    let drive = random_drive(scene.array().len(), 2);
    // Beyond one chunk of threads and one step of the control.
    let points = random_points(8_500, 0.1, 2);
    let all = field(&scene, &drive, &points);
    for part in [0..1, 0..255, 255..257, 200..713, 8_000..8_500] {
        assert_eq!(field(&scene, &drive, &points[part.clone()]), all[part]);
    }
}

#[test]
fn on_a_transducer_r_is_a_hundredth_of_the_wavelength() {
    let lone = scene(Array::grid(1, 1, 1e-2).expect("a grid"), vec![[0.0, 0.0, 0.1]], None);
    let wavelength = lone.medium().wavelength();
    // From 4.386 Pa m; a hundredth of a wavelength is a hundredth of a turn.
    let wanted = Complex64::from_polar(4.386 / (wavelength / 100.0), std::f64::consts::TAU / 100.0);
    for height in [0.0, 0.003 * wavelength, -0.009_99 * wavelength] {
        let [found] = widen(&field(&lone, &[Complex32::ONE], &[[0.0, 0.0, height]]))[..] else { panic!("one value") };
        assert!((found - wanted).norm() < 1e-6 * wanted.norm(), "{found} at {height} for {wanted}");
    }
    let real = real();
    let drive = random_drive(real.array().len(), 3);
    let found = field(&real, &drive, real.array().positions());
    assert!(found.iter().all(|p| p.is_finite() && *p != Complex32::ZERO));
}

#[test]
fn silence_is_silent() {
    let scene = real();
    let found = field(&scene, &vec![Complex32::ZERO; scene.array().len()], &random_points(20, 0.1, 1));
    assert_eq!(found, [Complex32::ZERO; 20]);
}

#[cfg(feature = "parallel")]
#[test]
fn the_number_of_threads_changes_no_bit() {
    let scene = real();
    let drive = random_drive(scene.array().len(), 4);
    let points = random_points(8_500, 0.1, 3);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            assert_eq!(rayon::current_num_threads(), threads);
            field(&scene, &drive, &points)
        })
    };
    let alone = on(1);
    assert_eq!(alone, on(2));
    assert_eq!(alone, on(3));
}

#[test]
fn a_stop_gives_nothing_and_each_step_is_announced_once() {
    let scene = real();
    let drive = random_drive(scene.array().len(), 5);
    let points = random_points(40_000, 0.1, 4);
    let watched = |last: usize| {
        let mut seen = Vec::new();
        let mut observer = |progress: Progress| {
            seen.push((progress.step, progress.steps));
            if progress.step == last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let found = midair::field(
            &Model::of(&scene, InstructionSet::best()),
            &drive,
            &points,
            &mut Control::watched(&mut observer),
        )
        .map(|field| field.len());
        (found, seen)
    };
    let (all, steps) = watched(usize::MAX);
    assert_eq!(all, Ok(40_000));
    assert!(steps.len() > 1 && steps.iter().enumerate().all(|(k, step)| *step == (k + 1, steps.len())), "{steps:?}");
    assert_eq!(watched(1), (Err(Error::Stopped), steps[..1].to_vec()));
}

#[test]
fn what_has_no_field_is_refused_by_name() {
    let scene = scene(Array::grid(2, 1, 1e-2).expect("a grid"), vec![[0.0, 0.0, 0.1]], None);
    let message = |drive: &[Complex32], points: &[[f64; 3]]| {
        midair::field(&Model::of(&scene, InstructionSet::best()), drive, points, &mut Control::none())
            .expect_err("refused")
            .to_string()
    };
    let (on, spot) = ([Complex32::ONE; 2], [[0.0, 0.0, 0.1]]);
    let with = |re: f32| [Complex32::ONE, Complex32::new(re, 0.0)];
    for (text, start) in [
        (message(&on[..1], &spot), "drive is 1 values"),
        (message(&with(f32::NAN), &spot), "drive[1] is"),
        (message(&with(f32::INFINITY), &spot), "drive[1] is"),
        (message(&with(1.000_01), &spot), "drive[1] is"),
        (message(&on, &[]), "field points is empty"),
        (message(&on, &[spot[0], [0.0, f64::NAN, 0.0]]), "field points[1] is"),
    ] {
        assert!(text.starts_with(start) && !text.contains('\n'), "{text}");
    }
    assert_eq!(field(&scene, &with(1.000_000_1), &spot).len(), 1);
}
