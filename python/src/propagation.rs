//! `midair.Propagation`.

use std::hash::{Hash, Hasher};

use pyo3::prelude::*;

use crate::error::refused;
use crate::give;
use crate::pickle::Reduced;
use crate::read;

/// Propagation matrix G of your own: measured, or computed with obstacles.
///
/// Parameters
/// ----------
/// matrix : (M, N) array_like
///     Complex pressure in Pa at each point by each transducer at full drive.
///
/// Raises
/// ------
/// SceneError
///     For a matrix that is not (M, N) or has entries that are not finite.
///
/// Notes
/// -----
/// Pressures and weights, and quantization, mask and positions of its array, are arguments of `solve`, `Solver`,
/// `solve_batch`, `judge` and `bound`.
///
/// Examples
/// --------
/// >>> import midair, numpy as np
/// >>> solution = midair.solve(midair.Propagation(np.ones((1, 4))), pressures=4.0)
/// >>> round(solution.metrics.accuracy, 6)
/// 1.0
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct Propagation {
    pub(crate) inner: midair::Propagation,
}

impl Hash for Propagation {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.shape().hash(state);
    }
}

#[pymethods]
impl Propagation {
    #[staticmethod]
    #[pyo3(name = "_new")]
    fn new(matrix: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (entries, points) = read::matrix("propagation", matrix)?;
        Ok(Self { inner: midair::Propagation::from_matrix(&entries, points).map_err(refused)? })
    }

    /// Number of points M and of transducers N.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.inner.points(), self.inner.transducers())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, (points, transducers)) = (slf.py(), slf.get().shape());
        let entry = |k: usize| slf.get().inner.exact(k / transducers, k % transducers);
        let matrix = give::table(py, (0..points * transducers).map(entry).collect(), [points, transducers])?;
        Ok((slf.get_type().into_any(), (matrix,).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        let (m, n) = self.shape();
        format!("<midair.Propagation of {n} transducers at {m} points>")
    }
}
