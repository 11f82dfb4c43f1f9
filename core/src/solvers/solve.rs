//! The entry point: balance, solve, round to the board, report.

use alloc::format;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::problem::{Problem, Solution, Status};
use crate::solvers::batching;
use crate::solvers::last::Last;
use crate::solvers::method::Solve;
use crate::workspace::Workspace;

/// The largest |q|^2, with rounding; it also limits [`crate::Start::Drive`].
const MOST_POWER: f32 = 1.0 + 2e-6;

/// Solves a problem, balancing it first on request.
///
/// Balancing multiplies the targets by [`Problem::balance`] when that is above 1, and brings the drives down to the targets
/// afterwards, as far as that is down: the cure of the paper's section V, where foci much weaker than the array can make
/// come out smeared. Metrics, trace and progress speak of the final drive and the caller's targets.
///
/// Where the array has [`crate::Quantization`], every drive of the answer lies on them, rounded to the nearest phase and
/// amplitude. Balancing then reduces to the nearest amplitude; where that would be below the least one above 0, the
/// drives are brought there and [`Solution::scale`] says what is left to supply or modulation.
///
/// Where several transducers are on one channel ([`crate::Array::with_channels`]), a solver sees one column of each channel, and
/// the answer has its drive at each of them.
///
/// A stop that comes before the solver has anything leaves a drive of 0 and the status [`crate::Status::Stopped`].
///
/// # Errors
/// What the solver refuses; a drive that is not finite or above 1.
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
    solve_after(problem, solver, balance, None, work, control)
}

/// As [`solve`], of the frame after the last for a solver that remembers that.
pub(crate) fn solve_after(
    problem: &Problem,
    solver: &dyn Solve,
    balance: bool,
    last: Option<&mut Last>,
    work: &mut Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
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
        Err(Error::Stopped) => Ok(Solution::silent(problem, work).spread()),
        Ok(mut solution) => {
            if problem.missed(solver.meets_targets(), solver.quiet(), &solution).is_some() {
                solution.status = Status::Missed;
            }
            Ok(solution.spread())
        }
        error => error,
    }
}

/// The answer on the device's grid, balancing undone.
fn quantized(mut solution: Solution, factor: f64, work: &Workspace, control: &mut Control) -> Result<Solution, Error> {
    check(&solution)?;
    let excess = excess(&solution, factor);
    if solution.quantize(excess, work, control)? || excess != factor {
        control.correct(|| solution.metrics().residual);
    }
    Ok(solution)
}

/// As [`solve`], several problems at once, where the solver knows how and none of them is out of f32's range.
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
    }
    balanced.into_iter().flatten().for_each(|problem| problem.recycle(work));
    Ok(solutions)
}

/// How many times as loud as its targets an answer to balanced targets is, at least 1: what its drives are divided by. In 12 binary
/// digits, which do not depend on the unit of the pressures.
fn excess(solution: &Solution, factor: f64) -> f64 {
    let level = if factor > 1.0 { solution.metrics().level } else { 1.0 };
    let digits = ((level as f32).to_bits() + (1 << 10)) & !0x7ff;
    if level.is_finite() { f64::from(f32::from_bits(digits)).max(1.0) } else { factor }
}

/// Refuses an answer that no array can play.
fn check(solution: &Solution) -> Result<(), Error> {
    // Compares all of them, so that the loop has no branch; a NaN is not below either.
    let fine = |fine, q: &Complex32| fine & (q.norm_sqr() <= MOST_POWER);
    if solution.drive.iter().fold(true, fine) {
        return Ok(());
    }
    let unfit = solution.drive.iter().position(|q| !fine(true, q)).unwrap_or_default();
    let q = solution.drive[unfit];
    if q.is_finite() {
        return Err(Error::invalid(format!("drive[{unfit}]"), q, "a solver's drives have a modulus of at most 1"));
    }
    Err(Error::lost())
}

/// The factor of the targets before solving.
fn factor(problem: &Problem, solver: &dyn Solve, balance: bool) -> f64 {
    if balance && !solver.finds_level() { problem.balance().max(1.0) } else { 1.0 }
}
