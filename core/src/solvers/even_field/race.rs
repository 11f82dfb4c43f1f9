//! Race: fields from several starts, of which the few loudest are followed to the end; the loudest even one is kept.

use core::f64::consts::TAU;

use crate::kernels::LANES;
use crate::math::phasor;
use crate::prelude::*;
use crate::scene::Aim;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::ascent::{Pace, climb};
use crate::solvers::even_field::even::{MOST_STEPS, Manner, Polish, polish};
use crate::solvers::even_field::newton::Newton;
use crate::solvers::even_field::path::{self, CULL, Course};
use crate::solvers::even_field::run::{FEW_ENOUGH, Plan, Run, TOO_MANY};
use crate::solvers::even_field::starts::{FEW, Foci, Starts, cone, loudest_of_few};
use crate::solvers::even_field::sweeps::raise;
use crate::workspace::Workspace;

/// Points are crowded if at least two, and at least this part, of them depend on others, and the condition of [`KEPT`]
/// holds, too.
const CROWDED: f32 = 0.2;

/// Points are crowded if the steps to an even field left less than this part of the level. Of separate points a tenth
/// depends on others, and .97 or more of the level is kept.
const KEPT: f32 = 0.97;

/// Separate points follow the path if the steps to an even field left less than this part of the level.
const LOST: f32 = 0.985;

/// Separate points have other starts, too, if the steps to an even field left less than this part of the level.
const KEPT_BY_FEW: f32 = 0.95;

/// Crowded points are even if none differs from its target by more than this part of the level. In f32 the smallest
/// eigenvalues of their matrix are noise, so a closer match cannot be found.
pub(super) const NEARLY: f32 = 1e-3;

/// Allowed deviation of crowded points if a closer match costs level, or cannot be found. Half of it would cost 2 % of the
/// level.
const CLOSE: f32 = 4.8e-3;

/// Weighted sweeps from the starts of crowded points.
const SWEEPS: usize = 30;

/// What points turned out to be on the shortest steps to an even field.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Found {
    /// The steps keep the level.
    Separate,
    /// The steps lose some of the level, see [`LOST`]: a path raises it.
    Raisable,
    /// The steps lose much of the level, see [`KEPT_BY_FEW`]: other starts may lose less.
    Lossy,
    /// The steps lose the level or find no even field.
    Crowded,
}

/// The best field so far.
pub(super) struct Search<'w> {
    pub(super) best: Wave<'w>,
    /// Whether the field is even.
    pub(super) even: bool,
    /// |P| of the field's weakest point with a target; negative before there is a field.
    pub(super) lowest: f32,
    pub(super) trial: Wave<'w>,
    /// The loudest even fields of separate points.
    leaders: Leaders<'w>,
}

impl<'w> Search<'w> {
    /// Creates a search without a field.
    pub(super) fn new(rows: &Rows, work: &'w Workspace) -> Self {
        let [best, trial] = [(); 2].map(|()| Wave::new(rows, work));
        Self { best, even: false, lowest: -1.0, trial, leaders: Leaders::new() }
    }

    /// Takes the memory of steps that only some problems need, once for a size: later solves of this size then allocate
    /// nothing, whichever steps they need.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn reserve(run: &mut Run<'_, '_, 'w>) -> Result<(), Error> {
        let (rows, work, size) = (run.rows, run.work, [run.rows.lanes, run.rows.count]);
        let known = work.even.get();
        let larger = size[0] > known[0] || size[1] > known[1];
        if larger && (2..=TOO_MANY).contains(&rows.equations()) {
            work.even.set([size[0].max(known[0]), size[1].max(known[1])]);
            let waves = [(); MOST + 2].map(|()| Wave::new(rows, work));
            let starts = [(); 8].map(|()| work.floats.take_any(LANES * rows.targeted));
            let couplings = [(); 2].map(|()| work.floats.take_any(rows.targeted * rows.targeted));
            path::reserve(run)?;
            drop((waves, starts, couplings));
        }
        Ok(())
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

    /// Makes the field of each start of a plan even by the shortest steps. Returns what the points turned out to be.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn separate(&mut self, run: &mut Run<'_, '_, 'w>, foci: &Foci, plan: Plan) -> Result<Found, Error> {
        let rows = run.rows;
        let starts = Starts::new(run.problem, rows, foci, &plan, run.work, run.control)?;
        run.plan = plan;
        run.steps += starts.count * (1 + plan.sweeps + MOST_STEPS);
        let (mut crowded, mut kept) = (false, 1.0_f32);
        for start in 0..starts.count {
            raise(run, &starts, start, &mut self.trial);
            let before = self.trial.level(rows);
            let Polish { even, dependent } = polish(run, Manner::separate(None), &mut self.trial)?;
            let level = self.trial.level(rows);
            kept = kept.min(level / before);
            let many = dependent > 1 && dependent as f32 >= CROWDED * rows.targeted as f32;
            let uneven = !even && self.trial.unevenness(rows, level, run.plan.quiet) > NEARLY;
            crowded |= uneven || many && level < KEPT * before;
            if even {
                self.leaders.offer(&self.trial, self.trial.lowest(rows), plan.leaders(), rows, run.work);
            }
            self.offer(rows, even);
            if run.stopped {
                break;
            }
        }
        Ok(if rows.targeted == 1 {
            Found::Separate
        } else if crowded {
            Found::Crowded
        } else if kept < KEPT_BY_FEW {
            Found::Lossy
        } else if kept < LOST || plan.wide {
            Found::Raisable
        } else {
            Found::Separate
        })
    }

    /// Follows the path from the loudest even fields of separate points, or from the best point phases of few points.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn rise(&mut self, run: &mut Run<'_, '_, 'w>) -> Result<(), Error> {
        let rows = run.rows;
        let leaders = core::mem::replace(&mut self.leaders, Leaders::new());
        if run.plan.wide && rows.targeted == rows.order.len() && rows.targeted <= FEW {
            if let Some(start) = loudest_of_few(run)? {
                run.plan.sweeps = 0;
                raise(run, &start, 0, &mut self.trial);
                self.follow(run)?;
            }
            return Ok(());
        }
        for wave in leaders.fields() {
            self.trial.copy(wave);
            self.follow(run)?;
        }
        Ok(())
    }

    /// Follows the path from the trial, and makes it even.
    fn follow(&mut self, run: &mut Run<'_, '_, 'w>) -> Result<(), Error> {
        path::follow(run, Course::SEPARATE, NEARLY, &mut self.trial)?;
        let even = polish(run, Manner::separate(None), &mut self.trial)?.even;
        self.offer(run.rows, even);
        Ok(())
    }

    /// Raises the level of a few targets among crowded quiet points, from each start of a plan.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn among_quiet(&mut self, run: &mut Run<'_, '_, 'w>, foci: &Foci, plan: Plan) -> Result<(), Error> {
        let rows = run.rows;
        let starts = Starts::new(run.problem, rows, foci, &plan, run.work, run.control)?;
        run.plan = plan;
        run.steps += starts.count * (1 + plan.sweeps + MOST_STEPS);
        for start in 0..starts.count {
            if run.stopped {
                break;
            }
            raise(run, &starts, start, &mut self.trial);
            self.climb_on(run, Pace::SHORT)?;
        }
        Ok(())
    }

    /// Raises the level of the trial by an ascent, and makes it even.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn climb_on(&mut self, run: &mut Run<'_, '_, 'w>, pace: Pace) -> Result<(), Error> {
        climb(run, pace, &mut self.trial)?;
        let level = self.trial.level(run.rows);
        polish(run, pace.manner(level, run.plan.quiet), &mut self.trial)?;
        let alone = run.rows.targeted == run.rows.order.len();
        let even = self.unevenness(run) <= run.plan.tolerance.max(if alone { CLOSE } else { 2.0 * NEARLY });
        self.offer(run.rows, even);
        Ok(())
    }

    /// Follows the path of crowded points from a drive, or from the best field if there is none, and from the starts of a
    /// plan. The loudest fields are followed to the end.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(super) fn race(
        &mut self,
        run: &mut Run<'_, '_, 'w>,
        foci: &Foci,
        plan: Plan,
        drive: Option<&[Complex32]>,
    ) -> Result<(), Error> {
        let (rows, work) = (run.rows, run.work);
        let mut ahead = Leaders::new();
        run.plan = Plan { sweeps: SWEEPS, ..plan };
        match drive {
            Some(drive) => self.trial.play_at_full(rows, drive.iter().copied()),
            None => self.trial.copy(&self.best),
        }
        self.set_out(run, &mut ahead)?;
        let starts = Starts::new(run.problem, rows, foci, &plan, work, run.control);
        let Some(starts) = run.unless_stopped(starts)? else { return self.arrive(run, &ahead) };
        for start in 0..starts.count {
            if run.stopped {
                break;
            }
            raise(run, &starts, start, &mut self.trial);
            self.set_out(run, &mut ahead)?;
        }
        if run.problem.has_start() || run.stopped {
            return self.arrive(run, &ahead);
        }
        for &place in plan.cones() {
            let Some(start) = cone(run, foci, place).filter(|_| !run.stopped) else { break };
            for sweeps in [0, SWEEPS] {
                run.plan.sweeps = sweeps;
                raise(run, &start, 0, &mut self.trial);
                self.set_out(run, &mut ahead)?;
            }
        }
        if rows.equations() <= FEW_ENOUGH {
            let mut rng = Rng::new(plan.seed);
            for _ in 0..plan.random() {
                let drive = (0..run.problem.propagation().transducers()).map(|_| phasor(TAU * rng.uniform()));
                self.trial.play_at_full(rows, drive.map(|q| Complex32::new(q.re as f32, q.im as f32)));
                self.set_out(run, &mut ahead)?;
            }
        }
        self.arrive(run, &ahead)
    }

    /// Follows the first part of the path from the trial, and offers it to the fields `ahead`.
    fn set_out(&mut self, run: &mut Run<'_, '_, 'w>, ahead: &mut Leaders<'w>) -> Result<(), Error> {
        if run.stopped {
            return Ok(());
        }
        path::follow(run, Course::FIRST, CLOSE, &mut self.trial)?;
        let newton = Newton::new(run.problem, run.rows, run.plan.quiet, run.work, run.control)?;
        let merit = path::merit(&newton, run, &self.trial, CULL) as f32;
        ahead.offer(&self.trial, merit, run.plan.leaders(), run.rows, run.work);
        Ok(())
    }

    /// Follows the rest of the path from the fields `ahead`, and offers those that are even at its end. A plan that is not
    /// wide makes a field closer to even if it can.
    fn arrive(&mut self, run: &mut Run<'_, '_, 'w>, ahead: &Leaders<'w>) -> Result<(), Error> {
        let rows = run.rows;
        for wave in ahead.fields() {
            self.trial.copy(wave);
            let course = if run.plan.wide { Course::SLOW_REST } else { Course::REST };
            let rest = path::follow(run, course, CLOSE, &mut self.trial)?;
            if !run.plan.wide && self.unevenness(run) <= CLOSE {
                let mut close = Wave::new(rows, run.work);
                close.copy(&self.trial);
                path::follow(run, rest, NEARLY, &mut self.trial)?;
                if self.unevenness(run) > NEARLY {
                    core::mem::swap(&mut self.trial, &mut close);
                }
            }
            if self.unevenness(run) <= run.plan.tolerance.max(CLOSE) {
                self.offer(rows, true);
            }
        }
        Ok(())
    }

    /// Returns how far the trial is from its mean level.
    fn unevenness(&self, run: &Run) -> f32 {
        self.trial.unevenness(run.rows, self.trial.level(run.rows), run.plan.quiet)
    }
}

/// Largest number of fields that are followed to the end.
const MOST: usize = 3;

/// Fields count as the same field if their merits differ by less than this part.
const ALIKE: f32 = 1e-5;

/// The fields of the largest merits.
struct Leaders<'w> {
    fields: [Option<(f32, Wave<'w>)>; MOST],
}

impl<'w> Leaders<'w> {
    fn new() -> Self {
        Self { fields: [const { None }; MOST] }
    }

    /// Adds a copy of `wave` if there are fewer than `most` fields or if its merit is above that of another field, which
    /// it replaces.
    fn offer(&mut self, wave: &Wave, merit: f32, most: usize, rows: &Rows, work: &'w Workspace) {
        let level = |field: &Option<(f32, Wave)>| field.as_ref().map_or(f32::NEG_INFINITY, |(level, _)| *level);
        if self.fields.iter().any(|field| (level(field) / merit - 1.0).abs() <= ALIKE) {
            return;
        }
        let last = self.fields[..most].iter_mut().min_by(|a, b| level(a).total_cmp(&level(b)));
        if let Some(last) = last.filter(|last| level(last) < merit) {
            let (_, mut own) = last.take().unwrap_or_else(|| (merit, Wave::new(rows, work)));
            own.copy(wave);
            *last = Some((merit, own));
        }
    }

    /// Returns the stored fields.
    fn fields(&self) -> impl Iterator<Item = &Wave<'w>> {
        self.fields.iter().flatten().map(|(_, wave)| wave)
    }
}
