//! Tests that batches and sessions give the same bits as single solves.

use std::sync::Arc;

use midair::{
    Aim, Array, Batch, Complex32, Complex64, Control, Directivity, Error, InstructionSet, Medium, Model, Problem,
    Request, Rng, Session, Setup, Solution, Solve, SolveRequest, Start, Status, Transducer, Workspace, solvers,
};

use crate::scenes::{preset, random_points};

type Solver = Arc<dyn Solve + Send + Sync>;

const B: usize = 37;
const M: usize = 5;

fn model() -> Model {
    Model::new(&preset("paper20"), Medium::default(), InstructionSet::best()).expect("an array")
}

/// Returns the request of problem k; in every third, one point has weight 0.
fn requested(k: usize) -> SolveRequest {
    let mut rng = Rng::new(k as u64);
    let pressures = (0..M).map(|_| 0.2 + rng.uniform()).collect();
    let weights = (k % 3 == 2).then(|| (0..M).map(|j| if j == k % M { 0.0 } else { 1.0 }).collect());
    let request = Request { pressures: Some(pressures), weights, ..Request::default() };
    SolveRequest { points: random_points(M, 0.1, k as u64), request, start: None, aim: None }
}

/// Returns the problem of a single request, made without a session.
fn problem(model: &Model, ask: &SolveRequest) -> Problem {
    let propagation = model.propagation(&ask.points).expect("propagation");
    let setup = Setup::of(model.array(), model.medium());
    let mut problem = Problem::with_propagation(propagation, setup, &ask.request).expect("a problem");
    if let Some(start) = &ask.start {
        problem = problem.with_start(start.clone()).expect("a start");
    }
    if let Some(aim) = ask.aim { problem.with_aim(aim) } else { problem }
}

fn alone(problem: &Problem, solver: &dyn Solve, balance: bool) -> Solution {
    midair::solve(problem, solver, balance, &mut Workspace::new(), &mut Control::none()).expect("an answer")
}

/// Solves a batch of these requests. Returns the drives and the other results.
fn batch_of(
    model: &Model,
    asks: &[SolveRequest],
    solver: &Solver,
    balance: bool,
) -> Result<(Vec<Complex32>, Batch), Error> {
    let mut drives = vec![Complex32::ZERO; asks.len() * model.array().len()];
    let ask = |k: usize, ask: &mut SolveRequest| {
        ask.clone_from(&asks[k]);
        Ok(())
    };
    let points = asks[0].points.len();
    let control = &mut Control::none().with_threads(3);
    let mut session = Session::new(model.clone(), Arc::clone(solver), balance);
    let batch = session.solve_batch(asks.len(), points, &ask, &mut drives, control)?;
    Ok((drives, batch))
}

#[test]
#[ignore = "slow"]
fn a_batch_and_a_session_are_single_solves_bit_for_bit() {
    let model = model();
    for entry in solvers::SOLVERS {
        let solver: Solver = entry.configure(&midair::Options::new()).expect("defaults").solver.into();
        let balance = entry.info.balance;
        let asks: Vec<SolveRequest> = (0..B).map(requested).collect();
        let (drives, batch) = batch_of(&model, &asks, &solver, balance).expect("answers");
        let mut session = Session::new(model.clone(), Arc::clone(&solver), balance);
        for (k, ask) in asks.iter().enumerate() {
            let single = alone(&problem(&model, ask), &*solver, balance);
            let name = entry.info.name;
            assert_eq!(single.drive, drives[k * 400..(k + 1) * 400], "{name}: drive of problem {k}");
            assert_eq!(single.pressures, batch.pressures[k * M..(k + 1) * M], "{name}: pressures of {k}");
            assert_eq!(
                (single.metrics(), single.status, single.steps),
                (batch.metrics[k], batch.status[k], batch.steps[k])
            );
            // A solver with a memory of its last frame must not continue from it.
            session.last().clear();
            let again = session.solve(ask, &mut Control::none()).expect("an answer");
            assert_eq!((&single.drive, &single.pressures), (&again.drive, &again.pressures), "{name}: session at {k}");
        }
    }
}

#[test]
fn a_bad_problem_is_named_and_a_stop_keeps_what_is_done() {
    let model = model();
    let solver: Solver = Arc::new(solvers::Fast::default());
    let refused = |spoil: &dyn Fn(usize, &mut SolveRequest)| {
        let mut asks: Vec<SolveRequest> = (0..B).map(requested).collect();
        asks.iter_mut().enumerate().for_each(|(k, ask)| spoil(k, ask));
        batch_of(&model, &asks, &solver, false).expect_err("refused").to_string()
    };
    // Errors are found at three stages: reading the points, summing |G|, comparing with the reach. The problem with the lowest
    // index is named.
    let far = |ask: &mut SolveRequest| ask.points[0][1] = f64::NAN;
    let near = |ask: &mut SolveRequest| ask.points[2] = model.array().positions()[0];
    let loud = |ask: &mut SolveRequest| ask.request.pressures.as_mut().expect("pressures")[1] = 1e200;
    let reported = refused(&|k, ask| {
        if k == 7 || k == 30 {
            far(ask);
        }
    });
    assert!(reported.starts_with("problems[7]: points[0].position is [") && reported.contains("NaN"), "{reported}");
    let reported = refused(&|k, ask| match k {
        5 => near(ask),
        6 => loud(ask),
        7 => far(ask),
        _ => (),
    });
    assert!(reported.starts_with("problems[5]: points[2] "), "{reported}");
    let reported = refused(&|k, ask| match k {
        4 => loud(ask),
        5 => near(ask),
        _ => (),
    });
    assert!(reported.starts_with("problems[4]: points[1].pressure is 1e200"), "{reported}");
    let reported = refused(&|k, ask| {
        if k == 3 {
            ask.points.truncate(2);
        }
    });
    assert_eq!(reported, "problems[3]: points is 2 of them: give 5 as all problems of the batch have");
    let mut calls = 0;
    let mut stop = |_: midair::Progress<'_>| {
        calls += 1;
        std::ops::ControlFlow::Break(())
    };
    let ask = |k: usize, ask: &mut SolveRequest| {
        ask.clone_from(&requested(k));
        Ok(())
    };
    // More problems than any machine solves before it checks whether to stop.
    let count = 2000;
    let batch = Session::new(model, solver, false).solve_batch(
        count,
        M,
        &ask,
        &mut vec![Complex32::ZERO; 400 * count],
        &mut Control::watched(&mut stop).with_threads(2),
    );
    let batch = batch.expect("what is done");
    assert_eq!(calls, 1);
    let done = batch.status.iter().filter(|status| **status != Status::Stopped).count();
    assert!(done > 0 && done < count && batch.status[..done].iter().all(|status| *status != Status::Stopped));
    assert!(batch.pressures[done * M..].iter().all(|p| p.norm() == 0.0));
}

/// Returns a model of a 7 x 5 array, so that the last group of lanes is not full. If `full`, it has responses, a
/// directivity and absorption.
fn small(full: bool, set: InstructionSet) -> Model {
    let array = Array::grid(7, 5, 10e-3).expect("a grid");
    if !full {
        return Model::new(&array, Medium::default(), set).expect("an array");
    }
    let response = (0..35).map(|i| if i == 11 { Complex64::ZERO } else { Complex64::cis(f64::from(i % 4)) }).collect();
    let transducer = Transducer { directivity: Directivity::piston(4.5e-3), ..Transducer::default() };
    let array = array.with_transducer(transducer).and_then(|array| array.with_response(Some(response)));
    let medium = Medium { absorption: 0.15, ..Medium::default() };
    Model::new(&array.expect("an array"), medium, set).expect("an array")
}

/// The bits of complex numbers, which distinguish -0 from +0.
fn bits(list: &[Complex32]) -> Vec<[u32; 2]> {
    list.iter().map(|z| [z.re.to_bits(), z.im.to_bits()]).collect()
}

/// Compares batches of every size up to the number of requests with single solves, bit by bit.
fn hold(model: &Model, asks: &[SolveRequest], solver: &Solver, balance: bool, what: &str) {
    let single: Vec<Solution> = asks.iter().map(|ask| alone(&problem(model, ask), &**solver, balance)).collect();
    let points = asks[0].points.len();
    for count in 1..=asks.len() {
        let (drives, batch) = batch_of(model, &asks[..count], solver, balance).expect("answers");
        for (k, single) in single[..count].iter().enumerate() {
            let drive = &drives[k * single.drive.len()..(k + 1) * single.drive.len()];
            assert_eq!(bits(&single.drive), bits(drive), "{what}: drive {k} of {count}");
            let pressures = &batch.pressures[k * points..(k + 1) * points];
            assert_eq!(bits(&single.pressures), bits(pressures), "{what}: pressures {k} of {count}");
            assert_eq!(
                (single.metrics(), single.status, single.steps, single.scale.to_bits()),
                (batch.metrics[k], batch.status[k], batch.steps[k], batch.scale[k].to_bits()),
                "{what}: {k} of {count}"
            );
        }
    }
}

/// Returns `count` requests of `points` points at random places, with random pressures if `given`.
fn some(points: usize, count: usize, given: bool) -> Vec<SolveRequest> {
    let ask = |k: usize| {
        let mut rng = Rng::new((100 * points + k) as u64);
        // The targets are 0 at quiet points; others exceed what the array can give.
        let pressures = given.then(|| (0..points).map(|j| 2e3 * ((j + 1) % 3) as f64 * rng.uniform()).collect());
        let request = Request { pressures, ..Request::default() };
        SolveRequest { points: random_points(points, 0.05, k as u64), request, start: None, aim: None }
    };
    (0..count).map(ask).collect()
}

/// Options with which several problems are solved together in lanes, and some with which they are solved one by one.
fn with_options() -> Vec<(String, Solver)> {
    use solvers::{Fast, Greedy, Objective, Order};
    let coarse = Greedy { phases: 10, amplitudes: 3, order: Order::Columns, ..Greedy::default() };
    let most = Greedy { phases: 51, amplitudes: 5, seed: 3, ..Greedy::default() };
    let fine = Greedy { phases: 64, ..Greedy::default() };
    let absolute = Greedy { objective: Objective::L1, ..Greedy::default() };
    let swept = Fast { block: 3, sweeps: 2, seed: 5 };
    let named = |solver: Greedy| (format!("{solver:?}"), Arc::new(solver) as Solver);
    let mut list: Vec<_> = [Greedy::default(), coarse, most, fine, absolute].map(named).into();
    list.extend([Fast::default(), swept].map(|solver| (format!("{solver:?}"), Arc::new(solver) as Solver)));
    list
}

#[test]
#[ignore = "slow"]
fn problems_in_lanes_are_single_solves_bit_for_bit() {
    hold_in_lanes(&[2, 7, 15]);
}

#[test]
#[ignore = "slow"]
fn other_numbers_of_points_in_lanes_are_single_solves_at_length() {
    hold_in_lanes(&[1, 3, 4, 8, 16]);
}

fn hold_in_lanes(counts: &[usize]) {
    for (name, solver) in with_options() {
        for set in InstructionSet::all() {
            for full in [false, true] {
                let model = small(full, set);
                for &points in counts {
                    for (given, balance) in [(true, false), (true, true), (false, true)] {
                        let what = format!("{name} {set} {full} M={points} {given} {balance}");
                        hold(&model, &some(points, 33, given), &solver, balance, &what);
                    }
                }
            }
        }
    }
}

#[test]
fn problems_of_unlike_sizes_are_single_solves_bit_for_bit() {
    let ask = |k: usize| {
        let weights = (0..M).map(|j| if j < k % M { 0.0 } else { 0.1 + j as f64 }).collect();
        let request = Request { weights: Some(weights), ..Request::default() };
        SolveRequest { points: random_points(M, 0.05, k as u64), request, start: None, aim: None }
    };
    let asks: Vec<SolveRequest> = (0..16).map(ask).collect();
    for (name, solver) in with_options() {
        hold(&small(false, InstructionSet::best()), &asks, &solver, true, &format!("{name}, weights of 0"));
    }
}

#[test]
fn a_problem_keeps_nothing_of_the_one_before() {
    let mut asks = some(3, 40, true);
    for (k, ask) in asks.iter_mut().enumerate() {
        ask.start = (k % 4 == 1).then(|| Start::Phases(vec![0.1 * k as f64; 3]));
        ask.aim = (k % 5 == 2).then_some(Aim::Max);
        ask.request.weights = (k % 7 == 3).then(|| vec![0.0, 1.0, 0.5]);
        if k % 3 == 2 {
            ask.request.pressures = None;
        }
    }
    let model = small(true, InstructionSet::best());
    for name in ["fast", "gs", "uniform"] {
        let made = solvers::find(name).and_then(|entry| entry.configure(&midair::Options::new()));
        hold(&model, &asks, &made.expect("a method").solver.into(), true, name);
    }
}

#[test]
fn the_board_s_quantization_holds_in_a_batch() {
    let array = preset("autd3");
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("an array");
    assert!(array.quantization().is_some());
    let coarse = solvers::Greedy { phases: 16, amplitudes: 3, ..solvers::Greedy::default() };
    hold(&model, &some(3, 17, true), &(Arc::new(solvers::Fast::default()) as Solver), true, "fast");
    hold(&model, &some(3, 17, true), &(Arc::new(coarse) as Solver), false, "greedy");
}
