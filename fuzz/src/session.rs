//! Tests requests of changing sizes in one session, and as a batch: each result has the same bits as a single solve.

use std::sync::Arc;

use crate::{Allowed, Draw, one_line};
use midair::{
    Complex32, Control, Error, InstructionSet, Model, Problem, Session, Setup, Solution, Solve, SolveRequest, Workspace,
};

type Solver = Arc<dyn Solve + Send + Sync>;

/// Runs the test that the bytes describe.
pub fn check(bytes: &[u8]) {
    one_line(run(&mut Draw::new(bytes)));
}

fn run(draw: &mut Draw) -> Result<(), Error> {
    let model = Model::new(&draw.array()?, draw.medium()?, InstructionSet::best())?;
    let transducers = model.array().len();
    let configured = draw.solver(model.array().quantization(), transducers)?;
    let (solver, balance): (Solver, bool) = (configured.solver.into(), draw.flag());
    let asks: Vec<SolveRequest> = (0..6).map_while(|_| draw.more().then(|| ask(draw, transducers))).collect();
    let mut session = Session::new(model.clone(), Arc::clone(&solver), balance);
    for ask in &asks {
        let single = alone(&model, ask, &*solver, balance);
        if !session.last().is_empty() {
            // A solver with a memory continues from its last frame; after it is cleared, it starts like a single solve.
            if let (Ok(next), Ok((problem, _))) = (session.solve(ask, &mut Control::none()), &single) {
                let allowed = Allowed::of(model.array(), model.medium(), &ask.points);
                allowed.check(problem, &model.propagation(&ask.points)?, next, configured.info.name);
            }
            session.last().clear();
        }
        match (session.solve(ask, &mut Control::none()), single) {
            (Ok(found), Ok((problem, single))) => {
                let allowed = Allowed::of(model.array(), model.medium(), &ask.points);
                allowed.check(&problem, &model.propagation(&ask.points)?, &single, configured.info.name);
                assert_eq!((&found.drive, &found.pressures), (&single.drive, &single.pressures));
                assert_eq!(
                    (found.metrics(), found.status, found.steps),
                    (single.metrics(), single.status, single.steps)
                );
                assert_eq!(found.scale, single.scale);
            }
            // If a request has two errors, a session reports the error of the start, a single problem the error of the points.
            (Err(_), Err(_)) if ask.start.is_some() => {}
            (found, single) => assert_eq!(found.err(), single.err()),
        }
    }
    if let Some(size) = asks.first().map(|ask| ask.points.len()) {
        let asks: Vec<SolveRequest> = asks.into_iter().filter(|ask| ask.points.len() == size).collect();
        batch(&model, &asks, &solver, balance);
    }
    Ok(())
}

/// Solves a batch of many requests of the same size, so that some groups of SIMD lanes are full and one is not.
fn batch(model: &Model, asks: &[SolveRequest], solver: &Solver, balance: bool) {
    let (count, size, transducers) = (asks.len() * 7, asks[0].points.len(), model.array().len());
    let mut drives = vec![Complex32::ZERO; count * transducers];
    let read = |k: usize, ask: &mut SolveRequest| {
        ask.clone_from(&asks[k % asks.len()]);
        Ok(())
    };
    let mut session = Session::new(model.clone(), Arc::clone(solver), balance);
    let batch = session.solve_batch(count, size, &read, &mut drives, &mut Control::none());
    let single: Result<Vec<_>, (usize, Error)> = asks
        .iter()
        .enumerate()
        .map(|(k, ask)| alone(model, ask, &**solver, balance).map_err(|error| (k, error)))
        .collect();
    match (batch, single) {
        (Ok(batch), Ok(single)) => {
            for k in 0..count {
                let one = &single[k % asks.len()].1;
                assert_eq!(one.drive, drives[k * transducers..(k + 1) * transducers], "problem {k}");
                assert_eq!(one.pressures, batch.pressures[k * size..(k + 1) * size], "problem {k}");
                assert_eq!((one.metrics(), one.scale), (batch.metrics[k], batch.scale[k]), "problem {k}");
                assert_eq!((one.status, one.steps), (batch.status[k], batch.steps[k]), "problem {k}");
            }
        }
        (Err(error), Err((first, _))) if asks[first].start.is_some() => assert_eq!(error.index, Some(first)),
        (batch, single) => {
            let named = single.err().map(|(index, error)| error.of_one("problems", index));
            assert_eq!(batch.err(), named);
        }
    }
}

fn ask(draw: &mut Draw, transducers: usize) -> SolveRequest {
    let points = draw.points(20);
    let request = draw.request(points.len());
    let start = draw.maybe(|draw| draw.start(transducers, points.len()));
    SolveRequest { points, request, start, aim: draw.maybe(Draw::aim) }
}

/// Solves the same request without a session.
fn alone(model: &Model, ask: &SolveRequest, solver: &dyn Solve, balance: bool) -> Result<(Problem, Solution), Error> {
    let setup = Setup::of_model(model);
    let mut problem = Problem::with_propagation(model.propagation(&ask.points)?, setup, &ask.request)?;
    if let Some(start) = &ask.start {
        problem = problem.with_start(start.clone())?;
    }
    if let Some(aim) = ask.aim {
        problem = problem.with_aim(aim);
    }
    let solution = midair::solve(&problem, solver, balance, &mut Workspace::new(), &mut Control::none())?;
    Ok((problem, solution))
}
