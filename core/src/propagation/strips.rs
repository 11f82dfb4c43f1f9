//! Strips: the propagation matrix G as tiles, some transducers at a time, and products such as G G^H, G^H p and G q.
//!
//! Sixteen transducers fill the SIMD lanes, even if there are few points. With M = 4, G takes a quarter of the time that it
//! takes with one row for each transducer. A small G is one strip, computed once and used in each pass. A large propagation
//! matrix G is computed again in each pass, [`STRIP`] transducers at a time. Memory stays O(M), and reading a stored G would
//! take as long.

use crate::kernels::LANES;
use crate::kernels::tiles::{self, Tiles, products};
use crate::linalg::Planar;
use crate::prelude::*;
use crate::propagation::Propagation;
use crate::workspace::{Aligned, Buffer, Workspace};

/// The number of transducers in a strip of a large propagation matrix G.
const STRIP: usize = products::RUN * LANES;

/// The number of transducers in a strip, on targets where code and memory must be small.
const SHORT_STRIP: usize = 4 * LANES;

/// The most entries of a propagation matrix G that is stored as a whole: 2 MB.
const KEPT: usize = 1 << 18;

/// One number for each transducer, real and imaginary part, padded to whole pairs of tiles.
pub(crate) type Drives<'w> = [Buffer<'w, f32>; 2];

/// The propagation matrix G at the points of a problem, in strips.
pub(crate) struct Strips<'w> {
    propagation: &'w Propagation,
    order: Buffer<'w, u32>,
    planes: [Aligned<'w>; 2],
    /// The number of transducers in a strip: whole pairs of tiles, unless it is the only strip.
    strip: usize,
    /// Whether the only strip has been computed.
    made: bool,
    work: &'w Workspace,
}

impl<'w> Strips<'w> {
    pub(crate) fn new(propagation: &'w Propagation, work: &'w Workspace) -> Self {
        let (count, transducers) = (propagation.points(), propagation.transducers());
        let strip = match propagation.instruction_set() {
            set if set.is_short() => transducers.min(SHORT_STRIP),
            _ if count * transducers <= KEPT => transducers,
            _ => transducers.min(STRIP),
        };
        let size = tiles::size(tiles::height(count), tiles::lanes(strip));
        let planes = [(); 2].map(|()| Aligned::take(size, work));
        Self { propagation, order: work.counting(count), planes, strip, made: false, work }
    }

    /// Calls `pass` for each strip, with the range of the strip's transducers. The same range applies to the lanes of
    /// padded lists.
    fn each(
        &mut self,
        control: &mut Control,
        mut pass: impl FnMut(Range<usize>, Tiles<'_>, &mut Control) -> Result<()>,
    ) -> Result<()> {
        let Self { propagation, order, planes: [re, im], strip, made, .. } = self;
        let (set, transducers) = (propagation.instruction_set(), propagation.transducers());
        for first in (0..transducers).step_by(*strip) {
            let members = first..transducers.min(first + *strip);
            let lanes = tiles::lanes(members.len());
            let size = tiles::size(tiles::height(order.len()), lanes);
            if !*made {
                let planes = [&mut re[..size], &mut im[..size]];
                tiles::pack(set, propagation.rows(), members, order, planes, control)?;
                *made = transducers == *strip;
            }
            pass(first..first + lanes, Tiles { planes: [&re[..size], &im[..size]], lanes }, control)?;
        }
        Ok(())
    }

    /// Returns memory for one complex number for each transducer.
    fn drives(&self) -> Drives<'w> {
        [(); 2].map(|()| self.work.floats.take_any(tiles::lanes(self.propagation.transducers())))
    }

    /// The sum sum_i |G_ji|^2 for each point.
    pub(crate) fn powers(&mut self, control: &mut Control) -> Result<Buffer<'w, f32>> {
        let (set, work) = (self.propagation.instruction_set(), self.work);
        let mut powers = work.floats.take(self.order.len());
        let mut part = work.floats.take_any(self.order.len());
        self.each(control, |_, tiles, _| {
            products::powers(set, tiles, &mut part);
            powers.iter_mut().zip(&part).for_each(|(power, part)| *power += part);
            Ok(())
        })?;
        Ok(powers)
    }

    /// The sum sum_j f_j |G_ji| for each transducer, with `factors` f.
    pub(crate) fn moduli(&mut self, factors: &[f32], control: &mut Control) -> Result<Buffer<'w, f32>> {
        let set = self.propagation.instruction_set();
        let mut moduli = self.work.floats.take_any(tiles::lanes(self.propagation.transducers()));
        self.each(control, |lanes, tiles, _| {
            products::moduli(set, tiles, factors, &mut moduli[lanes]);
            Ok(())
        })?;
        Ok(moduli)
    }

    /// Returns b_i = sum_j conj(G_ji) p_j for each transducer, with `phasors` p.
    pub(crate) fn back_project(&mut self, phasors: &Planar, control: &mut Control) -> Result<Drives<'w>> {
        let set = self.propagation.instruction_set();
        let mut drives = self.drives();
        self.each(control, |lanes, tiles, _| {
            let out = drives.each_mut().map(|plane| &mut plane[lanes.clone()]);
            tiles::correlate(set, tiles, [&phasors.re, &phasors.im], out);
            Ok(())
        })?;
        Ok(drives)
    }

    /// Returns the field p = G q of `drives` q: one padded row.
    pub(crate) fn field(&mut self, drives: &mut Drives<'_>, control: &mut Control) -> Result<Planar<'w>> {
        let (set, work) = (self.propagation.instruction_set(), self.work);
        let mut field = Planar::zeros(1, self.propagation.lanes(), work);
        let mut part = [(); 2].map(|()| work.floats.take_any(tiles::height(self.order.len())));
        self.each(control, |lanes, tiles, _| {
            let drive = drives.each_mut().map(|plane| &mut plane[lanes.clone()]);
            tiles::play(set, tiles, tiles::Wave { drive, field: part.each_mut().map(|plane| &mut plane[..]) });
            for (field, part) in [&mut field.re, &mut field.im].into_iter().zip(&part) {
                field.iter_mut().zip(part).for_each(|(field, part)| *field += part);
            }
            Ok(())
        })?;
        Ok(field)
    }

    /// Returns conj(G diag(f) G^H), each row padded. Entry l of row k is `conj(sum_i f_i G_ki conj(G_li))`, with `factors` f_i
    /// >= 0, or 1 without factors. Time O(N M^2), memory O(M^2).
    ///
    /// The result is conjugated so that `correlate` with row k gives row k of G G^H times a vector.
    ///
    /// # Errors
    /// More memory than allowed, a stop by the caller.
    pub(crate) fn gram(&mut self, factors: Option<&[f32]>, control: &mut Control) -> Result<Planar<'w>> {
        let (propagation, work) = (self.propagation, self.work);
        let (set, count, lanes) = (propagation.instruction_set(), propagation.points(), propagation.lanes());
        control.room("the matrix G G^H", [propagation.transducers(), count], bytes(8, &[count, lanes]))?;
        let mut product = Planar::zeros(count, lanes, work);
        let most = factors.map_or(0, |_| self.planes[0].len());
        let mut weighed = [(); 2].map(|()| Aligned::take(most, work));
        let mut roots = work.floats.take_any(factors.map_or(0, |_| tiles::lanes(self.strip)));
        self.each(control, |range, tiles, control| {
            let mut planes = tiles.planes;
            if let Some(factors) = factors {
                let roots = &mut roots[..tiles.lanes];
                roots.iter_mut().zip(&factors[range]).for_each(|(root, factor)| *root = sqrtf(*factor));
                for (scaled, plane) in weighed.iter_mut().zip(tiles.planes) {
                    scaled[..plane.len()].copy_from_slice(plane);
                    tiles::weigh(set, &mut scaled[..plane.len()], roots);
                }
                planes = weighed.each_ref().map(|scaled| &scaled[..tiles.planes[0].len()]);
            }
            let to = [&mut product.re[..], &mut product.im[..]];
            products::couplings(set, Tiles { planes, ..tiles }, 0..tiles.lanes / LANES, count, to, control)
        })?;
        for k in 0..count {
            control.pulse()?;
            // The diagonal is real: an imaginary part left by rounding would change phases.
            product.im[k * lanes + k] = 0.0;
            for l in k + 1..count {
                let (upper, lower) = (k * lanes + l, l * lanes + k);
                let (re, im) = (product.re[upper], product.im[upper]);
                (product.re[lower], product.im[lower]) = (re, im);
                product.im[upper] = -im;
            }
        }
        Ok(product)
    }
}

#[cfg(test)]
#[path = "tests/strips.rs"]
mod tests;
