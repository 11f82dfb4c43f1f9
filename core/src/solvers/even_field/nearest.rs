//! Nearest: the drive whose field is nearest to the targets, where points cannot be even or miss their targets.
//!
//! 1. *Phases* of least squares at the balanced level ([`least_squares`]), or at the targets where these are higher: all
//!    power goes to the targets.
//! 2. *Meet* the targets by Gauss-Newton steps, where all are near ([`met`]).
//! 3. *Phases and amplitudes* at the targets ([`with_amplitudes`]), where these are not met and the board has amplitudes: below
//!    the balanced level there is freedom left, which one amplitude for all throws away.

use crate::control::Control;
use crate::device::quantization::Quantization;
use crate::error::Error;
use crate::problem::judgement::MISS;
use crate::problem::{Problem, Solution, Status};
use crate::scene::Aim;
use crate::solvers::common::least_squares::{LeastSquares, Task, least_squares, with_amplitudes};
use crate::solvers::even_field::targets::met;
use crate::workspace::Workspace;

/// More points than that are a picture: an even field of theirs takes seconds ...
const PICTURE: usize = 400;

/// ... and more than that, where they are to be unlike: their even field is far below the targets.
const UNLIKE: usize = 150;

/// Fewer that are to sound are no picture, but few points amid a quiet zone.
const LIT: usize = 32;

/// Steps of points that are to be all alike: their error falls on and on, where that of a picture comes to an end.
const STEPS_ALIKE: usize = 1500;

/// A board of fewer amplitudes plays all transducers at one.
const AMPLITUDES: usize = 16;

/// An even answer gives way to another that misses this part of what it misses.
const MUCH: f64 = 0.33;

/// A gain of less than a thousandth is no gain: rounding decides there.
const BETTER: f64 = 0.999;

/// The error that needs no amplitudes.
const MET: f64 = 1e-3;

/// The work that is usual.
pub(super) const USUAL: Task = Task { steps: 500, tolerance: 5e-4, starts: 3, seed: 0, factor: 1.0, before: 0 };

/// Whether all targets are the same.
fn alike(problem: &Problem) -> bool {
    problem.targets()[..problem.propagation().points()].windows(2).all(|pair| pair[0] == pair[1])
}

/// Whether a problem is a picture, with targets to be met: of this many points no even field is looked for.
pub(super) fn is_picture(problem: &Problem) -> bool {
    let points = problem.propagation().points();
    let lit = problem.targets().iter().filter(|&&target| target > 0.0).count();
    let many = points > PICTURE || points > UNLIKE && !alike(problem);
    many && lit >= LIT && problem.aim() == Aim::Target && !problem.has_start()
}

/// The work that a picture takes.
pub(super) fn for_picture(problem: &Problem) -> Task {
    Task { steps: if alike(problem) { STEPS_ALIKE } else { USUAL.steps }, ..USUAL }
}

/// The drive nearest to the targets.
///
/// # Errors
/// More memory than allowed; a stop before there is a drive.
pub(crate) fn nearest(
    problem: &Problem,
    task: Task,
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    let factor = problem.balance().max(1.0) as f32;
    let LeastSquares { mut drive, mut status, steps } =
        least_squares(problem, &Task { factor, ..task }, work, control)?;
    if status != Status::Stopped
        && let Some(even) = met(problem, &drive, factor, steps, work, control)?
    {
        work.complexes.give(core::mem::replace(&mut drive, even));
        status = Status::Done;
    }
    let amplitude = 1.0 / f64::from(factor);
    let few = problem.quantization().filter(|_| !has_amplitudes(problem));
    let (amplitude, scale) = few.map_or((amplitude, 1.0), |board| board.lowered(amplitude));
    for q in &mut drive {
        *q *= amplitude as f32;
    }
    if status == Status::Stopped || !has_amplitudes(problem) {
        return Ok(Solution::new(problem, drive, (status, steps.0), steps.1, work, control)?.scaled(scale));
    }
    let alone = Solution::new(problem, drive, (status, steps.0), steps.1, work, control)?;
    if alone.status == Status::Stopped || problem.miss(&alone, 0.0) <= MET {
        return Ok(alone);
    }
    let LeastSquares { drive, status, steps } = with_amplitudes(problem, &alone.drive, steps, work, control)?;
    let both = Solution::new(problem, drive, (status, steps.0), steps.1, work, control)?;
    nearer(problem, 0.0, [alone, both], true, work, control)
}

/// The second of two answers, unless the first misses less once a board has rounded both; an even one gives way only to
/// one that meets the targets, unless it is as good as `uneven`.
///
/// # Errors
/// A stop, if it is the first.
pub(super) fn nearer(
    problem: &Problem,
    quiet: f64,
    [mut first, mut second]: [Solution; 2],
    uneven: bool,
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    first.quantize(1.0, work, control)?;
    second.quantize(1.0, work, control)?;
    let misses = [&first, &second].map(|solution| problem.miss(solution, quiet));
    if misses[1] <= BETTER * misses[0] && (uneven || misses[1] <= MISS.max(MUCH * misses[0])) {
        first.recycle(work);
        return Ok(second);
    }
    (first.status, first.steps) = (second.status, second.steps);
    second.recycle(work);
    first.correct(problem, control);
    Ok(first)
}

/// Whether each transducer may have an amplitude of its own.
fn has_amplitudes(problem: &Problem) -> bool {
    let table = problem.quantization().and_then(Quantization::amplitudes);
    table.is_none_or(|table| table.len() >= AMPLITUDES)
}
