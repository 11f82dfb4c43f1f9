//! NEON: four registers, on every 64-bit ARM.

use core::arch::aarch64::{
    float32x4_t, vabsq_f32, vaddq_f32, vaddq_s32, vaddvq_u32, vandq_u32, vbslq_f32, vcltq_f32, vcvtq_f32_s32,
    vcvtq_s32_f32, vdivq_f32, vdupq_n_f32, vdupq_n_s32, vextq_f32, vfmaq_f32, vfmsq_f32, vld1q_f32, vld1q_u32,
    vmulq_f32, vreinterpretq_f32_s32, vreinterpretq_s32_f32, vrev64q_f32, vrndnq_f32, vrsqrteq_f32, vrsqrtsq_f32,
    vshlq_n_s32, vshrq_n_s32, vsqrtq_f32, vst1q_f32, vsubq_f32, vsubq_s32,
};

use crate::kernels::lanes::Lanes;
use crate::kernels::simd::Simd;

/// NEON is there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neon;

type Four = [float32x4_t; 4];

/// A method of [`Simd`] that does the same to all registers.
macro_rules! operations {
    ($($name:ident($($argument:ident),*) = $body:expr;)*) => {$(
        #[inline(always)]
        #[allow(unused_unsafe, reason = "safe where NEON is part of the target")]
        fn $name(self, $($argument: Four),*) -> Four {
            macro_rules! one {
                ($h:literal) => {{
                    $(let $argument = $argument[$h];)*
                    // SAFETY: every aarch64 CPU has NEON.
                    unsafe { $body }
                }};
            }
            [one!(0), one!(1), one!(2), one!(3)]
        }
    )*};
}

impl Simd for Neon {
    type V = Four;

    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }

    #[inline(always)]
    #[allow(unused_unsafe, reason = "safe where NEON is part of the target")]
    fn splat(self, x: f32) -> Four {
        // SAFETY: every aarch64 CPU has NEON.
        [unsafe { vdupq_n_f32(x) }; 4]
    }

    #[inline(always)]
    fn load(self, lanes: &Lanes) -> Four {
        let at = lanes.as_ptr();
        // SAFETY: 16 numbers are four registers.
        unsafe { [vld1q_f32(at), vld1q_f32(at.add(4)), vld1q_f32(at.add(8)), vld1q_f32(at.add(12))] }
    }

    #[inline(always)]
    fn store(self, v: Four, lanes: &mut Lanes) {
        let at = lanes.as_mut_ptr();
        // SAFETY: 16 numbers are four registers.
        unsafe {
            vst1q_f32(at, v[0]);
            vst1q_f32(at.add(4), v[1]);
            vst1q_f32(at.add(8), v[2]);
            vst1q_f32(at.add(12), v[3]);
        }
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
        // Eight bits, whose rounding ARM prescribes, and a step of Newton.
        rsqrt_estimate(a) = {
            let y = vrsqrteq_f32(a);
            vmulq_f32(y, vrsqrtsq_f32(vmulq_f32(a, y), y))
        };
        select_less(a, b, x, y) = vbslq_f32(vcltq_f32(a, b), x, y);
    }

    #[inline(always)]
    fn less(self, a: Four, b: Four) -> u32 {
        macro_rules! bits {
            ($h:literal) => {{
                // SAFETY: four numbers are a register.
                unsafe { vaddvq_u32(vandq_u32(vcltq_f32(a[$h], b[$h]), vld1q_u32([1, 2, 4, 8].as_ptr()))) << (4 * $h) }
            }};
        }
        bits!(0) | bits!(1) | bits!(2) | bits!(3)
    }

    #[inline(always)]
    #[allow(unused_unsafe, reason = "safe where NEON is part of the target")]
    fn swap<const DISTANCE: usize>(self, [a, b, c, d]: Four) -> Four {
        macro_rules! each {
            ($x:ident => $swapped:expr) => {{
                // SAFETY: every aarch64 CPU has NEON.
                let swapped = |$x| unsafe { $swapped };
                [swapped(a), swapped(b), swapped(c), swapped(d)]
            }};
        }
        match DISTANCE {
            8 => [c, d, a, b],
            4 => [b, a, d, c],
            2 => each!(x => vextq_f32::<2>(x, x)),
            _ => each!(x => vrev64q_f32(x)),
        }
    }

    #[inline(always)]
    #[allow(unused_unsafe, reason = "safe where NEON is part of the target")]
    fn quarters(self, numbers: [f32; 4]) -> Four {
        // SAFETY: every aarch64 CPU has NEON.
        numbers.map(|x| unsafe { vdupq_n_f32(x) })
    }
}
