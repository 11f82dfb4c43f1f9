//! `midair.solve`.

use std::time::Instant;

use midair::solvers::{fallen, remarks};

use crate::chosen::{Chosen, Naming};
use crate::prelude::*;
use crate::solution::{Solution, begin};
use crate::subject::{Beside, Subject};

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
///     If pressures are above the array's reach, and if traps do not hold their beads.
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
    read::callback(progress.as_ref().map(|callback| callback.bind(py)), "step, steps, residual")?;
    let (file, board) = (subject.choice(), subject.quantization());
    let naming = Naming { solver, balance, aim };
    let (chosen, configured, raised) = Chosen::read_with_functions(py, file, board, naming, options)?;
    chosen.check_start(start.is_some())?;
    let (solver, balance) = (&*configured.solver, chosen.balances());
    let clock = Instant::now();
    let start = start.map(begin).transpose()?;
    let problem = attend(py, None, |mut control| {
        let problem = subject.problem(solver.computes_rows(), &mut control)?.with_aim(chosen.choice.aim);
        start.map_or(Ok(problem.clone()), |start| problem.with_start(start))
    })?;
    let mut work = subject.workspace();
    let answer = attend(py, progress, |control| {
        let mut control = if trace { control.traced() } else { control };
        let solution = midair::solve(&problem, solver, balance, &mut work, &mut control)?;
        Ok((solution, control.into_trace()))
    });
    subject.keep(work);
    raised.check()?;
    let (inner, trace) = answer?;
    let elapsed = clock.elapsed().as_secs_f64();
    let (beyond, fallen) =
        attend(py, None, |mut control| Ok((problem.beyond(&mut control)?, fallen(&inner, &mut control)?)))?;
    warn_all(py, remarks(&problem, solver, balance, None, &inner, beyond).into_iter().chain([fallen]).flatten())?;
    Ok(Solution::new(inner, chosen.answered(&problem), elapsed).of(subject.scene(), trace))
}
