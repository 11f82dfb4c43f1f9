//! WebAssembly simd128: four registers for 16 lanes, where the whole program is compiled for it.
//!
//! No operation is fused and the estimate is that of the scalar set, so that both sets give the same bits.

#[allow(clippy::wildcard_imports, reason = "the intrinsics, whose names say where they are from")]
use core::arch::wasm32::*;

use crate::kernels::simd::fours::{FOUR, Register};

/// Token that stands for simd128 in a program that is compiled for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vectors;

/// Defines methods that are one expression of intrinsics.
macro_rules! operations {
    ($($name:ident($($argument:ident),*) = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: v128),*) -> v128 {
            $body
        }
    )*};
}

impl Register for Vectors {
    type V = v128;

    inlined! {
        splat(self, x: f32) -> v128 = f32x4_splat(x);
        // SAFETY: four numbers fill a register, and loads need no alignment.
        load(self, four: &[f32; FOUR]) -> v128 = unsafe { v128_load(four.as_ptr().cast()) };
        // SAFETY: four numbers fill a register, and stores need no alignment.
        store(self, v: v128, four: &mut [f32; FOUR]) -> () = unsafe { v128_store(four.as_mut_ptr().cast(), v) };
        less(self, a: v128, b: v128) -> u32 = u32::from(i32x4_bitmask(f32x4_lt(a, b)));
    }

    operations! {
        add(a, b) = f32x4_add(a, b);
        sub(a, b) = f32x4_sub(a, b);
        mul(a, b) = f32x4_mul(a, b);
        div(a, b) = f32x4_div(a, b);
        sqrt(a) = f32x4_sqrt(a);
        fma(a, b, c) = f32x4_add(f32x4_mul(a, b), c);
        fnma(a, b, c) = f32x4_sub(c, f32x4_mul(a, b));
        min(a, b) = f32x4_pmin(b, a);
        max(a, b) = f32x4_pmax(b, a);
        abs(a) = f32x4_abs(a);
        round(a) = f32x4_nearest(a);
        exp2(a) = i32x4_shl(i32x4_add(i32x4_trunc_sat_f32x4(a), i32x4_splat(127)), 23);
        exponent(a) = f32x4_convert_i32x4(i32x4_sub(u32x4_shr(a, 23), i32x4_splat(127)));
        rsqrt_estimate(a) = {
            let half = f32x4_mul(a, f32x4_splat(0.5));
            let y = i32x4_sub(i32x4_splat(0x5f37_5a86), u32x4_shr(a, 1));
            let three_halves = f32x4_splat(1.5);
            let y = f32x4_mul(y, f32x4_sub(three_halves, f32x4_mul(f32x4_mul(half, y), y)));
            f32x4_mul(y, f32x4_sub(three_halves, f32x4_mul(f32x4_mul(half, y), y)))
        };
        select_less(a, b, x, y) = v128_bitselect(x, y, f32x4_lt(a, b));
        swap_pairs(a) = i32x4_shuffle::<2, 3, 0, 1>(a, a);
        swap_neighbours(a) = i32x4_shuffle::<1, 0, 3, 2>(a, a);
        pick_pairs(low, high) = i32x4_shuffle::<0, 1, 6, 7>(low, high);
        pick_neighbours(low, high) = i32x4_shuffle::<0, 5, 2, 7>(low, high);
    }
}
