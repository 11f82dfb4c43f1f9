//! What `midair.Solver` and `solve_batch` share: a session from transducers, a solver and keywords.

use midair::solvers::{Info, configure};
use midair::{Choice, Medium, Model, Session};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyDictMethods};

use crate::array::{Array, adjusted};
use crate::error::{invalid, refused};
use crate::instruction_set::instruction_set;
use crate::propagation::Propagation;
use crate::quantization::on_board;
use crate::read;
use crate::scene::Scene;
use crate::subject::{Beside, given};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// A session, and how it was chosen.
pub(crate) struct Setting {
    pub(crate) session: Session,
    pub(crate) choice: Choice,
    pub(crate) info: &'static Info,
}

/// Keywords that are taken out before the rest is read as a solver's options.
struct Keywords<'py>(Bound<'py, PyDict>);

impl<'py> Keywords<'py> {
    fn take(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let value = self.0.get_item(name)?.filter(|value| !value.is_none());
        if self.0.contains(name)? {
            self.0.del_item(name)?;
        }
        Ok(value)
    }

    /// The array and medium of a Scene or an Array, as the keywords change them.
    fn model(&self, array: midair::Array, own: Medium, beside: Beside<'_, '_>) -> PyResult<Model> {
        let take = |name: &str| self.take(name);
        let [speed, temperature] = [("sound_speed", take("sound_speed")?), ("temperature", take("temperature")?)]
            .map(|(name, value)| value.map(|value| read::real(name, &value)).transpose());
        let sound_speed = match (speed?, temperature?) {
            (None, None) => own.sound_speed,
            (speed, temperature) => Medium::sound_speed(speed, temperature).map_err(refused)?,
        };
        let medium = Medium {
            frequency: read::real_or("frequency", take("frequency")?.as_ref(), own.frequency)?,
            sound_speed,
            absorption: read::real_or("absorption", take("absorption")?.as_ref(), own.absorption)?,
            density: read::real_or("density", take("density")?.as_ref(), own.density)?,
        };
        let (pressure, directivity) = (take("source_pressure")?, take("directivity")?);
        let array = adjusted(array, pressure.as_ref(), directivity.as_ref(), None)?;
        let array = on_board(array, beside.mask, beside.quantization)?;
        Model::new(&array, medium, instruction_set()?).map_err(refused)
    }
}

impl Setting {
    /// From a Scene (its array and medium), an Array or a Propagation, and keywords: the Scene's, `quantization`, `mask`,
    /// `balance`, `aim`, and the solver's options.
    pub(crate) fn read(
        object: &Bound<'_, PyAny>,
        solver: Argument<'_, '_>,
        keywords: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let keywords = Keywords(match keywords {
            Some(keywords) => keywords.copy()?,
            None => PyDict::new(object.py()),
        });
        let [balance, aim, quantization, mask, positions] =
            ["balance", "aim", "quantization", "mask", "positions"].map(|name| keywords.take(name));
        let (balance, aim, quantization, mask, positions) = (balance?, aim?, quantization?, mask?, positions?);
        let beside = Beside {
            quantization: quantization.as_ref(),
            mask: mask.as_ref(),
            positions: positions.as_ref(),
            ..Beside::default()
        };
        let mut choice = Choice {
            name: solver.map_or_else(|| Ok(midair::solvers::DEFAULT.into()), read::name)?,
            options: midair::Options::new(),
            balance: balance.map(|value| read::flag("balance", &value)).transpose()?,
            aim: aim.map(|value| read::aim(&value)).transpose()?,
        };
        let mut configured = |board: Option<&midair::Quantization>| {
            choice.options = read::options(Some(&keywords.0))?;
            let configured = configure(&choice, board).map_err(refused)?;
            choice.name = configured.info.name.into();
            choice.balance = Some(choice.balance.unwrap_or(configured.info.balance));
            choice.options.clone_from(&configured.options);
            Ok::<_, PyErr>((configured, choice.balance == Some(true)))
        };
        let (session, info) = if let Ok(matrix) = object.cast::<Propagation>() {
            let (propagation, setup) = given(&matrix.get().inner, beside)?;
            let (configured, balance) = configured(setup.quantization.as_deref())?;
            let propagation = propagation.with_instruction_set(instruction_set()?);
            let session = Session::with_propagation(propagation, setup, configured.solver, balance);
            (session.map_err(refused)?, configured.info)
        } else {
            if positions.is_some() {
                return Err(invalid("positions", "given", "an array has its own: they go with Propagation"));
            }
            let (array, medium) = if let Ok(scene) = object.cast::<Scene>() {
                let scene = &scene.get().inner;
                (scene.array().clone(), scene.medium())
            } else if let Ok(array) = object.cast::<Array>() {
                (array.get().inner.clone(), Medium::default())
            } else {
                let kind = object.get_type().qualname()?;
                return Err(PyTypeError::new_err(format!(
                    "expected a midair.Scene, midair.Array or midair.Propagation first, not {kind}"
                )));
            };
            let model = keywords.model(array, medium, beside)?;
            let (configured, balance) = configured(model.array().quantization())?;
            (Session::new(model, configured.solver, balance), configured.info)
        };
        Ok(Self { session, choice, info })
    }
}
