//! Levenberg-Marquardt on the phases: Madsen, Nielsen and Tingleff, "Methods for non-linear least squares
//! problems", 2004, algorithm 3.16, as the paper applies it.
//!
//! Unknown are the phases phi_i of the transducers, |q_i| = 1, and theta_j of the points; the residuals are
//! r_j = sqrt(w_j) (P_j - t_j e^{j theta_j}), complex. A step solves (J^T J + mu I) d = -J^T r in the dual,
//! d = -J^T (J J^T + mu I)^-1 r, of 2M real rows whatever N is.

use num_complex::Complex32;

use crate::control::Control;
use crate::error::{Error, real};
use crate::kernels;
use crate::linalg::{Cholesky, Planar};
use crate::math;
use crate::math::{sqrt, sqrtf};
use crate::problem::Problem;
use crate::problem::solution::{Solution, Status};
use crate::rng::Rng;
use crate::solvers::common::alternating_projection::start_phasors;
use crate::solvers::method::{Info, Method, Solve, check_iteration};
use crate::workspace::Workspace;

use alloc::vec::Vec;

crate::options! {
    /// Levenberg-Marquardt, |q| = 1. Time O(N M^2 + M^3) a step, memory O(N M + M^2).
    pub struct Lm {
        /// Steps at most.
        pub steps: u32 = 200,
        /// First damping relative to the largest diagonal entry of J^T J, above 0.
        pub tau: f64 = 1e-3,
        /// Ends when the gradient or, relative to the phases, the step is smaller.
        pub eps: f64 = 1e-8,
        /// Seed of the phases it starts from, 0 to 2^64 - 1.
        pub seed: u64 = 0,
    }
}

impl Method for Lm {
    const INFO: Info = Info {
        name: "lm",
        summary: "Levenberg-Marquardt on all phases, |q| = 1",
        source: "Madsen et al. 2004, algorithm 3.16; Suzuki et al. 2021",
        balance: false,
        tolerance: 0.02,
        uses_start: true,
        uses_aim: false,
    };

    fn check(&self) -> Result<(), Error> {
        check_iteration(self.steps, 0.0)?;
        real("eps", self.eps, 0.0, false)?;
        real("tau", self.tau, 0.0, true).map(|_| ())
    }
}

impl Solve for Lm {
    fn solve(
        &self,
        problem: &Problem,
        work: &mut Workspace,
        control: &mut Control,
    ) -> Result<Solution, Error> {
        let mut state = State::new(problem, self.seed, work);
        let mut trial = State::copy(&state, work);
        let mut normal = Normal::new(problem, work);
        let steps = self.steps as usize;
        let (mut status, mut step) = (Status::OutOfSteps, 0);
        let (mut damping, mut growth) = (0.0, 2.0);
        let mut moved = true;
        while step < steps {
            if moved {
                normal.update(problem, &state);
                if step == 0 {
                    damping = self.tau * normal.largest;
                }
                if normal.steepest <= self.eps {
                    status = Status::Done;
                    break;
                }
                moved = false;
            }
            step += 1;
            let finished = match normal.step(problem, &state, damping, &mut trial, work) {
                Some((length, _)) if length <= self.eps * (state.length() + self.eps) => true,
                Some((_, predicted)) => {
                    trial.refresh(problem, &normal.propagation);
                    let ratio = (state.cost - trial.cost) / predicted;
                    moved = ratio > 0.0;
                    if moved {
                        core::mem::swap(&mut state, &mut trial);
                        let trust = 2.0 * ratio - 1.0;
                        damping *= (1.0 - trust * trust * trust).max(1.0 / 3.0);
                        growth = 2.0;
                    } else {
                        damping *= growth;
                        growth *= 2.0;
                    }
                    // Past all f32: nothing can improve any more.
                    damping > 1e30
                }
                // Not positive definite in f32: more damping makes it so.
                None => {
                    damping *= growth;
                    growth *= 2.0;
                    false
                }
            };
            if control.step(step, steps, || problem.residual(&state.modulus)).is_break() {
                status = Status::Stopped;
                break;
            }
            if finished {
                status = Status::Done;
                break;
            }
        }
        let mut drive = work.complexes.take(problem.propagation().transducers());
        drive.copy_from_slice(&state.drive);
        for (i, q) in drive.iter_mut().enumerate() {
            if normal.propagation.row(i).iter().all(|part| part.iter().all(|&x| x == 0.0)) {
                *q = Complex32::ZERO;
            }
        }
        normal.give(work);
        state.give(work);
        trial.give(work);
        Ok(Solution::new(problem, drive, status, step, work))
    }
}

/// A set of phases and what follows from it.
struct State {
    phi: Vec<f32>,
    theta: Vec<f32>,
    drive: Vec<Complex32>,
    field: Planar,
    modulus: Vec<f32>,
    /// e^{j theta}.
    phasor: Planar,
    /// sqrt(w) (P - t e^{j theta}).
    residual: Planar,
    cost: f64,
}

impl State {
    fn new(problem: &Problem, seed: u64, work: &mut Workspace) -> Self {
        let propagation = problem.propagation();
        let mut state = Self {
            phi: work.floats.take(propagation.transducers()),
            theta: work.floats.take(propagation.lanes()),
            drive: work.complexes.take(propagation.transducers()),
            field: Planar::zeros(1, propagation.lanes(), work),
            modulus: work.floats.take(propagation.lanes()),
            phasor: Planar::zeros(1, propagation.lanes(), work),
            residual: Planar::zeros(1, propagation.lanes(), work),
            cost: 0.0,
        };
        let mut rng = Rng::new(seed);
        let mut random = || (core::f64::consts::TAU * rng.uniform()) as f32;
        state.phi.fill_with(&mut random);
        state.theta[..propagation.points()].fill_with(&mut random);
        let angle = |re: f32, im: f32| math::atan2(f64::from(im), f64::from(re)) as f32;
        let given = problem.start_drive().is_some() || problem.start_phases().is_some();
        let rows = Planar::stored(propagation, work);
        if given {
            let phasors = start_phasors(problem, work);
            for j in 0..propagation.points() {
                state.theta[j] = angle(phasors.re[j], phasors.im[j]);
            }
            for i in 0..propagation.transducers() {
                let [re, im] = match problem.start_drive() {
                    Some(drive) => [drive[i].re, drive[i].im],
                    None => kernels::correlate(propagation.instruction_set(), rows.row(i), phasors.row(0)),
                };
                state.phi[i] = angle(re, im);
            }
            phasors.give(work);
        }
        state.refresh(problem, &rows);
        rows.give(work);
        state
    }

    fn copy(other: &Self, work: &mut Workspace) -> Self {
        let lanes = other.theta.len();
        Self {
            phi: work.floats.take(other.phi.len()),
            theta: work.floats.take(lanes),
            drive: work.complexes.take(other.drive.len()),
            field: Planar::zeros(1, lanes, work),
            modulus: work.floats.take(lanes),
            phasor: Planar::zeros(1, lanes, work),
            residual: Planar::zeros(1, lanes, work),
            cost: 0.0,
        }
    }

    /// Everything that follows from the phases.
    fn refresh(&mut self, problem: &Problem, propagation: &Planar) {
        let cis = |angle: f32| {
            let angle = f64::from(angle);
            (math::cos(angle) as f32, math::sin(angle) as f32)
        };
        for (q, &phi) in self.drive.iter_mut().zip(&self.phi) {
            let (re, im) = cis(phi);
            *q = Complex32::new(re, im);
        }
        let set = problem.propagation().instruction_set();
        let Planar { re, im, .. } = &mut self.field;
        kernels::combine_rows(set, [&propagation.re, &propagation.im], &self.drive, [re, im]);
        kernels::modulus(set, &self.field.re, &self.field.im, &mut self.modulus);
        self.cost = 0.0;
        for j in 0..problem.propagation().points() {
            let (re, im) = cis(self.theta[j]);
            (self.phasor.re[j], self.phasor.im[j]) = (re, im);
            let (target, root) = (problem.targets()[j], sqrtf(problem.weights()[j]));
            self.residual.re[j] = root * (self.field.re[j] - target * re);
            self.residual.im[j] = root * (self.field.im[j] - target * im);
            let (re, im) = (f64::from(self.residual.re[j]), f64::from(self.residual.im[j]));
            self.cost += 0.5 * (re * re + im * im);
        }
    }

    /// The norm of all phases.
    fn length(&self) -> f64 {
        sqrt(self.phi.iter().chain(&self.theta).map(|&x| f64::from(x) * f64::from(x)).sum())
    }

    fn give(self, work: &mut Workspace) {
        work.floats.give_all([self.phi, self.theta, self.modulus]);
        work.complexes.give(self.drive);
        for planar in [self.field, self.phasor, self.residual] {
            planar.give(work);
        }
    }
}

/// The dual normal equations at a state.
struct Normal {
    propagation: Planar,
    /// J J^T, of 2 lanes: real parts, then imaginary ones.
    matrix: Vec<f32>,
    /// Four rows of J's transducer columns at a time.
    columns: [Vec<f32>; 4],
    gradient: Vec<f32>,
    point_gradient: Vec<f32>,
    /// Largest |gradient|.
    steepest: f64,
    /// Largest diagonal entry of J^T J.
    largest: f64,
}

impl Normal {
    fn new(problem: &Problem, work: &mut Workspace) -> Self {
        let propagation = problem.propagation();
        let size = 2 * propagation.lanes();
        Self {
            propagation: Planar::stored(propagation, work),
            matrix: work.floats.take(size * size),
            columns: [(); 4].map(|()| work.floats.take(size)),
            gradient: work.floats.take(propagation.transducers()),
            point_gradient: work.floats.take(propagation.lanes()),
            steepest: 0.0,
            largest: 0.0,
        }
    }

    fn update(&mut self, problem: &Problem, state: &State) {
        let propagation = problem.propagation();
        let (lanes, count) = (propagation.lanes(), propagation.points());
        let size = 2 * lanes;
        self.matrix.fill(0.0);
        (self.steepest, self.largest) = (0.0, 0.0);
        for first in (0..propagation.transducers()).step_by(4) {
            for (b, column) in self.columns.iter_mut().enumerate() {
                column.fill(0.0);
                let i = first + b;
                if i >= propagation.transducers() {
                    continue;
                }
                // d r_j / d phi_i = j sqrt(w_j) G_ji q_i.
                let ([re, im], q) = (self.propagation.row(i), state.drive[i]);
                let (mut slope, mut square) = (0.0, 0.0);
                for j in 0..count {
                    let root = sqrtf(problem.weights()[j]);
                    column[j] = -root * (re[j] * q.im + im[j] * q.re);
                    column[lanes + j] = root * (re[j] * q.re - im[j] * q.im);
                    slope += column[j] * state.residual.re[j] + column[lanes + j] * state.residual.im[j];
                    square += column[j] * column[j] + column[lanes + j] * column[lanes + j];
                }
                self.gradient[i] = slope;
                self.steepest = self.steepest.max(f64::from(slope.abs()));
                self.largest = self.largest.max(f64::from(square));
            }
            kernels::add_outer(
                problem.propagation().instruction_set(),
                self.columns.each_ref().map(Vec::as_slice),
                &mut self.matrix,
            );
        }
        for j in 0..count {
            // d r_j / d theta_j = -j sqrt(w_j) t_j e^{j theta_j}.
            let pull = sqrtf(problem.weights()[j]) * problem.targets()[j];
            let (re, im) = (pull * state.phasor.im[j], -pull * state.phasor.re[j]);
            self.matrix[j * size + j] += re * re;
            self.matrix[j * size + lanes + j] += re * im;
            self.matrix[(lanes + j) * size + lanes + j] += im * im;
            let slope = re * state.residual.re[j] + im * state.residual.im[j];
            self.point_gradient[j] = slope;
            self.steepest = self.steepest.max(f64::from(slope.abs()));
            self.largest = self.largest.max(f64::from(pull * pull));
        }
    }

    /// Writes the phases after a step of the given damping into `trial`; the step's norm and the decrease that the
    /// linear model predicts. `None` if f32 cannot factor the matrix.
    fn step(
        &self,
        problem: &Problem,
        state: &State,
        damping: f64,
        trial: &mut State,
        work: &mut Workspace,
    ) -> Option<(f64, f64)> {
        let propagation = problem.propagation();
        let (lanes, count) = (propagation.lanes(), propagation.points());
        let size = 2 * lanes;
        let mut matrix = work.floats.take(size * size);
        matrix.copy_from_slice(&self.matrix);
        for k in 0..size {
            matrix[k * size + k] += damping as f32;
        }
        let cholesky = Cholesky::new(propagation.instruction_set(), matrix, size, work)?;
        let mut both = work.floats.take(size);
        both[..lanes].copy_from_slice(&state.residual.re);
        both[lanes..].copy_from_slice(&state.residual.im);
        cholesky.solve(&mut both);
        cholesky.give(work);
        let mut dual = Planar::zeros(1, lanes, work);
        for j in 0..count {
            let root = sqrtf(problem.weights()[j]);
            (dual.re[j], dual.im[j]) = (root * both[j], root * both[lanes + j]);
        }
        let (mut square, mut predicted) = (0.0, 0.0);
        let mut took = |d: f32, slope: f32| {
            let (d, slope) = (f64::from(d), f64::from(slope));
            square += d * d;
            predicted += 0.5 * d * (damping * d - slope);
        };
        kernels::correlate_rows(
            propagation.instruction_set(),
            [&self.propagation.re, &self.propagation.im],
            dual.row(0),
            |i, sum| {
                // -Re(conj(j q) sum_j conj(G_ji) y_j) = -Im(conj(q) sum)
                let q = state.drive[i];
                let d = -(q.re * sum.im - q.im * sum.re);
                trial.phi[i] = state.phi[i] + d;
                took(d, self.gradient[i]);
            },
        );
        for j in 0..count {
            let d =
                problem.targets()[j] * (state.phasor.re[j] * dual.im[j] - state.phasor.im[j] * dual.re[j]);
            trial.theta[j] = state.theta[j] + d;
            took(d, self.point_gradient[j]);
        }
        work.floats.give(both);
        dual.give(work);
        Some((sqrt(square), predicted))
    }

    fn give(self, work: &mut Workspace) {
        self.propagation.give(work);
        work.floats.give_all([self.matrix, self.gradient, self.point_gradient]);
        work.floats.give_all(self.columns);
    }
}
