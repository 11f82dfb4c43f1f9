//! Batches and sessions: every answer bit for bit that of a lone solve.

use midair::{
    Control, Error, Level, Medium, Problem, Request, Rng, Session, Status, Transmitter, Workspace,
    solve_batch, solvers,
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
