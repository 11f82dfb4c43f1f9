//! The entry point: balance, solve, round to the board, report.

use alloc::vec::Vec;

use crate::control::Control;
use crate::error::Error;
use crate::problem::{Problem, Solution};
use crate::solvers::method::Solve;
use crate::workspace::Workspace;

/// Solves a problem, balancing it first if asked to.
///
/// Balancing multiplies the targets by [`Problem::balance`] when that is above 1, and divides the drives by it
/// afterwards: the cure of the paper's section V, where foci much weaker than the array can make come out
/// smeared. Metrics, trace and progress speak of the final drive and the caller's targets.
///
/// Where the array has [`crate::Quantization`], every drive of the answer lies on them, rounded to the nearest phase and
/// amplitude. Balancing then reduces to the nearest amplitude; where that would be below the least one above 0, the
/// drives are brought there and [`Solution::scale`] says what is left to supply or modulation.
///
/// A stop that comes before the solver has anything leaves a drive of 0 and the status [`crate::Status::Stopped`].
///
/// # Errors
/// What the solver refuses.
///
/// ```
/// use midair::{Array, Control, Medium, Problem, Request, Scene, Workspace, solvers};
///
/// let points = vec![[-0.02, 0.0, 0.15], [0.02, 0.0, 0.15]];
/// let scene = Scene::new(Array::grid(20, 20, 10e-3)?, Medium::default(), points, Request::default())?;
/// let greedy = solvers::find("greedy")?.configure(&[("seed".into(), midair::Value::Integer(1))].into())?;
/// let problem = Problem::new(&scene)?;
/// let solution = midair::solve(&problem, &*greedy.solver, false, &mut Workspace::new(), &mut Control::none())?;
/// assert!(solution.metrics().accuracy > 0.8);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn solve(
    problem: &Problem,
    solver: &dyn Solve,
    balance: bool,
    work: &mut Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    let factor = factor(problem, solver, balance);
    let solution = if factor > 1.0 {
        let balanced = problem.rescaled(factor, work);
        let solution = solver.solve(&balanced, work, control);
        balanced.recycle(work);
        solution
    } else {
        solver.solve(problem, work, control)
    };
    let quantized = |solution: Solution| quantized(solution, factor, work, control);
    match solution.and_then(quantized) {
        Err(Error::Stopped) => Ok(Solution::silent(problem, work)),
        solution => solution,
    }
}

/// The answer on the device's grid, balancing undone.
fn quantized(mut solution: Solution, factor: f64, work: &Workspace, control: &mut Control) -> Result<Solution, Error> {
    if solution.quantize(factor, work, control)? {
        control.correct(|| solution.metrics().residual);
    }
    Ok(solution)
}

/// As [`solve`], several problems at once, where the solver knows how.
pub(crate) fn solve_interleaved(
    problems: &[Problem],
    solver: &dyn Solve,
    balance: bool,
    work: &mut Workspace,
) -> Option<Vec<Solution>> {
    let factor = |problem: &Problem| factor(problem, solver, balance);
    let rescaled = || problems.iter().map(|problem| problem.rescaled(factor(problem), work)).collect();
    let balanced: Option<Vec<Problem>> = problems.iter().any(|problem| factor(problem) > 1.0).then(rescaled);
    let mut solutions = solver.solve_interleaved(balanced.as_deref().unwrap_or(problems), work);
    for (solution, problem) in solutions.iter_mut().flatten().zip(problems) {
        solution.quantize(factor(problem), work, &mut Control::none()).ok()?;
    }
    balanced.into_iter().flatten().for_each(|problem| problem.recycle(work));
    solutions
}

/// What the targets are multiplied by before solving, and the answer divided by afterwards.
fn factor(problem: &Problem, solver: &dyn Solve, balance: bool) -> f64 {
    if balance && !solver.finds_level() { problem.balance().max(1.0) } else { 1.0 }
}
