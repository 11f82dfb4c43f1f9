//! Search of a large grid, of 64 or more phases and any number of amplitudes: bounds exclude most candidates.
//!
//! ```text
//! f(z) = change of the energy under z, third order; fourth order where z is listed
//! evaluate f at 32 phases of full amplitude, the ends of 32 arcs
//! evaluate the 4 arcs around the phase where the first moment is least (else around the best of the 32)
//! if the bounds of f on all other arcs and lower amplitudes are above the least value found + slack:
//!     list = the candidates of these arcs
//! else:
//!     list = the candidates of all arcs and amplitudes that the bounds do not exclude
//! drop from the list what is above the best by more than the remainder of their difference
//! best = the only one left, or the first of them by eq. (7)
//! ```
//!
//! The bounds hold for f_a(phi), the change under a e^{j phi}, where the amplitudes a rise to 1:
//!
//! - The second derivative over the phase is at most c. Let v <= v' be the values at the ends of an arc of length h. On
//!   the arc f is at least v - c h^2/8 (1 - x)^2 with x = 2 (v' - v)/(c h^2), or at least v where x > 1.
//! - A lower amplitude is bounded by the value at full amplitude and the same phase. The polynomial a g1 + a^2 g2 + a^3
//!   g3 is a f_1 - a (1 - a) (g2 + (1 + a) g3). At a point that the moments leave out, |P + a G z| <= (1 - a) |P| + a
//!   |P + G z| gives the same with w |G|^2 in place of the last bracket. So f_a >= a f_1 - a (1 - a) Q, see
//!   [`Energies::bow`].
//!
//! Time of a pass that each idea saves (K = 16 amplitudes, L = 256 phases, M from 1 to 256 points):
//!
//! 1. Evaluate the arcs around one phase first, and others only where the bounds do not exclude them: 32 % up to M =
//!    16, 2 to 8 % at M = 256.
//! 2. Compute that phase from the first moment, before the 32 changes are known: 10 % up to M = 16. Comparisons with
//!    the tangents of [`direction`] give it 5 % earlier than the least lane of the first order.
//! 3. Compute the least of all amplitudes at one phase before all arcs are evaluated: 16 % at N = 400 transducers, M =
//!    256.
//! 4. List the candidates of the window by vectors rather than one by one: 5 % up to M = 64.
//! 5. Compare candidates by the remainder of their difference, which is smaller the closer they are, and ignore
//!    differences that do not matter: eq. (7) decides 2 of 996 updates at M = 64.

use crate::kernels::greedy::candidates::{Candidates, Sixteen};
use crate::kernels::greedy::energies::Energies;
use crate::kernels::greedy::shortlist;
use crate::kernels::greedy::shortlist::List;
use crate::kernels::prelude::*;

/// Number of phases that are evaluated first, and of arcs between them.
const ARCS: usize = 2 * LANES;

/// Number of arcs on each side of the chosen phase of which every candidate is evaluated.
const REACH: usize = 2;

/// Smallest number of phases of a grid that this module searches.
pub(crate) const LARGE: usize = 64;

/// Returns whether this module searches a grid.
#[inline(always)]
pub(crate) fn large(candidates: &Candidates) -> bool {
    candidates.phases >= LARGE
}

/// Returns the largest number of phases in the arcs that are evaluated first.
const fn window(phases: usize) -> usize {
    (2 * REACH * phases.div_ceil(ARCS)).next_multiple_of(LANES)
}

/// Returns the length of a list for a grid of `phases`.
pub(crate) fn list(phases: usize) -> usize {
    shortlist::MOST.max(window(phases))
}

/// Returns the length of the working memory: the values of a list, and the changes of the window.
pub(crate) fn floats(phases: usize) -> usize {
    list(phases) + window(phases)
}

/// Returns the index of the best candidate; differences of the energy below `matters` are ignored. Returns `None` if
/// the transducer has no effect.
#[inline(always)]
pub(crate) fn best<S: Simd>(
    energies: &Energies<'_, S>,
    matters: f32,
    floats: &mut [f32],
    indices: &mut [u32],
) -> Option<usize> {
    let moments = energies.moments;
    if moments.power() == 0.0 {
        return None;
    }
    let (values, window) = floats.split_at_mut(list(energies.candidates.phases));
    let rounding = energies.rounding();
    let rivals = Rivals { rounding, matters, steep: moments.steepness() };
    // Each of two compared energies has a remainder, so each remainder counts twice.
    let fine = 2.0 * moments.fine_remainder();
    let slack = (2.0 * moments.remainder() + fine + rounding - matters).max(0.0);
    let mut list = List::new((fine + rounding - matters).max(0.0), values, indices);
    let arcs = Arcs::new(energies);
    let best = if arcs.evaluate_window(energies, slack, window, &mut list.least) {
        rivals.list_window(energies, &arcs, window, &mut list)
    } else {
        arcs.list_all(energies, slack, &mut list);
        list.sift();
        rivals.keep(energies.candidates, &mut list)
    };
    if list.count <= 1 {
        return Some(best);
    }
    // The window may extend over the last phase to the first ones, so its indices may not be in ascending order.
    list.sort();
    list.best(energies)
}

/// The arcs between 32 phases at full amplitude.
struct Arcs<V> {
    /// The least change of the energy at the ends of the arcs.
    least: f32,
    /// Index of the arc end near which the energy's change is expected to be least.
    center: usize,
    /// Lower bounds of the changes on the arcs that begin at an even end, and on those that begin at an odd end.
    lower: [V; 2],
}

impl<V: Copy> Arcs<V> {
    #[inline(always)]
    fn new<S: Simd<V = V>>(energies: &Energies<'_, S>) -> Self {
        let (s, candidates) = (energies.s, energies.candidates);
        let amplitude = candidates.amplitude(candidates.amplitudes - 1);
        let [even, odd] = candidates.coarse(amplitude);
        let (even, odd) = (energies.roughly(even), energies.roughly(odd));
        let least = s.least(s.min(even, odd));
        let center = if energies.near.is_empty() {
            direction(energies.moments.first())
        } else {
            let at = [even, odd].map(|changes| !s.less(s.splat(least), changes) & 0xffff);
            let center = if at[0] == 0 { 2 * at[1].trailing_zeros() + 1 } else { 2 * at[0].trailing_zeros() };
            center as usize % ARCS
        };
        let mut twice: [Lanes; 2] = [[0.0; LANES]; 2];
        s.store(even, &mut twice[0]);
        s.store(even, &mut twice[1]);
        let next = s.load(twice.as_flattened()[1..].first_chunk().unwrap_or(&[0.0; LANES]));
        let width = core::f32::consts::TAU * candidates.phases.div_ceil(ARCS) as f32 / candidates.phases as f32;
        let dip = energies.curvature(amplitude) * width * width / 8.0;
        let lower = [below(s, even, odd, dip), below(s, odd, next, dip)];
        Self { least, center, lower }
    }

    /// Iterates over the phases of the arcs around the center, up to sixteen at a time: the first phase, and how many
    /// belong to the arcs.
    #[inline(always)]
    fn window(&self, candidates: &Candidates) -> impl Iterator<Item = (usize, usize)> + use<V> {
        let phases = candidates.phases;
        let first = candidates.start(self.center + ARCS - REACH);
        let count = candidates.start(self.center + ARCS + REACH) - first;
        let wrap = move |l: usize| if l < phases { l } else { l - phases };
        let first = wrap(first);
        (0..count.div_ceil(LANES)).map(move |k| (wrap(first + k * LANES), LANES.min(count - k * LANES)))
    }

    /// Evaluates the arcs around the center. Returns whether no other candidate can be below their least change plus
    /// `slack`.
    #[inline(always)]
    fn evaluate_window<S: Simd<V = V>>(
        &self,
        energies: &Energies<'_, S>,
        slack: f32,
        window: &mut [f32],
        least: &mut f32,
    ) -> bool {
        let (s, candidates) = (energies.s, energies.candidates);
        let full = candidates.amplitudes - 1;
        let mut lowest = s.splat(f32::INFINITY);
        for ((l, _), window) in self.window(candidates).zip(window.as_chunks_mut().0) {
            let changes = energies.evaluate(candidates.drives(candidates.amplitude(full), l));
            lowest = s.min(changes, lowest);
            s.store(changes, window);
        }
        *least = s.least(lowest);
        let limit = s.splat(*least + slack);
        let first = self.center + ARCS - REACH;
        let inside = |first: usize| u32::from(((1_u16 << REACH) - 1).rotate_left((first % LANES) as u32));
        let even = !s.less(limit, self.lower[0]) & 0xffff & !inside(first.div_ceil(2));
        let odd = !s.less(limit, self.lower[1]) & 0xffff & !inside(first / 2);
        let full_only = full == 0 || {
            let a = candidates.amplitude(full - 1);
            (1.0 - a) * (-*least).min(-*least - a * energies.bow()) > slack
        };
        even | odd == 0 && full_only
    }

    /// Returns the least change of all amplitudes at the phase of the center.
    #[inline(always)]
    fn least_inward<S: Simd<V = V>>(&self, energies: &Energies<'_, S>) -> f32 {
        let (s, candidates) = (energies.s, energies.candidates);
        let [cos, sin] = candidates.phasor(candidates.start(self.center));
        let mut lowest = s.splat(f32::INFINITY);
        for first in (0..candidates.amplitudes).step_by(LANES) {
            let mut amplitudes = [0.0; LANES];
            for (k, amplitude) in amplitudes.iter_mut().enumerate() {
                *amplitude = candidates.amplitude((first + k).min(candidates.amplitudes - 1));
            }
            let mut z = [[0.0; LANES]; 2];
            s.store(s.mul(s.load(&amplitudes), s.splat(cos)), &mut z[0]);
            s.store(s.mul(s.load(&amplitudes), s.splat(sin)), &mut z[1]);
            lowest = s.min(energies.roughly(Sixteen { amplitude: 1.0, phasors: z.each_ref() }), lowest);
        }
        s.least(lowest)
    }

    /// Evaluates and lists all candidates, of any amplitude, that may be the best.
    #[inline(always)]
    fn list_all<S: Simd<V = V>>(&self, energies: &Energies<'_, S>, slack: f32, list: &mut List<'_>) {
        let (s, candidates) = (energies.s, energies.candidates);
        let bow = energies.bow();
        let lower = s.min(self.lower[0], self.lower[1]);
        let mut least = self.least.min(self.least_inward(energies));
        for k in 0..candidates.amplitudes {
            let a = candidates.amplitude(k);
            let limit = least + slack + a * (1.0 - a) * bow;
            let mut open = !s.less(s.splat(limit), s.mul(s.splat(a), lower)) & 0xffff;
            while open != 0 {
                let arc = 2 * open.trailing_zeros() as usize;
                open &= open - 1;
                let end = candidates.start(arc + 2);
                for l in (candidates.start(arc)..end).step_by(LANES) {
                    let changes = energies.evaluate(candidates.drives(a, l));
                    list.push(s, changes, k * candidates.phases + l, LANES.min(end - l));
                    least = least.min(list.least);
                }
            }
        }
    }
}

/// Returns a lower bound of a function with values v and w at the ends of an arc; `dip` is c h^2/8 (see the module's
/// head).
#[inline(always)]
fn below<S: Simd>(s: S, v: S::V, w: S::V, dip: f32) -> S::V {
    let apart = s.mul(s.splat(0.25 / dip), s.abs(s.sub(v, w)));
    let rest = s.max(s.sub(s.splat(1.0), apart), s.splat(0.0));
    s.fnma(s.mul(s.splat(dip), rest), rest, s.min(v, w))
}

/// Returns the index of the multiple of 1/32 turn that is nearest to the phase of z where Re(z m) is least, m = (re,
/// im).
#[inline(always)]
fn direction([re, im]: [f32; 2]) -> usize {
    // Tangents of the odd multiples of 1/64 turn.
    const BETWEEN: [f32; ARCS / 4] =
        [0.098_491_4, 0.303_346_7, 0.534_511_1, 0.820_678_8, 1.218_503_5, 1.870_868_4, 3.296_558_2, 10.153_17];
    let (x, y) = (re.abs(), im.abs());
    let up = BETWEEN.iter().map(|tangent| usize::from(y > tangent * x)).sum();
    let half = if re > 0.0 { ARCS / 2 - up } else { up };
    if im < 0.0 { (ARCS - half) % ARCS } else { half }
}

/// Bounds that say which candidates may be as good as the best one.
struct Rivals {
    /// If two changes of the energy differ by less than this, rounding leaves their order open.
    rounding: f32,
    /// If two changes of the energy differ by less than this, the candidates count as equally good.
    matters: f32,
    /// Bound of the remainder in the difference of two changes, for each unit of distance between the two candidates.
    steep: f32,
}

impl Rivals {
    /// Lists the best candidate of the window and its rivals; returns the index of the best.
    #[inline(always)]
    fn list_window<S: Simd>(
        &self,
        energies: &Energies<'_, S>,
        arcs: &Arcs<S::V>,
        window: &[f32],
        list: &mut List<'_>,
    ) -> usize {
        let (s, candidates) = (energies.s, energies.candidates);
        let phases = candidates.phases;
        let first = (candidates.amplitudes - 1) * phases;
        let limit = s.splat(list.least + self.rounding);
        let window = window.as_chunks().0;
        let mut best = usize::MAX;
        for ((l, used), changes) in arcs.window(candidates).zip(window) {
            let bits = !s.less(limit, s.load(changes)) & (0xffff >> (LANES - used));
            best = if best == usize::MAX && bits != 0 { l + bits.trailing_zeros() as usize } else { best };
        }
        // `best` is not set if the changes are NaN; then phase 0 is taken.
        let best = if best == usize::MAX { 0 } else { best % phases };
        let [cos, sin] = candidates.phasor(best);
        let (cos, sin, steep) = (s.splat(cos), s.splat(sin), s.splat(self.steep * self.steep));
        let spare = s.splat(list.least + 2.0 * self.rounding - self.matters);
        for ((l, used), changes) in arcs.window(candidates).zip(window) {
            let [c, d] = candidates.sixteen(l);
            let (x, y) = (s.sub(s.load(c), cos), s.sub(s.load(d), sin));
            let apart = s.fma(x, x, s.mul(y, y));
            let excess = s.max(s.sub(s.load(changes), spare), s.splat(0.0));
            let mut bits = !s.less(s.mul(steep, apart), s.mul(excess, excess)) & (0xffff >> (LANES - used));
            let lane = if best < l { best + phases - l } else { best - l };
            if lane < used {
                bits |= 1 << lane;
            }
            while bits != 0 {
                let at = l + bits.trailing_zeros() as usize;
                let at = if at < phases { at } else { at - phases };
                list.add(first + at);
                bits &= bits - 1;
            }
        }
        first + best
    }

    /// Removes from a list all candidates except the best one and its rivals; returns the index of the best.
    #[inline(always)]
    fn keep(&self, candidates: &Candidates, list: &mut List<'_>) -> usize {
        let near = list.least + self.rounding;
        let Some(best) = list.first_below(near) else { return 0 };
        let [br, bi] = candidates.drive(best);
        list.retain(|index, value| {
            let [re, im] = candidates.drive(index);
            let apart = (re - br) * (re - br) + (im - bi) * (im - bi);
            let excess = (value - near + self.matters).max(0.0);
            index == best || excess * excess <= self.steep * self.steep * apart
        });
        best
    }
}
