//! One transducer rotated to the phase that serves its points best, all others as they are.

use crate::kernels::greedy::candidates::Candidates;
use crate::kernels::greedy::objective::L2;
use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::greedy::search;
use crate::kernels::greedy::search::Points;
use crate::kernels::lanes::{groups, groups_mut};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};

/// Writes the state of a field's points: targets and weights, pressures, all padded alike.
pub(crate) fn keep(set: InstructionSet, asked: [&[f32]; 2], field: [&[f32]; 2], points: &mut [PointGroup]) {
    dispatch!(set, s => {
        let one = [s.splat(1.0), s.splat(0.0)];
        let lists = groups(asked[0]).iter().zip(groups(asked[1])).zip(groups(field[0]).iter().zip(groups(field[1])));
        for (group, ((target, weight), (re, im))) in points.iter_mut().zip(lists) {
            *group = PointGroup::silent(s, target, weight);
            group.add(s, [re, im], one);
        }
    });
}

/// Takes the wave of one transducer, its `row` times `drive`, out of the field of `count` points, puts it back times
/// the best of the candidates, and returns the index of that one. `wave` is memory for a row.
pub(crate) fn rotate(
    set: InstructionSet,
    row: [&[f32]; 2],
    drive: [f32; 2],
    candidates: &Candidates,
    (points, count): (&mut [PointGroup], usize),
    [re, im]: [&mut [f32]; 2],
) -> usize {
    dispatch!(set, s => {
        let (qr, qi) = (s.splat(drive[0]), s.splat(drive[1]));
        let rows = groups(row[0]).iter().zip(groups(row[1]));
        let waves = groups_mut(re).iter_mut().zip(groups_mut(im));
        let out = [s.splat(-1.0), s.splat(0.0)];
        for ((group, (gr, gi)), (re, im)) in points.iter_mut().zip(rows).zip(waves) {
            let (gr, gi) = (s.load(gr), s.load(gi));
            s.store(s.fnma(gi, qi, s.mul(gr, qr)), re);
            s.store(s.fma(gi, qr, s.mul(gr, qi)), im);
            group.add(s, [re, im], out);
        }
        let others = Points { groups: points, row: [&*re, &*im], count };
        let tolerance = search::tolerance::<_, L2>(s, others);
        let choice = search::best::<_, L2>(s, others, candidates, false, tolerance);
        let [qr, qi] = candidates.drive(choice);
        let back = [s.splat(qr), s.splat(qi)];
        for (group, (re, im)) in points.iter_mut().zip(groups(re).iter().zip(groups(im))) {
            group.add(s, [re, im], back);
        }
        choice
    })
}
