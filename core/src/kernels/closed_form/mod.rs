//! Closed-form greedy sweep: gives one transducer after another its best phase, in blocks that share one residual.

pub(crate) mod blocks;
pub(crate) mod interleaved_sweep;
pub(crate) mod points;
pub(crate) mod segments;
mod short;

pub(crate) use blocks::{MOST, Memory, Sweep, floats};

use crate::kernels::prelude::*;

/// Gives every transducer of `order` the phase arg sum w conj(G) (t P/|P| - P + `own` G q), symbols as in [`blocks`]. Calls `report` with the points' pressures after each block. If `report` returns false, the sweep ends and
/// returns false.
pub(crate) fn sweep(
    set: InstructionSet,
    sweep: Sweep<'_>,
    order: impl Iterator<Item = usize>,
    drive: &mut [Complex32],
    pressures: [&mut [f32]; 2],
    report: impl FnMut([&[f32]; 2]) -> bool,
) -> bool {
    match sweep.count {
        _ if set.is_short() => short::sweep(set, sweep, order, drive, pressures, report),
        ..=4 => segments::sweep::<4>(set, &sweep, order, drive, pressures, report),
        5..=8 => segments::sweep::<2>(set, &sweep, order, drive, pressures, report),
        _ => points::sweep(set, sweep, order, drive, pressures, report),
    }
}
