//! Products with G whose rows are computed on the way: G^H p, G q and G G^H.

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::{Control, bytes};
use crate::error::Error;
use crate::kernels;
use crate::kernels::LANES;
use crate::kernels::tiles::products;
use crate::kernels::tiles::{self, Tiles};
use crate::linalg::Planar;
use crate::math::sqrtf;
use crate::propagation::Propagation;
use crate::workspace::{Aligned, Workspace};

/// q_i = factor_i sum_j conj(G_ji) p_j, rows computed on the way.
pub(crate) fn back_project(
    propagation: &Propagation,
    phasors: &Planar,
    factor: impl Fn(usize) -> f32,
    work: &Workspace,
    control: &mut Control,
) -> Result<Vec<Complex32>, Error> {
    let mut drive = work.complexes.take(propagation.transducers());
    let mut row = Planar::zeros(1, propagation.lanes(), work);
    for (i, q) in drive.iter_mut().enumerate() {
        control.pulse()?;
        propagation.row(i, &mut row.re, &mut row.im);
        let [re, im] =
            kernels::correlate(propagation.instruction_set(), row.row(0), phasors.row(0), propagation.points());
        *q = Complex32::new(re, im) * factor(i);
    }
    Ok(drive.into_vec())
}

/// P = G q of a drive, rows computed on the way: one padded row, in units of the reference.
pub(crate) fn field_of<'w>(
    propagation: &Propagation,
    drive: &[Complex32],
    work: &'w Workspace,
    control: &mut Control,
) -> Result<Planar<'w>, Error> {
    let mut field = Planar::zeros(1, propagation.lanes(), work);
    let into = [&mut field.re[..], &mut field.im[..]];
    kernels::add_waves(propagation.instruction_set(), propagation.rows(), drive, into, control)?;
    Ok(field)
}

/// conj(G diag(f) G^H), row k padded: entry l is `conj(sum_i f_i G_ki conj(G_li))`, f_i >= 0, 1 where left out. Time
/// O(N M^2), memory O(M^2).
///
/// Conjugated so that `correlate` with row k is row k of G G^H times a vector.
///
/// # Errors
/// More memory than allowed, a stop.
pub(crate) fn gram<'w>(
    propagation: &Propagation,
    factors: Option<&[f32]>,
    work: &'w Workspace,
    control: &mut Control,
) -> Result<Planar<'w>, Error> {
    const TRANSDUCERS_A_RUN: usize = products::RUN * LANES;
    let (set, count, lanes) = (propagation.instruction_set(), propagation.points(), propagation.lanes());
    control.room("the matrix G G^H", [propagation.transducers(), count], bytes(8, &[count, lanes]))?;
    let mut product = Planar::zeros(count, lanes, work);
    let order = work.counting(count);
    let mut roots = work.floats.take(TRANSDUCERS_A_RUN);
    let most = tiles::size(tiles::height(count), tiles::lanes(propagation.transducers().min(TRANSDUCERS_A_RUN)));
    let mut planes = [(); 2].map(|()| Aligned::take(most, work));
    for first in (0..propagation.transducers()).step_by(TRANSDUCERS_A_RUN) {
        let members = first..propagation.transducers().min(first + TRANSDUCERS_A_RUN);
        let across = tiles::lanes(members.len());
        let size = tiles::size(tiles::height(count), across);
        let [re, im] = planes.each_mut().map(|plane| &mut plane[..size]);
        tiles::pack(set, propagation.rows(), members.clone(), &order, [&mut *re, &mut *im], control)?;
        if let Some(factors) = factors {
            roots.iter_mut().zip(&factors[members]).for_each(|(root, factor)| *root = sqrtf(*factor));
            tiles::weigh(set, re, &roots[..across]);
            tiles::weigh(set, im, &roots[..across]);
        }
        let to = [&mut product.re[..], &mut product.im[..]];
        let tiles = Tiles { planes: [re, im], lanes: across };
        products::couplings(set, tiles, 0..across / LANES, count, to, control)?;
    }
    for k in 0..count {
        control.pulse()?;
        for l in k..count {
            let (upper, lower) = (k * lanes + l, l * lanes + k);
            let (re, im) = (product.re[upper], product.im[upper]);
            (product.re[lower], product.im[lower]) = (re, im);
            product.im[upper] = -im;
        }
    }
    Ok(product)
}

#[cfg(test)]
#[path = "tests/products.rs"]
mod tests;
