//! Products of stored planar matrices with vectors, and the field of a drive.

use crate::kernels::prelude::*;
use crate::kernels::vector::{add_row, correlation};
use crate::kernels::{Rows, add_field};

/// Number of rows that one pass over a vector multiplies: their sums fill a lane group.
const TOGETHER: usize = LANES / 2;

/// out_k = `sum_j conj(row_kj) vector_j` for every row of a planar matrix.
///
/// # Errors
/// A requested stop, which is checked once every few rows.
pub(crate) fn correlate_rows(
    set: InstructionSet,
    rows: [&[f32]; 2],
    vector: [&[f32]; 2],
    control: &mut Control,
    mut out: impl FnMut(usize, Complex32),
) -> Result<()> {
    dispatch!(set, s => {
        let lanes = vector[0].len();
        let row = |k: usize| rows.map(|part| &part[k * lanes..(k + 1) * lanes]);
        let count = rows[0].len() / lanes;
        for first in (0..count).step_by(TOGETHER) {
            control.pulse()?;
            let mut parts = [s.splat(0.0); LANES];
            for k in 0..TOGETHER.min(count - first) {
                let [re, im] = correlation(s, row(first + k), vector);
                parts[k] = re;
                parts[k + TOGETHER] = im;
            }
            let mut sums: Lanes = [0.0; LANES];
            s.store(s.reduce_add_each(&parts), &mut sums);
            for k in 0..TOGETHER.min(count - first) {
                out(first + k, Complex32::new(sums[k], sums[k + TOGETHER]));
            }
        }
        Ok(())
    })
}

/// Adds the waves G q of all transducers whose drive q is not 0 to the pressures.
///
/// # Errors
/// A requested stop, which is checked at least once a transducer.
pub(crate) fn add_waves(
    set: InstructionSet,
    rows: Rows<'_>,
    drive: &[Complex32],
    [re, im]: [&mut [f32]; 2],
    control: &mut Control,
) -> Result<()> {
    let [all_re, all_im] = match rows {
        Rows::Computed { radiation, sources, control_points, .. } => {
            return add_field(set, radiation, sources, drive, control_points, [re, im], control);
        }
        Rows::Stored { re, im } => [re, im],
    };
    dispatch!(set, s => {
        let lanes = re.len();
        for (i, q) in drive.iter().enumerate().filter(|(_, q)| **q != Complex32::ZERO) {
            control.pulse()?;
            let row = [all_re, all_im].map(|all| &all[i * lanes..(i + 1) * lanes]);
            add_row(s, row, [q.re, q.im], re, im);
        }
        Ok(())
    })
}
