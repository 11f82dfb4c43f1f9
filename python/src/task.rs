//! The first argument of `midair.solve` and `midair.judge`.

use std::sync::Arc;

use midair::{InstructionSet, Problem};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::invalid;
use crate::scene::{Propagation, Scene, request};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// What `solve` and `judge` take first: a scene, or propagation with what is asked of them.
pub(crate) enum Task {
    Scene(Arc<midair::Scene>),
    Propagation(midair::Propagation, midair::Request),
}

impl Task {
    pub(crate) fn read(
        object: &Bound<'_, PyAny>,
        pressures: Argument<'_, '_>,
        weights: Argument<'_, '_>,
    ) -> PyResult<Self> {
        if let Ok(scene) = object.cast::<Scene>() {
            for (item, value) in [("pressures", pressures), ("weights", weights)] {
                if value.is_some() {
                    return Err(invalid(
                        item,
                        "given beside a Scene",
                        "give them to the Scene; here they go with Propagation",
                    ));
                }
            }
            return Ok(Self::Scene(Arc::clone(&scene.get().inner)));
        }
        if let Ok(propagation) = object.cast::<Propagation>() {
            let propagation = propagation.get().inner.clone();
            let request = request(propagation.points(), pressures, weights)?;
            return Ok(Self::Propagation(propagation, request));
        }
        let kind = object.get_type().qualname()?;
        Err(PyTypeError::new_err(format!("expected a midair.Scene or midair.Propagation first, not {kind}")))
    }

    pub(crate) fn problem(&self, set: InstructionSet) -> Result<Problem, midair::Error> {
        let (propagation, request) = match self {
            Self::Scene(scene) => (midair::Propagation::of(scene), scene.request()),
            Self::Propagation(propagation, request) => (propagation.clone(), request),
        };
        Problem::with_propagation(propagation.with_instruction_set(set), request)
    }

    /// The levels of the scene's device.
    pub(crate) fn quantization(&self) -> Option<&midair::Quantization> {
        match self {
            Self::Scene(scene) => scene.array().quantization(),
            Self::Propagation(..) => None,
        }
    }

    /// The solver the scene file names.
    pub(crate) fn choice(&self) -> Option<&midair::Choice> {
        match self {
            Self::Scene(scene) => scene.solver.as_ref(),
            Self::Propagation(..) => None,
        }
    }
}
