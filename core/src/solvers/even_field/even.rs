//! Even: the shortest steps to |P_j| = s t_j, the level s free or given, until every point is even enough.
//!
//! These are Gauss-Newton steps in the dual ([`crate::solvers::even_field::newton`]).

use crate::prelude::*;
use crate::solvers::common::tiled::Wave;
use crate::solvers::even_field::newton::{DAMPING, FREE, Factor, Level, Newton};
use crate::solvers::even_field::run::Run;

/// Largest number of steps for separate points. Four suffice where the points are fewer than a quarter of the
/// transducers, ten where they are half as many.
pub(super) const MOST_STEPS: usize = 20;

/// Damping of the first step for crowded points.
const CROWDED_DAMPING: f32 = 1e-3;

/// With crowded quiet points, the field is even if no point differs from its target by more than this part of the level.
const SILENT: f32 = 1e-4;

/// Largest number of successive steps between crowded points that leave more than half of the squared error. After so
/// many slow steps, the following steps are slow, too.
const PATIENCE: usize = 6;

/// The Jacobian is used again after a step that leaves less than this part of the squared error, because computing it
/// takes most of a step's time.
const SLOW: f64 = 0.01;

/// The largest change of a phase in rad: beyond it |P| is no longer near its tangent.
pub(super) const MOST_ROTATION: f32 = 1.0;

/// An equation depends on earlier ones if these leave less than this part of its diagonal entry of J J^T.
const DEPENDENT: f32 = 0.5;

/// The outcome of [`polish`].
pub(super) struct Polish {
    /// Whether the wave is even to the plan's tolerance.
    pub(super) even: bool,
    /// Number of targeted points that depended on others at the first step, see [`DEPENDENT`].
    pub(super) dependent: usize,
}

/// Parameters of [`polish`].
#[derive(Clone, Copy)]
pub(super) struct Manner {
    /// The level; `None` for the level of the shortest step.
    level: Option<f32>,
    /// Damping of the first step, relative to the mean diagonal entry of J J^T.
    damping: f32,
    /// The least damping, relative to the mean diagonal entry of J J^T.
    least: f32,
    /// The largest deviation that counts as even, if it is larger than the plan's.
    tolerance: f32,
    /// Largest number of steps.
    most: usize,
    /// Largest number of successive steps with little gain.
    patience: usize,
}

impl Manner {
    /// Returns the parameters for separate points and a given level; `None` selects the level of the shortest step.
    pub(super) fn separate(level: Option<f32>) -> Self {
        Self { level, damping: DAMPING, least: 0.0, tolerance: 0.0, most: MOST_STEPS, patience: MOST_STEPS }
    }

    /// Returns the parameters for crowded points and a given level. High damping makes the smooth part of the field even
    /// first.
    pub(super) fn crowded(level: f32) -> Self {
        let (most, patience) = (2 * MOST_STEPS, PATIENCE);
        Self { level: Some(level), damping: CROWDED_DAMPING, least: 0.0, tolerance: 0.0, most, patience }
    }

    /// Returns the parameters for crowded quiet points and a given level. A quiet point may leak up to the part `quiet` of
    /// this level.
    pub(super) fn silent(level: f32, quiet: f32) -> Self {
        Self { least: quiet * quiet, tolerance: SILENT, patience: 2 * MOST_STEPS, ..Self::crowded(level) }
    }
}

/// Makes the points of `wave` equally loud, relative to their targets.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn polish<'w>(run: &mut Run<'_, '_, 'w>, manner: Manner, wave: &mut Wave<'w>) -> Result<Polish, Error> {
    let Manner { level, mut damping, least, tolerance, most, patience } = manner;
    let (rows, work) = (run.rows, run.work);
    let mut newton = Newton::new(run.problem, rows, run.plan.quiet, work, run.control)?;
    let [mut trial, mut begun] = [(); 2].map(|()| Wave::new(rows, work));
    begun.copy(wave);
    let mut factor: Option<Factor> = None;
    let (mut even, mut dependent) = (false, None);
    let (mut renew, mut fresh, mut slow) = (true, false, 0);
    for step in 0..=most {
        let level_here = |wave: &Wave| level.unwrap_or_else(|| wave.level(rows));
        even = wave.unevenness(rows, level_here(wave), run.plan.quiet) <= run.plan.tolerance.max(tolerance);
        if even || run.stopped || step == most || slow > patience {
            break;
        }
        let before = newton.cost(rows, wave, level_here(wave));
        if renew {
            (fresh, factor) = (true, None);
            let updated = newton.update(rows, wave, None, run.control);
            if run.unless_stopped(updated)?.is_none() {
                break;
            }
        }
        if factor.is_none() {
            let factored = newton.factored(rows, damping, run.control);
            let Some(new) = run.unless_stopped(factored)? else { break };
            factor = new;
        }
        let mut after = f64::INFINITY;
        if let Some(factor) = &factor {
            dependent.get_or_insert_with(|| newton.dual.dependent(&factor.0, rows.targeted, DEPENDENT));
            let multipliers = newton.multipliers(rows, wave, factor, level.map_or(FREE, Level::Given));
            let longest = newton.turn(&multipliers, None);
            if longest.is_finite() {
                trial.rotate(rows, wave, &newton.rotations, (MOST_ROTATION / longest).min(1.0));
                after = newton.cost(rows, &trial, level_here(&trial));
            }
        }
        slow = if after < 0.5 * before { 0 } else { slow + 1 };
        if after < before {
            core::mem::swap(wave, &mut trial);
            damping = (0.1 * damping).max(least);
            renew = after > SLOW * before;
            fresh = false;
        } else {
            // If a step with an old Jacobian failed, the Jacobian is computed again before the damping is changed.
            (renew, damping) = if fresh { (false, 10.0 * damping) } else { (true, damping) };
            factor = None;
        }
        run.report(wave);
    }
    // The transducers cannot make so many points even: the result is no weaker than the start, unless there are quiet
    // points.
    if !even && rows.targeted == rows.order.len() && wave.lowest(rows) < begun.lowest(rows) {
        core::mem::swap(wave, &mut begun);
    }
    Ok(Polish { even, dependent: dependent.unwrap_or(0) })
}
