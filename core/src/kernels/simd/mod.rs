//! The vector trait: operations on 16 f32, for registers of any size.
//!
//! [`Simd`] has all operations of the kernels: each kernel is written once with it. A value that implements it is a
//! token. It exists only where the CPU has its instructions, which makes the `unsafe` blocks of these files sound.
//! [`Elementwise`] has the operations in which no lane depends on another: they can run on some of the lanes alone.
//! Sums over the lanes follow one fixed tree. So the results of instruction sets differ only by fused multiply-adds and
//! by the estimate of an inverse root.

/// Defines methods that are one expression, each inlined: name, arguments, result and value.
macro_rules! inlined {
    ($( $(#[$about:meta])* $name:ident($this:ident $(, $argument:ident: $kind:ty)*) -> $result:ty = $body:expr; )*) => {$(
        $(#[$about])*
        #[inline(always)]
        fn $name($this $(, $argument: $kind)*) -> $result {
            $body
        }
    )*};
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "it names instructions: a token proves that the CPU has them")]
pub(crate) mod avx2;
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "it names instructions: a token proves that the CPU has them")]
pub(crate) mod avx512;
pub(crate) mod doubles;
pub(crate) mod fours;
pub(crate) mod instruction_set;
#[cfg(target_arch = "aarch64")]
#[allow(unsafe_code, reason = "it names instructions: a token proves that the CPU has them")]
pub(crate) mod neon;
#[cfg(not(any(
    all(target_arch = "wasm32", target_feature = "simd128"),
    all(target_arch = "x86_64", target_feature = "sse2")
)))]
pub(crate) mod scalar;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
#[allow(unsafe_code, reason = "it names instructions: a token proves that the CPU has them")]
pub(crate) mod simd128;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
#[allow(unsafe_code, reason = "it names instructions: the program is compiled for CPUs that have them")]
pub(crate) mod sse2;

use crate::kernels::lanes::{LANES, Lanes};

/// Smaller squares count as 0: the remainders of their roots would be denormal numbers, which take a hundred cycles on
/// some machines.
pub(crate) const TINY: f32 = 1e-28;

/// Added to |x| < 2^22, this number leaves the nearest integer, ties to even, in the lowest bits.
pub(crate) const WHOLE: f32 = 12_582_912.0;

/// Operations on lanes in which no lane depends on another.
pub(crate) trait Elementwise: Copy {
    /// Sixteen f32, or the f32 of some lanes.
    type V: Copy;

    /// Whether 16 lanes are more registers than a kernel should use. Code and stack must then be short: a kernel checks
    /// its options at each element instead of being compiled for each option.
    const SHORT: bool = false;

    /// Returns [`Elementwise::SHORT`] of a token.
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
    /// Returns a / b, rounded once: every set gives the same bits.
    fn div(self, a: Self::V, b: Self::V) -> Self::V;
    /// Returns sqrt(a), rounded once: every set gives the same bits.
    fn sqrt(self, a: Self::V) -> Self::V;
    /// Returns a b + c, rounded once where the machine has such an instruction.
    fn fma(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// Returns c - a b.
    fn fnma(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// Returns the smaller number; b if either is NaN.
    fn min(self, a: Self::V, b: Self::V) -> Self::V;
    /// Returns the larger number; b if either is NaN.
    fn max(self, a: Self::V, b: Self::V) -> Self::V;
    fn abs(self, a: Self::V) -> Self::V;
    /// Returns the nearest integer of |a| < 2^22, ties to even.
    fn round(self, a: Self::V) -> Self::V;
    /// Returns the largest integer that is at most a, |a| < 2^22.
    #[inline(always)]
    fn floor(self, a: Self::V) -> Self::V {
        let near = self.round(a);
        self.select_less(a, near, self.sub(near, self.splat(1.0)), near)
    }
    /// Returns a less its nearest integer, for |a| < 2^22.
    #[inline(always)]
    fn fract(self, a: Self::V) -> Self::V {
        self.sub(a, self.round(a))
    }
    /// Returns 2^a of integers a in -126..=127.
    fn exp2(self, a: Self::V) -> Self::V;
    /// Returns the largest integer e with 2^e <= a, of normal a > 0.
    fn exponent(self, a: Self::V) -> Self::V;
    /// Returns 1/sqrt(a) with a relative error below 7e-5, of normal a > 0.
    fn rsqrt_estimate(self, a: Self::V) -> Self::V;
    /// Returns x where a < b, else y.
    fn select_less(self, a: Self::V, b: Self::V, x: Self::V, y: Self::V) -> Self::V;
    /// Returns bits: bit l is set where a < b in lane l.
    fn less(self, a: Self::V, b: Self::V) -> u32;
    /// Returns a number in which the bit of every lane is set.
    #[inline(always)]
    fn every(self) -> u32 {
        (1 << LANES) - 1
    }

    /// Returns each of four numbers in four lanes.
    #[inline(always)]
    fn quarters(self, numbers: [f32; 4]) -> Self::V {
        self.load(&core::array::from_fn(|l| numbers[l / 4]))
    }

    /// Returns `table[index % 16]`; the index is an integer plus [`WHOLE`].
    #[inline(always)]
    fn gather(self, table: &Lanes, index: Self::V) -> Self::V {
        let mut lanes = [0.0; LANES];
        self.store(index, &mut lanes);
        self.load(&lanes.map(|index| table[index.to_bits() as usize % LANES]))
    }

    /// Returns `list[index]` of a list that is not empty. Indices are whole numbers; an index beyond the end reads the
    /// last.
    #[inline(always)]
    fn gather_list(self, list: &[f32], index: Self::V) -> Self::V {
        let mut lanes = [0.0; LANES];
        self.store(index, &mut lanes);
        self.load(&lanes.map(|index| list[(index as usize).min(list.len() - 1)]))
    }

    /// Returns sqrt(a) and 1/sqrt(a) of a >= [`TINY`], each within two roundings. Each is computed from the estimate by
    /// one step of Newton's method.
    #[inline(always)]
    fn sqrt_rsqrt(self, a: Self::V) -> (Self::V, Self::V) {
        let guess = self.rsqrt_estimate(a);
        let root = self.mul(a, guess);
        let half = self.mul(guess, self.splat(0.5));
        let (miss, other) = (self.fnma(root, root, a), self.fnma(root, guess, self.splat(1.0)));
        (self.fma(half, miss, root), self.fma(half, other, guess))
    }

    /// Returns 1/sqrt(a) without sqrt(a).
    #[inline(always)]
    fn rsqrt(self, a: Self::V) -> Self::V {
        let (guess, miss) = self.rsqrt_guess(a);
        self.fma(self.mul(guess, self.splat(0.5)), miss, guess)
    }

    /// Returns g and m with 1/sqrt(a) = g (1 + m/2) within two roundings. A caller can multiply g by a factor while m
    /// is computed.
    #[inline(always)]
    fn rsqrt_guess(self, a: Self::V) -> (Self::V, Self::V) {
        let guess = self.rsqrt_estimate(a);
        (guess, self.fnma(self.mul(a, guess), guess, self.splat(1.0)))
    }
}

/// A kernel in which no lane depends on another: it may run over some of the lanes after the others.
pub(crate) trait Apart {
    fn run<S: Elementwise>(&mut self, s: S);
}

/// Operations on 16 lanes.
pub(crate) trait Simd: Elementwise {
    /// Runs a kernel over all lanes at once, or over the lanes of one register after the other. Only the first `used`
    /// lanes matter; the others may be left out.
    #[inline(always)]
    fn apart(self, used: usize, kernel: &mut impl Apart) {
        let _ = used;
        kernel.run(self);
    }

    /// Runs `f`, as a function that is not inlined where code and stack must be short. `f` must be `#[inline(always)]`.
    #[inline(always)]
    fn aside<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }

    /// Moves lane l xor `DISTANCE` to lane l: 8 swaps the halves, 4 the quarters of each half, 2 pairs and 1
    /// neighbours.
    #[inline(always)]
    fn swap<const DISTANCE: usize>(self, a: Self::V) -> Self::V {
        let mut lanes = [0.0; LANES];
        self.store(a, &mut lanes);
        self.load(&core::array::from_fn(|l| lanes[(l ^ DISTANCE) % LANES]))
    }

    /// Returns lane l of `low` where bit `DISTANCE` of l is 0, else lane l of `high`.
    #[inline(always)]
    fn pick<const DISTANCE: usize>(self, low: Self::V, high: Self::V) -> Self::V {
        let mut lanes = [[0.0; LANES]; 2];
        self.store(low, &mut lanes[0]);
        self.store(high, &mut lanes[1]);
        self.load(&core::array::from_fn(|l| lanes[usize::from(l & DISTANCE > 0)][l]))
    }

    /// Returns the sums of lanes l and l xor `DISTANCE`: of a where bit `DISTANCE` of l is 0, else of b.
    #[inline(always)]
    fn fold<const DISTANCE: usize>(self, a: Self::V, b: Self::V) -> Self::V {
        self.add(self.pick::<DISTANCE>(a, b), self.swap::<DISTANCE>(self.pick::<DISTANCE>(b, a)))
    }

    /// Returns the sum over lanes. It adds the halves, then the halves of the result, and so on.
    #[inline(always)]
    fn reduce_add(self, a: Self::V) -> f32 {
        let mut lanes = [0.0; LANES];
        self.store(a, &mut lanes);
        reduce_add(&lanes)
    }

    /// Returns the largest lane, if none is NaN.
    #[inline(always)]
    fn reduce_max(self, a: Self::V) -> f32 {
        let mut lanes = [0.0; LANES];
        self.store(a, &mut lanes);
        lanes.into_iter().fold(f32::NEG_INFINITY, |a, b| if a > b { a } else { b })
    }

    /// Returns the smallest lane, if none is NaN.
    #[inline(always)]
    fn least(self, a: Self::V) -> f32 {
        -self.reduce_max(self.sub(self.splat(0.0), a))
    }

    /// Returns the smallest lane in all lanes, if none is NaN.
    #[inline(always)]
    fn reduce_min(self, a: Self::V) -> Self::V {
        self.splat(self.least(a))
    }

    /// Returns in lane k the sum over the lanes of vector k, in the same tree as [`Simd::reduce_add`].
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

    /// Returns in lane k the sum of list k, as [`Simd::reduce_add_each`]. After the first `used` lanes all lanes
    /// contain +0.
    #[inline(always)]
    fn sums(self, lists: &[Lanes; LANES], used: usize) -> Self::V {
        let _ = used;
        let mut vectors = [self.splat(0.0); LANES];
        for (vector, list) in vectors.iter_mut().zip(lists) {
            *vector = self.load(list);
        }
        self.reduce_add_each(&vectors)
    }

    /// Moves lane l of vector k to lane k of vector l.
    #[inline(always)]
    fn transpose(self, vectors: [Self::V; LANES]) -> [Self::V; LANES] {
        let mut lists = [[0.0; LANES]; LANES];
        for (list, vector) in lists.iter_mut().zip(vectors) {
            self.store(vector, list);
        }
        core::array::from_fn(|l| self.load(&lists.map(|list| list[l])))
    }

    /// Reads pairs from a list of at least one pair. Lanes 2k and 2k + 1 of the result are pair floor(x) + `zero`, for
    /// the x in lane 2k. Indices outside of the list and NaN read the last pair.
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

/// Returns the sum over lanes in a fixed tree of halves. Callers rely on its rounding.
#[inline(always)]
pub(crate) fn reduce_add(lanes: &Lanes) -> f32 {
    let eight: [f32; 8] = core::array::from_fn(|l| lanes[l] + lanes[l + 8]);
    let four: [f32; 4] = core::array::from_fn(|l| eight[l] + eight[l + 4]);
    (four[0] + four[2]) + (four[1] + four[3])
}
