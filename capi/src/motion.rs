//! Motions: the frames of a scene file with `[motion]`, solved one after another.

use std::ffi::c_char;
use std::ops::Range;

use midair::{Complex32, Control, Error, Moving, Result};

use crate::memory::{Complex, fill, room, write};
use crate::outcome::{Message, Outcome, outcome};
use crate::session::{Session, State};

/// The frames of a motion.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// The number of frames T.
    pub frames: usize,
    /// The number of points M.
    pub points: usize,
    /// Frames per second.
    pub rate: f64,
    /// Whether the last frame continues to the first: 1 for yes, 0 for no.
    pub closed: i32,
}

impl State {
    /// Returns the frames of the motion that the session was made from.
    fn motion(&self) -> Result<&Moving> {
        let cure = "make the session by midair_session_open() from a scene file with [motion]";
        self.moving.as_ref().ok_or_else(|| Error::invalid("motion", "not there", cure))
    }
}

/// Returns a range of frames; rejects one with no frames or beyond the last.
fn range(moving: &Moving, first: usize, count: usize) -> Result<Range<usize>> {
    if let Some(end) = first.checked_add(count).filter(|&end| count > 0 && end <= moving.frames()) {
        return Ok(first..end);
    }
    let cure = format!("the motion has {}, give some of them", moving.frames());
    Err(Error::invalid("frames", format!("{count} from {first} on"), cure))
}

/// Writes to motion the number of frames, and more, of a session that was made from a scene file with [motion].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_motion(
    session: *mut Session,
    motion: *mut Motion,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees the session.
        let state = unsafe { Session::behind(session) }?.state()?;
        let moving = state.motion()?;
        let (frames, points) = (moving.frames(), moving.count());
        let shown = Motion { frames, points, rate: moving.rate, closed: moving.closed.into() };
        // SAFETY: the caller guarantees the buffer.
        unsafe { fill("motion", motion, 1, &[shown]) }
    })
}

/// Writes the points (frames, points, 3) in m and the targets (frames, points) in Pa of some frames of a motion, from first on.
/// A target of 0 stands for a point that is absent. targets may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_frames(
    session: *mut Session,
    first: usize,
    frames: usize,
    points: *mut f64,
    targets: *mut f64,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees the session.
        let state = unsafe { Session::behind(session) }?.state()?;
        let moving = state.motion()?;
        let (range, count) = (range(moving, first, frames)?, moving.count());
        let places = range.start * count..range.end * count;
        room("points", points, places.len(), places.len())?;
        if !targets.is_null() {
            room("targets", targets, places.len(), places.len())?;
        }
        // SAFETY: `room` was checked, and the caller guarantees the buffers.
        unsafe {
            write(points, moving.points[places.clone()].as_flattened());
            if !targets.is_null() {
                write(targets, &moving.targets[places]);
            }
        }
        Ok("")
    })
}

/// Solves some frames of a motion, from first on, one after another within the bound of the motion, and writes the drives
/// (frames, transducers), where transducers is N. Frames that do not begin with 0 follow those of the last call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_follow(
    session: *mut Session,
    first: usize,
    frames: usize,
    drives: *mut Complex,
    transducers: usize,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    let message = Message { text: message, size: message_size };
    outcome(message, || {
        // SAFETY: the caller guarantees the session.
        let mut state = unsafe { Session::behind(session) }?.state()?;
        let range = range(state.motion()?, first, frames)?;
        let count = state.session.transducers();
        room("drives", drives, frames.saturating_mul(transducers), frames.saturating_mul(count))?;
        let mut output = vec![Complex32::ZERO; frames * count];
        let State { session, moving, model, .. } = &mut *state;
        if let Some(moving) = moving.as_ref() {
            session.follow_moving(moving, range.clone(), &mut output, &mut Control::none())?;
        }
        // The session has advanced: the drives are written, whatever comes of the warnings.
        // SAFETY: `room` was checked, and the caller guarantees the buffer; both complex types are two consecutive f32.
        unsafe { write(drives.cast(), &output) };
        if !message.is_wanted() {
            return Ok(String::new());
        }
        let strain = moving.as_ref().map(|moving| moving.strain(range, &output, model, &mut Control::none()));
        let strain = strain.transpose()?.flatten().map(|doubt| doubt.to_string());
        let mut said: Vec<_> = [state.remarks()].into_iter().chain(strain).collect();
        said.retain(|line| !line.is_empty());
        Ok(said.join("\n"))
    })
}
