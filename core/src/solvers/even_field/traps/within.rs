//! Traps in motion: as stiff as possible with every phase within an arc around the last frame's.
//!
//! Points move by a hundredth of a wavelength a frame. So the stiffest traps are near the last ones, and a few steps of
//! [`PhaseDescent`] within the bound find them. A bead that follows its point needs the force m a + drag(v) for its
//! velocity v and acceleration a. The trap carries this force like the bead's weight. If the places x-, x+ of the
//! points h frames before and after are known,
//!
//! ```text
//! v = (x+ - x-) rate/(2 h),   a = (x+ - 2 x + x-) (rate/h)^2
//! ```
//!
//! Otherwise both are estimated from the places so far, with a smoothed over less than a bead's period:
//!
//! ```text
//! v = (x - x') rate,   a = a' + (1 - e^{-1/(rate T)}) ((v - v') rate - a'),   T = 1 ms
//! ```
//!
//! (primes are values of the last frame). This estimate is late by as much, so that beads are off their points. The
//! force is limited to what a trap can carry.

use crate::device::quantization::Quantization;
use crate::kernels::tiles::unit::Arc;
use crate::prelude::*;
use crate::problem::Problem;
use crate::propagation::forces::stiffness::Stiffness;
use crate::scene::{distance, dot};
use crate::solvers::common::phase_descent::PhaseDescent;
use crate::solvers::common::tiled::Wave;
use crate::solvers::even_field::traps::foci::FixedFoci;
use crate::solvers::even_field::traps::on_grid;
use crate::solvers::even_field::traps::stiffest::{self, Softest, planes};
use crate::solvers::last::{Last, settled};
use crate::workspace::Workspace;

/// T in s (see the module's head). A bead of expanded polystyrene swings with a period of some 20 ms.
const SMOOTHED: f64 = 1e-3;

/// Largest displacement of a bead by the force, relative to the wavelength: a trap pulls it back within a quarter.
const FURTHEST: f64 = 0.2;

/// Largest movement of a point in a frame, relative to the wavelength. A larger one is a jump to another point, which
/// no bead would follow.
const JUMP: f64 = 0.25;

/// The traps of a frame, and the foci beside them.
pub(crate) struct Moving {
    traps: Stiffness,
    fixed: FixedFoci,
}

/// The range of phases, the number of steps, and the part of an envelope that remains after a frame.
#[derive(Clone, Copy)]
pub(crate) struct Turn {
    pub(crate) arc: Arc,
    pub(crate) steps: u32,
    pub(crate) kept: f64,
}

/// Returns the traps of a frame that requests nothing from its traps but stiffness; `None` for any other frame. The
/// foci beside the traps keep the level that they had in the first frame, unless their pressures are in Pa.
///
/// # Errors
/// More memory than allowed, a stop.
pub(crate) fn requested(problem: &Problem, last: &mut Last, control: &mut Control) -> Result<Option<Moving>, Error> {
    let Some(traps) = stiffest::requested(problem, control)? else { return Ok(None) };
    let foci = !traps.chosen()[1].is_empty();
    if foci && last.weights.len() != 1 {
        let field = traps.field(&last.played);
        last.weights.clear();
        last.weights.push(stiffest::level(&traps, problem, [&field[0], &field[1]]) as f32);
    }
    let level = if foci { f64::from(last.weights[0]) } else { 1.0 };
    let fixed = FixedFoci::of(&traps, problem, level);
    Ok(Some(Moving { traps, fixed }))
}

/// Adds to traps the forces that their particles need to move with their points, a frame after `last`. Returns the
/// motion to be stored for the next frame.
pub(crate) fn accelerate(moving: &mut Moving, problem: &Problem, rate: f64, last: &Last) -> Vec<[f64; 3]> {
    let traps = &mut moving.traps;
    let places = problem.propagation().control_points().unwrap_or_default();
    let wavelength = problem.setup().medium.wavelength();
    let motion = moved(&last.motion, places, rate, wavelength);
    let known = known((&last.around.0, last.around.1), places, rate, wavelength);
    let so_far = || {
        let mut lists = motion.chunks_exact(places.len()).skip(1);
        Some(lists.next()?.iter().copied().zip(lists.next()?.iter().copied()).collect())
    };
    let moving: Vec<_> = known.or_else(so_far).unwrap_or_default();
    carry(traps, &moving, &last.played, wavelength);
    motion
}

/// Adds to traps the forces that their particles need to move with their points, from the points' places (2 M, 3)
/// `apart` frames before and after.
pub(crate) fn carry_along(
    traps: &mut Stiffness,
    (places, around, apart): (&[[f64; 3]], &[[f64; 3]], usize),
    rate: f64,
    drive: &[Complex32],
    wavelength: f64,
) {
    let moving = known((around, apart), places, rate, wavelength).unwrap_or_default();
    carry(traps, &moving, drive, wavelength);
}

/// Returns velocities and accelerations of points from their places `apart` frames before and after; `None` if these
/// are not known.
fn known(
    (around, apart): (&[[f64; 3]], usize),
    places: &[[f64; 3]],
    rate: f64,
    wavelength: f64,
) -> Option<Vec<([f64; 3], [f64; 3])>> {
    if around.len() != 2 * places.len() {
        return None;
    }
    let (before, after) = around.split_at(places.len());
    let rate = rate / apart as f64;
    let each = |(x, (before, after)): (&[f64; 3], (&[f64; 3], &[f64; 3]))| {
        let bend = [0, 1, 2].map(|axis| after[axis] - 2.0 * x[axis] + before[axis]);
        if dot(bend, bend) > JUMP * JUMP * wavelength * wavelength {
            return ([0.0; 3], [0.0; 3]);
        }
        ([0, 1, 2].map(|axis| (after[axis] - before[axis]) * rate / 2.0), bend.map(|x| x * rate * rate))
    };
    Some(places.iter().zip(before.iter().zip(after)).map(each).collect())
}

/// Adds to traps the forces that their particles need for velocities and accelerations (M,), as far as the traps of a
/// drive (N,) can carry them.
fn carry(traps: &mut Stiffness, moving: &[([f64; 3], [f64; 3])], drive: &[Complex32], wavelength: f64) {
    let chosen = traps.chosen()[0].iter().filter_map(|&j| moving.get(j));
    let forces: Vec<_> = chosen.map(|&(v, a)| traps.needed(v, a)).collect();
    let field = traps.field(drive);
    let (_, yielding) = traps.balance([&field[0], &field[1]]);
    let carried = forces.iter().zip(&yielding).map(|(force, yielding)| {
        let shift = yielding.map(|row| dot(row, *force));
        let part = (FURTHEST * wavelength / math::sqrt(dot(shift, shift)).max(f64::MIN_POSITIVE)).min(1.0);
        force.map(|x| part * x)
    });
    traps.pull_by(&carried.collect::<Vec<_>>());
}

/// Returns places (M, 3), and once they are known their velocities and accelerations, given those of the frame before.
fn moved(before: &[[f64; 3]], places: &[[f64; 3]], rate: f64, wavelength: f64) -> Vec<[f64; 3]> {
    let near = |(x, last): (&[f64; 3], &[f64; 3])| distance(*x, *last) < JUMP * wavelength;
    let known = [1, 2, 3].map(|lists| lists * places.len());
    let follows = known.contains(&before.len()) && places.iter().zip(before).all(near);
    let mut old = before.chunks_exact(places.len()).take(if follows { 3 } else { 0 });
    let slope = |(new, old): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|axis| (new[axis] - old[axis]) * rate);
    let mut motion = places.to_vec();
    let Some(last) = old.next() else { return motion };
    let velocities: Vec<_> = places.iter().zip(last).map(slope).collect();
    motion.extend_from_slice(&velocities);
    let Some(last) = old.next() else { return motion };
    let share = 1.0 - math::exp(-1.0 / (rate * SMOOTHED));
    let mut accelerations = old.next().map_or_else(|| alloc::vec![[0.0; 3]; places.len()], <[_]>::to_vec);
    for (own, new) in accelerations.iter_mut().zip(velocities.iter().zip(last).map(slope)) {
        own.iter_mut().zip(new).for_each(|(own, new)| *own += share * (new - *own));
    }
    motion.extend(accelerations);
    motion
}

/// Turns the drives, which are relative to those played last, so that the traps become as stiff as possible.
///
/// # Errors
/// More memory than allowed, a stop.
pub(crate) fn stiffen(
    Moving { traps, fixed }: &Moving,
    problem: &Problem,
    last: &Last,
    Turn { arc, steps, kept }: Turn,
    relative: [&mut [f32]; 2],
    work: &Workspace,
    control: &mut Control,
) -> Result<(), Error> {
    let mut rows = stiffest::rows(traps, (problem.propagation().instruction_set(), last.played.len()), work, control)?;
    let mut own = Wave::new(&rows, work);
    let beside = (kept > 0.0).then(|| {
        own.play(&rows, last.envelope.iter().map(|y| y * kept as f32));
        own.field.each_ref().map(|plane| plane.to_vec())
    });
    let beside = beside.as_ref().map(|planes| planes.each_ref().map(|plane| &plane[..]));
    own.take(&rows, last.played.iter().map(|q| q * (1.0 - kept) as f32));
    rows.rotate(&own.drive);
    for (own, drive) in own.drive.iter_mut().zip(&relative) {
        own.copy_from_slice(drive);
    }
    own.hear(&rows);
    let cost = Softest::last((traps, fixed), planes(&own), beside);
    let mut descent = if arc[0] > -1.0 {
        PhaseDescent::within(rows.arcs(arc, work), own, &cost, &rows, work)
    } else {
        PhaseDescent::new(own, &cost, &rows, work)
    };
    for _ in 0..steps {
        control.pulse()?;
        if !descent.step(&cost, &rows) {
            break;
        }
    }
    for (drive, own) in relative.into_iter().zip(&descent.wave.drive) {
        drive.copy_from_slice(own);
    }
    Ok(())
}

/// Rounds drives (N,), given relative to those played last, to the board's grid, and stores them in `last`. Returns
/// them as they are played, relative to the same drives.
pub(crate) fn keep(
    moving: &Moving,
    problem: &Problem,
    most: f32,
    relative: &[Complex32],
    last: &mut Last,
) -> Vec<Complex32> {
    let found: Vec<Complex32> = last.played.iter().zip(relative).map(|(q, d)| settled(q * d)).collect();
    let mut played = found.clone();
    let board = problem.quantization();
    if board.is_none_or(|board| bring(moving, (problem, board), (last, most), &mut played)) {
        last.wave = found;
    }
    let turned = played.iter().zip(&last.played).map(|(q, old)| q * old.conj()).collect();
    last.played = played;
    turned
}

/// Rounds drives (N,) to a board's grid, within `most` codes of those played last. If the drives played last are no
/// worse, they are taken instead, and the result is false.
fn bring(
    Moving { traps, fixed }: &Moving,
    (problem, board): (&Problem, &Quantization),
    (last, most): (&Last, f32),
    drive: &mut [Complex32],
) -> bool {
    let before = traps.field(&last.played);
    let before = before.each_ref().map(|plane| &plane[..]);
    let cost = Softest::last((traps, fixed), before, None);
    let set = problem.propagation().instruction_set();
    on_grid::bring(set, (traps, fixed, cost.unit), board, (&[&last.played], most), (drive, &mut || false));
    let after = traps.field(drive);
    let better = cost.of_field([&after[0], &after[1]]) < cost.of_field(before);
    if !better {
        drive.copy_from_slice(&last.played);
    }
    better
}
