//! Soft minimum: a smooth function near the least of some values, and fields that raise it.
//!
//! ```text
//! E = -min x + 1/s ln sum_k e^{-s (x_k - min x)}             x_k in parts of a unit, s the sharpness
//! ```

use crate::math::{exp, log};
use crate::solvers::common::phase_descent::{Cost, PhaseDescent};
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::run::Run;

/// The sharpness s of the minimum in each stage.
const SHARPNESS: [f64; 3] = [10.0, 30.0, 100.0];
/// Largest number of steps in a stage.
const STEPS: usize = 60;

/// A stage ends when a step gains less than this part of the level.
const WORTH: f64 = 1e-4;

/// Returns E of the module's head, the negative soft minimum of some values.
pub(super) fn negated(values: impl Iterator<Item = f64> + Clone, sharpness: f64) -> f64 {
    let (least, sum) = shares(values, sharpness);
    log(sum) / sharpness - least
}

/// Returns the least value, and the sum of all e^{-s (x - min x)}; each term over the sum is the share of a value.
pub(super) fn shares(values: impl Iterator<Item = f64> + Clone, sharpness: f64) -> (f64, f64) {
    let least = values.clone().fold(f64::INFINITY, f64::min);
    (least, values.map(|x| exp(sharpness * (least - x))).sum())
}

/// The cost of a field: E of |P| at the targeted points.
struct Weakest {
    targeted: usize,
    unit: f64,
    sharpness: f64,
}

impl Weakest {
    fn parts<'a>(&self, wave: &'a Wave) -> impl Iterator<Item = f64> + Clone + use<'a> {
        let unit = self.unit;
        wave.moduli[..self.targeted].iter().map(move |&x| f64::from(x) / unit)
    }
}

impl Cost for Weakest {
    fn of(&self, wave: &Wave) -> f64 {
        negated(self.parts(wave), self.sharpness)
    }

    fn pull(&self, wave: &Wave, [re, im]: [&mut [f32]; 2]) {
        let (least, sum) = shares(self.parts(wave), self.sharpness);
        for (k, x) in self.parts(wave).enumerate() {
            let share = exp(self.sharpness * (least - x)) / sum;
            let pull = if x > 0.0 { (-share / (self.unit * self.unit * x)) as f32 } else { 0.0 };
            (re[k], im[k]) = (pull * wave.field[0][k], pull * wave.field[1][k]);
        }
    }
}

/// Raises the soft minimum of the targeted points of `wave`, with growing sharpness.
pub(super) fn raise<'w>(run: &mut Run<'_, '_, 'w>, wave: &mut Wave<'w>) {
    let (rows, work): (&Rows, _) = (run.rows, run.work);
    let unit = f64::from(wave.level(rows));
    if unit.is_nan() || unit <= 0.0 {
        return;
    }
    let cost = |sharpness| Weakest { targeted: rows.targeted, unit, sharpness };
    let begun = core::mem::replace(wave, Wave::new(rows, work));
    let mut descent = PhaseDescent::new(begun, &cost(SHARPNESS[0]), rows, work);
    run.steps += SHARPNESS.len() * STEPS;
    for sharpness in SHARPNESS {
        descent.follow(&cost(sharpness), rows);
        for _ in 0..STEPS {
            let before = descent.cost;
            let lower = !run.stopped && descent.step(&cost(sharpness), rows);
            if !lower || !run.report(&descent.wave) || before - descent.cost < WORTH {
                break;
            }
        }
    }
    *wave = descent.wave;
}
