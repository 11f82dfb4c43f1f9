//! Rows of G: one transducer against every point, eq. (5).

use core::array::from_fn;

use super::turns::{cis, power_of_two};
use super::{LANES, Lanes, groups, groups_mut};
use crate::directivity::Table;
use crate::math::sqrtf;

/// A hundredth of a wavelength: nearer than that r is held there, so that no field is infinite.
pub(crate) const NEAREST: f32 = 0.01;

/// Points in wavelengths from the array's middle, each coordinate padded with points far away.
#[derive(Clone, Copy)]
pub(crate) struct Spots<'a> {
    /// x, y and z.
    pub(crate) coordinates: [&'a [f32]; 3],
    /// How many of them are points; the rest is padding.
    pub(crate) count: usize,
}

/// One transducer in the same frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
    /// |c_i| times P0 over the reference, per wavelength, in the phase of c_i: (re, im).
    pub(crate) strength: [f32; 2],
}

/// What all transducers share: absorption as a power of two per wavelength (<= 0) and the directivity's table.
#[derive(Clone, Debug)]
pub(crate) struct Law {
    pub(crate) decay: f32,
    pub(crate) table: Option<Table>,
}

/// Where a row is written.
pub(crate) struct Row<'a> {
    pub(crate) re: &'a mut [f32],
    pub(crate) im: &'a mut [f32],
}

/// Distances (in wavelengths) and D e^{-alpha r}/r of one group of points; keeps the least square distance seen.
#[inline(always)]
fn spread(law: &Law, source: &Source, [x, y, z]: [&Lanes; 3], nearest: &mut Lanes) -> (Lanes, Lanes) {
    let dx: Lanes = from_fn(|l| x[l] - source.position[0]);
    let dy: Lanes = from_fn(|l| y[l] - source.position[1]);
    let dz: Lanes = from_fn(|l| z[l] - source.position[2]);
    let square: Lanes = from_fn(|l| dx[l] * dx[l] + dy[l] * dy[l] + dz[l] * dz[l]);
    *nearest = from_fn(|l| if square[l] < nearest[l] { square[l] } else { nearest[l] });
    let distance: Lanes =
        from_fn(|l| sqrtf(if square[l] > NEAREST * NEAREST { square[l] } else { NEAREST * NEAREST }));
    let inverse: Lanes = from_fn(|l| 1.0 / distance[l]);
    let mut amplitude = inverse;
    if law.decay < 0.0 {
        let power = power_of_two(&from_fn(|l| law.decay * distance[l]));
        amplitude = from_fn(|l| amplitude[l] * power[l]);
    }
    if let Some(table) = &law.table {
        let [nx, ny, nz] = source.normal;
        let cos: Lanes = from_fn(|l| (nx * dx[l] + ny * dy[l] + nz * dz[l]) * inverse[l]);
        let pieces: Lanes = from_fn(|l| arc_cosine(cos[l]) * Table::PIECES_PER_RADIAN);
        amplitude = from_fn(|l| if cos[l] < 0.0 { 0.0 } else { amplitude[l] * table.at(pieces[l], cos[l]) });
    }
    (distance, amplitude)
}

/// acos x for 0 <= x <= 1 (larger x counts as 1), error below 1e-7 rad plus rounding: Abramowitz and Stegun 4.4.46.
#[inline(always)]
fn arc_cosine(x: f32) -> f32 {
    #[allow(clippy::approx_constant, reason = "fitted coefficients that lie near a constant")]
    const C: [f32; 8] = [
        1.570_796_3,
        -0.214_598_8,
        0.088_978_99,
        -0.050_174_304,
        0.030_891_88,
        -0.017_088_126,
        0.006_670_09,
        -0.001_262_491_1,
    ];
    let complement = if x < 1.0 { 1.0 - x } else { 0.0 };
    sqrtf(complement) * C.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Writes the row of `source` over its target's whole length, zeros in the padding, and returns the least square
/// distance in square wavelengths.
pub(crate) fn row(law: &Law, source: &Source, spots: Spots<'_>, out: &mut Row<'_>) -> f32 {
    let [x, y, z] = spots.coordinates.map(groups);
    let [cr, ci] = source.strength;
    let mut nearest = [f32::INFINITY; LANES];
    let out_groups = groups_mut(out.re).iter_mut().zip(groups_mut(out.im));
    for (((x, y), z), (re, im)) in x.iter().zip(y).zip(z).zip(out_groups) {
        let (distance, amplitude) = spread(law, source, [x, y, z], &mut nearest);
        let (cos, sin) = cis(&distance);
        *re = from_fn(|l| amplitude[l] * (cos[l] * cr - sin[l] * ci));
        *im = from_fn(|l| amplitude[l] * (cos[l] * ci + sin[l] * cr));
    }
    out.re[spots.count..].fill(0.0);
    out.im[spots.count..].fill(0.0);
    least(&nearest)
}

/// The moduli |G| of the same row; the least square distance as before.
pub(crate) fn magnitudes(law: &Law, source: &Source, spots: Spots<'_>, out: &mut [f32]) -> f32 {
    let [x, y, z] = spots.coordinates.map(groups);
    let [cr, ci] = source.strength;
    let strength = sqrtf(cr * cr + ci * ci);
    let mut nearest = [f32::INFINITY; LANES];
    for (((x, y), z), out) in x.iter().zip(y).zip(z).zip(groups_mut(out)) {
        let (_, amplitude) = spread(law, source, [x, y, z], &mut nearest);
        // A piston's side lobes have D < 0.
        *out = from_fn(|l| (amplitude[l] * strength).abs());
    }
    out[spots.count..].fill(0.0);
    least(&nearest)
}

fn least(lanes: &Lanes) -> f32 {
    lanes.iter().copied().fold(f32::INFINITY, f32::min)
}
