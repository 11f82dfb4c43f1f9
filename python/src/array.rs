//! `midair.Array` and `midair.presets`.

use midair::{Directivity, ErrorCode, Medium, Origin, PartKind, PartValue};

use crate::error::coded;
use crate::give::{list, rows};
use crate::parts::{self, Values};
use crate::pickle::called;
use crate::prelude::*;
use crate::ready::{Cache, Ready};

/// Array of N transducers: their places and their radiation.
///
/// Parameters
/// ----------
/// positions : (N, 3) array_like
///     Places in m.
/// normals : (N, 3) array_like, optional
///     Directions, which are normalised; by default +z.
/// unit : {"m", "cm", "mm", "um"}, optional
///     Unit of the positions; by default m.
/// {parts}
///
/// Raises
/// ------
/// SceneError
///     For numbers of another shape or not finite, values out of their range, and unknown names.
///
/// See Also
/// --------
/// Array.preset, Array.grid, Array.from_file : other ways to make one.
///
/// Notes
/// -----
/// docs/conventions.md lists the directivities. A quantization has the phases and amplitudes of a board, such as
/// {"phases": 256, "amplitudes": [0, 0.5, 1]}: every drive then lies on that grid. A missing part, or None, is
/// continuous.
///
/// Examples
/// --------
/// >>> import midair
/// >>> midair.Array([[0, 0, 0], [0.01, 0, 0]]).positions.shape
/// (2, 3)
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone)]
pub(crate) struct Array {
    pub(crate) inner: midair::Array,
    cache: Cache,
}

impl From<midair::Array> for Array {
    fn from(inner: midair::Array) -> Self {
        Self { inner, cache: Cache::default() }
    }
}

impl From<&Arc<Ready>> for Array {
    fn from(ready: &Arc<Ready>) -> Self {
        Self { inner: ready.model.array().clone(), cache: Cache::of(Arc::clone(ready)) }
    }
}

impl Array {
    /// Returns the array with these parts instead of its own.
    pub(crate) fn with_parts(self, values: Values) -> PyResult<Self> {
        if values.is_empty() {
            return Ok(self);
        }
        let array = values.into_iter().try_fold(self.inner, |array, (part, value)| part.put(array, value));
        array.map(|inner| Self { cache: self.cache.changed(&inner), inner }).map_err(refused)
    }

    /// Returns the array prepared for a medium.
    pub(crate) fn ready(&self, medium: Medium) -> PyResult<Arc<Ready>> {
        self.cache.get(&self.inner, medium)
    }
}

impl PartialEq for Array {
    fn eq(&self, other: &Self) -> bool {
        self.inner == other.inner
    }
}

hashed!(Array: self => (self.inner.positions()[0].map(bits), bits(self.inner.transducer().source_pressure)));

#[pymethods]
impl Array {
    #[staticmethod]
    #[pyo3(name = "_new", signature = (positions, normals=None, *, unit="m", **parts))]
    fn new(
        positions: &Bound<'_, PyAny>,
        normals: Argument<'_, '_>,
        unit: &str,
        parts: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        if positions.is_instance_of::<PyString>() {
            return Err(coded(
                ErrorCode::Type,
                "positions",
                &quoted(positions),
                "a known array is midair.Array.preset(NAME)",
            ));
        }
        let normals = normals.map(|normals| read::vectors("normals", normals)).transpose()?;
        let mut places = read::vectors("positions", positions)?;
        let size = midair::files::length(unit).map_err(refused)?;
        places.iter_mut().flatten().for_each(|x| *x *= size);
        let array = midair::Array::new(places, normals).map_err(refused)?;
        Self::from(array).with_parts(parts::keywords("Array", parts)?)
    }

    /// Make a flat grid of nx x ny transducers, centred in z = 0; x varies fastest.
    ///
    /// Parameters
    /// ----------
    /// nx, ny : int
    ///     Transducers along x and y.
    /// pitch : float
    ///     Distance between neighbours in m.
    /// **parts
    ///     Keywords of `Array`.
    ///
    /// Returns
    /// -------
    /// midair.Array
    ///     The array.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For less than one transducer, a pitch that is not above 0, and keywords that `Array` rejects.
    #[staticmethod]
    #[pyo3(signature = (nx, ny, pitch, **parts))]
    fn grid(
        py: Python<'_>,
        nx: &Bound<'_, PyAny>,
        ny: &Bound<'_, PyAny>,
        pitch: &Bound<'_, PyAny>,
        parts: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let (nx, ny) = (read::count("nx", nx)?, read::count("ny", ny)?);
        let array = midair::Array::grid(nx, ny, read::real("pitch", pitch)?).map_err(refused)?;
        warn_all(py, array.doubt())?;
        Self::from(array).with_parts(parts::keywords("Array.grid", parts)?)
    }

    /// Make the array of a known board, or the paper's.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Name of a preset; `midair.presets()` lists them.
    /// tiles : (int, int), optional
    ///     Boards along x and y.
    /// **parts
    ///     Keywords of `Array`, which override the preset's values.
    ///
    /// Returns
    /// -------
    /// midair.Array
    ///     The array.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For an unknown name, for tiles of a preset that has none, and keywords that `Array` rejects.
    #[staticmethod]
    #[pyo3(signature = (name, tiles=None, **parts))]
    fn preset(name: &Bound<'_, PyAny>, tiles: Argument<'_, '_>, parts: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let name = read::text("preset", name, "give a name as text")?;
        let array = midair::Array::preset(&name, read::tiles(tiles)?).map_err(refused)?;
        Self::from(array).with_parts(parts::keywords("Array.preset", parts)?)
    }

    /// Return a copy that is rotated about the origin, then translated.
    ///
    /// Air, directivity, responses, order, channels, pins and the phases and amplitudes of the board stay.
    ///
    /// Parameters
    /// ----------
    /// rotation : (3,), (4,) or (3, 3) array_like, optional
    ///     Axis times angle in rad; or a quaternion w, x, y, z; or a matrix R.
    /// translation : (3,) array_like, optional
    ///     Translation t in m: a place x moves to R x + t.
    ///
    /// Returns
    /// -------
    /// midair.Array
    ///     The array.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For a matrix that is no rotation, a quaternion of length 0, other shapes, numbers that are not finite.
    ///
    /// Examples
    /// --------
    /// >>> import midair
    /// >>> board = midair.Array.preset("autd3")
    /// >>> upright = board.moved(rotation=[[0, 0, 1], [0, 1, 0], [-1, 0, 0]], translation=[-0.1, 0, 0.1])
    /// >>> upright.normals[0]
    /// array([1., 0., 0.])
    #[pyo3(signature = (*, rotation=None, translation=None))]
    fn moved(&self, rotation: Argument<'_, '_>, translation: Argument<'_, '_>) -> PyResult<Self> {
        Ok(self.inner.moved(&read::pose(rotation, translation)?).map_err(refused)?.into())
    }

    /// Join several arrays, such as the boards of a rig, to one.
    ///
    /// Parameters
    /// ----------
    /// arrays : sequence of midair.Array
    ///     Arrays of one frequency, directivity, source pressure and quantization. `moved` puts each in its place.
    ///
    /// Returns
    /// -------
    /// midair.Array
    ///     The transducers of all arrays in their order, with their responses, masks, channels and pins.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For no array, and for arrays that differ in frequency, transducer, quantization or wiring.
    ///
    /// Examples
    /// --------
    /// >>> import midair
    /// >>> board = midair.Array.preset("autd3")
    /// >>> facing = board.moved(rotation=[0, 3.14159265, 0], translation=[0, 0, 0.3])
    /// >>> rig = midair.Array.join([board, facing])
    /// >>> len(rig), midair.Board("autd3", rig).boards
    /// (498, 2)
    #[staticmethod]
    fn join(arrays: &Bound<'_, PyAny>) -> PyResult<Self> {
        let Ok(arrays) = arrays.extract::<Vec<Py<Self>>>() else {
            return Err(invalid("arrays", &quoted(arrays), "give a list of arrays"));
        };
        let arrays: Vec<_> = arrays.iter().map(|array| array.get().inner.clone()).collect();
        Ok(midair::Array::join(&arrays).map_err(refused)?.into())
    }

    /// Return the names of the presets; `midair.presets()` describes them.
    #[staticmethod]
    fn presets() -> Vec<&'static str> {
        midair::presets::PRESETS.iter().map(|preset| preset.name).collect()
    }

    /// Return the channel on a kind of board of each transducer, found by comparing places.
    ///
    /// Each board may stand anywhere and be turned. Use it for an array in another order than the board:
    /// `midair.Board(kind, array, channels=array.channels_by_place(kind))`.
    ///
    /// Parameters
    /// ----------
    /// kind : str
    ///     A kind of board, such as "sonicsurface"; `midair boards` lists them.
    ///
    /// Returns
    /// -------
    /// (N,) ndarray of int
    ///     The channels; those of a second board follow those of the first.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For an unknown kind, part of a board, and places that differ by more than 3 mm from the board's.
    ///
    /// Examples
    /// --------
    /// >>> import midair
    /// >>> board = midair.Array.preset("sonicsurface")
    /// >>> turned = midair.Array(board.positions.reshape(16, 16, 3).swapaxes(0, 1).reshape(256, 3))
    /// >>> turned.channels_by_place("sonicsurface")[:3], midair.Board("sonicsurface").channels[:33:16]
    /// (array([0, 4, 8]), array([0, 4, 8]))
    fn channels_by_place<'py>(&self, py: Python<'py>, kind: &str) -> PyResult<Array1<'py, i64>> {
        let channels = self.inner.channels_by_place(kind).map_err(refused)?;
        Ok(list(py, channels.into_iter().map(|channel| i64::try_from(channel).unwrap_or(i64::MAX)).collect()))
    }

    /// Checks that a drive of another array may be played on this one.
    fn _check_drive_of(&self, other: &Self) -> PyResult<()> {
        self.inner.check_drive_of(&other.inner).map_err(refused)
    }

    /// Returns the same array, marked as hardware of a frequency in Hz, or as no hardware.
    #[pyo3(name = "_with_hardware")]
    fn with_hardware(&self, hardware: Option<f64>) -> Self {
        self.inner.clone().with_hardware(hardware).into()
    }

    /// Returns whether a point (x, y, z) in m lies behind every transducer.
    fn _is_behind(&self, point: [f64; 3]) -> bool {
        self.inner.is_behind(point)
    }

    /// Returns a part by its name, or None if the array has none; a missing mask is all True.
    fn _part<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let value = midair::Array::part(name).and_then(|part| match (part.of(&self.inner), part.kind()) {
            (None, PartKind::Flags) => Some(PartValue::Flags(vec![true; self.inner.len()])),
            (value, _) => value,
        });
        value.map(|value| parts::object(py, value)).transpose()
    }

    fn __len__(&self) -> usize {
        self.inner.len()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let (class, array) = (py.get_type::<Self>(), &self.inner);
        if let Some(hardware) = array.hardware()
            && *array.origin() == Origin::Positions
        {
            return Ok((class.getattr("_with_hardware")?, (self.with_hardware(None), hardware).into_pyobject(py)?));
        }
        let call = match array.origin() {
            Origin::Positions => (class, self.positions(py)?, self.normals(py)?).into_pyobject(py)?,
            Origin::Grid { nx, ny, pitch } => (class.getattr("grid")?, nx, ny, pitch).into_pyobject(py)?,
            Origin::Preset { name, tiles: [x, y] } => (class.getattr("preset")?, name, (x, y)).into_pyobject(py)?,
        };
        let keywords = PyDict::new(py);
        for (name, value) in array.stated() {
            keywords.set_item(name, parts::object(py, value)?)?;
        }
        called(call, &keywords)
    }

    fn __repr__(&self) -> String {
        let (name, _) = self.inner.transducer().directivity.name();
        let origin = match self.inner.origin() {
            midair::Origin::Preset { name, tiles: [1, 1] } => format!(" \"{name}\""),
            midair::Origin::Preset { name, tiles: [x, y] } => format!(" \"{name}\", {x} x {y} boards,"),
            _ => String::new(),
        };
        let (count, pressure) = (self.inner.len(), self.inner.transducer().source_pressure);
        format!("<midair.Array{origin} of {count} transducers, {pressure} Pa m, {name}>")
    }
}

getters! {
    Array:

    /// Positions (N, 3) in m.
    positions(self, py) -> PyResult<Array2<'py, f64>> = rows(py, self.inner.positions());

    /// Unit normals (N, 3).
    normals(self, py) -> PyResult<Array2<'py, f64>> = rows(py, self.inner.normals());

    /// Values of the air by name, for scenes that give none.
    ///
    /// 25 degrees C, 50 % humidity and 101.325 kPa for presets of hardware, else the paper's 340 m/s without
    /// absorption.
    ///
    /// Examples
    /// --------
    /// >>> import midair
    /// >>> midair.Array.preset("paper20").medium.get("sound_speed")
    /// 340.0
    medium(self, py) -> PyResult<Bound<'py, PyDict>> =
        self.inner.medium(&[]).map_err(refused)?.numbers().collect::<Vec<_>>().into_py_dict(py);

    /// Frequency of hardware in Hz, or None. Scenes of hardware have the air of a room by default.
    _hardware(self) -> Option<f64> = self.inner.hardware();
}

/// Description of a preset; from `midair.presets`.
///
/// Examples
/// --------
/// >>> import midair
/// >>> autd3 = midair.presets()["autd3"]
/// >>> autd3.count, autd3.board
/// (249, 'autd3')
#[pyclass(frozen, get_all, eq, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct PresetInfo {
    /// Description in one line.
    summary: String,
    /// Source of the preset's data.
    source: String,
    /// Number of transducers of one board.
    count: usize,
    /// Whether boards can be tiled.
    tiles: bool,
    /// Source pressure P0 in Pa m: pressure times distance on the axis at full drive.
    source_pressure: f64,
    /// Name of the board that plays the array, or None.
    board: Option<String>,
}

pickled!(PresetInfo: summary: String, source: String, count: usize, tiles: bool, source_pressure: f64, board: Option<String>);

#[pymethods]
impl PresetInfo {
    fn __repr__(&self) -> String {
        format!("<{} transducers: {}>", self.count, self.summary)
    }
}

/// List every preset by name.
///
/// Returns
/// -------
/// dict of str to midair.PresetInfo
///     The presets; `midair.Array.preset` makes the arrays.
///
/// Examples
/// --------
/// >>> import midair
/// >>> midair.presets()["sonicsurface"].count
/// 256
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

/// Returns every directivity by name: (default of its parameter or None, the parameter's unit, the formula).
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
