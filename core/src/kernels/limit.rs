//! Amplitude limits: drives of any modulus, planar over the transducers, are changed to |q| <= 1.
//!
//! Before a modulus is computed, the drive is divided by its larger part (real or imaginary): no square over- or
//! underflows.

use crate::kernels::prelude::*;
use crate::math::sqrtf;

/// Reduces every |q| above 1 to 1; other drives stay.
pub(crate) fn clamp(set: InstructionSet, drive: [&mut [f32]; 2]) {
    dispatch!(set, s => s.apart(LANES, &mut Limited::<false> { drive }));
}

/// Changes every |q| to 1; 0 stays 0.
pub(crate) fn fill(set: InstructionSet, drive: [&mut [f32]; 2]) {
    dispatch!(set, s => s.apart(LANES, &mut Limited::<true> { drive }));
}

/// Divides all drives by the largest |q|.
pub(crate) fn normalize(set: InstructionSet, [re, im]: [&mut [f32]; 2]) {
    let largest = re.iter().chain(&*im).fold(0.0, |most: f32, part| most.max(part.abs()));
    if largest == 0.0 {
        return;
    }
    let mut squares = Squares { drive: [&*re, &*im], largest, most: [0.0; LANES] };
    dispatch!(set, s => s.apart(LANES, &mut squares));
    let greatest = sqrtf(squares.most.into_iter().fold(0.0, f32::max));
    re.iter_mut().chain(im).for_each(|part| *part = *part / largest / greatest);
}

/// Returns q / `larger`, and the square of its modulus. `larger` is at least the larger part (real or imaginary) of q.
#[inline(always)]
fn scaled<S: Elementwise>(s: S, [re, im]: [S::V; 2], larger: S::V) -> ([S::V; 2], S::V) {
    let [re, im] = [s.div(re, larger), s.div(im, larger)];
    ([re, im], s.fma(re, re, s.mul(im, im)))
}

/// Kernel that changes the modulus of drives to 1: of all but 0 where `FULL`, else of those above 1.
struct Limited<'a, const FULL: bool> {
    drive: [&'a mut [f32]; 2],
}

impl<const FULL: bool> Apart for Limited<'_, FULL> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let [all_re, all_im] = &mut self.drive;
        let (zero, one) = (s.splat(0.0), s.splat(1.0));
        for (re, im) in groups_mut(all_re).iter_mut().zip(groups_mut(all_im)) {
            let q = [s.load(re), s.load(im)];
            let larger = s.max(s.abs(q[0]), s.abs(q[1]));
            let ([x, y], square) = scaled(s, q, if FULL { larger } else { s.max(larger, one) });
            let inverse = s.rsqrt(s.max(square, one));
            let limited = [x, y].map(
                #[inline(always)]
                |part| {
                    let full = s.mul(part, inverse);
                    if FULL { s.select_less(zero, larger, full, zero) } else { s.select_less(one, square, full, part) }
                },
            );
            s.store(limited[0], re);
            s.store(limited[1], im);
        }
    }
}

/// Kernel of the largest |q / largest|^2 in each lane.
struct Squares<'a> {
    drive: [&'a [f32]; 2],
    largest: f32,
    most: Lanes,
}

impl Apart for Squares<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let [re, im] = self.drive.map(groups);
        let (mut most, largest) = (s.splat(0.0), s.splat(self.largest));
        for (re, im) in re.iter().zip(im) {
            most = s.max(scaled(s, [s.load(re), s.load(im)], largest).1, most);
        }
        s.store(most, &mut self.most);
    }
}
