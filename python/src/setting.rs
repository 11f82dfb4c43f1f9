//! What `midair.solve_batch` and `midair.Solver` share: an array in a medium, and a solver, from keywords.

use midair::solvers::Configured;
use midair::{Choice, Medium, Model};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyDictMethods};

use crate::array::{Array, adjusted};
use crate::level::level;
use crate::scene::Scene;
use crate::solve::{aim, flag};
use crate::{invalid, read, refused};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// An array made ready, and how its problems are solved.
pub(crate) struct Setting {
    pub(crate) model: Model,
    pub(crate) choice: Choice,
    pub(crate) configured: Configured,
    pub(crate) balance: bool,
}

impl Setting {
    /// From a Scene (its array and medium) or an Array, and keywords: the Scene's, `balance`, `level`, and the
    /// solver's options.
    pub(crate) fn read(
        object: &Bound<'_, PyAny>,
        solver: Argument<'_, '_>,
        keywords: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let keywords = match keywords {
            Some(keywords) => keywords.copy()?,
            None => PyDict::new(object.py()),
        };
        let take = |name: &str| -> PyResult<Option<Bound<'_, PyAny>>> {
            let value = keywords.get_item(name)?.filter(|value| !value.is_none());
            if keywords.contains(name)? {
                keywords.del_item(name)?;
            }
            Ok(value)
        };
        let (balance, aimed) = (take("balance")?, take("level")?);
        let [frequency, speed, temperature, absorption, density, pressure, directivity] = [
            take("frequency")?,
            take("sound_speed")?,
            take("temperature")?,
            take("absorption")?,
            take("density")?,
            take("source_pressure")?,
            take("directivity")?,
        ];
        let (array, own) = if let Ok(scene) = object.cast::<Scene>() {
            let scene = &scene.get().inner;
            (scene.array().clone(), scene.medium())
        } else if let Ok(array) = object.cast::<Array>() {
            (array.get().inner.clone(), Medium::default())
        } else {
            let kind = object.get_type().qualname()?;
            return Err(PyTypeError::new_err(format!(
                "expected a midair.Scene or midair.Array first, not {kind}"
            )));
        };
        let sound_speed = if speed.is_some() || temperature.is_some() {
            let speed = speed.map(|value| read::real("sound_speed", &value)).transpose()?;
            let temperature = temperature.map(|value| read::real("temperature", &value)).transpose()?;
            Medium::sound_speed(speed, temperature).map_err(refused)?
        } else {
            own.sound_speed
        };
        let medium = Medium {
            frequency: read::real_or("frequency", frequency.as_ref(), own.frequency)?,
            sound_speed,
            absorption: read::real_or("absorption", absorption.as_ref(), own.absorption)?,
            density: read::real_or("density", density.as_ref(), own.density)?,
        };
        let array = adjusted(array, pressure.as_ref(), directivity.as_ref(), None)?;
        let name = match solver {
            None => midair::solvers::DEFAULT.into(),
            Some(name) => {
                let text = name.extract::<String>();
                text.map_err(|_| invalid("solver", &name.to_string(), "give a name as text"))?
            }
        };
        let mut choice = Choice {
            name,
            options: read::options(Some(&keywords))?,
            balance: balance.map(|value| flag("balance", &value)).transpose()?,
            level: aimed.map(|value| aim(&value)).transpose()?,
        };
        let configured = choice.configured(array.quantization()).map_err(refused)?;
        let balance = choice.balance.unwrap_or(configured.info.balance);
        choice.balance = Some(balance);
        choice.options = configured.options.clone();
        let model = Model::new(&array, medium, level()?).map_err(refused)?;
        Ok(Self { model, choice, configured, balance })
    }
}
