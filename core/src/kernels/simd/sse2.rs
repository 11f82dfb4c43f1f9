//! SSE2, which every 64-bit x86 CPU has: registers of four numbers instead of scalar code, with the same bits.
//!
//! No operation is fused and the estimate is that of the scalar set.

#[allow(clippy::wildcard_imports, reason = "the intrinsics, whose names say where they are from")]
use core::arch::x86_64::*;

use crate::kernels::simd::WHOLE;
use crate::kernels::simd::fours::{FOUR, Register};

/// Token that stands for SSE2, which every 64-bit x86 CPU has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vectors;

/// Defines methods that are one expression of intrinsics.
macro_rules! operations {
    ($($name:ident($($argument:ident),*) = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: __m128),*) -> __m128 {
            // SAFETY: the program is compiled for SSE2.
            unsafe { $body }
        }
    )*};
}

impl Register for Vectors {
    type V = __m128;

    inlined! {
        // SAFETY: the program is compiled for SSE2.
        splat(self, x: f32) -> __m128 = unsafe { _mm_set1_ps(x) };
        // SAFETY: the program is compiled for SSE2; four numbers fill a register, and loads need no alignment.
        load(self, four: &[f32; FOUR]) -> __m128 = unsafe { _mm_loadu_ps(four.as_ptr()) };
        // SAFETY: the program is compiled for SSE2; four numbers fill a register, and stores need no alignment.
        store(self, v: __m128, four: &mut [f32; FOUR]) -> () = unsafe { _mm_storeu_ps(four.as_mut_ptr(), v) };
        // SAFETY: the program is compiled for SSE2.
        less(self, a: __m128, b: __m128) -> u32 = unsafe { _mm_movemask_ps(_mm_cmplt_ps(a, b)) as u32 };
    }

    operations! {
        add(a, b) = _mm_add_ps(a, b);
        sub(a, b) = _mm_sub_ps(a, b);
        mul(a, b) = _mm_mul_ps(a, b);
        div(a, b) = _mm_div_ps(a, b);
        sqrt(a) = _mm_sqrt_ps(a);
        fma(a, b, c) = _mm_add_ps(_mm_mul_ps(a, b), c);
        fnma(a, b, c) = _mm_sub_ps(c, _mm_mul_ps(a, b));
        min(a, b) = _mm_min_ps(a, b);
        max(a, b) = _mm_max_ps(a, b);
        abs(a) = _mm_andnot_ps(_mm_set1_ps(-0.0), a);
        round(a) = _mm_sub_ps(_mm_add_ps(a, _mm_set1_ps(WHOLE)), _mm_set1_ps(WHOLE));
        // Both exp2 and exponent use the bits of the exponent.
        exp2(a) = _mm_castsi128_ps(_mm_slli_epi32::<23>(_mm_add_epi32(_mm_cvttps_epi32(a), _mm_set1_epi32(127))));
        exponent(a) = _mm_cvtepi32_ps(_mm_sub_epi32(_mm_srli_epi32::<23>(_mm_castps_si128(a)), _mm_set1_epi32(127)));
        rsqrt_estimate(a) = {
            let (half, three_halves) = (_mm_mul_ps(a, _mm_set1_ps(0.5)), _mm_set1_ps(1.5));
            let bits = _mm_sub_epi32(_mm_set1_epi32(0x5f37_5a86), _mm_srli_epi32::<1>(_mm_castps_si128(a)));
            let y = _mm_castsi128_ps(bits);
            let y = _mm_mul_ps(y, _mm_sub_ps(three_halves, _mm_mul_ps(_mm_mul_ps(half, y), y)));
            _mm_mul_ps(y, _mm_sub_ps(three_halves, _mm_mul_ps(_mm_mul_ps(half, y), y)))
        };
        select_less(a, b, x, y) = {
            let less = _mm_cmplt_ps(a, b);
            _mm_or_ps(_mm_and_ps(less, x), _mm_andnot_ps(less, y))
        };
        swap_pairs(a) = _mm_shuffle_ps::<0b01_00_11_10>(a, a);
        swap_neighbours(a) = _mm_shuffle_ps::<0b10_11_00_01>(a, a);
        pick_pairs(low, high) = _mm_shuffle_ps::<0b11_10_01_00>(low, high);
        pick_neighbours(low, high) = {
            let v = _mm_shuffle_ps::<0b11_01_10_00>(low, high);
            _mm_shuffle_ps::<0b11_01_10_00>(v, v)
        };
    }
}
