//! WebAssembly simd128: four registers, where the whole program is compiled for it.
//!
//! Nothing is fused and the guess is the scalar one, so the bits are those of the scalar set.

use core::arch::wasm32::{
    f32x4_abs, f32x4_add, f32x4_convert_i32x4, f32x4_div, f32x4_lt, f32x4_mul, f32x4_nearest, f32x4_pmax, f32x4_pmin,
    f32x4_splat, f32x4_sqrt, f32x4_sub, i32x4_add, i32x4_bitmask, i32x4_shl, i32x4_shuffle, i32x4_splat, i32x4_sub,
    i32x4_trunc_sat_f32x4, u32x4_shr, v128, v128_bitselect, v128_load, v128_store,
};

use crate::kernels::lanes::Lanes;
use crate::kernels::simd::Simd;

/// simd128 is there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simd128;

type Four = [v128; 4];

/// A method of [`Simd`] that does the same to all registers.
macro_rules! operations {
    ($($name:ident($($argument:ident),*) = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: Four),*) -> Four {
            macro_rules! one {
                ($h:literal) => {{
                    $(let $argument = $argument[$h];)*
                    $body
                }};
            }
            [one!(0), one!(1), one!(2), one!(3)]
        }
    )*};
}

impl Simd for Simd128 {
    type V = Four;

    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Four {
        [f32x4_splat(x); 4]
    }

    #[inline(always)]
    fn load(self, lanes: &Lanes) -> Four {
        let at = lanes.as_ptr().cast::<v128>();
        // SAFETY: 16 numbers are four registers, and loads need no alignment.
        unsafe { [v128_load(at), v128_load(at.add(1)), v128_load(at.add(2)), v128_load(at.add(3))] }
    }

    #[inline(always)]
    fn store(self, v: Four, lanes: &mut Lanes) {
        let at = lanes.as_mut_ptr().cast::<v128>();
        // SAFETY: 16 numbers are four registers, and stores need no alignment.
        unsafe {
            v128_store(at, v[0]);
            v128_store(at.add(1), v[1]);
            v128_store(at.add(2), v[2]);
            v128_store(at.add(3), v[3]);
        }
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
    }

    #[inline(always)]
    fn less(self, a: Four, b: Four) -> u32 {
        macro_rules! bits {
            ($h:literal) => {
                u32::from(i32x4_bitmask(f32x4_lt(a[$h], b[$h]))) << (4 * $h)
            };
        }
        bits!(0) | bits!(1) | bits!(2) | bits!(3)
    }

    #[inline(always)]
    fn swap<const DISTANCE: usize>(self, [a, b, c, d]: Four) -> Four {
        match DISTANCE {
            8 => [c, d, a, b],
            4 => [b, a, d, c],
            2 => [a, b, c, d].map(|x| i32x4_shuffle::<2, 3, 0, 1>(x, x)),
            _ => [a, b, c, d].map(|x| i32x4_shuffle::<1, 0, 3, 2>(x, x)),
        }
    }

    #[inline(always)]
    fn quarters(self, numbers: [f32; 4]) -> Four {
        numbers.map(|x| f32x4_splat(x))
    }
}
