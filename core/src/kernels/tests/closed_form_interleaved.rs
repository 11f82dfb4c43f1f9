//! The interleaved sweep has the same bits as single sweeps, and its drives reach the right problems.

use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;

use crate::kernels::closed_form::interleaved_sweep::{deal_out, sweep};
use crate::kernels::closed_form::{MOST, Memory, Sweep, floats};
use crate::kernels::grid::Phases;
use crate::kernels::lanes::LANES;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::batch::{TRANSDUCERS, each, widened};
use crate::kernels::tests::closed_form::{alone, order};

#[test]
fn every_lane_has_the_bits_of_its_single_sweep() {
    each(|set, batch, _| {
        let board = Phases::new(16);
        for (block, phases) in [(1, None), (3, None), (MOST, None), (MOST, Some(&board)), (3, Some(&board))] {
            let all = &batch.all;
            let mut drive = vec![0.0; 2 * LANES * TRANSDUCERS];
            let mut field = [(); 2].map(|()| vec![0.0; all.lanes()]);
            let mut memory = vec![f32::NAN; floats(all.lanes())];
            for own in [0.0, 0.4] {
                let (target, weight) = (&all.target[..], &all.weight[..]);
                let task = Sweep {
                    rows: all.rows(),
                    target,
                    weight,
                    count: all.lanes(),
                    block,
                    own,
                    phases,
                    memory: Memory::of(&mut memory),
                };
                let [re, im] = &mut field;
                sweep(set, task, order(), &mut drive, [re, im]);
            }
            for (lane, lists) in batch.problems.iter().enumerate() {
                let (single, [re, im]) = alone(set, lists, block, phases, |_, _, _| ());
                batch.assert_same(lane, &single, [&re, &im], &drive, [&field[0], &field[1]]);
                lists.assert_field(&widened(&single), &re, &im);
            }
        }
    });
}

#[test]
fn drives_are_copied_to_their_problems() {
    for set in InstructionSet::all() {
        let drive: Vec<f32> = (0..3 * LANES * LANES).map(|k| k as f32).collect();
        let mut out: [Vec<_>; LANES] = from_fn(|_| Vec::new());
        deal_out(set, &drive, &mut out);
        for (lane, drives) in out.iter().enumerate() {
            assert_eq!(drives.len(), 3 * LANES / 2);
            for (i, q) in drives.iter().enumerate() {
                let at = 2 * i * LANES + lane;
                assert_eq!([q.re, q.im], [at as f32, (at + LANES) as f32], "{set}: drive {i} of problem {lane}");
            }
        }
    }
}
