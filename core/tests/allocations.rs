//! Counts allocations: for every registered solver, the second solve of the same size with one workspace has none.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

use midair::{
    Array, Complex32, Control, InstructionSet, Medium, Model, Problem, Quantization, Request, Rng, Scene, Session,
    Solve, SolveRequest, Start, Workspace, solvers,
};

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

#[allow(unsafe_code, reason = "a global allocator cannot be had otherwise; it only counts and passes on")]
// SAFETY: every call is passed on to the system allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's guarantees are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's guarantees are passed on.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn problem(seed: u64, pressure: Option<f64>, quantization: Option<&Quantization>) -> Problem {
    let mut rng = Rng::new(seed);
    let points = (0..11).map(|_| [0.1 * rng.uniform(), 0.1 * rng.uniform(), 0.15]).collect();
    let array = Array::grid(9, 7, 10e-3).expect("a grid").with_quantization(quantization.cloned());
    let request = Request { pressures: pressure.map(|pressure| vec![pressure; 11]), ..Request::default() };
    Problem::new(&Scene::new(array, Medium::default(), points, request).expect("a scene")).expect("a problem")
}

#[test]
fn the_second_solve_of_a_size_allocates_nothing() {
    // The cases: without pressures, and with pressures far below the balanced level. `solve` has different code with and
    // without balancing.
    let board = Quantization::new(Some(32), Some(vec![0.0, 0.25, 1.0])).expect("quantization");
    for (pressure, balance, quantization) in [
        (None, false, None),
        (Some(1.0), true, None),
        (Some(1.0), false, None),
        (None, false, Some(&board)),
        (Some(1.0), true, Some(&board)),
    ] {
        let (first, second) = (problem(1, pressure, quantization), problem(2, pressure, quantization));
        for entry in solvers::SOLVERS {
            let made = entry.configure(&midair::Options::new()).expect("defaults");
            let mut work = Workspace::new();
            let before = COUNT.get();
            let solution = midair::solve(&first, &*made.solver, balance, &mut work, &mut Control::none());
            solution.expect("an answer").recycle(&work);
            assert!(COUNT.get() > before, "the first solve must allocate, or nothing is counted");
            let before = COUNT.get();
            let solution = midair::solve(&second, &*made.solver, balance, &mut work, &mut Control::none());
            let allocations = COUNT.get() - before;
            assert_eq!(allocations, 0, "{} allocates in its second solve", entry.info.name);
            assert!(solution.expect("an answer").drive.iter().any(|q| q.norm() > 0.0));
        }
    }
}

#[test]
fn an_exchange_allocates_nothing_in_its_second_solve() {
    let board = Quantization::new(Some(32), Some(vec![0.0, 0.25, 1.0])).expect("quantization");
    for (quantization, balance) in [(None, false), (Some(&board), false), (Some(&board), true)] {
        let greedy = solvers::Greedy { change: 0.5, ..solvers::Greedy::default() };
        let [first, second] = [1, 2].map(|seed| {
            let start = Start::Drive(vec![Complex32::ONE; 63]);
            problem(seed, balance.then_some(1.0), quantization).with_start(start).expect("a start")
        });
        let mut work = Workspace::new();
        let solution = midair::solve(&first, &greedy, balance, &mut work, &mut Control::none());
        solution.expect("an answer").recycle(&work);
        let before = COUNT.get();
        let solution = midair::solve(&second, &greedy, balance, &mut work, &mut Control::none());
        assert_eq!(COUNT.get() - before, 0, "balance {balance}, {quantization:?}");
        assert!(solution.expect("an answer").drive.iter().any(|q| q.norm() > 0.0));
    }
}

#[test]
fn a_session_allocates_nothing_from_its_second_call_on() {
    let array = Array::grid(9, 7, 10e-3).expect("a grid");
    let mut rng = Rng::new(3);
    for entry in solvers::SOLVERS {
        let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("an array");
        let solver = entry.configure(&midair::Options::new()).expect("defaults").solver;
        let mut session = Session::new(model, solver, entry.info.balance);
        let request = Request { pressures: Some(vec![0.0; 11]), ..Request::default() };
        let mut ask = SolveRequest { request, ..SolveRequest::default() };
        for call in 0..4 {
            let points: [[f64; 3]; 11] = std::array::from_fn(|_| [0.1 * rng.uniform(), 0.1 * rng.uniform(), 0.15]);
            ask.points.clear();
            ask.points.extend(points);
            if let Some(pressures) = &mut ask.request.pressures {
                pressures.fill(100.0 + f64::from(call));
            }
            let before = COUNT.get();
            let solution = session.solve(&ask, &mut Control::none()).expect("an answer");
            assert!(solution.drive.iter().any(|q| q.norm() > 0.0));
            let allocations = COUNT.get() - before;
            // A method may exchange its buffers, so that all of them are allocated only after two calls.
            assert!(call < 2 || allocations == 0, "{}: {allocations} in call {call}", entry.info.name);
        }
    }
}

#[test]
#[ignore = "slow"]
fn a_batch_allocates_nothing_for_a_further_problem() {
    let array = Array::grid(9, 7, 10e-3).expect("a grid");
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("an array");
    for (entry, points) in solvers::SOLVERS.iter().flat_map(|entry| [(entry, 5), (entry, 17)]) {
        let ask = |k: usize, ask: &mut SolveRequest| {
            let mut rng = Rng::new(k as u64);
            ask.points.clear();
            ask.points.extend((0..points).map(|_| [0.1 * rng.uniform(), 0.1 * rng.uniform(), 0.15]));
            Ok(())
        };
        let solver: Arc<dyn Solve + Send + Sync> =
            entry.configure(&midair::Options::new()).expect("defaults").solver.into();
        let allocations = |count: usize| {
            let mut session = Session::new(model.clone(), Arc::clone(&solver), true);
            let (mut drives, none) = (vec![Complex32::ZERO; 63 * count], &mut Control::none());
            let before = COUNT.get();
            session.solve_batch(count, points, &ask, &mut drives, none).expect("answers");
            COUNT.get() - before
        };
        // All problems are one part, which this thread solves. Sixteen problems that are solved together are returned in one
        // vector. A problem that needs steps which no problem before it needed takes their memory, once.
        let (few, many) = (allocations(64), allocations(96));
        let name = entry.info.name;
        assert!(few > 0 && many <= few + 8, "{name}, M = {points}: {few} for 64 problems, {many} for 96");
    }
}
