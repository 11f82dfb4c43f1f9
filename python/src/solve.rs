//! `midair.solve`.

use std::sync::Arc;
use std::time::Instant;

use midair::solvers::{self as registry, Greedy, Method, Remark};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::ctrl_c::attend;
use crate::energy;
use crate::error::{invalid, refused, warn};
use crate::function::Function;
use crate::read;
use crate::ready::Ready;
use crate::solution::{Solution, begin};
use crate::subject::{Beside, Subject};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Find a drive q, |q| <= 1, whose pressures p = G q are near the targets.
///
/// Parameters
/// ----------
/// scene : midair.Scene or midair.Propagation
///     A scene, or a matrix G with the keywords below.
/// solver : str or callable, optional
///     A name of `solvers()`; by default the scene file's, else `uniform`. Or a function: solver(propagation, targets,
///     weights, **options) gets G (M, N) in Pa, targets (M,) in Pa and weights (M,) up to 1, of the points with a
///     weight above 0, and returns a drive (N,) of moduli up to 1.
/// pressures, weights
///     For a matrix, as for `Scene`; for a scene they replace its own.
/// quantization : mapping, optional
///     Steps of the board, as for `Array`.
/// mask : (N,) array_like of bool, optional
///     Transducers that are on.
/// positions : (N, 3) array_like, optional
///     Places of the transducers in m, for a matrix only.
/// balance : bool, optional
///     True solves at the level the array can reach and reduces the drives afterwards; None is the method's default.
/// aim : {"target", "max"}, optional
///     "target" meets the targets, "max" is as loud as possible, for the methods that use it.
/// start : (N,) or (M,) array_like, or midair.Solution, optional
///     A drive (N,), point phases (M,) in rad or a solution, for the methods that use it.
/// progress : callable, optional
///     Called with (step, steps, residual) at every step; False stops with the best drive so far.
/// trace : bool, optional
///     Whether the residuals, eq. (7) relative to silence, are stored: sum w (target - |p|)^2 / sum w target^2.
/// **options
///     Options of the solver; `solvers()` lists them. The option objective of greedy may be a function:
///     objective(pressures, targets, weights) gets the pressures (K, M) in Pa of each of K candidates, and returns the
///     cost of each (K,); greedy takes the lowest, one transducer after another.
///
/// Returns
/// -------
/// midair.Solution
///     The drive, its pressures and its metrics.
///
/// Raises
/// ------
/// SceneError
///     For an unknown solver or option, a wrong value, a point nearer than lambda/100 to a transducer, and a pressure
///     that no transducer reaches. A function's own errors pass through.
/// TypeError
///     If `scene` has another type.
/// MemoryError
///     For more than MIDAIR_MEMORY allows.
///
/// Warns
/// -----
/// SceneWarning
///     If pressures are above the array's reach.
///
/// See Also
/// --------
/// midair.solve_batch : many problems at once.
///
/// midair.Solver : many requests one after another.
///
/// midair.compare : several methods beside each other.
///
/// Examples
/// --------
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
/// >>> solution = midair.solve(scene, "greedy", phases=16, seed=1)
/// >>> solution.drive.shape, solution.status
/// ((400,), 'done')
#[pyfunction]
#[pyo3(signature = (
    scene, solver=None, *, pressures=None, weights=None, quantization=None, mask=None, positions=None, balance=None,
    aim=None, start=None, progress=None, trace=false, **options
))]
#[allow(clippy::too_many_arguments, reason = "Python's keywords")]
pub(crate) fn solve(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    solver: Argument<'_, '_>,
    pressures: Argument<'_, '_>,
    weights: Argument<'_, '_>,
    quantization: Argument<'_, '_>,
    mask: Argument<'_, '_>,
    positions: Argument<'_, '_>,
    balance: Argument<'_, '_>,
    aim: Argument<'_, '_>,
    start: Argument<'_, '_>,
    progress: Option<Py<PyAny>>,
    trace: bool,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Solution> {
    let subject = Subject::read(scene, Beside { pressures, weights, quantization, mask, positions })?;
    let function = solver.map(|solver| Function::read(solver, options)).transpose()?.flatten();
    let (energy, options) = if function.is_some() { (None, None) } else { energy::Function::take(options)? };
    let raised = function.as_ref().map(Function::raised).or(energy.as_ref().map(energy::Function::raised));
    let mut choice = match &function {
        Some(function) => function.choice(py)?,
        None => read::chosen(subject.choice(), solver, options.as_ref())?,
    };
    read::callback(progress.as_ref().map(|callback| callback.bind(py)), "step, steps, residual")?;
    if let Some(aim) = aim {
        choice.aim = Some(read::aim(aim)?);
    }
    let configured = match function {
        Some(function) => function.configured(&choice)?,
        None => registry::configure(&choice, subject.quantization()).map_err(refused)?,
    };
    let configured = match energy {
        Some(_) if configured.info.name != Greedy::INFO.name => {
            return Err(invalid("objective", "a function", "greedy alone takes one: name it, or leave this out"));
        }
        Some(energy) => energy.configured(py, configured.options)?,
        None => configured,
    };
    if start.is_some() && !configured.info.uses_start {
        return Err(refused(registry::unused("start", &choice.name, |info| info.uses_start)));
    }
    if let Some(balance) = balance {
        choice.balance = Some(read::flag("balance", balance)?);
    }
    let balance = choice.balance.unwrap_or(configured.info.balance);
    choice.balance = Some(balance);
    choice.options = configured.options;
    let clock = Instant::now();
    let start = start.map(begin).transpose()?;
    let mut problem = attend(py, None, |mut control| match start {
        None => subject.problem(configured.solver.computes_rows(), &mut control),
        Some(start) => subject.problem(configured.solver.computes_rows(), &mut control)?.with_start(start),
    })?;
    if let Some(aim) = choice.aim {
        problem = problem.with_aim(aim);
    }
    if configured.info.uses_aim {
        choice.aim = Some(problem.aim());
    }
    let weak = Remark::weak(&problem, &*configured.solver, balance);
    for remark in weak.into_iter().chain(Remark::phases_unused(&problem, &*configured.solver)) {
        warn(py, &remark)?;
    }
    let ready = subject.ready();
    let mut work = ready.map(Ready::workspace).unwrap_or_default();
    let answer = attend(py, progress, |control| {
        let mut control = if trace { control.traced() } else { control };
        let solution = midair::solve(&problem, &*configured.solver, balance, &mut work, &mut control)?;
        Ok((solution, control.into_trace()))
    });
    if let Some(ready) = ready {
        ready.keep(work);
    }
    raised.map_or(Ok(()), |raised| raised.check())?;
    let (inner, trace) = answer?;
    let elapsed = clock.elapsed().as_secs_f64();
    let beyond = attend(py, None, |mut control| problem.beyond(&mut control))?;
    let leak = Remark::leak(&problem, &*configured.solver, &inner);
    let missed = Remark::missed(&problem, &*configured.solver, &inner);
    let (scaled, harmonic) = (Remark::scaled(&inner), Remark::harmonic(&problem, &inner));
    for remark in [beyond.map(Remark::Beyond), missed, leak, scaled, harmonic].into_iter().flatten() {
        warn(py, &remark)?;
    }
    Ok(Solution::new(inner, Arc::new(choice), elapsed).of(subject.scene(), trace))
}
