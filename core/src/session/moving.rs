//! Moving: frames of points that move, the rules for what a request leaves out, and their solve one after another.

use alloc::format;
use alloc::vec::Vec;
use core::f64::consts::PI;
use core::ops::Range;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::{Error, real};
use crate::kernels::InstructionSet;
use crate::points::{Path, PathFrames};
use crate::problem::Problem;
use crate::propagation::Model;
use crate::scene::{Aim, Choice, Options, Scene, Signature, Value};
use crate::session::{Frames, Session, SolveRequest};
use crate::solvers::registry;

/// Time in s, to each side, over which the acceleration of points is averaged. A bead oscillates much more slowly.
const LOOK: f64 = 0.5e-3;

/// Default bound in rad per frame. At 10 kHz it is a frequency shift of 312 Hz, which transducers can follow.
const CHANGE: f64 = PI / 16.0;

/// The solver of a motion that names none.
const FOLLOWER: &str = "glide";

/// Frames of moving points with all that their solve needs.
///
/// ```
/// use midair::{Array, Complex32, Control, InstructionSet, Medium, Moving, Pace, Request, Scene};
/// use midair::points::{Curve, Path, Run};
///
/// let circle = Curve::circle([0.0, 0.0, 0.15], 0.01, [0.0, 0.0, 1.0], 0.0)?;
/// let path = Path::along(circle, Run { frequency: Some(5.0), ..Run::default() }, None)?;
/// let start = vec![path.at(0.0, 0).place];
/// let scene = Scene::new(Array::grid(16, 16, 10e-3)?, Medium::default(), start, Request::default())?;
/// let set = InstructionSet::best();
/// let moving = Moving::new(scene, &path, Pace { rate: 1e3, ..Pace::default() }, set)?;
/// let mut session = moving.session(set)?;
/// let mut drives = vec![Complex32::ZERO; moving.frames() * 256];
/// session.follow_moving(&moving, 0..moving.frames(), &mut drives, &mut Control::none())?;
/// assert!(drives.iter().all(|q| q.norm() > 0.999));
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Moving {
    /// The first frame, with array, air and the solver that follows the points.
    pub scene: Scene,
    /// Points (T, M) in m.
    pub points: Vec<[f64; 3]>,
    /// Targets (T, M) in Pa; 0 where a point is absent.
    pub targets: Vec<f64>,
    /// Whether the targets are meant, or the highest pressures in their ratios.
    pub aim: Aim,
    /// Whether the points are traps, or traps and foci, that are solved for the largest stiffness.
    pub stiff: bool,
    /// Frames per second.
    pub rate: f64,
    /// Whether the last frame continues to the first.
    pub closed: bool,
}

/// How fast frames follow one another, and phases may change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "the keys of a motion in a scene file")]
pub struct Pace {
    /// Frames per second.
    pub rate: f64,
    /// Largest change of a phase in rad per frame; or `change_rate`.
    pub change: Option<f64>,
    /// Largest change of a phase in rad/s; or `change`.
    pub change_rate: Option<f64>,
    /// Time constant of the transducers' envelopes in s.
    pub tau: Option<f64>,
    /// Whether the last frame continues to the first; `None` stands for what the path says.
    pub closed: Option<bool>,
}

impl Pace {
    /// Returns the bound of the change of a phase in rad per frame.
    ///
    /// # Errors
    /// `change` and `change_rate` together, or one below 0.
    pub fn bound(&self) -> Result<f64, Error> {
        match (self.change, self.change_rate) {
            (Some(_), Some(other)) => {
                Err(Error::invalid("change_rate", format_args!("{other:?}"), "change is given, too: give one of them"))
            }
            (None, Some(per_second)) => Ok(real("change_rate", per_second, 0.0, false)? / self.rate),
            (change, None) => real("change", change.unwrap_or(CHANGE), 0.0, false),
        }
    }

    /// Checks that a path has frames at this pace.
    ///
    /// # Errors
    /// The errors of [`Path::count`]; `closed` for a path that is not; a time constant below 0.
    pub fn fits(&self, path: &Path) -> Result<(), Error> {
        path.count(self.rate)?;
        real("tau", self.tau.unwrap_or_default(), 0.0, false)?;
        if self.closed == Some(true) && !path.closed() {
            return Err(Error::invalid("closed", true, "the path's end is not its start, leave it out"));
        }
        Ok(())
    }
}

impl Moving {
    /// Returns the frames of a path at a pace. The scene has the path's points at its start, and the solver; without one,
    /// `glide` follows the points.
    ///
    /// # Errors
    /// The errors of [`Pace::fits`], [`Pace::bound`] and [`Problem::reach`]; options that the solver does not have.
    pub fn new(mut scene: Scene, path: &Path, pace: Pace, set: InstructionSet) -> Result<Self, Error> {
        pace.fits(path)?;
        let PathFrames { points, mut targets } = path.frames(pace.rate)?;
        let plain = !path.pascals() && targets.iter().all(|&target| target == 1.0);
        let mut choice = scene.solver.take().map_or_else(|| Choice::new(FOLLOWER.into(), Options::new()), Ok)?;
        let (aim, stiff) = meant(plain, choice.aim, scene.signature());
        if !path.pascals() {
            let control = &mut Control::none();
            let level = Problem::of_scene(&scene, set, control)?.reach(control)?.level;
            targets.iter_mut().zip(level.iter().cycle()).for_each(|(target, level)| *target *= level);
        }
        let entry = registry::find(&choice.name)?;
        let options = entry.options();
        for (key, value) in [("change", Some(pace.bound()?)), ("rate", Some(pace.rate)), ("tau", pace.tau)] {
            let Some(value) = value else { continue };
            if options.iter().any(|option| option.name == key) {
                choice.options.entry(key.into()).or_insert(Value::Real(value));
            } else if key == "tau" {
                let cure = format!("{} takes no account of it, leave it out or use {FOLLOWER}", choice.name);
                return Err(Error::invalid(key, value, cure));
            }
        }
        choice.aim = entry.info.uses_aim.then_some(aim);
        scene.solver = Some(choice);
        let closed = pace.closed.unwrap_or(path.closed());
        Ok(Self { scene, points, targets, aim, stiff, rate: pace.rate, closed })
    }

    /// The number of frames T.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.points.len() / self.count()
    }

    /// The number of points M in a frame.
    #[must_use]
    pub fn count(&self) -> usize {
        self.scene.points().len()
    }

    /// Returns a session of the solver that follows the points.
    ///
    /// # Errors
    /// The errors of [`Session::chosen`].
    pub fn session(&self, set: InstructionSet) -> Result<Session, Error> {
        Session::chosen(Model::of(&self.scene, set), self.scene.solver.as_ref())
    }
}

impl Session {
    /// Solves a range of frames and writes their drives (frames, N). Frames that do not begin with 0 follow those of the last call.
    ///
    /// # Errors
    /// Frames beyond the last, and the errors of [`Session::follow`] with the number of the frame.
    pub fn follow_moving(
        &mut self,
        moving: &Moving,
        range: Range<usize>,
        drives: &mut [Complex32],
        control: &mut Control,
    ) -> Result<(), Error> {
        let (count, frames, first) = (moving.count(), moving.frames(), range.start);
        if range.is_empty() || range.end > frames {
            return Err(Error::invalid("frames", format!("{range:?}"), format!("give some of {frames}")));
        }
        if first == 0 {
            self.last.clear();
        }
        // The acceleration of stiff traps is that of the frames around. Outside an open sequence the points stand still.
        let stiff = moving.stiff && self.task.solver.remembers();
        let margin = if stiff { look(moving.rate) } else { 0 };
        let around = (0..range.len() + 2 * margin).flat_map(|k| {
            let frame = (first + k) as isize - margin as isize;
            let all = frames as isize;
            let frame = if moving.closed { frame.rem_euclid(all) } else { frame.clamp(0, all - 1) };
            &moving.points[frame as usize * count..][..count]
        });
        let points: Vec<[f64; 3]> = around.copied().collect();
        let targets = (!stiff).then(|| &moving.targets[first * count..range.end * count]);
        let mut ask =
            SolveRequest { aim: moving.scene.solver.as_ref().and_then(|choice| choice.aim), ..SolveRequest::default() };
        self.follow(Frames { points: &points, targets, count, margin, first }, &mut ask, drives, control)
    }
}

/// Returns the aim of moving points, and whether they are solved as the stiffest traps. Points that are given alone, `plain`, get
/// the highest pressures, unless an aim says otherwise; traps among them, or among foci, are made as stiff as possible.
#[must_use]
pub fn meant(plain: bool, aim: Option<Aim>, signature: Option<&Signature>) -> (Aim, bool) {
    let aim = aim.unwrap_or(if plain { Aim::Max } else { Aim::Target });
    (aim, plain && aim == Aim::Max && signature.is_some_and(Signature::traps))
}

/// Returns the number of later frames that a solve knows; `None` for all. A closed sequence needs all.
///
/// # Errors
/// No whole number of at least 0, a word other than "all"; a closed sequence that does not know all.
pub fn sight(ahead: Option<&Value>, closed: bool) -> Result<Option<usize>, Error> {
    let frames = match ahead {
        Some(Value::Text(word)) if word == "all" => return Ok(None),
        None => 0,
        Some(&Value::Integer(frames @ 0..)) => usize::try_from(frames).unwrap_or(usize::MAX),
        Some(Value::Real(number)) => {
            return Err(Error::invalid("ahead", format_args!("{number:?}"), "give a whole number"));
        }
        Some(word @ Value::Text(_)) => {
            return Err(Error::invalid("ahead", word, "give a whole number of frames, or \"all\""));
        }
        Some(other) => return Err(Error::invalid("ahead", other, "give a whole number of at least 0")),
    };
    if closed {
        let cure = "give ahead = \"all\", that the last frame meets the first";
        return Err(Error::invalid("closed", format!("true, but ahead is {frames}"), cure));
    }
    Ok(Some(frames))
}

/// Returns the number of frames on each side from which the acceleration of points is computed.
#[must_use]
pub fn look(rate: f64) -> usize {
    (crate::math::rint(LOOK * rate) as usize).max(1)
}
