//! Play: solves frames one after the other, and encodes the bytes with which a board plays a drive.

use midair::{Board, Complex32, Control, Error, Frames, Result, Signature, SolveRequest};

use crate::opened::Opened;
use crate::studio::Studio;

impl Studio {
    pub(crate) fn follow(&mut self, frames: usize) -> Result<()> {
        if frames == 0 && self.numbers_in.is_empty() {
            return self.follow_motion();
        }
        let places: Vec<[f64; 3]> = self.numbers_in.as_chunks().0.to_vec();
        let Opened { session, ask, scene, .. } = self.opened()?;
        let (count, transducers) = (scene.points().len(), scene.array().len());
        if frames == 0 || frames.checked_mul(count) != Some(places.len()) {
            let cure = format!("give {count} points in each of {frames} frames");
            return Err(Error::invalid("frames", format!("{} points", places.len()), cure));
        }
        let pressed = scene.request().pressures.as_ref();
        let targets = pressed.map(|each| each.repeat(frames));
        let mut drives = vec![Complex32::ZERO; frames * transducers];
        // The path repeats. The stiffest traps need the points of the frames before and after, for the acceleration. One frame
        // on each side suffices, because the studio's paths are smooth.
        let margin = usize::from(pressed.is_none() && scene.signature() == Some(&Signature::Trap));
        let (start, end) = (&places[..margin * count], &places[places.len() - margin * count..]);
        let around = [end, &places, start].concat();
        let all = Frames { points: &around, targets: targets.as_deref(), count, margin, first: 0 };
        let mut kept = SolveRequest { aim: ask.aim, ..SolveRequest::default() };
        session.last().clear();
        session.follow(all, &mut kept, &mut drives, &mut Control::none())?;
        self.keep(drives, places, targets.as_deref())
    }

    /// Solves the frames of the scene's motion.
    fn follow_motion(&mut self) -> Result<()> {
        let Opened { session, moving, model, .. } = self.opened()?;
        let moving = moving.clone().ok_or_else(still)?;
        let mut drives = vec![Complex32::ZERO; moving.frames() * model.array().len()];
        session.follow_moving(&moving, 0..moving.frames(), &mut drives, &mut Control::none())?;
        self.keep(drives, moving.points, Some(&moving.targets))
    }

    /// Writes rate, closedness (1 or 0) and number of points of the scene's motion to the numbers, then the points (T, M, 3) in
    /// m and the targets (T, M) in Pa of all frames.
    pub(crate) fn motion(&mut self) -> Result<()> {
        let moving = self.opened()?.moving.as_ref().ok_or_else(still)?;
        let mut numbers = vec![moving.rate, f64::from(u8::from(moving.closed)), moving.count() as f64];
        numbers.extend(moving.points.as_flattened());
        numbers.extend(&moving.targets);
        self.numbers = numbers;
        Ok(())
    }

    /// Keeps solved frames, points (T, M, 3) with targets (T, M), and reports on each.
    fn keep(&mut self, drives: Vec<Complex32>, places: Vec<[f64; 3]>, targets: Option<&[f64]>) -> Result<()> {
        let opened = self.opened()?;
        let (count, transducers) = (opened.scene.points().len(), opened.scene.array().len());
        let mut reported = Vec::new();
        let mut before: Option<&[Complex32]> = None;
        for (frame, (drive, points)) in drives.chunks(transducers).zip(places.chunks(count)).enumerate() {
            let turned = before.map_or(0.0, |before| change(before, drive));
            let targets = targets.map(|targets| &targets[frame * count..][..count]);
            let moduli = opened.moduli(drive, points, targets)?;
            let there = |j: &usize| targets.is_none_or(|targets| targets[*j] > 0.0);
            let least = (0..count).filter(there).fold(f64::INFINITY, |least, j| least.min(moduli[j]));
            reported.extend([turned, least, moduli.iter().copied().fold(0.0, f64::max)]);
            before = Some(drive);
        }
        (self.numbers, self.frames, self.places, self.course) = (reported, drives, places, None);
        self.frame(0)
    }

    pub(crate) fn frame(&mut self, frame: usize) -> Result<()> {
        let transducers = self.opened()?.scene.array().len();
        let drive = self.frames.chunks(transducers).nth(frame).map(<[_]>::to_vec);
        self.take(drive.ok_or_else(|| Error::out_of_range("frame", frame, "follow so many frames first"))?);
        Ok(())
    }

    pub(crate) fn encode(&mut self) -> Result<()> {
        let board = self.board()?;
        let mut bytes = vec![0; board.frame_size()];
        board.encode(&self.drive, &mut bytes)?;
        self.bytes = bytes;
        self.numbers = vec![board.baud().map_or(0.0, f64::from)];
        Ok(())
    }

    pub(crate) fn silence(&mut self) -> Result<()> {
        self.bytes = self.board()?.silence();
        Ok(())
    }

    fn board(&mut self) -> Result<Board> {
        let name = String::from_utf8_lossy(&self.text_in).into_owned();
        self.opened()?.scene.array().board(&name)
    }
}

fn still() -> Error {
    Error::invalid("motion", "not there", "open a scene file with [motion]")
}

/// Returns the largest phase change between two drives, in rad.
fn change(last: &[Complex32], drive: &[Complex32]) -> f64 {
    last.iter().zip(drive).map(|(a, b)| f64::from((b * a.conj()).arg().abs())).fold(0.0, f64::max)
}
