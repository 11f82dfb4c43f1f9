//! Search: makes fields from several starts, and keeps the loudest even one.

use core::f64::consts::TAU;
use core::ops::Range;

use num_complex::Complex32;

use crate::error::Error;
use crate::math::phasor;
use crate::rng::Rng;
use crate::scene::Aim;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::ascent::{Pace, climb};
use crate::solvers::even_field::common_level::{MOST_STEPS, Manner, Polish, polish};
use crate::solvers::even_field::cones;
use crate::solvers::even_field::few::{self, FEW};
use crate::solvers::even_field::leaders::{self, Leaders};
use crate::solvers::even_field::penalty;
use crate::solvers::even_field::point_phases::{Foci, Starts};
use crate::solvers::even_field::run::{Plan, Run};
use crate::solvers::even_field::soft_minimum;
use crate::solvers::even_field::weighted_sweeps::raise;
use crate::workspace::Workspace;

/// Points are crowded if at least two, and at least this part, of them depend on others, and the condition of [`KEPT`]
/// holds, too.
const CROWDED: f32 = 0.2;

/// Points are crowded if the steps to an even field left less than this part of the level. Of separate points a tenth
/// depends on others, and .97 or more of the level is kept.
const KEPT: f32 = 0.97;

/// Crowded points are even if none differs from its target by more than this part of the level. In f32 the smallest
/// eigenvalues of their matrix are noise, so a closer match cannot be found.
pub(super) const NEARLY: f32 = 1e-3;

/// Allowed deviation at the highest level, where the last steps lose level for evenness.
const ALIKE: f32 = 2e-3;

/// An even field is rejected if it is below this part of an uneven field's weakest point.
const FAINT: f32 = 0.6;

/// The best field so far.
pub(super) struct Search<'w> {
    pub(super) best: Wave<'w>,
    /// Whether the field is even.
    pub(super) even: bool,
    /// |P| of the field's weakest point with a target; negative before there is a field.
    pub(super) lowest: f32,
    pub(super) trial: Wave<'w>,
    /// Number of the best even fields whose level will be raised further.
    raised: usize,
    leaders: Leaders<'w>,
}

/// One of three starts is continued to its end. With one of four, the level of a letter of 160 points is 2 to 4 %
/// lower.
const RACERS: usize = 3;

impl<'w> Search<'w> {
    /// Creates a search without a field; `raised` fields will be raised further.
    pub(super) fn new(rows: &Rows, raised: usize, work: &'w Workspace) -> Self {
        let [best, trial] = [(); 2].map(|()| Wave::new(rows, work));
        Self { best, even: false, lowest: -1.0, trial, raised, leaders: Leaders::new(raised) }
    }

    /// Replaces the best field by the trial if the trial is better. An even field is better than an uneven one; of two
    /// even fields the louder one is better.
    pub(super) fn offer(&mut self, rows: &Rows, even: bool) {
        let lowest = self.trial.lowest(rows);
        if (even, lowest) > (self.even, self.lowest) {
            (self.even, self.lowest) = (even, lowest);
            core::mem::swap(&mut self.best, &mut self.trial);
        }
    }

    /// Returns whether the best field is even and reaches the target at all points.
    pub(super) fn reaches(&self, target: f32) -> bool {
        self.even && self.lowest >= target * (1.0 - 2.0 * NEARLY)
    }

    /// Returns whether pressures are requested and the best field reaches them.
    pub(super) fn finds(&self, run: &Run) -> bool {
        run.problem.aim() == Aim::Target && self.reaches(run.rows.target)
    }

    /// Makes the field of each start of a plan even by the shortest steps. Returns whether the points turned out to be
    /// crowded.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn level(&mut self, run: &mut Run<'_, '_, 'w>, foci: &Foci, plan: Plan) -> Result<bool, Error> {
        let (rows, mut crowded) = (run.rows, false);
        let starts = Starts::new(run.problem, rows, foci, &plan, run.work, run.control)?;
        run.plan = plan;
        run.steps += starts.count * (1 + plan.sweeps + MOST_STEPS);
        for start in 0..starts.count {
            raise(run, &starts, start, &mut self.trial);
            let before = self.trial.level(rows);
            let Polish { even, dependent } = polish(run, Manner::separate(None), &mut self.trial)?;
            let many = dependent > 1 && dependent as f32 >= CROWDED * rows.targeted as f32;
            let level = self.trial.level(rows);
            let uneven = !even && self.trial.unevenness(rows, level, run.plan.quiet) > NEARLY;
            crowded |= uneven || (many && level < KEPT * before);
            if even && self.raised > 0 {
                self.leaders.offer(&self.trial, rows, run.work);
            }
            self.offer(rows, even);
            if run.stopped {
                break;
            }
        }
        Ok(crowded && rows.targeted > 1)
    }

    /// Raises the level of crowded points, from each start of a plan.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn climb(
        &mut self,
        run: &mut Run<'_, '_, 'w>,
        foci: &Foci,
        plan: Plan,
        pace: Pace,
    ) -> Result<(), Error> {
        let rows = run.rows;
        let starts = Starts::new(run.problem, rows, foci, &plan, run.work, run.control)?;
        run.plan = plan;
        run.steps += starts.count * (1 + plan.sweeps + pace.steps + MOST_STEPS);
        for start in 0..starts.count {
            if run.stopped {
                break;
            }
            raise(run, &starts, start, &mut self.trial);
            self.climb_on(run, pace)?;
        }
        Ok(())
    }

    /// Raises the level of crowded points: a few steps from each start of a plan, then more from the loudest results.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn race(&mut self, run: &mut Run<'_, '_, 'w>, foci: &Foci, plan: Plan) -> Result<(), Error> {
        let rows = run.rows;
        let starts = Starts::new(run.problem, rows, foci, &plan, run.work, run.control)?;
        let most = starts.count.div_ceil(RACERS).min(leaders::MOST);
        run.plan = plan;
        run.steps += starts.count * (1 + plan.sweeps + Pace::FIRST.steps) + most * (Pace::REST.steps + MOST_STEPS);
        let mut ahead = Leaders::new(most);
        for start in 0..starts.count {
            if run.stopped {
                break;
            }
            raise(run, &starts, start, &mut self.trial);
            climb(run, Pace::FIRST, &mut self.trial)?;
            ahead.offer(&self.trial, rows, run.work);
        }
        for wave in ahead.fields() {
            self.trial.copy(wave);
            self.climb_on(run, Pace::REST)?;
        }
        Ok(())
    }

    /// Raises the levels of separate points by ascents. Few points without quiet ones start from the best point phases,
    /// which [`few`] finds. Others start from the loudest fields found. If there are no quiet points, the soft minimum
    /// of these fields is raised first.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn rise(&mut self, run: &mut Run<'_, '_, 'w>) -> Result<(), Error> {
        let (rows, alone) = (run.rows, run.rows.targeted == run.rows.order.len());
        let leaders = core::mem::replace(&mut self.leaders, Leaders::new(0));
        let few = alone && (2..=FEW).contains(&rows.targeted);
        if self.raised == 0 || rows.targeted == 1 {
            return Ok(());
        }
        if few && let Some(starts) = few::start(run)? {
            run.plan.sweeps = 0;
            raise(run, &starts, 0, &mut self.trial);
            self.rise_on(run, Pace::RISE_OF_FEW)?;
        }
        for wave in leaders.fields().take(if few { 0 } else { leaders::MOST }) {
            self.trial.copy(wave);
            if alone {
                soft_minimum::raise(run, &mut self.trial);
            }
            self.rise_on(run, Pace::RISE)?;
        }
        Ok(())
    }

    /// Raises the level of the trial by an ascent.
    fn rise_on(&mut self, run: &mut Run<'_, '_, 'w>, pace: Pace) -> Result<(), Error> {
        run.steps += pace.steps + MOST_STEPS;
        climb(run, pace, &mut self.trial)?;
        let even = polish(run, Manner::separate(None), &mut self.trial)?.even;
        self.offer(run.rows, even);
        Ok(())
    }

    /// Raises the soft minimum, from the best field of crowded points and from waves whose focus is in front of or
    /// behind them.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn soften(&mut self, run: &mut Run<'_, '_, 'w>, foci: &Foci, plan: Plan) -> Result<(), Error> {
        let rows = run.rows;
        let mut ahead = Leaders::new(leaders::MOST);
        run.plan = plan;
        run.steps += (leaders::MOST + 1) * penalty::MOST_STEPS;
        self.trial.copy(&self.best);
        for cone in 0..=cones::COUNT {
            if cone > 0 {
                let Some(starts) = cones::start(run, foci, cone - 1) else { break };
                raise(run, &starts, 0, &mut self.trial);
            }
            if run.stopped {
                break;
            }
            soft_minimum::raise(run, &mut self.trial);
            ahead.offer(&self.trial, rows, run.work);
        }
        for wave in ahead.fields() {
            self.trial.copy(wave);
            self.tighten(run, penalty::ALL)?;
        }
        self.trial.copy(&self.best);
        self.tighten(run, penalty::ALL)
    }

    /// Applies the penalty to drives of random phases: where points fill a volume, the loudest fields are not near
    /// smooth ones.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn scatter(&mut self, run: &mut Run<'_, '_, 'w>, starts: usize) -> Result<(), Error> {
        let (mut rng, mut ahead) = (Rng::new(run.plan.seed), Leaders::new(starts / RACERS));
        for _ in 0..starts {
            let drive = (0..run.problem.propagation().transducers()).map(|_| phasor(TAU * rng.uniform()));
            self.trial.play_at_full(run.rows, drive.map(|q| Complex32::new(q.re as f32, q.im as f32)));
            penalty::raise(run, penalty::FIRST, &mut self.trial)?;
            ahead.offer(&self.trial, run.rows, run.work);
        }
        for wave in ahead.fields() {
            self.trial.copy(wave);
            self.tighten(run, penalty::REST)?;
        }
        Ok(())
    }

    /// Raises the common level of the trial by the steps of [`penalty`].
    fn tighten(&mut self, run: &mut Run<'_, '_, 'w>, parts: Range<usize>) -> Result<(), Error> {
        let rows = run.rows;
        run.steps += penalty::MOST_STEPS;
        penalty::raise(run, parts, &mut self.trial)?;
        let level = self.trial.level(rows);
        let even = self.trial.unevenness(rows, level, run.plan.quiet) <= run.plan.tolerance.max(penalty::CLOSE);
        // An uneven field is better than an even field that is much weaker.
        if even && (self.even || self.trial.lowest(rows) >= FAINT * self.lowest) {
            self.offer(rows, true);
        }
        Ok(())
    }

    /// Raises the level of the trial, and makes it even.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn climb_on(&mut self, run: &mut Run<'_, '_, 'w>, pace: Pace) -> Result<(), Error> {
        let rows = run.rows;
        climb(run, pace, &mut self.trial)?;
        let level = self.trial.level(rows);
        polish(run, (pace.manner)(level, run.plan.quiet), &mut self.trial)?;
        let level = self.trial.level(rows);
        let even = self.trial.unevenness(rows, level, run.plan.quiet) <= run.plan.tolerance.max(ALIKE);
        self.offer(rows, even);
        Ok(())
    }
}
