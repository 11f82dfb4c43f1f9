//! NEON: four registers for 16 lanes, on every 64-bit ARM CPU.

#[allow(clippy::wildcard_imports, reason = "the intrinsics, whose names say where they are from")]
use core::arch::aarch64::*;

use crate::kernels::simd::fours::{FOUR, Fours, Register};

/// Token for operations on 16 lanes by NEON.
pub(crate) type Neon = Fours<Vectors>;

/// Token that stands for NEON, which every 64-bit ARM CPU has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vectors;

/// Defines methods that are one expression of intrinsics.
macro_rules! operations {
    ($($name:ident($($argument:ident),*) = $body:expr;)*) => {$(
        #[inline(always)]
        #[allow(unused_unsafe, reason = "safe where NEON is part of the target")]
        fn $name(self, $($argument: float32x4_t),*) -> float32x4_t {
            // SAFETY: every aarch64 CPU has NEON.
            unsafe { $body }
        }
    )*};
}

impl Register for Vectors {
    type V = float32x4_t;

    inlined! {
        // SAFETY: every aarch64 CPU has NEON.
        #[allow(unused_unsafe, reason = "safe where NEON is part of the target")]
        splat(self, x: f32) -> float32x4_t = unsafe { vdupq_n_f32(x) };
        // SAFETY: four numbers fill a register.
        load(self, four: &[f32; FOUR]) -> float32x4_t = unsafe { vld1q_f32(four.as_ptr()) };
        // SAFETY: four numbers fill a register.
        store(self, v: float32x4_t, four: &mut [f32; FOUR]) -> () = unsafe { vst1q_f32(four.as_mut_ptr(), v) };
        // SAFETY: every aarch64 CPU has NEON, and four numbers fill a register.
        less(self, a: float32x4_t, b: float32x4_t) -> u32 =
            unsafe { vaddvq_u32(vandq_u32(vcltq_f32(a, b), vld1q_u32([1, 2, 4, 8].as_ptr()))) };
    }

    operations! {
        add(a, b) = vaddq_f32(a, b);
        sub(a, b) = vsubq_f32(a, b);
        mul(a, b) = vmulq_f32(a, b);
        div(a, b) = vdivq_f32(a, b);
        sqrt(a) = vsqrtq_f32(a);
        fma(a, b, c) = vfmaq_f32(c, a, b);
        fnma(a, b, c) = vfmsq_f32(c, a, b);
        min(a, b) = vbslq_f32(vcltq_f32(a, b), a, b);
        max(a, b) = vbslq_f32(vcltq_f32(b, a), a, b);
        abs(a) = vabsq_f32(a);
        round(a) = vrndnq_f32(a);
        exp2(a) = vreinterpretq_f32_s32(vshlq_n_s32::<23>(vaddq_s32(vcvtq_s32_f32(a), vdupq_n_s32(127))));
        exponent(a) = vcvtq_f32_s32(vsubq_s32(vshrq_n_s32::<23>(vreinterpretq_s32_f32(a)), vdupq_n_s32(127)));
        // An estimate of eight bits, whose rounding ARM specifies, and a step of Newton's method.
        rsqrt_estimate(a) = {
            let y = vrsqrteq_f32(a);
            vmulq_f32(y, vrsqrtsq_f32(vmulq_f32(a, y), y))
        };
        select_less(a, b, x, y) = vbslq_f32(vcltq_f32(a, b), x, y);
        swap_pairs(a) = vextq_f32::<2>(a, a);
        swap_neighbours(a) = vrev64q_f32(a);
        pick_pairs(low, high) = vcombine_f32(vget_low_f32(low), vget_high_f32(high));
        pick_neighbours(low, high) = vtrn1q_f32(low, vrev64q_f32(high));
    }
}
