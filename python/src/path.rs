//! `midair.path.Path`: points that move; the kinds of paths and their combinations are in the core.

use midair::files::{self, Drawing, Node};
use midair::points;

use crate::node;
use crate::numbers::{REAL, numbers};
use crate::prelude::*;

/// Places (T, M, 3) in m.
type Places<'py> = Bound<'py, PyArray3<f64>>;

/// Path of M control points for a time, with a target for each; immutable.
///
/// The functions of `midair.path` make paths. `a & b` are the points of both at the same time, `a.then(b)` those of b after
/// those of a.
///
/// Notes
/// -----
/// Targets are in Pa (peak) if `pressures` were given, and then `pascals` is true. Otherwise targets are factors: 1, times
/// modulation and fades, for a solver that finds the level. A point whose target is 0 is absent: leave it out of that
/// frame's scene.
///
/// Examples
/// --------
/// >>> import midair
/// >>> there = midair.path.line([-0.02, 0, 0.15], [0.02, 0, 0.15], speed=0.1)
/// >>> back = midair.path.line([0.02, 0, 0.15], [-0.02, 0, 0.15], speed=0.2)
/// >>> there.then(back)
/// Path(points=1, duration=0.6, closed=True)
#[pyclass(frozen, module = "midair.path")]
pub(crate) struct Path {
    path: points::Path,
    /// The method that made it, and its arguments, for pickling; `None` for the path of a file.
    made: Option<(&'static str, Py<PyTuple>)>,
}

impl From<points::Path> for Path {
    fn from(path: points::Path) -> Self {
        Self { path, made: None }
    }
}

impl Path {
    pub(crate) fn new<'py>(
        py: Python<'py>,
        path: Result<points::Path, midair::Error>,
        method: &'static str,
        arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
    ) -> PyResult<Self> {
        Ok(Self { path: path.map_err(refused)?, made: Some((method, arguments.into_pyobject(py)?.unbind())) })
    }

    /// Returns values of all points at some times.
    fn each<T: Send>(&self, times: &Bound<'_, PyAny>, of: fn(points::Moment) -> T) -> PyResult<Vec<T>> {
        let cure = "give a list of finite times in s";
        let list = numbers::<f64>("times", times, REAL, cure)?;
        if list.shape.len() != 1 || !list.values.iter().all(|time| time.is_finite()) {
            return Err(invalid("times", &quoted(times), cure));
        }
        Ok(times.py().detach(|| list.values.iter().flat_map(|&time| self.path.moments(time)).map(of).collect()))
    }

    fn places<'py>(&self, py: Python<'py>, places: &[[f64; 3]]) -> PyResult<Places<'py>> {
        let points = self.path.points();
        places.as_flattened().to_vec().into_pyarray(py).reshape([places.len() / points, points, 3])
    }

    fn values<'py>(&self, py: Python<'py>, values: Vec<f64>) -> PyResult<Array2<'py, f64>> {
        let points = self.path.points();
        let frames = values.len() / points;
        values.into_pyarray(py).reshape([frames, points])
    }

    fn am(slf: &Bound<'_, Self>, table: &Node) -> PyResult<Self> {
        let path = files::read_modulated(&slf.get().path, table);
        Self::new(slf.py(), path, "_am", (slf, node::object(slf.py(), table)?))
    }

    fn other<'a>(other: &'a Bound<'_, PyAny>) -> PyResult<&'a Self> {
        let path = other.cast::<Self>();
        path.map(Bound::get)
            .map_err(|_| invalid("other", &quoted(other), "give a path, such as midair.path.circle(...)"))
    }
}

#[pymethods]
impl Path {
    /// Makes the path of a table, as `[[motion.path]]` in a scene file; drawings are read by `midair.path.svg`.
    #[staticmethod]
    fn _of(table: &Bound<'_, PyDict>) -> PyResult<Self> {
        let (py, table) = (table.py(), node::table(table)?);
        let no_drawing = &mut |_: &str, _: &str| -> Result<Drawing, midair::Error> {
            Err(midair::Error::missing("", "a drawing", "give a path without a file"))
        };
        Self::new(py, files::read_path(&table, no_drawing), "_of", (node::object(py, &table)?,))
    }

    /// Makes the path through frames (K, M, 3) at a rate, with pressures (K, M) or None.
    #[staticmethod]
    fn _through(points: &Bound<'_, PyAny>, rate: f64, closed: bool, pressures: Argument<'_, '_>) -> PyResult<Self> {
        let (places, [frames, count]) = read::batch_of_points("points", points)?;
        let targets = pressures.map(|all| read::batch_of_numbers("pressures", all, [frames, count])).transpose()?;
        let path = points::Path::through(places, count, rate, closed, targets.as_deref());
        Self::new(points.py(), path, "_through", (points, rate, closed, pressures))
    }

    /// Return places at some times; a closed path repeats, an open one rests before and after.
    ///
    /// Parameters
    /// ----------
    /// times : (T,) array_like
    ///     Times in s.
    ///
    /// Returns
    /// -------
    /// (T, M, 3) ndarray
    ///     Places in m.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For times that are no finite numbers.
    fn at<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Places<'py>> {
        self.places(times.py(), &self.each(times, |moment| moment.place)?)
    }

    /// Return targets at some times: in Pa if pressures were given, else factors from 0 to 1.
    ///
    /// Parameters
    /// ----------
    /// times : (T,) array_like
    ///     Times in s.
    ///
    /// Returns
    /// -------
    /// (T, M) ndarray
    ///     Targets.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For times that are no finite numbers.
    fn targets<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Array2<'py, f64>> {
        self.values(times.py(), self.each(times, |moment| moment.target)?)
    }

    /// Return speeds at some times within the path; at a corner, the speed after it.
    ///
    /// Parameters
    /// ----------
    /// times : (T,) array_like
    ///     Times in s.
    ///
    /// Returns
    /// -------
    /// (T, M) ndarray
    ///     Speeds in m/s.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For times that are no finite numbers.
    fn speed<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Array2<'py, f64>> {
        self.values(times.py(), self.each(times, |moment| moment.speed)?)
    }

    /// Return places and targets of round(duration * rate) frames at the times i / rate, i = 0, 1, ...
    ///
    /// Parameters
    /// ----------
    /// rate : float
    ///     Frames per second. The step over the seam of a closed path is like any other if duration times rate is whole.
    ///
    /// Returns
    /// -------
    /// places : (T, M, 3) ndarray
    ///     Places in m; an open path has one more, its end.
    /// targets : (T, M) ndarray
    ///     Targets, as `targets` returns them.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For a rate that gives less than two frames, too many at once, or too few for the modulation.
    fn frames<'py>(&self, rate: &Bound<'py, PyAny>) -> PyResult<(Places<'py>, Array2<'py, f64>)> {
        let (py, rate) = (rate.py(), read::real("rate", rate)?);
        let frames = py.detach(|| self.path.frames(rate)).map_err(refused)?;
        Ok((self.places(py, &frames.points)?, self.values(py, frames.targets)?))
    }

    /// Join two paths at the same time: this path's points first; also `path & other`.
    ///
    /// Parameters
    /// ----------
    /// other : Path
    ///     A path of the same duration. Or both are closed, with durations in a ratio of whole numbers: they repeat until
    ///     both are at their start again.
    ///
    /// Returns
    /// -------
    /// Path
    ///     The points of both.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For paths of other durations, or of which one has pressures and one has none.
    fn beside(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Self> {
        let path = slf.get().path.beside(&Self::other(other)?.path);
        Self::new(slf.py(), path, "beside", (slf, other))
    }

    /// Return both paths played at the same time, like `beside`.
    fn __and__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::beside(slf, other)
    }

    /// Join two paths, the other after this one.
    ///
    /// Parameters
    /// ----------
    /// other : Path
    ///     The path that follows.
    /// fade : float, optional
    ///     Time in s, for paths whose end and start differ in points, places or targets. During the fade all points stand
    ///     still, and targets change from one value to the other along a raised cosine; points that vanish and appear change
    ///     to and from 0. Without a fade such paths are rejected.
    ///
    /// Returns
    /// -------
    /// Path
    ///     Both paths as one, which is closed if its end joins its start.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For paths that do not join without a fade, or of which one has pressures and one has none.
    #[pyo3(signature = (other, fade=None))]
    fn then(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>, fade: Argument<'_, '_>) -> PyResult<Self> {
        let seconds = fade.map(|fade| read::real("fade", fade)).transpose()?;
        let path = slf.get().path.then(&Self::other(other)?.path, seconds);
        Self::new(slf.py(), path, "then", (slf, other, seconds))
    }

    /// Modulate the amplitude: targets times 1 - depth + depth s(t).
    ///
    /// Parameters
    /// ----------
    /// frequency : float
    ///     Frequency in Hz; a closed path needs a whole number of periods.
    /// shape : {"sqrt", "cosine", "square"}, optional
    ///     Shape of s(t), below; by default "sqrt".
    /// depth : float, optional
    ///     Depth of the modulation, from 0 (none) to 1; by default 1.
    ///
    /// Returns
    /// -------
    /// Path
    ///     The modulated path.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For an unknown shape, a depth beyond 0 to 1, and a frequency that does not fit a closed path.
    ///
    /// Notes
    /// -----
    /// With c = cos(2 pi frequency t), s is sqrt((1 + c) / 2) for "sqrt". Its force on a hand has one line in its spectrum
    /// and the mean 1/2. For "cosine" s is (1 + c) / 2, with a mean force of 3/8; for "square" s is 1, then 0.
    #[pyo3(signature = (frequency, shape=None, depth=None))]
    fn with_am(
        slf: &Bound<'_, Self>,
        frequency: &Bound<'_, PyAny>,
        shape: Argument<'_, '_>,
        depth: Argument<'_, '_>,
    ) -> PyResult<Self> {
        Self::modulated(slf, frequency, shape, depth, None)
    }

    /// Modulate the amplitude as `with_am` does, or by any samples that repeat.
    ///
    /// Parameters
    /// ----------
    /// frequency : float or (S,) array_like
    ///     A frequency in Hz, or samples of s from 0 to 1.
    /// shape, depth
    ///     As for `with_am`; `shape` is not used for samples.
    /// samples_rate : float, optional
    ///     Samples per second.
    ///
    /// Returns
    /// -------
    /// Path
    ///     The modulated path.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     As for `with_am`, and for invalid samples or rates.
    #[pyo3(signature = (frequency, shape=None, depth=None, *, samples_rate=None))]
    fn modulated(
        slf: &Bound<'_, Self>,
        frequency: &Bound<'_, PyAny>,
        shape: Argument<'_, '_>,
        depth: Argument<'_, '_>,
        samples_rate: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let entry = node::read("frequency", frequency)?;
        let sampled = samples_rate.is_some() || matches!(entry, Node::List(_) | Node::Numbers(_));
        let mut keys = vec![(if sampled { "samples" } else { "frequency" }.to_owned(), entry)];
        for (key, value) in [("shape", shape), ("depth", depth), ("samples_rate", samples_rate)] {
            keys.push((key.into(), value.map_or(Ok(Node::Null), |value| node::read(key, value))?));
        }
        Self::am(slf, &Node::Table(keys))
    }

    fn _am(slf: &Bound<'_, Self>, table: &Bound<'_, PyDict>) -> PyResult<Self> {
        Self::am(slf, &node::table(table)?)
    }

    #[staticmethod]
    fn _restore<'py>(method: &str, arguments: &Bound<'py, PyTuple>) -> PyResult<Bound<'py, PyAny>> {
        arguments.py().get_type::<Self>().getattr(method)?.call1(arguments)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let unmade = || invalid("path", "of a scene file", "pickle the name of the file");
        let (method, arguments) = self.made.as_ref().ok_or_else(unmade)?;
        restored::<Self>(py, (*method, arguments))
    }

    /// Return points, duration and closedness as text.
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let duration: String = self.duration().into_pyobject(py)?.call_method1("__format__", (".6g",))?.extract()?;
        let closed = if self.closed() { "True" } else { "False" };
        Ok(format!("Path(points={}, duration={duration}, closed={closed})", self.points()))
    }
}

getters! {
    Path:

    /// M, the number of points, the same at all times.
    points(self) -> usize = self.path.points();

    /// Duration in s.
    duration(self) -> f64 = self.path.duration();

    /// Whether the end joins the start, so that the path can repeat for ever.
    closed(self) -> bool = self.path.closed();

    /// Whether targets are in Pa (pressures were given); otherwise they are factors from 0 to 1.
    pascals(self) -> bool = self.path.pascals();
}
