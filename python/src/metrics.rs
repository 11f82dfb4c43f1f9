//! `midair.Metrics`.

use pyo3::prelude::*;

/// How good an answer is, over the points with a pressure and a weight above 0, x = |p| / target.
#[pyclass(frozen, get_all, eq, module = "midair")]
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

impl From<midair::Metrics> for Metrics {
    fn from(metrics: midair::Metrics) -> Self {
        let midair::Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
        Self { accuracy, sigma, uniformity, level, residual, leak }
    }
}

#[pymethods]
impl Metrics {
    fn __repr__(&self) -> String {
        let Self { accuracy, sigma, uniformity, level, residual, leak } = self;
        format!(
            "Metrics(accuracy={accuracy:.4}, sigma={sigma:.4}, uniformity={uniformity:.4}, level={level:.4}, residual={residual:.4}, leak={leak:.4})"
        )
    }
}
