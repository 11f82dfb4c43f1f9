//! Moving solver: solves the frames of a motion block after block, one after another or together with later ones.

use crate::prelude::*;
use crate::propagation::Model;
use crate::scene::Signature;
use crate::sequence::horizon::{Horizon, Table, Tracks};
use crate::sequence::track::nearest_code;
use crate::session::moving::look;
use crate::session::{Moving, Session};

/// Solves the frames of a motion block after block.
pub struct MovingSolver {
    /// The frames.
    moving: Arc<Moving>,
    method: Method,
}

/// How frames are solved.
enum Method {
    /// Each frame from the last one.
    Follow(Box<Session>),
    /// Each frame with some later ones; the number of frames that were read.
    Ahead(Horizon, usize),
    /// All frames together.
    All(Tracks),
}

/// What was found for some frames.
#[derive(Clone, Debug, PartialEq)]
pub enum Played {
    /// Drives (frames, N).
    Drives(Vec<Complex32>),
    /// Codes l (frames, N) of the board's phases 2 pi l/L, at full amplitude.
    Codes(Vec<u16>),
}

impl MovingSolver {
    /// Returns a solver of all frames of a motion. The model is that of its scene.
    ///
    /// # Errors
    /// The errors of [`Session::chosen`].
    pub fn new(moving: impl Into<Arc<Moving>>, model: Model) -> Result<Self> {
        let moving = moving.into();
        let tracks = |model| Tracks { model, change: moving.change, aim: moving.aim };
        let method = match moving.ahead {
            Some(0) => Method::Follow(Box::new(Session::chosen(model, moving.scene.solver.as_ref())?)),
            Some(ahead) => Method::Ahead(Horizon::new(tracks(model), ahead), 0),
            None => Method::All(tracks(model)),
        };
        Ok(Self { moving, method })
    }

    /// Solves a range of frames, which follow those of the last call. If all frames are solved together, the range is all of them.
    ///
    /// # Errors
    /// The errors of [`Session::follow_moving`] or [`Tracks::codes`]; a stop.
    pub fn block(&mut self, range: Range<usize>, control: &mut Control) -> Result<Played> {
        let Self { moving, method } = self;
        let full = moving.is_full();
        let count = moving.count();
        let table = |range: Range<usize>| Table {
            points: &moving.points[range.start * count..range.end * count],
            targets: &moving.targets[range.start * count..range.end * count],
            frames: range.len(),
            first: range.start,
        };
        let (codes, tracks) = match method {
            Method::Follow(session) => {
                let mut drives = vec![Complex32::ZERO; range.len() * session.transducers()];
                session.follow_moving(moving, range, &mut drives, control)?;
                let phases = moving.board().and_then(|board| board.phases());
                return Ok(match phases.filter(|_| full && session.task.solver.remembers()) {
                    Some(phases) => Played::Codes(drives.iter().map(|q| nearest_code(*q, phases as usize)).collect()),
                    None => Played::Drives(drives),
                });
            }
            Method::Ahead(horizon, read) => {
                let mut codes = Vec::new();
                for _ in range.clone() {
                    while horizon.wanted() > 0 && *read < moving.frames() {
                        let Table { points, targets, .. } = table(*read..*read + 1);
                        horizon.push(points.into(), targets.into());
                        *read += 1;
                    }
                    codes.extend(horizon.advance(control)?.unwrap_or_default());
                }
                (codes, &horizon.tracks)
            }
            Method::All(tracks) => {
                let mut codes = tracks.codes(table(range.clone()), moving.closed, None, control)?;
                if moving.stiff && moving.scene.signature() == Some(&Signature::Trap) && range.len() > 1 {
                    let margin = look(moving.rate);
                    tracks.stiffen(&moving.points, moving.closed, moving.rate, margin, &mut codes, control)?;
                }
                (codes, &*tracks)
            }
        };
        if full { Ok(Played::Codes(codes)) } else { tracks.drives(table(range), &codes, control).map(Played::Drives) }
    }

    /// The session that solves each frame from the last one, if that is how frames are solved.
    pub fn session(&mut self) -> Option<&mut Session> {
        match &mut self.method {
            Method::Follow(session) => Some(session),
            _ => None,
        }
    }

    /// The horizon that solves each frame with some later ones, if that is how frames are solved.
    pub fn horizon(&self) -> Option<&Horizon> {
        match &self.method {
            Method::Ahead(horizon, _) => Some(horizon),
            _ => None,
        }
    }

    /// Continues the horizon after `done` frames with the result of [`Horizon::state`].
    pub fn restore_horizon(&mut self, done: usize, codes: Vec<u16>, decided: usize) {
        if let Method::Ahead(horizon, read) = &mut self.method {
            horizon.restore(done, codes, decided);
            *read = done - 1;
        }
    }
}
