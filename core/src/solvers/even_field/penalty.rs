//! Penalty: the highest common level of points that nearly depend on each other, with a penalty for uneven fields.
//!
//! ```text
//! maximise F = mean |P| - sum_j (|P_j| - mean |P|)^2 / (2 rho)      rho = r times the level, smaller and smaller
//! y_j = 1/M + (mean |P| - |P_j|)/rho                                the multipliers, of sum 1
//! (J D^-1 J^T + rho (1 + tau)) y' = s - |P|                         the next multipliers; s from sum y' = 1/(1 + tau)
//! d = D^-1 J^T y'                                                   the rotations of the drives
//! ```
//!
//! (quadratic penalty, Nocedal and Wright 2006, chapter 17.1; J and D as in [`crate::solvers::even_field::ascent`].) A
//! step that does not raise F is tried again with a larger tau. rho keeps the matrix regular: its inverse is accurate
//! in f32, where that of the even field itself is noise.

use core::ops::Range;

use crate::error::Error;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::ascent::Metric;
use crate::solvers::even_field::common_level::Newton;
use crate::solvers::even_field::run::Run;
use crate::workspace::Buffer;

/// Values of r (see the module's head). They are used one after another until the points are [`CLOSE`].
const PARTS: [f32; 10] = [1.0, 0.3, 0.1, 0.03, 0.01, 4e-3, 2e-3, 1e-3, 7e-4, 4e-4];
/// The indices of all values of r.
pub(super) const ALL: Range<usize> = 0..PARTS.len();
/// The indices of the first two values of r. After these two, the field shows how loud it will be at the end.
pub(super) const FIRST: Range<usize> = 0..2;
/// The indices of the values of r after [`FIRST`].
pub(super) const REST: Range<usize> = 2..PARTS.len();

/// Points are even if none differs from its target by more than this part of the level. With half of this value, crowded
/// points would lose 2 % of their level.
pub(super) const CLOSE: f32 = 4.8e-3;

/// The largest change of a phase in rad.
const MOST_ROTATION: f32 = 0.5;

/// Largest number of steps for each r.
const STEPS: usize = 60;
/// Part of the level that a step must gain; after a smaller gain the next r follows.
const WORTH: f64 = 1e-5;

/// tau of the first step (see the module's head). A failed step multiplies tau by four and adds this; above [`MOST`] no
/// shorter step is tried.
const TAU: f32 = 0.1;
const MOST: f32 = 1e5;

/// Largest number of steps for all r.
pub(super) const MOST_STEPS: usize = PARTS.len() * STEPS;

/// Returns F of the module's head for the targeted points.
fn merit(rows: &Rows, wave: &Wave, rho: f32) -> f64 {
    let moduli = wave.moduli[..rows.targeted].iter().map(|&x| f64::from(x));
    let mean = moduli.clone().sum::<f64>() / rows.targeted as f64;
    mean - moduli.map(|x| (x - mean) * (x - mean)).sum::<f64>() / (2.0 * f64::from(rho))
}

/// Raises the common level of `wave` with some of the r of [`PARTS`]. All of its points have targets.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn raise<'w>(run: &mut Run<'_, '_, 'w>, parts: Range<usize>, wave: &mut Wave<'w>) -> Result<(), Error> {
    let (rows, work) = (run.rows, run.work);
    let mut newton = Newton::new(run.problem, rows, run.plan.quiet, work, run.control)?;
    let mut trial = Wave::new(rows, work);
    let mut metric = Metric::new(rows, work);
    let mut multipliers = work.floats.take(newton.dual.lanes());
    for &part in &PARTS[parts] {
        let (mut tau, mut fresh) = (TAU, true);
        for _ in 0..STEPS {
            let level = wave.level(rows);
            let rho = part * level;
            if run.stopped || level.is_nan() || level <= 0.0 {
                return Ok(());
            }
            let derived = if fresh {
                for (multiplier, modulus) in multipliers.iter_mut().zip(&wave.moduli[..rows.targeted]) {
                    *multiplier = 1.0 / rows.targeted as f32 + (level - modulus) / rho;
                }
                metric.measure(rows, wave, &multipliers);
                newton.update(rows, wave, Some(&metric.roots), run.control)
            } else {
                Ok(())
            };
            let step = derived.and_then(|()| direction(&mut newton, rows, wave, (rho, tau), &metric.roots, run));
            let found = match step {
                Err(error) if error.is_stop() => {
                    run.stopped = true;
                    return Ok(());
                }
                step => step?,
            };
            let before = merit(rows, wave, rho);
            if found {
                trial.rotate(rows, wave, &newton.rotations, 1.0);
            }
            let gain = merit(rows, &trial, rho) - before;
            fresh = found && gain > 0.0;
            if fresh {
                core::mem::swap(wave, &mut trial);
                tau /= 3.0;
                run.report(wave);
                if gain < WORTH * f64::from(level) {
                    break;
                }
            } else {
                tau = 4.0 * tau + TAU;
                if tau > MOST {
                    break;
                }
            }
        }
        if wave.unevenness(rows, wave.level(rows), 0.0) <= CLOSE {
            break;
        }
    }
    Ok(())
}

/// Writes a step to the rotations. Returns `false` if f32 cannot find one.
fn direction<'w>(
    newton: &mut Newton<'w>,
    rows: &Rows,
    wave: &Wave,
    (rho, tau): (f32, f32),
    roots: &[f32],
    run: &mut Run<'_, '_, 'w>,
) -> Result<bool, Error> {
    let (size, lanes, level) = (newton.dual.size, newton.dual.lanes(), wave.level(rows));
    let Some(cholesky) = newton.dual.factor(|_| rho * (1.0 + tau), run.control)? else { return Ok(false) };
    let [mut next, mut rise]: [Buffer<f32>; 2] = [(); 2].map(|()| run.work.floats.take(lanes));
    rise[..size].fill(1.0);
    next.iter_mut().zip(&wave.moduli[..size]).for_each(|(next, modulus)| *next = level - modulus);
    cholesky.solve(&mut rise);
    cholesky.solve(&mut next);
    let sum = |values: &[f32]| values[..size].iter().map(|&x| f64::from(x)).sum::<f64>();
    let shift = ((1.0 / (1.0 + f64::from(tau)) - sum(&next)) / sum(&rise)) as f32;
    next.iter_mut().zip(&rise[..]).for_each(|(next, rise)| *next += shift * rise);
    newton.dual.back(&next, &mut newton.rotations);
    let finite = newton.rotations.iter().all(|rotation| rotation.is_finite());
    for (rotation, root) in newton.rotations.iter_mut().zip(roots) {
        *rotation = (*rotation * root).clamp(-MOST_ROTATION, MOST_ROTATION);
    }
    Ok(finite)
}
