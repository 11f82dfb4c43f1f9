//! Compares the time of a solve through the shared library with that in Rust: N = 400, M = 4, `fast`, in alternating rounds.
//!
//! `make bench-capi` sets MIDAIR_LIBRARY to the library. Before the measurement, the drives are compared bit by bit.
#![allow(unsafe_code, reason = "functions of a library that is loaded by its name")]

use std::ffi::{CStr, c_char, c_void};
use std::ptr::{null, null_mut};
use std::time::Instant;

use libloading::{Library, Symbol};
use midair::{
    Array, Complex32, Control, InstructionSet, Medium, Model, Options, Request, Session, SolveRequest, solvers,
};

const N: usize = 400;
const M: usize = 4;
/// The number of calls of each side in one round.
const CALLS: usize = 200;
/// The number of rounds.
const ROUNDS: usize = 500;

type NewArray = unsafe extern "C" fn(*const c_char, usize, usize, *mut *mut c_void, *mut c_char, usize) -> i32;
type NewSession = unsafe extern "C" fn(*const c_void, *const c_char, *mut *mut c_void, *mut c_char, usize) -> i32;
type Solve = unsafe extern "C" fn(
    *const c_void,
    *const [f64; 3],
    *const f64,
    *const f64,
    usize,
    *mut Complex32,
    usize,
    *mut [f64; 9],
    *mut c_char,
    usize,
) -> i32;

/// Returns the points and pressures of a call.
fn request(call: usize) -> ([[f64; 3]; M], [f64; M]) {
    let turn = |j: usize| call as f64 * 1e-3 + j as f64;
    (std::array::from_fn(|j| [0.03 * turn(j).cos(), 0.03 * turn(j).sin(), 0.15]), [0.8; M])
}

/// Returns the mean time of a call in microseconds, over one round.
fn round(mut solve: impl FnMut(usize)) -> f64 {
    let start = Instant::now();
    (0..CALLS).for_each(&mut solve);
    start.elapsed().as_secs_f64() * 1e6 / CALLS as f64
}

fn main() {
    let Some(path) = std::env::var_os("MIDAIR_LIBRARY") else {
        return println!("overhead: MIDAIR_LIBRARY names no library; `make bench-capi` does");
    };
    // SAFETY: loading this library runs no code.
    let library = unsafe { Library::new(path) }.expect("a library");
    // SAFETY: the types are those of midair.h; an answer is an int, a size_t and seven doubles, nine times 8 bytes.
    let (array, session, solve): (Symbol<'_, NewArray>, Symbol<'_, NewSession>, Symbol<'_, Solve>) = unsafe {
        let get = "functions of midair.h";
        (
            library.get("midair_array_preset").expect(get),
            library.get("midair_session_new").expect(get),
            library.get("midair_session_solve").expect(get),
        )
    };
    let (mut preset, mut handle) = (null_mut(), null_mut());
    let name = |name: &'static CStr| name.as_ptr();
    // SAFETY: the texts end with NUL, and the places for handles are valid.
    unsafe {
        assert_eq!(array(name(c"paper20"), 1, 1, &raw mut preset, null_mut(), 0), 0);
        assert_eq!(session(preset, name(c"fast"), &raw mut handle, null_mut(), 0), 0);
    }
    let model =
        Model::new(&Array::preset("paper20", [1, 1]).expect("an array"), Medium::default(), InstructionSet::best());
    let fast = solvers::find("fast").and_then(|entry| entry.configure(&Options::new())).expect("a method");
    let mut own = Session::new(model.expect("a model"), fast.solver, fast.info.balance);
    let mut ask = SolveRequest {
        request: Request { pressures: Some(vec![0.0; M]), ..Request::default() },
        ..SolveRequest::default()
    };
    let mut rust = |call: usize, drive: &mut [Complex32]| {
        let (points, pressures) = request(call);
        ask.points.clear();
        ask.points.extend_from_slice(&points);
        ask.request.pressures.as_mut().expect("pressures").copy_from_slice(&pressures);
        drive.copy_from_slice(&own.solve(&ask, &mut Control::none()).expect("an answer").drive);
    };
    let (mut answer, mut message) = ([0.0; 9], [0; 512]);
    let mut c = |call: usize, drive: &mut [Complex32], reported: bool| {
        let (points, pressures) = request(call);
        let answer = if reported { &raw mut answer } else { null_mut() };
        let size = if reported { 512 } else { 0 };
        let (points, pressures) = (points.as_ptr(), pressures.as_ptr());
        // SAFETY: the lists have M and N entries; the answer and the 512 characters are valid buffers.
        let outcome = unsafe {
            solve(handle, points, pressures, null(), M, drive.as_mut_ptr(), N, answer, message.as_mut_ptr(), size)
        };
        assert_eq!(outcome, 0);
    };
    let mut drives = [(); 2].map(|()| vec![Complex32::ZERO; N]);
    let [mine, other] = &mut drives;
    for call in 0..100 {
        rust(call, mine);
        c(call, other, true);
        assert_eq!(mine, other, "call {call}");
    }
    let mut times = [(); 3].map(|()| Vec::with_capacity(ROUNDS));
    for _ in 0..ROUNDS {
        times[0].push(round(|call| rust(call, mine)));
        times[1].push(round(|call| c(call, other, false)));
        times[2].push(round(|call| c(call, other, true)));
    }
    let [rust, bare, reported] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 2]
    });
    println!("fast, N = {N}, M = {M}, medians of {ROUNDS} rounds in turns: Rust {rust:.2} us");
    println!(
        "C, drive alone {bare:.2} us ({:.3} times); with answer and message {reported:.2} us ({:.3} times)",
        bare / rust,
        reported / rust
    );
}
