use core::f64::consts::{PI, TAU};

use crate::points::{Curve, Modulation, Path, Run};
use crate::scene::distance;

const Z: f64 = 0.15;

fn ring(frequency: f64, points: usize) -> Path {
    let circle = Curve::circle([0.0, 0.0, Z], 0.02, [0.0, 0.0, 1.0], 0.0).unwrap();
    Path::along(circle, Run { frequency: Some(frequency), points, ..Run::default() }, None).unwrap()
}

fn still(places: &[f64]) -> Path {
    let places: Vec<_> = places.iter().map(|&x| [x, 0.0, Z]).collect();
    Path::morph(&places, &places, Some(0.1), None, None).unwrap()
}

#[test]
fn a_circle_is_where_its_formula_is() {
    let frames = ring(50.0, 3).frames(10e3).unwrap();
    assert_eq!((frames.points.len(), frames.targets.len()), (600, 600));
    for (k, place) in frames.points.iter().enumerate() {
        let angle = TAU * ((k / 3) as f64 / 200.0 + (k % 3) as f64 / 3.0);
        assert!(distance(*place, [0.02 * angle.cos(), 0.02 * angle.sin(), Z]) < 1e-16);
    }
    // A closed path repeats, also before its start; an open one rests.
    let (path, open) = (ring(50.0, 1), Path::through(vec![[0.0; 3], [0.0, 0.0, 1.0]], 1, 1.0, false, None).unwrap());
    for periods in [-3.0, 1.0, 2.0] {
        assert!(distance(path.at(0.003, 0).place, path.at(0.003 + 0.02 * periods, 0).place) < 1e-15);
    }
    assert_eq!([-1.0, 0.25, 1.0, 9.0].map(|time| open.at(time, 0).place[2]), [0.0, 0.25, 1.0, 1.0]);
    assert_eq!(open.at(0.5, 0).speed, 1.0);
}

#[test]
fn frames_are_met_exactly_and_straight_between() {
    let places: Vec<[f64; 3]> = (0..6).map(|k| [f64::from(k * k) * 1e-3, 0.1 / f64::from(k + 1), Z]).collect();
    for closed in [false, true] {
        let path = Path::through(places.clone(), 2, 1e3 / 3.0, closed, Some(&[1.0, 2.0])).unwrap();
        assert!((path.duration() - if closed { 9e-3 } else { 6e-3 }).abs() < 1e-17);
        let frames = path.frames(1e3 / 3.0).unwrap();
        assert_eq!((frames.points, frames.targets), (places.clone(), [1.0, 2.0].repeat(3)));
        let between = path.at(0.003 * 1.25, 1).place;
        let exact = [0, 1, 2].map(|axis| 0.75 * places[3][axis] + 0.25 * places[5][axis]);
        assert!(distance(between, exact) < 1e-16);
    }
}

#[test]
fn a_modulation_is_its_formula_and_fits_a_closed_path() {
    type Wave = fn(f64) -> f64;
    let waves: [(&str, Wave); 3] = [
        ("sqrt", |x| f64::midpoint(1.0, (TAU * x).cos()).sqrt()),
        ("cosine", |x| f64::midpoint(1.0, (TAU * x).cos())),
        ("square", |x| if (x % 1.0) < 0.5 - 1e-9 || x % 1.0 > 1.0 - 1e-9 { 1.0 } else { 0.0 }),
    ];
    for (shape, wave) in waves {
        let path = ring(50.0, 2).modulated(Modulation::new(200.0, shape, 0.4).unwrap()).unwrap();
        for (k, target) in path.frames(8e3).unwrap().targets.iter().enumerate() {
            assert!((target - (0.6 + 0.4 * wave(200.0 * (k / 2) as f64 / 8e3))).abs() < 1e-12, "{shape} {k}");
        }
    }
    let refused = |frequency: f64| {
        ring(50.0, 1).modulated(Modulation::new(frequency, "sqrt", 1.0).unwrap()).unwrap_err().to_string()
    };
    assert!(refused(180.0).ends_with("3.6 periods and jump at its seam, give 150 or 200 Hz"));
    let slow = ring(50.0, 1).modulated(Modulation::new(100.0, "sqrt", 1.0).unwrap()).unwrap().frames(150.0);
    assert!(slow.unwrap_err().to_string().contains("needs 200 frames a second"));
}

#[test]
fn closed_paths_beside_one_another_repeat_until_both_are_back() {
    let both = ring(60.0, 1).beside(&ring(40.0, 2)).unwrap().beside(&ring(20.0, 1)).unwrap();
    assert_eq!((both.points(), both.closed()), (4, true));
    assert!((both.duration() - 0.05).abs() < 1e-15);
    for (point, (frequency, index, count)) in
        [(60.0, 0, 1), (40.0, 0, 2), (40.0, 1, 2), (20.0, 0, 1)].iter().enumerate()
    {
        let alone = ring(*frequency, *count).at(0.041, *index).place;
        assert!(distance(both.at(0.041, point).place, alone) < 1e-14);
    }
    assert!(
        ring(50.0, 1).beside(&ring(50.123, 1)).unwrap_err().to_string().contains("ratio of whole numbers up to 64")
    );
}

#[test]
fn points_that_appear_and_vanish_fade_and_others_keep_their_slots() {
    let chain = still(&[0.0, 0.01]).then(&still(&[0.01, 0.03, 0.05]), Some(0.05)).unwrap();
    let chain = chain.then(&still(&[0.05, 0.07]), Some(0.05)).unwrap();
    assert_eq!(chain.points(), 4);
    let targets = |time: f64| chain.moments(time).map(|moment| moment.target).collect::<Vec<_>>();
    assert_eq!(targets(0.05), [1.0, 1.0, 0.0, 0.0]);
    assert_eq!(targets(0.2), [0.0, 1.0, 1.0, 1.0]);
    assert_eq!(targets(0.35), [1.0, 0.0, 0.0, 1.0]);
    assert!((targets(0.1125)[0] - f64::midpoint(1.0, (PI * 0.25).cos())).abs() < 1e-9);
    assert_eq!((chain.at(0.35, 0).place[0], chain.at(0.35, 3).place[0]), (0.07, 0.05));
    let jump = still(&[0.0]).then(&still(&[0.0123]), None).unwrap_err().to_string();
    assert!(
        jump.starts_with("the start of point 0 of the second path is 12.3 mm from where the first ends: give a fade")
    );
}
