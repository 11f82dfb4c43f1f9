//! Horizon: the codes of frames that are solved in windows, each of which includes some later frames.
//!
//! A window begins with the frame that was returned last, whose codes are fixed. After each solve, a third of the
//! other frames becomes final. The rest is the initial guess for the next window. In trials this was as loud, within
//! 0.3 %, as a window that advances by one frame, in a quarter of the time.

use crate::propagation::Model;
use crate::scene::Aim;
use crate::sequence::track::Circle;
use crate::sequence::{Ahead, Ends, ahead, stiffen};
use crate::solvers::prelude::*;
use crate::solvers::remark::Remark;

/// Number of phases that is used for a board that can play any phase.
pub(crate) const PHASES: u32 = 256;

/// Iterations of tracks, point phases and weights. After ten, the level grows by less than 0.1 % per iteration.
const ROUNDS: u32 = 10;

/// Iterations for a closed curve, which repeats: up to 0.2 % louder than after ten.
const ROUNDS_CLOSED: u32 = 20;

/// Iterations if the initial guess is known from the last window.
const ROUNDS_MORE: u32 = 5;

/// What the frames of moving points have in common when they are solved together with later ones.
#[derive(Clone, Debug)]
pub struct Tracks {
    /// The array with its board, the air and the signature. A board that can play any phase gets 256.
    pub model: Model,
    /// The largest change of a phase in rad per frame.
    pub change: f64,
    /// Whether amplitudes reduce the pressures to the targets.
    pub aim: Aim,
}

/// T frames of M points.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a> {
    /// Points (T, M) in m.
    pub points: &'a [[f64; 3]],
    /// Targets (T, M) in Pa; 0 where a point is absent.
    pub targets: &'a [f64],
    /// The number of frames T.
    pub frames: usize,
    /// The number of the first frame, for errors.
    pub first: usize,
}

impl Tracks {
    fn phases(&self) -> u32 {
        self.model.array().quantization().and_then(Quantization::phases).unwrap_or(PHASES)
    }

    /// Warns of a bound below a step of the board's phases.
    pub fn doubt(&self) -> Option<Notice> {
        Remark::still_on(self.change, self.phases()).map(|remark| remark.notice())
    }

    /// Returns the codes (T, N) of frames that are solved together. `start` (T, N) is the initial guess; the codes of its first
    /// frame stay as they are. Frames without points keep the codes of the start, or 0.
    ///
    /// # Errors
    /// The errors of [`ahead`].
    pub fn codes(
        &self,
        table: Table<'_>,
        closed: bool,
        start: Option<&[u16]>,
        control: &mut Control,
    ) -> Result<Vec<u16>> {
        let (transducers, Table { points, targets, frames, first }) = (self.model.array().len(), table);
        if !targets.iter().any(|&target| target > 0.0) {
            let still = start.map_or_else(|| vec![0; transducers], |codes| codes[..transducers].to_vec());
            return Ok(still.repeat(frames));
        }
        if frames == 1 {
            // A single frame is solved as points at rest.
            let twice = Table { points: &points.repeat(2), targets: &targets.repeat(2), frames: 2, first };
            let mut codes = self.codes(twice, false, None, control)?;
            codes.truncate(transducers);
            return Ok(codes);
        }
        let (ends, rounds) = match (start, closed) {
            (Some(_), _) => (Ends::Held, ROUNDS_MORE),
            (None, true) => (Ends::Closed, ROUNDS_CLOSED),
            (None, false) => (Ends::Open, ROUNDS),
        };
        let how = Ahead { change: self.change, phases: self.phases(), ends, rounds };
        ahead(&self.model, points, targets, frames, &how, start, control).map_err(|mut error| {
            if let Some(index) = error.index {
                // The item is points[t, j] or targets[t, j].
                error.item = error.item.replacen(&alloc::format!("[{index}"), &alloc::format!("[{}", index + first), 1);
                error.index = Some(index + first);
            }
            error
        })
    }

    /// Changes codes (T, N) so that traps are as stiff as possible and carry their beads at `rate` frames per second.
    ///
    /// # Errors
    /// The errors of [`stiffen`].
    pub fn stiffen(
        &self,
        points: &[[f64; 3]],
        closed: bool,
        rate: f64,
        margin: usize,
        codes: &mut [u16],
        control: &mut Control,
    ) -> Result<()> {
        let ends = if closed { Ends::Closed } else { Ends::Open };
        let how = Ahead { change: self.change, phases: self.phases(), ends, rounds: 1 };
        stiffen(&self.model, points, &how, rate, margin, codes, control)
    }

    /// Returns the drives (T, N) of codes: 0 in frames without points, with the highest amplitudes that keep all points of a
    /// frame within their targets.
    ///
    /// # Errors
    /// The errors of [`Model::propagation`]; a stop.
    pub fn drives(&self, table: Table<'_>, codes: &[u16], control: &mut Control) -> Result<Vec<Complex32>> {
        let (array, Table { points, targets, frames, .. }) = (self.model.array(), table);
        let (count, circle) = (points.len() / frames, Circle::new(self.phases() as usize, 0));
        let on: Vec<bool> = (0..array.len()).map(|i| array.effect(i) != Complex64::ZERO).collect();
        let mut drives = Vec::with_capacity(codes.len());
        for (t, row) in codes.chunks(array.len()).enumerate() {
            let (places, targets) = (&points[t * count..][..count], &targets[t * count..][..count]);
            let Some(first) = targets.iter().position(|&target| target > 0.0) else {
                drives.resize(drives.len() + row.len(), Complex32::ZERO);
                continue;
            };
            let full = row.iter().zip(&on).map(|(&code, &on)| if on { circle.phasor(code) } else { Complex32::ZERO });
            let full: Vec<Complex32> = full.collect();
            let mut part = 1.0;
            if self.aim == Aim::Target {
                // An absent point has the place of another one.
                let places: Vec<_> = (0..count).map(|j| places[if targets[j] > 0.0 { j } else { first }]).collect();
                let matrix = self.model.propagation(&places)?.matrix(control)?;
                let there = matrix.chunks(array.len()).zip(targets).filter(|(_, target)| **target > 0.0);
                let excess = there.map(|(row, target)| {
                    let pressure: Complex64 = row.iter().zip(&full).map(|(g, q)| widened(*g) * widened(*q)).sum();
                    pressure.norm() / target
                });
                part = 1.0 / excess.fold(1.0, f64::max);
            }
            let part = array.quantization().map_or(part, |board| board.at_most(part)) as f32;
            drives.extend(full.iter().map(|q| q * part));
        }
        Ok(drives)
    }
}

fn widened(q: Complex32) -> Complex64 {
    Complex64::new(q.re.into(), q.im.into())
}

/// Solves the codes of frames that come one after another, each with up to `ahead` later ones.
#[derive(Clone, Debug)]
pub struct Horizon {
    /// What the frames have in common.
    pub tracks: Tracks,
    ahead: usize,
    /// The frame that was returned last, and those after it: points and targets.
    frames: Vec<(Vec<[f64; 3]>, Vec<f64>)>,
    /// Codes (K, N) of the first K of `frames`.
    codes: Vec<u16>,
    /// How many frames of `codes` are final.
    decided: usize,
    /// The number of frames that were returned.
    done: usize,
}

impl Horizon {
    /// Returns a horizon of `ahead` frames, before the first frame.
    pub fn new(tracks: Tracks, ahead: usize) -> Self {
        Self { tracks, ahead, frames: Vec::new(), codes: Vec::new(), decided: 0, done: 0 }
    }

    /// Returns the codes (K, N) of the last frame and of those after it, and the number of frames of them that are final.
    pub fn state(&self) -> (&[u16], usize) {
        (&self.codes, self.decided)
    }

    /// Continues after `done` frames with the result of [`Horizon::state`]. The frame that was returned last is pushed first.
    pub fn restore(&mut self, done: usize, codes: Vec<u16>, decided: usize) {
        (self.frames, self.codes, self.decided, self.done) = (Vec::new(), codes, decided, done);
    }

    /// Returns how many frames can be pushed before the next one is solved.
    pub fn wanted(&self) -> usize {
        self.most().saturating_sub(self.frames.len())
    }

    fn most(&self) -> usize {
        self.done.min(1).saturating_add(1).saturating_add(self.ahead)
    }

    /// Adds a frame of points (M,) in m and targets (M,) in Pa. M may change from frame to frame.
    pub fn push(&mut self, points: Vec<[f64; 3]>, targets: Vec<f64>) {
        self.frames.push((points, targets));
    }

    /// The frame that was returned last: points and targets.
    pub fn frame(&self) -> Option<(&[[f64; 3]], &[f64])> {
        self.frames.first().map(|(points, targets)| (&points[..], &targets[..]))
    }

    /// Returns the codes (N,) of the next frame, `None` after the last. Fewer frames than wanted are the last ones.
    ///
    /// # Errors
    /// The errors of [`Tracks::codes`].
    pub fn advance(&mut self, control: &mut Control) -> Result<Option<Vec<u16>>> {
        let (transducers, returned) = (self.tracks.model.array().len(), self.done.min(1));
        if self.frames.len() == returned {
            return Ok(None);
        }
        if self.decided == returned {
            self.codes = self.plan(returned, control)?;
            let last = self.wanted() > 0;
            self.decided = if last { self.frames.len() } else { returned + 1 + self.ahead / 3 };
        }
        self.frames.drain(..returned);
        self.codes.drain(..returned * transducers);
        self.decided -= returned;
        self.done += 1;
        Ok(Some(self.codes[..transducers].to_vec()))
    }

    /// Returns the codes of all frames of the window; those of the first `returned` frames stay.
    fn plan(&self, returned: usize, control: &mut Control) -> Result<Vec<u16>> {
        let (transducers, frames) = (self.tracks.model.array().len(), self.frames.len());
        let count = self.frames.iter().map(|(points, _)| points.len()).max().unwrap_or_default();
        let (mut points, mut targets) = (Vec::new(), Vec::new());
        for (k, (places, pressures)) in self.frames.iter().enumerate() {
            points.extend_from_slice(places);
            points.resize((k + 1) * count, [0.0; 3]);
            targets.extend_from_slice(pressures);
            targets.resize((k + 1) * count, 0.0);
        }
        let all = Table { points: &points, targets: &targets, frames, first: self.done - returned };
        if self.codes.is_empty() {
            return self.tracks.codes(all, false, None, control);
        }
        if targets[..count].iter().all(|&target| target == 0.0) {
            // A silent frame does not limit the phases of the next one, so the rest is solved independently.
            let (points, targets) = (&points[returned * count..], &targets[returned * count..]);
            let rest = Table { points, targets, frames: frames - returned, first: self.done };
            let rest = self.tracks.codes(rest, false, None, control)?;
            return Ok([&self.codes[..returned * transducers], &rest].concat());
        }
        let last = &self.codes[self.codes.len() - transducers..];
        let missing = frames - self.codes.len() / transducers;
        let start = [&self.codes[..], &last.repeat(missing)].concat();
        self.tracks.codes(all, false, Some(&start), control)
    }
}

#[cfg(test)]
#[path = "tests/horizon.rs"]
mod tests;
