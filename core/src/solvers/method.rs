//! The trait `Solve`, and the registry's facts about a method.

use core::any::Any;

use crate::control::Control;
use crate::device::quantization::Quantization;
use crate::error::{Error, real};
use crate::problem::{Problem, Solution};
use crate::scene::Options;
use crate::solvers::last::Last;
use crate::solvers::options::Configure;
use crate::workspace::Workspace;

/// A method that finds a drive.
pub trait Solve {
    /// Solves `problem` as it stands: its targets are met or missed, no drive exceeds 1. Buffers come from
    /// `work` and go back there; `control` is called once a step. A solver does not balance: [`crate::solve`] does.
    ///
    /// # Errors
    /// Options that this problem cannot be solved with.
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution, Error>;

    /// Itself, where it knows how to share the work of several problems: a marker type without code.
    #[doc(hidden)]
    fn interleaved(&self) -> Option<&dyn Any> {
        None
    }

    /// Whether it goes on until the targets are met, and an answer that misses them has the status
    /// [`crate::Status::Missed`].
    #[doc(hidden)]
    fn meets_targets(&self) -> bool {
        false
    }

    /// Whether it drives every transducer at full power however weak the targets are: weak foci then come out smeared, or too
    /// loud.
    #[doc(hidden)]
    fn plays_at_full(&self) -> bool {
        true
    }

    /// Whether it computes rows of G one after the other: [`crate::Model::for_rows`].
    #[doc(hidden)]
    fn computes_rows(&self) -> bool {
        false
    }

    /// Solves the frame after the last, where it remembers that.
    ///
    /// # Errors
    /// As [`Solve::solve`].
    #[doc(hidden)]
    fn follow(
        &self,
        problem: &Problem,
        _last: &mut Last,
        work: &mut Workspace,
        control: &mut Control,
    ) -> Result<Solution, Error> {
        self.solve(problem, work, control)
    }

    /// Whether it remembers its last frame.
    #[doc(hidden)]
    fn remembers(&self) -> bool {
        false
    }

    /// Whether it brings its answer to the problem's level by itself, so that there is nothing to balance.
    fn finds_level(&self) -> bool {
        false
    }

    /// The allowed leak of a quiet point, relative to the loudest point, if the method has such a tolerance.
    #[doc(hidden)]
    fn quiet(&self) -> Option<f64> {
        None
    }

    /// The most that a phase may change from the last drive, in rad, where it holds to that.
    #[doc(hidden)]
    fn bound(&self) -> Option<f64> {
        None
    }

    /// Whether it uses the phases of the targets, where these have any.
    fn uses_phases(&self) -> bool {
        false
    }
}

/// The registry's facts about a method beside its options.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::exhaustive_structs, reason = "a plain list of what is known; Info::new gives the usual values")]
pub struct Info {
    /// Its name.
    pub name: &'static str,
    /// Its description in one line.
    pub summary: &'static str,
    /// Paper and equation.
    pub source: &'static str,
    /// Whether [`crate::solve`] balances the targets by default.
    pub balance: bool,
    /// By how much permuting, moving or mirroring a scene may change a metric (in the mean over 20 scenes).
    pub tolerance: f64,
    /// Whether it uses a start (a drive or point phases).
    pub uses_start: bool,
    /// Whether it uses an aim ("target" or "max").
    pub uses_aim: bool,
}

impl Info {
    /// A method that neither balances nor uses a start or an aim, with a tolerance of 1e-4.
    #[must_use]
    pub const fn new(name: &'static str, summary: &'static str, source: &'static str) -> Self {
        Self { name, summary, source, balance: false, tolerance: 1e-4, uses_start: false, uses_aim: false }
    }

    /// The same, balancing the targets by default.
    #[must_use]
    pub const fn balanced(self) -> Self {
        Self { balance: true, ..self }
    }

    /// The same, using a start.
    #[must_use]
    pub const fn with_start(self) -> Self {
        Self { uses_start: true, ..self }
    }

    /// The same, using an aim.
    #[must_use]
    pub const fn with_aim(self) -> Self {
        Self { uses_aim: true, ..self }
    }

    /// The same with another tolerance.
    #[must_use]
    pub const fn within(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }
}

/// A registered method: options, facts, and [`Solve`].
pub trait Method: Configure + Solve + Send + Sync + 'static {
    /// Its facts.
    const INFO: Info;

    /// Defaults that follow from a device's quantization.
    #[must_use]
    fn device_defaults(_quantization: &Quantization) -> Options {
        Options::new()
    }

    /// Checks the options against each other and their ranges.
    ///
    /// # Errors
    /// A value out of range.
    fn check(&self) -> Result<(), Error>;
}

/// Refuses an iterative method's steps and tolerance out of range.
pub(crate) fn check_iteration(steps: u32, tolerance: f64) -> Result<(), Error> {
    if steps == 0 {
        return Err(Error::invalid("steps", steps, "give at least 1"));
    }
    real("tolerance", tolerance, 0.0, false).map(|_| ())
}
