//! Doubles: operations on f64, none of them fused, so that every instruction set gives the same bits.
//!
//! Numbers are stored in groups of eight; an instruction set processes all eight at once, or one after the other.

use core::ops::{Add, Mul, Sub};

use crate::kernels::simd::fours::Fours;
use crate::prelude::*;

/// Size of a group of numbers.
pub(crate) const EIGHT: usize = 8;

/// A group of eight numbers.
pub(crate) type Eight = [f64; EIGHT];

/// The constant of [`Doubles::rsqrt_estimate_doubles`].
pub(crate) const ROOT: u64 = 0x5fe6_eb50_c7b5_37a9;

/// Operations of an instruction set on doubles.
pub(crate) trait Doubles: Copy {
    /// A vector of [`Doubles::WIDTH`] f64, a divisor of [`EIGHT`].
    type D: Copy;

    const WIDTH: usize;

    fn splat_double(self, x: f64) -> Self::D;
    /// Returns the vector at the beginning of a slice.
    fn load_doubles(self, from: &[f64]) -> Self::D;
    fn store_doubles(self, d: Self::D, to: &mut [f64]);
    fn add_doubles(self, a: Self::D, b: Self::D) -> Self::D;
    fn sub_doubles(self, a: Self::D, b: Self::D) -> Self::D;
    fn mul_doubles(self, a: Self::D, b: Self::D) -> Self::D;
    fn div_doubles(self, a: Self::D, b: Self::D) -> Self::D;
    fn sqrt_doubles(self, a: Self::D) -> Self::D;
    /// Returns 1/sqrt(a) of normal a within 3.5 %: the integer of its bits is [`ROOT`] less half of the integer of a's
    /// bits.
    fn rsqrt_estimate_doubles(self, a: Self::D) -> Self::D;
    /// Returns x where a < b, else y.
    fn select_doubles(self, a: Self::D, b: Self::D, x: Self::D, y: Self::D) -> Self::D;
}

/// Processes one number at a time.
impl<R: Copy> Doubles for Fours<R> {
    type D = f64;

    const WIDTH: usize = 1;

    inlined! {
        splat_double(self, x: f64) -> f64 = x;
        load_doubles(self, from: &[f64]) -> f64 = from[0];
        store_doubles(self, d: f64, to: &mut [f64]) -> () = to[0] = d;
        add_doubles(self, a: f64, b: f64) -> f64 = a + b;
        sub_doubles(self, a: f64, b: f64) -> f64 = a - b;
        mul_doubles(self, a: f64, b: f64) -> f64 = a * b;
        div_doubles(self, a: f64, b: f64) -> f64 = a / b;
        sqrt_doubles(self, a: f64) -> f64 = math::sqrt(a);
        rsqrt_estimate_doubles(self, a: f64) -> f64 = f64::from_bits(ROOT - (a.to_bits() >> 1));
        select_doubles(self, a: f64, b: f64, x: f64, y: f64) -> f64 = if a < b { x } else { y };
    }
}

/// A vector of doubles with the token of its instruction set, so that formulas can be written with operators.
#[derive(Clone, Copy)]
pub(crate) struct V<S: Doubles>(S, S::D);

impl<S: Doubles> V<S> {
    #[inline(always)]
    pub(crate) fn all(s: S, x: f64) -> Self {
        Self(s, s.splat_double(x))
    }

    #[inline(always)]
    pub(crate) fn of(s: S, from: &[f64]) -> Self {
        Self(s, s.load_doubles(from))
    }

    #[inline(always)]
    pub(crate) fn put(self, to: &mut [f64]) {
        self.0.store_doubles(self.1, to);
    }

    /// Adds the vector to the first numbers of a slice.
    #[inline(always)]
    pub(crate) fn onto(self, sum: &mut [f64]) {
        (Self::of(self.0, sum) + self).put(sum);
    }

    /// Applies a function with N results to each number, one after the other.
    #[inline(always)]
    pub(crate) fn each<const N: usize>(self, of: impl Fn(f64) -> [f64; N]) -> [Self; N] {
        let (mut lanes, mut out) = ([0.0; EIGHT], [[0.0; EIGHT]; N]);
        self.put(&mut lanes);
        for lane in 0..S::WIDTH {
            let values = of(lanes[lane]);
            for k in 0..N {
                out[k][lane] = values[k];
            }
        }
        let mut all = [self; N];
        for k in 0..N {
            all[k] = Self::of(self.0, &out[k]);
        }
        all
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self(self.0, self.0.sqrt_doubles(self.1))
    }

    /// Returns 1/x.
    #[inline(always)]
    pub(crate) fn inverse(self) -> Self {
        Self(self.0, self.0.div_doubles(self.0.splat_double(1.0), self.1))
    }

    /// Returns 1/sqrt(x) of normal x within 3e-12, in half the time of a root and a quotient.
    #[inline(always)]
    pub(crate) fn inverse_root(self) -> Self {
        let mut root = Self(self.0, self.0.rsqrt_estimate_doubles(self.1));
        // Halley's step: an error e becomes 5/2 e^3.
        for _ in 0..2 {
            let rest = Self::all(self.0, 1.0) - self * root * root;
            root = root + root * rest * (rest * 0.375 + 0.5);
        }
        root
    }

    /// Returns this vector where `a` < `b`, else `other`.
    #[inline(always)]
    pub(crate) fn where_less(self, a: Self, b: Self, other: Self) -> Self {
        Self(self.0, self.0.select_doubles(a.1, b.1, self.1, other.1))
    }

    /// Returns the nearest integers for |x| < 2^51, ties to even.
    #[inline(always)]
    pub(crate) fn round(self) -> Self {
        const WHOLE: f64 = 6_755_399_441_055_744.0;
        (self + WHOLE) - WHOLE
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $operation:ident) => {
        impl<S: Doubles> $trait for V<S> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0, self.0.$operation(self.1, other.1))
            }
        }

        impl<S: Doubles> $trait<f64> for V<S> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: f64) -> Self {
                Self(self.0, self.0.$operation(self.1, self.0.splat_double(other)))
            }
        }
    };
}
operator!(Add, add, add_doubles);
operator!(Sub, sub, sub_doubles);
operator!(Mul, mul, mul_doubles);

/// Iterates over the first index of each vector in a group of eight.
#[inline(always)]
pub(crate) fn runs<S: Doubles>(_s: S) -> impl Iterator<Item = usize> {
    (0..EIGHT).step_by(S::WIDTH)
}

/// Returns the array of `of(0)` to `of(N - 1)`. A closure of `core::array::from_fn` would be compiled without the set's
/// instructions, and run half as fast.
#[inline(always)]
pub(crate) fn list<S: Doubles, const N: usize>(s: S, of: impl Fn(usize) -> V<S>) -> [V<S>; N] {
    let mut all = [V::all(s, 0.0); N];
    for k in 0..N {
        all[k] = of(k);
    }
    all
}

/// Loads one vector from each list, from index `at` on.
#[inline(always)]
pub(crate) fn loaded<S: Doubles, const N: usize>(s: S, lists: &[Eight; N], at: usize) -> [V<S>; N] {
    list(s, |k| V::of(s, &lists[k][at..]))
}

/// Returns a vector times a number, per lane.
#[inline(always)]
pub(crate) fn scaled<S: Doubles, const N: usize>(v: [V<S>; N], x: V<S>) -> [V<S>; N] {
    list(x.0, |k| v[k] * x)
}

/// Returns the vectors from places to a point.
#[inline(always)]
pub(crate) fn ray<S: Doubles>(s: S, point: [f64; 3], (places, at): (&[Eight; 3], usize)) -> [V<S>; 3] {
    let [x, y, z] = loaded(s, places, at);
    [V::all(s, point[0]) - x, V::all(s, point[1]) - y, V::all(s, point[2]) - z]
}

/// Returns the dot product a . b, per lane.
#[inline(always)]
pub(crate) fn dot<S: Doubles>(a: [V<S>; 3], b: [V<S>; 3]) -> V<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the sum of eight numbers, in a fixed order.
pub(crate) fn total([a, b, c, d, e, f, g, h]: Eight) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}
