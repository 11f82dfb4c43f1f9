//! `midair.Array` and `midair.presets`.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

use midair::{Complex64, Directivity, Medium, Origin, Transducer};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::error::{invalid, refused, warn_all};
use crate::give::{self, rows};
use crate::numbers::quoted;
use crate::pickle::{Reduced, called, restored};
use crate::quantization::{self, read_quantization};
use crate::read;
use crate::ready::{Kept, Ready};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// N transducers: positions (N, 3) in m, normals (N, 3), and how each radiates.
///
/// Normals are normalised and +z where left out. source_pressure (Pa m) is the on-axis pressure times distance
/// at full drive, directivity a name such as "t4010a1" or {name: parameter} (docs/conventions.md lists them),
/// response (N,) a complex factor of each transducer, 0 for a dead one; mask (N,) is False where one is off.
/// quantization is what its board can play, {"phases": 256, "amplitudes": [0, 0.5, 1]}: every answer then lies on
/// that grid. What is left out there, or None, is continuous.
///
/// Raises SceneError for numbers of another shape or not finite, values out of their range, and unknown names.
///
/// >>> import midair
/// >>> midair.Array([[0, 0, 0], [0.01, 0, 0]]).positions.shape
/// (2, 3)
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone)]
pub(crate) struct Array {
    pub(crate) inner: midair::Array,
    kept: Kept,
}

impl From<midair::Array> for Array {
    fn from(inner: midair::Array) -> Self {
        Self { inner, kept: Kept::default() }
    }
}

impl From<&Arc<Ready>> for Array {
    fn from(ready: &Arc<Ready>) -> Self {
        Self { inner: ready.model.array().clone(), kept: Kept::of(Arc::clone(ready)) }
    }
}

impl Array {
    /// Itself prepared for a medium.
    pub(crate) fn ready(&self, medium: Medium) -> PyResult<Arc<Ready>> {
        self.kept.get(&self.inner, medium)
    }
}

impl PartialEq for Array {
    fn eq(&self, other: &Self) -> bool {
        self.inner == other.inner
    }
}

impl Hash for Array {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // 0 and -0 are equal.
        let Transducer { source_pressure, .. } = self.inner.transducer();
        (self.inner.len(), self.inner.positions()[0].map(|x| (x + 0.0).to_bits())).hash(state);
        source_pressure.to_bits().hash(state);
    }
}

/// Applies the keywords that every way to make an array shares; what is left out stays as it is.
pub(crate) fn adjusted(
    array: Array,
    source_pressure: Argument<'_, '_>,
    directivity: Argument<'_, '_>,
    response: Argument<'_, '_>,
) -> PyResult<Array> {
    if [source_pressure, directivity, response].iter().all(Option::is_none) {
        return Ok(array);
    }
    let own = array.inner.transducer();
    let transducer = Transducer {
        source_pressure: read::real_or("source_pressure", source_pressure, own.source_pressure)?,
        directivity: directivity.map_or(Ok(own.directivity), read::directivity)?,
    };
    let array = array.inner.with_transducer(transducer).map_err(refused)?;
    let array = match response {
        None => array,
        Some(response) => array.with_response(Some(read::complexes("response", response)?)).map_err(refused)?,
    };
    Ok(array.into())
}

#[pymethods]
impl Array {
    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "Python's keywords")]
    #[pyo3(name = "_new", signature = (positions, normals=None, *, source_pressure=None, directivity=None, response=None, mask=None, quantization=None))]
    fn new(
        positions: &Bound<'_, PyAny>,
        normals: Argument<'_, '_>,
        source_pressure: Argument<'_, '_>,
        directivity: Argument<'_, '_>,
        response: Argument<'_, '_>,
        mask: Argument<'_, '_>,
        quantization: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let normals = normals.map(|normals| read::vectors("normals", normals)).transpose()?;
        let array = midair::Array::new(read::vectors("positions", positions)?, normals).map_err(refused)?;
        on_board(adjusted(array.into(), source_pressure, directivity, response)?, mask, quantization)
    }

    /// A flat grid of nx x ny transducers, pitch metres apart, centred in z = 0, x fastest. The keywords are those of
    /// `Array`.
    ///
    /// Raises SceneError for less than one transducer, a pitch that is not above 0, and keywords that `Array` refuses.
    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "Python's keywords")]
    #[pyo3(signature = (nx, ny, pitch, *, source_pressure=None, directivity=None, response=None, mask=None, quantization=None))]
    fn grid(
        py: Python<'_>,
        nx: &Bound<'_, PyAny>,
        ny: &Bound<'_, PyAny>,
        pitch: &Bound<'_, PyAny>,
        source_pressure: Argument<'_, '_>,
        directivity: Argument<'_, '_>,
        response: Argument<'_, '_>,
        mask: Argument<'_, '_>,
        quantization: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let (nx, ny) = (read::count("nx", nx)?, read::count("ny", ny)?);
        let array = midair::Array::grid(nx, ny, read::real("pitch", pitch)?).map_err(refused)?;
        warn_all(py, array.doubt())?;
        on_board(adjusted(array.into(), source_pressure, directivity, response)?, mask, quantization)
    }

    /// A known board or the paper's array; tiles = (x, y) boards. The keywords, those of `Array`, override the preset's
    /// values.
    ///
    /// Raises SceneError for an unknown name, for tiles of a preset that has none, and keywords that `Array` refuses.
    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "Python's keywords")]
    #[pyo3(signature = (name, tiles=None, *, source_pressure=None, directivity=None, response=None, mask=None, quantization=None))]
    fn preset(
        name: &Bound<'_, PyAny>,
        tiles: Argument<'_, '_>,
        source_pressure: Argument<'_, '_>,
        directivity: Argument<'_, '_>,
        response: Argument<'_, '_>,
        mask: Argument<'_, '_>,
        quantization: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let Ok(name) = name.extract::<String>() else {
            return Err(invalid("preset", &quoted(name), "give a name as text"));
        };
        let array = midair::Array::preset(&name, read::tiles(tiles)?).map_err(refused)?;
        on_board(adjusted(array.into(), source_pressure, directivity, response)?, mask, quantization)
    }

    /// The names of the presets; `midair.presets()` tells more.
    #[staticmethod]
    fn presets() -> Vec<&'static str> {
        midair::presets::PRESETS.iter().map(|preset| preset.name).collect()
    }

    /// Positions (N, 3) in m.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.inner.positions())
    }

    /// Unit normals (N, 3).
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.inner.normals())
    }

    /// Whether a point (x, y, z) in m lies behind every transducer.
    fn _is_behind(&self, point: [f64; 3]) -> bool {
        self.inner.is_behind(point)
    }

    /// Complex responses (N,), or None where all are 1.
    #[getter]
    fn response<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<Complex64>>> {
        self.inner.response().map(|response| give::list(py, response.to_vec()))
    }

    /// Which transducers are on (N,), bool.
    #[getter]
    fn mask<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        quantization::mask(py, &self.inner)
    }

    /// What the board can play, as {"phases": L or None, "amplitudes": (K,) or None}, or None where any drive can be had.
    #[getter]
    fn quantization<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        quantization::shown(py, self.inner.quantization())
    }

    /// P0 in Pa m.
    #[getter]
    fn source_pressure(&self) -> f64 {
        self.inner.transducer().source_pressure
    }

    /// The directivity: a name, or a dictionary of one name and its parameter.
    #[getter]
    fn directivity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let directivity: Directivity = self.inner.transducer().directivity;
        match directivity.name() {
            (name, None) => Ok(name.into_pyobject(py)?.into_any()),
            (name, Some(parameter)) => Ok([(name, parameter)].into_py_dict(py)?.into_any()),
        }
    }

    fn __len__(&self) -> usize {
        self.inner.len()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let (class, array) = (py.get_type::<Self>(), &self.inner);
        let call = match array.origin() {
            Origin::Positions => (class, self.positions(py)?, self.normals(py)?).into_pyobject(py)?,
            Origin::Grid { nx, ny, pitch } => (class.getattr("grid")?, nx, ny, pitch).into_pyobject(py)?,
            Origin::Preset { name, tiles: [x, y] } => (class.getattr("preset")?, name, (x, y)).into_pyobject(py)?,
        };
        let keywords = PyDict::new(py);
        keywords.set_item("source_pressure", self.source_pressure())?;
        keywords.set_item("directivity", self.directivity(py)?)?;
        keywords.set_item("response", self.response(py))?;
        keywords.set_item("mask", array.mask().map(|mask| give::list(py, mask.to_vec())))?;
        // Left out, it would be the preset's.
        keywords.set_item("quantization", self.quantization(py)?.unwrap_or_else(|| PyDict::new(py)))?;
        called(call, &keywords)
    }

    fn __repr__(&self) -> String {
        let (name, _) = self.inner.transducer().directivity.name();
        let origin = match self.inner.origin() {
            midair::Origin::Preset { name, tiles: [1, 1] } => format!(" \"{name}\""),
            midair::Origin::Preset { name, tiles: [x, y] } => format!(" \"{name}\", {x} x {y} boards,"),
            _ => String::new(),
        };
        let (count, pressure) = (self.inner.len(), self.source_pressure());
        format!("<midair.Array{origin} of {count} transducers, {pressure} Pa m, {name}>")
    }
}

/// What is known of a preset.
#[pyclass(frozen, get_all, eq, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct PresetInfo {
    /// What it is, in one line.
    summary: String,
    /// Where its numbers come from.
    source: String,
    /// Transducers of one board.
    count: usize,
    /// Whether boards can be tiled.
    tiles: bool,
    /// P0 in Pa m.
    source_pressure: f64,
    /// The board that plays it, or None.
    board: Option<String>,
}

#[pymethods]
impl PresetInfo {
    #[staticmethod]
    fn _restore(
        summary: String,
        source: String,
        count: usize,
        tiles: bool,
        source_pressure: f64,
        board: Option<String>,
    ) -> Self {
        Self { summary, source, count, tiles, source_pressure, board }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let Self { summary, source, count, tiles, source_pressure, board } = self;
        restored::<Self>(py, (summary, source, count, tiles, source_pressure, board))
    }

    fn __repr__(&self) -> String {
        format!("<{} transducers: {}>", self.count, self.summary)
    }
}

/// Every preset by name.
#[pyfunction]
pub(crate) fn presets(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for preset in &midair::presets::PRESETS {
        let info = PresetInfo {
            summary: preset.summary.into(),
            source: preset.source.into(),
            count: preset.count,
            tiles: preset.tiles,
            source_pressure: preset.transducer.source_pressure,
            board: preset.board.map(Into::into),
        };
        dict.set_item(preset.name, Bound::new(py, info)?)?;
    }
    Ok(dict)
}

/// Every directivity by name: the default of its parameter or None, the parameter's unit, and the formula.
#[pyfunction]
pub(crate) fn directivities(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for directivity in Directivity::all() {
        let (name, default) = directivity.name();
        let unit = directivity.parameter().map_or("", |parameter| if parameter.length { "m" } else { "" });
        dict.set_item(name, (default, unit, directivity.about()))?;
    }
    Ok(dict)
}

/// The array with what is given of mask and quantization; what is left out stays as it is.
pub(crate) fn on_board(array: Array, mask: Argument<'_, '_>, quantization: Argument<'_, '_>) -> PyResult<Array> {
    let array = match quantization {
        None => array,
        Some(quantization) => array.inner.with_quantization(Some(read_quantization(quantization)?)).into(),
    };
    match mask {
        None => Ok(array),
        Some(mask) => Ok(array.inner.with_mask(Some(read::flags("mask", mask)?)).map_err(refused)?.into()),
    }
}
