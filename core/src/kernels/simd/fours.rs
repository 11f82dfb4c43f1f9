//! Fours: 16 lanes as four registers of four numbers, for machines with narrow registers; or one register alone.
//!
//! A kernel in which no lane depends on another runs over the lanes of one register after the other ([`Simd::apart`]).
//! Its values then stay in registers, its code is a quarter as long, and unused lanes take no time.

use crate::kernels::lanes::{LANES, Lanes};
use crate::kernels::simd::{Apart, Elementwise, Simd, reduce_add};

/// Number of lanes of a register.
pub(crate) const FOUR: usize = 4;

/// Operations on four numbers; each has the meaning that it has in [`Elementwise`].
pub(crate) trait Register: Copy {
    /// A register of four f32.
    type V: Copy;

    fn splat(self, x: f32) -> Self::V;
    fn load(self, four: &[f32; FOUR]) -> Self::V;
    fn store(self, v: Self::V, four: &mut [f32; FOUR]);
    fn add(self, a: Self::V, b: Self::V) -> Self::V;
    fn sub(self, a: Self::V, b: Self::V) -> Self::V;
    fn mul(self, a: Self::V, b: Self::V) -> Self::V;
    fn div(self, a: Self::V, b: Self::V) -> Self::V;
    fn sqrt(self, a: Self::V) -> Self::V;
    fn fma(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    fn fnma(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    fn min(self, a: Self::V, b: Self::V) -> Self::V;
    fn max(self, a: Self::V, b: Self::V) -> Self::V;
    fn abs(self, a: Self::V) -> Self::V;
    fn round(self, a: Self::V) -> Self::V;
    fn exp2(self, a: Self::V) -> Self::V;
    fn exponent(self, a: Self::V) -> Self::V;
    fn rsqrt_estimate(self, a: Self::V) -> Self::V;
    fn select_less(self, a: Self::V, b: Self::V, x: Self::V, y: Self::V) -> Self::V;

    #[inline(always)]
    fn gather(self, table: &Lanes, index: Self::V) -> Self::V {
        let mut four = [0.0; FOUR];
        self.store(index, &mut four);
        let look = |index: f32| table[index.to_bits() as usize % LANES];
        self.load(&[look(four[0]), look(four[1]), look(four[2]), look(four[3])])
    }

    #[inline(always)]
    fn gather_list(self, list: &[f32], index: Self::V) -> Self::V {
        let mut four = [0.0; FOUR];
        self.store(index, &mut four);
        let look = |index: f32| list[(index as usize).min(list.len() - 1)];
        self.load(&[look(four[0]), look(four[1]), look(four[2]), look(four[3])])
    }

    /// Returns four bits: bit l is set where a < b.
    fn less(self, a: Self::V, b: Self::V) -> u32;
    /// Moves lane l xor 2 to lane l.
    fn swap_pairs(self, a: Self::V) -> Self::V;
    /// Moves lane l xor 1 to lane l.
    fn swap_neighbours(self, a: Self::V) -> Self::V;
    /// Returns lanes 0 and 1 of `low` and lanes 2 and 3 of `high`.
    fn pick_pairs(self, low: Self::V, high: Self::V) -> Self::V;
    /// Returns lanes 0 and 2 of `low` and lanes 1 and 3 of `high`.
    fn pick_neighbours(self, low: Self::V, high: Self::V) -> Self::V;
}

/// Token of a machine whose registers have four numbers or one: operations on all 16 lanes in four registers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fours<R>(pub(crate) R);

/// Token for operations on lanes 4 k to 4 k + 3 of the 16; the other lanes are neither read nor written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quarter<R> {
    register: R,
    k: usize,
}

/// Defines the operations of [`Elementwise`] that consist of one operation of [`Register`].
macro_rules! operations {
    ($one:ident; $($name:ident($($argument:ident),*);)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: Self::V),*) -> Self::V {
            $one!(self, $name, $($argument),*)
        }
    )*};
    ($one:ident) => {
        operations! { $one;
            add(a, b);
            sub(a, b);
            mul(a, b);
            div(a, b);
            sqrt(a);
            fma(a, b, c);
            fnma(a, b, c);
            min(a, b);
            max(a, b);
            abs(a);
            round(a);
            exp2(a);
            exponent(a);
            rsqrt_estimate(a);
            select_less(a, b, x, y);
        }
    };
}

/// Applies an operation to every register.
macro_rules! each {
    ($s:ident, $name:ident, $($argument:ident),*) => {
        [
            $s.0.$name($($argument[0]),*),
            $s.0.$name($($argument[1]),*),
            $s.0.$name($($argument[2]),*),
            $s.0.$name($($argument[3]),*),
        ]
    };
}
/// Applies an operation to the one register of a [`Quarter`].
macro_rules! quarter {
    ($s:ident, $name:ident, $($argument:ident),*) => {
        $s.register.$name($($argument),*)
    };
}

impl<R: Register> Elementwise for Fours<R> {
    type V = [R::V; FOUR];

    // A vector operation takes four instructions or sixteen, so kernels must be short.
    const SHORT: bool = true;

    #[inline(always)]
    fn vectorize<T>(self, f: impl FnOnce() -> T) -> T {
        f()
    }

    inlined! {
        splat(self, x: f32) -> Self::V = [self.0.splat(x); FOUR];
        quarters(self, numbers: [f32; 4]) -> Self::V = each!(self, splat, numbers);
        gather(self, table: &Lanes, index: Self::V) -> Self::V = index.map(|index| self.0.gather(table, index));
        gather_list(self, list: &[f32], index: Self::V) -> Self::V = index.map(|index| self.0.gather_list(list, index));
    }

    #[inline(always)]
    fn load(self, lanes: &Lanes) -> Self::V {
        let fours = lanes.as_chunks().0;
        [self.0.load(&fours[0]), self.0.load(&fours[1]), self.0.load(&fours[2]), self.0.load(&fours[3])]
    }

    #[inline(always)]
    fn store(self, v: Self::V, lanes: &mut Lanes) {
        let fours = lanes.as_chunks_mut().0;
        self.0.store(v[0], &mut fours[0]);
        self.0.store(v[1], &mut fours[1]);
        self.0.store(v[2], &mut fours[2]);
        self.0.store(v[3], &mut fours[3]);
    }

    #[inline(never)]
    fn less(self, a: Self::V, b: Self::V) -> u32 {
        (0..FOUR).fold(0, |bits, k| bits | self.0.less(a[k], b[k]) << (FOUR * k))
    }

    operations!(each);
}

impl<R: Register> Elementwise for Quarter<R> {
    type V = R::V;

    const SHORT: bool = true;

    #[inline(always)]
    fn vectorize<T>(self, f: impl FnOnce() -> T) -> T {
        f()
    }

    inlined! {
        splat(self, x: f32) -> Self::V = self.register.splat(x);
        load(self, lanes: &Lanes) -> Self::V = self.register.load(&lanes.as_chunks().0[self.k % FOUR]);
        store(self, v: Self::V, lanes: &mut Lanes) -> () =
            self.register.store(v, &mut lanes.as_chunks_mut().0[self.k % FOUR]);
        less(self, a: Self::V, b: Self::V) -> u32 = self.register.less(a, b) << (FOUR * self.k);
        every(self) -> u32 = ((1 << FOUR) - 1) << (FOUR * self.k);
        quarters(self, numbers: [f32; 4]) -> Self::V = self.register.splat(numbers[self.k % FOUR]);
        gather(self, table: &Lanes, index: Self::V) -> Self::V = self.register.gather(table, index);
        gather_list(self, list: &[f32], index: Self::V) -> Self::V = self.register.gather_list(list, index);
    }

    operations!(quarter);
}

impl<R: Register> Simd for Fours<R> {
    // Not inlined: each kernel is compiled once, for all callers.
    #[inline(never)]
    fn apart(self, used: usize, kernel: &mut impl Apart) {
        for k in 0..used.min(LANES).div_ceil(FOUR) {
            kernel.run(Quarter { register: self.0, k });
        }
    }

    #[inline(never)]
    fn aside<T>(self, f: impl FnOnce() -> T) -> T {
        f()
    }

    #[inline(always)]
    fn swap<const DISTANCE: usize>(self, v: Self::V) -> Self::V {
        match DISTANCE {
            8 => [v[2], v[3], v[0], v[1]],
            4 => [v[1], v[0], v[3], v[2]],
            2 => each!(self, swap_pairs, v),
            _ => each!(self, swap_neighbours, v),
        }
    }

    #[inline(always)]
    fn pick<const DISTANCE: usize>(self, low: Self::V, high: Self::V) -> Self::V {
        match DISTANCE {
            8 => [low[0], low[1], high[2], high[3]],
            4 => [low[0], high[1], low[2], high[3]],
            2 => each!(self, pick_pairs, low, high),
            _ => each!(self, pick_neighbours, low, high),
        }
    }

    #[inline(always)]
    fn reduce_add(self, [a, b, c, d]: Self::V) -> f32 {
        let mut four = [0.0; FOUR];
        self.0.store(self.0.add(self.0.add(a, c), self.0.add(b, d)), &mut four);
        (four[0] + four[2]) + (four[1] + four[3])
    }

    // A loop, because folds of whole vectors would take thousands of instructions.
    #[inline(never)]
    fn sums(self, lists: &[Lanes; LANES], used: usize) -> Self::V {
        let few = used <= FOUR;
        // With +0 among the terms, the sum is never -0.
        let first = |list: &Lanes| (list[0] + list[2]) + (list[1] + list[3]) + 0.0;
        let mut sums = [0.0; LANES];
        for (sum, list) in sums.iter_mut().zip(lists) {
            *sum = if few { first(list) } else { reduce_add(list) };
        }
        self.load(&sums)
    }

    #[inline(never)]
    fn reduce_max(self, v: Self::V) -> f32 {
        let mut lanes = [0.0; LANES];
        self.store(v, &mut lanes);
        greatest(lanes.into_iter())
    }

    #[inline(never)]
    fn least(self, v: Self::V) -> f32 {
        let mut lanes = [0.0; LANES];
        self.store(v, &mut lanes);
        -greatest(lanes.into_iter().map(|lane| 0.0 - lane))
    }
}

/// Returns the greatest of some numbers.
#[inline(always)]
fn greatest(numbers: impl Iterator<Item = f32>) -> f32 {
    numbers.fold(f32::NEG_INFINITY, |a, b| if a > b { a } else { b })
}
