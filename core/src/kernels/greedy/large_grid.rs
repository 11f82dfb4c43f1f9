//! The search of a large grid: many phases, and maybe many amplitudes.
//!
//! Amplitudes rise to 1. Mostly that alone is met, at 32 phases and then closely around where the first moment points,
//! or around the best of the 32 where the moments leave points out. The rest is passed over by bounds on f_a(phi), the
//! change under a e^{j phi}:
//!
//! - Over the phase its second derivative is at most c, so on a stretch of length h with v <= v' at its ends it
//!   stays above v - c h^2/8 (1 - x)^2 with x = 2 (v' - v)/(c h^2), or above v where x > 1.
//! - A lower amplitude is bounded by the full one at the same phase. The polynomial a g1 + a^2 g2 + a^3 g3 is
//!   a f_1 - a (1 - a) (g2 + (1 + a) g3). At a point left out |P + a G z| <= (1 - a) |P| + a |P + G z| gives the same
//!   with w |G|^2 for the last bracket. So f_a >= a f_1 - a (1 - a) Q, [`Energies::bow`].
//!
//! Where a bound cannot tell, the stretch is met too. Of what is met the candidates closer to the best than the
//! remainder of their difference are decided by eq. (7) itself.

use crate::kernels::greedy::energies::Energies;
use crate::kernels::greedy::moments::Moments;
use crate::kernels::greedy::search;
use crate::kernels::greedy::search::{Candidates, L2, Points, Winner};
use crate::kernels::greedy::shortlist::{List, Shortlist};
use crate::kernels::lanes::{LANES, Lanes, groups};
use crate::kernels::simd::Simd;

/// From this many phases on a grid is large.
pub(crate) const LARGE: usize = 64;

/// Phases met first, and stretches between them.
const COARSE: usize = 2 * LANES;

/// How many of these apart from the best of them, on each side, is looked at closely.
const REACH: usize = 2;

/// How many phases are looked at closely, at most.
const fn window(phases: usize) -> usize {
    (2 * REACH * phases.div_ceil(COARSE)).next_multiple_of(LANES)
}

/// The length of a list for a grid of `phases`.
pub(crate) fn list(phases: usize) -> usize {
    if phases < LARGE { Shortlist::MOST } else { Shortlist::MOST.max(window(phases)) }
}

/// Numbers of working memory: the values of a list, and those of a close look.
pub(crate) fn floats(phases: usize) -> usize {
    list(phases) + window(phases)
}

/// The best candidate, but for differences of the energy below `matters`; none if the transducer has no effect.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "the state of one turn")]
pub(crate) fn best<S: Simd>(
    s: S,
    points: Points<'_>,
    moments: &Moments,
    near: &[u32],
    candidates: &Candidates,
    matters: f32,
    floats: &mut [f32],
    close: &mut [u32],
) -> Option<usize> {
    if moments.power() == 0.0 {
        return None;
    }
    let energies = Energies { s, points, moments, near, candidates };
    let (values, met) = floats.split_at_mut(list(candidates.phases));
    let rounding = energies.rounding();
    let rivals = Rivals { rounding, matters, steep: moments.steepness() };
    // Twice the remainder of what the bounds are for, and the remainders of what is compared with them.
    let fine = 2.0 * moments.fine_remainder();
    let slack = (2.0 * moments.remainder() + fine + rounding - matters).max(0.0);
    let coarse = Coarse::new(&energies);
    let (best, count) = if let Some(least) = coarse.alone(&energies, slack, met) {
        rivals.beside(&energies, &coarse, least, met, close)
    } else {
        let near = (fine + rounding - matters).max(0.0);
        let mut list = List { slack: near, least: f32::INFINITY, indices: close, values, count: 0 };
        coarse.meet_all(&energies, slack, |changes, index, used| {
            list.meet(s, changes, index, used);
            list.least
        });
        list.sift();
        if list.count > list.indices.len() {
            let limit = list.least + list.slack;
            let tolerance = search::tolerance::<S, L2>(s, points);
            return (tolerance > 0.0).then(|| coarse.settle_all(&energies, slack, limit, tolerance));
        }
        rivals.among(candidates, &mut list)
    };
    if count <= 1 {
        return Some(best);
    }
    let tolerance = search::tolerance::<S, L2>(s, points);
    if tolerance == 0.0 {
        return None;
    }
    let close = &mut close[..count];
    // Phases looked at closely may run past the last one.
    close.sort_unstable();
    if count <= LANES {
        return Some(among_few(s, points, candidates, close, tolerance));
    }
    Some(search::best_of(s, points, candidates, close, tolerance))
}

/// As [`search::best_of`] among up to 16, with the points in the lanes.
#[inline(always)]
fn among_few<S: Simd>(s: S, points: Points<'_>, candidates: &Candidates, some: &[u32], tolerance: f32) -> usize {
    let zero = s.splat(0.0);
    let mut changes = [zero; LANES];
    for (&index, change) in some.iter().zip(&mut changes) {
        let drive = candidates.drive(index as usize).map(|q| s.splat(q));
        for (kept, (gr, gi)) in points.kept.iter().zip(groups(points.gain[0]).iter().zip(groups(points.gain[1]))) {
            *change = kept.add_change(s, [gr, gi], drive, *change);
        }
    }
    let at = |lane: usize| some[lane.min(some.len() - 1)] as usize;
    let mut lanes = [f32::INFINITY; LANES];
    s.store(s.reduce_add_each(&changes), &mut lanes);
    lanes[some.len()..].fill(f32::INFINITY);
    Winner::NONE.meet(s, s.load(&lanes), at, tolerance).index
}

/// The first look: 32 phases at full amplitude.
struct Coarse<V> {
    /// The least of these changes, and about where the least of all is.
    least: f32,
    place: usize,
    /// What the stretches from each to the next stay above: those that start at an even one, and at an odd one.
    lower: [V; 2],
}

impl<V: Copy> Coarse<V> {
    #[inline(always)]
    fn new<S: Simd<V = V>>(energies: &Energies<'_, S>) -> Self {
        let (s, candidates) = (energies.s, energies.candidates);
        let amplitude = candidates.amplitude(candidates.amplitudes - 1);
        let [even, odd] =
            candidates.coarse().map(|phasors| phasors.map(|part| s.mul(s.splat(amplitude), s.load(part))));
        let (even, odd) = (energies.roughly(even), energies.roughly(odd));
        let least = -s.reduce_max(s.sub(s.splat(0.0), s.min(even, odd)));
        let place = if energies.near.is_empty() {
            direction(energies.moments.first())
        } else {
            let at = [even, odd].map(|changes| !s.less(s.splat(least), changes) & 0xffff);
            let place = if at[0] == 0 { 2 * at[1].trailing_zeros() + 1 } else { 2 * at[0].trailing_zeros() };
            place as usize % COARSE
        };
        let mut twice: [Lanes; 2] = [[0.0; LANES]; 2];
        s.store(even, &mut twice[0]);
        s.store(even, &mut twice[1]);
        let next = s.load(twice.as_flattened()[1..].first_chunk().unwrap_or(&[0.0; LANES]));
        let width = core::f32::consts::TAU * candidates.phases.div_ceil(COARSE) as f32 / candidates.phases as f32;
        let dip = energies.curvature(amplitude) * width * width / 8.0;
        let lower = [below(s, even, odd, dip), below(s, odd, next, dip)];
        Self { least, place, lower }
    }

    /// The phases to be met: the first of each sixteen, and how many of them belong there.
    #[inline(always)]
    fn window(&self, candidates: &Candidates) -> impl Iterator<Item = (usize, usize)> + use<V> {
        let phases = candidates.phases;
        let first = candidates.start(self.place + COARSE - REACH);
        let count = candidates.start(self.place + COARSE + REACH) - first;
        let wrap = move |l: usize| if l < phases { l } else { l - phases };
        let first = wrap(first);
        (0..count.div_ceil(LANES)).map(move |k| (wrap(first + k * LANES), LANES.min(count - k * LANES)))
    }

    /// Meets these, and returns the least change if nothing beyond them can be less by `slack`.
    #[inline(always)]
    fn alone<S: Simd<V = V>>(&self, energies: &Energies<'_, S>, slack: f32, met: &mut [f32]) -> Option<f32> {
        let (s, candidates) = (energies.s, energies.candidates);
        let full = candidates.amplitudes - 1;
        let mut lowest = s.splat(f32::INFINITY);
        for ((l, _), met) in self.window(candidates).zip(met.as_chunks_mut().0) {
            let changes = energies.meet(candidates.amplitude(full), candidates.sixteen(l));
            lowest = s.min(changes, lowest);
            s.store(changes, met);
        }
        let least = -s.reduce_max(s.sub(s.splat(0.0), lowest));
        let limit = s.splat(least + slack);
        let first = self.place + COARSE - REACH;
        let inside = |first: usize| u32::from(((1_u16 << REACH) - 1).rotate_left((first % LANES) as u32));
        let even = !s.less(limit, self.lower[0]) & 0xffff & !inside(first.div_ceil(2));
        let odd = !s.less(limit, self.lower[1]) & 0xffff & !inside(first / 2);
        let full_only = full == 0 || {
            let a = candidates.amplitude(full - 1);
            (1.0 - a) * (-least).min(-least - a * energies.bow()) > slack
        };
        (even | odd == 0 && full_only).then_some(least)
    }

    /// The least change of all amplitudes at the phase of the place.
    #[inline(always)]
    fn least_inward<S: Simd<V = V>>(&self, energies: &Energies<'_, S>) -> f32 {
        let (s, candidates) = (energies.s, energies.candidates);
        let [cos, sin] = candidates.phasor(candidates.start(self.place));
        let mut lowest = s.splat(f32::INFINITY);
        for first in (0..candidates.amplitudes).step_by(LANES) {
            let mut levels = [0.0; LANES];
            for (k, set) in levels.iter_mut().enumerate() {
                *set = candidates.amplitude((first + k).min(candidates.amplitudes - 1));
            }
            let z = [cos, sin].map(|part| s.mul(s.load(&levels), s.splat(part)));
            lowest = s.min(energies.roughly(z), lowest);
        }
        -s.reduce_max(s.sub(s.splat(0.0), lowest))
    }

    /// Meets whatever may be best at any amplitude: `meet` is given 16 changes, the first one's index and how many
    /// of them count, and answers the least so far.
    #[inline(always)]
    fn meet_all<S: Simd<V = V>>(
        &self,
        energies: &Energies<'_, S>,
        slack: f32,
        mut meet: impl FnMut(V, usize, usize) -> f32,
    ) {
        let (s, candidates) = (energies.s, energies.candidates);
        let bow = energies.bow();
        let lower = s.min(self.lower[0], self.lower[1]);
        let mut least = self.least.min(self.least_inward(energies));
        for k in 0..candidates.amplitudes {
            let a = candidates.amplitude(k);
            let limit = least + slack + a * (1.0 - a) * bow;
            let mut open = !s.less(s.splat(limit), s.mul(s.splat(a), lower)) & 0xffff;
            while open != 0 {
                let place = 2 * open.trailing_zeros() as usize;
                open &= open - 1;
                let end = candidates.start(place + 2);
                for l in (candidates.start(place)..end).step_by(LANES) {
                    let changes = energies.meet(a, candidates.sixteen(l));
                    least = least.min(meet(changes, k * candidates.phases + l, LANES.min(end - l)));
                }
            }
        }
    }

    /// The best by eq. (7) of all that [`Self::meet_all`] meets and finds up to `limit`.
    #[inline(always)]
    fn settle_all<S: Simd<V = V>>(&self, energies: &Energies<'_, S>, slack: f32, limit: f32, tolerance: f32) -> usize {
        let (s, candidates, points) = (energies.s, energies.candidates, energies.points);
        let mut winner = Winner::NONE;
        self.meet_all(energies, slack, |changes, index, used| {
            if !s.less(s.splat(limit), changes) & (0xffff >> (LANES - used)) != 0 {
                let (k, l) = (index / candidates.phases, index % candidates.phases);
                let a = s.splat(candidates.amplitude(k));
                let z = candidates.sixteen(l).map(|part| s.mul(a, s.load(part)));
                let changes = search::add_changes::<S, L2>(s, points, 0..points.count, z, s.splat(0.0));
                // Lanes beyond the last phase are copies of the first ones.
                winner = winner.meet(s, changes, |lane| index - l + (l + lane) % candidates.phases, tolerance);
            }
            f32::INFINITY
        });
        winner.index
    }
}

/// What a function of values v and w at both ends of a stretch stays above; `dip` is c h^2/8.
#[inline(always)]
fn below<S: Simd>(s: S, v: S::V, w: S::V, dip: f32) -> S::V {
    let apart = s.mul(s.splat(0.25 / dip), s.abs(s.sub(v, w)));
    let rest = s.max(s.sub(s.splat(1.0), apart), s.splat(0.0));
    s.fnma(s.mul(s.splat(dip), rest), rest, s.min(v, w))
}

/// The thirty-second of a turn nearest to the phase where Re(z m) is least.
#[inline(always)]
fn direction([re, im]: [f32; 2]) -> usize {
    // Tangents of odd sixty-fourths of a turn.
    const BETWEEN: [f32; COARSE / 4] =
        [0.098_491_4, 0.303_346_7, 0.534_511_1, 0.820_678_8, 1.218_503_5, 1.870_868_4, 3.296_558_2, 10.153_17];
    let (x, y) = (re.abs(), im.abs());
    let up = BETWEEN.iter().map(|tangent| usize::from(y > tangent * x)).sum();
    let half = if re > 0.0 { COARSE / 2 - up } else { up };
    if im < 0.0 { (COARSE - half) % COARSE } else { half }
}

/// Which candidates the moments cannot tell from the best.
struct Rivals {
    /// What the changes' rounding leaves open,
    rounding: f32,
    /// what need not be told,
    matters: f32,
    /// and the remainder's part for each unit that two drives are apart.
    steep: f32,
}

impl Rivals {
    /// The best of what was looked at closely, and how many are listed: its rivals and itself.
    #[inline(always)]
    fn beside<S: Simd>(
        &self,
        energies: &Energies<'_, S>,
        coarse: &Coarse<S::V>,
        least: f32,
        met: &[f32],
        close: &mut [u32],
    ) -> (usize, usize) {
        let (s, candidates) = (energies.s, energies.candidates);
        let first = (candidates.amplitudes - 1) * candidates.phases;
        let limit = s.splat(least + self.rounding);
        let met = met.as_chunks().0;
        let mut best = usize::MAX;
        for ((l, used), changes) in coarse.window(candidates).zip(met) {
            let bits = !s.less(limit, s.load(changes)) & (0xffff >> (LANES - used));
            best = if best == usize::MAX && bits != 0 { l + bits.trailing_zeros() as usize } else { best };
        }
        let phases = candidates.phases;
        // None is found where nothing can be compared.
        let best = if best == usize::MAX { 0 } else { best % phases };
        let [cos, sin] = candidates.phasor(best).map(|x| s.splat(x));
        let (steep, spare) = (s.splat(self.steep * self.steep), s.splat(least + 2.0 * self.rounding - self.matters));
        let mut count = 0;
        for ((l, used), changes) in coarse.window(candidates).zip(met) {
            let [c, d] = candidates.sixteen(l);
            let (x, y) = (s.sub(s.load(c), cos), s.sub(s.load(d), sin));
            let apart = s.fma(x, x, s.mul(y, y));
            let excess = s.max(s.sub(s.load(changes), spare), s.splat(0.0));
            let mut bits = !s.less(s.mul(steep, apart), s.mul(excess, excess)) & (0xffff >> (LANES - used));
            let own = if best < l { best + phases - l } else { best - l };
            if own < used {
                bits |= 1 << own;
            }
            while bits != 0 {
                let at = l + bits.trailing_zeros() as usize;
                close[count] = (first + if at < phases { at } else { at - phases }) as u32;
                count += 1;
                bits &= bits - 1;
            }
        }
        (first + best, count)
    }

    /// As [`Self::beside`], for what was listed.
    #[inline(always)]
    fn among(&self, candidates: &Candidates, list: &mut List<'_>) -> (usize, usize) {
        let near = list.least + self.rounding;
        // None is found where nothing can be compared.
        let best = (0..list.count).find(|&k| list.values[k] <= near).unwrap_or(0);
        let winner = list.indices[..list.count].get(best).map_or(0, |&index| index as usize);
        let [br, bi] = candidates.drive(winner);
        let mut count = 0;
        for k in 0..list.count {
            let [re, im] = candidates.drive(list.indices[k] as usize);
            let apart = (re - br) * (re - br) + (im - bi) * (im - bi);
            let excess = (list.values[k] - near + self.matters).max(0.0);
            if k == best || excess * excess <= self.steep * self.steep * apart {
                list.indices[count] = list.indices[k];
                count += 1;
            }
        }
        (winner, count)
    }
}
