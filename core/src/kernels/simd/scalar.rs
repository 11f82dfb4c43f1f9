//! Scalar: single numbers, which the compiler vectorises with the instructions that every such machine has.

use crate::kernels::simd::WHOLE;
use crate::kernels::simd::fours::{FOUR, Register};
use crate::math::sqrtf;

/// Token that stands for single numbers, which every machine has. Products and sums are rounded separately.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Numbers;

type Four = [f32; FOUR];

/// Defines methods that apply one expression to each number. (A loop would remain a loop where code is to be short.)
macro_rules! operations {
    ($($name:ident($($argument:ident),*) = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: Four),*) -> Four {
            macro_rules! one {
                ($l:literal) => {{
                    $(let $argument = $argument[$l];)*
                    $body
                }};
            }
            [one!(0), one!(1), one!(2), one!(3)]
        }
    )*};
}

impl Register for Numbers {
    type V = Four;

    inlined! {
        splat(self, x: f32) -> Four = [x; FOUR];
        load(self, four: &Four) -> Four = *four;
        store(self, v: Four, four: &mut Four) -> () = *four = v;
        swap_pairs(self, a: Four) -> Four = [a[2], a[3], a[0], a[1]];
        swap_neighbours(self, a: Four) -> Four = [a[1], a[0], a[3], a[2]];
        pick_pairs(self, low: Four, high: Four) -> Four = [low[0], low[1], high[2], high[3]];
        pick_neighbours(self, low: Four, high: Four) -> Four = [low[0], high[1], low[2], high[3]];
    }

    operations! {
        add(a, b) = a + b;
        sub(a, b) = a - b;
        mul(a, b) = a * b;
        div(a, b) = a / b;
        sqrt(a) = sqrtf(a);
        fma(a, b, c) = a * b + c;
        fnma(a, b, c) = c - a * b;
        min(a, b) = if a < b { a } else { b };
        max(a, b) = if a > b { a } else { b };
        abs(a) = a.abs();
        round(a) = (a + WHOLE) - WHOLE;
        // Both exp2 and exponent use the bits of the exponent.
        exp2(a) = f32::from_bits(((a as i32 + 127) as u32) << 23);
        exponent(a) = ((a.to_bits() >> 23) as i32 - 127) as f32;
        rsqrt_estimate(a) = rsqrt_estimate(a);
        select_less(a, b, x, y) = if a < b { x } else { y };
    }

    #[inline(always)]
    fn less(self, a: Four, b: Four) -> u32 {
        let bit = |l: usize| u32::from(a[l] < b[l]) << l;
        bit(0) | bit(1) | bit(2) | bit(3)
    }
}

/// Returns 1/sqrt(x). The exponent's bits give it within 3.5e-2, and two steps of Newton's method within 5e-6. Unlike
/// the estimates of SSE it has the same bits on every machine.
#[inline(always)]
fn rsqrt_estimate(x: f32) -> f32 {
    let half = 0.5 * x;
    let y = f32::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1));
    let y = y * (1.5 - half * y * y);
    y * (1.5 - half * y * y)
}
