//! Batches: many requests of one session, or many scenes, solved on several threads by one call.

use std::ffi::c_char;
use std::num::NonZero;
use std::panic::resume_unwind;
use std::path::Path;
use std::thread;

use midair::files::Source;
use midair::{Complex32, Control, Error, Result, SolveRequest};

use crate::answer::Answer;
use crate::memory::{Complex, Lists, list, path_or_none, room, text, write};
use crate::outcome::{Message, Outcome, outcome};
use crate::session::{Session, State};

/// Returns the number of threads: at most this many, or as many as there are processors for 0.
fn at_most(threads: usize) -> usize {
    let all = thread::available_parallelism().map_or(1, NonZero::get);
    if threads == 0 { all } else { threads.min(all) }
}

/// Runs work that starts threads on a separate thread. Rust allocates memory in a thread that waits for others, and frees it
/// only when that thread ends; so none remains in the caller's thread.
fn aside<R: Send>(work: impl FnOnce() -> R + Send) -> Result<R> {
    // SAFETY: everything that the work borrows outlives the thread, which is joined before this function returns.
    let thread = unsafe { thread::Builder::new().spawn_unchecked(work) };
    let thread = thread.map_err(|error| Error::invalid("threads", error, "the system starts no more: end some"))?;
    Ok(thread.join().unwrap_or_else(|panic| resume_unwind(panic)))
}

/// Returns the number of entries in a list for all problems, with `count` entries for each problem.
fn entries(problems: usize, count: usize) -> Result<usize> {
    let cure = "no memory holds so many points: look at the counts";
    problems.checked_mul(count).ok_or_else(|| Error::invalid("problems", problems, cure))
}

/// Checks that drives and answers of this many problems can be written. Returns the number of entries of the drives.
fn outputs(problems: usize, drives: *mut Complex, transducers: usize, answers: *mut Answer) -> Result<usize> {
    let rows = entries(problems, transducers)?;
    room("drives", drives, rows, rows)?;
    if !answers.is_null() {
        room("answers", answers, problems, problems)?;
    }
    Ok(rows)
}

/// Solves problems of count points each by one call, on at most this many threads (0 for one per processor). The inputs are
/// points (problems, count, 3) in m, and pressures and weights (problems, count) as in midair_session_solve(). The outputs are
/// drives (problems, transducers) and answers (problems,), which may be NULL. Each answer has the same bits as that of
/// midair_session_solve() for the problem alone in a new session, for any number of threads. If a problem is rejected, the
/// message gives its index, and nothing is written. Problems with fewer points can be filled with points of weight 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_session_solve_batch(
    session: *mut Session,
    points: *const f64,
    pressures: *const f64,
    weights: *const f64,
    problems: usize,
    count: usize,
    threads: usize,
    drives: *mut Complex,
    transducers: usize,
    answers: *mut Answer,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees valid arguments.
        let mut state = unsafe { Session::behind(session) }?.state()?;
        let State { session, ask, .. } = &mut *state;
        let (size, aim) = (session.transducers(), ask.aim);
        if transducers != size {
            return Err(Error::invalid("transducers", transducers, format!("the session has {size}")));
        }
        let rows = outputs(problems, drives, transducers, answers)?;
        // SAFETY: the caller guarantees the lists.
        let all = unsafe { Lists::read(points, pressures, weights, entries(problems, count)?) }?;
        let request = |k: usize, ask: &mut SolveRequest| {
            let range = k * count..(k + 1) * count;
            let [pressures, weights] = [all.pressures, all.weights].map(|list| list.map(|list| &list[range.clone()]));
            ask.write(&all.points[range], [pressures, None, weights]);
            ask.aim = aim;
            Ok(())
        };
        let mut output = vec![Complex32::ZERO; rows];
        let threads = at_most(threads);
        let mut solve = || {
            let control = &mut Control::none().with_threads(threads);
            session.solve_batch(problems, count, &request, &mut output, control)
        };
        let batch = if threads == 1 { solve() } else { aside(solve)? }?;
        let answer = |k: usize| Answer {
            status: batch.status[k].into(),
            steps: batch.steps[k],
            scale: batch.scale[k],
            metrics: batch.metrics[k].into(),
        };
        // SAFETY: `outputs` checked the space; both complex types are two consecutive f32.
        unsafe {
            write(drives.cast(), &output);
            if !answers.is_null() {
                write(answers, &(0..problems).map(answer).collect::<Vec<_>>());
            }
        }
        let doubts = session.batch_doubts(all.points, count);
        let lines: Vec<String> = doubts.iter().map(ToString::to_string).chain(batch.remarks).collect();
        Ok(lines.join("\n"))
    })
}

/// Solves the requests of count scenes by one call, on at most this many threads (0 for one per processor). scenes (count,) are
/// texts as for midair_session_open(); folder is the folder of the files that scenes name, or NULL. drives (count, transducers)
/// has one row for each scene; a row is filled with 0 after the drive of a scene with fewer transducers. answers (count,) may
/// be NULL. If a scene is rejected, the message gives its index, and nothing is written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_solve_scenes(
    scenes: *const *const c_char,
    folder: *const c_char,
    count: usize,
    threads: usize,
    drives: *mut Complex,
    transducers: usize,
    answers: *mut Answer,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        outputs(count, drives, transducers, answers)?;
        // SAFETY: the caller guarantees scenes and folder.
        let (scenes, folder) = unsafe {
            let texts = list("scenes", scenes, count)?.iter().enumerate();
            let scenes: Result<Vec<&str>> = texts.map(|(k, &scene)| text(&format!("scenes[{k}]"), scene)).collect();
            (scenes?, path_or_none("folder", folder)?)
        };
        let share = count.div_ceil(at_most(threads)).max(1);
        let part = |first: usize| -> Vec<Result<Solved>> {
            (first..count.min(first + share)).map(|k| solve_scene(k, scenes[k], folder, transducers)).collect()
        };
        let spread = || {
            thread::scope(|scope| {
                let parts: Vec<_> = (0..count).step_by(share).map(|first| scope.spawn(move || part(first))).collect();
                parts.into_iter().flat_map(|part| part.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
            })
        };
        let solved = if share < count { aside(spread)? } else { part(0) };
        let solved: Vec<Solved> = solved.into_iter().collect::<Result<_, _>>()?;
        // SAFETY: `outputs` checked the space; both complex types are two consecutive f32.
        unsafe {
            for (k, one) in solved.iter().enumerate() {
                write(drives.add(k * transducers).cast(), &one.drive);
            }
            if !answers.is_null() {
                write(answers, &solved.iter().map(|one| one.answer).collect::<Vec<_>>());
            }
        }
        let lines: Vec<String> = solved.into_iter().flat_map(|one| one.said).collect();
        Ok(lines.join("\n"))
    })
}

/// The result of a scene: its drive, filled up to the length of a row, its answer, and its warnings.
struct Solved {
    drive: Vec<Complex32>,
    answer: Answer,
    said: Vec<String>,
}

fn solve_scene(k: usize, text: &str, folder: Option<&Path>, row: usize) -> Result<Solved> {
    let place = format!("scenes[{k}]");
    let (mut state, _) = State::of_scene(text, Source { name: &place, folder })?;
    if state.session.transducers() > row {
        let value = format!("{} transducers", state.session.transducers());
        return Err(Error::invalid(place, value, format!("a row of drives has room for {row}")));
    }
    let solution = state.solve_own().map_err(|error| error.inside(place.as_str()))?;
    let (mut drive, answer) = (solution.drive.clone(), solution.into());
    drive.resize(row, Complex32::ZERO);
    let said = state.remarks().lines().map(|line| format!("{place}: {line}")).collect();
    Ok(Solved { drive, answer, said })
}
