//! A run: the limits of the search, steps reported to the caller, and how even a field is.

use crate::linalg::Planar;
use crate::prelude::*;
use crate::problem::Problem;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::{Buffer, Workspace};

/// Limits of the search.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    /// Number of point phases that are tried: one on G, several on the matrix of couplings.
    pub(crate) starts: usize,
    /// Number of the best point phases that are continued to drives.
    pub(crate) finalists: usize,
    /// Seed of the point phases.
    pub(crate) seed: u64,
    /// Weighted sweeps for each finalist.
    pub(crate) sweeps: usize,
    /// The largest deviation from the common level that counts as even, relative to it.
    pub(crate) tolerance: f32,
    /// The allowed leak of a quiet point, relative to the level.
    pub(crate) quiet: f32,
    /// Whether more fields are followed to the end, from more kinds of starts.
    pub(crate) wide: bool,
}

/// A quiet point counts as too loud from this multiple of its allowed leak on. To remove the last tenth would take as
/// many steps as all steps before.
const ABOVE: f32 = 1.1;

/// Default of the allowed leak of a quiet point: 60 dB below the level.
pub(crate) const QUIET: f64 = 1e-3;

/// Default number of weighted sweeps before the shortest steps to an even field.
pub(crate) const SWEEPS: u32 = 12;

/// Above this number of equations, where a step takes tens of milliseconds, the level is not raised further.
pub(super) const TOO_MANY: usize = 500;

/// Up to this number of equations random phases are tried as starts, too.
pub(super) const FEW_ENOUGH: usize = 128;

impl Plan {
    /// Returns the plan with a single start, which is found on G itself.
    pub(crate) const fn alone(sweeps: u32, tolerance: f64, quiet: f64) -> Self {
        let (tolerance, quiet) = (tolerance as f32, quiet as f32);
        Self { starts: 1, finalists: 1, seed: 0, sweeps: sweeps as usize, tolerance, quiet, wide: false }
    }

    /// Returns the plan with more starts, for points whose single start may have been bad.
    pub(super) fn again(&self) -> Self {
        Self { starts: 16, finalists: 2, ..*self }
    }

    /// Returns the number of starts with random drives: where points fill a volume, the loudest fields are not near
    /// smooth ones.
    pub(super) fn random(&self) -> usize {
        if self.wide { 4 } else { 2 }
    }

    /// Returns how many fields are followed to the end.
    pub(super) fn leaders(&self) -> usize {
        if self.wide { 3 } else { 2 }
    }

    /// Returns the cones from which crowded points start. A wide plan follows one that is not wide.
    pub(super) fn cones(&self) -> &'static [usize] {
        if self.wide { &[0, 1, 3, 4, 5] } else { &[2] }
    }
}

impl Wave<'_> {
    /// Returns the field at `amplitude` in the problem's order and unit; `rows` contains all of the problem's points.
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

    /// Returns |P| of the weakest targeted point.
    pub(super) fn lowest(&self, rows: &Rows) -> f32 {
        self.moduli[..rows.targeted].iter().copied().fold(f32::INFINITY, f32::min)
    }

    /// Returns the mean |P| of the targeted points.
    pub(crate) fn level(&self, rows: &Rows) -> f32 {
        self.moduli[..rows.targeted].iter().sum::<f32>() / rows.targeted as f32
    }

    /// Returns the largest deviation from `level` and the largest leak of a quiet point above `quiet`, relative to the
    /// level.
    pub(crate) fn unevenness(&self, rows: &Rows, level: f32, quiet: f32) -> f32 {
        if level == 0.0 {
            return f32::INFINITY;
        }
        let (targeted, silent) = self.moduli[..rows.order.len()].split_at(rows.targeted);
        let deviations = targeted.iter().map(|x| (x / level - 1.0).abs());
        deviations.chain(silent.iter().map(|x| x / level - ABOVE * quiet)).fold(0.0, f32::max)
    }
}

/// A running solve: its problem, and its steps, each reported to the caller.
pub(crate) struct Run<'a, 'b, 'w> {
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
    /// Creates a run before its first step; `steps` is the expected number.
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

    /// Returns the value; `None` after a stop, which is noted.
    pub(super) fn unless_stopped<T>(&mut self, result: Result<T, Error>) -> Result<Option<T>, Error> {
        match result {
            Err(error) if error.is_stop() => {
                self.stopped = true;
                Ok(None)
            }
            result => result.map(Some),
        }
    }

    /// Counts a step to `wave`; returns whether to continue. A step is reported when the next one is done, because the
    /// residual of the last step is that of the solution, which is reported later.
    pub(super) fn report(&mut self, wave: &Wave) -> bool {
        let (problem, moduli) = (self.problem, &self.moduli);
        if self.step > 0 {
            self.stopped |= self.control.step(self.step, self.steps, || problem.residual(moduli)).is_break();
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
