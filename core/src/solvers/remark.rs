//! Remarks: warnings about a solution.
//!
//! They concern targets that are beyond reach or too weak, phases that are not used, a remaining scale, a bound that
//! allows no change, a focus so loud that harmonics matter, and traps that lose their beads.

use crate::device::quantization::steps_within;
use crate::problem::{Beyond, Setup};
use crate::scene::{Aim, figures};
use crate::solvers::even_field::quiet::silenceable;
use crate::solvers::prelude::*;
use crate::solvers::{Last, SOLVERS};

/// A warning about a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// A point moves so far from one frame to the next that its focus cannot follow within the bound.
    Fast {
        /// How far it moves, in m.
        moved: f64,
        /// The change of a phase that its focus needs, in rad.
        needed: f64,
        /// The largest change of a phase, in rad.
        change: f64,
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
    /// Traps whose beads fall.
    Fallen {
        /// How many traps hold their bead.
        kept: usize,
        /// The number of traps.
        traps: usize,
    },
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.notice().fmt(f)
    }
}

impl Remark {
    /// Returns the parts of the warning.
    pub fn notice(&self) -> Notice {
        match self {
            Self::Beyond(beyond) => beyond.notice(),
            Self::Missed(error) => {
                let value = format!("{:.1} % of their root mean square", 100.0 * error);
                let faint = *error > 1.0 - FAINT;
                let cure = if faint { "scale the drive, up to |q| = 1" } else { "request less, or fewer points" };
                Notice::new(ErrorCode::Missed, "the pressures", value, cure)
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
                    format!("the array silences about {able} that are a wavelength apart, allow more or request fewer");
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
            Self::Fast { moved, needed, change } => {
                let [moved, needed, change] = [1e3 * moved, *needed, *change].map(|number| figures(number, 3));
                let value =
                    format!("{moved} mm in a frame, which needs phase changes of {needed} rad, {change} allowed");
                let cure = "the level falls; move slower, send points more often, or allow a larger change";
                Notice::new(ErrorCode::Doubtful, "a point", value, cure).verb("moves by")
            }
            Self::Fallen { kept, traps } => {
                let value = format!("{kept} of {traps} beads");
                let cure = "request fewer traps, give each transducer its own channel, move them between two sides, or take \
                            a lighter bead";
                Notice::new(ErrorCode::Fallen, "traps", value, cure).verb("hold").other(format_args!("{kept}/{traps}"))
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

/// The number of kinds of remarks.
pub(crate) const KINDS: usize = 10;

/// The numbers of [`Remark::Fast`] and [`Remark::Fallen`], which a session adds itself.
pub(crate) const FAST: usize = KINDS - 2;
pub(crate) const FALLEN: usize = KINDS - 1;

/// The level below which a solution counts as a mistake of its method, as by a drive that was not scaled.
const FAINT: f64 = 0.01;

/// The share of the second harmonic from which on there is a warning: that of about 6 kPa.
const HARMONIC: f64 = 0.25;

impl Remark {
    /// Warns of a board with too few phases for a bound on their changes in rad, unless the bound is 0.
    pub fn still_on(change: f64, phases: u32) -> Option<Self> {
        (change > 0.0 && steps_within(change, phases) < 1.0).then_some(Self::Still { change, phases })
    }

    /// How far the solution is from the request. It compares remarks of one kind: the largest is the worst.
    pub(crate) fn severity(&self) -> f64 {
        match *self {
            Self::Beyond(Beyond::Alone { target, alone, .. }) => target / alone,
            Self::Missed(error) => error,
            Self::Beyond(Beyond::Together { most: part }) | Self::Weak(part) | Self::Scaled(part) => 1.0 / part,
            Self::Leak { leak, quiet, .. } => leak / quiet,
            Self::Harmonic { share, .. } => share,
            Self::Fast { needed, change, .. } => needed / change,
            Self::Fallen { kept, traps, .. } => (traps - kept) as f64,
            Self::PhasesUnused | Self::Still { .. } => 1.0,
        }
    }
}

/// Returns the warnings about a solution, at most one of each kind, in the order in which all languages report them.
/// `last` is the memory of the last frame in a session. `beyond` is the result of [`Problem::beyond`], which may take long,
/// or of [`Problem::beyond_alone`].
///
/// ```
/// use midair::solvers::{Greedy, remarks};
/// use midair::{Array, Control, Medium, Problem, Request, Scene, Workspace};
///
/// let request = Request { pressures: Some(vec![1e4]), ..Request::default() };
/// let scene = Scene::new(Array::preset("paper20", [1, 1])?, Medium::default(), vec![[0.0, 0.0, 0.15]], request)?;
/// let (problem, solver) = (Problem::new(&scene)?, Greedy::default());
/// let solution = midair::solve(&problem, &solver, false, &mut Workspace::new(), &mut Control::none())?;
/// let warnings = remarks(&problem, &solver, false, None, &solution, problem.beyond_alone());
/// let texts: Vec<String> = warnings.iter().flatten().map(ToString::to_string).collect();
/// assert!(texts[0].starts_with("points[0].pressure is 10000 Pa, beyond reach"));
/// # Ok::<(), midair::Error>(())
/// ```
pub fn remarks(
    problem: &Problem,
    solver: &dyn Solve,
    balance: bool,
    last: Option<&Last>,
    solution: &Solution,
    beyond: Option<Beyond>,
) -> [Option<Remark>; KINDS] {
    let missed = problem.missed(solver.quiet(), solution).filter(|_| solver.meets_targets());
    let sounds = problem.active_targets_in_pascals().any(|target| target > 0.0) && solution.status != Status::Stopped;
    let level = solution.metrics().level;
    // No target states the pressure at a trap.
    let focused = problem.propagation().signature().is_none();
    let meant = focused && (problem.aim() == Aim::Target || !problem.asks_pressures());
    let missed = missed.or((sounds && meant && beyond.is_none() && level < FAINT).then_some(1.0 - level));
    let weak = problem.is_weak() && !balance && !solver.finds_level() && solver.plays_at_full();
    let unused = problem.target_phases().is_some() && !solver.uses_phases();
    let follows = problem.start_drive().is_some() || last.is_some_and(|last| !last.is_empty());
    let scale = solution.scale;
    [
        beyond.map(Remark::Beyond),
        missed.map(Remark::Missed),
        weak.then(|| Remark::Weak(1.0 / problem.balance())),
        unused.then_some(Remark::PhasesUnused),
        leak(problem, solver, solution),
        if follows { still(problem, solver) } else { None },
        (scale < 1.0).then_some(Remark::Scaled(scale)),
        harmonic(problem, solution),
        None,
        None,
    ]
}

/// Warns of traps that do not hold their beads. [`remarks`] leaves this out: it takes as long as some steps of a solver.
///
/// # Errors
/// The errors of [`Solution::beads`].
pub fn fallen(solution: &Solution, control: &mut Control) -> Result<Option<Remark>> {
    let beads = if solution.status == Status::Stopped { None } else { solution.beads(control)? };
    Ok(beads.filter(|[kept, traps]| kept < traps).map(|[kept, traps]| Remark::Fallen { kept, traps }))
}

/// Returns the change of a phase in rad that a focus needs to move between two places.
///
/// Let it move by d along e, and let `u_i` be the direction from transducer i to it. The phase of transducer i changes by
/// k d (`u_i` . e). A common phase of all transducers is free, so half the spread of k d (`u_i` . e) is needed.
pub(crate) fn change_needed(positions: &[[f64; 3]], wavelength: f64, from: [f64; 3], to: [f64; 3]) -> f64 {
    let moved = Vec3(to) - Vec3(from);
    let along = positions.iter().map(|&place| {
        let ray = Vec3(to) - Vec3(place);
        ray.dot(moved) / ray.norm().max(1e-9)
    });
    let [least, most] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    PI * (most - least) / wavelength
}

/// Warns of a point that moves too far between two frames for a bound in rad.
pub(crate) fn fast(setup: &Setup, change: f64, before: &[[f64; 3]], now: &[[f64; 3]]) -> Option<Remark> {
    let (positions, wavelength) = (setup.positions.as_deref()?, setup.medium.wavelength());
    let each = before.iter().zip(now).map(|(&from, &to)| (change_needed(positions, wavelength, from, to), from, to));
    let (needed, from, to) = each.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let moved = (Vec3(to) - Vec3(from)).norm();
    (needed > change * (1.0 + 1e-9) && change > 0.0).then_some(Remark::Fast { moved, needed, change })
}

/// Warns of quiet points that leak much more than the solver's tolerance.
fn leak(problem: &Problem, solver: &dyn Solve, solution: &Solution) -> Option<Remark> {
    let quiet = solver.quiet()?;
    let leak = problem.leaks(quiet, solution)?;
    let able = silenceable(problem.propagation().transducers(), problem.targeted().len());
    Some(Remark::Leak { leak, quiet, able })
}

/// Warns of a board whose phases are too coarse for the bound on their changes.
fn still(problem: &Problem, solver: &dyn Solve) -> Option<Remark> {
    Remark::still_on(solver.bound()?, problem.quantization()?.phases()?)
}

/// Warns of a large second harmonic at the loudest point, if pressures are requested. With a signature it returns `None`: the
/// real pressures then differ from these.
fn harmonic(problem: &Problem, solution: &Solution) -> Option<Remark> {
    let signed = problem.propagation().signature().is_some();
    if !problem.asks_pressures() || problem.aim() != Aim::Target || signed {
        return None;
    }
    let loudest = solution.pressures.iter().fold(0.0f32, |most, p| most.max(p.norm_sqr()));
    let pressure = math::sqrt(f64::from(loudest));
    let share = problem.setup().medium.second_harmonic(pressure);
    (share > HARMONIC).then_some(Remark::Harmonic { share, pressure })
}
