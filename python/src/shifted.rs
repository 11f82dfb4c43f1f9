//! Sparse systems for many shifts, for `midair.skin` on a mesh.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::ctrl_c::attend;
use crate::give;
use crate::instruction_set::instruction_set;
use crate::read;

/// Systems (A + s B) x = b with a sparse symmetric A and a diagonal B, as the core's `Shifted`.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Shifted {
    inner: midair::touch::Shifted,
}

#[pymethods]
impl Shifted {
    #[new]
    fn new(starts: Vec<usize>, rows: Vec<u32>, values: Vec<f64>, shares: Vec<f64>) -> PyResult<Self> {
        Ok(Self {
            inner: midair::touch::Shifted::new(&starts, &rows, &values, &shares).map_err(crate::error::refused)?,
        })
    }

    /// The solutions (L V,) for shifts (L,) and loads (L V,), one after another.
    fn solve<'py>(
        &self,
        py: Python<'py>,
        shifts: &Bound<'py, PyAny>,
        loads: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<midair::Complex32>>> {
        let (shifts, loads, set) =
            (read::complexes("shifts", shifts)?, read::drive("loads", loads)?, instruction_set()?);
        let solutions = attend(py, None, |mut control| self.inner.solve(set, &shifts, &loads, &mut control))?;
        Ok(give::list(py, solutions))
    }
}
