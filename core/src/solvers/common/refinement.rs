//! Refinement on a board of few phases: a search over the neighbouring codes, one transducer after another.
//!
//! Plain rounding leaves errors that add up at random at the points. The search rotates one transducer after another to
//! the phase that reduces them most. A few rounds remove most of the error.

use crate::kernels;
use crate::kernels::{Candidates, table};
use crate::propagation::field_of;
use crate::solvers::prelude::*;

/// Number of phases tried for each transducer, around its present phase: one lane group. A coarse device has no more
/// phases; on a fine device a rounding error needs fewer.
const WIDTH: usize = 16;

/// Largest number of rounds. In trials (N = 400, M = 16 and 64) a fifth round lowered sigma by less than 3 %.
const ROUNDS: usize = 4;

/// Rounds `drive` (N,) to the device's quantization. Then rotates one transducer after another to the phase of the grid
/// that lowers `sum w (s t - |P|)^2` most; the common level s is estimated again each round. Without phase quantization
/// it only rounds, and without any quantization it does nothing. A drive of 0 stays 0, and amplitudes stay.
///
/// Time O(16 N M) a round and at most four rounds, memory O(M). A stop leaves the drive of that moment, on the grid.
///
/// # Panics
/// If the length of `drive` is not the number of the problem's transducers.
pub fn refine(problem: &Problem, drive: &mut [Complex32], work: &Workspace, control: &mut Control) {
    let propagation = problem.propagation();
    assert_eq!(drive.len(), propagation.transducers(), "one drive a transducer");
    let Some(quantization) = problem.quantization() else { return };
    for q in drive.iter_mut() {
        *q = quantization.nearest(*q);
    }
    let Some(phases) = quantization.phases() else { return };
    let buffers = [table(WIDTH), table(WIDTH), 1].map(|len| work.floats.take(len).into_vec());
    let candidates = Candidates::rotations(phases as usize, WIDTH, buffers);
    let lanes = propagation.lanes();
    let [mut row, mut wave] = [(); 2].map(|()| Planar::zeros(1, lanes, work));
    let [mut modulus, mut targets] = [(); 2].map(|()| work.floats.take(lanes));
    let mut kept = work.points.take(lanes / crate::kernels::lanes::LANES);
    for _ in 0..ROUNDS {
        let Ok(field) = field_of(propagation, drive, work, control) else { break };
        kernels::modulus(propagation.instruction_set(), &field.re, &field.im, &mut modulus);
        let level = common_level(problem, &modulus);
        for (target, requested) in targets.iter_mut().zip(problem.targets()) {
            *target = level * requested;
        }
        kernels::keep(propagation.instruction_set(), [&targets, problem.weights()], field.row(0), &mut kept);
        let mut moved = false;
        for (i, q) in drive.iter_mut().enumerate().filter(|(_, q)| **q != Complex32::ZERO) {
            if control.pulse().is_err() {
                moved = false;
                break;
            }
            propagation.row(i, &mut row.re, &mut row.im);
            let memory = [&mut wave.re[..], &mut wave.im[..]];
            let (set, count) = (propagation.instruction_set(), propagation.points());
            let choice = kernels::rotate(set, row.row(0), [q.re, q.im], &candidates, &mut kept, count, memory);
            if choice > 0 {
                let [re, im] = candidates.drive(choice);
                *q = quantization.nearest(*q * Complex32::new(re, im));
                moved = true;
            }
        }
        if !moved {
            break;
        }
    }
    for buffer in candidates.into_buffers() {
        work.floats.give(buffer);
    }
}

/// Returns s = `sum w t |P| / sum w t^2`: the level at which targets in these ratios fit the moduli best.
fn common_level(problem: &Problem, modulus: &[f32]) -> f32 {
    let points = modulus.iter().zip(problem.targets()).zip(problem.weights());
    let (met, requested) = points.fold((0.0_f64, 0.0_f64), |(met, requested), ((&p, &t), &w)| {
        let [p, t, w] = [p, t, w].map(f64::from);
        (met + w * t * p, requested + w * t * t)
    });
    (met / requested) as f32
}
