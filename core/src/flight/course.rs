//! Course: radiation and points of a sequence at knots (interpolation nodes in time), linear between knots.

use crate::flight::envelope::Envelope;
use crate::prelude::*;
use crate::propagation::Model;
use crate::propagation::forces::rest::poised;
use crate::scene::{Bead, distance};

/// Largest time between two knots in s. Between such knots, traps deviate by less than 0.1 % from linear interpolation.
const LONGEST: f64 = 1e-3;
/// Time in s before and after a frame in which `sequence` takes the motion of a trap.
const LAUNCH: f64 = 0.5e-3;
/// Largest movement of a point between two knots, in wavelengths.
const WAY: f64 = 1.0 / 16.0;

/// Largest length in s of a part of a frame: longer frames are divided. It is shorter than the transducers' settling
/// time.
const SETTLED: f64 = 0.25e-3;

/// Largest number of laps in a flight of default duration: one second, rounded up to whole laps of a closed sequence.
const LAPS: usize = 100;

/// Knots in time: the transducers' radiation at each knot, and the places of the points in each frame.
#[derive(Clone, Debug)]
pub struct Course {
    pub(super) envelope: Envelope,
    pub(super) closed: bool,
    /// Places (T, M, 3) of the points in m.
    frames: Vec<[f64; 3]>,
    /// The number M of points.
    points: usize,
    /// Frames per knot, and knots per frame. One of them is 1.
    every: usize,
    parts: usize,
    /// The number N of transducers.
    transducers: usize,
    /// Radiation (K, N) at the knots of one lap, or of all frames of an open sequence.
    drives: Vec<Complex32>,
    /// The radiation after the frames that were played, and the number of these frames.
    state: Vec<Complex64>,
    played: usize,
}

impl Course {
    /// Creates the knots for `frames` (T, M, 3) in m of M `points`. `before` (N,) is the transducers' radiation at the
    /// start of the first frame. [`Course::play`] then takes the drive of each frame.
    ///
    /// # Errors
    /// No points, another number of places than T M, a rate or a time constant out of range.
    pub fn new(
        frames: &[[f64; 3]],
        points: usize,
        wavelength: f64,
        envelope: Envelope,
        closed: bool,
        before: Vec<Complex64>,
    ) -> Result<Self> {
        frame_rate(envelope.rate)?;
        real("tau", envelope.tau, 0.0, false)?;
        if points == 0 || frames.is_empty() || !frames.len().is_multiple_of(points) {
            return Err(Error::invalid("points", frames.len(), "give as many in each frame"));
        }
        let (count, rate) = (frames.len() / points, envelope.rate);
        let (mut every, parts) = (1, math::ceil(1.0 / (rate * SETTLED) - 1e-9).max(1.0) as usize);
        if parts == 1 {
            let moved = frames.iter().zip(&frames[points..]).map(|(a, b)| distance(*a, *b)).fold(1e-9, f64::max);
            let most = (LONGEST * rate).min(WAY * wavelength / moved).min(count as f64);
            every = (most as usize).max(1);
            while closed && !count.is_multiple_of(every) {
                every -= 1;
            }
        }
        let (frames, transducers) = (frames.to_vec(), before.len());
        Ok(Self {
            envelope,
            closed,
            frames,
            points,
            every,
            parts,
            transducers,
            drives: Vec::new(),
            state: before,
            played: 0,
        })
    }

    /// Creates the knots for a whole sequence: `frames` (T, M, 3) in m and `drives` (T, N).
    ///
    /// # Errors
    /// The errors of [`Course::new`]; drives of another number of frames; more memory than allowed; a stop.
    pub fn of(
        frames: &[[f64; 3]],
        drives: &[Complex32],
        model: &Model,
        envelope: Envelope,
        closed: bool,
        control: &mut Control,
    ) -> Result<Self> {
        let transducers = model.array().len();
        let count = drives.len() / transducers;
        if count == 0 || !frames.len().is_multiple_of(count) || !drives.len().is_multiple_of(transducers) {
            return Err(Error::invalid("drives", drives.len(), "give one for each transducer in each frame"));
        }
        let (first, tail) = (&drives[..transducers], count - envelope.memory(count));
        let before = if closed {
            envelope.repeated(&drives[tail * transducers..], first)
        } else {
            first.iter().map(|q| Complex64::new(f64::from(q.re), f64::from(q.im))).collect()
        };
        let points = frames.len() / count;
        let mut course = Self::new(frames, points, model.medium().wavelength(), envelope, closed, before)?;
        let last = &drives[(count - 1) * transducers..];
        let following = drives.chunks(transducers).skip(1).chain([if closed { first } else { last }]);
        for (now, following) in drives.chunks(transducers).zip(following) {
            course.play(now, following, control)?;
        }
        Ok(course)
    }

    /// Plays the drive (N,) of the next frame; `following` is the drive of the frame after it.
    ///
    /// # Errors
    /// Other numbers of drives than transducers; more memory than allowed; a stop.
    pub fn play(&mut self, now: &[Complex32], following: &[Complex32], control: &mut Control) -> Result<()> {
        for drive in [now, following] {
            one_each("drives", drive.len(), "values", self.transducers, "transducers")?;
        }
        control.pulse()?;
        let knots = if self.played.is_multiple_of(self.every) { self.parts } else { 0 };
        let (first, count) = (self.drives.len(), self.transducers);
        control.room("the drives at knots", [count, knots], bytes(8, &[first + 3 * knots * count]))?;
        let steps = 2 * knots;
        let mut all = vec![Complex32::ZERO; steps * count];
        self.envelope.frame(now, following, &mut self.state, 2 * self.parts, 0..steps, &mut all);
        // A knot is in the middle of a part of a frame.
        self.drives.extend(all.chunks(count).skip(1).step_by(2).flatten());
        self.played += 1;
        Ok(())
    }

    /// Returns the number of knots of one lap, or of all frames of an open sequence.
    pub fn lap(&self) -> usize {
        self.drives.len() / self.transducers
    }

    /// Returns the number of frames per second.
    pub fn rate(&self) -> f64 {
        self.envelope.rate
    }

    /// Returns the time in s between two knots.
    pub fn spacing(&self) -> f64 {
        self.every as f64 / (self.envelope.rate * self.parts as f64)
    }

    /// Returns the time in s of a knot, which may be fractional. The first knot is in the middle of the first part of the
    /// first frame.
    pub fn time(&self, knot: f64) -> f64 {
        0.5 / (self.envelope.rate * self.parts as f64) + self.spacing() * knot
    }

    /// Returns the times (K,) in s of the first `knots` knots.
    pub fn times(&self, knots: usize) -> Vec<f64> {
        (0..knots).map(|knot| self.time(knot as f64)).collect()
    }

    /// Returns the number of knots of a flight of `duration` seconds. By default the flight lasts as long as an open
    /// sequence. For a closed sequence it lasts one second, rounded up to whole laps, but at most 100 laps.
    ///
    /// # Errors
    /// An open sequence with fewer than two knots.
    pub fn knots(&self, duration: Option<f64>) -> Result<usize> {
        let lap = self.lap();
        let needed = duration.map(|duration| math::ceil(duration / self.spacing()) as usize);
        if self.closed {
            let laps = math::ceil(1.0 / (lap as f64 * self.spacing())) as usize;
            return Ok(needed.unwrap_or(laps.clamp(1, LAPS) * lap).saturating_add(1));
        }
        let knots = needed.map_or(lap, |needed| lap.min(needed.saturating_add(1)));
        if knots < 2 {
            let value = duration.map_or_else(|| "None".into(), |duration| alloc::format!("{duration:?}"));
            let cure = "the sequence is too short for a flight, give more frames";
            return Err(Error::invalid("duration", value, cure));
        }
        Ok(knots)
    }

    /// Returns the radiation (N,) at a knot of a lap.
    pub(super) fn drive(&self, knot: usize) -> &[Complex32] {
        &self.drives[knot * self.transducers..(knot + 1) * self.transducers]
    }

    /// Returns the place of a point at a time in s, linear between frames.
    pub fn place(&self, time: f64, point: usize) -> [f64; 3] {
        let count = self.frames.len() / self.points;
        let way = time * self.envelope.rate;
        let way = if self.closed {
            way - math::floor(way / count as f64) * count as f64
        } else {
            way.clamp(0.0, (count - 1) as f64)
        };
        let before = (way as usize).min(count - 1);
        let after = if self.closed { (before + 1) % count } else { (before + 1).min(count - 1) };
        let [from, to] = [before, after].map(|frame| Vec3(self.frames[frame * self.points + point]));
        (from + (way - before as f64) * (to - from)).0
    }

    /// Returns the places (K, B, 3) of some points (B,) at the first `knots` knots.
    pub fn ways(&self, knots: usize, points: &[usize]) -> Vec<[f64; 3]> {
        let lap = knots.min(self.lap());
        let knot = |k: usize| points.iter().map(move |&point| self.place(self.time(k as f64), point));
        let first: Vec<[f64; 3]> = (0..lap).flat_map(knot).collect();
        // The points of later laps are those of the first.
        first.iter().cycle().take(knots * points.len()).copied().collect()
    }

    /// Returns the velocity in m/s and the acceleration in m/s^2 of a point at the start of a closed sequence; 0 for an
    /// open one.
    pub fn moving(&self, point: usize) -> [[f64; 3]; 2] {
        if self.closed { self.motion(point, -self.envelope.tau, self.spacing().max(LONGEST)) } else { [[0.0; 3]; 2] }
    }

    /// Returns the velocity and the acceleration of a point at a time in s, from its places `apart` before and after.
    fn motion(&self, point: usize, time: f64, apart: f64) -> [[f64; 3]; 2] {
        let [before, here, after] = [-1.0, 0.0, 1.0].map(|side| Vec3(self.place(time + apart * side, point)));
        let speed = (after - before) / (2.0 * apart);
        let acceleration = (after - 2.0 * here + before) / (apart * apart);
        [speed.0, acceleration.0]
    }

    /// Returns the places (B, 3) in m where beads in the traps of some points (B,) must start, so that they move with
    /// their points at once. If there is no such place, it is the place of the point.
    ///
    /// A bead of an open sequence starts at rest, but a trap that was solved for the motion already gives the force of the
    /// launch. So the bead starts where this trap gives this force, or none, whichever place is nearer to the point.
    ///
    /// # Errors
    /// The errors of [`crate::rest`].
    pub fn resting(&self, model: &Model, bead: Bead, points: &[usize], control: &mut Control) -> Result<Vec<[f64; 3]>> {
        let frame = self.frames[..self.points].iter().copied();
        let first: Vec<[f64; 3]> = frame.collect();
        let mut start = |point: usize, [speed, acceleration]: [[f64; 3]; 2]| {
            let force = bead.particle.needed(model.medium(), speed, acceleration);
            poised(model, self.drive(0), first[point], bead, force, control)
        };
        let each = points.iter().map(|&point| {
            if self.closed {
                // The radiation is known at the first knot, and the flight begins at 0 s.
                let time = self.time(0.0);
                let moving = self.motion(point, time - self.envelope.tau, self.spacing().max(LONGEST));
                let there = start(point, moving)?.unwrap_or(first[point]);
                return Ok((Vec3(there) - time * Vec3(moving[0])).0);
            }
            let rest = start(point, [[0.0; 3]; 2])?.unwrap_or(first[point]);
            let launch = self.motion(point, 0.0, LAUNCH.max(1.0 / self.envelope.rate));
            let launched = start(point, launch)?.unwrap_or(first[point]);
            let apart = |place: [f64; 3]| distance(place, first[point]);
            Ok(if apart(launched) < apart(rest) { launched } else { rest })
        });
        each.collect()
    }
}
