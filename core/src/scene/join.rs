//! Join: one array of several, such as the boards of a rig.

use crate::prelude::*;

use crate::scene::array::Array;

impl Array {
    /// Returns one array of the transducers of several, in their order, each with its response, mask, channels and pins. Move
    /// the parts first, with [`Array::moved`].
    ///
    /// # Errors
    /// No part; parts of other transducers, quantization or frequency; pins in some parts, or the same pin in two.
    ///
    /// ```
    /// use midair::{Array, Pose};
    ///
    /// let board = Array::preset("autd3", [1, 1])?;
    /// let above = board.moved(&Pose::new(&[0.0, core::f64::consts::PI, 0.0], [0.0, 0.0, 0.3])?)?;
    /// let rig = Array::join(&[board, above])?;
    /// assert_eq!((rig.len(), rig.hardware(), rig.board("autd3")?.boards()), (498, Some(40e3), 2));
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn join(parts: &[Self]) -> Result<Self> {
        let Some(first) = parts.first() else {
            return Err(Error::missing("arrays", "empty", "give at least one array"));
        };
        for (k, part) in parts.iter().enumerate().skip(1) {
            let differs = |what: &str| {
                let cure = "give arrays of one frequency, quantization and transducer, all with pins or none";
                Err(Error::conflict(format!("arrays[{k}]"), format!("of another {what} than the first"), cure))
            };
            match part {
                _ if part.hardware() != first.hardware() => return differs("frequency or air"),
                _ if part.transducer() != first.transducer() => return differs("transducer"),
                _ if part.quantization() != first.quantization() => return differs("quantization"),
                _ if part.reflecting() != first.reflecting() => return differs("reflection"),
                _ if part.pins().is_some() != first.pins().is_some() => return differs("wiring"),
                _ => {}
            }
        }
        let pins_of =
            |(k, part): (usize, &Self)| part.pins().unwrap_or_default().iter().map(|&pin| (pin, k)).collect::<Vec<_>>();
        let mut owners: Vec<_> = parts.iter().enumerate().flat_map(pins_of).collect();
        owners.sort_unstable();
        if let Some(pair) = owners.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            let [(pin, _), (_, k)] = [pair[0], pair[1]];
            let cure = "those of a second board follow those of the first";
            return Err(Error::conflict(format!("arrays[{k}]"), format!("on pin {pin}, as another transducer"), cure));
        }
        let all = |list: fn(&Self) -> &[[f64; 3]]| parts.iter().flat_map(list).copied().collect();
        let effects =
            |part: &Self| part.response().map_or_else(|| alloc::vec![Complex64::ONE; part.len()], <[_]>::to_vec);
        let response =
            parts.iter().any(|part| part.response().is_some()).then(|| parts.iter().flat_map(effects).collect());
        let masks = |part: &Self| part.mask().map_or_else(|| alloc::vec![true; part.len()], <[_]>::to_vec);
        let mask = parts.iter().any(|part| part.mask().is_some()).then(|| parts.iter().flat_map(masks).collect());
        let pins = first.pins().map(|_| parts.iter().filter_map(Self::pins).flatten().copied().collect());
        let mut channels = Vec::new();
        for part in parts {
            let before = channels.iter().max().map_or(0, |most| most + 1);
            match part.channels() {
                Some(list) => channels.extend(list.iter().map(|channel| before + channel)),
                None => channels.extend(before..before + part.len()),
            }
        }
        Self::new(all(Self::positions), Some(all(Self::normals)))?
            .with_transducer(first.transducer())?
            .with_response(response)?
            .with_mask(mask)?
            .with_channels(Some(channels))?
            .with_pins(pins)?
            .with_reflecting(first.reflecting())
            .map(|array| array.with_quantization(first.quantization().cloned()).with_hardware(first.hardware()))
    }
}
