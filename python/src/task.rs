//! The first argument of `midair.solve` and `midair.judge`.

use std::sync::Arc;

use midair::{Level, Problem};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::invalid;
use crate::scene::{Gains, Scene, request};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// What `solve` and `judge` take first: a scene, or gains with what is asked of them.
pub(crate) enum Task {
    Scene(Arc<midair::Scene>),
    Gains(midair::Gains, midair::Request),
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
                        "give them to the Scene; here they go with Gains",
                    ));
                }
            }
            return Ok(Self::Scene(Arc::clone(&scene.get().inner)));
        }
        if let Ok(gains) = object.cast::<Gains>() {
            let gains = gains.get().inner.clone();
            let request = request(gains.points(), pressures, weights)?;
            return Ok(Self::Gains(gains, request));
        }
        let kind = object.get_type().qualname()?;
        Err(PyTypeError::new_err(format!("expected a midair.Scene or midair.Gains first, not {kind}")))
    }

    pub(crate) fn problem(&self, level: Level) -> Result<Problem, midair::Error> {
        let (gains, request) = match self {
            Self::Scene(scene) => (midair::Gains::of(scene), scene.request()),
            Self::Gains(gains, request) => (gains.clone(), request),
        };
        Problem::with_gains(gains.with_level(level), request)
    }

    /// The levels of the scene's device.
    pub(crate) fn levels(&self) -> Option<&midair::Levels> {
        match self {
            Self::Scene(scene) => scene.array().levels(),
            Self::Gains(..) => None,
        }
    }

    /// The solver the scene file names.
    pub(crate) fn choice(&self) -> Option<&midair::Choice> {
        match self {
            Self::Scene(scene) => scene.solver.as_ref(),
            Self::Gains(..) => None,
        }
    }
}
