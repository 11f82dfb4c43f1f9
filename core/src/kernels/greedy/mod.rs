//! The pass of the greedy method over its transducers.
//!
//! Most turns are decided by moments (see [`Moments`]), whatever the number of candidates. Where the best
//! candidates lie closer than the moments' remainder they are expanded anew about the best of them, which makes
//! the remainder smaller by the fourth power of their distance; and where that is not enough eq. (7) itself
//! decides, as it does at the first transducers and for the absolute errors. Large grids are searched by [`fine`].

pub(crate) mod energies;
pub(crate) mod interleaved;
pub(crate) mod large_grid;
pub(crate) mod moments;
pub(crate) mod point_group;
pub(crate) mod rotate;
pub(crate) mod search;
pub(crate) mod shortlist;

use num_complex::Complex32;

use crate::kernels::greedy::moments::Moments;
use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::greedy::search::{Candidates, L2, Points, Term};
use crate::kernels::greedy::shortlist::{Shortlist, shortlist};
use crate::kernels::lanes::{LANES, Lanes, groups};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::simd::Simd;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};

/// Differences of the energy that do not matter, beside the energy of silence: a fifth of the regret that
/// docs/conventions.md allows, which leaves the rest to the rounding of G.
const MATTERS: f32 = 2e-7;

/// What a pass works on; all lists of points are padded alike.
pub(crate) struct Pass<'a> {
    pub(crate) rows: Rows<'a>,
    /// How many of them are points; the rest is padding.
    pub(crate) count: usize,
    pub(crate) target: &'a [f32],
    pub(crate) weight: &'a [f32],
    pub(crate) candidates: &'a Candidates,
    /// The transducers in the order of their turns.
    pub(crate) order: &'a [u32],
    /// Memory: two for each 16 points,
    pub(crate) kept: &'a mut [PointGroup],
    /// two rows,
    pub(crate) row: [&'a mut [f32]; 4],
    /// [`floats`] numbers,
    pub(crate) floats: &'a mut [f32],
    /// and [`indices`] indices.
    pub(crate) indices: &'a mut [u32],
}

/// Numbers of working memory for a grid of `phases`.
pub(crate) fn floats(phases: usize) -> usize {
    large_grid::floats(phases)
}

/// Indices of working memory for a row of `lanes` and a grid of `phases`.
pub(crate) fn indices(lanes: usize, phases: usize) -> usize {
    lanes + large_grid::list(phases)
}

/// Gives every transducer in turn its best candidate. `step` is told the points after each turn and answers whether
/// to go on; returns the number of turns taken. What has no effect keeps its drive of 0.
pub(crate) fn pass<T: Term>(
    set: InstructionSet,
    pass: Pass<'_>,
    drive: &mut [Complex32],
    pressures: [&mut [f32]; 2],
    mut step: impl FnMut(usize, &[PointGroup]) -> bool,
) -> usize {
    dispatch!(set, s => run::<_, T>(s, pass, drive, pressures, &mut step))
}

#[inline(always)]
fn run<S: Simd, T: Term>(
    s: S,
    pass: Pass<'_>,
    drive: &mut [Complex32],
    [re, im]: [&mut [f32]; 2],
    step: &mut impl FnMut(usize, &[PointGroup]) -> bool,
) -> usize {
    let Pass { rows, count, target, weight, candidates, order, kept, row, floats, indices } = pass;
    let [mut row_re, mut row_im, mut next_re, mut next_im] = row;
    let (near, close) = indices.split_at_mut(target.len());
    let (kept, moved) = kept.split_at_mut(target.len() / LANES);
    let mut energy = s.splat(0.0);
    for (kept, (t, w)) in kept.iter_mut().zip(groups(target).iter().zip(groups(weight))) {
        *kept = PointGroup::silent(s, t, w);
        energy = s.fma(s.mul(s.load(w), s.load(t)), s.load(t), energy);
    }
    let matters = MATTERS * s.reduce_add(energy);
    let large = candidates.phases >= large_grid::LARGE;
    let mut silent = true;
    let mut turns = 0;
    if let Some(&first) = order.first() {
        rows.write(s, first as usize, row_re, row_im);
    }
    for (turn, &i) in order.iter().enumerate() {
        let points = Points { kept, gain: [&*row_re, &*row_im], count };
        let moments = match (T::SQUARE && !silent, large) {
            (true, true) => Some(Moments::new::<S, true>(s, kept, points.gain, energy, near)),
            (true, false) => Some(Moments::new::<S, false>(s, kept, points.gain, energy, near)),
            (false, _) => None,
        };
        // The next row depends on nothing here: it fills the wait for the sums.
        if let Some(&next) = order.get(turn + 1) {
            rows.write(s, next as usize, next_re, next_im);
        }
        let choice = match moments {
            Some((moments, nearby)) if large => {
                large_grid::best(s, points, &moments, &near[..nearby], candidates, matters, floats, close)
            }
            // With few points eq. (7) alone is quicker than moments that leave some out.
            Some((moments, nearby)) if nearby == 0 || points.kept.len() > 1 || !few(candidates) => {
                choose(s, points, &moments, nearby, moved, candidates, floats, near, close)
            }
            _ => search_all::<S, T>(s, points, candidates, silent),
        };
        if let Some(index) = choice {
            let [qr, qi] = candidates.drive(index);
            drive[i as usize] = Complex32::new(qr, qi);
            energy = s.splat(0.0);
            let q = [s.splat(qr), s.splat(qi)];
            for (kept, (gr, gi)) in kept.iter_mut().zip(groups(row_re).iter().zip(groups(row_im))) {
                energy = s.add(energy, kept.add(s, [gr, gi], q));
            }
            silent = kept.iter().all(|kept| kept.modulus == [0.0; LANES]);
        }
        turns = turn + 1;
        if !step(turns, kept) {
            break;
        }
        core::mem::swap(&mut row_re, &mut next_re);
        core::mem::swap(&mut row_im, &mut next_im);
    }
    for (kept, group) in kept.iter().zip(0..) {
        let range = group * LANES..(group + 1) * LANES;
        re[range.clone()].copy_from_slice(&kept.re);
        im[range].copy_from_slice(&kept.im);
    }
    turns
}

/// Whether all candidates are up to 16 phases.
#[inline(always)]
pub(crate) fn few(candidates: &Candidates) -> bool {
    candidates.amplitudes == 1 && candidates.phases <= LANES
}

/// The best candidate by eq. (7) alone; none if the transducer has no effect.
#[inline(always)]
pub(crate) fn search_all<S: Simd, T: Term>(
    s: S,
    points: Points<'_>,
    candidates: &Candidates,
    silent: bool,
) -> Option<usize> {
    let tolerance = search::tolerance::<S, T>(s, points);
    (tolerance > 0.0).then(|| search::best::<S, T>(s, points, candidates, silent, tolerance))
}

/// The best candidate, `moments` leaving out the first `nearby` points of `near`; none if the transducer has no effect.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "the state of one turn")]
pub(crate) fn choose<S: Simd>(
    s: S,
    points: Points<'_>,
    moments: &Moments,
    nearby: usize,
    moved: &mut [PointGroup],
    candidates: &Candidates,
    floats: &mut [f32],
    near: &mut [u32],
    close: &mut [u32],
) -> Option<usize> {
    if moments.power() == 0.0 {
        return None;
    }
    if nearby == 0
        && few(candidates)
        && let Some(index) = shortlist::clear_winner(s, moments, candidates)
    {
        return Some(index);
    }
    let Shortlist { best, count, reach } =
        shortlist(s, points, moments, &near[..nearby], candidates, moments.slack(1.0), floats, close);
    if count == 1 {
        return Some(best);
    }
    let tolerance = search::tolerance::<S, L2>(s, points);
    if tolerance == 0.0 {
        return None;
    }
    if count > Shortlist::MOST {
        return Some(search::best::<S, L2>(s, points, candidates, false, tolerance));
    }
    let close = &close[..count];
    Some(
        settle(s, points, moved, candidates, best, close, near, reach, tolerance)
            .unwrap_or_else(|| search::best_of(s, points, candidates, close, tolerance)),
    )
}

/// The winner among some candidates by moments about `best` of them; none if these do not tell them apart either.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "the state of one turn")]
fn settle<S: Simd>(
    s: S,
    points: Points<'_>,
    moved: &mut [PointGroup],
    candidates: &Candidates,
    best: usize,
    close: &[u32],
    near: &mut [u32],
    reach: f32,
    tolerance: f32,
) -> Option<usize> {
    let [qr, qi] = candidates.drive(best);
    let q = [s.splat(qr), s.splat(qi)];
    let rows = groups(points.gain[0]).iter().zip(groups(points.gain[1]));
    let mut energy = s.splat(0.0);
    for ((moved, kept), (gr, gi)) in moved.iter_mut().zip(points.kept).zip(rows) {
        *moved = *kept;
        energy = s.add(energy, moved.add(s, [gr, gi], q));
    }
    let (moments, nearby) = Moments::new::<S, false>(s, moved, points.gain, energy, near);
    let square = reach * reach;
    if nearby > 0 || 2.0 * square * square * moments.remainder() > tolerance {
        return None;
    }
    let mut winner = search::Winner::NONE;
    for chunk in close.chunks(LANES) {
        let (mut re, mut im): (Lanes, Lanes) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let [zr, zi] = candidates.drive(chunk[lane.min(chunk.len() - 1)] as usize);
            (re[lane], im[lane]) = (zr - qr, zi - qi);
        }
        let changes = moments.change(s, s.load(&re), s.load(&im));
        winner = winner.meet(s, changes, |lane| chunk[lane.min(chunk.len() - 1)] as usize, tolerance);
    }
    Some(winner.index)
}
