//! The interleaved greedy pass has the same bits as single passes.

use alloc::vec;

use crate::kernels::greedy::candidates::L2;
use crate::kernels::greedy::interleaved_pass::{fits, floats, pass};
use crate::kernels::greedy::large_grid;
use crate::kernels::greedy::point_group::PointGroup;
use crate::kernels::greedy::{Pass, Search, indices};
use crate::kernels::lanes::LANES;
use crate::kernels::tests::batch::{TRANSDUCERS, each, widened};
use crate::kernels::tests::greedy::{alone, grid, order};

#[test]
fn every_lane_has_the_bits_of_its_single_pass() {
    each(|set, batch, points| {
        for (phases, amplitudes) in [(16, 1), (10, 1), (16, 3), (51, 5)] {
            let (candidates, all) = (grid(phases, amplitudes), &batch.all);
            let mut drive = vec![f32::NAN; 2 * LANES * TRANSDUCERS];
            let mut field = [(); 2].map(|()| vec![f32::NAN; all.lanes()]);
            let pass_over = Pass {
                rows: all.rows(),
                target: &all.target,
                weight: &all.weight,
                count: all.lanes(),
                order: &order(),
                groups: &mut vec![PointGroup::default(); points],
                memory: &mut vec![f32::NAN; 4 * all.lanes()],
            };
            let search = Search {
                candidates: &candidates,
                floats: &mut vec![f32::NAN; floats(all.lanes(), &candidates)],
                indices: &mut vec![u32::MAX; indices(LANES, phases)],
            };
            let [re, im] = &mut field;
            pass(set, pass_over, search, batch.problems.len(), &mut drive, [re, im]);
            for (lane, lists) in batch.problems.iter().enumerate() {
                let (single, [re, im], _) = alone::<L2>(set, lists, &candidates, |_, _| true);
                batch.assert_same(lane, &single, [&re, &im], &drive, [&field[0], &field[1]]);
                lists.assert_field(&widened(&single), &re, &im);
            }
        }
    });
}

#[test]
fn only_small_grids_fit() {
    assert!(fits(16, 1) && fits(16, 16) && fits(51, 5));
    assert!(!fits(16, 17) && !fits(large_grid::LARGE, 1) && !fits(256, 16));
}
