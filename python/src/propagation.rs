//! `midair.Propagation`.

use pyo3::prelude::*;

use crate::error::refused;
use crate::read;

/// A user's own G (M, N) in Pa: measured, or computed with obstacles.
///
/// Pressures and weights, and the quantization, mask and positions of the array behind it, then go to `solve`, `Solver`,
/// `solve_batch`, `judge` and `bound`.
///
/// >>> import midair, numpy as np
/// >>> solution = midair.solve(midair.Propagation(np.ones((1, 4))), pressures=4.0)
/// >>> round(solution.metrics.accuracy, 6)
/// 1.0
#[pyclass(frozen, module = "midair")]
pub(crate) struct Propagation {
    pub(crate) inner: midair::Propagation,
}

#[pymethods]
impl Propagation {
    #[new]
    fn new(matrix: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (entries, points) = read::matrix("propagation", matrix)?;
        Ok(Self { inner: midair::Propagation::from_matrix(&entries, points).map_err(refused)? })
    }

    /// (M, N): points and transducers.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.inner.points(), self.inner.transducers())
    }

    fn __repr__(&self) -> String {
        let (m, n) = self.shape();
        format!("<midair.Propagation of {n} transducers at {m} points>")
    }
}
