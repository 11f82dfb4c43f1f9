//! The trait `Solve` of a method, and its entry in the registry.

use core::any::Any;

use crate::device::quantization::Quantization;
use crate::prelude::*;
use crate::problem::{Problem, Solution};
use crate::scene::Options;
use crate::solvers::last::Last;
use crate::solvers::options::Configure;
use crate::workspace::Workspace;

/// A method that finds a drive.
pub trait Solve {
    /// Solves `problem` with its present targets, which may be missed; no drive exceeds 1. Buffers come from `work` and
    /// go back there; `control` is called once a step. [`crate::solve`] balances; a solver does not.
    ///
    /// # Errors
    /// Options that do not fit this problem.
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution>;

    /// Returns the solver itself if it can share the work of several problems, else `None`.
    #[doc(hidden)]
    fn interleaved(&self) -> Option<&dyn Any> {
        None
    }

    /// Returns whether the method continues until the targets are met. A miss of 1 % is then worth a warning.
    #[doc(hidden)]
    fn meets_targets(&self) -> bool {
        false
    }

    /// Returns whether the method drives every transducer at full power however weak the targets are. Weak foci then
    /// become blurred or too loud.
    #[doc(hidden)]
    fn plays_at_full(&self) -> bool {
        true
    }

    /// Returns whether the method computes rows of G one after the other, see [`crate::Model::for_rows`].
    #[doc(hidden)]
    fn computes_rows(&self) -> bool {
        false
    }

    /// Solves the frame after `last`, if the method uses it.
    ///
    /// # Errors
    /// The errors of [`Solve::solve`].
    #[doc(hidden)]
    fn follow(
        &self,
        problem: &Problem,
        _last: &mut Last,
        work: &mut Workspace,
        control: &mut Control,
    ) -> Result<Solution> {
        self.solve(problem, work, control)
    }

    /// Returns whether the method uses its last frame.
    #[doc(hidden)]
    fn remembers(&self) -> bool {
        false
    }

    /// Returns whether the method itself finds the level of its solution, so that no balancing is needed.
    fn finds_level(&self) -> bool {
        false
    }

    /// Returns the allowed leak of a quiet point, relative to the loudest point, if the method has such a tolerance.
    #[doc(hidden)]
    fn quiet(&self) -> Option<f64> {
        None
    }

    /// Returns the largest change of a phase from the last drive in rad, if the method has such a bound.
    #[doc(hidden)]
    fn bound(&self) -> Option<f64> {
        None
    }

    /// Returns whether the method uses the phases of the targets.
    fn uses_phases(&self) -> bool {
        false
    }
}

/// A method's entry in the registry, besides its options.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// The name of the method.
    pub name: &'static str,
    /// A description in one line.
    pub summary: &'static str,
    /// The source: paper and equation.
    pub source: &'static str,
    /// Whether [`crate::solve`] balances the targets by default.
    pub balance: bool,
    /// Largest change of a metric when a scene is permuted, moved or mirrored (mean over 20 scenes).
    pub tolerance: f64,
    /// Whether the method uses a start (a drive or point phases).
    pub uses_start: bool,
    /// Whether the method uses an aim ("target" or "max").
    pub uses_aim: bool,
}

impl Info {
    /// Creates the entry of a method that neither balances nor uses a start or an aim, with a tolerance of 1e-4.
    pub const fn new(name: &'static str, summary: &'static str, source: &'static str) -> Self {
        Self { name, summary, source, balance: false, tolerance: 1e-4, uses_start: false, uses_aim: false }
    }

    /// Returns the entry of a method that balances the targets by default.
    #[must_use]
    pub const fn balanced(self) -> Self {
        Self { balance: true, ..self }
    }

    /// Returns the entry of a method that uses a start.
    #[must_use]
    pub const fn with_start(self) -> Self {
        Self { uses_start: true, ..self }
    }

    /// Returns the entry of a method that uses an aim.
    #[must_use]
    pub const fn with_aim(self) -> Self {
        Self { uses_aim: true, ..self }
    }

    /// Returns the entry with another tolerance.
    #[must_use]
    pub const fn within(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }
}

/// A registered method: its options, its entry, and [`Solve`].
pub trait Method: Configure + Solve + Send + Sync + 'static {
    /// The method's entry in the registry.
    const INFO: Info;

    /// Returns the defaults that follow from a device's quantization.
    fn device_defaults(_quantization: &Quantization) -> Options {
        Options::new()
    }

    /// Checks the options against each other and their ranges.
    ///
    /// # Errors
    /// A value out of range.
    fn check(&self) -> Result<()>;
}

/// Checks the steps and the tolerance of an iterative method; returns an error if one is out of range.
pub(crate) fn check_iteration(steps: u32, tolerance: f64) -> Result<()> {
    refuse_if!(steps == 0, Error::out_of_range("steps", steps, "give at least 1"));
    real("tolerance", tolerance, 0.0, false).map(|_| ())
}
