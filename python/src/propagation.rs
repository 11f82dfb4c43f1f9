//! `midair.Propagation`.

use midair::{InstructionSet, Setup};

use crate::prelude::*;
use crate::quantization::{self, read_quantization};

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

hashed!(Propagation: self => self.shape());

#[pymethods]
impl Propagation {
    #[staticmethod]
    #[pyo3(name = "_new")]
    fn new(matrix: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (entries, points) = read::matrix("propagation", matrix)?;
        Ok(Self { inner: midair::Propagation::from_matrix(&entries, points).map_err(refused)? })
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

getters! {
    Propagation:

    /// Number of points M and of transducers N.
    shape(self) -> (usize, usize) = (self.inner.points(), self.inner.transducers());
}

/// A matrix with the setup that keywords give: a board's quantization, and places of the transducers.
#[derive(Clone, PartialEq)]
pub(crate) struct Matrix {
    pub(crate) propagation: midair::Propagation,
    pub(crate) setup: Arc<Setup>,
}

impl Matrix {
    /// Reads the keywords. A mask switches transducers of the matrix off.
    pub(crate) fn read(
        propagation: &midair::Propagation,
        [quantization, mask, positions]: [Argument<'_, '_>; 3],
    ) -> PyResult<Self> {
        let quantization = quantization.map(read_quantization).transpose()?.filter(|board| !board.is_continuous());
        let positions = positions.map(|value| read::vectors("positions", value)).transpose()?.map(Into::into);
        let propagation = propagation.clone().with_instruction_set(InstructionSet::requested().map_err(refused)?);
        let propagation = match mask {
            None => propagation,
            Some(mask) => propagation.with_mask(&read::flags("mask", mask)?).map_err(refused)?,
        };
        let setup = Setup { quantization: quantization.map(Arc::new), positions, ..Setup::default() };
        Ok(Self { propagation, setup: setup.into() })
    }

    /// Makes the problem of a request.
    pub(crate) fn problem(&self, request: &Request, control: &mut Control) -> Result<Problem, midair::Error> {
        Problem::watched(self.propagation.clone(), Arc::clone(&self.setup), request, control)
    }

    /// Writes the keywords, and returns the matrix as Python has it.
    pub(crate) fn write<'py>(&self, keywords: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
        let (py, Setup { quantization, positions, .. }) = (keywords.py(), &*self.setup);
        let board = quantization.as_deref().map(|board| quantization::object(py, board)).transpose()?;
        keywords.set_item("quantization", board)?;
        keywords.set_item("positions", positions.as_deref().map(|at| give::rows(py, at)).transpose()?)?;
        Ok(Bound::new(py, Propagation { inner: self.propagation.clone() })?.into_any())
    }
}
