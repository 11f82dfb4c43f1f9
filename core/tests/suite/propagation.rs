//! Compares rows of the propagation matrix G, computed and stored, with plain f64 loops over points and transducers.

use midair::solvers::{Greedy, Order};
use midair::{
    Array, Complex64, Control, Directivity, Medium, Problem, Propagation, Request, Rng, Scene, Setup, Solve,
    Transducer, Workspace,
};

use crate::oracle;
use crate::scenes::{preset, problem, propagation, random_points, scene};

const PATTERNS: [Directivity; 7] = [
    Directivity::POINT,
    Directivity::piston(4.5e-3),
    // This piston has two zeros and a negative side lobe before 90 degrees.
    Directivity::piston(1e-2),
    Directivity::sinc(9e-3),
    Directivity::cos(3.376),
    Directivity::cos(0.0),
    Directivity::T4010A1,
];

/// Returns 36 tilted transducers around `middle` with responses of any phase, one of which is 0, and `count` points up to `far`
/// metres away.
fn crooked(directivity: Directivity, absorption: f64, middle: [f64; 3], far: f64, count: usize) -> Scene {
    let mut rng = Rng::new(count as u64);
    let mut random = |low: f64, high: f64| low + (high - low) * rng.uniform();
    let mut near = |size: f64| middle.map(|x| x + random(-size, size));
    let positions: Vec<_> = (0..36).map(|_| near(0.1)).collect();
    let normals = (0..36).map(|_| [random(-0.6, 0.6), random(-0.6, 0.6), 1.0]).collect();
    let mut response: Vec<_> = (0..36).map(|_| Complex64::from_polar(random(0.1, 3.0), random(-3.0, 3.0))).collect();
    response[7] = Complex64::ZERO;
    let points = (0..count).map(|_| {
        let [x, y, z] = [random(-1.0, 1.0), random(-1.0, 1.0), random(0.2, 1.0)];
        let scale = random(0.15, far) / (x * x + y * y + z * z).sqrt();
        [middle[0] + scale * x, middle[1] + scale * y, middle[2] + scale * z + 0.1]
    });
    let points: Vec<_> = points.collect();
    let transducer = Transducer { directivity, ..Transducer::default() };
    let array = Array::new(positions, Some(normals)).and_then(|array| array.with_transducer(transducer));
    let array = array.and_then(|array| array.with_response(Some(response))).expect("an array");
    let medium = Medium { absorption, sound_speed: 346.0, ..Medium::default() };
    Scene::new(array, medium, points, Request::default()).expect("a scene")
}

/// Every row in Pa, written into memory full of NaN.
fn rows(propagation: &Propagation) -> Vec<Vec<Complex64>> {
    let row = |i: usize| {
        let [mut re, mut im] = [(); 2].map(|()| vec![f32::NAN; propagation.lanes()]);
        propagation.row(i, &mut re, &mut im);
        assert!(
            re[propagation.points()..].iter().chain(&im[propagation.points()..]).all(|&x| x == 0.0),
            "sound in the padding"
        );
        let entry = |j: usize| Complex64::new(f64::from(re[j]), f64::from(im[j])) * propagation.reference();
        (0..propagation.points()).map(entry).collect()
    };
    (0..propagation.transducers()).map(row).collect()
}

/// Returns the distance and the error of each entry of the propagation matrix G, except for dead transducers. The error is
/// relative to the modulus on the axis at that distance, because the directivity is 0 at some angles. For a point source this
/// is the entry's own modulus.
fn errors(scene: &Scene, found: &[Vec<Complex64>]) -> Vec<(f64, f64)> {
    let array = scene.array();
    let mut errors = Vec::new();
    for (i, (found, exact)) in found.iter().zip(propagation(scene)).enumerate() {
        let response = array.response().map_or(1.0, |list| list[i].norm());
        for ((found, exact), point) in found.iter().zip(exact).zip(scene.points()) {
            let square = |axis: usize| (point[axis] - array.positions()[i][axis]).powi(2);
            let r = (square(0) + square(1) + square(2)).sqrt();
            let unit = array.transducer().source_pressure * response * (-scene.medium().absorption * r).exp() / r;
            if unit == 0.0 {
                assert_eq!(*found, Complex64::ZERO, "the dead transducer sounds");
            } else {
                errors.push((r, (found - exact).norm() / unit));
            }
        }
    }
    errors
}

/// Checks the accuracy that [`Propagation::row`] states. A metre is 118 wavelengths, where neighbouring f32 numbers differ by
/// 7.6e-6 turns or 4.8e-5 rad. Coordinates, differences, squares, sum and root each round by at most half of that; 2e-4 is
/// eight times this. The error grows with the distance.
fn assert_errors(scene: &Scene, found: &[Vec<Complex64>]) {
    for (r, error) in errors(scene, found) {
        assert!(error < if r <= 1.0 { 2e-4 } else { 4e-4 }, "{error:e} at {r} m from {:?}", scene.array().transducer());
    }
}

#[test]
fn rows_are_eq_5_for_every_directivity_absorption_response_and_normal() {
    for directivity in PATTERNS {
        for absorption in [0.0, 0.15] {
            let scene = crooked(directivity, absorption, [0.0; 3], 1.9, 300);
            assert_errors(&scene, &rows(&Propagation::of(&scene)));
        }
    }
}

#[test]
fn rows_of_the_papers_array_are_eq_5_and_better_than_promised_in_the_median() {
    let mut rng = Rng::new(1);
    let mut points = random_points(400, 1.2, 2);
    for point in &mut points {
        point[2] = 0.05 + 1.3 * rng.uniform();
    }
    let scene = scene(preset("paper36"), points, None);
    let found = rows(&Propagation::of(&scene));
    assert_errors(&scene, &found);
    let errors = errors(&scene, &found).into_iter().filter(|(r, _)| (0.9..1.1).contains(r));
    let mut errors: Vec<f64> = errors.map(|(_, error)| error).collect();
    errors.sort_by(f64::total_cmp);
    // There are about six roundings of random sign, each evenly distributed within half of 4.8e-5 rad. Their root mean square
    // is 3e-5, and the median is two thirds of it.
    assert!(errors.len() > 10_000 && errors[errors.len() / 2] < 3e-5, "median {:e}", errors[errors.len() / 2]);
}

#[test]
fn an_array_five_metres_off_loses_no_digit() {
    for directivity in PATTERNS {
        let scene = crooked(directivity, 0.15, [5.0, -5.0, 5.0], 0.9, 100);
        assert_errors(&scene, &rows(&Propagation::of(&scene)));
    }
}

#[test]
fn matrix_has_the_rows_in_pascals_point_by_point() {
    let scene = crooked(Directivity::T4010A1, 0.15, [0.0; 3], 0.9, 21);
    let matrix = Propagation::of(&scene).matrix(&mut Control::none()).expect("no point on a transducer");
    assert_eq!(matrix.len(), 36 * 21);
    let entry = |i: usize, j: usize| Complex64::new(matrix[j * 36 + i].re.into(), matrix[j * 36 + i].im.into());
    let found: Vec<Vec<_>> = (0..36).map(|i| (0..21).map(|j| entry(i, j)).collect()).collect();
    assert_errors(&scene, &found);
    let touched = vec![[0.0, 0.0, 0.1], scene.array().positions()[5]];
    let touched = Scene::new(scene.array().clone(), scene.medium(), touched, Request::default()).expect("a scene");
    let error =
        Propagation::of(&touched).matrix(&mut Control::none()).expect_err("a point on a transducer").to_string();
    assert!(error.starts_with("points[1] is 0.000e0 m from transducer 5"), "{error}");
}

#[test]
fn exact_is_the_oracle() {
    for directivity in PATTERNS {
        for middle in [[0.0; 3], [5.0, -5.0, 5.0]] {
            let scene = crooked(directivity, 0.15, middle, 1.9, 20);
            let found = Propagation::of(&scene);
            let exact: Vec<Vec<_>> = (0..36).map(|i| (0..20).map(|j| found.exact(j, i)).collect()).collect();
            for (r, error) in errors(&scene, &exact) {
                // Both values are f64; a distance of two metres is a phase of 1500 rad, accurate to 2e-13.
                assert!(error < 1e-12, "{error:e} at {r} m with {directivity:?}");
            }
        }
    }
}

#[test]
fn p1_of_the_papers_arrays_has_its_six_digits() {
    for (name, p1) in [("paper20", 2.36066), ("paper36", 6.40341)] {
        let scene = scene(preset(name), vec![[0.0, 0.0, 0.15]], None);
        let balanced = problem(&scene).targets_in_pascals()[0];
        let reach: f64 = rows(&Propagation::of(&scene)).iter().map(|row| row[0].norm()).sum();
        // The tolerance is half a unit of the sixth digit.
        assert!((balanced - p1).abs() < 5e-6 && (reach - p1).abs() < 5e-6, "{balanced} or {reach} for {p1}");
    }
}

#[test]
fn targets_left_out_are_the_balanced_level() {
    for directivity in PATTERNS {
        let scene = crooked(directivity, 0.0, [0.0; 3], 0.9, 30);
        let reach = oracle::reach(&propagation(&scene));
        let level = oracle::balanced_factor(&reach, &[1.0; 30], &[1.0; 30]);
        for &target in problem(&scene).targets_in_pascals() {
            // The moduli in f32 are accurate to 2e-6 of the modulus on the axis, with errors of random sign.
            assert!((target / level - 1.0).abs() < 1e-6, "{target} for {level} with {directivity:?}");
        }
    }
}

#[test]
fn behind_a_baffle_all_is_silent() {
    let mut points = random_points(50, 0.2, 1);
    for point in &mut points {
        point[2] *= -1.0;
    }
    for directivity in PATTERNS {
        let transducer = Transducer { directivity, ..Transducer::default() };
        let array = preset("paper20").with_transducer(transducer).expect("a transducer");
        let propagation = Propagation::of(&scene(array, points.clone(), None));
        let silent = rows(&propagation).iter().flatten().all(|g| *g == Complex64::ZERO);
        let exactly = (0..50).all(|j| propagation.exact(j, 21) == Complex64::ZERO);
        let open = directivity == Directivity::POINT;
        assert_eq!((silent, exactly), (!open, !open), "{directivity:?}");
    }
}

#[test]
fn an_entry_has_the_same_bits_whatever_the_number_of_points_and_the_memory() {
    let whole = crooked(Directivity::T4010A1, 0.15, [0.0; 3], 0.9, 67);
    let all = rows(&Propagation::of(&whole));
    for count in 1..=67 {
        let points = whole.points()[..count].to_vec();
        let part = Scene::new(whole.array().clone(), whole.medium(), points, Request::default()).expect("a scene");
        for (part, all) in rows(&Propagation::of(&part)).iter().zip(&all) {
            assert_eq!(part[..], all[..count], "M = {count}");
        }
    }
}

/// Returns the exact matrix of a scene as a user's own propagation matrix G.
fn stored(scene: &Scene) -> Propagation {
    let propagation = propagation(scene);
    let points = scene.points().len();
    let entry = |k: usize| propagation[k % propagation.len()][k / propagation.len()];
    let matrix: Vec<Complex64> = (0..propagation.len() * points).map(entry).collect();
    Propagation::from_matrix(&matrix, points).expect("a matrix")
}

#[test]
fn stored_rows_are_the_users_matrix_at_every_count() {
    for count in 1..=67 {
        let scene = crooked(Directivity::cos(1.0), 0.0, [0.0; 3], 0.9, count);
        let propagation = stored(&scene);
        assert_eq!((propagation.transducers(), propagation.points()), (36, count));
        for (i, (found, exact)) in rows(&propagation).iter().zip(crate::scenes::propagation(&scene)).enumerate() {
            for (j, (found, exact)) in found.iter().zip(exact).enumerate() {
                assert_eq!(propagation.exact(j, i), exact);
                // Real and imaginary part are rounded to f32 once.
                assert!((found - exact).norm() <= 1e-7 * exact.norm(), "{found} for {exact}");
            }
        }
    }
}

#[test]
fn a_stored_matrix_gets_the_answer_of_the_computed_one() {
    for (count, seed) in [(1, 1), (8, 2), (38, 3), (64, 4)] {
        let scene = scene(preset("paper20"), random_points(count, 0.1, seed), None);
        let computed = problem(&scene);
        let request = Request { pressures: Some(computed.targets_in_pascals().to_vec()), ..Request::default() };
        let stored = Problem::with_propagation(stored(&scene), Setup::default(), &request).expect("a problem");
        let order = Order::Given(Rng::new(seed).permutation(400));
        let greedy = Greedy { order, ..Greedy::default() };
        let solve = |problem: &Problem| {
            greedy.solve(problem, &mut Workspace::new(), &mut Control::none()).expect("an answer").metrics()
        };
        let (a, b) = (solve(&computed), solve(&stored));
        for (a, b) in [(a.accuracy, b.accuracy), (a.sigma, b.sigma), (a.uniformity, b.uniformity), (a.level, b.level)] {
            // Rows that differ by 1e-5 occasionally change a choice that is nearly a tie.
            assert!((a - b).abs() < 1e-3, "{a} and {b} at M = {count}");
        }
    }
}

#[test]
fn a_matrix_that_is_none_is_refused_by_name() {
    let one = Complex64::ONE;
    let message =
        |matrix: &[Complex64], points| Propagation::from_matrix(matrix, points).expect_err("refused").to_string();
    for (matrix, points) in [(&[][..], 1), (&[one; 4][..], 0), (&[one; 4][..], 3)] {
        assert!(message(matrix, points).starts_with("propagation is"), "{}", message(matrix, points));
    }
    for bad in [Complex64::new(f64::NAN, 0.0), Complex64::new(0.0, f64::INFINITY)] {
        let text = message(&[one, one, one, one, one, bad], 2);
        assert!(text.starts_with("propagation[1, 2] is"), "{text}");
    }
}

#[test]
#[should_panic(expected = "a row is M padded to 16 long")]
fn a_row_of_another_length_is_refused() {
    let propagation = Propagation::of(&scene(preset("paper20"), random_points(3, 0.1, 1), None));
    propagation.row(0, &mut [0.0; 3], &mut [0.0; 3]);
}
