//! `midair.Scene` and `midair.Reach`.

use std::path::PathBuf;
use std::sync::Arc;

use midair::files::{self, Format, Provenance};
use midair::{Complex32, Control, Medium, Request};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::{Array, adjusted};
use crate::ctrl_c::attend;
use crate::error::refused;
use crate::give::{self, rows};
use crate::instruction_set::instruction_set;
use crate::plane::Plane;
use crate::read;
use crate::solution::Solution;

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// A request: an array, points (M, 3) in m, and what each shall feel.
///
/// pressures (M,) are peak pressures in Pa; one number stands for all, 0 asks for a quiet point; left out, all are
/// equal at the level the array can reach together. weights (M,) multiply the points' terms; a point of weight 0
/// takes no part. sound_speed (m/s) or temperature (degrees C), absorption in Np/m, density in kg/m^3;
/// source_pressure and directivity override the array's.
///
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]])
/// >>> round(float(abs(scene.propagation()).sum()), 5)
/// 2.36066
#[pyclass(frozen, module = "midair")]
pub(crate) struct Scene {
    pub(crate) inner: Arc<midair::Scene>,
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (
        array, points, pressures=None, *, weights=None, frequency=None, sound_speed=None, temperature=None,
        absorption=None, density=None, source_pressure=None, directivity=None
    ))]
    #[allow(clippy::too_many_arguments, reason = "Python's keywords")]
    fn new(
        array: &Bound<'_, Array>,
        points: &Bound<'_, PyAny>,
        pressures: Argument<'_, '_>,
        weights: Argument<'_, '_>,
        frequency: Argument<'_, '_>,
        sound_speed: Argument<'_, '_>,
        temperature: Argument<'_, '_>,
        absorption: Argument<'_, '_>,
        density: Argument<'_, '_>,
        source_pressure: Argument<'_, '_>,
        directivity: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let default = Medium::default();
        let speed = sound_speed.map(|speed| read::real("sound_speed", speed)).transpose()?;
        let temperature = temperature.map(|value| read::real("temperature", value)).transpose()?;
        let medium = Medium {
            frequency: read::real_or("frequency", frequency, default.frequency)?,
            sound_speed: Medium::sound_speed(speed, temperature).map_err(refused)?,
            absorption: read::real_or("absorption", absorption, default.absorption)?,
            density: read::real_or("density", density, default.density)?,
        };
        let array = adjusted(array.get().inner.clone(), source_pressure, directivity, None)?;
        let points = read::vectors("points", points)?;
        // Without points there is nothing to compare lengths with; the core says so.
        let request =
            if points.is_empty() { Request::default() } else { read::request(points.len(), pressures, weights)? };
        let scene = midair::Scene::new(array, medium, points, request).map_err(refused)?;
        Ok(Self { inner: Arc::new(scene) })
    }

    /// Reads a scene file: JSON by its ending .json, TOML by .toml, else by looking at it.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        Ok(Self { inner: Arc::new(crate::files::load(&path)?) })
    }

    /// Reads a scene from text (str or bytes), TOML or JSON by looking at it.
    ///
    /// name is what errors call it; files that it names are relative to folder, and refused without one.
    #[staticmethod]
    #[pyo3(signature = (text, *, name="scene", folder=None))]
    fn parse(text: &Bound<'_, PyAny>, name: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        Ok(Self { inner: Arc::new(crate::files::parse(text, name, folder.as_deref())?) })
    }

    /// Writes the scene as TOML or (by the ending .json) JSON, whole or not at all.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let text = files::write(&self.inner, Format::of(&path.to_string_lossy()), &Provenance::default());
        crate::files::save(py, &path, &text.map_err(refused)?)
    }

    /// The scene as JSON text; with a solution, as the record of how it was solved.
    #[pyo3(signature = (solution=None))]
    fn json(&self, solution: Option<&Bound<'_, Solution>>) -> PyResult<String> {
        let Some(solution) = solution else {
            return files::write(&self.inner, Format::Json, &Provenance::default()).map_err(refused);
        };
        let mut scene = (*self.inner).clone();
        scene.solver = Some((*solution.get().choice).clone());
        let provenance = Provenance {
            version: Some(env!("CARGO_PKG_VERSION").into()),
            status: Some(solution.get().inner.status.to_string()),
        };
        files::write(&scene, Format::Json, &provenance).map_err(refused)
    }

    /// The array.
    #[getter]
    fn array(&self) -> Array {
        Array { inner: self.inner.array().clone() }
    }

    /// Points (M, 3) in m.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.inner.points())
    }

    /// Pressures (M,) in Pa as given, or None.
    #[getter]
    fn pressures<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.inner.request().pressures.clone().map(|pressures| give::list(py, pressures))
    }

    /// Weights (M,) as given, or None.
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.inner.request().weights.clone().map(|weights| give::list(py, weights))
    }

    /// Frequency in Hz.
    #[getter]
    fn frequency(&self) -> f64 {
        self.inner.medium().frequency
    }

    /// Sound speed in m/s.
    #[getter]
    fn sound_speed(&self) -> f64 {
        self.inner.medium().sound_speed
    }

    /// Wavelength in m.
    #[getter]
    fn wavelength(&self) -> f64 {
        self.inner.medium().wavelength()
    }

    /// Absorption in Np/m.
    #[getter]
    fn absorption(&self) -> f64 {
        self.inner.medium().absorption
    }

    /// Density in kg/m^3.
    #[getter]
    fn density(&self) -> f64 {
        self.inner.medium().density
    }

    /// Whether pressures are in the paper's unit: eq. (5) in mm, which source_pressure = 1e-3 reproduces.
    #[getter]
    fn in_paper_unit(&self) -> bool {
        self.inner.array().in_paper_unit()
    }

    /// The solver the scene file names, (name, options), or None.
    #[getter]
    fn solver<'py>(&self, py: Python<'py>) -> PyResult<Option<(String, Bound<'py, PyDict>)>> {
        let Some(choice) = &self.inner.solver else { return Ok(None) };
        Ok(Some((choice.name.clone(), read::option_dict(py, &choice.table())?)))
    }

    /// The plane the scene file asks pictures of, or None.
    #[getter]
    fn plane(&self) -> Option<Plane> {
        self.inner.plane.map(|inner| Plane { inner })
    }

    /// G (M, N) in Pa, complex64: the pressure at point j of transducer i at full drive, eq. (5).
    fn propagation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<Complex32>>> {
        let propagation = midair::Propagation::of(&self.inner).with_instruction_set(instruction_set()?);
        let matrix = attend(py, None, |mut control| propagation.matrix(&mut control))?;
        give::table(py, matrix, [self.inner.points().len(), self.inner.array().len()])
    }

    /// What the array can do at the points: the strongest pressure at each alone, and at all of them together.
    fn reach(&self, py: Python<'_>) -> PyResult<Reach> {
        let set = instruction_set()?;
        let reach =
            |mut control: Control<'_>| midair::Problem::of_scene(&self.inner, set, &mut control)?.reach(&mut control);
        Ok(Reach { inner: attend(py, None, reach)? })
    }

    fn __repr__(&self) -> String {
        let (n, m) = (self.inner.array().len(), self.inner.points().len());
        format!("<midair.Scene of {n} transducers and {m} points at {} Hz>", self.inner.medium().frequency)
    }
}

/// What an array can do at a scene's points.
#[pyclass(frozen, module = "midair")]
pub(crate) struct Reach {
    inner: midair::Reach,
}

#[pymethods]
impl Reach {
    /// The strongest pressure at each point alone (M,) in Pa: the sum of |G|.
    #[getter]
    fn alone<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.inner.alone.clone())
    }

    /// The balanced level (M,) in Pa: what the array can make at all points together, in the ratios of the pressures, if
    /// they are a focal width apart.
    #[getter]
    fn level<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.inner.level.clone())
    }

    fn __repr__(&self) -> String {
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let (alone, level) = (most(&self.inner.alone), most(&self.inner.level));
        format!("<midair.Reach: up to {alone:.4} Pa alone, {level:.4} Pa together>")
    }
}
