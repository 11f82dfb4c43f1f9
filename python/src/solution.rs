//! `midair.Solution`.

use std::sync::Arc;

use midair::Complex32;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::give;
use crate::metrics::Metrics;
use crate::read;
use crate::scene::Scene;

/// A drive and what it does at the points.
#[pyclass(frozen, module = "midair")]
pub(crate) struct Solution {
    pub(crate) inner: midair::Solution,
    pub(crate) choice: Arc<midair::Choice>,
    /// The scene as it was given; where there was none, it is made of the answer when asked for.
    scene: Option<Arc<midair::Scene>>,
    trace: Option<Vec<f64>>,
    elapsed: f64,
}

impl Solution {
    pub(crate) fn new(inner: midair::Solution, choice: Arc<midair::Choice>, elapsed: f64) -> Self {
        Self { inner, choice, scene: None, trace: None, elapsed }
    }

    /// The same with the scene it was solved for, and the residual after each step.
    pub(crate) fn of(self, scene: Option<Arc<midair::Scene>>, trace: Option<Vec<f64>>) -> Self {
        Self { scene, trace, ..self }
    }
}

#[pymethods]
impl Solution {
    /// Drives q (N,), complex64, |q| <= 1.
    #[getter]
    fn drive<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<Complex32>> {
        give::list(py, self.inner.drive.clone())
    }

    /// Phases (N,) in rad in [0, 2 pi); 0 where the drive is 0.
    #[getter]
    fn phases<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, (0..self.inner.drive.len()).map(|i| self.inner.phase(i)).collect())
    }

    /// Amplitudes (N,), 0 to 1.
    #[getter]
    fn amplitudes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, (0..self.inner.drive.len()).map(|i| self.inner.amplitude(i)).collect())
    }

    /// Complex pressures (M,) in Pa (peak), complex64.
    #[getter]
    fn pressures<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<Complex32>> {
        give::list(py, self.inner.pressures.clone())
    }

    /// Radiation pressures (M,) in Pa, |p|^2/(rho c^2).
    #[getter]
    fn radiation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, (0..self.inner.pressures.len()).map(|j| self.inner.radiation(j)).collect())
    }

    /// Targets (M,) in Pa that the metrics refer to.
    #[getter]
    fn targets<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.inner.targets().to_vec())
    }

    /// How good it is.
    #[getter]
    fn metrics(&self) -> Metrics {
        self.inner.metrics().into()
    }

    /// How the solve ended: "done", "out_of_steps" or "stopped".
    #[getter]
    fn status(&self) -> String {
        self.inner.status.to_string()
    }

    /// Steps taken.
    #[getter]
    fn steps(&self) -> usize {
        self.inner.steps
    }

    /// What supply or modulation have to multiply all drives by, at most 1: below 1 where the device has
    /// no amplitude for the answer. The pressures count it in, the drives do not.
    #[getter]
    fn scale(&self) -> f64 {
        self.inner.scale
    }

    /// Seconds from the checked scene to the answer.
    #[getter]
    fn elapsed(&self) -> f64 {
        self.elapsed
    }

    /// The residual after each step (steps,), or None where no trace was asked for.
    #[getter]
    fn trace<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.trace.clone().map(|trace| give::list(py, trace))
    }

    /// The scene that it answers, or None for a matrix of one's own.
    #[getter]
    fn scene(&self) -> Option<Scene> {
        self.scene.clone().or_else(|| self.inner.scene().map(Arc::new)).map(|inner| Scene { inner })
    }

    /// The solver's name.
    #[getter]
    fn solver(&self) -> &str {
        &self.choice.name
    }

    /// Every option in full, whether the targets were balanced, and the aim where the method uses one.
    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        read::option_dict(py, &self.choice.table())
    }

    fn __repr__(&self) -> String {
        let metrics = self.inner.metrics();
        let (name, status) = (&self.choice.name, self.inner.status);
        let (accuracy, sigma) = (metrics.accuracy, metrics.sigma);
        let scale = self.inner.scale;
        let supply = if scale < 1.0 { format!(", drives to be scaled by {scale:.4}") } else { String::new() };
        format!("<midair.Solution by {name}: {status}, accuracy {accuracy:.4}, sigma {sigma:.4}{supply}>")
    }
}

/// A start: a Solution or complex numbers are a drive (N,), real numbers are point phases (M,).
pub(crate) fn begin(start: &Bound<'_, PyAny>) -> PyResult<midair::Start> {
    if let Ok(solution) = start.cast::<Solution>() {
        return Ok(midair::Start::Drive(solution.get().inner.drive.clone()));
    }
    read::start("start", start)
}
