//! `midair.Metrics` and `midair.BatchMetrics`.

use std::hash::{Hash, Hasher};

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::give;
use crate::pickle::{Reduced, restored};

/// How good an answer is, over the points with a pressure and a weight above 0, x = |p| / target.
#[pyclass(frozen, get_all, eq, hash, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Metrics {
    /// sum |p| / sum target: eq. (12).
    accuracy: f64,
    /// Standard deviation of x / max x: eq. (13) for equal targets.
    sigma: f64,
    /// min x / max x.
    uniformity: f64,
    /// Mean x.
    level: f64,
    /// sum w (target - |p|)^2 / sum w target^2.
    residual: f64,
    /// max |p| over the quiet points over the largest target.
    leak: f64,
}

const NAMES: [&str; 6] = ["accuracy", "sigma", "uniformity", "level", "residual", "leak"];

impl From<midair::Metrics> for Metrics {
    fn from(metrics: midair::Metrics) -> Self {
        let midair::Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
        Self { accuracy, sigma, uniformity, level, residual, leak }
    }
}

/// From values in the order of [`NAMES`].
fn made_of([accuracy, sigma, uniformity, level, residual, leak]: [f64; 6]) -> midair::Metrics {
    midair::Metrics { accuracy, sigma, uniformity, level, residual, leak }
}

impl Hash for Metrics {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // 0 and -0 are equal.
        self.values().map(|value| (value + 0.0).to_bits()).hash(state);
    }
}

impl Metrics {
    /// In the order of [`NAMES`].
    fn values(&self) -> [f64; 6] {
        let Self { accuracy, sigma, uniformity, level, residual, leak } = *self;
        [accuracy, sigma, uniformity, level, residual, leak]
    }
}

#[pymethods]
impl Metrics {
    /// All six by name.
    fn asdict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        NAMES.iter().zip(self.values()).try_for_each(|(name, value)| dict.set_item(name, value))?;
        Ok(dict)
    }

    #[staticmethod]
    fn _restore(values: [f64; 6]) -> Self {
        made_of(values).into()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        restored::<Self>(py, (self.values(),))
    }

    fn __repr__(&self) -> String {
        let parts = NAMES.iter().zip(self.values()).map(|(name, value)| format!("{name}={value:.4}"));
        format!("Metrics({})", parts.collect::<Vec<_>>().join(", "))
    }
}

/// How good the answers of a batch are: each an array (B,); see `Metrics`.
#[pyclass(frozen, eq, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct BatchMetrics {
    pub(crate) inner: Vec<midair::Metrics>,
}

impl BatchMetrics {
    fn each<'py>(&self, py: Python<'py>, part: fn(&midair::Metrics) -> f64) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.inner.iter().map(part).collect())
    }

    /// (B, 6).
    pub(crate) fn rows(&self) -> Vec<[f64; 6]> {
        self.inner.iter().map(|&metrics| Metrics::from(metrics).values()).collect()
    }

    pub(crate) fn of(rows: Vec<[f64; 6]>) -> Self {
        Self { inner: rows.into_iter().map(made_of).collect() }
    }
}

#[pymethods]
impl BatchMetrics {
    /// sum |p| / sum target: eq. (12).
    #[getter]
    fn accuracy<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.accuracy)
    }

    /// Standard deviation of x / max x: eq. (13) for equal targets.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.sigma)
    }

    /// min x / max x.
    #[getter]
    fn uniformity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.uniformity)
    }

    /// Mean x.
    #[getter]
    fn level<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.level)
    }

    /// sum w (target - |p|)^2 / sum w target^2.
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.residual)
    }

    /// max |p| over the quiet points over the largest target.
    #[getter]
    fn leak<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |metrics| metrics.leak)
    }

    /// All six arrays (B,) by name.
    fn asdict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (dict, rows) = (PyDict::new(py), self.rows());
        for (k, name) in NAMES.iter().enumerate() {
            dict.set_item(name, give::list(py, rows.iter().map(|row| row[k]).collect()))?;
        }
        Ok(dict)
    }

    #[staticmethod]
    fn _restore(rows: Vec<[f64; 6]>) -> Self {
        Self::of(rows)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        restored::<Self>(py, (self.rows(),))
    }

    fn __repr__(&self) -> String {
        format!("<midair.BatchMetrics of {} problems>", self.inner.len())
    }
}
