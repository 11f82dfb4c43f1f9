//! Sessions: one array and one method for many requests, with memory that is reused.

use std::ffi::c_char;
use std::sync::{Mutex, MutexGuard, TryLockError};

use midair::files::{Format, Source, open};
use midair::{
    Control, Error, ErrorCode, InstructionSet, Model, Moving, Precision, Problem, Request, Result, SolveRequest,
};

use crate::answer::{Answer, Metrics};
use crate::array::Array;
use crate::memory::{
    Complex, Lists, drive as read_drive, fill, give, handle, list, path_or_none, room, text, vectors, write,
};
use crate::option::{Input, Setting};
use crate::outcome::{Message, Outcome, outcome};

/// An array, a method with its options, and the memory of their solves. One thread at a time may use a session;
/// different sessions may be used by different threads at the same time.
pub struct Session(Mutex<State>);

/// The data that calls change.
pub(crate) struct State {
    setting: Setting,
    /// Warnings about the settings, and whether the message of a solve has had them.
    doubts: Vec<String>,
    repeated: bool,
    pub(crate) model: Model,
    pub(crate) session: midair::Session,
    pub(crate) ask: SolveRequest,
    /// The request of the scene from which the session was made.
    scene_request: Option<SolveRequest>,
    /// The frames of the motion from which it was made.
    pub(crate) moving: Option<Moving>,
}

impl State {
    /// Makes a session with these settings. Also returns its warnings, without those in `reported`.
    fn open(setting: Setting, reported: &[String]) -> Result<(Self, String)> {
        let (model, session) = setting.open()?;
        let doubts = setting.doubts();
        let news: Vec<&str> = doubts.iter().filter(|doubt| !reported.contains(doubt)).map(String::as_str).collect();
        let news = news.join("\n");
        let ask = SolveRequest { aim: setting.aim(), ..SolveRequest::default() };
        Ok((Self { setting, doubts, repeated: false, model, session, ask, scene_request: None, moving: None }, news))
    }

    /// Makes a session from the text of a scene. Also returns warnings about probable mistakes.
    pub(crate) fn of_scene(text: &str, source: Source<'_>) -> Result<(Self, String)> {
        if !text.trim().is_empty() && !text.contains(['=', '{', '[']) {
            return Err(Error::new(ErrorCode::Unreadable, "scene", text, "give the text of a scene file, no path"));
        }
        let (scene, moving) =
            open(text.as_bytes(), Format::of_text(text.as_bytes()), source, InstructionSet::requested()?)?;
        let (state, said) = Self::open(Setting::of_scene(&scene)?, &[])?;
        let scene_request = moving.is_none().then(|| SolveRequest::of_scene(&scene));
        let doubts = moving.iter().flat_map(Moving::doubts).map(|doubt| doubt.to_string());
        let said: Vec<String> = Some(said).filter(|said| !said.is_empty()).into_iter().chain(doubts).collect();
        Ok((Self { scene_request, moving, ..state }, said.join("\n")))
    }

    /// Solves the request of the scene from which the session was made.
    pub(crate) fn solve_own(&mut self) -> Result<&midair::Solution> {
        if let Some(scene) = &self.scene_request {
            let Request { pressures, phases, weights } = &scene.request;
            self.ask.write(&scene.points, [pressures, phases, weights].map(Option::as_deref));
        } else if self.moving.is_some() {
            let cure = "the scene has [motion]: solve its frames by midair_session_follow()";
            return Err(Error::invalid("points", "left out", cure));
        }
        self.session.solve(&self.ask, &mut Control::none())
    }

    /// Returns the boards of this kind for the session's array.
    pub(crate) fn board(&self, kind: &str) -> Result<midair::Board> {
        self.setting.board(kind)
    }

    /// Returns the warnings about the last solution, each kind once in a session; first those about the settings again, as
    /// many a caller reads only the messages of solves.
    pub(crate) fn remarks(&mut self) -> String {
        let own = if std::mem::replace(&mut self.repeated, true) { Vec::new() } else { self.doubts.clone() };
        let doubts = self.session.doubts(&self.ask).into_iter().map(|doubt| doubt.to_string());
        let remarks = self.session.remarks().map(|remark| remark.to_string());
        let lines: Vec<String> = own.into_iter().chain(doubts).chain(remarks).collect();
        lines.join("\n")
    }
}

impl Session {
    /// Returns the session behind a handle.
    ///
    /// # Safety
    /// The handle is NULL, or it has not been freed.
    pub(crate) unsafe fn behind<'a>(session: *mut Self) -> Result<&'a Self> {
        // SAFETY: the caller's guarantees are passed on; a lock protects the data that change.
        handle("session", unsafe { session.as_ref() })
    }

    pub(crate) fn state(&self) -> Result<MutexGuard<'_, State>> {
        match self.0.try_lock() {
            Ok(state) => Ok(state),
            // After a panic, no later call reads data that the call may have left incomplete.
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                Err(Error::invalid("session", "at work in another thread", "give each thread a session of its own"))
            }
        }
    }

    /// Sets an option. The session then starts anew, with no memory of earlier requests.
    fn set(&self, name: &str, input: Input<'_>) -> Result<String> {
        let mut state = self.state()?;
        let mut setting = state.setting.clone();
        setting.set(name, input)?;
        let (next, news) = State::open(setting, &state.doubts)?;
        *state = State { scene_request: state.scene_request.take(), moving: state.moving.take(), ..next };
        Ok(news)
    }
}

/// Makes a session for an array and a method, such as "uniform" or "fast", with the array's default medium. The session has a
/// copy of the array, which may be freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_new(
    array: Option<&Array>,
    method: *const c_char,
    session: *mut *mut Session,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    // SAFETY: the caller guarantees method and session.
    unsafe {
        give("session", session, Message { text: message, size: message_size }, || {
            let setting = Setting::new(handle("array", array)?.0.clone(), text("method", method)?)?;
            let (state, news) = State::open(setting, &[])?;
            Ok((Session(Mutex::new(state)), news))
        })
    }
}

/// Makes a session from the text of a scene file, TOML or JSON: its array, medium, obstacles, signature, solver and points.
/// folder is the folder of the files that the scene names; if folder is NULL, such files are errors. Shapes of text or
/// drawings, images and files of meshes need the Python package, and are errors. midair_session_solve() with 0 points solves
/// the scene's own request. Of a scene with [motion], midair_session_follow() solves the frames.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_open(
    scene: *const c_char,
    folder: *const c_char,
    session: *mut *mut Session,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    // SAFETY: the caller guarantees scene, folder and session.
    unsafe {
        give("session", session, Message { text: message, size: message_size }, || {
            let (scene, folder) = (text("scene", scene)?, path_or_none("folder", folder)?);
            let (state, news) = State::of_scene(scene, Source { name: "scene", folder })?;
            Ok((Session(Mutex::new(state)), news))
        })
    }
}

/// Returns the number N of a session's transducers, the length of a drive; 0 for NULL and for a session in use by another
/// thread.
#[unsafe(no_mangle)]
pub extern "C" fn midair_session_transducers(session: Option<&Session>) -> usize {
    session.and_then(|session| session.state().ok()).map_or(0, |state| state.session.transducers())
}

/// Sets an option to a number: of the medium (every key of `[medium]` in a scene file, such as "temperature"), of the
/// transducers ("source_pressure", or "directivity." and the name of a directivity with a parameter, as in
/// "directivity.piston"), of the bead that traps are made for ("bead.radius", "bead.density", "bead.sound_speed"), or of the
/// method. After an option is set, the session has no memory of earlier requests.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_set_number(
    session: *mut Session,
    name: *const c_char,
    value: f64,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees session and name.
        let (session, name) = unsafe { (Session::behind(session)?, text("name", name)?) };
        session.set(name, Input::Number(value))
    })
}

/// Sets an option to a text: "directivity" ("point", "t4010a1", ...), "quantization" (a board's name, or "none" for any drive),
/// "balance" ("true" or "false"), "aim" ("target" or "max"), or an option of the method.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_set_text(
    session: *mut Session,
    name: *const c_char,
    value: *const c_char,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees session, name and value.
        let (session, name, value) = unsafe { (Session::behind(session)?, text("name", name)?, text("value", value)?) };
        session.set(name, Input::Text(value))
    })
}

/// Sets an option to a list: "mask" (N, 1 for on and 0 for off), "response" (N, 2; real and imaginary part), "channels" (N,
/// shared channels), "pins" (N, channels of the boards), "bead.gravity" (3, along x, y and z in m/s^2), or an option of the
/// method.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_set_numbers(
    session: *mut Session,
    name: *const c_char,
    values: *const f64,
    count: usize,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees session, name and values.
        let (session, name) = unsafe { (Session::behind(session)?, text("name", name)?) };
        // SAFETY: the caller guarantees values.
        session.set(name, Input::Numbers(unsafe { list("values", values, count) }?))
    })
}

/// Computes a drive for points (count, 3) in m, and writes it to drive (transducers,), where transducers is N. pressures
/// (count,) are peak |p| in Pa; if NULL, all points get the level that the array can give to all of them at once. weights
/// (count,) may be NULL for 1 everywhere; answer may be NULL. With 0 points, a session made from a scene solves the scene's own
/// request. Each kind of warning is in the message once per session; without a message, warnings are not computed. Warnings
/// about array and medium are in the message of the call that made the session, and in that of the first solve.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_solve(
    session: *mut Session,
    points: *const f64,
    pressures: *const f64,
    weights: *const f64,
    count: usize,
    drive: *mut Complex,
    transducers: usize,
    answer: *mut Answer,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    let message = Message { text: message, size: message_size };
    outcome(message, || {
        // SAFETY: the caller guarantees valid arguments.
        let mut state = unsafe { Session::behind(session) }?.state()?;
        room("drive", drive, transducers, state.session.transducers())?;
        if !answer.is_null() {
            room("answer", answer, 1, 1)?;
        }
        // SAFETY: the caller guarantees the lists.
        let lists = unsafe { Lists::read(points, pressures, weights, count) }?;
        let solution = if lists.points.is_empty() && (state.scene_request.is_some() || state.moving.is_some()) {
            state.solve_own()?
        } else {
            let State { session, ask, .. } = &mut *state;
            ask.write(lists.points, [lists.pressures, None, lists.weights]);
            session.solve(ask, &mut Control::none())?
        };
        // SAFETY: `room` was checked, and the caller guarantees the buffers; both complex types are two consecutive f32.
        unsafe {
            write(drive.cast(), &solution.drive);
            if !answer.is_null() {
                answer.write(solution.into());
            }
        }
        Ok(if message.is_wanted() { state.remarks() } else { String::new() })
    })
}

/// Returns the number M of points of the session's last solution; 0 if there is none, and for a session in use by another
/// thread.
#[unsafe(no_mangle)]
pub extern "C" fn midair_session_points(session: Option<&Session>) -> usize {
    let state = session.and_then(|session| session.state().ok());
    state.and_then(|state| Some(state.session.solution()?.pressures.len())).unwrap_or_default()
}

/// Writes the complex pressures (count,) in Pa (peak) of the session's last solution, its scale applied, and its points
/// (count, 3) in m; count is midair_session_points(). points may be NULL. With a signature the pressures are those of the foci
/// before they become traps; midair_session_field() computes the real ones.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_pressures(
    session: *mut Session,
    pressures: *mut Complex,
    points: *mut f64,
    count: usize,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees valid arguments.
        let state = unsafe { Session::behind(session) }?.state()?;
        let cure = "call midair_session_solve() before";
        let solution = state.session.solution().ok_or_else(|| Error::missing("solution", "not there", cure))?;
        let own = solution.requested().0.control_points().unwrap_or_default();
        room("pressures", pressures, count, own.len())?;
        // SAFETY: `room` was checked, and the caller guarantees the buffers; both complex types are two consecutive f32.
        unsafe {
            if !points.is_null() {
                fill("points", points.cast::<[f64; 3]>(), count, own)?;
            }
            write(pressures.cast(), &solution.pressures);
        }
        Ok("")
    })
}

/// Computes the metrics of a drive (transducers,) at points (count, 3) in m, in double precision; pressures and weights
/// (count,) are as in midair_session_solve(). With 0 points, a session made from a scene refers to the scene's own request.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_judge(
    session: *mut Session,
    drive: *const Complex,
    transducers: usize,
    points: *const f64,
    pressures: *const f64,
    weights: *const f64,
    count: usize,
    metrics: *mut Metrics,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees valid arguments.
        let state = unsafe { Session::behind(session) }?.state()?;
        // SAFETY: the caller guarantees the lists.
        let (drive, Lists { points, pressures, weights }) =
            unsafe { (read_drive(drive, transducers)?, Lists::read(points, pressures, weights, count)?) };
        let mut ask = SolveRequest::default();
        ask.write(points, [pressures, None, weights]);
        let SolveRequest { points, request, .. } =
            state.scene_request.as_ref().filter(|_| points.is_empty()).unwrap_or(&ask);
        let control = &mut Control::none();
        let judged =
            Problem::of_model(&state.model, points, request, control)?.judge(drive, Precision::Double, control)?;
        // SAFETY: the caller guarantees the buffer.
        unsafe { fill("metrics", metrics, 1, &[judged.into()]) }
    })
}

/// Writes the complex pressures (count,) in Pa (peak) of a drive (transducers,) at any points (count, 3) in m.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_field(
    session: *mut Session,
    drive: *const Complex,
    transducers: usize,
    points: *const f64,
    count: usize,
    pressures: *mut Complex,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees valid arguments.
        let state = unsafe { Session::behind(session) }?.state()?;
        // SAFETY: the caller guarantees the lists.
        let (drive, points) = unsafe { (read_drive(drive, transducers)?, vectors("points", points, count)?) };
        let field = midair::field(&state.model, drive, points, &mut Control::none())?;
        // SAFETY: the caller guarantees the buffer; both complex types are two consecutive f32.
        unsafe { fill("pressures", pressures.cast(), count, &field) }
    })
}

/// Frees a session. NULL is allowed.
#[unsafe(no_mangle)]
pub extern "C" fn midair_session_free(session: Option<Box<Session>>) {
    drop(session);
}

#[cfg(test)]
#[path = "tests/session.rs"]
mod tests;
