//! A run under way: how much work to spend, steps reported to the caller, and how even a field is.

use crate::control::Control;
use crate::linalg::Planar;
use crate::problem::Problem;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::{Buffer, Workspace};

/// How much work to spend.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    /// Point phases tried: one on G, several on the matrix of couplings.
    pub(crate) starts: usize,
    /// How many of the best of them are carried on to drives.
    pub(crate) finalists: usize,
    /// Seed of the point phases.
    pub(crate) seed: u64,
    /// Weighted sweeps for each.
    pub(crate) sweeps: usize,
    /// Even enough: the largest deviation from the common level, relative to it.
    pub(crate) tolerance: f32,
    /// The allowed leak of a quiet point, relative to the level.
    pub(crate) quiet: f32,
    /// How many of the even fields of separate points are raised on.
    pub(crate) raised: usize,
}

/// A quiet point counts from this many times what it may leak on: the last tenth would take as many steps as all before.
const ABOVE: f32 = 1.1;

/// The default of the allowed leak of a quiet point: 60 dB below the level.
pub(crate) const QUIET: f64 = 1e-3;

/// Weighted sweeps before the Gauss-Newton steps, unless an option gives another number.
pub(crate) const SWEEPS: u32 = 4;

/// Equations of which a step takes tens of milliseconds: the level of more is not raised any further.
pub(super) const TOO_MANY: usize = 500;

/// Equations of so few points that they are made even from drives of random phases, too.
pub(super) const FEW_ENOUGH: usize = 128;

/// Targets are unequal where one is this part of another, ...
const UNEQUAL: f32 = 3.0;

/// ... which counts from this many on.
const MANY: usize = 16;

impl Plan {
    /// One start, found on G itself.
    pub(crate) const fn alone(sweeps: u32, tolerance: f64, quiet: f64) -> Self {
        let (tolerance, quiet) = (tolerance as f32, quiet as f32);
        Self { starts: 1, finalists: 1, seed: 0, sweeps: sweeps as usize, tolerance, quiet, raised: 0 }
    }

    /// Beside one start for points that lie regularly: it may have broken a tie for the worse.
    pub(super) fn for_regular(&self) -> Self {
        Self { starts: 16, finalists: 3, ..*self }
    }

    /// How many even fields are raised on: of unequal targets one at least, since the shortest steps to an even field cost
    /// them a tenth of the level.
    pub(super) fn raised(&self, rows: &Rows) -> usize {
        if rows.unequal() { self.raised.max(1) } else { self.raised }
    }

    /// From how many drives of random phases crowded points are made even; `loud`: another start did, at a high level.
    pub(super) fn scattered(&self, loud: bool) -> usize {
        match self.raised {
            0 if loud => 0,
            0 => 6,
            _ => 12,
        }
    }

    /// For crowded points, of which the energy of a start says less of the level it ends at: more of them are raised.
    pub(super) fn for_crowded(&self) -> Self {
        Self { starts: self.starts.max(16), finalists: (2 * self.finalists).max(4), ..*self }
    }
}

impl Rows<'_> {
    /// Whether there are many targets, some much louder than others.
    pub(super) fn unequal(&self) -> bool {
        self.targeted >= MANY && self.scale[..self.targeted].iter().any(|&scale| scale >= UNEQUAL)
    }
}

impl Wave<'_> {
    /// The field at `amplitude` in the problem's order and unit; `rows` contains all of the problem's points.
    pub(crate) fn received<'w>(
        &self,
        problem: &Problem,
        rows: &Rows,
        amplitude: f32,
        work: &'w Workspace,
    ) -> Planar<'w> {
        let mut field = Planar::zeros(1, problem.propagation().lanes(), work);
        for (field, own) in [&mut field.re, &mut field.im].into_iter().zip(&self.field) {
            for (k, &j) in rows.order.iter().enumerate() {
                field[j as usize] = own[k] / rows.scale[k] * amplitude;
            }
        }
        field
    }

    /// |P| of the weakest targeted point.
    pub(super) fn lowest(&self, rows: &Rows) -> f32 {
        self.moduli[..rows.targeted].iter().copied().fold(f32::INFINITY, f32::min)
    }

    /// The mean |P| of the targeted points.
    pub(crate) fn level(&self, rows: &Rows) -> f32 {
        self.moduli[..rows.targeted].iter().sum::<f32>() / rows.targeted as f32
    }

    /// The largest deviation from `level`, and what quiet points leak above the part `quiet` of it, relative to it.
    pub(crate) fn unevenness(&self, rows: &Rows, level: f32, quiet: f32) -> f32 {
        if level == 0.0 {
            return f32::INFINITY;
        }
        let (targeted, silent) = self.moduli[..rows.order.len()].split_at(rows.targeted);
        let deviations = targeted.iter().map(|x| (x / level - 1.0).abs());
        deviations.chain(silent.iter().map(|x| x / level - ABOVE * quiet)).fold(0.0, f32::max)
    }
}

/// A solve under way: what it works on, and its steps, each reported to the caller.
pub(super) struct Run<'a, 'b, 'w> {
    pub(super) problem: &'a Problem,
    pub(super) rows: &'a Rows<'w>,
    pub(super) plan: Plan,
    pub(super) work: &'w Workspace,
    pub(super) control: &'a mut Control<'b>,
    pub(super) step: usize,
    pub(super) steps: usize,
    pub(super) stopped: bool,
    /// Moduli in the problem's order and unit.
    pub(super) moduli: Buffer<'w, f32>,
}

impl<'a, 'b, 'w> Run<'a, 'b, 'w> {
    /// A run before its first step, of `steps` as far as is known.
    pub(super) fn new(
        problem: &'a Problem,
        rows: &'a Rows<'w>,
        plan: Plan,
        steps: usize,
        work: &'w Workspace,
        control: &'a mut Control<'b>,
    ) -> Self {
        let moduli = work.floats.take(problem.propagation().lanes());
        Self { problem, rows, plan, work, control, step: 0, steps, stopped: false, moduli }
    }

    /// Whether to go on after a step to `wave`. A step is reported when the next one is done: the last one's residual is
    /// that of the answer, which is reported when it is made.
    pub(super) fn report(&mut self, wave: &Wave) -> bool {
        let (problem, moduli) = (self.problem, &self.moduli);
        if self.step > 0 {
            self.stopped = self.control.step(self.step, self.steps, || problem.residual(moduli)).is_break();
        }
        if !self.stopped {
            self.step += 1;
            for (k, &j) in self.rows.order.iter().enumerate() {
                self.moduli[j as usize] = wave.moduli[k] / self.rows.scale[k];
            }
        }
        !self.stopped
    }
}
