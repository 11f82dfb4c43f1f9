//! Common part of `midair.Solver` and `solve_batch`: makes a session from transducers, a solver and keywords.

use std::sync::Arc;

use midair::solvers::{Configured, Info, configure};
use midair::{Choice, Control, Model, Problem, Request, Session, Setup};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyDictMethods};

use crate::array::Array;
use crate::bead::{read_bead, shown_bead};
use crate::error::{invalid, refused, warn_all};
use crate::give::rows;
use crate::keywords::Keywords;
use crate::obstacle::{read_obstacles, shown_obstacles};
use crate::propagation::Propagation;
use crate::quantization::shown;
use crate::read;
use crate::ready::Ready;
use crate::scene::Scene;
use crate::signature::{read_signature, shown_signature};
use crate::subject::{Beside, given};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// A session, and the choices from which it was made.
pub(crate) struct Setting {
    pub(crate) session: Session,
    pub(crate) choice: Choice,
    pub(crate) info: &'static Info,
    pub(crate) source: Source,
}

/// Returns the choice (solver, options, balance, aim) for a solution's record, with the problem's aim if the method uses one.
pub(crate) fn answered(choice: &Arc<Choice>, info: &Info, problem: Option<&Problem>) -> Arc<Choice> {
    match problem {
        Some(problem) if info.uses_aim => Arc::new(Choice { aim: Some(problem.aim()), ..Choice::clone(choice) }),
        _ => Arc::clone(choice),
    }
}

/// Where a session gets G from: a model, or a given matrix.
pub(crate) enum Source {
    Model(Model),
    Given(midair::Propagation, Arc<Setup>),
}

impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Model(own), Self::Model(other)) => {
                let same = own.array() == other.array() && own.medium() == other.medium();
                let same = same && own.bead() == other.bead();
                same && own.signature() == other.signature() && own.obstacles() == other.obstacles()
            }
            (Self::Given(own, setup), Self::Given(other, its)) => own == other && setup == its,
            _ => false,
        }
    }
}

impl Source {
    /// Makes one problem of a session again.
    pub(crate) fn problem(
        &self,
        points: &[[f64; 3]],
        request: &Request,
        control: &mut Control,
    ) -> Result<Problem, midair::Error> {
        match self {
            Self::Model(model) => Problem::of_model(model, points, request, control),
            Self::Given(propagation, setup) => {
                Problem::watched(propagation.clone(), Arc::clone(setup), request, control)
            }
        }
    }

    /// Returns the first argument and the keywords from which the setting can be made again.
    pub(crate) fn arguments<'py>(
        &self,
        py: Python<'py>,
        choice: &Choice,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let keywords = read::option_dict(py, &choice.table())?;
        let first = match self {
            Self::Model(model) => {
                for (name, value) in model.medium().numbers() {
                    keywords.set_item(name, value)?;
                }
                let shown = shown_signature(py, model.signature(), model.array().len())?;
                keywords.set_item("signature", shown)?;
                keywords.set_item("bead", shown_bead(py, model.bead())?)?;
                keywords.set_item("obstacles", shown_obstacles(py, model.obstacles())?)?;
                Bound::new(py, Array::from(model.array().clone()))?.into_any()
            }
            Self::Given(propagation, setup) => {
                keywords.set_item(
                    "quantization",
                    setup.quantization.as_deref().map(|board| shown(py, board)).transpose()?,
                )?;
                keywords.set_item("positions", setup.positions.as_deref().map(|at| rows(py, at)).transpose()?)?;
                Bound::new(py, Propagation { inner: propagation.clone() })?.into_any()
            }
        };
        Ok((first, keywords))
    }
}

impl Setting {
    /// Reads a Scene (its array, medium and solver), an Array or a Propagation, and keywords: the Scene's, `signature`,
    /// `bead`, `obstacles`, `balance`, `aim`, and the solver's options.
    pub(crate) fn read(
        object: &Bound<'_, PyAny>,
        solver: Argument<'_, '_>,
        keywords: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let keywords = Keywords::of(object.py(), keywords)?;
        let (signature, obstacles) = (keywords.take_or_none("signature")?, keywords.take_or_none("obstacles")?);
        let bead = keywords.take("bead")?;
        let (balance, aim, positions) = (keywords.take("balance")?, keywords.take("aim")?, keywords.take("positions")?);
        let balance = balance.map(|value| read::flag("balance", &value)).transpose()?;
        let aim = aim.map(|value| read::aim(&value)).transpose()?;
        let chosen = |own: Option<&Choice>, board: Option<&midair::Quantization>| {
            let mut choice = read::chosen(own, solver, Some(keywords.rest()))?;
            (choice.balance, choice.aim) = (balance.or(choice.balance), aim.or(choice.aim));
            let configured = configure(&choice, board).map_err(refused)?;
            choice.balance = Some(choice.balance.unwrap_or(configured.info.balance));
            choice.options.clone_from(&configured.options);
            Ok::<_, PyErr>((choice, configured))
        };
        if let Ok(matrix) = object.cast::<Propagation>() {
            if signature.is_some_and(|signature| !signature.is_none()) {
                return Err(invalid(
                    "signature",
                    "given",
                    "multiply the matrix by it: it goes with a Scene or an Array",
                ));
            }
            if obstacles.is_some_and(|obstacles| !obstacles.is_none()) {
                return Err(invalid("obstacles", "given", "a matrix has them in it: they go with a Scene or an Array"));
            }
            if bead.is_some() {
                return Err(invalid("bead", "given", "a matrix has no traps: it goes with a Scene or an Array"));
            }
            let (quantization, mask) = (keywords.take("quantization")?, keywords.take("mask")?);
            let (quantization, mask, positions) = (quantization.as_ref(), mask.as_ref(), positions.as_ref());
            let beside = Beside { quantization, mask, positions, ..Beside::default() };
            let (propagation, setup) = given(&matrix.get().inner, beside)?;
            let (choice, Configured { solver, info, .. }) = chosen(None, setup.quantization.as_deref())?;
            let source = Source::Given(propagation.clone(), Arc::new(setup.clone()));
            let session = Session::with_propagation(propagation, setup, solver, choice.balance == Some(true));
            return Ok(Self { session: session.map_err(refused)?, choice, info, source });
        }
        if positions.is_some() {
            return Err(invalid("positions", "given", "an array has its own: they go with Propagation"));
        }
        let scene = object.cast::<Scene>().ok().map(Bound::get);
        let (array, medium) = match (scene, object.cast::<Array>()) {
            (Some(scene), _) => (scene.array(), Some(scene.inner.medium())),
            (None, Ok(array)) => (array.get().clone(), None),
            (None, Err(_)) => {
                let kind = object.get_type().qualname()?;
                return Err(PyTypeError::new_err(format!(
                    "expected a midair.Scene, midair.Array or midair.Propagation first, not {kind}"
                )));
            }
        };
        let signature = match signature {
            None => scene.and_then(|scene| scene.inner.signature()).cloned(),
            Some(none) if none.is_none() => None,
            Some(signature) => Some(read_signature(&signature, array.inner.len())?),
        };
        let medium = keywords.medium(medium, &array)?;
        let ready = keywords.array(array)?.ready(medium)?;
        let Ready { model, doubts, .. } = &*ready;
        let reported = scene.map_or(&[][..], |scene| &scene.ready.doubts);
        warn_all(object.py(), doubts.iter().filter(|doubt| !reported.contains(doubt)))?;
        let own = scene.and_then(|scene| scene.inner.solver.as_ref());
        let (choice, configured) = chosen(own, model.array().quantization())?;
        let behind = scene.map_or(&[][..], |scene| scene.inner.obstacles());
        let obstacles = obstacles.map_or_else(|| Ok(behind.to_vec()), |given| read_obstacles(&given))?;
        let bead = bead.map(|bead| read_bead(&bead)).transpose()?;
        let bead = bead.or(scene.map(|scene| scene.inner.bead())).unwrap_or_default();
        let model = ready.behind(object.py(), &obstacles)?.with_signature(signature).with_bead(bead);
        let info = configured.info;
        let session = Session::configured(model.clone(), configured, choice.balance);
        Ok(Self { session, choice, info, source: Source::Model(model) })
    }
}
