//! Remarks: warnings about a solution.
//!
//! They concern targets that are beyond reach or too weak, phases that are not used, a remaining scale, a bound that
//! allows no change, and a focus so loud that harmonics matter.

use alloc::format;
use alloc::vec::Vec;
use core::f64::consts::TAU;
use core::fmt;

use crate::device::quantization::steps_within;
use crate::error::{ErrorCode, Notice};
use crate::math;
use crate::problem::{Beyond, Problem, Solution};
use crate::scene::Aim;
use crate::solvers::even_field::silence::silenceable;
use crate::solvers::method::Solve;
use crate::solvers::registry::SOLVERS;

/// A warning about a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::exhaustive_enums, reason = "the eight ways in which an answer differs from the request")]
pub enum Remark {
    /// An impossible request.
    Beyond(Beyond),
    /// The targets are missed by this relative error, which is above 1 %.
    Missed(f64),
    /// The targets are weak: this part of the balanced level, below a half. No balancing raised them before the solve.
    Weak(f64),
    /// The targets have phases, and the solver does not use them.
    PhasesUnused,
    /// The device has no amplitude for the solution; this factor must come from supply voltage or modulation.
    Scaled(f64),
    /// A phase may change by less than a step of the board's: every transducer keeps its phase.
    Still {
        /// The largest change of a phase, in rad.
        change: f64,
        /// The number of the board's phases.
        phases: u32,
    },
    /// Quiet points leak more than the solver's tolerance.
    Leak {
        /// The highest leak, relative to the loudest point, times the point's weight over the largest weight of the
        /// targets.
        leak: f64,
        /// The solver's tolerance for the leak.
        quiet: f64,
        /// The number of quiet points, a wavelength apart, that the array's transducers can silence besides the
        /// targets.
        able: usize,
    },
    /// The second harmonic, which the linear model leaves out, is a large part of the pressure at the loudest point.
    Harmonic {
        /// The estimated share of the second harmonic ([`crate::Medium::second_harmonic`]).
        share: f64,
        /// |p| at the loudest point, in Pa.
        pressure: f64,
    },
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.notice().fmt(f)
    }
}

impl Remark {
    /// Returns the parts of the warning.
    #[must_use]
    pub fn notice(&self) -> Notice {
        match self {
            Self::Beyond(beyond) => beyond.notice(),
            Self::Missed(error) => {
                let value = format!("{:.1} % of their root mean square", 100.0 * error);
                Notice::new(ErrorCode::Missed, "the pressures", value, "ask for less, or for fewer points")
                    .verb("are missed by")
                    .other(format_args!("{:.1} %", 100.0 * error))
            }
            Self::Weak(part) => {
                let part = if *part < 0.01 { format!("{part:.1e}") } else { format!("{part:.2}") };
                let cure = "foci this weak come out smeared or too loud, balance=True cures it";
                Notice::new(ErrorCode::Weak, "targets", format!("{part} of the balanced level"), cure)
                    .verb("are")
                    .other(part)
            }
            Self::PhasesUnused => {
                let users = SOLVERS.iter().filter(|entry| entry.uses_phases()).map(|entry| entry.info.name);
                let cure = format!("these use them: {}", users.collect::<Vec<_>>().join(", "));
                let value = "not used by this solver, only |p|";
                Notice::new(ErrorCode::PhasesUnused, "the phases of the pressures", value, cure).verb("are")
            }
            Self::Leak { leak, quiet, able } => {
                let value = format!("{leak:.1e} of the loudest point where quiet={quiet} allows less");
                let cure =
                    format!("the array silences about {able} that are a wavelength apart, allow more or ask for fewer");
                Notice::new(ErrorCode::Leak, "quiet points", value, cure).verb("leak").other(able)
            }
            Self::Harmonic { share, pressure } => {
                let pressure = format!("{:.1} kPa", pressure / 1e3);
                let item = format!("at {pressure} the second harmonic, which is not in the model,");
                let cure = "the real focus is weaker; request less, or measure it";
                Notice::new(ErrorCode::Harmonic, item, format!("{share:.2} of |p|"), cure)
                    .verb("is estimated at")
                    .other(pressure)
            }
            Self::Still { change, phases } => {
                let step = TAU / f64::from(*phases);
                let value =
                    format!("{change:.3} rad a frame, less than a step of the board's {phases} phases, {step:.3} rad");
                let cure = format!(
                    "no phase changes and the drive stands still; give 2 pi/{phases} or more, and fewer frames a second where \
                     the transducers need the time"
                );
                Notice::new(ErrorCode::Still, "change", value, cure).other(format_args!("{step:.3} rad"))
            }
            Self::Scaled(scale) => {
                let cure = format!("scale all drives by {scale:.4} by supply or modulation (solution.scale)");
                Notice::new(ErrorCode::Scaled, "the device", "no such amplitude", cure)
                    .verb("has")
                    .other(format_args!("{scale:.4}"))
            }
        }
    }
}

/// The share of the second harmonic from which on there is a warning: that of about 6 kPa.
const HARMONIC: f64 = 0.25;

impl Remark {
    /// Warns of weak targets that a solver does not balance.
    #[must_use]
    pub fn weak(problem: &Problem, solver: &dyn Solve, balance: bool) -> Option<Self> {
        weak_part(problem, solver, balance).map(Self::Weak)
    }

    /// Warns of targets missed by more than 1 %, for a solver that continues until they are met.
    #[must_use]
    pub fn missed(problem: &Problem, solver: &dyn Solve, solution: &Solution) -> Option<Self> {
        problem.missed(solver.meets_targets(), solver.quiet(), solution).map(Self::Missed)
    }

    /// Warns of phases of the targets that the solver does not use.
    #[must_use]
    pub fn phases_unused(problem: &Problem, solver: &dyn Solve) -> Option<Self> {
        (problem.target_phases().is_some() && !solver.uses_phases()).then_some(Self::PhasesUnused)
    }

    /// Warns of quiet points that leak much more than the solver's tolerance.
    #[must_use]
    pub fn leak(problem: &Problem, solver: &dyn Solve, solution: &Solution) -> Option<Self> {
        let quiet = solver.quiet()?;
        let leak = problem.leaks(quiet, solution)?;
        let able = silenceable(problem.propagation().transducers(), problem.targeted().len());
        Some(Self::Leak { leak, quiet, able })
    }

    /// Warns of a large second harmonic at the loudest point.
    #[must_use]
    pub fn harmonic(problem: &Problem, solution: &Solution) -> Option<Self> {
        harmonic(problem, solution).map(|(share, pressure)| Self::Harmonic { share, pressure })
    }

    /// Warns of a board whose phases are too coarse for the bound on their changes, unless the bound is 0.
    #[must_use]
    pub fn still(problem: &Problem, solver: &dyn Solve) -> Option<Self> {
        Self::still_on(solver.bound()?, problem.quantization()?.phases()?)
    }

    /// Warns of a board with too few phases for a bound on their changes in rad.
    #[must_use]
    pub fn still_on(change: f64, phases: u32) -> Option<Self> {
        (change > 0.0 && steps_within(change, phases) < 1.0).then_some(Self::Still { change, phases })
    }

    /// Warns of a factor that supply voltage or modulation must provide.
    #[must_use]
    pub fn scaled(solution: &Solution) -> Option<Self> {
        (solution.scale < 1.0).then_some(Self::Scaled(solution.scale))
    }
}

/// Returns the part of the balanced level that weak targets have, for a solver that does not balance them.
pub(crate) fn weak_part(problem: &Problem, solver: &dyn Solve, balance: bool) -> Option<f64> {
    (problem.is_weak() && !balance && !solver.finds_level() && solver.plays_at_full()).then(|| 1.0 / problem.balance())
}

/// Returns the estimated share of the second harmonic at the loudest point, and |p| in Pa there, if the share is large
/// and pressures are requested. With a signature it returns `None`: the real pressures then differ from these.
pub(crate) fn harmonic(problem: &Problem, solution: &Solution) -> Option<(f64, f64)> {
    let kept = problem.propagation().origin().and_then(|(.., kept)| kept);
    if !problem.asks_pressures() || problem.aim() != Aim::Target || kept.is_some_and(|kept| kept.signature.is_some()) {
        return None;
    }
    let loudest = solution.pressures.iter().fold(0.0f32, |most, p| most.max(p.norm_sqr()));
    let pressure = math::sqrt(f64::from(loudest));
    let share = problem.setup().medium.second_harmonic(pressure);
    (share > HARMONIC).then_some((share, pressure))
}
