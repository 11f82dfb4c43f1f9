//! The closed-form sweep compared with its formula in f64, block by block.

use alloc::vec;
use alloc::vec::Vec;

use num_complex::{Complex32, Complex64};

use crate::kernels::closed_form::{MOST, Memory, Sweep, floats, sweep};
use crate::kernels::grid::Phases;
use crate::kernels::lanes::LANES;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::batch::{Batch, Lists, TRANSDUCERS, each, widened};
use crate::kernels::tests::wide;

/// Runs two sweeps of one problem, with continuous phases or a board's. Calls `report` with the number of the sweep, of
/// the block and the pressures after it.
pub(super) fn alone(
    set: InstructionSet,
    lists: &Lists,
    block: usize,
    phases: Option<&Phases>,
    mut report: impl FnMut(usize, usize, [&[f32]; 2]),
) -> (Vec<Complex32>, [Vec<f32>; 2]) {
    let mut drive = vec![Complex32::ZERO; TRANSDUCERS];
    let mut field = [(); 2].map(|()| vec![0.0; lists.lanes()]);
    let mut memory = vec![f32::NAN; floats(lists.lanes())];
    for (round, own) in [0.0, 0.4].into_iter().enumerate() {
        let (target, weight) = (&lists.target[..], &lists.weight[..]);
        let task = Sweep {
            rows: lists.rows(),
            target,
            weight,
            count: lists.points,
            block,
            own,
            phases,
            memory: Memory::of(&mut memory),
        };
        let mut count = 0;
        let reported = |pressures: [&[f32]; 2]| {
            report(round, count, pressures);
            count += 1;
            true
        };
        let [re, im] = &mut field;
        assert!(sweep(set, task, order(), &mut drive, [re, im], reported));
    }
    (drive, field)
}

pub(super) fn order() -> impl Iterator<Item = usize> {
    (0..TRANSDUCERS).rev()
}

#[test]
fn every_block_takes_the_phases_of_the_formula() {
    for set in InstructionSet::all() {
        for points in [1, 2, 5, 16, 17, 40] {
            for block in [1, 3, MOST] {
                let lists = &Batch::new(1, points).problems[0];
                let mut fields = Vec::new();
                alone(set, lists, block, None, |_, _, [re, im]| {
                    let pairs = re.iter().zip(im);
                    fields.push(pairs.map(|(&re, &im)| Complex64::new(wide(re), wide(im))).collect::<Vec<_>>());
                });
                let mut before = vec![Complex64::ZERO; lists.lanes()];
                let mut drive = vec![Complex64::ZERO; TRANSDUCERS];
                let order: Vec<usize> = order().collect();
                let blocks = order.chunks(block).map(|block| (0.0, block)).chain(order.chunks(block).map(|b| (0.4, b)));
                for ((own, members), after) in blocks.zip(&fields) {
                    let mut moved = vec![Complex64::ZERO; points];
                    let mut allowed = 0.0;
                    for &i in members {
                        let (mut z, mut size) = (Complex64::ZERO, 0.0);
                        for j in 0..points {
                            let (g, p, t) = (lists.gain(i, j), before[j], wide(lists.target[j]));
                            let phase = if p.norm() == 0.0 { 1.0.into() } else { p / p.norm() };
                            let w = wide(lists.weight[j]);
                            z += w * (g.conj() * (phase * t - p) + f64::from(own as f32) * g.norm_sqr() * drive[i]);
                            size += w * g.norm() * (t + p.norm() + 1.0);
                        }
                        let change = z / z.norm() - drive[i];
                        // The allowed error: some ten roundings of each term and of the sum, and those of adding a
                        // wave.
                        allowed += 2e-6 * (size / z.norm() + 1.0);
                        drive[i] += change;
                        (0..points).for_each(|j| moved[j] += lists.gain(i, j) * change);
                    }
                    for j in 0..points {
                        let miss = (before[j] + moved[j] - after[j]).norm();
                        let allowed = 1.5 * allowed + 1e-6 * after[j].norm();
                        assert!(miss <= allowed, "{set}: M = {points}, block {block}: {miss:e} > {allowed:e}");
                    }
                    before.clone_from(after);
                }
            }
        }
    }
}

#[test]
fn drives_are_unit_phasors_and_the_field_is_theirs() {
    each(|set, batch, _| {
        for lists in &batch.problems {
            let (drive, [re, im]) = alone(set, lists, MOST, None, |_, _, _| ());
            for q in &drive {
                assert!((q.norm() - 1.0).abs() < 1e-6, "{set}: |q| = {}", q.norm());
            }
            lists.assert_field(&widened(&drive), &re, &im);
            assert!(re[lists.points..].iter().chain(&im[lists.points..]).all(|&x| x == 0.0), "padding sounds");
        }
    });
}

#[test]
fn a_transducer_without_gain_has_no_phase_and_a_report_ends_the_sweep() {
    for set in InstructionSet::all() {
        let (target, weight) = (vec![1.0; LANES], vec![1.0; LANES]);
        let deaf = vec![0.0; 3 * LANES];
        let mut gain = deaf.clone();
        gain[LANES] = 2.0;
        let rows = super::super::Rows::Stored { re: &gain, im: &deaf };
        let run = |block: usize, goes_on: bool| {
            let mut drive = vec![Complex32::ZERO; 3];
            let mut memory = vec![f32::NAN; floats(LANES)];
            let task = Sweep {
                rows,
                target: &target,
                weight: &weight,
                count: LANES,
                block,
                own: 0.0,
                phases: None,
                memory: Memory::of(&mut memory),
            };
            let mut field = [[0.0; LANES]; 2];
            let [re, im] = &mut field;
            let ended = sweep(set, task, 0..3, &mut drive, [re, im], |_| goes_on);
            (ended, drive, field[0][0])
        };
        let (ended, drive, field) = run(3, true);
        assert!(ended && drive[0].norm() + drive[2].norm() == 0.0, "{set}: {drive:?}");
        assert!((drive[1] - 1.0).norm() < 2e-7 && (field - 2.0).abs() < 4e-7, "{set}: {drive:?} {field}");
        assert_eq!(run(1, false), (false, vec![Complex32::ZERO; 3], 0.0), "{set}");
    }
}

#[test]
fn on_a_board_every_drive_has_one_of_its_phases_and_the_field_is_theirs() {
    const COUNT: f64 = 32.0;
    let phases = Phases::new(COUNT as u32);
    for set in InstructionSet::all() {
        for points in [1, 3, 4, 7, 16, 40] {
            let lists = &Batch::new(1, points).problems[0];
            let (free, board) =
                (alone(set, lists, 1, None, |_, _, _| ()), alone(set, lists, 1, Some(&phases), |_, _, _| ()));
            for (i, q) in board.0.iter().enumerate() {
                let code = f64::from(q.im).atan2(f64::from(q.re)) * COUNT / core::f64::consts::TAU;
                assert!(q.norm() == 0.0 || (code - code.round()).abs() < 1e-5, "{set}: drive {i} is {q}");
                assert_eq!(q.norm() == 0.0, free.0[i].norm() == 0.0, "{set}: drive {i}");
            }
            lists.assert_field(&widened(&board.0), &board.1[0], &board.1[1]);
        }
    }
}
