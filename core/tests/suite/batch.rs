//! Batches and sessions: every answer bit for bit that of a lone solve.

use midair::{
    Array, Complex32, Complex64, Control, Directivity, Error, Gains, Level, Medium, Problem, Request, Rng,
    Session, Solution, Solve, Status, Transducer, Transmitter, Workspace, solve_batch, solvers,
};

use crate::scenes::{preset, random_points};

const B: usize = 37;
const M: usize = 5;

fn transmitter() -> Transmitter {
    Transmitter::new(&preset("paper20"), Medium::default(), Level::best()).expect("an array")
}

/// Problem k: its points, and every third with a point of weight 0.
fn asked(k: usize) -> (Vec<[f64; 3]>, Request) {
    let mut rng = Rng::new(k as u64);
    let pressures = (0..M).map(|_| 0.2 + rng.uniform()).collect();
    let weights = (k % 3 == 2).then(|| (0..M).map(|j| if j == k % M { 0.0 } else { 1.0 }).collect());
    (random_points(M, 0.1, k as u64), Request { pressures: Some(pressures), weights })
}

fn problem(transmitter: &Transmitter, k: usize) -> Result<Problem, Error> {
    let (points, request) = asked(k);
    Problem::with_gains(transmitter.gains(&points)?, &request)
}

#[test]
fn a_batch_and_a_session_are_lone_solves_bit_for_bit() {
    let transmitter = transmitter();
    for entry in solvers::SOLVERS {
        let made = || entry.configure(&midair::Options::new()).expect("defaults");
        let solver = made().solver;
        let mut drives = vec![midair::Complex32::ZERO; B * 400];
        let make = |k| problem(&transmitter, k);
        let balance = entry.info.balance;
        let batch = solve_batch(B, M, &make, &*solver, balance, &mut drives, &mut Control::none());
        let batch = batch.expect("answers");
        let mut session = Session::new(transmitter.clone(), made());
        for k in 0..B {
            let problem = make(k).expect("a problem");
            let mut work = Workspace::new();
            let lone = midair::solve(&problem, &*solver, balance, &mut work, &mut Control::none())
                .expect("an answer");
            let name = entry.info.name;
            assert_eq!(lone.drive, drives[k * 400..(k + 1) * 400], "{name}: drive of problem {k}");
            assert_eq!(lone.pressures, batch.pressures[k * M..(k + 1) * M], "{name}: pressures of {k}");
            assert_eq!(
                (lone.metrics(), lone.status, lone.steps),
                (batch.metrics[k], batch.status[k], batch.steps[k])
            );
            let (points, request) = asked(k);
            let again = session.solve(&points, &request, None, &mut Control::none()).expect("an answer");
            assert_eq!(
                (&lone.drive, &lone.pressures),
                (&again.drive, &again.pressures),
                "{name}: session at {k}"
            );
        }
    }
}

#[test]
fn a_bad_problem_is_named_and_a_stop_keeps_what_is_done() {
    let transmitter = transmitter();
    let solver = solvers::find("fast")
        .expect("registered")
        .configure(&midair::Options::new())
        .expect("defaults")
        .solver;
    let mut drives = vec![midair::Complex32::ZERO; B * 400];
    let bad = |k: usize| {
        if k == 7 || k == 30 {
            transmitter.gains(&[[0.0, f64::NAN, 0.1]; M]).map(|_| unreachable!())
        } else {
            problem(&transmitter, k)
        }
    };
    let refused =
        solve_batch(B, M, &bad, &*solver, false, &mut drives, &mut Control::none()).expect_err("refused");
    assert_eq!(
        refused.to_string(),
        "problems[7]: points[0].position is [0.0, NaN, 0.1]: give three finite numbers"
    );
    let short = |k: usize| {
        let (points, _) = asked(k);
        Problem::with_gains(transmitter.gains(&points[..if k == 3 { 2 } else { M }])?, &Request::default())
    };
    let refused =
        solve_batch(B, M, &short, &*solver, false, &mut drives, &mut Control::none()).expect_err("refused");
    assert!(refused.to_string().starts_with("problems[3]"), "{refused}");
    drives.fill(midair::Complex32::ZERO);
    let mut calls = 0;
    let mut stop = |_: midair::Progress<'_>| {
        calls += 1;
        std::ops::ControlFlow::Break(())
    };
    let make = |k| problem(&transmitter, k);
    let batch = solve_batch(
        1000,
        M,
        &make,
        &*solver,
        false,
        &mut vec![midair::Complex32::ZERO; 400_000],
        &mut Control::watched(&mut stop),
    );
    let batch = batch.expect("what is done");
    assert_eq!(calls, 1);
    let done = batch.status.iter().filter(|status| **status == Status::Done).count();
    assert!(done > 0 && done < 1000 && batch.status[..done].iter().all(|status| *status == Status::Done));
    assert!(batch.pressures[done * M..].iter().all(|p| p.norm() == 0.0));
}

/// A 7 x 5 array, so that the last block is not whole; its options and its air at a level.
fn small(full: bool, level: Level) -> Transmitter {
    let array = Array::grid(7, 5, 10e-3).expect("a grid");
    if !full {
        return Transmitter::new(&array, Medium::default(), level).expect("an array");
    }
    let response =
        (0..35).map(|i| if i == 11 { Complex64::ZERO } else { Complex64::cis(f64::from(i % 4)) }).collect();
    let transducer = Transducer { directivity: Directivity::Piston(4.5e-3), ..Transducer::default() };
    let array = array.with_transducer(transducer).and_then(|array| array.with_response(Some(response)));
    let medium = Medium { absorption: 0.15, ..Medium::default() };
    Transmitter::new(&array.expect("an array"), medium, level).expect("an array")
}

/// The bits of complex numbers, which tell -0 from +0.
fn bits(list: &[Complex32]) -> Vec<[u32; 2]> {
    list.iter().map(|z| [z.re.to_bits(), z.im.to_bits()]).collect()
}

/// Holds batches of every size up to the number of problems to lone solves, in bits.
fn hold(problems: &[Problem], solver: &(dyn Solve + Sync), balance: bool, what: &str) {
    let lone = |problem: &Problem| {
        midair::solve(problem, solver, balance, &mut Workspace::new(), &mut Control::none())
            .expect("an answer")
    };
    let lone: Vec<Solution> = problems.iter().map(lone).collect();
    let points = problems[0].pressures().len();
    for count in 1..=problems.len() {
        let mut drives = vec![Complex32::ZERO; count * lone[0].drive.len()];
        let make = |k: usize| Ok(problems[k].clone());
        let batch = solve_batch(count, points, &make, solver, balance, &mut drives, &mut Control::none())
            .expect("answers");
        for (k, lone) in lone[..count].iter().enumerate() {
            let drive = &drives[k * lone.drive.len()..(k + 1) * lone.drive.len()];
            assert_eq!(bits(&lone.drive), bits(drive), "{what}: drive {k} of {count}");
            let pressures = &batch.pressures[k * points..(k + 1) * points];
            assert_eq!(bits(&lone.pressures), bits(pressures), "{what}: pressures {k} of {count}");
            assert_eq!(
                (lone.metrics(), lone.status, lone.steps, lone.scale.to_bits()),
                (batch.metrics[k], batch.status[k], batch.steps[k], batch.scale[k].to_bits()),
                "{what}: {k} of {count}"
            );
        }
    }
}

/// `count` problems of `points` points at random places and pressures.
fn some(transmitter: &Transmitter, points: usize, count: usize, given: bool) -> Vec<Problem> {
    let problem = |k: usize| {
        let mut rng = Rng::new((100 * points + k) as u64);
        // From 0, a quiet point, to more than the array can give.
        let pressures =
            given.then(|| (0..points).map(|j| 2e3 * ((j + 1) % 3) as f64 * rng.uniform()).collect());
        let gains = transmitter.gains(&random_points(points, 0.05, k as u64))?;
        Problem::with_gains(gains, &Request { pressures, weights: None })
    };
    (0..count).map(|k| problem(k).expect("a problem")).collect()
}

/// Options that problems in lanes are solved with, and some that go one by one.
fn with_options() -> Vec<(String, Box<dyn Solve + Send + Sync>)> {
    use solvers::{Fast, Greedy, Objective, Order};
    let coarse = Greedy { phases: 10, amplitudes: 3, order: Order::Rows, ..Greedy::default() };
    let most = Greedy { phases: 51, amplitudes: 5, seed: 3, ..Greedy::default() };
    let fine = Greedy { phases: 64, ..Greedy::default() };
    let absolute = Greedy { objective: Objective::L1, ..Greedy::default() };
    let swept = Fast { block: 3, sweeps: 2, seed: 5 };
    let named = |solver: Greedy| (format!("{solver:?}"), Box::new(solver) as Box<dyn Solve + Send + Sync>);
    let mut list: Vec<_> = [Greedy::default(), coarse, most, fine, absolute].map(named).into();
    list.extend([Fast::default(), swept].map(|solver| (format!("{solver:?}"), Box::new(solver) as _)));
    list
}

#[test]
fn problems_in_lanes_are_lone_solves_bit_for_bit() {
    for (name, solver) in with_options() {
        for level in Level::all() {
            for full in [false, true] {
                let transmitter = small(full, level);
                for points in [1, 2, 3, 4, 7, 8, 15, 16] {
                    for (given, balance) in [(true, false), (true, true), (false, true)] {
                        let problems = some(&transmitter, points, 33, given);
                        let what = format!("{name} {level} {full} M={points} {given} {balance}");
                        hold(&problems, &*solver, balance, &what);
                    }
                }
            }
        }
    }
}

#[test]
fn problems_of_unlike_sizes_arrays_and_levels_are_lone_solves_bit_for_bit() {
    for (name, solver) in with_options() {
        let transmitter = small(false, Level::best());
        let mut problems: Vec<Problem> = (0..16)
            .map(|k| {
                let weights = (0..M).map(|j| if j < k % M { 0.0 } else { 0.1 + j as f64 }).collect();
                let request = Request { pressures: None, weights: Some(weights) };
                let gains = transmitter.gains(&random_points(M, 0.05, k as u64)).expect("gains");
                Problem::with_gains(gains, &request).expect("a problem")
            })
            .collect();
        hold(&problems, &*solver, true, &format!("{name}, weights of 0"));
        let elsewhere = small(true, Level::best());
        problems[3] = some(&elsewhere, M, 1, true).remove(0);
        hold(&problems, &*solver, true, &format!("{name}, another array"));
        problems[3] = some(&small(false, Level::SCALAR), M, 1, true).remove(0);
        hold(&problems, &*solver, true, &format!("{name}, another level"));
        let matrix = problems[3].gains().matrix().expect("G");
        let matrix: Vec<Complex64> =
            matrix.iter().map(|g| Complex64::new(f64::from(g.re), f64::from(g.im))).collect();
        let gains = Gains::from_matrix(&matrix, M).expect("gains");
        problems[0] = Problem::with_gains(gains, &Request::default()).expect("a problem");
        hold(&problems, &*solver, true, &format!("{name}, a matrix"));
    }
}

#[test]
fn the_device_s_levels_hold_in_a_batch() {
    let array = preset("autd3");
    let transmitter = Transmitter::new(&array, Medium::default(), Level::best()).expect("an array");
    assert!(array.levels().is_some());
    let coarse = solvers::Greedy { phases: 16, amplitudes: 3, ..solvers::Greedy::default() };
    hold(&some(&transmitter, 3, 17, true), &solvers::Fast::default(), true, "fast");
    hold(&some(&transmitter, 3, 17, true), &coarse, false, "greedy");
}
