use proptest::prelude::*;

use crate::points::Curve;
use crate::points::contour::{Lines, along, fitted, spaced};
use crate::scene::distance;

#[test]
fn spaced_points_are_those_of_a_plain_loop() {
    let mut rng = crate::rng::Rng::new(1);
    let points: Vec<[f64; 3]> = (0..400).map(|_| [0; 3].map(|_| 0.02 * rng.uniform() - 0.01)).collect();
    let mut apart: Vec<[f64; 3]> = Vec::new();
    for &point in &points {
        if apart.iter().all(|&other| distance(point, other) >= 0.002) {
            apart.push(point);
        }
    }
    assert!(apart.len() > 50 && apart.len() < 390);
    assert_eq!(spaced(points, 0.004), apart);
}

#[test]
fn a_distance_along_lines_gives_the_right_place() {
    let corner = [[0.0, 0.0, 0.1], [0.03, 0.0, 0.1], [0.03, 0.0, 0.1], [0.03, 0.01, 0.1]];
    let lines = Lines::new(&corner).unwrap();
    assert!((lines.length() - 0.04).abs() < 1e-17);
    for (way, place) in [(-1.0, corner[0]), (0.0, corner[0]), (0.03, corner[1]), (1.0, corner[3])] {
        assert_eq!(lines.after(way), place);
    }
    assert!(distance(lines.after(0.035), [0.03, 0.005, 0.1]) < 1e-17);
    // A single vertex is the place at every distance.
    assert_eq!(Lines::new(&corner[..1]).unwrap().after(0.5), corner[0]);
}

#[test]
fn a_contour_that_ends_where_it_began_has_no_point_twice() {
    let square = vec![[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.01, 0.01, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.0]];
    assert_eq!(along(&[square.clone(), square], 0.005).unwrap().len(), 8);
}

#[test]
fn fitted_points_are_at_most_as_many_as_allowed() {
    let circle = Curve::circle([0.0, 0.0, 0.1], 0.01, [0.0, 0.0, 1.0], 0.0).unwrap();
    let ring = |step| circle.points(step);
    assert_eq!(fitted(64, ring).unwrap().len(), 30);
    for most in 1..30 {
        let count = fitted(most, ring).unwrap().len();
        assert!(count <= most && count * 10 >= most * 9, "{count} of {most}");
    }
}

#[test]
fn a_length_of_too_many_points_is_rejected() {
    let line = Curve::line([0.0, 0.0, 0.1], [1000.0, 0.0, 0.1], false).unwrap();
    let reported = |step| line.points(step).unwrap_err().to_string();
    assert!(reported(2e-3).starts_with("step is 0.002: 1000 m of contours would be more than 100000 points"));
    assert_eq!(reported(0.0), "step is 0.0: give a number above 0");
    assert_eq!(reported(f64::NAN), "step is NaN: give a finite number");
    let reported = along(&[vec![]], 1e-3).unwrap_err().to_string();
    assert_eq!(reported, "contour is []: give vertices of finite numbers");
}

proptest! {
    #[test]
    fn steps_are_equal_and_both_ends_are_there(
        start in prop::array::uniform3(-0.1..0.1f64), end in prop::array::uniform3(-0.1..0.1f64), step in 1e-3..0.2f64,
    ) {
        let length = distance(start, end);
        prop_assume!(length > 1e-3);
        let points = Curve::line(start, end, false).unwrap().points(step).unwrap();
        let steps = points.len() - 1;
        prop_assert_eq!(points[0], start);
        prop_assert!(length < step / 2.0 || distance(points[steps], end) < 1e-12);
        prop_assert!(steps < 2 || (length / step - steps as f64).abs() <= 0.5 + 1e-9);
        for pair in points.windows(2) {
            prop_assert!((distance(pair[0], pair[1]) - length / steps as f64).abs() < 1e-12);
        }
    }
}
