//! Tests of `Flight::fly`: closed forms of an oscillator, and the same bits by every instruction set.

use super::*;
use crate::kernels::simd::doubles::Eight;

const STILL: [f64; 3] = [0.0; 3];

/// Returns air that is too thin for drag.
fn thin() -> Medium {
    Medium { density: 1e-9, ..Medium::default() }
}

fn flight(steps: usize, step: f64) -> Flight {
    Flight { particle: Particle::default(), gravity: STILL, step, steps, unit: 1e-3 }
}

/// Returns the force -k x for eight beads, each with its stiffness k, in units of 1 mm.
fn spring(stiffness: Eight) -> Force {
    let mut force = [[[0.0; 8]; 3]; 84];
    for axis in 0..3 {
        force[1 + axis][axis] = stiffness.map(|k| -k * 1e-3);
    }
    force
}

fn flown(
    set: InstructionSet,
    air: Medium,
    forces: &[Force],
    flight: &Flight,
    place: [f64; 3],
) -> (State, Vec<[Eight; 3]>) {
    let mut state = begun(place.map(|x| [x; 8]), [[0.0; 8]; 3]);
    let centres = vec![[[0.0; 8]; 3]; flight.steps * (forces.len() - 1) + 1];
    let mut places = vec![[[0.0; 8]; 3]; forces.len()];
    let none = &mut Control::none();
    let reach = [f64::INFINITY; 8];
    let last = flight.fly(set, air, &mut state, reach, forces, &centres, 0, &mut places, none).expect("a flight");
    assert_eq!(last, centres.len() - 1);
    (state, places)
}

#[test]
fn a_bead_on_a_spring_swings_as_a_cosine_that_friction_damps_and_sags_by_its_weight() {
    let (air, particle) = (thin(), Particle::default());
    let mass = particle.mass(air);
    let stiffness: Eight = core::array::from_fn(|i| 0.01 * (i + 1) as f64);
    let flight = Flight { gravity: [0.0, 0.0, -9.81], ..flight(10, 1e-5) };
    let forces = vec![spring(stiffness); 101];
    let (_, places) = flown(InstructionSet::best(), air, &forces, &flight, [1e-4, -2e-4, 0.0]);
    // Only Stokes' friction acts: the air is too thin for other drag.
    let damping = 3.0 * core::f64::consts::PI * air.viscosity() * particle.radius / mass;
    for (knot, place) in places.iter().enumerate() {
        for i in 0..8 {
            let time = 1e-4 * knot as f64;
            let speed = crate::math::sqrt(stiffness[i] / mass - damping * damping);
            let swing = crate::math::exp(-damping * time)
                * (crate::math::cos(speed * time) + damping / speed * crate::math::sin(speed * time));
            let sag = particle.weight(air, flight.gravity)[2] / stiffness[i];
            let exact = [1e-4 * swing, -2e-4 * swing, sag * (1.0 - swing)];
            assert!((0..3).all(|axis| (place[axis][i] - exact[axis]).abs() < 1e-9), "{knot} {i}");
        }
    }
}

#[test]
fn the_exponentials_are_the_root_of_time_from_3_hz_to_2_khz() {
    for k in 0..200 {
        let omega = 20.0 * crate::math::pow(600.0, f64::from(k) / 199.0);
        let turn = num_complex::Complex64::new(0.0, omega);
        let sum: num_complex::Complex64 =
            exponentials().iter().map(|[rate, weight]| turn * *weight / (turn + rate)).sum();
        // The transform of u' * 1/sqrt(t) is sqrt(pi j omega) u.
        let exact = (turn * core::f64::consts::PI).sqrt();
        assert!((sum - exact).norm() < 0.008 * exact.norm(), "{omega}: {sum} {exact}");
    }
}

#[test]
fn a_bead_rings_down_as_the_whole_history_of_its_boundary_layer_demands() {
    // 289 Hz, the axial resonance of a bead of 1 mm in an OpenMPD.
    let (air, particle) = (Medium::default(), Particle::default());
    let (mass, turn) = (particle.mass(air), core::f64::consts::TAU * 289.0);
    let stiffness = turn * turn * mass;
    let knots = 6001;
    let (_, places) =
        flown(InstructionSet::best(), air, &vec![spring([stiffness; 8]); knots], &flight(1, 5e-5), [1e-5, 0.0, 0.0]);
    // m u' = -k x - 6 pi eta a u - C int u'(s)/sqrt(t - s) ds, with every earlier step and its integral of the root.
    let (h, steps) = (5e-5, 3000);
    let (friction, factor) = (particle.friction(air), particle.history(air));
    let (mut x, mut u, mut gains) = (1e-5_f64, 0.0_f64, Vec::<f64>::new());
    let mut exact = vec![x];
    for n in 0..steps {
        // The equation in the middle of the step, where x and u are means; the newest gain (u' - u)/h is unknown.
        let root = |part: usize| math::sqrt((part as f64 + 0.5) * h);
        let past: f64 = (0..n).map(|s| 2.0 * gains[s] * (root(n - s) - root(n - s - 1))).sum();
        let [own, other] = [mass / h + 2.0 * factor * root(0) / h, 0.5 * friction + 0.25 * stiffness * h];
        let after = ((own - other) * u - stiffness * x - factor * past) / (own + other);
        gains.push((after - u) / h);
        x += 0.5 * h * (u + after);
        u = after;
        exact.push(x);
    }
    let rate = |track: &[f64]| {
        let peaks: Vec<(f64, f64)> = (1..track.len() - 1)
            .filter(|&k| track[k] > track[k - 1] && track[k] >= track[k + 1])
            .map(|k| (k as f64 * h, track[k].ln()))
            .collect();
        let (first, last) = (peaks[2], peaks[peaks.len() - 1]);
        (first.1 - last.1) / (last.0 - first.0)
    };
    let track: Vec<f64> = places.iter().take(steps + 1).map(|place| place[0][0]).collect();
    let [flown, plain] = [&track, &exact].map(|track| 1e3 / rate(track));
    assert!((flown / plain - 1.0).abs() < 0.03, "{flown} {plain}");
    assert!((flown / 83.5 - 1.0).abs() < 0.05, "{flown}");
}

#[test]
fn drag_brings_a_falling_bead_to_the_speed_at_which_it_weighs_nothing() {
    let (air, particle) = (Medium::default(), Particle::default());
    let flight = Flight { gravity: [0.0, 0.0, -9.81], ..flight(1000, 1e-3) };
    let (state, _) = flown(InstructionSet::best(), air, &vec![spring([0.0; 8]); 11], &flight, STILL);
    let weight = -particle.weight(air, flight.gravity)[2];
    assert!((particle.drag(air, -state[1][2][0]) / weight - 1.0).abs() < 1e-5);
    // Stokes' law holds at low speed: friction is the only force.
    assert!((particle.drag(air, 1e-7) / (6.0 * core::f64::consts::PI * air.viscosity() * 1e-10) - 1.0).abs() < 1e-3);
}

#[test]
fn every_set_gives_the_same_bits_and_a_flight_that_stops_goes_on_to_the_same() {
    let air = Medium::default();
    let mut forces = vec![spring([0.02; 8]), spring([0.03; 8]), spring([0.01; 8])];
    for (t, force) in forces.iter_mut().enumerate() {
        force.as_flattened_mut().as_flattened_mut().iter_mut().enumerate().for_each(|(k, x)| {
            *x += 1e-7 * crate::math::sin((k + t) as f64);
        });
    }
    let flight = flight(20, 5e-5);
    let start = [2e-4, 0.0, -1e-4];
    let (state, places) = flown(InstructionSet::best(), air, &forces, &flight, start);
    for set in InstructionSet::all() {
        assert!(flown(set, air, &forces, &flight, start) == (state, places.clone()));
    }
    // In the first three calls the first bead is at once outside its reach of 10 um. The fourth call has no limit.
    let mut again = begun(start.map(|x| [x; 8]), [[0.0; 8]; 3]);
    let centres = vec![[[0.0; 8]; 3]; 41];
    let mut track = vec![[[0.0; 8]; 3]; 3];
    let (mut from, mut calls) = (0, 0);
    while from < 40 {
        let mut reach = [f64::INFINITY; 8];
        reach[0] = if calls < 3 { 1e-5 } else { f64::INFINITY };
        let set = InstructionSet::best();
        from = flight
            .fly(set, air, &mut again, reach, &forces, &centres, from, &mut track, &mut Control::none())
            .expect("a flight");
        calls += 1;
    }
    assert!(calls == 4 && again == state && track == places);
}

/// Returns the state after a flight of beads that start on the x axis at `places`, in mm. The force has a linear
/// spring's terms and terms of higher degrees; each degree has terms a tenth as large as the degree before.
fn swung(set: InstructionSet, places: Eight) -> State {
    let mut force = spring([0.02; 8]);
    for (t, term) in force.iter_mut().enumerate().skip(4) {
        let degree = [10, 20, 35, 56, 84].iter().filter(|&&end| end <= t).count() as f64 + 2.0;
        let size = -2e-5 * crate::math::exp(-2.3 * (degree - 1.0));
        term.as_flattened_mut().fill(size * crate::math::sin(t as f64));
    }
    let mut state = begun([places.map(|x| 1e-3 * x), [0.0; 8], [0.0; 8]], [[0.0; 8]; 3]);
    let forces = vec![force; 11];
    let flight = flight(10, 5e-5);
    let centres = vec![[[0.0; 8]; 3]; 101];
    let mut places = vec![[[0.0; 8]; 3]; 11];
    let reach = [f64::INFINITY; 8];
    let none = &mut Control::none();
    flight.fly(set, Medium::default(), &mut state, reach, &forces, &centres, 0, &mut places, none).expect("a flight");
    state
}

#[test]
fn near_its_centre_a_bead_moves_by_few_terms_as_by_all() {
    for near in [0.01, 0.03, 0.1, 0.3] {
        let alone = swung(InstructionSet::best(), [near; 8]);
        // If one bead is far from its centre, all beads use all terms.
        let mut places = [near; 8];
        places[7] = 0.9;
        let beside = swung(InstructionSet::best(), places);
        for axis in 0..3 {
            let apart = (alone[0][axis][0] - beside[0][axis][0]).abs();
            assert!(apart < 1e-8, "{near} {axis}: {apart}");
        }
        assert!(alone[0][0][0] != beside[0][0][0] || near > 0.1);
        for set in InstructionSet::all() {
            assert!(swung(set, [near; 8]) == alone);
        }
    }
}

#[test]
fn laps_are_flown_as_forces_that_repeat() {
    let lap: Vec<Force> = [0.02, 0.03, 0.01, 0.02].iter().map(|&k| spring([k; 8])).collect();
    let long: Vec<Force> = lap[..3].iter().cycle().take(8).copied().collect();
    let (air, flight) = (Medium::default(), flight(20, 5e-5));
    let (state, places) = flown(InstructionSet::best(), air, &long, &flight, [2e-4, 0.0, -1e-4]);
    let mut again = begun([2e-4, 0.0, -1e-4].map(|x| [x; 8]), [[0.0; 8]; 3]);
    let centres = vec![[[0.0; 8]; 3]; 61];
    let mut track = vec![[[0.0; 8]; 3]; 8];
    let (set, reach, none) = (InstructionSet::best(), [f64::NAN; 8], &mut Control::none());
    let last = flight.fly(set, air, &mut again, reach, &lap, &centres, 0, &mut track, none).expect("a flight");
    assert!(last == 140 && again == state && track == places);
}
