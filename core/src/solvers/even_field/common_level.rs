//! Gauss-Newton steps on |P_j| = s t_j, the level s free or given, until every point is even enough.
//!
//! J are the derivatives of the moduli |P| by the drives' phases, t the targets, W the weights, mu the damping. The
//! shortest step that meets a level s is d = J^T y with (J J^T + mu W^-1) y = s t - |P|. This is an M x M system for M
//! points, however many transducers there are.
//! The free level is the one with the shortest step. A quiet point has two rows, Re P = Im P = 0; a point of large
//! weight is damped less.

use crate::control::Control;
use crate::error::Error;
use crate::linalg::Cholesky;
use crate::problem::Problem;
use crate::solvers::common::gauss_newton::Dual;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::run::Run;
use crate::workspace::{Buffer, Workspace};

/// Largest number of steps for separate points. Four suffice where the points are fewer than a quarter of the
/// transducers, ten where they are half as many.
pub(super) const MOST_STEPS: usize = 20;

/// Damping of the first step for separate points.
const DAMPING: f32 = 1e-6;

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

/// The part of the allowed leak at which a step aims for the quiet points. The rest is for points between those that
/// are made silent, and for the error of a step.
const WITHIN: f32 = 0.3;

/// Weights below this count as 0.
const LEAST_WEIGHT: f32 = 1e-6;

/// The outcome of [`polish`].
pub(super) struct Polish {
    /// Whether the wave is even to the plan's tolerance.
    pub(super) even: bool,
    /// Number of targeted points that depended on others at the first step, see [`DEPENDENT`].
    pub(super) dependent: usize,
}

/// An equation depends on earlier ones if these leave less than this part of its diagonal entry of J J^T.
const DEPENDENT: f32 = 0.5;

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
    pub(super) fn crowded(level: f32, _quiet: f32) -> Self {
        Self {
            level: Some(level),
            damping: CROWDED_DAMPING,
            least: 0.0,
            tolerance: 0.0,
            most: 2 * MOST_STEPS,
            patience: PATIENCE,
        }
    }

    /// Returns the parameters for separate points after an ascent. The level is the one of the shortest step.
    pub(super) fn rising(_level: f32, _quiet: f32) -> Self {
        Self::separate(None)
    }

    /// Returns the parameters for crowded quiet points and a given level. A quiet point may leak up to the part `quiet` of
    /// this level.
    pub(super) fn silent(level: f32, quiet: f32) -> Self {
        Self {
            level: Some(level),
            damping: CROWDED_DAMPING,
            least: quiet * quiet,
            tolerance: SILENT,
            most: 2 * MOST_STEPS,
            patience: 2 * MOST_STEPS,
        }
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
    let mut even = false;
    let (mut renew, mut fresh, mut slow) = (true, false, 0);
    for step in 0..=most {
        let level_here = |wave: &Wave| level.unwrap_or_else(|| wave.level(rows));
        even = wave.unevenness(rows, level_here(wave), run.plan.quiet) <= run.plan.tolerance.max(tolerance);
        if even || run.stopped || step == most || slow > patience {
            break;
        }
        fresh |= renew;
        let before = newton.cost(rows, wave, level_here(wave));
        let renewed = if renew { newton.update(rows, wave, None, run.control) } else { Ok(()) };
        let tried = match renewed.and_then(|()| newton.step(rows, wave, level, damping, &mut trial, run.control)) {
            // A step that a stop interrupts does not count.
            Err(error) if error.is_stop() => {
                run.stopped = true;
                break;
            }
            tried => tried?,
        };
        let after = if tried { newton.cost(rows, &trial, level_here(&trial)) } else { f64::INFINITY };
        slow = if after < 0.5 * before { 0 } else { slow + 1 };
        if after < before {
            core::mem::swap(wave, &mut trial);
            damping = (0.1 * damping).max(least);
            renew = after > SLOW * before;
            fresh = false;
        } else {
            // If a step with an old Jacobian failed, the Jacobian is computed again before the damping is changed.
            (renew, damping) = if fresh { (false, 10.0 * damping) } else { (true, damping) };
            newton.factor = None;
        }
        run.report(wave);
    }
    // The transducers cannot make so many points even: the result is no weaker than the start, unless there are quiet
    // points.
    if !even && rows.targeted == rows.order.len() && wave.lowest(rows) < begun.lowest(rows) {
        core::mem::swap(wave, &mut begun);
    }
    Ok(Polish { even, dependent: newton.dependent.unwrap_or(0) })
}

/// The factor of the damped J J^T, and its solution for a rise of the level.
pub(crate) type Factor<'w> = (Cholesky<'w>, Buffer<'w, f32>);

/// The linear system at a wave: the targeted points' moduli, then the quiet points' real and imaginary parts.
pub(crate) struct Newton<'w> {
    pub(crate) dual: Dual<'w>,
    factor: Option<Factor<'w>>,
    dependent: Option<usize>,
    /// 1 / weight of each equation.
    ease: Buffer<'w, f32>,
    pub(crate) rotations: Buffer<'w, f32>,
    /// The allowed leak of a quiet point, relative to the level.
    quiet: f32,
}

impl<'w> Newton<'w> {
    pub(crate) fn new(
        problem: &Problem,
        rows: &Rows,
        quiet: f32,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let (targeted, all) = (rows.targeted, rows.order.len());
        let mut dual = Dual::new(rows, rows.equations(), work, control)?;
        let [f, g] = &mut dual.factors;
        g[targeted..all].fill(-1.0);
        f[all..].fill(1.0);
        let mut ease = work.floats.take(dual.size);
        let points = rows.order.iter().chain(&rows.order[targeted..]);
        for (ease, &j) in ease.iter_mut().zip(points) {
            *ease = 1.0 / problem.weights()[j as usize].max(LEAST_WEIGHT);
        }
        // A quiet point's row is multiplied by its weight, so the damping is relative to the row's own size.
        for (ease, scale) in ease[targeted..].iter_mut().zip(rows.scale[targeted..].iter().cycle()) {
            *ease = (scale * scale).max(f32::MIN_POSITIVE);
        }
        Ok(Self { dual, factor: None, dependent: None, ease, rotations: work.floats.take_any(rows.lanes), quiet })
    }

    /// Returns the weighted squared deviations from `level`, relative to it.
    pub(crate) fn cost(&self, rows: &Rows, wave: &Wave, level: f32) -> f64 {
        let missing = |k: usize| self.missing(rows, wave, k, level) / level;
        (0..self.dual.size).map(|k| f64::from(missing(k) * missing(k) / self.ease[k])).sum()
    }

    /// Returns how much an equation misses at a level. A quiet point misses only its leak above the allowed one.
    pub(super) fn missing(&self, rows: &Rows, wave: &Wave, equation: usize, level: f32) -> f32 {
        let points = rows.order.len();
        let (value, modulus) = match equation {
            k if k < rows.targeted => return level - wave.moduli[k],
            k if k < points => (wave.field[0][k], wave.moduli[k]),
            k => {
                let k = k - points + rows.targeted;
                (wave.field[1][k], wave.moduli[k])
            }
        };
        if modulus <= WITHIN * self.quiet * level { 0.0 } else { value * (WITHIN * self.quiet * level / modulus - 1.0) }
    }

    /// Computes the derivatives at a wave. If a `metric` is given, the derivatives of each transducer are multiplied by its
    /// entry.
    pub(crate) fn update(
        &mut self,
        rows: &Rows,
        wave: &Wave,
        metric: Option<&[f32]>,
        control: &mut Control,
    ) -> Result<(), Error> {
        self.factor = None;
        let (targeted, points) = (rows.targeted, rows.order.len());
        let [f, g] = &mut self.dual.factors;
        // The derivative d|P| = Re(conj(P) dP)/|P| with dP = j G q d, for rotations d of the drives q.
        for k in 0..targeted {
            (f[k], g[k]) = (wave.field[1][k] / wave.moduli[k], -wave.field[0][k] / wave.moduli[k]);
        }
        self.dual.derive(rows, wave, (0..points).chain(targeted..points), metric, control)
    }

    /// Returns the factor of the damped matrix and the solution for a rise of the level; `None` if f32 cannot factor
    /// it.
    pub(crate) fn factored(
        &self,
        rows: &Rows,
        damping: f32,
        control: &mut Control,
    ) -> Result<Option<Factor<'w>>, Error> {
        let (size, lanes) = (self.dual.size, self.dual.lanes());
        let mean = (0..size).map(|k| self.dual.matrix[k * lanes + k]).sum::<f32>() / size as f32;
        let factor = self.dual.factor(|k| damping * mean * self.ease[k], control)?;
        let Some(cholesky) = factor else { return Ok(None) };
        let mut rise = self.dual.work.floats.take(lanes);
        rise[..rows.targeted].fill(1.0);
        cholesky.solve(&mut rise);
        Ok(Some((cholesky, rise)))
    }

    /// Returns the multipliers y of the shortest step J^T y from a wave to a level, or with a free level.
    pub(crate) fn shortest(
        &self,
        rows: &Rows,
        wave: &Wave,
        (cholesky, rise): &Factor<'w>,
        level: Option<f32>,
    ) -> Buffer<'w, f32> {
        // The solution is computed from the mean level. As the difference of s times one solution and another solution,
        // it would lose most digits.
        let middle = wave.level(rows);
        let mut dual = self.dual.work.floats.take(rise.len());
        for (k, dual) in dual.iter_mut().enumerate().take(self.dual.size) {
            *dual = self.missing(rows, wave, k, middle);
        }
        cholesky.solve(&mut dual);
        let sum = |values: &[f32]| values[..rows.targeted].iter().map(|&x| f64::from(x)).sum::<f64>();
        let shift = level.map_or_else(|| (-sum(&dual) / sum(rise)) as f32, |level| level - middle);
        dual.iter_mut().zip(&rise[..]).for_each(|(dual, rise)| *dual += shift * rise);
        dual
    }

    /// Writes the steepest descent of the deviations from the mean level to `rotations`.
    pub(crate) fn descent(&mut self, rows: &Rows, wave: &Wave, control: &mut Control) -> Result<(), Error> {
        self.update(rows, wave, None, control)?;
        let level = wave.level(rows);
        let mut missing = self.dual.work.floats.take(self.dual.lanes());
        for (k, missing) in missing.iter_mut().enumerate().take(self.dual.size) {
            *missing = self.missing(rows, wave, k, level);
        }
        self.dual.back(&missing, &mut self.rotations);
        Ok(())
    }

    /// Writes the shortest step with a free level to `rotations`; a `metric` weighs the transducers in the length of the
    /// step. Returns `false` if f32 cannot find a step.
    pub(crate) fn direction(
        &mut self,
        rows: &Rows,
        wave: &Wave,
        metric: Option<&[f32]>,
        control: &mut Control,
    ) -> Result<bool, Error> {
        self.update(rows, wave, metric, control)?;
        let Some(factor) = self.factored(rows, DAMPING, control)? else { return Ok(false) };
        let dual = self.shortest(rows, wave, &factor, None);
        Ok(self.dual.back(&dual, &mut self.rotations).is_finite())
    }

    /// Writes the wave after a step with the last derivatives to `trial`; returns `false` if f32 cannot factor the
    /// system.
    fn step(
        &mut self,
        rows: &Rows,
        wave: &Wave,
        level: Option<f32>,
        damping: f32,
        trial: &mut Wave,
        control: &mut Control,
    ) -> Result<bool, Error> {
        let factor = match self.factor.take() {
            None => self.factored(rows, damping, control)?,
            kept => kept,
        };
        let Some((cholesky, rise)) = factor else { return Ok(false) };
        self.dependent.get_or_insert_with(|| self.dual.dependent(&cholesky, rows.targeted, DEPENDENT));
        let factor = (cholesky, rise);
        let dual = self.shortest(rows, wave, &factor, level);
        let most = self.dual.back(&dual, &mut self.rotations);
        self.factor = Some(factor);
        let part = if most > MOST_ROTATION { MOST_ROTATION / most } else { 1.0 };
        if !most.is_finite() {
            return Ok(false);
        }
        trial.rotate(rows, wave, &self.rotations, part);
        Ok(true)
    }
}
