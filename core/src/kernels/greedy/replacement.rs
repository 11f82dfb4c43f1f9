//! Replacement: removes one transducer's wave from the field and adds it again with the best drive.
//!
//! ```text
//! P -= G q                                  the pressures without this transducer
//! q = the candidate of a range of phases with the least change of eq. (7), computed exactly
//! P += G q
//! ```

use crate::kernels::greedy::candidates::{Candidates, L2, PhaseRange, Term};
use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::greedy::search::Points;
use crate::kernels::greedy::{point_group, search};
use crate::kernels::prelude::*;

/// Writes point groups from targets and weights (`requested`) and pressures (`field`), lists of the same padded length.
pub(crate) fn keep(set: InstructionSet, requested: [&[f32]; 2], field: [&[f32]; 2], points: &mut [PointGroup]) {
    dispatch!(set, s => {
        for (group, (target, weight)) in points.iter_mut().zip(groups(requested[0]).iter().zip(groups(requested[1]))) {
            *group = PointGroup::silent(s, target, weight);
        }
        point_group::add(s, points, field[0].len(), field, [1.0, 0.0]);
    });
}

/// Replaces the drive of one transducer, given its `row` of G, in the field of `count` points. Returns the new drive.
///
/// The new drive is the best candidate of `range`; without a range it is the present drive. A transducer without effect
/// gets 0.
pub(crate) fn replace<T: Term>(
    set: InstructionSet,
    row: [&[f32]; 2],
    present: [f32; 2],
    candidates: &Candidates,
    range: Option<PhaseRange>,
    points: &mut [PointGroup],
    count: usize,
) -> [f32; 2] {
    dispatch!(set, s => {
        let choose = |others: Points<'_>| {
            let tolerance = search::tolerance::<_, T>(s, others);
            match range {
                _ if tolerance == 0.0 => [0.0; 2],
                Some(range) => candidates.drive(search::best_within::<_, T>(s, others, candidates, range, tolerance)),
                None => present,
            }
        };
        replaced(s, row, present, points, count, choose)
    })
}

/// Replaces a transducer's wave, `row` times `drive`, by this wave times the best of some rotations. Returns the index
/// of that rotation. The last argument is memory for a row.
pub(crate) fn rotate(
    set: InstructionSet,
    row: [&[f32]; 2],
    drive: [f32; 2],
    rotations: &Candidates,
    points: &mut [PointGroup],
    count: usize,
    [re, im]: [&mut [f32]; 2],
) -> usize {
    dispatch!(set, s => {
        let (qr, qi) = (s.splat(drive[0]), s.splat(drive[1]));
        let rows = groups(row[0]).iter().zip(groups(row[1]));
        for ((gr, gi), (re, im)) in rows.zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
            let (gr, gi) = (s.load(gr), s.load(gi));
            s.store(s.fnma(gi, qi, s.mul(gr, qr)), re);
            s.store(s.fma(gi, qr, s.mul(gr, qi)), im);
        }
        let mut choice = 0;
        let choose = |others: Points<'_>| {
            let tolerance = search::tolerance::<_, L2>(s, others);
            choice = search::best::<_, L2>(s, others, rotations, false, tolerance);
            rotations.drive(choice)
        };
        replaced(s, [re, im], [1.0, 0.0], points, count, choose);
        choice
    })
}

/// Removes a transducer's wave G q from the pressures, and adds G q' with the q' that `choose` returns. Returns q'.
#[inline(always)]
fn replaced<S: Simd>(
    s: S,
    row: [&[f32]; 2],
    present: [f32; 2],
    points: &mut [PointGroup],
    count: usize,
    choose: impl FnOnce(Points<'_>) -> [f32; 2],
) -> [f32; 2] {
    let add = |points: &mut [PointGroup], q: [f32; 2]| {
        point_group::add(s, points, count, row, q);
    };
    add(points, present.map(|part| -part));
    let chosen = choose(Points { groups: points, row, count });
    add(points, chosen);
    chosen
}
