//! lm: Levenberg-Marquardt on all phases (Madsen et al. 2004, algorithm 3.16; Suzuki et al. 2021).
//!
//! The unknowns are the phases phi_i of the transducers, |q_i| = 1, and theta_j of the points. The complex residuals
//! are r_j = sqrt(w_j) (P_j - t_j e^{j theta_j}) with weights w and targets t. A step solves (J^T J + mu I) d = -J^T r
//! in the dual ([`crate::solvers::common::gauss_newton`]) of 2M real equations. It rotates each phasor by atan(d),
//! which needs no sine or cosine.

use crate::kernels;
use crate::kernels::padded;
use crate::solvers::common::alternating_projection::Projector;
use crate::solvers::common::gauss_newton::Dual;
use crate::solvers::iterate::iterate;
use crate::solvers::prelude::*;

options! {
    /// Levenberg-Marquardt, |q| = 1. Time O(N M^2 + M^3) a step, memory O(N M + M^2).
    pub struct Lm {
        /// Largest number of steps.
        pub steps: u32 = 200,
        /// First damping relative to the largest diagonal entry of J^T J, above 0.
        pub tau: f64 = 1e-3,
        /// Ends when the gradient, or the root mean square of a step in turns, is below this; 0 takes all steps.
        pub eps: f64 = 1e-8,
        /// Seed of the random start phases, 0 to 2^64 - 1.
        pub seed: u64 = 0,
    }
}

impl Method for Lm {
    const INFO: Info = Info::new(
        "lm",
        "Levenberg-Marquardt on all phases, |q| = 1",
        "Madsen et al. 2004, algorithm 3.16; Suzuki et al. 2021",
    )
    .with_start()
    .within(0.02);

    fn check(&self) -> Result<()> {
        check_iteration(self.steps, 0.0)?;
        real("eps", self.eps, 0.0, false)?;
        real("tau", self.tau, 0.0, true).map(|_| ())
    }
}

impl Solve for Lm {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let rows = Rows::new(problem, work, control)?;
        let mut state = State::new(problem, &rows, self.seed, work, control)?;
        let mut trial = State::empty(&rows, work);
        let mut normal = Normal::new(problem, &rows, work, control)?;
        normal.update(&rows, &state, control)?;
        let begun_at_rest = normal.steepest <= self.eps;
        let (mut damping, mut growth) = (self.tau * largest(problem, work, control)?, 2.0);
        // `eps` is the root mean square of a step in turns; `least` is the norm of the step in rad.
        let least =
            self.eps * TAU * sqrt((problem.propagation().transducers() + problem.propagation().points()) as f64);
        let ended = if begun_at_rest {
            (Status::Done, 0)
        } else {
            iterate(
                (self.steps, self.eps),
                &mut state,
                control,
                |state, control| {
                    let Some((length, predicted)) = normal.step(&rows, state, damping, &mut trial, control)? else {
                        // The matrix is not positive definite in f32. With more damping it becomes positive definite.
                        damping *= growth;
                        growth *= 2.0;
                        return Ok(false);
                    };
                    if length <= least {
                        return Ok(true);
                    }
                    control.beat()?;
                    trial.refresh(problem);
                    let ratio = (state.cost - trial.cost) / predicted;
                    if ratio > 0.0 {
                        core::mem::swap(state, &mut trial);
                        let trust = 2.0 * ratio - 1.0;
                        damping *= (1.0 - trust * trust * trust).max(1.0 / 3.0);
                        growth = 2.0;
                        normal.update(&rows, state, control)?;
                        Ok(normal.steepest <= self.eps)
                    } else {
                        damping *= growth;
                        growth *= 2.0;
                        // With this damping a step changes no number in f32: the method has converged.
                        Ok(damping > 1e30)
                    }
                },
                |state| problem.residual(&state.wave.moduli),
            )?
        };
        let drive = state.wave.drives(problem.propagation().transducers(), work);
        Solution::new(problem, drive, ended, self.steps as usize, work, control)
    }
}

/// Returns the largest diagonal entry of J^T J. The entries are sum_j w_j |G_ji|^2 for transducer i and w_j t_j^2 for
/// point j.
fn largest(problem: &Problem, work: &Workspace, control: &mut Control) -> Result<f64> {
    let (propagation, weights) = (problem.propagation(), problem.weights());
    let mut row = Planar::zeros(1, propagation.lanes(), work);
    let mut squares = work.floats.take(propagation.lanes());
    let pulls = problem.targets().iter().zip(weights).map(|(target, weight)| weight * target * target);
    let mut largest = pulls.fold(0.0, f32::max);
    for i in 0..propagation.transducers() {
        control.pulse()?;
        propagation.row(i, &mut row.re, &mut row.im);
        squares.fill(0.0);
        kernels::squares(propagation.instruction_set(), row.row(0), propagation.points(), &mut squares);
        largest = largest.max(kernels::dot(propagation.instruction_set(), &squares, weights));
    }
    Ok(f64::from(largest))
}

/// A set of phases, and the values that follow from it.
struct State<'w> {
    /// The drives e^{j phi} and their field.
    wave: Wave<'w>,
    /// The points' phasors e^{j theta}.
    phasors: [Buffer<'w, f32>; 2],
    /// sqrt(w) (P - t e^{j theta}): real parts, then imaginary ones.
    residual: Buffer<'w, f32>,
    cost: f64,
}

impl<'w> State<'w> {
    fn empty(rows: &Rows, work: &'w Workspace) -> Self {
        let points = rows.order.len();
        Self {
            wave: Wave::new(rows, work),
            phasors: [(); 2].map(|()| work.floats.take(points)),
            residual: work.floats.take(padded(2 * points)),
            cost: 0.0,
        }
    }

    /// Creates the state from the phases of the problem's start and of its field, or from random phases.
    fn new(problem: &Problem, rows: &Rows, seed: u64, work: &'w Workspace, control: &mut Control) -> Result<Self> {
        let mut state = Self::empty(rows, work);
        let mut projector = Projector::new(rows, work);
        let start = projector.start(problem, rows, work, control)?;
        let mut rng = Rng::new(seed);
        let mut random = || {
            let angle = f64::from((TAU * rng.uniform()) as f32);
            Complex32::new(math::cos(angle) as f32, math::sin(angle) as f32)
        };
        let mut drive = work.complexes.take(problem.propagation().transducers());
        drive.fill_with(&mut random);
        for j in 0..rows.order.len() {
            let phasor = random();
            (state.phasors[0][j], state.phasors[1][j]) = (phasor.re, phasor.im);
        }
        if let Some(start) = start {
            for (i, q) in drive.iter_mut().enumerate() {
                let own = Complex32::new(start.drive[0][i], start.drive[1][i]);
                *q = if own == Complex32::ZERO { Complex32::ONE } else { own };
            }
            for (j, &modulus) in start.moduli.iter().enumerate().take(rows.order.len()) {
                let own = [start.field[0][j], start.field[1][j]].map(|part| part / modulus);
                [state.phasors[0][j], state.phasors[1][j]] = if modulus > 0.0 { own } else { [1.0, 0.0] };
            }
        }
        state.wave.play_at_full(rows, drive.iter().copied());
        state.refresh(problem);
        Ok(state)
    }

    /// Computes residual and cost from the phases.
    fn refresh(&mut self, problem: &Problem) {
        let count = problem.propagation().points();
        self.cost = 0.0;
        for (part, (field, phasors)) in self.wave.field.iter().zip(&self.phasors).enumerate() {
            for j in 0..count {
                let short = field[j] - problem.targets()[j] * phasors[j];
                let residual = sqrtf(problem.weights()[j]) * short;
                self.residual[part * count + j] = residual;
                self.cost += 0.5 * f64::from(residual) * f64::from(residual);
            }
        }
    }
}

/// The normal equations at a state, in their dual form.
struct Normal<'w> {
    /// Two equations for each point, the real parts first. The points' columns of J are only added to its matrix.
    dual: Dual<'w>,
    /// sqrt(w) t: the length of a point's own column of J.
    pulls: Buffer<'w, f32>,
    gradient: Buffer<'w, f32>,
    point_gradient: Buffer<'w, f32>,
    /// J^T y of a step; the rotations are its negative.
    rotations: Buffer<'w, f32>,
    /// The largest |gradient|.
    steepest: f64,
}

impl<'w> Normal<'w> {
    fn new(problem: &Problem, rows: &Rows, work: &'w Workspace, control: &mut Control) -> Result<Self> {
        let count = rows.order.len();
        let mut dual = Dual::new(rows, 2 * count, work, control)?;
        let mut pulls = work.floats.take(count);
        // d r_j / d phi_i = i sqrt(w_j) G_ji q_i, where the factor i is the imaginary unit.
        for j in 0..count {
            let root = sqrtf(problem.weights()[j]);
            dual.factors[1][j] = -root;
            dual.factors[0][count + j] = root;
            pulls[j] = root * problem.targets()[j];
        }
        Ok(Self {
            dual,
            pulls,
            gradient: work.floats.take_any(rows.lanes),
            point_gradient: work.floats.take(count),
            rotations: work.floats.take_any(rows.lanes),
            steepest: 0.0,
        })
    }

    fn update(&mut self, rows: &Rows, state: &State, control: &mut Control) -> Result<()> {
        let (count, lanes) = (rows.order.len(), self.dual.lanes());
        self.dual.derive(rows, &state.wave, (0..count).chain(0..count), None, control)?;
        control.beat()?;
        self.steepest = f64::from(self.dual.back(&state.residual, &mut self.gradient));
        let matrix = &mut self.dual.matrix;
        for j in 0..count {
            // d r_j / d theta_j = -i sqrt(w_j) t_j e^{i theta_j}, where i is the imaginary unit.
            let (re, im) = (self.pulls[j] * state.phasors[1][j], -self.pulls[j] * state.phasors[0][j]);
            matrix[j * lanes + j] += re * re;
            matrix[j * lanes + count + j] += re * im;
            matrix[(count + j) * lanes + count + j] += im * im;
            self.point_gradient[j] = re * state.residual[j] + im * state.residual[count + j];
            self.steepest = self.steepest.max(f64::from(self.point_gradient[j].abs()));
        }
        Ok(())
    }

    /// Writes to `trial` the state after a step of the given damping. Returns the step's norm and the decrease of the
    /// cost that the linear model predicts; `None` if f32 cannot factor the matrix.
    fn step(
        &mut self,
        rows: &Rows,
        state: &State,
        damping: f64,
        trial: &mut State,
        control: &mut Control,
    ) -> Result<Option<(f64, f64)>> {
        let count = rows.order.len();
        let Some(cholesky) = self.dual.factor(|_| damping as f32, control)? else { return Ok(None) };
        let mut dual = self.dual.work.floats.take_any(self.dual.lanes());
        dual.copy_from_slice(&state.residual);
        control.beat()?;
        cholesky.solve(&mut dual);
        control.beat()?;
        self.dual.back(&dual, &mut self.rotations);
        let (mut square, mut predicted) = (0.0, 0.0);
        let mut took = |d: f32, slope: f32| {
            let (d, slope) = (f64::from(d), f64::from(slope));
            square += d * d;
            predicted += 0.5 * d * (damping * d - slope);
        };
        self.rotations.iter().zip(&self.gradient).for_each(|(&rotation, &slope)| took(-rotation, slope));
        control.beat()?;
        trial.wave.rotate(rows, &state.wave, &self.rotations, -1.0);
        for j in 0..count {
            let (re, im) = (state.phasors[0][j], state.phasors[1][j]);
            let d = self.pulls[j] * (re * dual[count + j] - im * dual[j]);
            took(d, self.point_gradient[j]);
            let length = sqrtf(1.0 + d * d) * sqrtf(re * re + im * im);
            (trial.phasors[0][j], trial.phasors[1][j]) = ((re - d * im) / length, (im + d * re) / length);
        }
        Ok(Some((sqrt(square), predicted)))
    }
}
