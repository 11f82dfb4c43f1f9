//! Tests of greedy with a start: the exchange of drives with a bound on the phase change, compared with plain double precision.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use midair::solvers::{Greedy, Objective, Order, Uniform};
use midair::{
    Array, Complex32, Complex64, Control, InstructionSet, Medium, Metrics, Model, Problem, Propagation, Quantization,
    Request, Rng, Session, Setup, Solution, Solve, SolveRequest, Start, Workspace,
};

use crate::oracle::{self, Search};
use crate::scenes::{preset, problem, propagation, random_points, scene, widen};

/// The allowed regret of a choice: 1e-6 of E(0), as docs/reproducibility.md states.
const REGRET: f64 = 1e-6;

fn started(problem: Problem, start: &[Complex32]) -> Problem {
    problem.with_start(Start::Drive(start.to_vec())).expect("a start")
}

fn solved(greedy: &Greedy, problem: &Problem) -> Solution {
    midair::solve(problem, greedy, false, &mut Workspace::new(), &mut Control::none()).expect("an answer")
}

/// Returns random drives with L = `phases` phases (any phase for 0). One in ten is 0; the amplitudes are 1 if `loud`, else
/// anything above a tenth.
fn drive(count: usize, phases: u32, loud: bool, seed: u64) -> Vec<Complex32> {
    let mut rng = Rng::new(seed);
    let mut one = || {
        let turns = rng.uniform();
        let turns = if phases == 0 { turns } else { (turns * f64::from(phases)).floor() / f64::from(phases) };
        let amplitude = if loud { 1.0 } else { 0.1 + 0.9 * rng.uniform() };
        let q = Complex64::from_polar(if rng.uniform() < 0.1 { 0.0 } else { amplitude }, TAU * turns);
        Complex32::new(q.re as f32, q.im as f32)
    };
    (0..count).map(|_| one()).collect()
}

/// The angle between two drives in rad, 0 if one of them is 0.
fn turn(a: Complex32, b: Complex32) -> f64 {
    let [a, b] = [a, b].map(|z| Complex64::new(z.re.into(), z.im.into()));
    (a * b.conj()).arg().abs()
}

#[test]
#[ignore = "slow"]
fn every_exchange_is_the_best_within_its_bound_at_every_instruction_set() {
    let changes = [0.0, 0.1, PI / 16.0, 1.0, PI];
    for (k, points) in [1_usize, 2, 4, 16, 17, 38].into_iter().enumerate() {
        for (l, (phases, amplitudes)) in [(16, 1), (256, 1), (64, 3), (3, 2), (100, 1)].into_iter().enumerate() {
            let objective = if (k + l) % 3 == 0 { Objective::L1 } else { Objective::L2 };
            let order = if k % 2 == 0 { Order::Random } else { Order::Rows };
            let change = changes[(k + l) % changes.len()];
            let greedy = Greedy { phases, amplitudes, objective, order, change, ..Greedy::default() };
            let scene = scene(preset("paper20"), random_points(points, 0.1, points as u64), None);
            let order: Vec<usize> = match &greedy.order {
                Order::Random => Rng::new(0).permutation(400).into_iter().map(|i| i as usize).collect(),
                _ => (0..400).collect(),
            };
            let rows = propagation(&scene);
            for start in [drive(400, phases, true, 7), drive(400, 0, false, 8), drive(400, 4 * phases, true, 9)] {
                for set in InstructionSet::all() {
                    let propagation = Propagation::of(&scene).with_instruction_set(set);
                    let setup = Setup::of(scene.array(), scene.medium());
                    let problem = Problem::with_propagation(propagation, setup, scene.request()).expect("a problem");
                    let found = solved(&greedy, &started(problem.clone(), &start));
                    for (i, (q, last)) in found.drive.iter().zip(&start).enumerate() {
                        assert!(*last == Complex32::ZERO || turn(*q, *last) <= change + 1e-6, "{set}, {i}: {greedy:?}");
                    }
                    let search = Search {
                        propagation: &rows,
                        targets: problem.targets_in_pascals(),
                        weights: problem.point_weights(),
                        phases: phases as usize,
                        amplitudes: amplitudes as usize,
                        objective: if objective == Objective::L2 {
                            oracle::Objective::L2
                        } else {
                            oracle::Objective::L1
                        },
                        order: &order,
                    };
                    let regrets = search.exchange_regrets(&widen(&start), &widen(&found.drive), change);
                    let worst = regrets.into_iter().fold(0.0, f64::max);
                    assert!(worst < REGRET, "{set}, M = {points}: regret {worst:e} with {greedy:?}");
                    // The pressures, from the field that the solver updated, are those of its drive.
                    let field = oracle::field(&rows, &widen(&found.drive));
                    let loudest = field.iter().map(|p| p.norm()).fold(0.0, f64::max);
                    for (ours, theirs) in widen(&found.pressures).iter().zip(&field) {
                        assert!((ours - theirs).norm() < 1e-4 * loudest, "{set}: {ours} for {theirs}");
                    }
                }
            }
        }
    }
}

/// Returns a problem for four AUTD3 boards (N = 996) with 256 phases and these amplitudes.
fn boards(amplitudes: &[f64], points: &[[f64; 3]], pressures: Option<Vec<f64>>) -> Problem {
    let quantization = Quantization::new(Some(256), Some(amplitudes.to_vec())).expect("quantization");
    let array = Array::preset("autd3", [2, 2]).expect("boards").with_quantization(Some(quantization));
    problem(&scene(array, points.to_vec(), pressures))
}

/// M points that move on circles of 10 mm at 0.5 m/s, with 10,000 frames per second.
fn circles(points: usize, frame: usize) -> Vec<[f64; 3]> {
    let mut rng = Rng::new(5);
    let one = |_| {
        let [x, y, angle] = [(); 3].map(|()| rng.uniform());
        let angle = TAU * angle + frame as f64 * 0.5 / 10e3 / 0.01;
        [0.12 * x - 0.06 + 0.01 * angle.cos(), 0.12 * y - 0.06 + 0.01 * angle.sin(), 0.2]
    };
    (0..points).map(one).collect()
}

/// The phase of each drive as a number of steps of 1/256 turn.
fn codes(drive: &[Complex32]) -> Vec<i64> {
    let steps = |q: &Complex32| f64::from(q.im).atan2(q.re.into()) / TAU * 256.0;
    assert!(drive.iter().all(|q| (steps(q) - steps(q).round()).abs() < 1e-4), "off the grid");
    drive.iter().map(|q| steps(q).round() as i64).collect()
}

/// The largest change of a phase between two drives, in steps.
fn largest_step(now: &[Complex32], last: &[Complex32]) -> i64 {
    let step = |(now, last): (&i64, &i64)| ((now - last + 128).rem_euclid(256) - 128).abs();
    codes(now).iter().zip(&codes(last)).map(step).max().expect("some")
}

#[test]
fn points_in_motion_stay_even_and_loud_with_every_change_within_the_bound() {
    for (change, most) in [(PI / 16.0, 8), (PI / 32.0, 4), (0.08, 3)] {
        let greedy = Greedy { phases: 256, change, seed: 1, ..Greedy::default() };
        let mut last = solved(&greedy, &boards(&[0.0, 1.0], &circles(4, 0), None)).drive;
        for frame in 1..60 {
            let requested = boards(&[0.0, 1.0], &circles(4, frame), None);
            let found = solved(&greedy, &started(requested.clone(), &last));
            let step = largest_step(&found.drive, &last);
            assert!(step <= most, "frame {frame}: {step} steps of 2 pi/256 for {change} rad");
            if frame >= 30 {
                let (work, none) = (&mut Workspace::new(), &mut Control::none());
                let cold =
                    midair::solve(&requested, &Uniform::default(), true, work, none).expect("an answer").metrics();
                let Metrics { level, uniformity, .. } = found.metrics();
                assert!(level > 0.98 * cold.level && uniformity > 0.98, "{change}, {frame}: {level}, {uniformity}");
            }
            last = found.drive;
        }
    }
}

#[test]
fn a_frame_at_rest_is_never_worse_than_the_last_and_change_0_keeps_it() {
    for points in [1, 4, 16] {
        let greedy = Greedy { phases: 256, change: PI / 16.0, ..Greedy::default() };
        let requested = boards(&[0.0, 1.0], &circles(points, 0), None);
        let mut last = solved(&greedy, &requested);
        for frame in 0..10 {
            let now = solved(&greedy, &started(requested.clone(), &last.drive));
            // The tolerance covers the rounding of the pressures.
            let [before, after] = [&last, &now].map(|solution| solution.metrics().residual);
            assert!(after <= before + 1e-6, "M = {points}, frame {frame}: {after} after {before}");
            // With one focus, all relative phases soon become right; a common phase does not matter.
            assert!(points > 1 || frame < 5 || now.drive == last.drive, "frame {frame}");
            last = now;
        }
        let still = Greedy { change: 0.0, ..greedy };
        let elsewhere = started(boards(&[0.0, 1.0], &circles(points, 900), None), &last.drive);
        assert_eq!(solved(&still, &elsewhere).drive, last.drive);
    }
}

#[test]
fn a_balanced_answer_is_carried_on_at_its_own_level() {
    let amplitudes: Vec<f64> = (0..=255).map(|k| f64::from(k) / 255.0).collect();
    let greedy = Greedy { phases: 256, change: PI / 16.0, ..Greedy::default() };
    let balanced = |frame: usize, last: Option<&[Complex32]>| {
        let requested = boards(&amplitudes, &circles(4, frame), Some(vec![300.0; 4]));
        let requested = if let Some(last) = last { started(requested, last) } else { requested };
        midair::solve(&requested, &greedy, true, &mut Workspace::new(), &mut Control::none()).expect("an answer")
    };
    let first = balanced(0, None);
    assert!(first.drive.iter().all(|q| q.norm() < 0.05), "far below full drive");
    let mut last = first.drive.clone();
    for frame in 1..20 {
        let found = balanced(frame, Some(&last));
        let Metrics { accuracy, uniformity, .. } = found.metrics();
        // If the start were compared with the balanced level, it would seem almost silent, and all phases would be changed
        // again.
        assert!((accuracy - 1.0).abs() < 2e-3 && uniformity > 0.98, "frame {frame}: {accuracy}, {uniformity}");
        assert!(largest_step(&found.drive, &last) <= 8, "frame {frame}");
        last = found.drive;
    }
}

#[test]
fn a_batch_with_starts_is_single_solves_bit_for_bit() {
    let array = preset("paper20");
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("an array");
    let greedy = Greedy { change: 1.0, ..Greedy::default() };
    let start = |k: usize| drive(400, 16, true, k as u64);
    let points = |k: usize| random_points(5, 0.1, k as u64);
    let ask = |k: usize, ask: &mut SolveRequest| {
        *ask = SolveRequest {
            points: points(k),
            request: Request::default(),
            start: Some(Start::Drive(start(k))),
            aim: None,
        };
        Ok(())
    };
    let solver: Arc<dyn Solve + Send + Sync> = Arc::new(greedy.clone());
    let mut drives = vec![Complex32::ZERO; 20 * 400];
    let mut session = Session::new(model, solver, false);
    session.solve_batch(20, 5, &ask, &mut drives, &mut Control::none().with_threads(3)).expect("answers");
    for (k, drive) in drives.chunks(400).enumerate() {
        let single = solved(&greedy, &started(problem(&scene(array.clone(), points(k), None)), &start(k)));
        assert_eq!(single.drive, drive, "problem {k}");
    }
}

#[test]
fn what_greedy_cannot_go_on_from_is_refused_in_one_line() {
    let requested = problem(&scene(preset("paper20"), random_points(2, 0.1, 1), None));
    let refused = |greedy: &Greedy, problem: &Problem| {
        let solution = midair::solve(problem, greedy, false, &mut Workspace::new(), &mut Control::none());
        solution.map(|_| ()).expect_err("refused").to_string()
    };
    for (change, reported) in [
        (f64::NAN, "change is NaN: give a finite number"),
        (f64::INFINITY, "change is inf: give a finite number"),
        (-0.1, "change is -0.1: give a number of at least 0"),
    ] {
        assert_eq!(refused(&Greedy { change, ..Greedy::default() }, &requested), reported);
    }
    let phases = requested.with_start(Start::Phases(vec![0.0; 2])).expect("a start");
    let reported = "start is point phases: greedy goes on from a drive: give one value a transducer";
    assert_eq!(refused(&Greedy::default(), &phases), reported);
}

#[test]
fn every_sweep_lowers_the_residual_and_keeps_the_bound_of_a_start() {
    let points = random_points(6, 0.1, 4);
    let requested = problem(&scene(preset("paper20"), points.clone(), None));
    let residual = |sweeps: u32| {
        let solution = solved(&Greedy { sweeps, ..Greedy::default() }, &requested);
        assert_eq!(solution.steps, 400 * sweeps as usize);
        solution.metrics().residual
    };
    let residuals: Vec<f64> = [1, 2, 3, 6].map(residual).to_vec();
    assert!(residuals.is_sorted_by(|a, b| a > b), "{residuals:?}");
    assert!(residuals[1] < 0.9 * residuals[0], "{residuals:?}");
    let last = drive(400, 16, true, 7);
    let greedy = Greedy { sweeps: 4, change: 2.0 * PI / 16.0, ..Greedy::default() };
    let found = solved(&greedy, &started(requested, &last));
    for (&new, &old) in found.drive.iter().zip(&last).filter(|(_, old)| old.norm() > 0.0) {
        assert!(turn(new, old) < 2.0 * PI / 16.0 + 1e-5, "{old} became {new}");
    }
    let none = Greedy { sweeps: 0, ..Greedy::default() };
    let requested = problem(&scene(preset("paper20"), points, None));
    let reported = midair::solve(&requested, &none, false, &mut Workspace::new(), &mut Control::none()).map(|_| ());
    assert_eq!(reported.expect_err("refused").to_string(), "sweeps is 0: give 1 to 1000");
}
