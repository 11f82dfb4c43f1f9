//! Weighted Gerchberg-Saxton sweeps (Di Leonardo et al. 2007) with |q| = 1 and over-relaxed point phases.

use crate::math::sqrtf;
use crate::solvers::common::alternating_projection::Projector;
use crate::solvers::common::tiled::Wave;
use crate::solvers::even_field::run::Run;
use crate::solvers::even_field::starts::Starts;

/// The part of a point's own contribution that is removed from its field before its phase is read. The own contribution
/// only repeats the old phase. In trials .8 is best or near the best from 4 to 64 points.
const RELAXATION: f32 = 0.8;

/// The largest factor of a weight in a sweep. Without this limit, two or three points would alternate.
const MOST_CHANGE: f32 = 2.0;

/// Sweeps end when no point is off the level by more than [`EVEN`] of it, and the level is at most this multiple of the last
/// sweep's. Points of a regular set are even from the first sweep on, while their level still rises.
const SETTLED: f32 = 1.001;
const EVEN: f32 = 0.03;

/// Does sweeps from a start; leaves in `wave` the field whose weakest point is strongest.
pub(super) fn raise<'w>(run: &mut Run<'_, '_, 'w>, starts: &Starts, start: usize, wave: &mut Wave<'w>) {
    let (rows, work, targeted) = (run.rows, run.work, run.rows.targeted);
    let mut weights = work.floats.take(targeted);
    weights.copy_from_slice(&starts.weights);
    let strongest = weights.iter().copied().fold(0.0, f32::max);
    let mut phasors = [0, 1].map(|plane| {
        let mut own = work.floats.take(targeted);
        own.copy_from_slice(&starts.phasors[plane][start * targeted..(start + 1) * targeted]);
        own
    });
    let mut projector = Projector::new(rows, work);
    let echo = RELAXATION * starts.echoes[start];
    let mut trial = Wave::new(rows, work);
    let mut last = 0.0;
    let given = run.problem.start_drive();
    if let Some(drive) = given {
        wave.play_at_full(rows, drive.iter().copied());
    }
    for sweep in 0..=run.plan.sweeps {
        for (wanted, phasors) in projector.wanted.iter_mut().zip(&phasors) {
            for ((wanted, phasor), weight) in wanted.iter_mut().zip(phasors).zip(&weights) {
                *wanted = weight * phasor;
            }
        }
        projector.project(rows, &mut trial);
        let level = trial.level(rows);
        let settled = !run.plan.wide && trial.unevenness(rows, level, f32::INFINITY) <= EVEN && level <= SETTLED * last;
        let mut largest = 0.0_f32;
        for k in 0..targeted {
            let modulus = trial.moduli[k];
            let mut change = MOST_CHANGE;
            if modulus > 0.0 {
                change = (level / modulus).clamp(1.0 / MOST_CHANGE, MOST_CHANGE);
                let (re, im) = (trial.field[0][k] / modulus, trial.field[1][k] / modulus);
                let (re, im) = (re - echo * phasors[0][k], im - echo * phasors[1][k]);
                let length = sqrtf(re * re + im * im);
                // The own contribution is at most RELAXATION of the whole, so the length is not 0.
                (phasors[0][k], phasors[1][k]) = (re / length, im / length);
            }
            weights[k] *= change;
            largest = largest.max(weights[k]);
        }
        for weight in &mut weights {
            *weight *= strongest / largest;
        }
        if (sweep == 0 && given.is_none()) || trial.lowest(rows) > wave.lowest(rows) {
            core::mem::swap(&mut trial, wave);
        }
        if !run.report(wave) || settled {
            break;
        }
        last = level;
    }
}
