//! A board's grid: rounds drives, 16 at a time, to the nearest of its phases and amplitudes.
//!
//! ```text
//! ratio = small/large of |re|, |im|;   |q| = large sqrt(1 + ratio^2)
//! turns = ratio poly(ratio^2), moved to its octant                    within 3e-8 turns
//! phase code = floor(L turns + 1/2);   direction = table of phasors for the codes -L to L
//! amplitude: one of 256 buckets gives the first index of the table; the middles between values give the final one
//! ```
//!
//! All quotients, roots, products and sums are rounded once and none is fused: every instruction set gives a drive the
//! same code. If two are equally near, the later phase and the larger amplitude are chosen.

use crate::kernels::prelude::*;
use crate::kernels::simd::WHOLE;

/// A drive above this modulus is at full power; the difference is rounding.
const FULL: f32 = 1.0 - 1e-6;

/// Number of equal parts of the range 0 to 1. For each part the index of its first amplitude is stored.
const BUCKETS: usize = 256;

/// If the phase or the amplitude is continuous, a drive that rounding changes by less than this part of it keeps its
/// value.
const SAME: f32 = 4e-7;

/// The phases and amplitudes of a board; each is `None` if it is continuous.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    pub(crate) phases: Option<Phases>,
    pub(crate) amplitudes: Option<Amplitudes>,
}

/// The phases 2 pi l/L.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Phases {
    /// cos and sin of each code l = -L to L, so that no code from rounding has to be moved into 0 to L - 1. They are
    /// followed by 0, for a drive without a phase.
    phasors: Vec<f32>,
    count: f32,
    /// cos(2 pi/L) - 1 and sin(2 pi/L).
    step: [f32; 2],
}

/// A board's amplitudes in ascending order; the last is 1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Amplitudes {
    values: Vec<f32>,
    /// The middle between each amplitude and the next; infinite after the last.
    middles: Vec<f32>,
    /// For each bucket, the smallest code of the amplitudes in it.
    first: Vec<f32>,
}

/// Phasors of the codes below 16 in both directions, so few that they are looked up in registers.
#[derive(Clone, Copy)]
pub(crate) struct Few {
    up: [Lanes; 2],
    down: [Lanes; 2],
}

impl Few {
    /// Returns the result of [`Phases::phasors`] for these codes.
    #[inline(always)]
    pub(crate) fn phasors<S: Elementwise>(&self, s: S, codes: S::V, q: [S::V; 2]) -> [S::V; 2] {
        let (large, zero, place) = (sides(s, q)[0], s.splat(0.0), s.add(s.abs(codes), s.splat(WHOLE)));
        let re = s.select_less(codes, zero, s.gather(&self.down[0], place), s.gather(&self.up[0], place));
        let im = s.select_less(codes, zero, s.gather(&self.down[1], place), s.gather(&self.up[1], place));
        [s.select_less(zero, large, re, zero), s.select_less(zero, large, im, zero)]
    }
}

impl Phases {
    /// Creates L = `count` phases.
    pub(crate) fn new(count: u32) -> Self {
        let angle = |l: u32| TAU * (f64::from(l) / f64::from(count));
        let once: Vec<f32> = (0..count).flat_map(|l| [math::cos, math::sin].map(|of| of(angle(l)) as f32)).collect();
        let half = math::sin(0.5 * angle(1));
        let step = [-2.0 * half * half, math::sin(angle(1))].map(|x| x as f32);
        Self { phasors: [&once[..], &once, &once[..2], &[0.0; 2]].concat(), count: count as f32, step }
    }

    /// Returns the number L of phases.
    pub(crate) fn count(&self) -> f32 {
        self.count
    }

    /// Returns the phase of q in codes, -L/2 to L/2, plus half a code. Its floor is the nearest code; if two codes are
    /// equally near, it is the later one. The result has no meaning where q is 0.
    #[inline(always)]
    pub(crate) fn later<S: Elementwise>(&self, s: S, q: [S::V; 2]) -> S::V {
        let [quarters, ratio, factor] = turns(s, q);
        // The ratio is not yet multiplied by the arc tangent's factor; this is done here.
        let count = s.splat(self.count);
        joined(s, [joined(s, [s.splat(0.5), count], quarters), s.mul(count, ratio)], factor)
    }

    /// Returns the phasors of codes; 0 where q is 0.
    #[inline(always)]
    pub(crate) fn phasors<S: Elementwise>(&self, s: S, codes: S::V, q: [S::V; 2]) -> [S::V; 2] {
        let (large, zero) = (sides(s, q)[0], s.splat(0.0));
        let at = self.at(s, codes);
        let [re, im] = [s.gather_list(&self.phasors, at), s.gather_list(&self.phasors[1..], at)];
        [s.select_less(zero, large, re, zero), s.select_less(zero, large, im, zero)]
    }

    /// Returns the index in the table where the phasor of a code begins.
    #[inline(always)]
    fn at<S: Elementwise>(&self, s: S, codes: S::V) -> S::V {
        let index = s.add(codes, s.splat(self.count));
        s.add(index, index)
    }

    /// Returns the result of [`Phases::nearest`] for eight q, whose real and imaginary parts are side by side.
    #[inline(always)]
    pub(crate) fn nearest_pairs<S: Simd>(&self, s: S, pairs: S::V) -> S::V {
        s.gather_pairs(&self.phasors, self.count as i32, self.later(s, [pairs, s.swap::<1>(pairs)]))
    }

    /// Returns the phasors of the phases that are nearest to the phases of q; 0 where q is 0.
    #[inline(always)]
    pub(crate) fn nearest<S: Elementwise>(&self, s: S, q: [S::V; 2]) -> [S::V; 2] {
        self.phasors(s, s.floor(self.later(s, q)), q)
    }

    /// Returns the phasors of codes up to `most` in both directions, if `most` is below 16.
    pub(crate) fn few(&self, most: f32) -> Option<Few> {
        let none = self.count as usize;
        let phasor = |code: usize, part: usize| self.phasors[2 * code + part];
        let up = |part: usize| core::array::from_fn(|l| phasor(none + l.min(none), part));
        let down = |part: usize| core::array::from_fn(|l| phasor(none - l.min(none), part));
        (most < LANES as f32).then(|| Few { up: [up(0), up(1)], down: [down(0), down(1)] })
    }

    /// Returns cos - 1 and sin of 2 pi/L.
    pub(crate) fn step(&self) -> [f32; 2] {
        self.step
    }

    /// Changes a code to the next one (`up`) or to the one before it, and returns its phasor.
    pub(crate) fn stepped(&self, code: &mut f32, up: bool) -> [f32; 2] {
        *code += if up { 1.0 } else { -1.0 };
        *code -= if code.abs() < self.count { 0.0 } else { *code };
        let index = 2 * (*code + self.count) as usize;
        [self.phasors[index], self.phasors[index + 1]]
    }
}

impl Amplitudes {
    /// Creates the amplitudes from an ascending table that ends in 1.
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

    /// Returns the amplitude nearest to each modulus.
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

/// Returns |re| and |im|, the larger first.
#[inline(always)]
fn sides<S: Elementwise>(s: S, [re, im]: [S::V; 2]) -> [S::V; 2] {
    let (along, across) = (s.abs(re), s.abs(im));
    [s.max(along, across), s.min(along, across)]
}

/// Returns |q|, also where its square would underflow.
#[inline(always)]
fn modulus<S: Elementwise>(s: S, q: [S::V; 2]) -> S::V {
    let [large, small] = sides(s, q);
    let ratio = s.div(small, s.max(large, s.splat(f32::MIN_POSITIVE)));
    s.mul(large, s.sqrt(s.add(s.splat(1.0), s.mul(ratio, ratio))))
}

/// Returns a + b x; product and sum are rounded separately.
#[inline(always)]
fn joined<S: Elementwise>(s: S, [a, b]: [S::V; 2], x: S::V) -> S::V {
    s.add(a, s.mul(b, x))
}

/// Returns the phase of q in turns, -1/2 to 1/2, as three numbers: quarters of a turn, a signed ratio and its factor;
/// the phase is quarters + ratio times factor. The ratio is NaN where q is 0. The factor is an odd minimax polynomial
/// for the arc tangent, with 1/8 at ratio 1.
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
    // These sums are independent, so the processor adds them at once.
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
    /// Returns the amplitudes that are nearest to the moduli of q.
    #[inline(always)]
    fn amplitude<S: Elementwise>(&self, s: S, q: [S::V; 2]) -> S::V {
        let (one, full, modulus) = (s.splat(1.0), s.splat(FULL), modulus(s, q));
        let amplitude = self.amplitudes.as_ref().map_or(modulus, |table| table.nearest(s, modulus));
        s.select_less(full, modulus, one, amplitude)
    }

    /// Returns the phasors of the phases that are nearest to the phases of q.
    #[inline(always)]
    fn direction<S: Elementwise>(&self, s: S, q: [S::V; 2]) -> [S::V; 2] {
        if let Some(phases) = &self.phases {
            return phases.nearest(s, q);
        }
        let clamped = s.max(modulus(s, q), s.splat(f32::MIN_POSITIVE));
        [s.div(q[0], clamped), s.div(q[1], clamped)]
    }

    /// Returns the nearest drives of the grid, with the amplitude `known` if it is given; 0 stays 0.
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
                // A value that is on the grid already keeps its bits.
                *new = s.select_less(s.abs(s.sub(*new, old)), s.mul(large, s.splat(SAME)), old, *new);
            }
            *new = s.select_less(zero, large, *new, zero);
        }
        new
    }

    /// Divides every drive by `factor` and rounds it to the grid. The largest modulus after the division is `most`; it
    /// is rounded to the amplitude `common`. Returns whether every result equals its drive times `common`, bit for bit.
    pub(crate) fn round(
        &self,
        set: InstructionSet,
        factor: f32,
        [most, common]: [f32; 2],
        drive: &mut [Complex32],
    ) -> bool {
        dispatch!(set, s => {
            let mut differ = 0;
            for chunk in drive.chunks_mut(LANES) {
                let mut some = Rounding { grid: self, part: 1.0 / factor, common, known: None, q: planar(chunk), differ };
                let [re, im] = [s.load(&some.q[0]), s.load(&some.q[1])];
                let part = s.splat(some.part);
                let (re, im) = (s.mul(re, part), s.mul(im, part));
                let square = s.add(s.mul(re, re), s.mul(im, im));
                // If all moduli are `most`, as in most solutions, the amplitude is known.
                let least = FULL * most;
                let least = least * least;
                some.known = (least > f32::MIN_POSITIVE && s.less(square, s.splat(least)) == 0).then_some(common);
                if let (Some(phases), Some(_), Some(_)) = (&self.phases, &self.amplitudes, some.known)
                    && chunk.len() == LANES
                    && !s.is_short()
                {
                    for eight in chunk.chunks_exact_mut(LANES / 2) {
                        differ |= round_pairs(s, phases, (some.part, common), eight);
                    }
                    continue;
                }
                s.apart(chunk.len(), &mut some);
                differ |= some.differ & (u32::MAX >> (32 - chunk.len()));
                for (q, (re, im)) in chunk.iter_mut().zip(some.q[0].into_iter().zip(some.q[1])) {
                    *q = Complex32::new(re, im);
                }
            }
            differ == 0
        })
    }
}

/// Rounds eight drives to the nearest phases at a known amplitude; returns the bits of the numbers that differ from the
/// drive times `common`.
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

/// Kernel that rounds 16 drives `q` to the grid.
struct Rounding<'a> {
    grid: &'a Grid,
    /// The factor by which drives are multiplied before they are rounded; and the expected ratio of rounded and old
    /// drives.
    part: f32,
    common: f32,
    /// The amplitude of all drives; `None` if they differ.
    known: Option<f32>,
    q: [Lanes; 2],
    /// Bits of the drives that differ from the old ones times `common`.
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

/// Returns the least |q| above 0 and the largest |q|; 1 and 0 if all drives are 0.
pub(crate) fn range(set: InstructionSet, drive: &[Complex32]) -> [f32; 2] {
    // With this factor the squares of q from 1e-37 to 1 neither underflow nor overflow.
    const UP: f32 = (1_u64 << 60) as f32;
    let squares = dispatch!(set, s => {
        let (up, zero, full) = (s.splat(UP), s.splat(0.0), s.splat(UP * UP));
        let (mut least, mut most) = (full, zero);
        for chunk in drive.chunks(LANES) {
            let q = planar(chunk);
            let (re, im) = (s.mul(s.load(&q[0]), up), s.mul(s.load(&q[1]), up));
            let square = s.add(s.mul(re, re), s.mul(im, im));
            most = s.max(square, most);
            least = s.min(s.select_less(zero, square, square, full), least);
        }
        [s.reduce_max(s.reduce_min(least)), s.reduce_max(most)]
    });
    squares.map(|square| math::sqrtf(square) / UP)
}

/// Returns the real and imaginary parts of at most sixteen drives.
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
