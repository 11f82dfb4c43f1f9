//! Phase descent: L-BFGS steps that rotate the drives, for any cost of the field at some rows.
//!
//! ```text
//! dE/dphi_i = Im(conj(q_i) sum_k conj(G_ki) (dE/dRe P_k + j dE/dIm P_k))        P = G q, |q_i| = 1
//! ```
//!
//! A step costs two products with G, however many rows there are, and curvature is learnt from the last steps
//! ([`crate::solvers::common::quasi_newton`]). Each drive rotates by the arc tangent of what a step asks for.

use crate::kernels::tiles;
use crate::solvers::common::quasi_newton::{QuasiNewton, dot};
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::{Buffer, Workspace};

/// The part of the predicted decrease that a step must bring.
const ENOUGH: f64 = 1e-4;

/// Trials of a step, each at most half as long as the last.
const TRIALS: usize = 12;

/// The largest rotation of a first step, in rad.
const FIRST: f32 = 0.3;

/// The largest rotation asked of any step: its arc tangent is less than a quarter turn.
const LONGEST: f32 = 2.0;

/// What is to be low.
pub(crate) trait Cost {
    /// E of a wave.
    fn of(&self, wave: &Wave) -> f64;

    /// Writes dE/dRe P and dE/dIm P of the rows.
    fn pull(&self, wave: &Wave, pulls: [&mut [f32]; 2]);
}

/// A descent under way.
pub(crate) struct PhaseDescent<'w> {
    pub(crate) wave: Wave<'w>,
    /// E of the wave.
    pub(crate) cost: f64,
    trial: Wave<'w>,
    gradient: Buffer<'w, f32>,
    newton: QuasiNewton<'w>,
    pulls: [Buffer<'w, f32>; 2],
    sums: [Buffer<'w, f32>; 2],
}

impl<'w> PhaseDescent<'w> {
    pub(crate) fn new(wave: Wave<'w>, cost: &impl Cost, rows: &Rows, work: &'w Workspace) -> Self {
        let mut descent = Self {
            trial: Wave::new(rows, work),
            wave,
            cost: 0.0,
            gradient: work.floats.take(rows.lanes),
            newton: QuasiNewton::new(work),
            pulls: [(); 2].map(|()| work.floats.take(rows.count)),
            sums: [(); 2].map(|()| work.floats.take_any(rows.lanes)),
        };
        descent.follow(cost, rows);
        descent
    }

    /// From now on by another cost.
    pub(crate) fn follow(&mut self, cost: &impl Cost, rows: &Rows) {
        self.newton.forget();
        self.cost = cost.of(&self.wave);
        self.slope(cost, rows);
    }

    /// Writes the gradient at the wave.
    fn slope(&mut self, cost: &impl Cost, rows: &Rows) {
        cost.pull(&self.wave, self.pulls.each_mut().map(|plane| &mut plane[..]));
        let ([re, im], [sum_re, sum_im]) = (&self.pulls, &mut self.sums);
        tiles::correlate(rows.set, rows.tiles(), [re, im], [&mut *sum_re, &mut *sum_im]);
        let [qr, qi] = &self.wave.drive;
        for (i, gradient) in self.gradient.iter_mut().enumerate() {
            *gradient = qr[i] * sum_im[i] - qi[i] * sum_re[i];
        }
    }

    /// One step; whether there was one that lowers the cost.
    pub(crate) fn step(&mut self, cost: &impl Cost, rows: &Rows) -> bool {
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
                    let trial = cost.of(&self.trial);
                    if trial <= self.cost + ENOUGH * f64::from(part) * slope {
                        core::mem::swap(&mut self.wave, &mut self.trial);
                        self.cost = trial;
                        change.copy_from_slice(&self.gradient);
                        self.slope(cost, rows);
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
