//! The levels of a device in a scene file: `levels = { phases = 256, amplitudes = [0.0, 0.5, 1.0] }`.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::array::{Array, Origin};
use crate::error::Error;
use crate::levels::Levels;
use crate::presets::{self, Preset};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LevelsTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    phases: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    amplitudes: Option<Vec<f64>>,
}

impl LevelsTable {
    /// What a file has to say of an array's levels: nothing where its preset says the same.
    pub(super) fn of(array: &Array) -> Option<Self> {
        let known = match array.origin() {
            Origin::Preset { name, .. } => presets::find(name).and_then(Preset::levels).ok().flatten(),
            _ => None,
        };
        let levels = array.levels();
        (levels != known.as_ref()).then(|| Self {
            phases: levels.and_then(Levels::phases).map(i64::from),
            amplitudes: levels.and_then(Levels::amplitudes).map(<[_]>::to_vec),
        })
    }

    /// The levels; those of an empty table bind nothing.
    pub(super) fn levels(self) -> Result<Levels, Error> {
        let count = |phases| {
            u32::try_from(phases)
                .map_err(|_| Error::invalid("array.levels.phases", phases, "give 2 to 65536"))
        };
        Levels::new(self.phases.map(count).transpose()?, self.amplitudes)
    }
}
