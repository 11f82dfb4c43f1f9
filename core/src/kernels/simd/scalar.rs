//! Scalar: arrays of 16, which the compiler vectorises for what every such machine has.

use core::array::from_fn;

use crate::kernels::lanes::Lanes;
use crate::kernels::simd::{Simd, WHOLE, rsqrt_estimate};
use crate::math::sqrtf;

/// The set that is always there. Products and sums are rounded apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scalar;

impl Simd for Scalar {
    type V = Lanes;

    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Lanes {
        [x; 16]
    }

    #[inline(always)]
    fn load(self, lanes: &Lanes) -> Lanes {
        *lanes
    }

    #[inline(always)]
    fn store(self, v: Lanes, lanes: &mut Lanes) {
        *lanes = v;
    }

    #[inline(always)]
    fn add(self, a: Lanes, b: Lanes) -> Lanes {
        from_fn(|l| a[l] + b[l])
    }

    #[inline(always)]
    fn sub(self, a: Lanes, b: Lanes) -> Lanes {
        from_fn(|l| a[l] - b[l])
    }

    #[inline(always)]
    fn mul(self, a: Lanes, b: Lanes) -> Lanes {
        from_fn(|l| a[l] * b[l])
    }

    #[inline(always)]
    fn div(self, a: Lanes, b: Lanes) -> Lanes {
        from_fn(|l| a[l] / b[l])
    }

    #[inline(always)]
    fn sqrt(self, a: Lanes) -> Lanes {
        a.map(sqrtf)
    }

    #[inline(always)]
    fn fma(self, a: Lanes, b: Lanes, c: Lanes) -> Lanes {
        from_fn(|l| a[l] * b[l] + c[l])
    }

    #[inline(always)]
    fn fnma(self, a: Lanes, b: Lanes, c: Lanes) -> Lanes {
        from_fn(|l| c[l] - a[l] * b[l])
    }

    #[inline(always)]
    fn min(self, a: Lanes, b: Lanes) -> Lanes {
        from_fn(|l| if a[l] < b[l] { a[l] } else { b[l] })
    }

    #[inline(always)]
    fn max(self, a: Lanes, b: Lanes) -> Lanes {
        from_fn(|l| if a[l] > b[l] { a[l] } else { b[l] })
    }

    #[inline(always)]
    fn abs(self, a: Lanes) -> Lanes {
        a.map(f32::abs)
    }

    #[inline(always)]
    fn round(self, a: Lanes) -> Lanes {
        from_fn(|l| (a[l] + WHOLE) - WHOLE)
    }

    #[inline(always)]
    fn exp2(self, a: Lanes) -> Lanes {
        // The exponent's bits.
        from_fn(|l| f32::from_bits(((a[l] as i32 + 127) as u32) << 23))
    }

    #[inline(always)]
    fn exponent(self, a: Lanes) -> Lanes {
        a.map(|a| ((a.to_bits() >> 23) as i32 - 127) as f32)
    }

    #[inline(always)]
    fn rsqrt_estimate(self, a: Lanes) -> Lanes {
        a.map(rsqrt_estimate)
    }

    #[inline(always)]
    fn select_less(self, a: Lanes, b: Lanes, x: Lanes, y: Lanes) -> Lanes {
        from_fn(|l| if a[l] < b[l] { x[l] } else { y[l] })
    }

    #[inline(always)]
    fn less(self, a: Lanes, b: Lanes) -> u32 {
        (0..16).fold(0, |bits, l| bits | u32::from(a[l] < b[l]) << l)
    }
}
