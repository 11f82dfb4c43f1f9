//! Ascent: raises the common level of points that are too close to be independent, while it makes them even.
//!
//! ```text
//! maximise s subject to |P_j| = s t_j,    with Lagrange multipliers y_j, sum_j y_j = 1
//! D_i = Re(q_i sum_j y_j conj(P_j/|P_j|) G_ji)               a rotation d_i of q_i lowers sum_j y_j |P_j| by D_i d_i^2/2
//! (J D^-1 J^T + mu W^-1) y = s t - |P|                       gives the new y; their sum gives s
//! d = D^-1 J^T y                                             the rotations of all drives
//! ```
//!
//! J are the derivatives of the moduli |P_j| by the drives' phases, t the targets and W the weights (sequential
//! quadratic programming, Nocedal and Wright 2006, chapter 18). Where points are a fraction of a wavelength apart, J
//! J^T is singular except for rounding. The shortest step to an even field with a free level
//! ([`crate::solvers::even_field::common_level`]) then follows that noise and loses level. Here the multipliers keep
//! the level high. The damping mu falls slowly from a size at which only the smooth part of a field matters.

use crate::error::Error;
use crate::kernels::tiles;
use crate::math::sqrtf;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::common_level::{MOST_ROTATION, Manner, Newton};
use crate::solvers::even_field::run::Run;
use crate::workspace::{Buffer, Workspace};

/// The course of the damping mu, relative to the mean diagonal entry of J D^-1 J^T, and the end of the ascent.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    /// The damping of the first step.
    damping: f32,
    /// The factor of the damping from step to step.
    shrink: f32,
    /// The least damping. With less damping, a step would follow parts of the field that have no effect, or the noise
    /// of f32.
    least: f32,
    /// Largest number of steps.
    pub(super) steps: usize,
    /// An even field is final once a step promises no more than this part of its level.
    settled: f32,
    /// Function of a level and an allowed leak: returns how the field is made even at the end.
    pub(super) manner: fn(level: f32, quiet: f32) -> Manner,
}

impl Pace {
    /// The pace for crowded targets. With a `shrink` of .85 a line of 33 points loses a tenth of the level; .97 gains
    /// nothing more.
    pub(super) const LOUD: Self =
        Self { damping: 1.0, shrink: 0.93, least: 1e-5, steps: 160, settled: f32::INFINITY, manner: Manner::crowded };

    /// The first quarter of [`Self::LOUD`]. After it the weakest point shows the final level within 3 %.
    pub(super) const FIRST: Self = Self { steps: 40, ..Self::LOUD };

    /// The rest of [`Self::LOUD`]. The damping is then .93^40 of the first one.
    pub(super) const REST: Self = Self { damping: 0.0549, steps: 120, ..Self::LOUD };

    /// The pace for crowded quiet points around a few targets: their equations are many and linear. Beside a disc of
    /// 172 points a least damping of 1e-5 loses 4 % of the level. With 1e-3 the quiet points leak twice as much.
    pub(super) const SILENT: Self =
        Self { damping: 1e-2, shrink: 0.5, least: 1e-4, steps: 22, settled: f32::INFINITY, manner: Manner::silent };

    /// The pace for separate targets whose field is even or nearly even. The damping is so low that steps are not
    /// shortened.
    pub(super) const RISE: Self =
        Self { damping: 1e-6, shrink: 1.0, least: 1e-6, steps: 20, settled: 1e-5, manner: Manner::rising };

    /// The pace for a few separate targets, whose phases still turn while their level hardly rises.
    pub(super) const RISE_OF_FEW: Self = Self { steps: 60, settled: 1e-6, ..Self::RISE };
}

/// Lower bound of the curvature D_i of the module's head, relative to the mean. It limits the rotation of transducers
/// of little effect.
const LEAST_CURVATURE: f32 = 0.1;

/// Raises the level of `wave`, and makes it as even as the last damping allows.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn climb<'w>(run: &mut Run<'_, '_, 'w>, pace: Pace, wave: &mut Wave<'w>) -> Result<(), Error> {
    let (rows, work) = (run.rows, run.work);
    let mut newton = Newton::new(run.problem, rows, run.plan.quiet, work, run.control)?;
    let mut trial = Wave::new(rows, work);
    let mut metric = Metric::new(rows, work);
    let size = newton.dual.size;
    let mut multipliers = work.floats.take(newton.dual.lanes());
    multipliers[..rows.targeted].fill(1.0 / rows.targeted as f32);
    let (mut damping, mut promised) = (pace.damping, f32::INFINITY);
    for _ in 0..pace.steps {
        let level = wave.level(rows);
        let settled = promised <= pace.settled * level;
        if run.stopped || settled && wave.unevenness(rows, level, run.plan.quiet) <= run.plan.tolerance {
            break;
        }
        metric.measure(rows, wave, &multipliers);
        let factor = match newton.update(rows, wave, Some(&metric.roots), run.control) {
            Ok(()) => newton.factored(rows, damping, run.control),
            Err(error) => Err(error),
        };
        let (cholesky, rise) = match factor {
            Err(error) if error.is_stop() => {
                run.stopped = true;
                break;
            }
            Ok(None) => {
                damping *= 10.0;
                continue;
            }
            factor => factor?.expect("a factor"),
        };
        let mut new = work.floats.take(rise.len());
        for (k, new) in new.iter_mut().enumerate().take(size) {
            *new = newton.missing(rows, wave, k, level);
        }
        cholesky.solve(&mut new);
        let sum = |values: &[f32]| values[..rows.targeted].iter().map(|&x| f64::from(x)).sum::<f64>();
        let shift = ((1.0 - sum(&new)) / sum(&rise)) as f32;
        new.iter_mut().zip(&rise).for_each(|(new, rise)| *new += shift * rise);
        newton.dual.back(&new, &mut newton.rotations);
        newton.rotations.iter_mut().zip(&metric.roots).for_each(|(rotation, root)| *rotation *= root);
        let most = newton.rotations.iter().fold(0.0_f32, |most, rotation| most.max(rotation.abs()));
        if !most.is_finite() {
            break;
        }
        let part = (MOST_ROTATION / most).min(1.0);
        trial.rotate(rows, wave, &newton.rotations, part);
        if !trial.level(rows).is_finite() || !shift.is_finite() {
            break;
        }
        promised = shift;
        core::mem::swap(wave, &mut trial);
        for (multiplier, new) in multipliers.iter_mut().zip(&new) {
            *multiplier += part * (new - *multiplier);
        }
        damping = (pace.shrink * damping).max(pace.least);
        run.report(wave);
    }
    Ok(())
}

/// D^-1/2 of every transducer, see the module's head.
pub(super) struct Metric<'w> {
    pub(super) roots: Buffer<'w, f32>,
    /// y_j P_j/|P_j| over the rows j, with the multipliers y of the module's head.
    pulls: [Buffer<'w, f32>; 2],
    /// sum_j conj(G_ji) y_j P_j/|P_j| over the transducers i.
    sums: [Buffer<'w, f32>; 2],
}

impl<'w> Metric<'w> {
    pub(super) fn new(rows: &Rows, work: &'w Workspace) -> Self {
        Self {
            roots: work.floats.take(rows.lanes),
            pulls: [(); 2].map(|()| work.floats.take(rows.count)),
            sums: [(); 2].map(|()| work.floats.take_any(rows.lanes)),
        }
    }

    pub(super) fn measure(&mut self, rows: &Rows, wave: &Wave, multipliers: &[f32]) {
        for k in 0..rows.targeted {
            let part = if wave.moduli[k] > 0.0 { multipliers[k] / wave.moduli[k] } else { 0.0 };
            (self.pulls[0][k], self.pulls[1][k]) = (part * wave.field[0][k], part * wave.field[1][k]);
        }
        let ([pull_re, pull_im], [re, im]) = (&self.pulls, &mut self.sums);
        tiles::correlate(rows.set, rows.tiles(), [pull_re, pull_im], [&mut *re, &mut *im]);
        let curvature = |i: usize| wave.drive[0][i] * re[i] + wave.drive[1][i] * im[i];
        let mut mean = 0.0;
        for i in 0..rows.lanes {
            self.roots[i] = curvature(i).abs();
            mean += self.roots[i] / rows.lanes as f32;
        }
        let least = (LEAST_CURVATURE * mean).max(f32::MIN_POSITIVE);
        self.roots.iter_mut().for_each(|root| *root = 1.0 / sqrtf(root.max(least)));
    }
}
