use core::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::points::Curve;
use crate::scene::{distance, dot};
use crate::vec3::Vec3;

#[test]
fn a_circle_is_round_flat_and_counterclockwise() {
    let center = [0.01, -0.02, 0.15];
    for normal in [[0.0, 0.0, 1.0], [0.0, 0.0, -3.0], [1.0, 0.0, 0.0], [-1.0, 1e-9, 0.0], [0.3, -0.2, 0.9]] {
        let circle = Curve::circle(center, 0.02, normal, 0.4).unwrap();
        assert!(circle.closed() && (circle.length() - TAU * 0.02).abs() < 1e-17);
        let away = |way: f64| [0, 1, 2].map(|axis| circle.after(way)[axis] - center[axis]);
        for k in 0..50 {
            let way = f64::from(k) * 0.01;
            assert!((dot(away(way), away(way)).sqrt() - 0.02).abs() < 1e-15);
            assert!(dot(away(way), normal).abs() < 1e-15);
            assert!(distance(circle.after(way), circle.after(way + circle.length())) < 1e-14);
            let next = away(way + 0.02 * FRAC_PI_2);
            assert!(Vec3(away(way)).cross(next).dot(normal) > 0.0);
        }
    }
    let flat = Curve::circle(center, 0.02, [0.0, 0.0, 2.0], PI / 6.0).unwrap().after(0.0);
    assert!(distance(flat, [0.01 + 0.02 * 0.75f64.sqrt(), -0.01, 0.15]) < 1e-17);
}

#[test]
fn meaningless_curves_are_rejected() {
    let circle = |center, radius, normal, angle| Curve::circle(center, radius, normal, angle).unwrap_err().to_string();
    let (at, up) = ([0.0, 0.0, 0.1], [0.0, 0.0, 1.0]);
    assert_eq!(circle(at, 0.0, up, 0.0), "radius is 0.0: give a number above 0");
    assert_eq!(circle(at, 1.0, [0.0; 3], 0.0), "normal is [0.0, 0.0, 0.0]: give a direction such as [0, 0, 1]");
    assert_eq!(circle(at, 1.0, up, f64::NAN), "start_angle is NaN: give a finite number");
    let nowhere = circle([0.0, 0.0, f64::INFINITY], 1.0, up, 0.0);
    assert_eq!(nowhere, "center is [0.0, 0.0, inf]: give three finite numbers");
    let line = Curve::line(at, at, true).unwrap_err().to_string();
    assert_eq!(line, "end is [0.0, 0.0, 0.1]: it is where the start is, give another point");
    let lines = |corners: &[[f64; 3]]| Curve::lines("corners", corners, false).unwrap_err().to_string();
    assert!(lines(&[at]).ends_with("give at least two"));
    assert!(lines(&[at, at]).starts_with("corners is [[0.0, 0.0, 0.1], [0.0, 0.0, 0.1]]: they are all in one place"));
    assert!(lines(&[at, [f64::NAN; 3]]).starts_with("corners is [NaN, NaN, NaN]"));
}

#[test]
fn open_lines_end_at_their_end_and_closed_ones_at_their_start() {
    let corners = [[0.0, 0.0, 0.1], [0.03, 0.0, 0.1], [0.03, 0.04, 0.1]];
    let [open, closed] = [false, true].map(|closed| Curve::lines("corners", &corners, closed).unwrap());
    assert!((open.length() - 0.07).abs() < 1e-16 && (closed.length() - 0.12).abs() < 1e-16);
    assert_eq!((open.after(1.0), closed.after(1.0)), (corners[2], corners[0]));
    assert!(distance(closed.after(0.095), [0.015, 0.02, 0.1]) < 1e-16);
}
