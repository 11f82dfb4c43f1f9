//! Tests of flights: a bead that moves with its trap, a bead that falls, and refusals.

use super::*;
use crate::InstructionSet;
use crate::flight::envelope::Envelope;
use crate::scene::{Array, Medium};

const COUNT: usize = 20;

/// Returns two boards that face each other, and a function that gives the drive of a trap at a place: a focus of each board,
/// with opposite phase for the upper board.
fn boards() -> (Model, impl Fn([f64; 3]) -> Vec<Complex32>) {
    let array = Array::preset("openmpd_pair", [1, 1]).expect("an array");
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("a model");
    let sources = model.sources.clone();
    let trap = move |place: [f64; 3]| {
        let turned = |i: usize| if sources.array.positions()[i][2] > 0.0 { core::f32::consts::PI } else { 0.0 };
        (0..sources.array.len()).map(|i| Complex32::cis(turned(i) - sources.exact(i, place).arg() as f32)).collect()
    };
    (model, trap)
}

/// Returns the course of a trap that goes around a circle in 20 frames, its drive multiplied by `share`.
fn ring(share: f32, rate: f64) -> (Model, Course) {
    let (model, trap) = boards();
    let angle = |k: usize| core::f64::consts::TAU * k as f64 / COUNT as f64;
    let frames: Vec<[f64; 3]> =
        (0..COUNT).map(|k| [2e-3 * math::cos(angle(k)), 2e-3 * math::sin(angle(k)), 0.0]).collect();
    let drives: Vec<Complex32> = frames.iter().flat_map(|&place| trap(place)).map(|q| q * share).collect();
    let envelope = Envelope { rate, tau: 1e-4, linear: false };
    let course = Course::of(&frames, &drives, &model, envelope, true, &mut Control::none()).expect("a course");
    (model, course)
}

fn flown(model: &Model, course: &Course, beads: &[BeadStart], knots: usize) -> Flown {
    course.fly(model, Bead::default(), beads, knots, &mut Control::none()).expect("a flight")
}

#[test]
fn a_bead_that_begins_as_its_trap_moves_goes_around_with_it_alone_and_among_others() {
    let (model, course) = ring(1.0, 1000.0);
    let knots = course.knots(Some(0.04)).expect("knots");
    // A frame of 1 ms has four knots, and two laps take 40 ms.
    assert_eq!((course.lap(), knots), (4 * COUNT, 8 * COUNT + 1));
    let place = course.resting(&model, Bead::default(), &[0], &mut Control::none()).expect("a place")[0];
    let start = BeadStart { place, speed: course.moving(0)[0], point: 0 };
    let one = flown(&model, &course, &[start], knots);
    let ways = course.ways(knots, &[0]);
    assert!(one.lost[0].is_nan());
    let most = one.places.iter().zip(&ways).map(|(a, b)| distance(*a, *b)).fold(0.0, f64::max);
    assert!(most < 1e-3, "{most}");
    assert_eq!(one.farthest(), [most]);
    let nine = flown(&model, &course, &[start; 9], knots);
    assert!(nine.places.chunks(9).zip(&one.places).all(|(nine, one)| nine[8] == *one));
}

#[test]
fn a_bead_falls_out_of_a_trap_that_is_too_weak_and_is_lost() {
    let (model, course) = ring(0.02, 1000.0);
    let start = BeadStart { place: [2e-3, 0.0, 0.0], ..BeadStart::default() };
    let fall = flown(&model, &course, &[start], 200);
    let lost = fall.places.iter().position(|place| place[0].is_nan()).expect("it is lost");
    assert!((course.time(lost as f64) - fall.lost[0]).abs() < 1e-12 && fall.lost[0] < 0.05);
    assert!(fall.places[lost..].iter().all(|place| place[0].is_nan()));
    // A free fall of half a wavelength, 4.3 mm, takes 30 ms.
    assert!(fall.lost[0] > 0.02, "{}", fall.lost[0]);
}

#[test]
fn wrong_beads_are_refused() {
    let (model, course) = ring(1.0, 1000.0);
    let refusal = |beads: &[BeadStart], knots| {
        course.fly(&model, Bead::default(), beads, knots, &mut Control::none()).expect_err("a refusal").to_string()
    };
    assert!(refusal(&[], 9).starts_with("beads is 0"));
    assert!(refusal(&[BeadStart { place: [f64::NAN; 3], ..BeadStart::default() }], 9).starts_with("beads[0] is [NaN"));
    let far = BeadStart { place: [0.0, 0.0, 9e9], ..BeadStart::default() };
    assert!(refusal(&[far], 9).starts_with("beads come where there is no force"));
}
