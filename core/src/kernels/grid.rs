//! A board's grid: 16 drives at a time rounded to the nearest of its phases and amplitudes.
//!
//! ```text
//! ratio = small/large of |re|, |im|;   |q| = large sqrt(1 + ratio^2)
//! turns = ratio poly(ratio^2), brought to its octant                  within 3e-8 turns
//! phase code = floor(L turns + 1/2);   direction = table of phasors for the codes -L to L
//! amplitude: 256 buckets tell where in the table to begin, comparisons with the values' middles go on from there
//! ```
//!
//! Quotients, roots, products and sums only, each rounded once and none fused: a drive has the same code by every
//! instruction set. Of two as near, the later phase and the larger amplitude win.

use alloc::vec;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::kernels::lanes::{LANES, Lanes};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::simd::{Apart, Elementwise, Simd, WHOLE};
use crate::math;

/// Above this modulus a drive is at full power but for its rounding.
const FULL: f32 = 1.0 - 1e-6;

/// Parts of 0 to 1 that know where in a table their amplitudes begin.
const BUCKETS: usize = 256;

/// Where phase or amplitude can be anything, a drive that rounding moves by less than this part of it stays as it is.
const SAME: f32 = 4e-7;

/// The phases and amplitudes of a board, each of which may be left out if it is continuous.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    pub(crate) phases: Option<Phases>,
    pub(crate) amplitudes: Option<Amplitudes>,
}

/// The phases 2 pi l/L.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Phases {
    /// cos and sin of each code l = -L to L: no code that rounding finds has to be brought into 0 to L - 1. Then 0, for what has
    /// no phase.
    phasors: Vec<f32>,
    count: f32,
    /// cos - 1 and sin of the first.
    step: [f32; 2],
}

/// Amplitudes in ascending order, the last 1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Amplitudes {
    values: Vec<f32>,
    /// The middle between each and the next; infinite after the last.
    middles: Vec<f32>,
    /// The least code that any amplitude of a bucket may have.
    first: Vec<f32>,
}

/// The phasors of codes so few, up and down, that they are looked up without leaving the lanes.
#[derive(Clone, Copy)]
pub(crate) struct Few {
    up: [Lanes; 2],
    down: [Lanes; 2],
}

impl Few {
    /// Like [`Phases::phasors`].
    #[inline(always)]
    pub(crate) fn phasors<S: Elementwise>(&self, s: S, codes: S::V, q: [S::V; 2]) -> [S::V; 2] {
        let (large, zero, place) = (sides(s, q)[0], s.splat(0.0), s.add(s.abs(codes), s.splat(WHOLE)));
        let re = s.select_less(codes, zero, s.gather(&self.down[0], place), s.gather(&self.up[0], place));
        let im = s.select_less(codes, zero, s.gather(&self.down[1], place), s.gather(&self.up[1], place));
        [s.select_less(zero, large, re, zero), s.select_less(zero, large, im, zero)]
    }
}

impl Phases {
    /// L = `count` phases.
    pub(crate) fn new(count: u32) -> Self {
        let angle = |l: u32| core::f64::consts::TAU * (f64::from(l) / f64::from(count));
        let once: Vec<f32> = (0..count).flat_map(|l| [math::cos, math::sin].map(|of| of(angle(l)) as f32)).collect();
        let half = math::sin(0.5 * angle(1));
        let step = [-2.0 * half * half, math::sin(angle(1))].map(|x| x as f32);
        Self { phasors: [&once[..], &once, &once[..2], &[0.0; 2]].concat(), count: count as f32, step }
    }

    /// L.
    pub(crate) fn count(&self) -> f32 {
        self.count
    }

    /// Half a code later than the phases of q lie among the codes, -L/2 to L/2: its floor is the nearest code, of two as near
    /// the later one. Anything where q is 0.
    #[inline(always)]
    pub(crate) fn later<S: Elementwise>(&self, s: S, q: [S::V; 2]) -> S::V {
        let [quarters, ratio, factor] = turns(s, q);
        // Only the factor was missing.
        let count = s.splat(self.count);
        joined(s, [joined(s, [s.splat(0.5), count], quarters), s.mul(count, ratio)], factor)
    }

    /// The phasors of some codes, 0 where q is 0.
    #[inline(always)]
    pub(crate) fn phasors<S: Elementwise>(&self, s: S, codes: S::V, q: [S::V; 2]) -> [S::V; 2] {
        let (large, zero) = (sides(s, q)[0], s.splat(0.0));
        let at = self.at(s, codes);
        let [re, im] = [s.gather_list(&self.phasors, at), s.gather_list(&self.phasors[1..], at)];
        [s.select_less(zero, large, re, zero), s.select_less(zero, large, im, zero)]
    }

    /// Where in the table the phasors of some codes begin.
    #[inline(always)]
    fn at<S: Elementwise>(&self, s: S, codes: S::V) -> S::V {
        let index = s.add(codes, s.splat(self.count));
        s.add(index, index)
    }

    /// Like [`Phases::nearest`] for eight q, re and im side by side.
    #[inline(always)]
    pub(crate) fn nearest_pairs<S: Simd>(&self, s: S, pairs: S::V) -> S::V {
        s.gather_pairs(&self.phasors, self.count as i32, self.later(s, [pairs, s.swap::<1>(pairs)]))
    }

    /// The phasors of the phases nearest to those of q, 0 where q is 0.
    #[inline(always)]
    pub(crate) fn nearest<S: Elementwise>(&self, s: S, q: [S::V; 2]) -> [S::V; 2] {
        self.phasors(s, s.floor(self.later(s, q)), q)
    }

    /// The phasors of codes up to `most` if that is below 16, up or down.
    pub(crate) fn few(&self, most: f32) -> Option<Few> {
        let none = self.count as usize;
        let phasor = |code: usize, part: usize| self.phasors[2 * code + part];
        let up = |part: usize| core::array::from_fn(|l| phasor(none + l.min(none), part));
        let down = |part: usize| core::array::from_fn(|l| phasor(none - l.min(none), part));
        (most < LANES as f32).then(|| Few { up: [up(0), up(1)], down: [down(0), down(1)] })
    }

    /// cos - 1 and sin of 2 pi/L.
    pub(crate) fn step(&self) -> [f32; 2] {
        self.step
    }

    /// Moves a code to the next one or to the one before, and returns its phasor.
    pub(crate) fn stepped(&self, code: &mut f32, up: bool) -> [f32; 2] {
        *code += if up { 1.0 } else { -1.0 };
        *code -= if code.abs() < self.count { 0.0 } else { *code };
        let index = 2 * (*code + self.count) as usize;
        [self.phasors[index], self.phasors[index + 1]]
    }
}

impl Amplitudes {
    /// The amplitudes of an ascending table that ends in 1.
    pub(crate) fn new(table: &[f64]) -> Self {
        let values: Vec<f32> = table.iter().map(|&amplitude| amplitude as f32).collect();
        let between = table.windows(2).map(|pair| (0.5 * (pair[0] + pair[1])) as f32);
        let middles: Vec<f32> = between.chain([f32::INFINITY]).collect();
        let mut first = vec![0.0; BUCKETS];
        for (k, first) in first.iter_mut().enumerate() {
            *first = middles.partition_point(|&middle| middle <= k as f32 / BUCKETS as f32) as f32;
        }
        Self { values, middles, first }
    }

    /// The amplitudes nearest to some moduli.
    #[inline(always)]
    fn nearest<S: Elementwise>(&self, s: S, moduli: S::V) -> S::V {
        let moduli = s.min(moduli, s.splat(1.0));
        let bucket = s.sub(s.mul(moduli, s.splat(BUCKETS as f32)), s.splat(0.5));
        let mut code = s.gather_list(&self.first, s.max(s.round(bucket), s.splat(0.0)));
        loop {
            let middle = s.gather_list(&self.middles, code);
            if s.less(moduli, middle) == s.every() {
                return s.gather_list(&self.values, code);
            }
            code = s.select_less(moduli, middle, code, s.add(code, s.splat(1.0)));
        }
    }
}

/// |re| and |im|, the larger first.
#[inline(always)]
fn sides<S: Elementwise>(s: S, [re, im]: [S::V; 2]) -> [S::V; 2] {
    let (along, across) = (s.abs(re), s.abs(im));
    [s.max(along, across), s.min(along, across)]
}

/// |q|, whose square may underflow.
#[inline(always)]
fn modulus<S: Elementwise>(s: S, q: [S::V; 2]) -> S::V {
    let [large, small] = sides(s, q);
    let ratio = s.div(small, s.max(large, s.splat(f32::MIN_POSITIVE)));
    s.mul(large, s.sqrt(s.add(s.splat(1.0), s.mul(ratio, ratio))))
}

/// a + b x, each rounded.
#[inline(always)]
fn joined<S: Elementwise>(s: S, [a, b]: [S::V; 2], x: S::V) -> S::V {
    s.add(a, s.mul(b, x))
}

/// The phase of q in turns, from -1/2 to 1/2: a whole number of quarters; and the ratio, no number where q is 0, with its sign
/// and the factor that makes it up to an eighth. They are an odd minimax polynomial for the arc tangent, made to end in 1/8 at 1.
#[inline(always)]
fn turns<S: Elementwise>(s: S, [re, im]: [S::V; 2]) -> [S::V; 3] {
    const C: [f32; 8] = [
        0.159_154_83,
        -0.053_045_884,
        0.031_743_012,
        -0.022_120_625,
        0.015_303_729,
        -0.008_838_079,
        0.003_435_692,
        -0.000_632_677_87,
    ];
    let [large, small] = sides(s, [re, im]);
    let ratio = s.div(small, large);
    let square = s.mul(ratio, ratio);
    let fourth = s.mul(square, square);
    // Pairs of independent sums, which the processor adds at once.
    let mut pairs = [s.splat(0.0); 4];
    for (pair, [low, high]) in pairs.iter_mut().zip(C.as_chunks().0) {
        *pair = joined(s, [s.splat(*low), s.splat(*high)], square);
    }
    let [a, b, c, d] = pairs;
    let factor = joined(s, [joined(s, [a, b], fourth), joined(s, [c, d], fourth)], s.mul(fourth, fourth));
    let (zero, one, minus) = (s.splat(0.0), s.splat(1.0), s.splat(-1.0));
    let (along, across) = (s.abs(re), s.abs(im));
    let quarter = s.select_less(along, across, s.splat(0.25), zero);
    let steep = s.select_less(along, across, minus, one);
    let half = s.select_less(re, zero, s.sub(s.splat(0.5), quarter), quarter);
    let left = s.select_less(re, zero, minus, one);
    let below = s.select_less(im, zero, minus, one);
    [s.mul(below, half), s.mul(s.mul(steep, left), s.mul(below, ratio)), factor]
}

impl Grid {
    /// The amplitudes nearest to those of q.
    #[inline(always)]
    fn amplitude<S: Elementwise>(&self, s: S, q: [S::V; 2]) -> S::V {
        let (one, full, modulus) = (s.splat(1.0), s.splat(FULL), modulus(s, q));
        let amplitude = self.amplitudes.as_ref().map_or(modulus, |table| table.nearest(s, modulus));
        s.select_less(full, modulus, one, amplitude)
    }

    /// The directions of the phases nearest to those of q.
    #[inline(always)]
    fn direction<S: Elementwise>(&self, s: S, q: [S::V; 2]) -> [S::V; 2] {
        if let Some(phases) = &self.phases {
            return phases.nearest(s, q);
        }
        let clamped = s.max(modulus(s, q), s.splat(f32::MIN_POSITIVE));
        [s.div(q[0], clamped), s.div(q[1], clamped)]
    }

    /// The nearest drives of the grid, of the amplitude `known` if it is; 0 stays 0.
    #[inline(always)]
    fn nearest<S: Elementwise>(&self, s: S, q: [S::V; 2], known: Option<f32>) -> [S::V; 2] {
        let (zero, large) = (s.splat(0.0), sides(s, q)[0]);
        let amplitude = known.map_or_else(
            #[inline(always)]
            || self.amplitude(s, q),
            #[inline(always)]
            |known| s.splat(known),
        );
        let mut new = self.direction(s, q);
        for (new, old) in new.iter_mut().zip(q) {
            *new = s.mul(amplitude, *new);
            if self.phases.is_none() || self.amplitudes.is_none() {
                // A value that has been rounded before keeps its bits.
                *new = s.select_less(s.abs(s.sub(*new, old)), s.mul(large, s.splat(SAME)), old, *new);
            }
            *new = s.select_less(zero, large, *new, zero);
        }
        new
    }

    /// Divides every drive by `factor` and rounds it, moduli that are then `most` to the amplitude `common`; whether each is
    /// what it was times `common`, to the bit.
    pub(crate) fn round(
        &self,
        set: InstructionSet,
        factor: f32,
        [most, common]: [f32; 2],
        drive: &mut [Complex32],
    ) -> bool {
        dispatch!(set, s => {
            let mut differ = 0;
            for own in drive.chunks_mut(LANES) {
                let mut some = Rounding { grid: self, part: 1.0 / factor, common, known: None, q: planar(own), differ };
                let [re, im] = [s.load(&some.q[0]), s.load(&some.q[1])];
                let part = s.splat(some.part);
                let (re, im) = (s.mul(re, part), s.mul(im, part));
                let square = s.add(s.mul(re, re), s.mul(im, im));
                // Most answers have one modulus.
                let least = FULL * most;
                let least = least * least;
                some.known = (least > f32::MIN_POSITIVE && s.less(square, s.splat(least)) == 0).then_some(common);
                if let (Some(phases), Some(_), Some(_)) = (&self.phases, &self.amplitudes, some.known)
                    && own.len() == LANES
                    && !s.is_short()
                {
                    for eight in own.chunks_exact_mut(LANES / 2) {
                        differ |= round_pairs(s, phases, (some.part, common), eight);
                    }
                    continue;
                }
                s.apart(own.len(), &mut some);
                differ |= some.differ & (u32::MAX >> (32 - own.len()));
                for (own, (re, im)) in own.iter_mut().zip(some.q[0].into_iter().zip(some.q[1])) {
                    *own = Complex32::new(re, im);
                }
            }
            differ == 0
        })
    }
}

/// Rounds eight drives to the nearest phases at a known amplitude; the bits of what then differs, as [`Grid::round`] tells.
#[inline(always)]
fn round_pairs<S: Simd>(s: S, phases: &Phases, (part, common): (f32, f32), eight: &mut [Complex32]) -> u32 {
    let mut pairs: Lanes = [0.0; LANES];
    for (pair, q) in pairs.as_chunks_mut::<2>().0.iter_mut().zip(&*eight) {
        *pair = [q.re, q.im];
    }
    let (q, common) = (s.load(&pairs), s.splat(common));
    let new = s.mul(common, phases.nearest_pairs(s, s.mul(q, s.splat(part))));
    s.store(new, &mut pairs);
    for (q, pair) in eight.iter_mut().zip(pairs.as_chunks::<2>().0) {
        *q = Complex32::new(pair[0], pair[1]);
    }
    s.less(s.splat(0.0), s.abs(s.sub(new, s.mul(q, common))))
}

/// Drives being rounded.
struct Rounding<'a> {
    grid: &'a Grid,
    /// The factor that was applied before, and the expected factor in total.
    part: f32,
    common: f32,
    /// The amplitude of all, where it is known.
    known: Option<f32>,
    q: [Lanes; 2],
    /// Bits of those that are not.
    differ: u32,
}

impl Apart for Rounding<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let (part, common) = (s.splat(self.part), s.splat(self.common));
        let q = [s.load(&self.q[0]), s.load(&self.q[1])];
        let [re, im] = self.grid.nearest(s, [s.mul(q[0], part), s.mul(q[1], part)], self.known);
        let (miss_re, miss_im) = (s.abs(s.sub(re, s.mul(q[0], common))), s.abs(s.sub(im, s.mul(q[1], common))));
        self.differ |= s.less(s.splat(0.0), s.max(miss_re, miss_im));
        s.store(re, &mut self.q[0]);
        s.store(im, &mut self.q[1]);
    }
}

/// The least |q| above 0 and the largest; 1 and 0 of silence.
pub(crate) fn range(set: InstructionSet, drive: &[Complex32]) -> [f32; 2] {
    // The squares of q up to 1 neither overflow nor, down to 1e-37, underflow.
    const UP: f32 = (1_u64 << 60) as f32;
    let squares = dispatch!(set, s => {
        let (up, zero, full) = (s.splat(UP), s.splat(0.0), s.splat(UP * UP));
        let (mut least, mut most) = (full, zero);
        for own in drive.chunks(LANES) {
            let q = planar(own);
            let (re, im) = (s.mul(s.load(&q[0]), up), s.mul(s.load(&q[1]), up));
            let square = s.add(s.mul(re, re), s.mul(im, im));
            most = s.max(square, most);
            least = s.min(s.select_less(zero, square, square, full), least);
        }
        [s.reduce_max(s.reduce_min(least)), s.reduce_max(most)]
    });
    squares.map(|square| math::sqrtf(square) / UP)
}

/// Real and imaginary parts of sixteen drives or fewer.
#[inline(always)]
fn planar(drives: &[Complex32]) -> [Lanes; 2] {
    if let Some(sixteen) = drives.first_chunk::<LANES>() {
        return [sixteen.map(|q| q.re), sixteen.map(|q| q.im)];
    }
    let (mut re, mut im) = ([0.0; LANES], [0.0; LANES]);
    for (q, (re, im)) in drives.iter().zip(re.iter_mut().zip(&mut im)) {
        (*re, *im) = (q.re, q.im);
    }
    [re, im]
}
