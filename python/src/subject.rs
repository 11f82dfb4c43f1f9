//! First argument of `midair.solve`, `judge` and `bound`: a scene, or a matrix with keywords.

use midair::{Quantization, Workspace};

use crate::keywords::Keywords;
use crate::prelude::*;
use crate::propagation::{Matrix, Propagation};
use crate::ready::Ready;
use crate::scene::Scene;

/// Keywords for data that a matrix does not have. For a scene they replace its own.
#[derive(Clone, Copy, Default)]
pub(crate) struct Beside<'a, 'py> {
    pub(crate) pressures: Argument<'a, 'py>,
    pub(crate) weights: Argument<'a, 'py>,
    pub(crate) quantization: Argument<'a, 'py>,
    pub(crate) mask: Argument<'a, 'py>,
    pub(crate) positions: Argument<'a, 'py>,
}

impl Beside<'_, '_> {
    /// Returns a scene with these keywords instead of its own values.
    fn over(self, scene: &Bound<'_, Scene>) -> PyResult<Scene> {
        let Self { pressures, weights, quantization, mask, positions } = self;
        if positions.is_some() {
            let cure = "its array has its own: they go with Propagation";
            return Err(invalid("positions", "given beside a Scene", cure));
        }
        let (py, scene) = (scene.py(), scene.get());
        let parts = [("pressures", pressures), ("weights", weights), ("quantization", quantization), ("mask", mask)];
        let changes = Keywords::of(py, None)?.with(parts)?;
        if changes.rest().is_empty() {
            return Ok(scene.clone());
        }
        Scene::read(scene.array(), Some(scene), &changes)?.reported(py, &scene.doubts())
    }
}

/// A scene or a matrix.
pub(crate) enum Subject {
    Scene(Scene),
    Given(Matrix, Request),
}

impl Subject {
    pub(crate) fn read(object: &Bound<'_, PyAny>, beside: Beside<'_, '_>) -> PyResult<Self> {
        if let Ok(scene) = object.cast::<Scene>() {
            return beside.over(scene).map(Self::Scene);
        }
        if let Ok(matrix) = object.cast::<Propagation>() {
            let matrix = &matrix.get().inner;
            let request = read::request(matrix.points(), beside.pressures, beside.weights)?;
            let Beside { quantization, mask, positions, .. } = beside;
            return Ok(Self::Given(Matrix::read(matrix, [quantization, mask, positions])?, request));
        }
        Err(unexpected(object, "a midair.Scene or midair.Propagation", ": give midair.Scene(array, points)"))
    }

    pub(crate) fn problem(&self, rows_follow: bool, control: &mut Control) -> Result<Problem, midair::Error> {
        match self {
            Self::Scene(scene) => scene.problem(rows_follow, control),
            Self::Given(matrix, request) => matrix.problem(request, control),
        }
    }

    /// Returns the scene; None for a matrix.
    pub(crate) fn scene(self) -> Option<Scene> {
        match self {
            Self::Scene(scene) => Some(scene),
            Self::Given(..) => None,
        }
    }

    /// Returns the board's quantization.
    pub(crate) fn quantization(&self) -> Option<&Quantization> {
        match self {
            Self::Scene(scene) => scene.inner.array().quantization(),
            Self::Given(matrix, _) => matrix.setup.quantization.as_deref(),
        }
    }

    /// Returns a workspace: that of the last solve with the scene's array, if no other call uses it.
    pub(crate) fn workspace(&self) -> Workspace {
        self.ready().map(Ready::workspace).unwrap_or_default()
    }

    /// Stores a workspace for the next solve with the scene's array.
    pub(crate) fn keep(&self, work: Workspace) {
        if let Some(ready) = self.ready() {
            ready.keep(work);
        }
    }

    /// Returns the prepared array of a scene; None for a matrix.
    fn ready(&self) -> Option<&Ready> {
        match self {
            Self::Scene(scene) => Some(&scene.ready),
            Self::Given(..) => None,
        }
    }

    /// Returns the solver that the scene file names.
    pub(crate) fn choice(&self) -> Option<&midair::Choice> {
        match self {
            Self::Scene(scene) => scene.inner.solver.as_ref(),
            Self::Given(..) => None,
        }
    }
}
