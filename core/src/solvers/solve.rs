//! The entry point: balance, solve, round to the board, report.

use crate::solvers::prelude::*;
use crate::solvers::{Last, batching};

/// The largest |q|^2, including rounding; it also limits [`crate::Start::Drive`].
const MOST_POWER: f32 = 1.0 + 2e-6;

/// Solves a problem, and balances it first if `balance` is true.
///
/// Balancing multiplies the targets by [`Problem::balance`] if that is above 1, and divides the drives of the solution
/// again, as far as that lowers them. It is the cure of the paper's section V for foci much weaker than the array can
/// make, which become blurred. Metrics, trace and progress refer to the final drive and the caller's targets.
///
/// If the array has a [`crate::Quantization`], every drive of the solution is rounded to its nearest phase and
/// amplitude. Balancing then reduces to the nearest amplitude. If that is below the least amplitude above 0, the drives
/// get that least one, and [`Solution::scale`] is the factor that supply voltage or modulation must provide.
///
/// If several transducers share a channel ([`crate::Array::with_channels`]), a solver uses one column of G for each
/// channel, and the solution has the channel's drive at each of them.
///
/// A stop before the solver's first result gives a drive of 0 and the status [`crate::Status::Stopped`].
///
/// # Errors
/// Errors of the solver; a drive that is not finite or above 1.
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
) -> Result<Solution> {
    solve_after(problem, solver, balance, None, work, control)
}

/// Does the same as [`solve`] for the frame that follows `last`, if the solver depends on the last frame.
pub(crate) fn solve_after(
    problem: &Problem,
    solver: &dyn Solve,
    balance: bool,
    last: Option<&mut Last>,
    work: &mut Workspace,
    control: &mut Control,
) -> Result<Solution> {
    let factor = factor(problem, solver, balance);
    let prepared = problem.prepared(factor, work);
    let own = prepared.as_ref().unwrap_or(problem);
    let solution = match last {
        Some(last) => solver.follow(own, last, work, control),
        None => solver.solve(own, work, control),
    };
    if let Some(prepared) = prepared {
        prepared.recycle(work);
    }
    let quantized = |solution: Solution| quantized(solution, factor, work, control);
    match solution.and_then(quantized) {
        Err(error) if error.is_stop() => Ok(Solution::silent(problem, work).spread()),
        Ok(mut solution) => {
            judge(problem, solver, &mut solution);
            Ok(solution.spread())
        }
        error => error,
    }
}

/// Sets the status of a solution that misses its targets. A method that does not continue until they are met keeps
/// [`Status::OutOfSteps`], which says that another number of steps gives another answer.
fn judge(problem: &Problem, solver: &dyn Solve, solution: &mut Solution) {
    let ended = solver.meets_targets() || solution.status == Status::Done;
    if ended && problem.missed(solver.quiet(), solution).is_some() {
        solution.status = Status::Missed;
    }
}

/// Rounds a solution to the device's grid, and undoes balancing.
fn quantized(mut solution: Solution, factor: f64, work: &Workspace, control: &mut Control) -> Result<Solution> {
    check(&solution)?;
    let excess = excess(&solution, factor);
    if solution.quantize(excess, work, control)? || excess != factor {
        control.correct(|| solution.metrics().residual);
    }
    Ok(solution)
}

/// Does the same as [`solve`] for several problems at once; returns `None` if the solver cannot do that or if a problem
/// is out of f32's range.
pub(crate) fn solve_interleaved(
    problems: &[Problem],
    solver: &dyn Solve,
    balance: bool,
    work: &mut Workspace,
) -> Result<Option<Vec<Solution>>, (usize, Error)> {
    if solver.interleaved().is_none() {
        return Ok(None);
    }
    let factor = |problem: &Problem| factor(problem, solver, balance);
    if !problems.iter().all(|problem| problem.is_within(factor(problem))) {
        return Ok(None);
    }
    let rescaled = || problems.iter().map(|problem| problem.rescaled(factor(problem), work)).collect();
    let balanced: Option<Vec<Problem>> = problems.iter().any(|problem| factor(problem) > 1.0).then(rescaled);
    let mut solutions = batching::solve(solver, balanced.as_deref().unwrap_or(problems), work);
    for (k, (solution, problem)) in solutions.iter_mut().flatten().zip(problems).enumerate() {
        let at = |error| (k, error);
        check(solution).map_err(at)?;
        solution.quantize(excess(solution, factor(problem)), work, &mut Control::none()).map_err(at)?;
        judge(problem, solver, solution);
    }
    balanced.into_iter().flatten().for_each(|problem| problem.recycle(work));
    Ok(solutions)
}

/// Returns the level of a solution of balanced targets relative to its targets, at least 1: the divisor of its drives.
/// The divisor is rounded to 12 binary digits, which do not depend on the unit of the pressures.
fn excess(solution: &Solution, factor: f64) -> f64 {
    let level = if factor > 1.0 { solution.metrics().level } else { 1.0 };
    let digits = ((level as f32).to_bits() + (1 << 10)) & !0x7ff;
    if level.is_finite() { f64::from(f32::from_bits(digits)).max(1.0) } else { factor }
}

/// Checks a solution; returns an error if no array can play it.
fn check(solution: &Solution) -> Result<()> {
    // The loop tests all drives instead of ending at the first unfit drive: it then has no branch. The comparison is
    // false for NaN.
    let fine = |fine, q: &Complex32| fine & (q.norm_sqr() <= MOST_POWER);
    if solution.drive.iter().fold(true, fine) {
        return Ok(());
    }
    let unfit = solution.drive.iter().position(|q| !fine(true, q)).unwrap_or_default();
    let q = solution.drive[unfit];
    if q.is_finite() {
        return Err(Error::out_of_range(format!("drive[{unfit}]"), q, "a solver's drives have a modulus of at most 1"));
    }
    Err(Error::lost())
}

/// Returns the factor of the targets before solving.
fn factor(problem: &Problem, solver: &dyn Solve, balance: bool) -> f64 {
    if balance && !solver.finds_level() { problem.balance().max(1.0) } else { 1.0 }
}
