//! Functions in Python: a solver, of G, targets and weights; and a cost, by which a solver compares its candidates.

use std::sync::{Mutex, PoisonError};

use midair::solvers::{ActiveRequest, Configured, Energy, Info, unused};
use midair::{Error, Solution, Solve, Workspace};

use crate::prelude::*;

/// Properties of all solvers that are Python functions: they do not balance, and use neither a start nor an aim.
static INFO: Info = Info::new("function", "a function in Python", "the caller's own");

/// Stores the exception of a Python function, so that the binding can raise it after the core has returned.
#[derive(Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    fn keep(&self, error: PyErr, item: &str, name: &str) -> Error {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        Error::invalid(item, name, "it raised an exception")
    }

    pub(crate) fn check(&self) -> PyResult<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
    }
}

/// A Python function, and the keywords with which it is called.
pub(crate) struct Function {
    solver: Py<PyAny>,
    keywords: Option<Py<PyDict>>,
    name: String,
    pub(crate) raised: Raised,
}

impl Function {
    /// Returns `solver` as a function, or None if it is not callable.
    pub(crate) fn read(solver: &Bound<'_, PyAny>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Option<Self>> {
        if !solver.is_callable() {
            return Ok(None);
        }
        // A functools.partial has no name; its function has. Other callable objects are named by their class.
        let name = solver.getattr("__name__").or_else(|_| solver.getattr("func")?.getattr("__name__"));
        let name = name.and_then(|name| name.extract()).or_else(|_| solver.get_type().name()?.extract())?;
        // A function of Python tells which arguments it takes; those of other languages may not.
        let signature = solver.py().import("inspect")?.call_method1("signature", (solver,));
        if let Some(error) = signature.ok().and_then(|it| it.call_method("bind", (0, 0, 0), keywords).err()) {
            let cure = "a solver is called as solver(propagation, targets, weights) and returns a drive (N,)";
            return Err(PyTypeError::new_err(format!("{name}: {}: {cure}", error.value(solver.py()))));
        }
        let keywords = keywords.map(|keywords| keywords.clone().unbind());
        Ok(Some(Self { solver: solver.clone().unbind(), keywords, name, raised: Raised::default() }))
    }

    /// Returns the label of the function's solutions: its name and keywords.
    pub(crate) fn choice(&self, py: Python<'_>) -> PyResult<Choice> {
        let options = read::options(self.keywords.as_ref().map(|keywords| keywords.bind(py)))?;
        Ok(Choice { name: self.name.clone(), options, balance: None, aim: None })
    }

    /// Returns the function as a configured method, like those of the registry.
    pub(crate) fn configured(self, choice: &Choice) -> PyResult<Configured> {
        if choice.aim.is_some() {
            return Err(refused(unused("aim", &self.name, |info| info.uses_aim)));
        }
        Ok(Configured { info: &INFO, options: choice.options.clone(), solver: Box::new(self) })
    }

    fn call(&self, py: Python<'_>, matrix: Vec<Complex32>, problem: &Problem) -> PyResult<Vec<Complex32>> {
        let (count, transducers) = (problem.propagation().points(), problem.propagation().transducers());
        let matrix = matrix.into_pyarray(py).reshape([count, transducers])?;
        let targets = match problem.complex_targets_in_pascals() {
            Some(targets) => targets.collect::<Vec<_>>().into_pyarray(py).into_any(),
            None => problem.active_targets_in_pascals().collect::<Vec<_>>().into_pyarray(py).into_any(),
        };
        let weights = problem.weights()[..count].iter().map(|&w| f64::from(w)).collect::<Vec<_>>().into_pyarray(py);
        let keywords = self.keywords.as_ref().map(|keywords| keywords.bind(py));
        let drive = self.solver.bind(py).call((matrix, targets, weights), keywords)?;
        read::drive(&format!("drive by {}", self.name), &drive)
    }
}

impl Solve for Function {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution, Error> {
        let matrix = problem.plain_propagation().matrix(control)?;
        let drive = Python::attach(|py| self.call(py, matrix, problem));
        let drive = drive.map_err(|error| self.raised.keep(error, "solver", &self.name))?;
        Solution::checked(problem, drive, work, control).map_err(|error| {
            let item = format!("{} by {}", error.item, self.name);
            if error.is_stop() { error } else { error.about(item) }
        })
    }

    fn uses_phases(&self) -> bool {
        true
    }
}

/// A Python function of the candidates' pressures (K, M), targets (M,) and weights (M,); and the exception that it raised.
pub(crate) struct Objective {
    function: Py<PyAny>,
    pub(crate) raised: Raised,
}

impl Objective {
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

impl Energy for Objective {
    fn evaluate(&self, fields: &[Complex32], request: &ActiveRequest, values: &mut [f64]) -> Result<(), Error> {
        let list = Python::attach(|py| self.call(py, fields, request, values.len()));
        values.copy_from_slice(&list.map_err(|error| self.raised.keep(error, "objective", "a function"))?);
        Ok(())
    }
}
