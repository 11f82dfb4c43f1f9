//! A cost function written in Python, by which a solver compares its candidates.

use midair::solvers::{ActiveRequest, Configured, Energy};
use midair::{Complex32, Error};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{invalid, refused};
use crate::function::Raised;
use crate::read;

/// A Python function of the candidates' pressures (K, M), targets (M,) and weights (M,); and the exception that it raised.
pub(crate) struct Function {
    function: Py<PyAny>,
    raised: Raised,
}

impl Function {
    /// Removes `objective` from the options and returns it, if it is a function.
    pub(crate) fn take<'py>(
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<(Option<Self>, Option<Bound<'py, PyDict>>)> {
        let Some(options) = options else { return Ok((None, None)) };
        match options.get_item("objective")? {
            Some(function) if function.is_callable() => {
                let rest = options.copy()?;
                rest.del_item("objective")?;
                Ok((Some(Self { function: function.unbind(), raised: Raised::default() }), Some(rest)))
            }
            _ => Ok((None, Some(options.clone()))),
        }
    }

    /// Returns a shared reference to the exception that the function has raised, if any.
    pub(crate) fn raised(&self) -> Raised {
        self.raised.clone()
    }

    /// Returns the solver with this cost function. The label of the objective is the function's name, or that of its class.
    pub(crate) fn configured(self, py: Python<'_>, solver: Configured) -> PyResult<Configured> {
        let function = self.function.bind(py);
        let name = function.getattr("__name__").and_then(|name| name.extract());
        let name = name.or_else(|_| function.get_type().name()?.extract())?;
        solver.by_energy(Box::new(self), name).map_err(refused)
    }

    fn call(&self, py: Python<'_>, fields: &[Complex32], request: &ActiveRequest, count: usize) -> PyResult<Vec<f64>> {
        let fields = fields.to_vec().into_pyarray(py).reshape([count, request.targets.len()])?;
        let targets = request.targets.clone().into_pyarray(py);
        let weights = request.weights.clone().into_pyarray(py);
        let values = self.function.bind(py).call1((fields, targets, weights))?;
        let values = read::reals("objective", &values)?;
        if values.len() == count {
            return Ok(values);
        }
        let cure = format!("return one for each of the {count} candidates");
        Err(invalid("objective", &format!("{} values", values.len()), &cure))
    }
}

impl Energy for Function {
    fn evaluate(&self, fields: &[Complex32], request: &ActiveRequest, values: &mut [f64]) -> Result<(), Error> {
        let result = Python::attach(|py| self.call(py, fields, request, values.len()));
        match result {
            Ok(list) => {
                values.copy_from_slice(&list);
                Ok(())
            }
            Err(error) => {
                self.raised.keep(error);
                Err(Error::invalid("objective", "a function", "it raised an exception"))
            }
        }
    }
}
