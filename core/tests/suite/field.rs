//! Tests of fields: on planes, at points, on transducers, with several threads, and when stopped.

use std::ops::ControlFlow;

use midair::{
    Array, Axis, Complex32, Complex64, Control, Directivity, Error, FieldMatrix, InstructionSet, Medium, Model,
    Obstacle, Plane, Progress, Request, Rng, Scene, Signature, Surface, Transducer,
};

use crate::oracle;
use crate::scenes::{model, preset, random_points, scene, widen};

/// Returns random phases and amplitudes, with every seventh transducer off.
fn random_drive(count: usize, seed: u64) -> Vec<Complex32> {
    let mut rng = Rng::new(seed);
    let mut random = |high: f64| (high * rng.uniform()) as f32;
    (0..count)
        .map(|i| if i % 7 == 3 { Complex32::ZERO } else { Complex32::from_polar(random(1.0), random(6.0)) })
        .collect()
}

fn model_of(scene: &Scene) -> Model {
    Model::of(scene, InstructionSet::best())
}

fn field(scene: &Scene, drive: &[Complex32], points: &[[f64; 3]]) -> Vec<Complex32> {
    midair::field(&model_of(scene), drive, points, &mut Control::none()).expect("a field")
}

/// Returns a scene with absorption in air, and with the directivity and different responses of real transducers.
fn real() -> Scene {
    let transducer = Transducer { directivity: Directivity::T4010A1, ..Transducer::default() };
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
        // Within 0.3 m an entry of the propagation matrix G is accurate to 3e-5 of its modulus. The sum is accurate to that
        // part of the sum of moduli.
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
fn a_field_matrix_gives_the_field_of_every_drive() {
    let scene = real();
    let model = model_of(&scene);
    // Some of the places are positions of transducers.
    let mut places = Plane::new(0.0, 0.2, 21, [0.01, -0.02]).expect("a plane").points();
    places.extend_from_slice(&scene.array().positions()[..9]);
    places.extend(random_points(100, 0.1, 1));
    let matrix = FieldMatrix::new(&model, &places, &mut Control::none()).expect("room");
    for seed in [1, 2] {
        let drive = random_drive(scene.array().len(), seed);
        let product = matrix.field(&drive, &mut Control::none()).expect("a drive");
        let field = field(&scene, &drive, &places);
        let most = field.iter().map(|p| p.norm()).fold(0.0, f32::max);
        for (product, p) in product.iter().zip(&field) {
            assert!((product - p).norm() < 2e-6 * most, "{product} for {p} where {most} is the most");
        }
    }
    assert!(matrix.field(&[], &mut Control::none()).is_err());
    assert!(FieldMatrix::new(&model, &[], &mut Control::none()).is_err());
    let wall = Obstacle::Wall { point: [0.2, 0.0, 0.0], normal: [-1.0, 0.0, 0.0], kind: Surface::Rigid };
    let walled = model.with_obstacles(&[wall]).expect("a wall");
    assert!(FieldMatrix::new(&walled, &places, &mut Control::none()).is_err());
}

#[test]
fn a_plane_is_sampled_from_end_to_end_x_fastest() {
    let plane = Plane::new(0.2, 0.1, 5, [0.01, -0.02]).expect("a plane");
    for (axis, first) in [(0, -0.04), (1, -0.07)] {
        for (i, x) in plane.samples(axis).into_iter().enumerate() {
            assert!((x - (first + 0.025 * i as f64)).abs() < 1e-15);
        }
    }
    let points = plane.points();
    assert_eq!(points.len(), 25);
    for (k, point) in points.into_iter().enumerate() {
        assert_eq!(point, [plane.samples(0)[k % 5], plane.samples(1)[k / 5], 0.2]);
    }
}

#[test]
fn an_upright_plane_has_its_axes_across_and_up() {
    let plane = Plane::normal_to(Axis::Y, 0.3, 0.1, 5, [0.01, 0.15]).expect("a plane");
    assert_eq!(plane.along(Axis::Y), None);
    assert_eq!((plane.along(Axis::X), plane.along(Axis::Z)), (Some(plane.samples(0)), Some(plane.samples(1))));
    for (k, point) in plane.points().into_iter().enumerate() {
        assert_eq!(point, [plane.samples(0)[k % 5], 0.3, plane.samples(1)[k / 5]]);
    }
    let side = Plane::normal_to(Axis::X, 0.3, 0.1, 3, [0.01, 0.15]).expect("a plane");
    assert_eq!(side.points()[1], [0.3, side.samples(0)[1], side.samples(1)[0]]);
}

/// Returns the axis, the places, the size and the centre of the planes around points, for a wavelength of 8.5 mm.
fn around(points: &[[f64; 3]]) -> (Axis, Vec<f64>, f64, [f64; 2]) {
    let planes = Plane::around(points, 8.5e-3);
    for plane in &planes {
        assert_eq!(Plane { at: plane.at, ..planes[0] }, *plane);
    }
    (planes[0].axis, planes.iter().map(|plane| plane.at).collect(), planes[0].size, planes[0].center)
}

#[test]
fn planes_left_out_go_through_the_points_and_two_wavelengths_around_them() {
    let margin = 4.0 * 8.5e-3;
    for (points, axis, center) in [
        (vec![[0.01, 0.02, 0.15]], Axis::Z, [0.01, 0.02]),
        (vec![[0.0, 0.0, 0.15], [0.04, 0.02, 0.15]], Axis::Z, [0.02, 0.01]),
        // Points on the axis of a levitator, and on lines along x and y.
        (vec![[0.0, 0.0, -0.02], [0.0, 0.0, 0.02]], Axis::Y, [0.0, 0.0]),
        (vec![[-0.02, 0.0, 0.1], [0.02, 0.0, 0.1]], Axis::Z, [0.0, 0.0]),
        (vec![[0.0, -0.02, 0.1], [0.0, 0.02, 0.1]], Axis::Z, [0.0, 0.0]),
        // Three points in a plane normal to x, and two points whose heights are so similar that one plane shows both.
        (vec![[0.01, 0.0, 0.1], [0.01, 0.02, 0.14], [0.01, 0.01, 0.1]], Axis::X, [0.01, 0.12]),
        (vec![[0.0, 0.0, 0.1], [0.02, 0.01, 0.1005]], Axis::Z, [0.01, 0.005]),
    ] {
        let (found, at, size, middle) = around(&points);
        let spread = |k: usize| {
            let of = |pick: fn(f64, f64) -> f64| points.iter().map(|point| point[k]).reduce(pick).expect("a point");
            of(f64::max) - of(f64::min)
        };
        let [u, v] = [Axis::X, Axis::Y, Axis::Z]
            .into_iter()
            .filter(|&other| other != axis)
            .map(|other| spread(other as usize))
            .collect::<Vec<_>>()[..]
        else {
            panic!("two axes")
        };
        assert_eq!((found, at.len()), (axis, 1), "{points:?}");
        assert!((size - u.max(v) - margin).abs() < 1e-15, "{size} for {points:?}");
        assert!(middle.into_iter().zip(center).all(|(a, b)| (a - b).abs() < 1e-15), "{middle:?} for {points:?}");
        let plane = Plane::around(&points, 8.5e-3)[0];
        assert!(points.iter().all(|&point| plane.shows(point, 8.5e-3)), "{points:?}");
    }
}

#[test]
fn points_that_no_plane_goes_through_have_one_for_each_place_at_most_four() {
    // Points at two heights; most of them, three, at the lower one.
    let (axis, at, ..) =
        around(&[[0.0, 0.0, 0.2], [0.03, 0.01, 0.1], [-0.03, 0.02, 0.1], [-0.02, -0.02, 0.2], [0.0, 0.03, 0.1]]);
    assert_eq!((axis, at), (Axis::Z, vec![0.1, 0.2]));
    // Equally many different places along x, y and z: planes normal to z are preferred, as for flat arrays.
    let (axis, at, ..) = around(&[[0.0, 0.0, 0.1], [0.02, 0.03, 0.12], [0.05, 0.06, 0.15]]);
    assert_eq!((axis, at), (Axis::Z, vec![0.1, 0.12, 0.15]));
    let spiral: Vec<_> = (0..50).map(|i| f64::from(i) * 0.01).map(|x| [x, x + 1.0, x + 2.0]).collect();
    assert_eq!(around(&spiral).1.len(), 4);
}

#[test]
fn traps_have_two_upright_planes_each_and_a_plane_through_their_shells_shows_them() {
    let traps = [[-0.02, 0.0, 0.1], [0.02, 0.01, 0.12]];
    let scene = Scene::new(preset("paper20"), Medium::default(), traps.to_vec(), Request::default()).expect("a scene");
    let across = scene.picture_planes();
    let scene = scene.with_signature(Some(Signature::Trap)).expect("a signature");
    let planes = scene.picture_planes();
    let reported: Vec<_> = planes.iter().map(|plane| (plane.axis, plane.at, plane.center)).collect();
    let y = |at, center| (Axis::Y, at, center);
    let x = |at, center| (Axis::X, at, center);
    assert_eq!(reported, [y(0.0, [-0.02, 0.1]), y(0.01, [0.02, 0.12]), x(-0.02, [0.0, 0.1]), x(0.02, [0.01, 0.12])]);
    assert!(planes.iter().all(|plane| plane.size == planes[0].size && scene.is_shown(plane)));
    assert!(across.iter().all(|plane| plane.axis == Axis::Z));
    let beside = |z| scene.is_shown(&Plane::new(z, 0.1, 20, [0.0, 0.0]).expect("a plane"));
    assert!(beside(0.1022) && !beside(0.11));
}

#[test]
fn a_body_that_no_plane_through_the_points_cuts_has_an_upright_one() {
    let points = vec![[0.03, 0.01, 0.18], [-0.03, 0.0, 0.18]];
    let scene = Scene::new(preset("paper20"), Medium::default(), points, Request::default()).expect("a scene");
    let with = |z| {
        let ball = Obstacle::Sphere { center: [0.01, -0.02, z], radius: 0.02, kind: Surface::Rigid };
        scene.clone().with_obstacles(vec![ball]).expect("a ball").picture_planes()
    };
    let planes = with(0.1);
    assert_eq!(planes[..1], scene.picture_planes());
    let [_, body] = planes[..] else { panic!("{planes:?}") };
    assert_eq!((body.axis, body.at), (Axis::Y, -0.02));
    for place in [[0.03, -0.02, 0.18], [-0.03, -0.02, 0.18], [0.01, -0.02, 0.08]] {
        assert!(body.shows(place, scene.medium().wavelength()), "{place:?}");
    }
    // If the plane through the points already cuts the sphere, no second plane is made.
    assert_eq!(with(0.195).len(), 1);
}

#[test]
fn a_plane_shows_what_lies_in_its_square_and_a_tenth_of_the_wavelength_around_it() {
    let plane = Plane::new(0.15, 0.1, 201, [0.01, 0.0]).expect("a plane");
    for (point, shown) in [
        ([0.06, -0.05, 0.15], true),
        ([0.0602, 0.0, 0.15], true),
        ([0.061, 0.0, 0.15], false),
        ([0.0, 0.051, 0.15], false),
        ([0.0, 0.0, 0.1508], true),
        ([0.0, 0.0, 0.1491], false),
    ] {
        assert_eq!(plane.shows(point, 8.5e-3), shown, "{point:?}");
    }
}

#[test]
fn a_point_has_the_same_bits_in_any_company() {
    let scene = real();
    let drive = random_drive(scene.array().len(), 2);
    // There are more points than a thread computes together, and more than the control counts as one step.
    let points = random_points(8_500, 0.1, 2);
    let all = field(&scene, &drive, &points);
    for part in [0..1, 0..255, 255..257, 200..713, 8_000..8_500] {
        assert_eq!(field(&scene, &drive, &points[part.clone()]), all[part]);
    }
}

#[test]
fn on_a_transducer_r_is_a_hundredth_of_the_wavelength() {
    let single = scene(Array::grid(1, 1, 1e-2).expect("a grid"), vec![[0.0, 0.0, 0.1]], None);
    let wavelength = single.medium().wavelength();
    // At a hundredth of a wavelength from a source of 4.386 Pa m, the phase is a hundredth of a turn.
    let wanted = Complex64::from_polar(4.386 / (wavelength / 100.0), std::f64::consts::TAU / 100.0);
    for height in [0.0, 0.003 * wavelength, -0.009_99 * wavelength] {
        let [found] = widen(&field(&single, &[Complex32::ONE], &[[0.0, 0.0, height]]))[..] else { panic!("one value") };
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

#[test]
fn the_number_of_threads_changes_no_bit() {
    let scene = real();
    let drive = random_drive(scene.array().len(), 4);
    let points = random_points(8_500, 0.1, 3);
    let on = |threads: usize| {
        midair::field(&model_of(&scene), &drive, &points, &mut Control::none().with_threads(threads)).expect("a field")
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
    assert_eq!(watched(1), (Err(Error::stopped()), steps[..1].to_vec()));
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
