//! Traps of which nothing is asked: phases turned until the softest of all is as stiff as can be.
//!
//! What is raised is the soft minimum ([`soft_minimum`]) of K_ja, the stiffness at point j along its axis a, over the least at
//! first.
//!
//! Equal foci are not equal traps: each lies in the others' waves, and across the boards' axis traps are a tenth as stiff as
//! along it. Along x and y foci cannot be told from one another, so that their levels alone bring no more than nine tenths of
//! what direct optimisation finds; from the foci a few steps of [`crate::solvers::common::phase_descent`] bring 96 %.

use alloc::vec::Vec;

use crate::error::Error;
use crate::kernels::propagate::rows;
use crate::math;
use crate::propagation::stiffness::Stiffness;
use crate::scene::{Aim, Signature};
use crate::solvers::common::phase_descent::{Cost, PhaseDescent};
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::run::Run;
use crate::solvers::even_field::soft_minimum;

/// How sharp the minimum is, one after the other, and steps of each: twice the steps bring 1 % more.
const SHARPNESS: [f64; 2] = [8.0, 32.0];
const STEPS: usize = 20;

/// The least stiffness counts as this part of the largest at least: soft traps become stiff, and none is divided by.
const LEAST: f64 = 0.01;

/// The softest of all traps, negated: smooth, and in parts of `unit`.
struct Softest<'a> {
    stiffness: &'a Stiffness,
    sharpness: f64,
    unit: f64,
}

impl Softest<'_> {
    fn parts(&self, wave: &Wave) -> Vec<f64> {
        stiffness(self.stiffness, wave).iter().map(|k| k / self.unit).collect()
    }
}

impl Cost for Softest<'_> {
    fn of(&self, wave: &Wave) -> f64 {
        soft_minimum::negated(self.parts(wave).iter().copied(), self.sharpness)
    }

    fn pull(&self, wave: &Wave, pulls: [&mut [f32]; 2]) {
        let parts = self.parts(wave);
        let (least, sum) = soft_minimum::shares(parts.iter().copied(), self.sharpness);
        let share = |k: &f64| math::exp(self.sharpness * (least - k)) / (-self.unit * sum);
        let weights: Vec<f64> = parts.iter().map(share).collect();
        self.stiffness.pull(wave.field.each_ref().map(|plane| &plane[..]), &weights, pulls);
    }
}

/// Makes the wave of even foci that of equal traps where the problem is one of traps and asks for no pressures. Returns
/// whether it did; after a stop the foci stay.
///
/// # Errors
/// More memory than allowed.
pub(super) fn stiffen(run: &mut Run, foci: &mut Wave) -> Result<bool, Error> {
    match if run.stopped { Ok(false) } else { descend(run, foci) } {
        Err(Error::Stopped) => {
            run.stopped = true;
            Ok(false)
        }
        stiffened => stiffened,
    }
}

// Inlined it would enlarge the stack of every solve.
#[inline(never)]
fn descend(run: &mut Run, foci: &mut Wave) -> Result<bool, Error> {
    let (problem, work) = (run.problem, run.work);
    let trapping = problem.aim() == Aim::Max && !problem.asks_pressures() && !problem.has_start();
    let kept = problem.propagation().origin().and_then(|(_, _, kept)| kept);
    let Some(kept) = kept.filter(|kept| trapping && kept.signature == Some(Signature::Trap)) else {
        return Ok(false);
    };
    let Some(traps) = (kept.make.stiffness)(kept, run.control)? else { return Ok(false) };
    let (set, transducers) = (run.rows.set, problem.propagation().transducers());
    let [re, im] = traps.planes();
    let order = work.counting(traps.rows());
    let rows = Rows::packed(set, rows::Rows::Stored { re, im }, transducers, order, work, run.control)?;
    let mut wave = Wave::new(&rows, work);
    wave.play_at_full(&rows, foci.drives(transducers, work).into_iter());
    let first = stiffness(&traps, &wave);
    let cost = |now: &[f64], sharpness: f64| {
        let largest = now.iter().fold(0.0, |most: f64, k| most.max(k.abs()));
        Softest { stiffness: &traps, sharpness, unit: least(now).max(LEAST * largest).max(f64::MIN_POSITIVE) }
    };
    let mut descent = PhaseDescent::new(wave, &cost(&first, SHARPNESS[0]), &rows, work);
    for sharpness in SHARPNESS {
        let cost = cost(&stiffness(&traps, &descent.wave), sharpness);
        descent.follow(&cost, &rows);
        for _ in 0..STEPS {
            if run.stopped || !run.report(foci) || !descent.step(&cost, &rows) {
                break;
            }
        }
    }
    if least(&stiffness(&traps, &descent.wave)) <= least(&first) {
        return Ok(false);
    }
    let mut drive = descent.wave.drives(transducers, work);
    if let Some(quantization) = problem.quantization() {
        // What is lost at single points is a hundredth, even on ten phases.
        quantization.grid().round(set, 1.0, [1.0; 2], &mut drive);
    }
    foci.play(run.rows, drive.into_iter());
    Ok(true)
}

/// K of all points and their axes.
fn stiffness(traps: &Stiffness, wave: &Wave) -> Vec<f64> {
    traps.at(wave.field.each_ref().map(|plane| &plane[..])).collect()
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}
