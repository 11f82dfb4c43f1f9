//! First argument of `midair.solve`, `judge` and `bound`: a scene, or a matrix and what goes beside it.

use std::sync::Arc;

use midair::{Control, InstructionSet, Problem, Quantization, Request, Setup};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::error::{invalid, refused};
use crate::propagation::Propagation;
use crate::quantization::{on_board, read_quantization};
use crate::read;
use crate::scene::{Scene, remade};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Keywords for what a matrix has not of its own; beside a scene they replace its own.
#[derive(Clone, Copy, Default)]
pub(crate) struct Beside<'a, 'py> {
    pub(crate) pressures: Argument<'a, 'py>,
    pub(crate) weights: Argument<'a, 'py>,
    pub(crate) quantization: Argument<'a, 'py>,
    pub(crate) mask: Argument<'a, 'py>,
    pub(crate) positions: Argument<'a, 'py>,
}

impl Beside<'_, '_> {
    /// A scene with what is given beside it in place of its own.
    fn over(self, py: Python<'_>, scene: &Arc<midair::Scene>) -> PyResult<Arc<midair::Scene>> {
        let Self { pressures, weights, quantization, mask, positions } = self;
        if positions.is_some() {
            return Err(invalid(
                "positions",
                "given beside a Scene",
                "its array has its own: they go with Propagation",
            ));
        }
        if [pressures, weights, quantization, mask].iter().all(Option::is_none) {
            return Ok(Arc::clone(scene));
        }
        let array = on_board(scene.array().clone(), mask, quantization)?;
        let Request { pressures: own_pressures, weights: own_weights } = scene.request().clone();
        let given = read::request(scene.points().len(), pressures, weights)?;
        let request = Request { pressures: given.pressures.or(own_pressures), weights: given.weights.or(own_weights) };
        remade(py, scene, (array, scene.medium()), scene.points().to_vec(), request, scene.plane)
    }
}

/// What `solve`, `judge` and `bound` are about.
pub(crate) enum Subject {
    Scene(Arc<midair::Scene>),
    Given(midair::Propagation, Arc<Setup>, midair::Request),
}

/// A matrix under its mask, and the array behind it.
pub(crate) fn given(
    propagation: &midair::Propagation,
    Beside { quantization, mask, positions, .. }: Beside<'_, '_>,
) -> PyResult<(midair::Propagation, Setup)> {
    let quantization = quantization.map(read_quantization).transpose()?.filter(|board| !board.is_continuous());
    let positions = positions.map(|value| read::vectors("positions", value)).transpose()?;
    let propagation = match mask {
        None => propagation.clone(),
        Some(mask) => propagation.clone().with_mask(&read::flags("mask", mask)?).map_err(refused)?,
    };
    let setup =
        Setup { quantization: quantization.map(Arc::new), positions: positions.map(Into::into), ..Setup::default() };
    Ok((propagation, setup))
}

impl Subject {
    pub(crate) fn read(object: &Bound<'_, PyAny>, beside: Beside<'_, '_>) -> PyResult<Self> {
        if let Ok(scene) = object.cast::<Scene>() {
            return beside.over(object.py(), &scene.get().inner).map(Self::Scene);
        }
        if let Ok(matrix) = object.cast::<Propagation>() {
            let matrix = &matrix.get().inner;
            let request = read::request(matrix.points(), beside.pressures, beside.weights)?;
            let (propagation, setup) = given(matrix, beside)?;
            return Ok(Self::Given(propagation, Arc::new(setup), request));
        }
        let kind = object.get_type().qualname()?;
        Err(PyTypeError::new_err(format!("expected a midair.Scene or midair.Propagation first, not {kind}")))
    }

    pub(crate) fn problem(&self, set: InstructionSet, control: &mut Control) -> Result<Problem, midair::Error> {
        match self {
            Self::Scene(scene) => Problem::of_scene(scene, set, control),
            Self::Given(propagation, setup, request) => {
                let propagation = propagation.clone().with_instruction_set(set);
                Problem::watched(propagation, Arc::clone(setup), request, control)
            }
        }
    }

    /// The scene, if it is one.
    pub(crate) fn scene(&self) -> Option<Arc<midair::Scene>> {
        match self {
            Self::Scene(scene) => Some(Arc::clone(scene)),
            Self::Given(..) => None,
        }
    }

    /// What the board can play.
    pub(crate) fn quantization(&self) -> Option<&Quantization> {
        match self {
            Self::Scene(scene) => scene.array().quantization(),
            Self::Given(_, setup, _) => setup.quantization.as_deref(),
        }
    }

    /// The solver the scene file names.
    pub(crate) fn choice(&self) -> Option<&midair::Choice> {
        match self {
            Self::Scene(scene) => scene.solver.as_ref(),
            Self::Given(..) => None,
        }
    }
}
