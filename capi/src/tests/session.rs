//! Tests of a session that another thread uses.

use std::ptr::null_mut;

use super::*;

#[test]
fn a_session_at_work_elsewhere_is_refused() {
    let array = midair::Array::grid(4, 4, 0.01).expect("a grid");
    let (state, _) = State::open(Setting::new(array, "fast").expect("a setting"), &[]).expect("a state");
    let mut session = Session(Mutex::new(state));
    let session = &raw mut session;
    let (mut drive, mut text) = ([Complex { re: 0.0, im: 0.0 }; 16], [0; 100]);
    let (drive, said, point) = (drive.as_mut_ptr(), text.as_mut_ptr(), [0.0, 0.0, 0.1]);
    let (points, none) = (point.as_ptr(), std::ptr::null());
    // SAFETY: the arguments are a session, a point, and buffers for 16 drives and 100 characters.
    let solve = || unsafe { midair_session_solve(session, points, none, none, 1, drive, 16, null_mut(), said, 100) };
    // SAFETY: as above.
    let state = unsafe { Session::behind(session) }.and_then(Session::state).expect("a session at rest");
    assert_eq!(solve(), Outcome::Invalid);
    drop(state);
    // SAFETY: the text ends with NUL.
    let said = unsafe { std::ffi::CStr::from_ptr(said) }.to_str();
    assert_eq!(said, Ok("session is at work in another thread: give each thread a session of its own"));
    assert_eq!(solve(), Outcome::Ok);
}
