//! Grid: brings an even field to a board's phases and amplitudes, and reduces it to the targets.
//!
//! Error diffusion rounds to eight or more phases. With fewer, two neighbouring codes are tried for each transducer, and
//! [`raise`] searches for the loudest weakest point; transducers may be off:
//!
//! ```text
//! E = sum_j (s/|P_j|)^2p,  p = 4, 8, 16           each change of a transducer to another code of the grid lowers E
//! ```
//!
//! s is the mean of |P_j|. Two phases leave errors of a tenth at every point. A common phase of all drives changes
//! which way each of them is rounded, so several common phases are tried.

use crate::control::bytes;
use crate::device::quantization::Quantization;
use crate::kernels::tiles::error_diffusion::{Choice, Task, diffuse, floats};
use crate::math::phasor;
use crate::prelude::*;
use crate::problem::{Problem, Solution, Status};
use crate::scene::Aim;
use crate::solvers::common::refinement::refine;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::run::Run;
use crate::workspace::{Buffer, Workspace};

/// Number of angles by which the drive is turned before it is rounded. Each turned drive is a start of the search,
/// besides the rounded drive itself.
const TURNS: usize = 8;

/// log2 of each value of p (see the module's head), in the order of their use.
const SHARPNESS: [u32; 3] = [2, 3, 4];
/// Largest number of sweeps over the transducers for each value of p.
const SWEEPS: usize = 8;

/// Largest number of codes of a transducer: seven phases, and off.
const MOST_CODES: usize = 8;

/// Returns the board if it has few phases and all points of the run have a target.
pub(super) fn board<'a>(run: &Run<'a, '_, '_>) -> Option<&'a Quantization> {
    let points = run.rows.order.len();
    let few = |board: &&Quantization| board.phases().is_some_and(|phases| phases < FEWEST);
    run.problem.quantization().filter(few).filter(|_| points > 1 && points == run.rows.targeted)
}

/// Raises the weakest target of a wave on the grid; `free` is its drive before rounding. A stop leaves the best result
/// so far.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn raise<'w>(
    run: &mut Run<'_, '_, 'w>,
    quantization: &Quantization,
    free: &[Complex32],
    wave: &mut Wave<'w>,
) -> Result<(), Error> {
    let (rows, work) = (run.rows, run.work);
    let sides = [free.len(), rows.targeted];
    run.control.room("the columns of G", sides, bytes(16, &sides))?;
    let mut codes = [Complex32::ZERO; MOST_CODES];
    let phases = quantization.phases().unwrap_or(0) as usize;
    for (k, code) in codes.iter_mut().take(phases).enumerate() {
        let v = phasor(core::f64::consts::TAU * k as f64 / phases as f64);
        *code = quantization.nearest(Complex32::new(v.re as f32, v.im as f32));
    }
    let off = quantization.amplitudes().is_none_or(|table| table[0] == 0.0);
    let mut search = Search::new(run, &codes[..phases + usize::from(off)]);
    let mut best = wave.drives(free.len(), work);
    let mut most = wave.lowest(rows);
    let mut trial = Wave::new(rows, work);
    let mut drive = work.complexes.take(free.len());
    for turn in 0..=TURNS {
        drive.copy_from_slice(if turn == 0 { &best } else { free });
        if turn > 0 {
            let v = phasor(core::f64::consts::TAU * turn as f64 / (phases * TURNS) as f64);
            drive.iter_mut().for_each(|q| *q *= Complex32::new(v.re as f32, v.im as f32));
            quantization.grid().round(rows.set, 1.0, [1.0; 2], &mut drive);
        }
        trial.play(rows, drive.iter().copied());
        if search.descend(run, &trial, &mut drive).is_err() {
            run.stopped = true;
            break;
        }
        trial.play(rows, drive.iter().copied());
        if trial.lowest(rows) > most {
            most = trial.lowest(rows);
            best.copy_from_slice(&drive);
            core::mem::swap(wave, &mut trial);
        }
    }
    work.complexes.give(best);
    Ok(())
}

/// The columns of G at the targeted points, and the present field.
struct Search<'a, 'w> {
    codes: &'a [Complex32],
    points: usize,
    /// G_ji at the points j, one transducer i after another.
    columns: [Buffer<'w, f64>; 2],
    field: [Buffer<'w, f64>; 2],
    /// s^2, the square of the mean pressure.
    unit: f64,
}

impl<'a, 'w> Search<'a, 'w> {
    fn new(run: &Run<'_, '_, 'w>, codes: &'a [Complex32]) -> Self {
        let (rows, work) = (run.rows, run.work);
        let points = rows.targeted;
        let mut columns = [(); 2].map(|()| work.doubles.take(rows.lanes * points));
        let mut own = [(); 2].map(|()| work.floats.take(rows.lanes));
        for j in 0..points {
            rows.conjugate(j, own.each_mut().map(|plane| &mut plane[..]));
            for (i, (re, im)) in own[0].iter().zip(&own[1]).enumerate() {
                (columns[0][i * points + j], columns[1][i * points + j]) = (f64::from(*re), -f64::from(*im));
            }
        }
        Self { codes, points, columns, field: [(); 2].map(|()| work.doubles.take(points)), unit: 0.0 }
    }

    /// Changes one transducer after another as long as that lowers E (see the module's head).
    fn descend(&mut self, run: &mut Run, wave: &Wave, drive: &mut [Complex32]) -> Result<(), Error> {
        let mean = f64::from(wave.level(run.rows));
        self.unit = mean * mean;
        for (field, own) in self.field.iter_mut().zip(&wave.field) {
            field.iter_mut().zip(own.iter()).for_each(|(field, own)| *field = f64::from(*own));
        }
        for sharpness in SHARPNESS {
            for _ in 0..SWEEPS {
                let mut moved = false;
                for (i, q) in drive.iter_mut().enumerate() {
                    run.control.pulse()?;
                    moved |= self.turn(i, q, sharpness);
                }
                if !moved {
                    break;
                }
            }
        }
        Ok(())
    }

    /// Sets one transducer to the code of the least E (see the module's head); returns whether it changed.
    fn turn(&mut self, i: usize, q: &mut Complex32, sharpness: u32) -> bool {
        let own = i * self.points..(i + 1) * self.points;
        let [re, im] = self.columns.each_ref().map(|plane| &plane[own.clone()]);
        let [field_re, field_im] = self.field.each_ref().map(|plane| &plane[..]);
        let energy = |change: [f64; 2]| {
            let points = re.iter().zip(im).zip(field_re.iter().zip(field_im));
            let each = points.map(|((re, im), (x, y))| {
                let [x, y] = [x + re * change[0] - im * change[1], y + re * change[1] + im * change[0]];
                let mut ratio = self.unit / (x * x + y * y).max(f64::MIN_POSITIVE);
                for _ in 0..sharpness {
                    ratio *= ratio;
                }
                ratio
            });
            each.sum::<f64>()
        };
        let change = |code: Complex32| [f64::from(code.re - q.re), f64::from(code.im - q.im)];
        let mut least = (energy([0.0; 2]), None);
        for &code in self.codes.iter().filter(|code| **code != *q) {
            let found = energy(change(code));
            if found < least.0 * (1.0 - 1e-9) {
                least = (found, Some(code));
            }
        }
        let Some(code) = least.1 else { return false };
        let [a, b] = change(code);
        for j in 0..self.points {
            let [re, im] = [self.columns[0][own.start + j], self.columns[1][own.start + j]];
            self.field[0][j] += re * a - im * b;
            self.field[1][j] += re * b + im * a;
        }
        *q = code;
        true
    }
}

/// Least number of phases for error diffusion. Fewer are too far apart for tangents: it would lose a tenth of the
/// level.
pub(super) const FEWEST: u32 = 8;

/// Rounds `wave` to the board's grid, if it has one and the run was not stopped, and computes its field again. The
/// points stay as even as the grid allows. A field that is not `even` has errors too large for the next transducers to
/// correct: the neighbouring codes are searched, too. After a stop the drive is partly unchanged.
pub(super) fn bring(run: &mut Run, even: bool, wave: &mut Wave<'_>) {
    if let Some(quantization) = run.problem.quantization()
        && !run.stopped
    {
        run.stopped = round(run, quantization, even, wave).is_err();
    }
}

fn round(run: &mut Run, quantization: &Quantization, even: bool, wave: &mut Wave<'_>) -> Result<(), Error> {
    let (problem, rows, work, control) = (run.problem, run.rows, run.work, &mut *run.control);
    let points = rows.order.len();
    if let Some(phases) = &quantization.grid().phases
        && even
        && points > 1
        && quantization.phases() >= Some(FEWEST)
    {
        let mut weights = work.floats.take_any(points);
        for (weight, &j) in weights.iter_mut().zip(&rows.order) {
            *weight = problem.weights()[j as usize];
        }
        let mut memory = work.floats.take_any(floats(points));
        let mut codes = work.floats.take_any(rows.lanes);
        let task = Task {
            tiles: rows.tiles(),
            choice: Choice::even(phases, f32::INFINITY),
            weights: &weights,
            targeted: rows.targeted,
            memory: &mut memory,
        };
        let drive = wave.drive.each_mut().map(|plane| &mut plane[..]);
        let field = wave.field.each_ref().map(|plane| &plane[..points]);
        diffuse(rows.set, task, drive, field, &mut codes, control)?;
        wave.hear(rows);
    } else {
        let mut drive = wave.drives(problem.propagation().transducers(), work);
        if points > 1 {
            refine(problem, &mut drive, work, control);
        } else {
            // A single point is even with any codes.
            quantization.grid().round(rows.set, 1.0, [1.0; 2], &mut drive);
        }
        wave.play(rows, drive.iter().copied());
        work.complexes.give(drive);
    }
    Ok(())
}

/// Full drives (N,), on the board's grid if it has phases, and the status of the search.
pub(crate) struct Answer {
    pub(crate) drive: Vec<Complex32>,
    pub(crate) status: Status,
    /// Steps done, and steps planned.
    pub(crate) steps: (usize, usize),
    /// Whether a level between two amplitudes of the board is a mix of both.
    pub(crate) mixed: bool,
}

impl Answer {
    /// Reduces the drives to the problem's targets if they are louder; `wave` is their field at the rows. Returns the
    /// solution.
    ///
    /// # Errors
    /// More memory than allowed is needed.
    pub(crate) fn brought_down(
        self,
        problem: &Problem,
        rows: &Rows,
        wave: &Wave,
        work: &Workspace,
        control: &mut Control,
    ) -> Result<Solution, Error> {
        let Self { mut drive, status, steps: (step, steps), mixed } = self;
        let quantization = problem.quantization();
        let loudest = wave.moduli[..rows.targeted].iter().copied().fold(0.0, f32::max);
        let lower = problem.aim() == Aim::Target && loudest > rows.target;
        let factor = if lower { f64::from(rows.target / loudest) } else { 1.0 };
        let on_grid =
            status != Status::Stopped && quantization.is_some_and(|quantization| quantization.phases().is_some());
        // True if the rows are those of all points of the problem, in its units.
        let known = rows.order.len() == problem.propagation().points();
        if mixed && lower {
            let field = known.then(|| wave.received(problem, rows, 1.0, work));
            if let Some(mut solution) =
                Solution::mixed(problem, &mut drive, (factor, field), (status, step), work, control)
            {
                solution.tell(problem, steps, control);
                return Ok(if on_grid { solution.on_grid() } else { solution });
            }
        }
        let (amplitude, scale) = quantization.map_or((factor, 1.0), |quantization| quantization.lowered(factor));
        for q in &mut drive {
            *q *= amplitude as f32;
        }
        let solution = if known {
            let field = wave.received(problem, rows, amplitude as f32, work);
            Solution::of_field(problem, drive, &field, status, step, work, control)?
        } else {
            Solution::new(problem, drive, (status, step), steps, work, control)?
        };
        let mut solution = solution.scaled(scale);
        if on_grid {
            solution = solution.on_grid();
        }
        solution.tell(problem, steps, control);
        Ok(solution)
    }
}
