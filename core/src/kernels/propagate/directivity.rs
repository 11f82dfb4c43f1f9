//! Directivity D(theta) from its cosine, by piecewise polynomials.

use alloc::vec::Vec;

use crate::kernels::lanes::{LANES, Lanes};
use crate::kernels::simd::Simd;
use crate::kernels::vector::root;
use crate::math;

/// D over theta.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one of them an array")]
pub(crate) enum Table {
    /// At most 16 pieces of degree 5 and equal width, coefficient by coefficient: each list is one register, and
    /// a piece is found without leaving the lanes. `scale` is pieces a radian.
    Few { scale: f32, coefficients: [Lanes; 6] },
    /// Cubics of equal width from 0 to 90 degrees, for beams that need many.
    Many { scale: f32, pieces: Vec<[f32; 4]> },
    /// cos(theta)^n, where it falls to 0 too steeply for any polynomial: n below 3 and broken.
    Power(f32),
}

impl Table {
    /// D at an angle given by its cosine, 0 behind the transducer.
    #[inline(always)]
    pub(crate) fn directivity<S: Simd>(&self, s: S, cos_theta: S::V) -> S::V {
        let value = match self {
            Self::Few { scale, coefficients } => {
                let place = s.mul(arc_cosine(s, cos_theta), s.splat(*scale));
                // Rounding may carry 90 degrees over the end of the last piece, whose polynomial goes on there.
                let half = s.splat(0.5);
                let piece = s.max(s.min(s.round(s.sub(place, half)), s.splat(15.0)), s.splat(0.0));
                let u = s.sub(place, piece);
                let [first, rest @ ..] = coefficients;
                let mut sum = s.gather(first, piece);
                for list in rest {
                    sum = s.fma(sum, u, s.gather(list, piece));
                }
                sum
            }
            Self::Many { scale, pieces } => {
                let place = s.mul(arc_cosine(s, cos_theta), s.splat(*scale));
                each_lane(s, place, |place| {
                    let index = (place as usize).min(pieces.len() - 1);
                    let u = place - index as f32;
                    let [c0, c1, c2, c3] = pieces[index];
                    ((c3 * u + c2) * u + c1) * u + c0
                })
            }
            Self::Power(exponent) => each_lane(s, s.max(cos_theta, s.splat(0.0)), |x| math::powf(x, *exponent)),
        };
        s.select_less(cos_theta, s.splat(0.0), s.splat(0.0), value)
    }
}

#[inline(always)]
fn each_lane<S: Simd>(s: S, v: S::V, f: impl Fn(f32) -> f32) -> S::V {
    let mut lanes: Lanes = [0.0; LANES];
    s.store(v, &mut lanes);
    s.load(&lanes.map(f))
}

/// acos x for 0 <= x <= 1 (larger x counts as 1, smaller as 0), error below 1e-7 rad plus rounding: Abramowitz and
/// Stegun 4.4.46.
#[inline(always)]
fn arc_cosine<S: Simd>(s: S, x: S::V) -> S::V {
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
    let x = s.max(s.min(x, s.splat(1.0)), s.splat(0.0));
    let mut sum = s.splat(C[7]);
    for &c in C[..7].iter().rev() {
        sum = s.fma(sum, x, s.splat(c));
    }
    s.mul(root(s, s.sub(s.splat(1.0), x)), sum)
}
