//! The key `quantization` of [array], as it is written: phases and amplitudes where a preset does not say them.

use alloc::vec::Vec;

use serde::Serialize;

use crate::device::quantization::Quantization;
use crate::scene::presets;
use crate::scene::presets::Preset;
use crate::scene::{Array, Origin};

#[derive(Serialize)]
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
}
