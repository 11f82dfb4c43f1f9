//! One transducer turned to where it serves its points best, all others as they are.

use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::greedy::search;
use crate::kernels::greedy::search::{Candidates, L2, Points};
use crate::kernels::lanes::{groups, groups_mut};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};

/// Takes up the points of a field: targets, weights and pressures, padded alike.
pub(crate) fn keep(set: InstructionSet, asked: [&[f32]; 2], field: [&[f32]; 2], kept: &mut [PointGroup]) {
    dispatch!(set, s => {
        let one = [s.splat(1.0), s.splat(0.0)];
        let lists = groups(asked[0]).iter().zip(groups(asked[1])).zip(groups(field[0]).iter().zip(groups(field[1])));
        for (kept, ((target, weight), (re, im))) in kept.iter_mut().zip(lists) {
            *kept = PointGroup::silent(s, target, weight);
            kept.add(s, [re, im], one);
        }
    });
}

/// Takes the wave of one transducer (its `row` times `drive`) out of the field, puts it back turned by the best of
/// the candidates, and returns that one's index. `wave` is memory for a row.
pub(crate) fn turn(
    set: InstructionSet,
    row: [&[f32]; 2],
    drive: [f32; 2],
    candidates: &Candidates,
    count: usize,
    kept: &mut [PointGroup],
    wave: [&mut [f32]; 2],
) -> usize {
    dispatch!(set, s => {
        let [re, im] = wave;
        let (qr, qi) = (s.splat(drive[0]), s.splat(drive[1]));
        let rows = groups(row[0]).iter().zip(groups(row[1]));
        let waves = groups_mut(re).iter_mut().zip(groups_mut(im));
        let out = [s.splat(-1.0), s.splat(0.0)];
        for ((kept, (gr, gi)), (re, im)) in kept.iter_mut().zip(rows).zip(waves) {
            let (gr, gi) = (s.load(gr), s.load(gi));
            s.store(s.fnma(gi, qi, s.mul(gr, qr)), re);
            s.store(s.fma(gi, qr, s.mul(gr, qi)), im);
            kept.add(s, [re, im], out);
        }
        let points = Points { kept, gain: [&*re, &*im], count };
        let tolerance = search::tolerance::<_, L2>(s, points);
        let choice = search::best::<_, L2>(s, points, candidates, false, tolerance);
        let [qr, qi] = candidates.drive(choice);
        let back = [s.splat(qr), s.splat(qi)];
        for (kept, (re, im)) in kept.iter_mut().zip(groups(re).iter().zip(groups(im))) {
            kept.add(s, [re, im], back);
        }
        choice
    })
}
