//! `midair.Solver`.

use std::sync::{Mutex, MutexGuard, TryLockError};
use std::time::Instant;

use midair::solvers::Last;
use midair::{Frames, Session, SolveRequest};
use numpy::{Ix1, Ix2, PyReadonlyArray1};

use crate::chosen::Chosen;
use crate::metrics::Metrics;
use crate::names::unknown_argument;
use crate::numbers::in_place;
use crate::out;
use crate::pickle::called;
use crate::prelude::*;
use crate::setting::{Setting, Source, points_of};
use crate::solution::{Solution, begin};

/// Solver of many requests of one array by one method, in memory of its own.
///
/// Parameters
/// ----------
/// scene : midair.Scene, midair.Array or midair.Propagation
///     Array and medium: a scene, or an array with a scene's keywords (frequency, sound_speed, ...). Or a matrix for
///     many targets.
/// solver : str, optional
///     A name of `solvers()`, as in `solve`.
/// points : int, optional
///     Largest number of points of a call, if there is one.
/// **options
///     Options of the solver; `balance` and `aim`; `quantization` and `mask`, which replace those of the array.
///
/// Raises
/// ------
/// SceneError
///     For an unknown solver or option and a wrong value; a call raises the errors of `solve`.
/// TypeError
///     If `scene` has another type.
///
/// Notes
/// -----
/// From the second call on it allocates nothing if `out` is given.
///
/// Examples
/// --------
/// >>> import midair, numpy
/// >>> solver = midair.Solver(midair.Array.preset("paper20"), "fast")
/// >>> drive = numpy.empty(400, numpy.complex64)
/// >>> for x in (0.00, 0.01, 0.02):
/// ...     answer = solver([[x, 0, 0.15], [-x, 0.01, 0.15]], out=drive)
/// >>> answer.status
/// 'done'
#[pyclass(frozen, module = "midair")]
pub(crate) struct Solver {
    state: Mutex<State>,
    chosen: Chosen,
    points: Option<usize>,
    source: Source,
}

/// Data that a call changes.
pub(crate) struct State {
    pub(crate) session: Session,
    ask: SolveRequest,
    elapsed: f64,
}

/// Locks what only one thread may use at a time.
pub(crate) fn free<'a, T>(lock: &'a Mutex<T>, item: &str, cure: &str) -> PyResult<MutexGuard<'a, T>> {
    match lock.try_lock() {
        Ok(free) => Ok(free),
        // A call that panicked leaves no data that the next call uses.
        Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => Err(invalid(item, "at work in another thread", cure)),
    }
}

impl Solver {
    pub(crate) fn state(&self) -> PyResult<MutexGuard<'_, State>> {
        free(&self.state, "solver", "give each thread a Solver of its own")
    }

    /// Returns a value of the last solution.
    fn answer<T>(&self, read: impl FnOnce(&midair::Solution) -> T) -> PyResult<T> {
        self.state()?.session.solution().map(read).ok_or_else(|| {
            invalid("solution", "none yet", "call the solver with out= first; without out= the answer is returned")
        })
    }
}

/// State of `glide` as Python objects.
pub(crate) type Remembered<'py> = (Array2<'py, Complex32>, Array1<'py, f32>, f32, Array2<'py, f64>);

/// Returns the state of a solver after its last frame; None before the first.
pub(crate) fn remembered<'py>(py: Python<'py>, last: &Last) -> PyResult<Option<Remembered<'py>>> {
    if last.is_empty() {
        return Ok(None);
    }
    let (drives, weights, unevenness) = last.parts();
    let table = give::table(py, drives.concat(), [3, drives[0].len()])?;
    Ok(Some((table, give::list(py, weights.to_vec()), unevenness, give::rows(py, last.motion())?)))
}

/// The arguments of `restore`, as [`remembered`] returns them.
pub(crate) type Kept<'py> =
    (PyReadonlyArray2<'py, Complex32>, PyReadonlyArray1<'py, f32>, f32, PyReadonlyArray2<'py, f64>);

/// Reads the state of a solver of `transducers`.
pub(crate) fn restored((drives, weights, unevenness, motion): Kept<'_>, transducers: usize) -> PyResult<Last> {
    let shape = drives.shape();
    if shape != [3, transducers] {
        let cure = format!("give (3, {transducers}), of last()");
        return Err(invalid("drives", &format!("of shape {shape:?}"), &cure));
    }
    if motion.shape()[1] != 3 {
        let shape = format!("of shape {:?}", motion.shape());
        return Err(invalid("motion", &shape, "give (K, 3), of last()"));
    }
    let rows = drives.as_array();
    let parts = [0, 1, 2].map(|k| rows.row(k).to_vec());
    let motion = motion.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
    Ok(Last::restore(parts, weights.as_array().to_vec(), unevenness, motion))
}

/// Copies points into a reused list; a C-contiguous float64 array is copied only once.
fn copy_points(value: &Bound<'_, PyAny>, points: &mut Vec<[f64; 3]>) -> PyResult<()> {
    points.clear();
    if let Some(array) = in_place::<f64, Ix2>(value)
        && array.shape()[1] == 3
        && let Ok(slice) = array.as_slice()
    {
        points.extend_from_slice(slice.as_chunks().0);
        return Ok(());
    }
    points.extend(read::vectors("points", value)?);
    Ok(())
}

/// Copies numbers into a reused list: one for every point, or one for all.
fn copy(item: &str, value: Argument<'_, '_>, count: usize, slot: &mut Option<Vec<f64>>) -> PyResult<()> {
    let Some(value) = value else {
        *slot = None;
        return Ok(());
    };
    if let (Some(array), Some(list)) = (in_place::<f64, Ix1>(value), slot.as_mut())
        && array.len() == count
        && let Ok(slice) = array.as_slice()
    {
        list.clear();
        list.extend_from_slice(slice);
        return Ok(());
    }
    *slot = Some(read::list(item, value, count)?);
    Ok(())
}

/// Copies pressures into a reused request.
fn copy_pressures(value: Argument<'_, '_>, count: usize, request: &mut Request) -> PyResult<()> {
    request.phases = None;
    match value {
        Some(value) if in_place::<f64, Ix1>(value).is_none() => {
            let Request { pressures, phases, .. } = read::pressures(value, count)?;
            (request.pressures, request.phases) = (pressures, phases);
            Ok(())
        }
        value => copy("pressures", value, count, &mut request.pressures),
    }
}

#[pymethods]
impl Solver {
    #[staticmethod]
    #[pyo3(name = "_new", signature = (scene, solver=None, *, points=None, **options))]
    fn new(
        scene: &Bound<'_, PyAny>,
        solver: Argument<'_, '_>,
        points: Argument<'_, '_>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let points = points.map(|points| read::count("points", points)).transpose()?;
        if points == Some(0) {
            return Err(invalid("points", "0", "give a whole number, 1 or above"));
        }
        solver.map(read::name).transpose()?;
        let Setting { session, chosen, source, .. } = Setting::read(scene, solver, options)?;
        if let (Some(count), Some(most)) = (session.given_points(), points)
            && most < count
        {
            let cure = format!("the matrix has {count} points: give as many, or leave it out");
            return Err(invalid("points", &most.to_string(), &cure));
        }
        let ask = SolveRequest { aim: chosen.choice.aim, ..SolveRequest::default() };
        Ok(Self { state: Mutex::new(State { session, ask, elapsed: 0.0 }), chosen, points, source })
    }

    /// Find a drive for some points, as `solve` does.
    ///
    /// Parameters
    /// ----------
    /// points : (M, 3) array_like, optional
    ///     Points in m; none for a matrix.
    /// pressures, weights, start
    ///     As for `midair.solve`.
    /// out : (N,) ndarray of complex64, optional
    ///     Array for the drive.
    ///
    /// Returns
    /// -------
    /// midair.Solution or midair.Solver
    ///     A new solution. With out the solver itself: its drive, pressures, metrics and status are those of the last call.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     As for `midair.solve`.
    #[pyo3(signature = (points=None, pressures=None, *, weights=None, start=None, out=None, **others))]
    fn __call__<'py>(
        slf: &Bound<'py, Self>,
        points: Argument<'_, 'py>,
        pressures: Argument<'_, 'py>,
        weights: Argument<'_, 'py>,
        start: Argument<'_, 'py>,
        out: Argument<'_, 'py>,
        others: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Py<PyAny>> {
        if let Some(others) = others {
            return Err(unknown_argument("midair.Solver", others, &["points", "pressures", "weights", "start", "out"]));
        }
        let clock = Instant::now();
        let (py, Self { chosen, points: most, .. }) = (slf.py(), slf.get());
        let mut state = slf.get().state()?;
        let State { session, ask, elapsed } = &mut *state;
        chosen.check_start(start.is_some())?;
        let count = match points_of(session, points, "(M, 3)")? {
            None => session.given_points().unwrap_or_default(),
            Some(points) => {
                copy_points(points, &mut ask.points)?;
                ask.points.len()
            }
        };
        if let Some(most) = most.filter(|&most| count > most) {
            let cure = format!("this solver was made for {most}: make one with points={count}");
            return Err(invalid("points", &format!("{count} of them"), &cure));
        }
        copy_pressures(pressures, count, &mut ask.request)?;
        copy("weights", weights, count, &mut ask.request.weights)?;
        let transducers = session.transducers();
        let out = out.map(|out| out::borrowed::<Ix1>(out, &[transducers])).transpose()?;
        ask.start = start.map(begin).transpose()?;
        attend(py, None, |mut control| session.solve(ask, &mut control).map(|_| ()))?;
        *elapsed = clock.elapsed().as_secs_f64();
        let (doubts, remarks) = (session.doubts(ask), session.remarks());
        let tell = || warn_all(py, doubts).and_then(|()| warn_all(py, remarks));
        if let Some(out) = out {
            out::write(out, session.solution().map_or(&[], |solution| &solution.drive))?;
            drop(state);
            tell()?;
            return Ok(slf.clone().into_any().unbind());
        }
        let none = || invalid("solution", "none", "report this");
        let (inner, problem) = session.take().zip(session.problem()).ok_or_else(none)?;
        let solution = Solution::new(inner, chosen.answered(problem), *elapsed);
        drop(state);
        tell()?;
        Ok(Bound::new(py, solution)?.into_any().unbind())
    }

    /// Solve T frames one after another.
    ///
    /// `glide` continues from the last frame, also that of an earlier call. Other solvers that use a start begin with the
    /// drive of the frame before, within this call.
    ///
    /// Parameters
    /// ----------
    /// points : (T, M, 3) array_like
    ///     Points in m; a frame without points is silent.
    /// pressures : (T, M) array_like, optional
    ///     Peak pressures in Pa, 0 where a point is absent; by default all points have the balanced level.
    /// margin : int, optional
    ///     Number of additional frames in `points` before the first and after the last: `points` is (T + 2 margin, M, 3).
    ///     The acceleration of traps is computed from them.
    ///
    /// Returns
    /// -------
    /// (T, N) ndarray of complex64
    ///     The drives.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For wrong points and pressures, naming the frame.
    #[pyo3(signature = (points, pressures=None, margin=0))]
    fn follow<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        pressures: Argument<'_, 'py>,
        margin: usize,
    ) -> PyResult<Array2<'py, Complex32>> {
        let mut state = self.state()?;
        let State { session, ask, .. } = &mut *state;
        if session.given_points().is_some() {
            return Err(invalid("points", "given", "a matrix has its own points, which do not move"));
        }
        let (points, [length, count]) = read::batch_of_points("points", points)?;
        let Some(frames @ 1..) = margin.checked_mul(2).and_then(|sides| length.checked_sub(sides)) else {
            return Err(invalid("margin", &margin.to_string(), "give more frames of points than on both sides"));
        };
        let targets = pressures.map(|value| read::batch_of_pressures(value, [frames, count])).transpose()?;
        let targets = targets.as_ref().and_then(|request| request.pressures.as_deref());
        let transducers = session.transducers();
        let mut drives = vec![Complex32::ZERO; frames * transducers];
        ask.request = Request::default();
        let path = Frames { points: &points, targets, count, margin, first: 0 };
        attend(py, None, |mut control| session.follow(path, ask, &mut drives, &mut control))?;
        ask.start = None;
        let remarks = session.remarks();
        drop(state);
        warn_all(py, remarks)?;
        give::table(py, drives, [frames, transducers])
    }

    /// Delete the last frame, so that the next frame is solved like the first one.
    fn reset(&self) -> PyResult<()> {
        self.state()?.session.last().clear();
        Ok(())
    }

    /// Return the state of `glide` after its last frame, for `restore`; None before the first.
    ///
    /// Returns
    /// -------
    /// tuple of (drives, weights, unevenness, motion), or None
    ///     complex64 (3, N) drives at full amplitude as found and as played, and the envelopes; float32 (M,) weights;
    ///     the unevenness of the points; of traps (K, 3) places in m, velocities and accelerations.
    fn last<'py>(&self, py: Python<'py>) -> PyResult<Option<Remembered<'py>>> {
        remembered(py, self.state()?.session.last())
    }

    /// Restore the state from `last`.
    ///
    /// Parameters
    /// ----------
    /// drives, weights, unevenness, motion
    ///     (3, N), (M,), a number and (K, 3), as `last` returns them.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For arrays of another shape than in `last`.
    /// TypeError
    ///     For other types.
    fn restore(
        &self,
        drives: PyReadonlyArray2<'_, Complex32>,
        weights: PyReadonlyArray1<'_, f32>,
        unevenness: f32,
        motion: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let mut state = self.state()?;
        let transducers = state.session.transducers();
        *state.session.last() = restored((drives, weights, unevenness, motion), transducers)?;
        Ok(())
    }

    /// Pickles the setting. A copy has its own memory and no last solution.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, Self { chosen: Chosen { choice, .. }, points, source, .. }) = (slf.py(), slf.get());
        let (first, keywords) = source.arguments(py, choice)?;
        keywords.set_item("points", points)?;
        called((slf.get_type(), first, &choice.name).into_pyobject(py)?, &keywords)
    }

    fn __repr__(&self) -> PyResult<String> {
        let points = self.points.map_or_else(String::new, |points| format!(", up to {points} points"));
        let transducers = self.state()?.session.transducers();
        Ok(format!("<midair.Solver by {}: {transducers} transducers{points}>", self.chosen.choice.name))
    }
}

getters! {
    Solver:

    /// Drives q (N,) of the last call with `out`, complex64.
    drive(self, py) -> PyResult<Array1<'py, Complex32>> =
        self.answer(|solution| give::list(py, solution.drive.clone()));

    /// Complex pressures (M,) of the last call with `out` in Pa (peak), complex64.
    pressures(self, py) -> PyResult<Array1<'py, Complex32>> =
        self.answer(|solution| give::list(py, solution.pressures.clone()));

    /// Quality of the last call with `out`.
    metrics(self) -> PyResult<Metrics> = self.answer(|solution| solution.metrics().into());

    /// The relative complex error of the last call with `out`, see `Solution.complex_error`.
    complex_error(self) -> PyResult<Option<f64>> = self.answer(midair::Solution::complex_error);

    /// Status of the last call with `out`.
    status(self) -> PyResult<String> = self.answer(|solution| solution.status.to_string());

    /// Factor for supply or modulation; 1 unless the device cannot play amplitudes as small as those of the drive.
    scale(self) -> PyResult<f64> = self.answer(|solution| solution.scale);

    /// Steps of the last call with `out`.
    steps(self) -> PyResult<usize> = self.answer(|solution| solution.steps);

    /// Time of the last call in s.
    elapsed(self) -> PyResult<f64> = Ok(self.state()?.elapsed);

    /// The solver's name.
    solver(self) -> &str = &self.chosen.choice.name;

    /// All options, and whether the targets are balanced.
    options(self, py) -> PyResult<Bound<'py, PyDict>> = read::option_dict(py, &self.chosen.choice.table());
}
