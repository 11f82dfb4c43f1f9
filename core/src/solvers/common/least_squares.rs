//! Least squares of eq. (7) over all phases, by descent.
//!
//! ```text
//! 1/2 sum_j w_j (a |P_j| - t_j)^2          P = G q, |q_i| = 1; weights w, targets t; a <= 1 the amplitude of least error
//! ```
//!
//! The steps are those of [`crate::solvers::common::phase_descent`]. The moduli have a kink at every zero of the field,
//! where descent gets stuck. The first starts have a focus whose cone covers the points
//! ([`crate::solvers::common::cover`]): their fields have no zeros near the picture.
//!
//! Below the balanced level amplitudes are free as well ([`with_amplitudes`]). They start from the drive of the
//! balanced level, with reduced amplitude, and meet the targets that phases alone miss.

use crate::solvers::common::alternating_projection::Projector;
use crate::solvers::common::cover::{Side, cover};
use crate::solvers::common::phase_descent::{Cost, PhaseDescent};
use crate::solvers::prelude::*;

/// Limits of the search.
#[derive(Clone, Copy)]
pub(crate) struct Task {
    /// Largest number of steps of the best start.
    pub(crate) steps: usize,
    /// The search ends when ten steps lower the error by less than this part of it.
    pub(crate) tolerance: f64,
    /// Number of starts; each is followed for a fifth of the steps.
    pub(crate) starts: usize,
    pub(crate) seed: u64,
    /// Factor of the targets.
    pub(crate) factor: f32,
    /// Number of steps that the solve has done before this search.
    pub(crate) before: usize,
}

/// The result: the drive, its status, the number of steps taken, and of all steps planned.
pub(crate) struct LeastSquares {
    pub(crate) drive: Vec<Complex32>,
    pub(crate) status: Status,
    pub(crate) steps: (usize, usize),
}

/// Returns the largest number of steps by phases and amplitudes. With fewer points a step is faster, and the last
/// digits need more steps.
fn free_steps(points: usize) -> usize {
    (MOST_FREE_WORK / points.max(1)).clamp(LEAST_FREE, MOST_FREE)
}

/// Largest product of points and steps: some .3 s with 996 transducers.
const MOST_FREE_WORK: usize = 300_000;
/// The least and the largest number of steps by phases and amplitudes.
const LEAST_FREE: usize = 300;
const MOST_FREE: usize = 1500;

/// Steps by phases and amplitudes end when ten of them lower the error by less than this part of it.
const FREE_TOLERANCE: f64 = 3e-4;

/// Divisor of the number of steps: a fifth of them is done from each start, the others from the best one.
const SHORT: usize = 5;

/// Number of steps over which progress is measured.
const SPAN: usize = 10;

/// Error below which a target counts as met: smaller errors are rounding errors of f32.
const LEAST_ERROR: f64 = 1e-6;

/// Returns the drive of the least squares that descents from several starts reach.
///
/// # Errors
/// More memory than allowed is needed.
pub(crate) fn least_squares(
    problem: &Problem,
    task: &Task,
    work: &Workspace,
    control: &mut Control,
) -> Result<LeastSquares> {
    let rows = Rows::new(problem, work, control)?;
    let mut targets = work.floats.take(rows.order.len());
    targets.iter_mut().zip(problem.targets()).for_each(|(own, target)| *own = task.factor * target);
    let requested = RowRequest { targets: &targets, weights: problem.weights() };
    let others = if problem.has_start() { 0 } else { task.starts - 1 };
    let short = task.steps.div_ceil(SHORT);
    let (mut done, all) = (task.before, task.before + task.steps + others * short);
    let mut rng = Rng::new(task.seed);
    let mut follow = |descent: &mut PhaseDescent, most: usize, control: &mut Control| {
        descend(descent, requested, &rows, (most, task.tolerance), |wave| {
            // A step is reported when the next step begins. The residual of the last step is reported with the
            // solution.
            let residual = || problem.residual(&requested.received(wave, task.factor));
            let stop = done > task.before && control.step(done, all, residual).is_break();
            done += usize::from(!stop);
            stop
        })
    };
    let mut smooth = [Side::Behind, Side::Front].into_iter().filter_map(|side| cover(problem, side, work));
    let mut best: Option<PhaseDescent> = None;
    let mut status = Status::OutOfSteps;
    for start in 0..=others {
        let smooth = if problem.has_start() { None } else { smooth.next() };
        let wave = match smooth {
            Some(drive) => played(drive, &rows, work),
            None if start == 0 => begun(problem, &rows, work, control)?,
            None => reflected(requested, &mut rng, &rows, work),
        };
        let mut descent = PhaseDescent::new(wave, &requested, &rows, work);
        status = follow(&mut descent, short, control);
        if best.as_ref().is_none_or(|best| descent.cost < best.cost) {
            best = Some(descent);
        }
        if status == Status::Stopped {
            break;
        }
    }
    let mut best = best.expect("there is at least one start");
    if status != Status::Stopped {
        status = follow(&mut best, task.steps - short, control);
    }
    let mut drive = best.wave.drives(problem.propagation().transducers(), work);
    let amplitude = requested.amplitude(&best.wave.moduli);
    for q in &mut drive {
        *q *= amplitude;
    }
    drop(best);
    Ok(LeastSquares { drive, status, steps: (done, all) })
}

/// Returns the drive of the least squares that phases and amplitudes reach from a `drive` near the targets. It is no
/// worse than that drive.
///
/// # Errors
/// More memory than allowed is needed.
pub(crate) fn with_amplitudes(
    problem: &Problem,
    drive: &[Complex32],
    before: (usize, usize),
    work: &Workspace,
    control: &mut Control,
) -> Result<LeastSquares> {
    let rows = Rows::new(problem, work, control)?;
    let targets = &problem.targets()[..rows.order.len()];
    let request = RowRequest { targets, weights: problem.weights() };
    let mut wave = Wave::new(&rows, work);
    wave.play(&rows, drive.iter().copied());
    let begun = request.of(&wave);
    let mut descent = PhaseDescent::with_amplitudes(wave, &request, &rows, work);
    let most = free_steps(rows.order.len());
    let (mut done, all) = (before.0, before.1.max(before.0) + most);
    let status = descend(&mut descent, request, &rows, (most, FREE_TOLERANCE), |wave| {
        let stop =
            done > before.0 && control.step(done, all, || problem.residual(&request.received(wave, 1.0))).is_break();
        done += usize::from(!stop);
        stop
    });
    let mut out = descent.wave.drives(problem.propagation().transducers(), work);
    let amplitude = request.amplitude(&descent.wave.moduli);
    if descent.cost < begun {
        for q in &mut out {
            *q *= amplitude;
        }
    } else {
        out.copy_from_slice(drive);
    }
    Ok(LeastSquares { drive: out, status, steps: (done, all) })
}

/// Targets and weights of the rows.
#[derive(Clone, Copy)]
struct RowRequest<'a> {
    targets: &'a [f32],
    weights: &'a [f32],
}

impl RowRequest<'_> {
    /// Returns |P|, target and weight of every row.
    fn terms(self, moduli: &[f32]) -> impl Iterator<Item = [f64; 3]> {
        let requested = self.targets.iter().zip(self.weights);
        moduli.iter().zip(requested).map(|(&m, (&t, &w))| [m, t, w].map(f64::from))
    }

    /// Returns the common amplitude a of the least error.
    fn amplitude(self, moduli: &[f32]) -> f32 {
        let (product, square) = self.terms(moduli).fold((0.0, 0.0), |(p, s), [m, t, w]| (p + w * m * t, s + w * m * m));
        if product < square { (product / square) as f32 } else { 1.0 }
    }

    /// Returns |P| at the common amplitude, in the unit of the problem's own targets.
    fn received(self, wave: &Wave, factor: f32) -> Vec<f32> {
        let amplitude = self.amplitude(&wave.moduli);
        wave.moduli.iter().map(|modulus| modulus * amplitude / factor).collect()
    }
}

impl Cost for RowRequest<'_> {
    fn of(&self, wave: &Wave) -> f64 {
        let amplitude = f64::from(self.amplitude(&wave.moduli));
        let miss = |m: f64, t: f64| amplitude * m - t;
        self.terms(&wave.moduli).map(|[m, t, w]| 0.5 * w * miss(m, t) * miss(m, t)).sum()
    }

    fn pull(&self, wave: &Wave, mut pulls: [&mut [f32]; 2]) {
        let amplitude = self.amplitude(&wave.moduli);
        for (j, (&target, &weight)) in self.targets.iter().zip(self.weights).enumerate() {
            let pull = weight * amplitude * (amplitude - target / wave.moduli[j].max(f32::MIN_POSITIVE));
            for (pulls, field) in pulls.iter_mut().zip(&wave.field) {
                pulls[j] = pull * field[j];
            }
        }
    }
}

/// Takes steps until ten of them gain too little, `stop` returns true or `most` are done. `stop` is called before each
/// step.
fn descend(
    descent: &mut PhaseDescent,
    requested: RowRequest,
    rows: &Rows,
    (most, tolerance): (usize, f64),
    mut stop: impl FnMut(&Wave) -> bool,
) -> Status {
    let silence = requested.terms(&descent.wave.moduli).map(|[_, t, w]| 0.5 * w * t * t).sum::<f64>();
    let mut before = descent.cost;
    for step in 0..most {
        if step > 0 && step.is_multiple_of(SPAN) {
            if math::sqrt(descent.cost) > (1.0 - tolerance) * math::sqrt(before) {
                return Status::Done;
            }
            before = descent.cost;
        }
        if descent.cost <= LEAST_ERROR * LEAST_ERROR * silence {
            return Status::Done;
        }
        if stop(&descent.wave) {
            return Status::Stopped;
        }
        if !descent.step(&requested, rows) {
            return Status::Done;
        }
    }
    Status::OutOfSteps
}

/// Returns the wave of the problem's start, or of q = 1, at full drive.
fn begun<'w>(problem: &Problem, rows: &Rows, work: &'w Workspace, control: &mut Control) -> Result<Wave<'w>> {
    let start = Projector::new(rows, work).begin(problem, rows, work, control)?;
    let drive = start.drives(problem.propagation().transducers(), work);
    Ok(played(drive, rows, work))
}

/// Returns the wave of a drive at full drive; drives of 0 become 1.
fn played<'w>(drive: Vec<Complex32>, rows: &Rows, work: &'w Workspace) -> Wave<'w> {
    let full = |q: &Complex32| if *q == Complex32::ZERO { Complex32::ONE } else { *q };
    let mut wave = Wave::new(rows, work);
    wave.play_at_full(rows, drive.iter().map(full));
    work.complexes.give(drive);
    wave
}

/// Returns the projection of the targets with random phases.
fn reflected<'w>(requested: RowRequest, rng: &mut Rng, rows: &Rows, work: &'w Workspace) -> Wave<'w> {
    let mut projector = Projector::new(rows, work);
    for (j, target) in requested.targets.iter().enumerate() {
        let (angle, modulus) = (TAU * rng.uniform(), target / rows.target);
        projector.wanted[0][j] = modulus * math::cos(angle) as f32;
        projector.wanted[1][j] = modulus * math::sin(angle) as f32;
    }
    let mut wave = Wave::new(rows, work);
    projector.project(rows, &mut wave);
    wave
}
