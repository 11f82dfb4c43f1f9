//! Common part of `midair.Solver` and `solve_batch`: makes a session from transducers, a solver and keywords.

use midair::solvers::Configured;
use midair::{Session, Setup};

use crate::array::Array;
use crate::bead;
use crate::bodies::obstacle_objects;
use crate::chosen::{Chosen, Naming};
use crate::function::Raised;
use crate::keywords::Keywords;
use crate::prelude::*;
use crate::propagation::{Matrix, Propagation};
use crate::scene::Scene;
use crate::signature::signature_object;

/// A session, and the choices from which it was made.
pub(crate) struct Setting {
    pub(crate) session: Session,
    pub(crate) chosen: Chosen,
    pub(crate) source: Source,
    /// Where a solver that is a function stores an exception.
    pub(crate) raised: Raised,
}

/// Keywords that a matrix does not take, each with the cure.
const NOT_OF_A_MATRIX: [(&str, &str); 3] = [
    ("signature", "multiply the matrix by it: it goes with a Scene or an Array"),
    ("obstacles", "a matrix has them in it: they go with a Scene or an Array"),
    ("bead", "a matrix has no traps: it goes with a Scene or an Array"),
];

/// Where a session gets G from: a model, or a given matrix.
pub(crate) enum Source {
    Model(Model),
    Given(Matrix),
}

impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Model(model), Self::Model(other)) => {
                let same = model.array() == other.array() && model.medium() == other.medium();
                let same = same && model.bead() == other.bead();
                same && model.signature() == other.signature() && model.obstacles() == other.obstacles()
            }
            (Self::Given(matrix), Self::Given(other)) => matrix == other,
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
            Self::Given(matrix) => matrix.problem(request, control),
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
                let signature = signature_object(py, model.signature(), model.array().len())?;
                keywords.set_item("signature", signature)?;
                keywords.set_item("bead", bead::Bead(model.bead()))?;
                keywords.set_item("obstacles", obstacle_objects(py, model.obstacles())?)?;
                Bound::new(py, Array::from(model.array().clone()))?.into_any()
            }
            Self::Given(matrix) => matrix.write(&keywords)?,
        };
        Ok((first, keywords))
    }
}

/// Returns the points of a call; None for a matrix, which has its own.
pub(crate) fn points_of<T>(session: &Session, points: Option<T>, shape: &str) -> PyResult<Option<T>> {
    match (session.given_points(), points) {
        (None, Some(points)) => Ok(Some(points)),
        (Some(_), None) => Ok(None),
        (Some(_), Some(_)) => Err(invalid("points", "given", "a matrix has its own points: leave them out")),
        (None, None) => Err(invalid("points", "left out", &format!("give them, of shape {shape}, in metres"))),
    }
}

impl Setting {
    /// Reads a Scene (its array, medium and solver), an Array or a Propagation, and keywords: the Scene's, `signature`,
    /// `bead`, `obstacles`, `balance`, `aim`, and the solver's options. The solver may be a function in Python.
    pub(crate) fn read(
        object: &Bound<'_, PyAny>,
        solver: Argument<'_, '_>,
        keywords: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let py = object.py();
        let keywords = Keywords::of(py, keywords)?;
        let (balance, aim, positions) = (keywords.take("balance")?, keywords.take("aim")?, keywords.take("positions")?);
        let naming = Naming { solver, balance: balance.as_ref(), aim: aim.as_ref() };
        if let Ok(matrix) = object.cast::<Propagation>() {
            for (name, cure) in NOT_OF_A_MATRIX {
                if keywords.take(name)?.is_some() {
                    return Err(invalid(name, "given", cure));
                }
            }
            let (quantization, mask) = (keywords.take("quantization")?, keywords.take("mask")?);
            let setup = [quantization.as_ref(), mask.as_ref(), positions.as_ref()];
            let matrix = Matrix::read(&matrix.get().inner, setup)?;
            let board = matrix.setup.quantization.as_deref();
            let own = Chosen::read_with_functions(py, None, board, naming, Some(keywords.rest()))?;
            let (chosen, Configured { solver, .. }, raised) = own;
            let Matrix { propagation, setup } = matrix.clone();
            let session = Session::with_propagation(propagation, Setup::clone(&setup), solver, chosen.balances());
            return Ok(Self { session: session.map_err(refused)?, chosen, source: Source::Given(matrix), raised });
        }
        if positions.is_some() {
            return Err(invalid("positions", "given", "an array has its own: they go with Propagation"));
        }
        let scene = object.cast::<Scene>().ok().map(Bound::get);
        let (array, medium, mut extras) = match (scene, object.cast::<Array>()) {
            (Some(scene), _) => (scene.array(), Some(scene.inner.medium()), scene.inner.extras()),
            (None, Ok(array)) => (array.get().clone(), None, Extras::default()),
            _ => return Err(unexpected(object, "a midair.Scene, midair.Array or midair.Propagation", "")),
        };
        keywords.write_extras(&mut extras, array.inner.len())?;
        let medium = keywords.medium(medium, &array)?;
        let ready = keywords.array(array)?.ready(medium)?;
        let reported = scene.map_or(&[][..], |scene| &scene.ready.doubts);
        warn_all(py, ready.doubts.iter().filter(|doubt| !reported.contains(doubt)))?;
        let (file, board) = (extras.solver.as_ref(), ready.model.array().quantization());
        let own = Chosen::read_with_functions(py, file, board, naming, Some(keywords.rest()))?;
        let (chosen, Configured { solver, .. }, raised) = own;
        let model = ready.model_with(py, extras)?;
        let session = Session::new(model.clone(), solver, chosen.balances());
        Ok(Self { session, chosen, source: Source::Model(model), raised })
    }
}
