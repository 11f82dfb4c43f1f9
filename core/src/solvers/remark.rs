//! Remarks: warnings about an answer.
//!
//! Targets beyond reach or too weak, phases left out of account, a scale left over, a bound that lets nothing move, a
//! focus so loud that its harmonics count.

use core::f64::consts::TAU;
use core::fmt;

use crate::device::quantization::steps_within;
use crate::math;
use crate::problem::{Beyond, Problem, Solution};
use crate::scene::Aim;
use crate::solvers::even_field::silence::silenceable;
use crate::solvers::method::Solve;
use crate::solvers::registry::SOLVERS;

/// Warnings about an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::exhaustive_enums, reason = "the eight ways in which an answer differs from the request")]
pub enum Remark {
    /// An impossible request.
    Beyond(Beyond),
    /// The error by which the targets are missed, where that is more than 1 %.
    Missed(f64),
    /// The part of the balanced level that the targets are: below half of it, and nothing balanced them.
    Weak(f64),
    /// Warns that the targets have phases, and the solver does not use them.
    PhasesUnused,
    /// The factor that is left to supply or modulation: the device has no amplitude for the answer.
    Scaled(f64),
    /// A phase may change by less than a step of the board's: every transducer keeps the phase that it has.
    Still {
        /// The most that a phase may change, in rad.
        change: f64,
        /// The board's phases.
        phases: u32,
    },
    /// Warns that quiet points leak more than the solver was to allow.
    Leak {
        /// The highest leak, relative to the loudest point, times the point's weight over the largest weight of the targets.
        leak: f64,
        /// The allowed value.
        quiet: f64,
        /// Quiet points a wavelength apart that this many transducers can silence beside the targets.
        able: usize,
    },
    /// The second harmonic, which the linear model leaves out, is a large part of the loudest point.
    Harmonic {
        /// The estimated share ([`crate::Medium::second_harmonic`]).
        share: f64,
        /// |p| of that point in Pa.
        pressure: f64,
    },
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Beyond(beyond) => beyond.fmt(f),
            Self::Missed(error) => write!(
                f,
                "the pressures are missed by {:.1} % of their root mean square: ask for less, or for fewer points",
                100.0 * error
            ),
            Self::Weak(part) => {
                f.write_str("targets are ")?;
                if *part < 0.01 { write!(f, "{part:.1e}") } else { write!(f, "{part:.2}") }?;
                f.write_str(
                    " of the balanced level: foci this weak come out smeared or too loud, balance=True cures it",
                )
            }
            Self::PhasesUnused => {
                f.write_str("the phases of the pressures are not used by this solver, only |p|: these use them: ")?;
                let users = SOLVERS.iter().filter(|entry| entry.uses_phases());
                users.enumerate().try_for_each(|(k, entry)| {
                    let gap = if k == 0 { "" } else { ", " };
                    write!(f, "{gap}{}", entry.info.name)
                })
            }
            Self::Leak { leak, quiet, able } => write!(
                f,
                "quiet points leak {leak:.1e} of the loudest point where quiet={quiet} allows less: the array silences about \
                 {able} that are a wavelength apart, allow more or ask for fewer"
            ),
            Self::Harmonic { share, pressure } => write!(
                f,
                "at {:.1} kPa the second harmonic, which is not in the model, is estimated at {share:.2} of |p|: the real focus is \
                 weaker; request less, or measure it",
                pressure / 1e3
            ),
            Self::Still { change, phases } => {
                let step = TAU / f64::from(*phases);
                write!(
                    f,
                    "change is {change:.3} rad a frame, less than a step of the board's {phases} phases, {step:.3} rad: no \
                     phase changes and the drive stands still; give 2 pi/{phases} or more, and fewer frames a second where \
                     the transducers need the time"
                )
            }
            Self::Scaled(scale) => write!(
                f,
                "the device has no such amplitude: scale all drives by {scale:.4} by supply or modulation (solution.scale)"
            ),
        }
    }
}

/// The share of the second harmonic that a remark names: that of some 6 kPa.
const HARMONIC: f64 = 0.25;

impl Remark {
    /// Warns that targets are weak, where a solver takes them as they stand.
    #[must_use]
    pub fn weak(problem: &Problem, solver: &dyn Solve, balance: bool) -> Option<Self> {
        weak_part(problem, solver, balance).map(Self::Weak)
    }

    /// Warns that the targets are missed by more than 1 %, where a solver goes on until they are met.
    #[must_use]
    pub fn missed(problem: &Problem, solver: &dyn Solve, solution: &Solution) -> Option<Self> {
        problem.missed(solver.meets_targets(), solver.quiet(), solution).map(Self::Missed)
    }

    /// Warns that the targets have phases which the solver does not use.
    #[must_use]
    pub fn phases_unused(problem: &Problem, solver: &dyn Solve) -> Option<Self> {
        (problem.target_phases().is_some() && !solver.uses_phases()).then_some(Self::PhasesUnused)
    }

    /// Warns that quiet points leak much more than the solver was to allow.
    #[must_use]
    pub fn leak(problem: &Problem, solver: &dyn Solve, solution: &Solution) -> Option<Self> {
        let quiet = solver.quiet()?;
        let leak = problem.leaks(quiet, solution)?;
        let able = silenceable(problem.propagation().transducers(), problem.targeted().len());
        Some(Self::Leak { leak, quiet, able })
    }

    /// Warns that the second harmonic is a large part of the loudest point.
    #[must_use]
    pub fn harmonic(problem: &Problem, solution: &Solution) -> Option<Self> {
        harmonic(problem, solution).map(|(share, pressure)| Self::Harmonic { share, pressure })
    }

    /// Warns that the board's phases are too coarse for the bound on their changes; a bound of 0 requests that.
    #[must_use]
    pub fn still(problem: &Problem, solver: &dyn Solve) -> Option<Self> {
        Self::still_on(solver.bound()?, problem.quantization()?.phases()?)
    }

    /// Warns that the board has too few phases for a bound on their changes in rad.
    #[must_use]
    pub fn still_on(change: f64, phases: u32) -> Option<Self> {
        (change > 0.0 && steps_within(change, phases) < 1.0).then_some(Self::Still { change, phases })
    }

    /// Warns that a factor is left to supply or modulation.
    #[must_use]
    pub fn scaled(solution: &Solution) -> Option<Self> {
        (solution.scale < 1.0).then_some(Self::Scaled(solution.scale))
    }
}

/// The part of the balanced level that weak targets are, where a solver takes them as they stand.
pub(crate) fn weak_part(problem: &Problem, solver: &dyn Solve, balance: bool) -> Option<f64> {
    (problem.is_weak() && !balance && !solver.finds_level() && solver.plays_at_full()).then(|| 1.0 / problem.balance())
}

/// The estimated share of the second harmonic at the loudest point, where it is large and pressures are requested, and |p| in
/// Pa there. Pressures under a signature are not those that are played.
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
