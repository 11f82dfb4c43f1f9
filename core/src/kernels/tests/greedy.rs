//! The greedy pass compared with energies in f64, update by update.

use alloc::vec;
use alloc::vec::Vec;

use num_complex::{Complex32, Complex64};

use crate::kernels::greedy::candidates::Candidates;
use crate::kernels::greedy::candidates::{L1, L2};
use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::greedy::{Pass, Search, floats, indices, pass};
use crate::kernels::lanes::LANES;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::batch::{Batch, Lists, TRANSDUCERS, each, widened};
use crate::kernels::tests::search::Reference;
use crate::kernels::tests::wide;

pub(super) fn order() -> Vec<u32> {
    (0..TRANSDUCERS as u32).rev().collect()
}

pub(super) fn grid(phases: usize, amplitudes: usize) -> Candidates {
    Candidates::new(phases, amplitudes, [const { Vec::new() }; 3])
}

/// Runs a pass of one problem. Calls `report` with the number of updates and the pressures after each.
pub(super) fn alone<T: Reference>(
    set: InstructionSet,
    lists: &Lists,
    candidates: &Candidates,
    mut report: impl FnMut(usize, Vec<Complex64>) -> bool,
) -> (Vec<Complex32>, [Vec<f32>; 2], usize) {
    let lanes = lists.lanes();
    let mut drive = vec![Complex32::ZERO; TRANSDUCERS];
    let mut field = [(); 2].map(|()| vec![f32::NAN; lanes]);
    let pass_over = Pass {
        rows: lists.rows(),
        target: &lists.target,
        weight: &lists.weight,
        count: lists.points,
        order: &order(),
        groups: &mut vec![PointGroup::default(); lanes / LANES],
        memory: &mut vec![f32::NAN; 4 * lanes],
    };
    let search = Search {
        candidates,
        floats: &mut vec![f32::NAN; floats(candidates.phases)],
        indices: &mut vec![u32::MAX; indices(lanes, candidates.phases)],
    };
    let reported = |updates: usize, groups: &[PointGroup]| {
        let all = groups.iter().flat_map(|group| group.re.into_iter().zip(group.im));
        report(updates, all.map(|(re, im)| Complex64::new(wide(re), wide(im))).collect())
    };
    let [re, im] = &mut field;
    let updates = pass::<T>(set, pass_over, search, &mut drive, [re, im], reported);
    (drive, field, updates)
}

fn check<T: Reference>(set: InstructionSet, lists: &Lists, phases: usize, amplitudes: usize) {
    let candidates = grid(phases, amplitudes);
    let mut fields = vec![vec![Complex64::ZERO; lists.lanes()]];
    let (drive, [re, im], updates) = alone::<T>(set, lists, &candidates, |updates, field| {
        assert_eq!(updates, fields.len());
        fields.push(field);
        true
    });
    assert_eq!(updates, TRANSDUCERS);
    lists.assert_field(&widened(&drive), &re, &im);
    let term = |j: usize, p: Complex64| wide(lists.weight[j]) * T::term(wide(lists.target[j]) - p.norm());
    let silence: f64 = (0..lists.points).map(|j| term(j, Complex64::ZERO)).sum();
    for (&i, pair) in order().iter().zip(fields.windows(2)) {
        let energy = |q: [f32; 2]| -> f64 {
            let q = Complex64::new(wide(q[0]), wide(q[1]));
            (0..lists.points).map(|j| term(j, pair[0][j] + lists.gain(i as usize, j) * q)).sum()
        };
        let q = drive[i as usize];
        // While all pressures are 0 the pass takes phase 0.
        let step = if pair[0].iter().all(|p| p.norm() == 0.0) { phases } else { 1 };
        let all = (0..phases * amplitudes).step_by(step);
        let best = all.map(|k| energy(candidates.drive(k))).fold(f64::INFINITY, f64::min);
        let regret = (energy([q.re, q.im]) - best) / silence;
        assert!(regret < 1e-6, "{set}: M = {}, {amplitudes} x {phases}: {regret:e}", lists.points);
    }
}

#[test]
#[ignore = "slow"]
fn every_update_is_the_best_of_all_candidates() {
    for set in InstructionSet::all() {
        for points in [1, 2, 5, 16, 17, 40] {
            for (phases, amplitudes) in [(16, 1), (7, 3), (51, 5), (64, 1), (100, 4)] {
                for lists in &Batch::new(2, points).problems {
                    check::<L2>(set, lists, phases, amplitudes);
                    check::<L1>(set, lists, phases, amplitudes);
                }
            }
        }
    }
}

#[test]
fn a_report_ends_the_pass() {
    each(|set, batch, _| {
        let (drive, ..) = alone::<L2>(set, &batch.problems[0], &grid(16, 1), |_, _| true);
        let (some, _, updates) = alone::<L2>(set, &batch.problems[0], &grid(16, 1), |updates, _| updates < 7);
        assert_eq!(updates, 7);
        for (k, &i) in order().iter().enumerate() {
            let want = if k < 7 { drive[i as usize] } else { Complex32::ZERO };
            assert_eq!(some[i as usize], want, "{set}: update {k}");
        }
    });
}
