//! The last step of a solver that cares for evenness on a device of few phases: a brute-force search on its grid.
//!
//! Plain rounding leaves errors that add up at random at the points. Turning one transducer after another to the
//! phase that best undoes them takes most of that back within a few rounds.

use core::array::from_fn;

use num_complex::Complex32;

use crate::kernels::{self, LANES, Lanes};
use crate::linalg::Planar;
use crate::math::{cos, sin, sqrtf};
use crate::problem::Problem;
use crate::workspace::Workspace;

/// Rounds at most. In trials (N = 400, M = 16 and 64) the fifth took less than 3 % off sigma.
const ROUNDS: usize = 4;

/// Brings `drive` (N,) to the device's levels and turns one transducer after another to the phase of the grid that
/// lowers `sum w (s t - |P|)^2` most, the common level s estimated anew each round. Without phase levels it rounds
/// (or, without any, does nothing). A drive of 0 stays 0, amplitudes stay.
///
/// Tried are the 16 phases around the present one: all of a coarse device, and on a fine one more than any rounding asks
/// for. Time O(16 N M) a round and at most four rounds, memory O(M).
///
/// # Panics
/// If `drive` has another length than the problem has transducers.
pub fn refine(problem: &Problem, drive: &mut [Complex32], work: &mut Workspace) {
    let gains = problem.gains();
    assert_eq!(drive.len(), gains.transducers(), "one drive a transducer");
    let Some(levels) = gains.levels() else { return };
    for q in drive.iter_mut() {
        *q = levels.nearest(*q);
    }
    let Some(phases) = levels.phases() else { return };
    let turns = Turns::new(phases);
    let [mut row, mut field] = [(); 2].map(|()| Planar::zeros(1, gains.lanes(), work));
    let [mut modulus, mut targets] = [(); 2].map(|()| work.floats.take(gains.lanes()));
    for (i, q) in drive.iter().enumerate() {
        gains.row(i, &mut row.re, &mut row.im);
        kernels::accumulate(row.row(0), [q.re, q.im], &mut field.re, &mut field.im);
    }
    for _ in 0..ROUNDS {
        kernels::modulus(&field.re, &field.im, &mut modulus);
        let level = common_level(problem, &modulus);
        for (target, asked) in targets.iter_mut().zip(problem.targets()) {
            *target = level * asked;
        }
        let mut moved = false;
        for (i, q) in drive.iter_mut().enumerate().filter(|(_, q)| **q != Complex32::ZERO) {
            gains.row(i, &mut row.re, &mut row.im);
            // The field without this transducer, and what it adds as it stands.
            kernels::accumulate(row.row(0), [-q.re, -q.im], &mut field.re, &mut field.im);
            for (re, im) in row.re.iter_mut().zip(&mut row.im) {
                let part = Complex32::new(*re, *im) * *q;
                (*re, *im) = (part.re, part.im);
            }
            kernels::modulus(&field.re, &field.im, &mut modulus);
            let asked = targets.iter().zip(problem.weights()).take(gains.points());
            let [re, im] = turns.best(&field, &modulus, &row, asked);
            kernels::accumulate(row.row(0), [re, im], &mut field.re, &mut field.im);
            if [re, im] != [1.0, 0.0] {
                *q = levels.nearest(*q * Complex32::new(re, im));
                moved = true;
            }
        }
        if !moved {
            break;
        }
    }
    for planar in [row, field] {
        planar.give(work);
    }
    work.floats.give_all([modulus, targets]);
}

/// Turns by 0, 1, -1, 2, -2 and so on steps of a device's phase: a turn a lane. A device of fewer phases meets some twice.
struct Turns {
    re: Lanes,
    im: Lanes,
}

impl Turns {
    fn new(phases: u32) -> Self {
        let angle = |k: usize| {
            let steps = k.div_ceil(2) as f64 * if k % 2 == 1 { 1.0 } else { -1.0 };
            core::f64::consts::TAU * steps / f64::from(phases)
        };
        Self { re: from_fn(|k| cos(angle(k)) as f32), im: from_fn(|k| sin(angle(k)) as f32) }
    }

    /// The turn of `part` that, added to `rest`, lowers `sum w (t - |P|)^2` most; none if none does by more than rounding.
    /// `alone` is |rest|, `asked` the targets and weights.
    fn best<'a>(
        &self,
        rest: &Planar,
        alone: &[f32],
        part: &Planar,
        asked: impl Iterator<Item = (&'a f32, &'a f32)>,
    ) -> [f32; 2] {
        let mut energy = [0.0; LANES];
        let mut rounding = 0.0;
        for (j, (&target, &weight)) in asked.enumerate() {
            let (gr, gi, pr, pi) = (part.re[j], part.im[j], rest.re[j], rest.im[j]);
            let old = alone[j];
            for k in 0..LANES {
                let x = pr + (gr * self.re[k] - gi * self.im[k]);
                let y = pi + (gr * self.im[k] + gi * self.re[k]);
                // Relative to silence of this transducer: differences of large numbers would lose their digits.
                let rise = sqrtf(x * x + y * y) - old;
                energy[k] += weight * (rise * (rise - 2.0 * (target - old)));
            }
            rounding = f32::max(rounding, weight * (target + old) * (gr.abs() + gi.abs()));
        }
        let tolerance = 1e-6 * rounding;
        let better = |best: usize, k: usize| if energy[k] < energy[best] - tolerance { k } else { best };
        let best = (1..LANES).fold(0, better);
        [self.re[best], self.im[best]]
    }
}

/// s = `sum w t |P| / sum w t^2`: the level at which targets in these ratios fit the moduli best.
fn common_level(problem: &Problem, modulus: &[f32]) -> f32 {
    let points = modulus.iter().zip(problem.targets()).zip(problem.weights());
    let (met, asked) = points.fold((0.0_f64, 0.0_f64), |(met, asked), ((&p, &t), &w)| {
        let [p, t, w] = [p, t, w].map(f64::from);
        (met + w * t * p, asked + w * t * t)
    });
    (met / asked) as f32
}
