//! Least squares of eq. (7) over all phases, by descent.
//!
//! ```text
//! powers first    1/4 sum_j w_j (|P_j|^2 - t_j^2)^2                P = G q, |q_i| = 1
//! then moduli     1/2 sum_j w_j (a |P_j| - t_j)^2                  a <= 1 the common amplitude of least error
//! dE/dphi_i = Im(conj(q_i) sum_j conj(G_ji) dE/d|P_j| P_j/|P_j|)
//! ```
//!
//! A step costs two products with G, however many points there are, and curvature is learnt from the last steps
//! ([`crate::solvers::common::quasi_newton`]). Each drive rotates by the arc tangent of what a step asks for. The moduli
//! have a kink at every zero of the field, where descent is caught; the powers are smooth: a picture of 961 points ends at
//! a third to nine tenths of the error that moduli alone end at. The first starts are those of a focus whose cone covers the
//! points ([`crate::solvers::common::cover`]), whose fields have no zeros near the picture.

use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::kernels::tiles;
use crate::math;
use crate::problem::{Problem, Status};
use crate::rng::Rng;
use crate::solvers::common::alternating_projection::Projector;
use crate::solvers::common::cover::{Side, cover};
use crate::solvers::common::quasi_newton::{QuasiNewton, dot};
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::{Buffer, Workspace};

/// How much work to spend.
pub(crate) struct Task {
    /// Steps of the best start, at most.
    pub(crate) steps: usize,
    /// Ends when ten steps lower the error by less than this part of it.
    pub(crate) tolerance: f64,
    /// Starts, each followed for a fifth of the steps.
    pub(crate) starts: usize,
    pub(crate) seed: u64,
    /// What the targets are multiplied by.
    pub(crate) factor: f32,
    /// Steps done before.
    pub(crate) before: usize,
}

/// What was found: the drive, how it ended, and steps taken of all.
pub(crate) struct Found {
    pub(crate) drive: Vec<Complex32>,
    pub(crate) status: Status,
    pub(crate) steps: (usize, usize),
}

/// One of so many steps lowers the error of the powers.
const POWER_STEPS: usize = 5;

/// Steps over which progress is measured.
const SPAN: usize = 10;

/// The error at which a target counts as met: f32 has no digits below.
const LEAST_ERROR: f64 = 1e-6;

/// The part of the predicted decrease that a step must bring.
const ENOUGH: f64 = 1e-4;

/// Trials of a step, each at most half as long as the last.
const TRIALS: usize = 12;

/// The largest rotation of a first step, in rad.
const FIRST: f32 = 0.3;

/// The largest rotation asked of any step: its arc tangent is less than a quarter turn.
const LONGEST: f32 = 2.0;

/// The drive of least squares that some starts lead to.
///
/// # Errors
/// More memory than allowed.
pub(crate) fn least_squares(
    problem: &Problem,
    task: &Task,
    work: &Workspace,
    control: &mut Control,
) -> Result<Found, Error> {
    let rows = Rows::new(problem, work, control)?;
    let mut targets = work.floats.take(rows.order.len());
    targets.iter_mut().zip(problem.targets()).for_each(|(own, target)| *own = task.factor * target);
    let asked = Asked { targets: &targets, weights: problem.weights() };
    let others = if problem.has_start() { 0 } else { task.starts - 1 };
    let short = task.steps.div_ceil(POWER_STEPS);
    let (mut done, all) = (task.before, task.before + task.steps + others * short);
    let mut rng = Rng::new(task.seed);
    let mut follow = |run: &mut Run, most: usize, control: &mut Control| {
        run.descend(asked, &rows, most, task.tolerance, |run| {
            // A step is reported when the next one begins: the last one's residual is that of the answer.
            let stop =
                done > task.before && control.step(done, all, || problem.residual(&run.heard(task.factor))).is_break();
            done += usize::from(!stop);
            stop
        })
    };
    let mut smooth = [Side::Behind, Side::Front].into_iter().filter_map(|side| cover(problem, side, work));
    let mut best: Option<Run> = None;
    let mut status = Status::OutOfSteps;
    for start in 0..=others {
        let smooth = if problem.has_start() { None } else { smooth.next() };
        let wave = match smooth {
            Some(drive) => played(drive, &rows, work),
            None if start == 0 => begun(problem, &rows, work, control)?,
            None => reflected(asked, &mut rng, &rows, work),
        };
        let mut run = Run::new(wave, asked, &rows, work);
        status = follow(&mut run, short, control);
        run.measure(asked, &rows, Measure::Moduli);
        if best.as_ref().is_none_or(|best| run.cost < best.cost) {
            best = Some(run);
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
    for q in &mut drive {
        *q *= best.amplitude;
    }
    drop(best);
    Ok(Found { drive, status, steps: (done, all) })
}

/// Targets and weights of the rows.
#[derive(Clone, Copy)]
struct Asked<'a> {
    targets: &'a [f32],
    weights: &'a [f32],
}

impl Asked<'_> {
    /// |P|, target and weight of every row.
    fn terms(self, moduli: &[f32]) -> impl Iterator<Item = [f64; 3]> {
        let asked = self.targets.iter().zip(self.weights);
        moduli.iter().zip(asked).map(|(&m, (&t, &w))| [m, t, w].map(f64::from))
    }
}

/// What the error is made of.
#[derive(Clone, Copy, PartialEq)]
enum Measure {
    Powers,
    Moduli,
}

/// A descent under way.
struct Run<'w> {
    measure: Measure,
    wave: Wave<'w>,
    trial: Wave<'w>,
    amplitude: f32,
    cost: f64,
    gradient: Buffer<'w, f32>,
    newton: QuasiNewton<'w>,
    /// dE/d|P_j| times P_j/|P_j| over the rows.
    pulls: [Buffer<'w, f32>; 2],
    sums: [Buffer<'w, f32>; 2],
}

impl<'w> Run<'w> {
    fn new(wave: Wave<'w>, asked: Asked, rows: &Rows, work: &'w Workspace) -> Self {
        let mut run = Self {
            measure: Measure::Powers,
            trial: Wave::new(rows, work),
            wave,
            amplitude: 1.0,
            cost: 0.0,
            gradient: work.floats.take(rows.lanes),
            newton: QuasiNewton::new(work),
            pulls: [(); 2].map(|()| work.floats.take(rows.count)),
            sums: [(); 2].map(|()| work.floats.take_any(rows.lanes)),
        };
        run.measure(asked, rows, Measure::Powers);
        run
    }

    /// From now on by another measure.
    fn measure(&mut self, asked: Asked, rows: &Rows, measure: Measure) {
        self.measure = measure;
        self.newton.forget();
        (self.cost, self.amplitude) = cost(asked, measure, &self.wave);
        self.slope(asked, rows);
    }

    /// |P| of the answer as it is, for the problem's own targets.
    fn heard(&self, factor: f32) -> Vec<f32> {
        self.wave.moduli.iter().map(|modulus| modulus * self.amplitude / factor).collect()
    }

    /// Writes the gradient at the wave.
    fn slope(&mut self, asked: Asked, rows: &Rows) {
        for (j, (&target, &weight)) in asked.targets.iter().zip(asked.weights).enumerate() {
            let modulus = self.wave.moduli[j];
            let pull = weight
                * match self.measure {
                    Measure::Powers => modulus * modulus - target * target,
                    Measure::Moduli => self.amplitude * (self.amplitude - target / modulus.max(f32::MIN_POSITIVE)),
                };
            for (pulls, field) in self.pulls.iter_mut().zip(&self.wave.field) {
                pulls[j] = pull * field[j];
            }
        }
        let ([re, im], [sum_re, sum_im]) = (&self.pulls, &mut self.sums);
        tiles::correlate(rows.set, rows.tiles(), [re, im], [&mut *sum_re, &mut *sum_im]);
        let [qr, qi] = &self.wave.drive;
        for (i, gradient) in self.gradient.iter_mut().enumerate() {
            *gradient = qr[i] * sum_im[i] - qi[i] * sum_re[i];
        }
    }

    /// Steps until little is gained, `stop`, which is asked before each, says so, or they are `most`.
    fn descend(
        &mut self,
        asked: Asked,
        rows: &Rows,
        most: usize,
        tolerance: f64,
        mut stop: impl FnMut(&Self) -> bool,
    ) -> Status {
        let silence = asked.terms(&self.wave.moduli).map(|[_, t, w]| 0.5 * w * t * t).sum::<f64>();
        let mut before = self.cost;
        for step in 0..most {
            if step > 0 && step.is_multiple_of(SPAN) {
                if math::sqrt(self.cost) > (1.0 - tolerance) * math::sqrt(before) {
                    return Status::Done;
                }
                before = self.cost;
            }
            let met = self.measure == Measure::Moduli && self.cost <= LEAST_ERROR * LEAST_ERROR * silence;
            if met {
                return Status::Done;
            }
            if stop(self) {
                return Status::Stopped;
            }
            if !self.step(asked, rows) {
                return Status::Done;
            }
        }
        Status::OutOfSteps
    }

    /// One step; whether there was one that lowers the error.
    fn step(&mut self, asked: Asked, rows: &Rows) -> bool {
        loop {
            let work = self.newton.work;
            let [mut direction, mut change] = [(); 2].map(|()| work.floats.take_any(rows.lanes));
            direction.copy_from_slice(&self.gradient);
            self.newton.descend(&mut direction);
            let longest = direction.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
            let slope = dot(&direction, &self.gradient);
            if longest > 0.0 && slope < 0.0 {
                let limit = if self.newton.knows_nothing() { FIRST / longest } else { (LONGEST / longest).min(1.0) };
                let mut part = limit;
                for _ in 0..TRIALS {
                    self.trial.rotate(rows, &self.wave, &direction, part);
                    let (trial, amplitude) = cost(asked, self.measure, &self.trial);
                    if trial <= self.cost + ENOUGH * f64::from(part) * slope {
                        core::mem::swap(&mut self.wave, &mut self.trial);
                        (self.cost, self.amplitude) = (trial, amplitude);
                        change.copy_from_slice(&self.gradient);
                        self.slope(asked, rows);
                        for (change, gradient) in change.iter_mut().zip(&self.gradient) {
                            *change = gradient - *change;
                        }
                        direction.iter_mut().for_each(|x| *x = libm::atanf(part * *x));
                        self.newton.remember(&direction, &change);
                        return true;
                    }
                    // The least of the parabola through both costs and the slope.
                    let bend = trial - self.cost - f64::from(part) * slope;
                    let least = -0.5 * f64::from(part) * slope / bend;
                    part *= if bend > 0.0 { (least as f32).clamp(0.1, 0.5) } else { 0.5 };
                }
            }
            // What was learnt leads nowhere: once more along the gradient alone.
            if !self.newton.forget() {
                return false;
            }
        }
    }
}

/// The wave of the problem's start, else of q = 1, at full drive.
fn begun<'w>(problem: &Problem, rows: &Rows, work: &'w Workspace, control: &mut Control) -> Result<Wave<'w>, Error> {
    let start = Projector::new(rows, work).begin(problem, rows, work, control)?;
    let drive = start.drives(problem.propagation().transducers(), work);
    Ok(played(drive, rows, work))
}

/// The wave of a drive at full drive, 1 where it is 0.
fn played<'w>(drive: Vec<Complex32>, rows: &Rows, work: &'w Workspace) -> Wave<'w> {
    let full = |q: &Complex32| if *q == Complex32::ZERO { Complex32::ONE } else { *q };
    let mut wave = Wave::new(rows, work);
    wave.play_at_full(rows, drive.iter().map(full));
    work.complexes.give(drive);
    wave
}

/// The wave that targets of random phases reflect.
fn reflected<'w>(asked: Asked, rng: &mut Rng, rows: &Rows, work: &'w Workspace) -> Wave<'w> {
    let mut projector = Projector::new(rows, work);
    for (j, target) in asked.targets.iter().enumerate() {
        let (angle, modulus) = (TAU * rng.uniform(), target / rows.target);
        projector.wanted[0][j] = modulus * math::cos(angle) as f32;
        projector.wanted[1][j] = modulus * math::sin(angle) as f32;
    }
    let mut wave = Wave::new(rows, work);
    projector.project(rows, &mut wave);
    wave
}

/// E of a wave, and the common amplitude.
fn cost(asked: Asked, measure: Measure, wave: &Wave) -> (f64, f32) {
    let terms = || asked.terms(&wave.moduli);
    if measure == Measure::Powers {
        return (terms().map(|[m, t, w]| 0.25 * w * (m * m - t * t) * (m * m - t * t)).sum(), 1.0);
    }
    let (product, square) = terms().fold((0.0, 0.0), |(p, s), [m, t, w]| (p + w * m * t, s + w * m * m));
    let amplitude = if product < square { (product / square) as f32 } else { 1.0 };
    let miss = |m: f64, t: f64| f64::from(amplitude) * m - t;
    (terms().map(|[m, t, w]| 0.5 * w * miss(m, t) * miss(m, t)).sum(), amplitude)
}
