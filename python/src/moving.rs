//! Frames of moving points, for `midair.sequence` and `midair.stream`: the core has their rules and solves them.

use std::sync::{Mutex, MutexGuard};

use midair::sequence::{self, Table, Tracks};
use midair::solvers;
use midair::{InstructionSet, MovingSolver, OptionValue, Options, Pace, Played, Trajectory};

use crate::array::Array;
use crate::error::warn;
use crate::keywords::Keywords;
use crate::parts;
use crate::prelude::*;
use crate::quantization;
use crate::scene::Scene;
use crate::solver::{Kept, free, remembered, restored};

/// Names of the state of a solver after its last frame.
const REMEMBERED: [&str; 4] = ["drives", "weights", "unevenness", "motion"];

/// Reads the rate in frames per second, the bound of phases and the time constant.
fn pace(rate: f64, change: Argument<'_, '_>, change_rate: Argument<'_, '_>, tau: Argument<'_, '_>) -> PyResult<Pace> {
    let [change, change_rate, tau] = [("change", change), ("change_rate", change_rate), ("tau", tau)]
        .map(|(item, value)| value.map(|value| read::real(item, value)).transpose());
    Ok(Pace { rate, change: change?, change_rate: change_rate?, tau: tau?, closed: None })
}

/// Returns a number of frames per second, if it is plausible.
#[pyfunction]
pub(crate) fn frame_rate(rate: f64) -> PyResult<f64> {
    midair::frame_rate(rate).map_err(refused)
}

/// Returns the bound of phases in rad per frame, from `change` in rad per frame or `change_rate` in rad/s. Warns of one that
/// binds nothing.
#[pyfunction]
pub(crate) fn bound_of(
    py: Python<'_>,
    rate: f64,
    change: Argument<'_, '_>,
    change_rate: Argument<'_, '_>,
) -> PyResult<f64> {
    let pace = pace(rate, change, change_rate, None)?;
    let bound = pace.bound().map_err(refused)?;
    warn_all(py, pace.doubt())?;
    Ok(bound)
}

/// Returns the options with which a solver follows frames at a pace: the bound, the rate, the time constant and the aim, as far
/// as it has them.
#[pyfunction]
pub(crate) fn paced<'py>(
    py: Python<'py>,
    solver: &Bound<'py, PyAny>,
    rate: f64,
    change: Argument<'_, 'py>,
    change_rate: Argument<'_, 'py>,
    tau: Argument<'_, 'py>,
    aim: Argument<'_, 'py>,
) -> PyResult<Bound<'py, PyDict>> {
    bound_of(py, rate, change, change_rate)?;
    let info = solvers::find(&read::name(solver)?).map_err(refused)?.info;
    let mut choice = Choice::new(info.name.into(), Options::new()).map_err(refused)?;
    choice.aim = aim.filter(|_| info.uses_aim).map(read::aim).transpose()?;
    let choice = pace(rate, change, change_rate, tau)?.followed(choice).map_err(refused)?;
    read::option_dict(py, &choice.table())
}

/// Checks what cannot be combined with later frames: another solver than the default one, a time constant, options.
#[pyfunction]
pub(crate) fn check_together<'py>(
    solver: &Bound<'py, PyAny>,
    tau: Argument<'_, 'py>,
    entries: &Bound<'py, PyDict>,
) -> PyResult<()> {
    let entry = solvers::find(&read::name(solver)?).map_err(refused)?;
    let choice = Choice::new(entry.info.name.into(), read::options(Some(entries))?).map_err(refused)?;
    pace(1.0, None, None, tau)?.together(&choice).map_err(refused)
}

/// Frames of moving points that are solved block after block.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Moving {
    request: Arc<midair::Moving>,
    /// The scene of the first frame, with the array as it was given.
    #[pyo3(get)]
    scene: Scene,
    run: Mutex<MovingSolver>,
}

impl Moving {
    fn run(&self) -> PyResult<MutexGuard<'_, MovingSolver>> {
        free(&self.run, "sequence", "solve it in one thread")
    }
}

#[pymethods]
impl Moving {
    /// Reads a request. `points` (T, M, 3) are in m. `targets` (T, M) are in Pa if `pascals` is true, else factors; None for points
    /// alone. `joined` says whether the end of a path is its start; None for frames that are no path.
    #[new]
    #[pyo3(signature = (
        array, points, targets, solver, *, rate, pascals, joined, change, change_rate, tau, closed, ahead, aim, **entries
    ))]
    fn new<'py>(
        array: &Bound<'py, PyAny>,
        points: &Bound<'py, PyAny>,
        targets: Argument<'_, 'py>,
        solver: &Bound<'py, PyAny>,
        rate: f64,
        pascals: bool,
        joined: Option<bool>,
        change: Argument<'_, 'py>,
        change_rate: Argument<'_, 'py>,
        tau: Argument<'_, 'py>,
        closed: Option<bool>,
        ahead: &Bound<'py, PyAny>,
        aim: Argument<'_, 'py>,
        entries: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Self> {
        let py = array.py();
        let array = array.cast::<Array>().map_err(|_| unexpected(array, "a midair.Array", ""))?.get();
        let pace = Pace { closed, ..pace(rate, change, change_rate, tau)? };
        pace.closes(joined).map_err(|mut error| {
            // As Python writes it.
            error.value = "True".into();
            refused(error)
        })?;
        let (points, size) = read::batch_of_points("points", points)?;
        let targets = targets.map(|all| read::batch_of_numbers("targets", all, size)).transpose()?;
        let keywords = Keywords::of(py, entries)?;
        let medium = keywords.medium(None, array)?;
        let mut extras = Extras::default();
        keywords.write_extras(&mut extras, array.inner.len())?;
        let first = points[..size[1]].to_vec();
        let made =
            |array: &Array| Scene::made(array, medium, first.clone(), midair::Request::default(), extras.clone());
        let scene = made(array)?.reported(py, &[])?;
        let ahead = midair::sight(Some(&read::option("ahead", ahead)?), closed == Some(true)).map_err(refused)?;
        let name = solvers::find(&read::name(solver)?).map_err(refused)?;
        // Frames that are solved together have no option besides the board.
        let parts =
            parts::values(
                |part| {
                    if ahead == Some(0) || part == "quantization" { keywords.take(part) } else { Ok(None) }
                },
            )?;
        let balance = keywords.take("balance")?.map(|value| read::flag("balance", &value)).transpose()?;
        let options = name.spelled(&read::options(Some(keywords.rest()))?).map_err(refused)?;
        let mut choice = Choice::new(name.info.name.into(), options).map_err(refused)?;
        (choice.balance, choice.aim) = (balance, aim.map(read::aim).transpose()?);
        let played = if parts.is_empty() {
            scene.clone()
        } else {
            made(&array.clone().with_parts(parts)?)?.reported(py, &scene.doubts())?
        };
        let frames = Trajectory { points, count: size[1], targets, pascals, joined };
        let mut first = midair::Scene::clone(&scene.inner);
        first.solver = Some(choice);
        let set = InstructionSet::requested().map_err(refused)?;
        let moving = py.detach(|| midair::Moving::new(first, frames, pace, ahead, set)).map_err(refused)?;
        let moving = moving.played_on(midair::Scene::clone(&played.inner));
        warn_all(py, moving.doubts())?;
        let request = Arc::new(moving);
        let run = Mutex::new(MovingSolver::new(Arc::clone(&request), played.model()).map_err(refused)?);
        Ok(Self { request, scene, run })
    }

    fn __len__(&self) -> usize {
        self.request.frames()
    }

    /// Solves the frames `first` to `stop`, which follow those of the last call. Returns drives (K, N), complex64, or codes (K, N),
    /// uint8 or uint16. All frames together call `progress` with (step, steps, residual).
    #[pyo3(signature = (first, stop, progress=None))]
    fn block<'py>(
        &self,
        py: Python<'py>,
        first: usize,
        stop: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = self.run()?;
        let solver = &mut *guard;
        let played = attend(py, progress.filter(|_| self.request.ahead.is_none()), |mut control| {
            solver.block(first..stop, &mut control)
        })?;
        let remarks: Vec<_> = solver.session().map(|session| session.remarks().collect()).unwrap_or_default();
        drop(guard);
        warn_all(py, remarks)?;
        let shape = [stop - first, self.request.scene.array().len()];
        Ok(match played {
            Played::Drives(drives) => give::table(py, drives, shape)?.into_any(),
            Played::Codes(codes) if codes.iter().all(|&code| code < 256) && self.phases() <= 256 => {
                give::table(py, codes.into_iter().map(|code| code as u8).collect(), shape)?.into_any()
            }
            Played::Codes(codes) => give::table(py, codes, shape)?.into_any(),
        })
    }

    /// Returns the state after the last frame, for `restore`.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (mut solver, state) = (self.run()?, PyDict::new(py));
        if let Some(horizon) = solver.horizon() {
            let (codes, decided) = horizon.state();
            let transducers = self.request.scene.array().len();
            state.set_item("codes", give::table(py, codes.to_vec(), [codes.len() / transducers, transducers])?)?;
            state.set_item("decided", decided)?;
        } else if let Some(session) = solver.session()
            && let Some((drives, weights, unevenness, motion)) = remembered(py, session.last())?
        {
            let values =
                [drives.into_any(), weights.into_any(), unevenness.into_pyobject(py)?.into_any(), motion.into_any()];
            REMEMBERED.iter().zip(values).try_for_each(|(name, value)| state.set_item(name, value))?;
        }
        Ok(state)
    }

    /// Continues after `done` frames with the result of `state`.
    fn restore(&self, done: usize, state: &Bound<'_, PyDict>) -> PyResult<()> {
        let mut solver = self.run()?;
        if let Some(session) = solver.session() {
            if !state.is_empty() {
                let [drives, weights, unevenness, motion] = REMEMBERED.map(|name| state.as_any().get_item(name));
                let kept: Kept<'_> =
                    (drives?.extract()?, weights?.extract()?, unevenness?.extract()?, motion?.extract()?);
                let transducers = session.transducers();
                *session.last() = restored(kept, transducers)?;
            }
            return Ok(());
        }
        let codes: PyReadonlyArray2<'_, u16> = state.as_any().get_item("codes")?.extract()?;
        solver.restore_horizon(done, codes.as_slice()?.to_vec(), state.as_any().get_item("decided")?.extract()?);
        Ok(())
    }

    /// Warns if a trap cannot accelerate its bead along the path. `drive` returns the drive (N,) of a frame.
    fn warn_of_pulls(&self, py: Python<'_>, drive: &Bound<'_, PyAny>) -> PyResult<()> {
        for pull in self.request.pulls() {
            let (model, drive) = (self.scene.model(), read::drive("drive", &drive.call1((pull.frame,))?)?);
            let doubt = attend(py, None, |mut control| self.request.strained(&pull, &model, &drive, &mut control))?;
            if let Some(doubt) = doubt {
                return warn(py, doubt);
            }
        }
        Ok(())
    }
}

impl Moving {
    fn phases(&self) -> u32 {
        self.request.board().and_then(|board| board.phases()).unwrap_or_default()
    }

    fn shape(&self) -> [usize; 2] {
        [self.request.frames(), self.request.count()]
    }
}

getters! {
    Moving:

    /// Points (T, M, 3) in m.
    points(self, py) -> PyResult<Array3<'py, f64>> = {
        let [frames, count] = self.shape();
        give::list(py, self.request.points.as_flattened().to_vec()).reshape([frames, count, 3])
    };

    /// Targets (T, M) in Pa.
    targets(self, py) -> PyResult<Array2<'py, f64>> = give::table(py, self.request.targets.clone(), self.shape());

    /// Frames per second.
    rate(self) -> f64 = self.request.rate;

    /// Largest change of a phase in rad per frame.
    change(self) -> f64 = self.request.change;

    /// Whether the last frame continues to the first.
    closed(self) -> bool = self.request.closed;

    /// "target" or "max".
    aim(self, py) -> PyResult<Bound<'py, PyAny>> = read::option_object(py, &self.request.aim.show());

    /// Number of later frames that each frame is solved with, None for all.
    ahead(self) -> Option<usize> = self.request.ahead;

    /// Name of the solver.
    solver(self) -> &str = self.request.scene.solver.as_ref().map_or("", |choice| &choice.name);

    /// Quantization of the board, None if it plays any drive.
    quantization(self, py) -> PyResult<Option<Bound<'py, PyDict>>> =
        self.request.board().map(|board| quantization::object(py, &board)).transpose();
}

/// Frames of an endless stream that are solved with some later ones.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Horizon(Mutex<sequence::Horizon>);

impl Horizon {
    fn inner(&self) -> PyResult<MutexGuard<'_, sequence::Horizon>> {
        free(&self.0, "stream", "read it in one thread")
    }
}

#[pymethods]
impl Horizon {
    /// Begins a stream for the array and the air of a scene.
    #[new]
    fn new(py: Python<'_>, scene: &Scene, change: f64, ahead: usize, aim: Argument<'_, '_>) -> PyResult<Self> {
        let aim = aim.map(read::aim).transpose()?.unwrap_or(midair::Aim::Target);
        let tracks = Tracks { model: scene.model(), change, aim };
        warn_all(py, tracks.doubt())?;
        Ok(Self(Mutex::new(sequence::Horizon::new(tracks, ahead))))
    }

    /// Adds a frame of points (M, 3) in m and targets (M,) in Pa.
    fn push(&self, points: &Bound<'_, PyAny>, targets: &Bound<'_, PyAny>) -> PyResult<()> {
        let points = read::vectors("points", points)?;
        let targets = read::list("targets", targets, points.len())?;
        self.inner()?.push(points, targets);
        Ok(())
    }

    /// Returns the drive (N,) of the next frame, None after the last. Fewer frames than wanted are the last ones.
    fn advance<'py>(&self, py: Python<'py>) -> PyResult<Option<Array1<'py, Complex32>>> {
        let mut guard = self.inner()?;
        let horizon = &mut *guard;
        let drive = attend(py, None, |mut control| {
            let Some(codes) = horizon.advance(&mut control)? else { return Ok(None) };
            let Some((points, targets)) = horizon.frame() else { return Ok(None) };
            let table = Table { points, targets, frames: 1, first: 0 };
            horizon.tracks.drives(table, &codes, &mut control).map(Some)
        })?;
        Ok(drive.map(|drive| give::list(py, drive)))
    }
}

getters! {
    Horizon:

    /// How many frames can be pushed before the next one is solved.
    wanted(self) -> PyResult<usize> = Ok(self.inner()?.wanted());
}
