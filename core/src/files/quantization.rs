//! The key `quantization` of a scene file's [array]: phases and amplitudes.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::device::quantization::Quantization;
use crate::error::Error;
use crate::scene::presets;
use crate::scene::presets::Preset;
use crate::scene::{Array, Origin};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct QuantizationTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    phases: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    amplitudes: Option<Vec<f64>>,
}

impl QuantizationTable {
    /// What a file has to say of an array's quantization: nothing where its preset says the same.
    pub(super) fn of(array: &Array) -> Option<Self> {
        let known = match array.origin() {
            Origin::Preset { name, .. } => presets::find(name).and_then(Preset::quantization).ok().flatten(),
            _ => None,
        };
        let quantization = array.quantization();
        (quantization != known.as_ref()).then(|| Self {
            phases: quantization.and_then(Quantization::phases).map(i64::from),
            amplitudes: quantization.and_then(Quantization::amplitudes).map(<[_]>::to_vec),
        })
    }

    /// The quantization; those of an empty table bind nothing.
    pub(super) fn quantization(self) -> Result<Quantization, Error> {
        let count = |phases| {
            u32::try_from(phases).map_err(|_| Error::invalid("array.quantization.phases", phases, "give 2 to 65536"))
        };
        Quantization::new(self.phases.map(count).transpose()?, self.amplitudes)
    }
}
