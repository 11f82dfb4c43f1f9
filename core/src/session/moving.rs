//! Moving: frames of points that move, the rules for what a request leaves out, and their solve one after another.

use crate::device::quantization::steps_within;
use crate::math::{ceil, rint};
use crate::points::{Path, PathFrames};
use crate::propagation::Model;
use crate::propagation::forces::rest::{poised, rest};
use crate::scene::{Aim, Bead, Choice, Options, Request, Scene, Signature, Value, figures};
use crate::sequence::horizon::PHASES;
use crate::session::{Frames, Session, SolveRequest};
use crate::solvers::prelude::*;
use crate::solvers::remark::{self, change_needed};
use crate::solvers::solve::solve;
use crate::solvers::{Remark, registry};

/// Time in s, to each side, over which the acceleration of points is averaged. A bead oscillates much more slowly.
const LOOK: f64 = 0.5e-3;

/// Default bound in rad per frame. At 10 kHz it is a frequency shift of 312 Hz, which transducers can follow.
const CHANGE: f64 = PI / 16.0;

/// The solver of a motion that names none.
pub const FOLLOWER: &str = "glide";

/// The largest number of frames that are examined for the speed of points.
const LOOKED: usize = 200;

/// Accelerations below this, in m/s^2, are possible for any trap.
const SLIGHT: f64 = 1.0;

/// Speed in m/s below which the catch of a bead is not judged.
const SLOW: f64 = 0.05;

/// Speed in m/s above which a trap that was solved for the launch may hold no bead at rest.
const FAST: f64 = 0.5;

/// Time in s over which the acceleration of a trap is averaged, to each side, before it is compared with the trap's forces.
const WHILE: f64 = 3e-3;

/// The largest number of frames whose highest even level is computed for a path with modulations or fades.
const JUDGED: usize = 16;

/// Frames of moving points with all that their solve needs.
///
/// ```
/// use midair::{Array, Complex32, Control, InstructionSet, Medium, Moving, Pace, Request, Scene, Trajectory};
/// use midair::points::{Curve, Path, Run};
///
/// let circle = Curve::circle([0.0, 0.0, 0.15], 0.01, [0.0, 0.0, 1.0], 0.0)?;
/// let path = Path::along(circle, Run { frequency: Some(5.0), ..Run::default() }, None)?;
/// let start = vec![path.at(0.0, 0).place];
/// let scene = Scene::new(Array::grid(16, 16, 10e-3)?, Medium::default(), start, Request::default())?;
/// let set = InstructionSet::best();
/// let pace = Pace { rate: 1e3, ..Pace::default() };
/// let moving = Moving::new(scene, Trajectory::of(&path, pace.rate)?, pace, Some(0), set)?;
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
    /// The largest change of a phase in rad per frame.
    pub change: f64,
    /// Whether the last frame continues to the first.
    pub closed: bool,
    /// The number of later frames that each frame is solved with; `None` for all.
    pub ahead: Option<usize>,
    pace: Pace,
}

/// Frames of points before their targets are known in Pa.
#[derive(Clone, Debug, Default)]
pub struct Trajectory {
    /// Points (T, M) in m.
    pub points: Vec<[f64; 3]>,
    /// The number of points M in a frame.
    pub count: usize,
    /// Targets (T, M): in Pa, or factors from 0 to 1 of the highest level that the array makes even in all frames. `None` for
    /// points alone.
    pub targets: Option<Vec<f64>>,
    /// Whether the targets are in Pa.
    pub pascals: bool,
    /// Whether the end of the path joins its start. `None` for frames that are no path: they may be closed all the same.
    pub joined: Option<bool>,
}

impl Trajectory {
    /// Returns the frames of a path.
    ///
    /// # Errors
    /// The errors of [`Path::frames`].
    pub fn of(path: &Path, rate: f64) -> Result<Self> {
        let PathFrames { points, targets } = path.frames(rate)?;
        let plain = !path.pascals() && targets.iter().all(|&target| target == 1.0);
        let targets = (!plain).then_some(targets);
        Ok(Self { points, count: path.points(), targets, pascals: path.pascals(), joined: Some(path.closed()) })
    }
}

/// How fast frames follow one another, and phases may change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// `change` and `change_rate` together, or one below 0; the errors of [`frame_rate`].
    pub fn bound(&self) -> Result<f64> {
        frame_rate(self.rate)?;
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
    pub fn fits(&self, path: &Path) -> Result<()> {
        path.count(self.rate)?;
        real("tau", self.tau.unwrap_or_default(), 0.0, false)?;
        self.closes(Some(path.closed())).map(|_| ())
    }

    /// Returns whether the last frame continues to the first. `joined` is that of a [`Trajectory`].
    ///
    /// # Errors
    /// `closed` for a path that is not.
    pub fn closes(&self, joined: Option<bool>) -> Result<bool> {
        if self.closed == Some(true) && joined == Some(false) {
            return Err(Error::invalid("closed", true, "the path's end is not its start, leave it out"));
        }
        Ok(self.closed.or(joined).unwrap_or(false))
    }

    /// Returns a choice with the bound, the rate and the time constant, as far as its solver has such options.
    ///
    /// # Errors
    /// An unknown solver, the errors of [`Pace::bound`], a time constant for a solver without one.
    pub fn followed(&self, mut choice: Choice) -> Result<Choice> {
        let options = registry::find(&choice.name)?.options();
        for (key, value) in [("change", Some(self.bound()?)), ("rate", Some(self.rate)), ("tau", self.tau)] {
            let Some(value) = value else { continue };
            if options.iter().any(|option| option.name == key) {
                choice.options.entry(key.into()).or_insert(Value::Real(value));
            } else if key == "tau" {
                let cure = format!("{} takes no account of it, leave it out or use {FOLLOWER}", choice.name);
                return Err(Error::invalid(key, format_args!("{value:?}"), cure));
            }
        }
        Ok(choice)
    }

    /// Checks what cannot be combined with later frames: they are solved without a solver of a name.
    ///
    /// # Errors
    /// Another solver than the default one, options, a time constant.
    pub fn together(&self, choice: &Choice) -> Result<()> {
        if choice.name != FOLLOWER {
            let (name, cure) =
                (format!("\"{}\"", choice.name), "with ahead the tracks are found by themselves, leave it out");
            return Err(Error::invalid("solver", name, cure));
        }
        if let Some(tau) = self.tau {
            let cure = "with ahead the tracks take no account of it: leave out tau, or ahead";
            return Err(Error::invalid("tau", format_args!("{tau:?}"), cure));
        }
        let balance = choice.balance.map(|_| "balance");
        match choice.options.keys().map(String::as_str).chain(balance).min() {
            None => Ok(()),
            Some(key) => Err(Error::conflict(key, "given", "with ahead there is no such option, leave it out")),
        }
    }

    /// Returns a warning about a bound that binds nothing.
    pub fn doubt(&self) -> Option<Notice> {
        let change = self.change.filter(|&change| change > PI)?;
        let cure = format!("give {} if degrees are meant, pi for no bound", figures(change.to_radians(), 3));
        let value = format!("{} rad, and above pi binds nothing", figures(change, 6));
        Some(Notice::new(ErrorCode::Doubtful, "change", value, cure))
    }
}

impl Moving {
    /// Returns the frames of a trajectory at a pace. The scene has its points at the start, and the solver; without one, `glide`
    /// follows the points. `ahead` is the result of [`sight`].
    ///
    /// # Errors
    /// The errors of [`Pace::closes`], [`Pace::followed`], [`Pace::together`] and [`Problem::reach`].
    pub fn new(
        mut scene: Scene,
        frames: Trajectory,
        pace: Pace,
        ahead: Option<usize>,
        set: InstructionSet,
    ) -> Result<Self> {
        let closed = pace.closes(frames.joined)?;
        let Trajectory { points, targets, pascals, .. } = frames;
        let mut choice = scene.solver.take().map_or_else(|| Choice::new(FOLLOWER.into(), Options::new()), Ok)?;
        let (aim, stiff) = meant(targets.is_none(), choice.aim, scene.signature());
        let modulated = targets.is_some() && scene.signature().is_none();
        let mut targets = targets.unwrap_or_else(|| vec![1.0; points.len()]);
        if !pascals {
            let control = &mut Control::none();
            let level = Problem::of_scene(&scene, set, control)?.reach(control)?.level;
            let factor = if modulated { evenly(&scene, &points, &level, set, control)? } else { 1.0 };
            targets.iter_mut().zip(level.iter().cycle()).for_each(|(target, level)| *target *= factor * level);
        }
        let change = pace.bound()?;
        if ahead == Some(0) {
            choice = pace.followed(choice)?;
        } else {
            pace.together(&choice)?;
        }
        choice.aim = registry::find(&choice.name)?.info.uses_aim.then_some(aim);
        scene.solver = Some(choice);
        Ok(Self { scene, points, targets, aim, stiff, rate: pace.rate, change, closed, ahead, pace })
    }

    /// Returns the same frames for another array in `scene`, such as one with the phases of a board.
    #[must_use]
    pub fn played_on(mut self, mut scene: Scene) -> Self {
        scene.solver = self.scene.solver.take();
        Self { scene, ..self }
    }

    /// The board on which the frames are played. Frames that are solved together need phases: 256 if the array has none.
    pub fn board(&self) -> Option<Quantization> {
        let board = self.scene.array().quantization().filter(|board| !board.is_continuous()).cloned();
        if self.ahead == Some(0) || board.as_ref().is_some_and(|board| board.phases().is_some()) {
            return board;
        }
        Quantization::new(Some(PHASES), board.and_then(|board| board.amplitudes().map(<[f64]>::to_vec))).ok()
    }

    /// Whether all drives have full amplitude.
    pub fn is_full(&self) -> bool {
        let sounds = |targets: &[f64]| targets.iter().any(|&target| target > 0.0);
        self.aim == Aim::Max && self.targets.chunks(self.count()).all(sounds)
    }

    /// Returns probable mistakes: pressures that change although the highest are requested, points that are faster than the bound
    /// allows, a bound that binds nothing or is below a step of the board's phases. The solver of single frames reports the last itself.
    pub fn doubts(&self) -> Vec<Notice> {
        let phases = self.board().and_then(|board| board.phases()).filter(|_| self.ahead != Some(0));
        let still = phases.and_then(|phases| Remark::still_on(self.change, phases));
        let still = still.map(|remark| remark.notice());
        [self.swelling(), self.pace.doubt(), self.too_fast(), still].into_iter().flatten().collect()
    }

    /// Warns if the sum of the targets changes, over frames with all points present.
    fn swelling(&self) -> Option<Notice> {
        let all = self.targets.chunks(self.count()).filter(|targets| targets.iter().all(|&target| target > 0.0));
        let sums = all.map(|targets| targets.iter().sum::<f64>());
        let (least, most) = sums.fold((f64::INFINITY, 0.0_f64), |(least, most), sum| (least.min(sum), most.max(sum)));
        (self.aim == Aim::Max && most > 1.01 * least).then(|| {
            let value = "\"max\", but pressures change between frames";
            Notice::new(ErrorCode::Doubtful, "aim", value, "leave it out, it plays each frame in full")
        })
    }

    /// Warns of points that move faster than a focus can follow within the bound (docs/motion.md).
    ///
    /// On a board's grid the bound is a whole number of phase steps; if none fits, the solver reports that.
    fn too_fast(&self) -> Option<Notice> {
        let entry = self.scene.solver.as_ref().and_then(|choice| registry::find(&choice.name).ok())?;
        if self.change > PI || !entry.options().iter().any(|option| option.name == "change") {
            return None;
        }
        let (needed, speed) = self.needed();
        let phases = self.board().and_then(|board| board.phases());
        let step = phases.map(|phases| 2.0 * PI / f64::from(phases));
        let allowed = match (phases, step) {
            (Some(phases), Some(step)) => step * steps_within(self.change, phases),
            _ => self.change,
        };
        if needed <= allowed * (1.0 + 1e-9) || (allowed == 0.0 && self.change > 0.0) {
            return None;
        }
        let (item, needs) = (format!("{} m/s", figures(speed, 3)), format!("{} rad a frame", figures(needed, 2)));
        if allowed == 0.0 {
            let cure = format!("{item} needs {needs}, give as much, or pi for no bound");
            return Some(Notice::new(ErrorCode::Doubtful, "change", "0, and no phase changes", cure));
        }
        let faster = ceil(self.rate * needed / allowed / 100.0) / 10.0;
        let wanted = step.map_or(needed, |step| step * ceil(needed / step));
        let wider = match (PI / wanted) as u32 {
            0 => String::new(),
            1 => " or change = pi".into(),
            part => format!(" or change = pi/{part}"),
        };
        let whole = phases.filter(|_| allowed < self.change * (1.0 - 1e-9));
        let whole = whole.map_or_else(String::new, |phases| format!(" in whole steps of {phases} phases"));
        let value = format!("{needs}, {} allowed{whole}", figures(allowed, 3));
        let cure = format!("the level falls; rate = {} kHz{wider} would do", figures(faster, 6));
        Some(Notice::new(ErrorCode::Doubtful, item, value, cure).verb("needs"))
    }

    /// Returns the largest bound in rad that any point needs, over some frames, and the speed of this point in m/s.
    fn needed(&self) -> (f64, f64) {
        let (frames, count, wavelength) = (self.frames(), self.count(), self.scene.medium().wavelength());
        let steps = (usize::from(!self.closed)..frames).step_by(((frames - 1) / LOOKED).max(1));
        let (mut most, mut speed) = (0.0, 0.0);
        for (t, before) in steps.map(|t| (t, t.checked_sub(1).unwrap_or(frames - 1))) {
            let both = (0..count).map(|j| [t * count + j, before * count + j]);
            for [now, before] in both.filter(|both| both.iter().all(|&k| self.targets[k] > 0.0)) {
                let [from, to] = [self.points[before], self.points[now]];
                let needed = change_needed(self.scene.array().positions(), wavelength, from, to);
                if needed > most {
                    (most, speed) = (needed, (Vec3(to) - Vec3(from)).norm() * self.rate);
                }
            }
        }
        (most, speed)
    }

    /// Returns where each trap has to accelerate its bead the most, without those of slight accelerations. At the first and the
    /// last frame of an open motion, each trap has to catch its bead.
    pub fn pulls(&self) -> Vec<Pull> {
        let (frames, count) = (self.frames(), self.count());
        let apart = (rint(WHILE * self.rate) as usize).max(1);
        if self.scene.signature().is_none() || frames <= 2 {
            return Vec::new();
        }
        let times = if self.closed { 0..frames } else { apart..frames.saturating_sub(apart) };
        let far = self.rate / apart as f64;
        let of = |point: usize| {
            let pull = |frame: usize| {
                let at = |frame: usize| Vec3(self.points[frame % frames * count + point]);
                let [before, now, after] = [at(frame + frames - apart), at(frame), at(frame + apart)];
                let there = self.targets[frame * count + point] > 0.0;
                let acceleration = (far * far) * (before - 2.0 * now + after);
                let size = if there { acceleration.norm() } else { 0.0 };
                (
                    size,
                    Pull { point, frame, velocity: ((far / 2.0) * (after - before)).0, acceleration: acceleration.0 },
                )
            };
            let most = times.clone().map(pull).reduce(|most, other| if other.0 > most.0 { other } else { most });
            most.filter(|most| most.0 >= SLIGHT).map(|most| most.1)
        };
        let end = |point: usize, frame: usize, next: usize| {
            let [here, there] = [frame, next].map(|frame| Vec3(self.points[frame * count + point]));
            let velocity = (self.rate * (there - here)).0;
            Pull { point, frame, velocity, acceleration: [0.0; 3] }
        };
        let ends = |point: usize| [end(point, 0, 1), end(point, frames - 1, frames - 2)];
        let open = (0..count).filter(|_| !self.closed).flat_map(ends);
        open.chain((0..count).filter_map(of)).collect()
    }

    /// Returns a warning if the trap of a pull cannot give its bead the force, with the frame's drive (N,).
    ///
    /// # Errors
    /// The errors of [`poised`].
    pub fn strained(
        &self,
        pull: &Pull,
        model: &Model,
        drive: &[Complex32],
        control: &mut Control,
    ) -> Result<Option<Notice>> {
        let &Pull { point, frame, velocity, acceleration } = pull;
        let (bead, place) = (self.scene.bead(), self.points[frame * self.count() + point]);
        if !self.closed && (frame == 0 || frame + 1 == self.frames()) {
            return self.caught(pull, model, drive, control);
        }
        let force = bead.particle.needed(self.scene.medium(), velocity, acceleration);
        if poised(model, drive, place, bead, force, control)?.is_some() {
            return Ok(None);
        }
        let size = figures(Vec3(acceleration).norm(), 3);
        let radius = figures(1e3 * bead.particle.radius, 3);
        let value = format!("{size} m/s^2 in frame {frame}, more than its trap can give a bead of {radius} mm radius");
        let (item, cure) = (format!("point {}", point + 1), "go slower, or by midair.path.fastest");
        Ok(Some(Notice::new(ErrorCode::Doubtful, item, value, cure).verb("takes")))
    }

    /// Returns a warning if the trap at an end of an open motion is too weak to catch a bead with the velocity of the point.
    fn caught(
        &self,
        &Pull { point, frame, velocity, .. }: &Pull,
        model: &Model,
        drive: &[Complex32],
        control: &mut Control,
    ) -> Result<Option<Notice>> {
        let (Bead { particle, gravity }, place) = (self.scene.bead(), self.points[frame * self.count() + point]);
        let speed = Vec3(velocity).norm();
        if speed < SLOW || self.targets[frame * self.count() + point] == 0.0 {
            return Ok(None);
        }
        let trap = rest(model, drive, &[place], particle, gravity, control)?;
        if !trap.held[0] && speed < FAST {
            // A trap that holds nothing is another fault than a launch.
            return Ok(None);
        }
        let mass = particle.mass(self.scene.medium());
        let part = |k: usize| {
            let way = |side: usize| trap.restoring[0][k][side] * trap.basin[0][k][side];
            // The work of a force that is a half wave of a sine over the basin.
            let work = way(0).min(way(1)) * core::f64::consts::FRAC_2_PI;
            let speed = Vec3(trap.axes[0][k]).dot(velocity);
            0.5 * mass * speed * speed / work
        };
        if trap.held[0] && (0..3).map(part).sum::<f64>() < 1.0 {
            return Ok(None);
        }
        let (size, radius) = (figures(speed, 3), figures(1e3 * particle.radius, 3));
        let value = format!("{size} m/s in frame {frame}, faster than its trap can catch a bead of {radius} mm radius");
        let verb = if frame == 0 { "begins at" } else { "ends at" };
        let cure = "begin and end at rest, by midair.path.fastest, or give a closed path";
        Ok(Some(Notice::new(ErrorCode::Doubtful, format!("point {}", point + 1), value, cure).verb(verb)))
    }

    /// Returns the first warning of [`Moving::strained`] about pulls in a range of frames, with its drives (frames, N).
    ///
    /// # Errors
    /// The errors of [`poised`].
    pub fn strain(
        &self,
        range: Range<usize>,
        drives: &[Complex32],
        model: &Model,
        control: &mut Control,
    ) -> Result<Option<Notice>> {
        let transducers = model.array().len();
        for pull in self.pulls().iter().filter(|pull| range.contains(&pull.frame)) {
            let drive = &drives[(pull.frame - range.start) * transducers..][..transducers];
            if let Some(doubt) = self.strained(pull, model, drive, control)? {
                return Ok(Some(doubt));
            }
        }
        Ok(None)
    }

    /// The number of frames T.
    pub fn frames(&self) -> usize {
        self.points.len() / self.count()
    }

    /// The number of points M in a frame.
    pub fn count(&self) -> usize {
        self.scene.points().len()
    }

    /// Returns a session of the solver that follows the points.
    ///
    /// # Errors
    /// The errors of [`Session::chosen`].
    pub fn session(&self, set: InstructionSet) -> Result<Session> {
        Session::chosen(Model::of(&self.scene, set), self.scene.solver.as_ref())
    }
}

/// The largest acceleration of a bead in the trap of a point.
#[derive(Clone, Copy, Debug)]
pub struct Pull {
    /// The number of the point.
    pub point: usize,
    /// The number of the frame.
    pub frame: usize,
    /// The bead's velocity in m/s.
    pub velocity: [f64; 3],
    /// The bead's acceleration in m/s^2.
    pub acceleration: [f64; 3],
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
    ) -> Result<()> {
        let (count, frames, first) = (moving.count(), moving.frames(), range.start);
        if range.is_empty() || range.end > frames {
            return Err(Error::out_of_range("frames", format!("{range:?}"), format!("give some of {frames}")));
        }
        if first == 0 {
            self.last.clear();
        }
        // `Moving::doubts` reports it for the whole motion.
        self.reported[remark::FAST] = true;
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
pub fn meant(plain: bool, aim: Option<Aim>, signature: Option<&Signature>) -> (Aim, bool) {
    let aim = aim.unwrap_or(if plain { Aim::Max } else { Aim::Target });
    (aim, plain && aim == Aim::Max && signature.is_some_and(Signature::traps))
}

/// Returns the largest part of some levels (M,) in Pa that all points can have in every frame: the least of some frames.
fn evenly(
    scene: &Scene,
    points: &[[f64; 3]],
    levels: &[f64],
    set: InstructionSet,
    control: &mut Control,
) -> Result<f64> {
    let uniform = registry::find("uniform")?.configure(&Options::new())?.solver;
    let (mut work, mut least, mut last) = (Workspace::new(), f64::INFINITY, None);
    let frames = || points.chunks_exact(levels.len());
    for frame in frames().step_by(frames().len().div_ceil(JUDGED)).chain(frames().last()) {
        if last.replace(frame) == Some(frame) {
            continue;
        }
        // A frame that cannot be solved is refused when its turn comes.
        let Ok(scene) = scene.clone().with_points(frame.to_vec(), Request::default()) else { continue };
        let Ok(problem) = Problem::of_scene(&scene, set, control) else { continue };
        let solution = solve(&problem.with_aim(Aim::Max), &*uniform, false, &mut work, control)?;
        let parts = solution.pressures.iter().zip(levels).map(|(p, level)| f64::from(p.norm()) / level);
        least = parts.fold(least, f64::min);
    }
    Ok(if least.is_finite() { least } else { 1.0 })
}

/// Returns the number of later frames that a solve knows; `None` for all. A closed sequence needs all.
///
/// # Errors
/// No whole number of at least 0, a word other than "all"; a closed sequence that does not know all.
pub fn sight(ahead: Option<&Value>, closed: bool) -> Result<Option<usize>> {
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
        Some(other) => return Err(Error::out_of_range("ahead", other, "give a whole number of at least 0")),
    };
    if closed {
        let cure = "give ahead = \"all\", that the last frame meets the first";
        return Err(Error::invalid("closed", format!("true, but ahead is {frames}"), cure));
    }
    Ok(Some(frames))
}

/// Returns the number of frames on each side from which the acceleration of points is computed.
pub(crate) fn look(rate: f64) -> usize {
    (rint(LOOK * rate) as usize).max(1)
}
