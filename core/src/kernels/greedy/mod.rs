//! Greedy pass: one transducer after another takes the candidate that lowers eq. (7) most.
//!
//! ```text
//! for each transducer i in order:
//!     G = row of i, its pressures at the points at drive 1
//!     m = moments of P, targets, weights and G        O(M), see `moments`
//!     q_i = argmin over the candidates z of the energy's change, by m alone where its remainder allows
//!     P += G q_i
//! ```
//!
//! The loop is written once over [`Layout`]: the lanes contain 16 points of one problem ([`PointsInLanes`]) or one
//! point of 16 problems ([`crate::kernels::greedy::interleaved_pass`]). Each update waits for the one before, so that
//! latency limits the pass. These points shorten it:
//!
//! 1. A candidate costs one polynomial, whatever the number M of points: 4096 candidates take 1.6 to 1.9 times as long
//!    as 16. Only candidates closer than the remainder are decided by eq. (7) itself ([`shortlist`], [`large_grid`]).
//! 2. The next row does not depend on this update. It is written while the loop waits for the sums over lanes.
//! 3. The values of a point that the moments need (1/|P|^2, w (1 - t/|P|), w t |P|) are computed when its pressure is,
//!    see [`PointGroup`].
//! 4. Eq. (7) is evaluated for all candidates at once in three cases: before any transducer is driven, for absolute
//!    errors, and for up to 16 phases at up to 16 points of which the moments leave some out.

pub(crate) mod candidates;
pub(crate) mod energies;
pub(crate) mod interleaved_pass;
pub(crate) mod large_grid;
pub(crate) mod moments;
pub(crate) mod point_group;
pub(crate) mod replacement;
pub(crate) mod search;
pub(crate) mod shortlist;

use core::marker::PhantomData;

use crate::kernels::greedy::candidates::Term;
use crate::kernels::greedy::energies::Energies;
use crate::kernels::greedy::moments::{Moments, PARTS, Parts};
use crate::kernels::greedy::search::Points;
use crate::kernels::prelude::*;
use crate::kernels::{Candidates, PointGroup, Rows};

/// Largest difference of two energies that is ignored, relative to the energy of silence. It is a fifth of the loss
/// that docs/reproducibility.md allows; the rest is for the rounding of G.
const MATTERS: f32 = 2e-7;

/// The problem and the working memory of a pass. All lists of points have the same padded length.
pub(crate) struct Pass<'a> {
    pub(crate) rows: Rows<'a>,
    pub(crate) target: &'a [f32],
    pub(crate) weight: &'a [f32],
    /// The number of points; the other lanes are padding.
    pub(crate) count: usize,
    /// The transducers in the order of their updates.
    pub(crate) order: &'a [u32],
    /// Working memory: one group for each 16 numbers of a list of points.
    pub(crate) groups: &'a mut [PointGroup],
    /// Working memory: this row and the next one, real and imaginary parts.
    pub(crate) memory: &'a mut [f32],
}

/// The candidates of a pass, and the memory of a search.
pub(crate) struct Search<'a> {
    pub(crate) candidates: &'a Candidates,
    /// Working memory of [`large_grid::floats`] numbers. In an interleaved batch,
    /// [`crate::kernels::greedy::interleaved_pass::floats`] is the length of the whole list, of which these are the
    /// last numbers.
    pub(crate) floats: &'a mut [f32],
    /// Working memory: [`indices`] indices.
    pub(crate) indices: &'a mut [u32],
}

/// Returns how many numbers a search of a grid of `phases` needs as working memory.
pub(crate) fn floats(phases: usize) -> usize {
    large_grid::floats(phases)
}

/// Returns how many indices a search needs for rows of `lanes` and a grid of `phases`.
pub(crate) fn indices(lanes: usize, phases: usize) -> usize {
    lanes + large_grid::list(phases)
}

/// Gives every transducer in order its best candidate, and returns the number of updates. Calls `report` after each
/// update with their number and the points. If `report` returns false, the pass ends. A transducer without effect keeps
/// its drive of 0.
pub(crate) fn pass<T: Term>(
    set: InstructionSet,
    pass: Pass<'_>,
    search: Search<'_>,
    drive: &mut [Complex32],
    pressures: [&mut [f32]; 2],
    report: impl FnMut(usize, &[PointGroup]) -> bool,
) -> usize {
    dispatch!(set, s => {
        let layout = PointsInLanes::<_, T>::new(s, [pass.target, pass.weight], search, drive);
        run(s, pass, layout, pressures, report)
    })
}

/// The layout of the lanes: 16 points of one problem, or one point of each of 16 problems.
pub(crate) trait Layout<S: Simd> {
    /// The drive of a transducer: in one problem, or in each of 16.
    type Drive;

    /// Chooses and stores the drive of transducer `i`; returns `None` if the transducer has no effect. Calls
    /// `meanwhile` once, while the processor waits for the sums over the points.
    fn update(&mut self, s: S, points: Points<'_>, i: usize, meanwhile: impl FnOnce()) -> Option<Self::Drive>;

    /// Adds the wave G q of a transducer to the pressures at `count` points.
    fn add(&mut self, s: S, groups: &mut [PointGroup], count: usize, row: [&[f32]; 2], q: Self::Drive);
}

/// Runs the pass in a given layout; returns the number of updates.
#[inline(always)]
pub(crate) fn run<S: Simd>(
    s: S,
    pass: Pass<'_>,
    mut layout: impl Layout<S>,
    [re, im]: [&mut [f32]; 2],
    mut report: impl FnMut(usize, &[PointGroup]) -> bool,
) -> usize {
    let Pass { rows, target, weight, count, order, groups: points, memory } = pass;
    let lanes = target.len();
    for (group, (t, w)) in points.iter_mut().zip(groups(target).iter().zip(groups(weight))) {
        *group = PointGroup::silent(s, t, w);
    }
    let (mut row, mut next) = memory.split_at_mut(2 * lanes);
    write(s, rows, order.first(), row);
    let mut updates = 0;
    for &i in order {
        updates += 1;
        let parts = [&row[..lanes], &row[lanes..]];
        let before = Points { groups: points, row: parts, count };
        let drive = layout.update(
            s,
            before,
            i as usize,
            #[inline(always)]
            || write(s, rows, order.get(updates), next),
        );
        if let Some(q) = drive {
            layout.add(s, points, count, parts, q);
        }
        if !report(updates, points) {
            break;
        }
        core::mem::swap(&mut row, &mut next);
    }
    for (group, (re, im)) in points.iter().zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
        (*re, *im) = (group.re, group.im);
    }
    updates
}

/// Writes the row of a transducer, if there is one.
#[inline(always)]
fn write<S: Simd>(s: S, rows: Rows<'_>, i: Option<&u32>, row: &mut [f32]) {
    let (re, im) = row.split_at_mut(row.len() / 2);
    if let Some(&i) = i {
        rows.write(s, i as usize, re, im);
    }
}

/// The state of one problem whose points are in the lanes.
pub(crate) struct PointsInLanes<'a, V, T> {
    pub(crate) candidates: &'a Candidates,
    pub(crate) drive: &'a mut [Complex32],
    /// The energy as one partial sum in each lane; not computed while all pressures are 0.
    pub(crate) energy: V,
    pub(crate) silent: bool,
    /// Difference of two energies that is ignored.
    matters: f32,
    /// Working memory of the moments. It is valid for one number of points only.
    parts: Parts,
    floats: &'a mut [f32],
    /// Working memory: the points that the moments leave out.
    near: &'a mut [u32],
    /// Working memory: candidates that may be the best.
    close: &'a mut [u32],
    term: PhantomData<T>,
}

impl<'a, V: Copy, T: Term> PointsInLanes<'a, V, T> {
    /// Creates the state before any transducer is driven. `requested` are targets and weights.
    #[inline(always)]
    pub(crate) fn new<S: Simd<V = V>>(
        s: S,
        requested: [&[f32]; 2],
        search: Search<'a>,
        drive: &'a mut [Complex32],
    ) -> Self {
        let Search { candidates, floats, indices } = search;
        let (near, close) = indices.split_at_mut(requested[0].len());
        let mut energy = s.splat(0.0);
        for (t, w) in groups(requested[0]).iter().zip(groups(requested[1])) {
            energy = s.fma(s.mul(s.load(w), s.load(t)), s.load(t), energy);
        }
        let matters = MATTERS * s.reduce_add(energy);
        Self {
            candidates,
            drive,
            energy,
            silent: true,
            matters,
            parts: [[0.0; LANES]; PARTS],
            floats,
            near,
            close,
            term: PhantomData,
        }
    }
}

impl<S: Simd, T: Term> Layout<S> for PointsInLanes<'_, S::V, T> {
    type Drive = [f32; 2];

    #[inline(always)]
    fn update(&mut self, s: S, points: Points<'_>, i: usize, meanwhile: impl FnOnce()) -> Option<[f32; 2]> {
        let candidates = self.candidates;
        let moments = match (T::SQUARE && !self.silent, large_grid::large(candidates)) {
            (true, true) => Some(Moments::new::<S, true>(s, points, self.energy, self.near, &mut self.parts)),
            (true, false) => Some(Moments::new::<S, false>(s, points, self.energy, self.near, &mut self.parts)),
            (false, _) => None,
        };
        meanwhile();
        let index = match moments {
            Some((moments, nearby)) if nearby == 0 || points.groups.len() > 1 || !shortlist::few(candidates) => {
                let near = &self.near[..nearby];
                let energies = Energies { s, points, moments: &moments, near, candidates };
                if large_grid::large(candidates) {
                    s.aside(
                        #[inline(always)]
                        || large_grid::best(&energies, self.matters, self.floats, self.close),
                    )?
                } else {
                    shortlist::best(&energies, self.floats, self.close)?
                }
            }
            _ => {
                let tolerance = search::tolerance::<S, T>(s, points);
                if tolerance == 0.0 {
                    return None;
                }
                search::best::<S, T>(s, points, candidates, self.silent, tolerance)
            }
        };
        let [re, im] = candidates.drive(index);
        self.drive[i] = Complex32::new(re, im);
        Some([re, im])
    }

    #[inline(always)]
    fn add(&mut self, s: S, points: &mut [PointGroup], count: usize, row: [&[f32]; 2], q: [f32; 2]) {
        self.energy = point_group::add(s, points, count, row, q);
        self.silent = points.iter().all(|group| group.modulus == [0.0; LANES]);
    }
}
