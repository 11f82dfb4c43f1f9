//! `midair.Metrics` and `midair.BatchMetrics`.

use midair::Metrics as Core;

use crate::prelude::*;

/// Quality of a drive, over the points with a pressure and a weight above 0, x = |p| / target.
///
/// Examples
/// --------
/// >>> import midair
/// >>> metrics = midair.solve(midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]])).metrics
/// >>> metrics.uniformity, sorted(metrics.asdict())
/// (1.0, ['accuracy', 'leak', 'level', 'residual', 'sigma', 'uniformity'])
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Metrics(Core);

/// Declares the properties of both classes, whose names and documentation the core has.
macro_rules! define {
    ($($(#[$text:meta])* $name:ident)*) => {
        getters! { Metrics: $($(#[$text])* $name(self) -> f64 = self.0.$name;)* }
        getters! {
            BatchMetrics:
            $($(#[$text])* $name(self, py) -> Array1<'py, f64> =
                give::list(py, self.inner.iter().map(|metrics| metrics.$name).collect());)*
        }
    };
}
midair::metrics!(define);

impl From<Core> for Metrics {
    fn from(metrics: Core) -> Self {
        Self(metrics)
    }
}

hashed!(Metrics: self => self.0.values().map(bits));

#[pymethods]
impl Metrics {
    /// Return all six metrics by name.
    fn asdict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        Core::NAMES.iter().zip(self.0.values()).try_for_each(|(name, value)| dict.set_item(name, value))?;
        Ok(dict)
    }

    #[staticmethod]
    fn _restore(values: [f64; 6]) -> Self {
        Core::from_values(values).into()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        restored::<Self>(py, (self.0.values(),))
    }

    fn __repr__(&self) -> String {
        let parts = Core::NAMES.iter().zip(self.0.values()).map(|(name, value)| format!("{name}={value:.4}"));
        format!("Metrics({})", parts.collect::<Vec<_>>().join(", "))
    }
}

/// Quality of the drives of a batch: each metric an array (B,); see `Metrics`.
///
/// Examples
/// --------
/// >>> import midair
/// >>> batch = midair.solve_batch(midair.Array.preset("paper20"), [[[0, 0, 0.15]], [[0.02, 0, 0.15]]])
/// >>> batch.metrics.uniformity
/// array([1., 1.])
#[pyclass(frozen, eq, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct BatchMetrics {
    pub(crate) inner: Vec<Core>,
}

impl BatchMetrics {
    /// Returns the metrics as rows (B, 6).
    pub(crate) fn rows(&self) -> Vec<[f64; 6]> {
        self.inner.iter().map(|metrics| metrics.values()).collect()
    }

    pub(crate) fn of(rows: Vec<[f64; 6]>) -> Self {
        Self { inner: rows.into_iter().map(Core::from_values).collect() }
    }
}

#[pymethods]
impl BatchMetrics {
    /// Return all six metrics by name, each an array (B,).
    fn asdict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (dict, rows) = (PyDict::new(py), self.rows());
        for (k, name) in Core::NAMES.iter().enumerate() {
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
