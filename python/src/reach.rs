//! `midair.Reach`.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::give;
use crate::pickle::pickled;

/// Capability of an array at a scene's points; from `Scene.reach`.
///
/// Examples
/// --------
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
/// >>> bool((scene.reach().level < scene.reach().alone).all())
/// True
#[pyclass(frozen, eq, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct Reach {
    pub(crate) alone: Vec<f64>,
    pub(crate) level: Vec<f64>,
}

pickled!(Reach: alone: Vec<f64>, level: Vec<f64>);

#[pymethods]
impl Reach {
    /// The highest pressure at each point alone (M,) in Pa: the sum of |G|.
    #[getter]
    fn alone<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.alone.clone())
    }

    /// The balanced level (M,) in Pa: the pressures that the array can make at all points together, in the ratios of the
    /// requested pressures. It assumes points at least a focal width apart.
    #[getter]
    fn level<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.level.clone())
    }

    fn __repr__(&self) -> String {
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let (alone, level) = (most(&self.alone), most(&self.level));
        format!("<midair.Reach: up to {alone:.4} Pa alone, {level:.4} Pa together>")
    }
}
