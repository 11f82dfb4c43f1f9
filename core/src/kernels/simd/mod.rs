//! The vector trait: operations on 16 f32, whatever the machine's registers hold.
//!
//! [`Simd`] is the whole vocabulary of the kernels: each is written once over it. A value that implements it is a
//! token: it exists only where its instructions do, which is what makes the `unsafe` blocks of these files sound.
//! Its operations in which no lane sees another are those of [`Elementwise`]: some of the lanes can do them alone.
//! Sums run over the lanes in one fixed tree, so that instruction sets differ by fused multiply-adds and the estimate of
//! an inverse root alone.

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "it names instructions: a token proves that the CPU has them")]
pub(crate) mod avx2;
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "it names instructions: a token proves that the CPU has them")]
pub(crate) mod avx512;
#[forbid(unsafe_code)]
pub(crate) mod doubles;
#[forbid(unsafe_code)]
pub(crate) mod fours;
pub(crate) mod instruction_set;
#[cfg(target_arch = "aarch64")]
#[allow(unsafe_code, reason = "it names instructions: a token proves that the CPU has them")]
pub(crate) mod neon;
#[cfg(not(any(
    all(target_arch = "wasm32", target_feature = "simd128"),
    all(target_arch = "x86_64", target_feature = "sse2")
)))]
#[forbid(unsafe_code)]
pub(crate) mod scalar;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
#[allow(unsafe_code, reason = "it names instructions: a token proves that the CPU has them")]
pub(crate) mod simd128;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
#[allow(unsafe_code, reason = "it names instructions: the program is compiled for CPUs that have them")]
pub(crate) mod sse2;

use crate::kernels::lanes::{LANES, Lanes};

/// Squares below it count as 0: the remainders of their roots would be denormal, at a hundred cycles each on some
/// machines.
pub(crate) const TINY: f32 = 1e-28;

/// Added to |x| < 2^22 it leaves the nearest integer, ties to even, in the lowest bits.
pub(crate) const WHOLE: f32 = 12_582_912.0;

/// Operations on lanes in which none sees another.
pub(crate) trait Elementwise: Copy {
    /// Sixteen f32, or those of some lanes.
    type V: Copy;

    /// Whether 16 lanes are more registers than a kernel should hold. Code and stack are then to be short: what a kernel can
    /// find out at each element it is not compiled for.
    const SHORT: bool = false;

    /// [`Elementwise::SHORT`] of a token.
    #[inline(always)]
    fn is_short(self) -> bool {
        Self::SHORT
    }

    /// Runs `f` compiled for this token's instructions; `f` must be `#[inline(always)]`.
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R;

    fn splat(self, x: f32) -> Self::V;
    fn load(self, lanes: &Lanes) -> Self::V;
    fn store(self, v: Self::V, lanes: &mut Lanes);
    fn add(self, a: Self::V, b: Self::V) -> Self::V;
    fn sub(self, a: Self::V, b: Self::V) -> Self::V;
    fn mul(self, a: Self::V, b: Self::V) -> Self::V;
    /// a / b, rounded once: the same bits by every set.
    fn div(self, a: Self::V, b: Self::V) -> Self::V;
    /// sqrt(a), rounded once: the same bits by every set.
    fn sqrt(self, a: Self::V) -> Self::V;
    /// a b + c, rounded once where the machine can.
    fn fma(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// c - a b.
    fn fnma(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// The lesser; b if either is NaN.
    fn min(self, a: Self::V, b: Self::V) -> Self::V;
    /// The greater; b if either is NaN.
    fn max(self, a: Self::V, b: Self::V) -> Self::V;
    fn abs(self, a: Self::V) -> Self::V;
    /// The nearest integer of |a| < 2^22, ties to even.
    fn round(self, a: Self::V) -> Self::V;
    /// The greatest integer up to |a| < 2^22.
    #[inline(always)]
    fn floor(self, a: Self::V) -> Self::V {
        let near = self.round(a);
        self.select_less(a, near, self.sub(near, self.splat(1.0)), near)
    }
    /// a less its nearest integer, for |a| < 2^22.
    #[inline(always)]
    fn fract(self, a: Self::V) -> Self::V {
        self.sub(a, self.round(a))
    }
    /// 2^a of integers a in -126..=127.
    fn exp2(self, a: Self::V) -> Self::V;
    /// The greatest integer e with 2^e <= a, of normal a > 0.
    fn exponent(self, a: Self::V) -> Self::V;
    /// 1/sqrt(a) with a relative error below 7e-5, of normal a > 0.
    fn rsqrt_estimate(self, a: Self::V) -> Self::V;
    /// x where a < b, else y.
    fn select_less(self, a: Self::V, b: Self::V, x: Self::V, y: Self::V) -> Self::V;
    /// Bit l is set where a < b.
    fn less(self, a: Self::V, b: Self::V) -> u32;
    /// The bits of all its lanes.
    #[inline(always)]
    fn every(self) -> u32 {
        (1 << LANES) - 1
    }

    /// Four lanes of each number.
    #[inline(always)]
    fn quarters(self, numbers: [f32; 4]) -> Self::V {
        self.load(&core::array::from_fn(|l| numbers[l / 4]))
    }

    /// `table[index % 16]` of an integer added to [`WHOLE`].
    #[inline(always)]
    fn gather(self, table: &Lanes, index: Self::V) -> Self::V {
        let mut lanes = [0.0; LANES];
        self.store(index, &mut lanes);
        self.load(&lanes.map(|index| table[index.to_bits() as usize % LANES]))
    }

    /// `list[index]` of a list of any length but 0, for indices that are whole numbers; those beyond its end read its last.
    #[inline(always)]
    fn gather_list(self, list: &[f32], index: Self::V) -> Self::V {
        let mut lanes = [0.0; LANES];
        self.store(index, &mut lanes);
        self.load(&lanes.map(|index| list[(index as usize).min(list.len() - 1)]))
    }

    /// sqrt(a) and 1/sqrt(a) of a >= [`TINY`], each within two roundings: one step of Newton from the guess for
    /// each, with their own remainders.
    #[inline(always)]
    fn sqrt_rsqrt(self, a: Self::V) -> (Self::V, Self::V) {
        let guess = self.rsqrt_estimate(a);
        let root = self.mul(a, guess);
        let half = self.mul(guess, self.splat(0.5));
        let (miss, other) = (self.fnma(root, root, a), self.fnma(root, guess, self.splat(1.0)));
        (self.fma(half, miss, root), self.fma(half, other, guess))
    }

    /// 1/sqrt(a) alone.
    #[inline(always)]
    fn rsqrt(self, a: Self::V) -> Self::V {
        let (guess, miss) = self.rsqrt_guess(a);
        self.fma(self.mul(guess, self.splat(0.5)), miss, guess)
    }

    /// g and m with 1/sqrt(a) = g (1 + m/2) within two roundings: a factor joins g while m is waited for.
    #[inline(always)]
    fn rsqrt_guess(self, a: Self::V) -> (Self::V, Self::V) {
        let guess = self.rsqrt_estimate(a);
        (guess, self.fnma(self.mul(a, guess), guess, self.splat(1.0)))
    }
}

/// A kernel in which no lane sees another: it may run over some of the lanes after the others.
pub(crate) trait Apart {
    fn run<S: Elementwise>(&mut self, s: S);
}

/// Operations on 16 lanes.
pub(crate) trait Simd: Elementwise {
    /// Runs a kernel of which the first `used` lanes matter, the others may or may not run: over all lanes at once, or over
    /// those of one register after the other.
    #[inline(always)]
    fn apart(self, used: usize, kernel: &mut impl Apart) {
        let _ = used;
        kernel.run(self);
    }

    /// Runs `f`, as a function of the program where code and stack must be short; it must be `#[inline(always)]`.
    #[inline(always)]
    fn aside<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }

    /// Lane l gets lane l xor `DISTANCE`: 8 swaps the halves, 4 the quarters of each half, 2 and 1 so on.
    #[inline(always)]
    fn swap<const DISTANCE: usize>(self, a: Self::V) -> Self::V {
        let mut lanes = [0.0; LANES];
        self.store(a, &mut lanes);
        self.load(&core::array::from_fn(|l| lanes[(l ^ DISTANCE) % LANES]))
    }

    /// Lane l of `low` where l lacks the bit `DISTANCE`, else lane l of `high`.
    #[inline(always)]
    fn pick<const DISTANCE: usize>(self, low: Self::V, high: Self::V) -> Self::V {
        let mut lanes = [[0.0; LANES]; 2];
        self.store(low, &mut lanes[0]);
        self.store(high, &mut lanes[1]);
        self.load(&core::array::from_fn(|l| lanes[usize::from(l & DISTANCE > 0)][l]))
    }

    /// Lanes l and l xor `DISTANCE` added up: where l lacks the bit `DISTANCE` those of a, else those of b.
    #[inline(always)]
    fn fold<const DISTANCE: usize>(self, a: Self::V, b: Self::V) -> Self::V {
        self.add(self.pick::<DISTANCE>(a, b), self.swap::<DISTANCE>(self.pick::<DISTANCE>(b, a)))
    }

    /// The sum over lanes: halves upon halves.
    #[inline(always)]
    fn reduce_add(self, a: Self::V) -> f32 {
        let mut lanes = [0.0; LANES];
        self.store(a, &mut lanes);
        reduce_add(&lanes)
    }

    /// The greatest lane, if none is NaN.
    #[inline(always)]
    fn reduce_max(self, a: Self::V) -> f32 {
        let mut lanes = [0.0; LANES];
        self.store(a, &mut lanes);
        lanes.into_iter().fold(f32::NEG_INFINITY, |a, b| if a > b { a } else { b })
    }

    /// The least lane, if none is NaN.
    #[inline(always)]
    fn least(self, a: Self::V) -> f32 {
        -self.reduce_max(self.sub(self.splat(0.0), a))
    }

    /// The least lane, in all lanes, if none is NaN.
    #[inline(always)]
    fn reduce_min(self, a: Self::V) -> Self::V {
        self.splat(self.least(a))
    }

    /// Lane k is the sum over the lanes of vector k, the same tree as [`Simd::reduce_add`].
    #[inline(always)]
    fn reduce_add_each(self, vectors: &[Self::V; LANES]) -> Self::V {
        let mut v = *vectors;
        for k in 0..8 {
            v[k] = self.fold::<8>(v[k], v[k + 8]);
        }
        for k in 0..4 {
            v[k] = self.fold::<4>(v[k], v[k + 4]);
        }
        for k in 0..2 {
            v[k] = self.fold::<2>(v[k], v[k + 2]);
        }
        self.fold::<1>(v[0], v[1])
    }

    /// Lane k is the sum of list k, of which only the first `used` lanes are not +0: [`Simd::reduce_add_each`].
    #[inline(always)]
    fn sums(self, lists: &[Lanes; LANES], used: usize) -> Self::V {
        let _ = used;
        let mut vectors = [self.splat(0.0); LANES];
        for (vector, list) in vectors.iter_mut().zip(lists) {
            *vector = self.load(list);
        }
        self.reduce_add_each(&vectors)
    }

    /// Lane l of vector k becomes lane k of vector l.
    #[inline(always)]
    fn transpose(self, vectors: [Self::V; LANES]) -> [Self::V; LANES] {
        let mut lists = [[0.0; LANES]; LANES];
        for (list, vector) in lists.iter_mut().zip(vectors) {
            self.store(vector, list);
        }
        core::array::from_fn(|l| self.load(&lists.map(|list| list[l])))
    }

    /// Lanes 2k and 2k + 1 are pair floor(x) + `zero` of a list of pairs, at least one, for the x in lane 2k; those beyond its
    /// ends, and what is no number, read its last.
    #[inline(always)]
    fn gather_pairs(self, list: &[f32], zero: i32, x: Self::V) -> Self::V {
        let (pairs, mut lanes) = (list.as_chunks::<2>().0, [0.0; LANES]);
        self.store(self.floor(x), &mut lanes);
        for pair in lanes.as_chunks_mut::<2>().0 {
            let at = if pair[0].is_nan() { -1 } else { (pair[0] as i32).wrapping_add(zero) };
            *pair = pairs[(at as u32 as usize).min(pairs.len() - 1)];
        }
        self.load(&lanes)
    }
}

/// The sum over lanes, halves upon halves: a fixed tree, so that its rounding is part of the contract.
#[inline(always)]
pub(crate) fn reduce_add(lanes: &Lanes) -> f32 {
    let eight: [f32; 8] = core::array::from_fn(|l| lanes[l] + lanes[l + 8]);
    let four: [f32; 4] = core::array::from_fn(|l| eight[l] + eight[l + 4]);
    (four[0] + four[2]) + (four[1] + four[3])
}
