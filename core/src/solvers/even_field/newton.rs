//! Newton: the linear system of the drives' rotations at a wave, in the dual.
//!
//! ```text
//! (J D^-1 J^T + mu W^-1) y = s t - |P|,   d = D^-1 J^T y
//! ```
//!
//! J are the derivatives of the moduli |P| by the drives' phases, t the targets, W the weights, mu the damping and D a
//! [`Metric`], or 1 for the shortest d. This is an M x M system for M points, however many transducers there are. A quiet
//! point has two rows, Re P = Im P = 0; a point of large weight is damped less. The level s is given, or it follows from
//! the sum of y. With the sum 0 the step d is the shortest one to any level.

use crate::kernels::tiles;
use crate::linalg::Cholesky;
use crate::math::sqrtf;
use crate::prelude::*;
use crate::problem::Problem;
use crate::solvers::common::gauss_newton::Dual;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::{Buffer, Workspace};

/// Damping of a step whose system is regular.
pub(super) const DAMPING: f32 = 1e-6;

/// The part of the allowed leak at which a step aims for the quiet points. The rest is for points between those that
/// are made silent, and for the error of a step.
const WITHIN: f32 = 0.3;

/// Weights below this count as 0.
const LEAST_WEIGHT: f32 = 1e-6;

/// The usual lower bound of a [`Metric`].
pub(super) const LEAST_CURVATURE: f32 = 0.1;

/// The level that a step aims at, or the sum of its multipliers over the targeted points.
#[derive(Clone, Copy)]
pub(crate) enum Level {
    Given(f32),
    Sum(f64),
}

/// The level of the shortest step.
pub(crate) const FREE: Level = Level::Sum(0.0);

/// The factor of the damped J J^T, and its solution for a rise of the level.
pub(crate) type Factor<'w> = (Cholesky<'w>, Buffer<'w, f32>);

/// The linear system at a wave: the targeted points' moduli, then the quiet points' real and imaginary parts.
pub(crate) struct Newton<'w> {
    pub(crate) dual: Dual<'w>,
    /// 1 / weight of each equation.
    pub(super) ease: Buffer<'w, f32>,
    pub(crate) rotations: Buffer<'w, f32>,
    /// The allowed leak of a quiet point, relative to the level.
    quiet: f32,
}

impl<'w> Newton<'w> {
    pub(crate) fn new(
        problem: &Problem,
        rows: &Rows,
        quiet: f32,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let (targeted, all) = (rows.targeted, rows.order.len());
        let mut dual = Dual::new(rows, rows.equations(), work, control)?;
        let [f, g] = &mut dual.factors;
        g[targeted..all].fill(-1.0);
        f[all..].fill(1.0);
        let mut ease = work.floats.take(dual.size);
        let points = rows.order.iter().chain(&rows.order[targeted..]);
        for (ease, &j) in ease.iter_mut().zip(points) {
            *ease = 1.0 / problem.weights()[j as usize].max(LEAST_WEIGHT);
        }
        // A quiet point's row is multiplied by its weight, so the damping is relative to the row's own size.
        for (ease, scale) in ease[targeted..].iter_mut().zip(rows.scale[targeted..].iter().cycle()) {
            *ease = (scale * scale).max(f32::MIN_POSITIVE);
        }
        Ok(Self { dual, ease, rotations: work.floats.take_any(rows.lanes), quiet })
    }

    /// Returns the weighted squared deviations from `level`, relative to it.
    pub(crate) fn cost(&self, rows: &Rows, wave: &Wave, level: f32) -> f64 {
        let missing = |k: usize| self.missing(rows, wave, k, level) / level;
        (0..self.dual.size).map(|k| f64::from(missing(k) * missing(k) / self.ease[k])).sum()
    }

    /// Returns how much an equation misses at a level. A quiet point misses only its leak above the allowed one.
    pub(super) fn missing(&self, rows: &Rows, wave: &Wave, equation: usize, level: f32) -> f32 {
        let points = rows.order.len();
        let (value, modulus) = match equation {
            k if k < rows.targeted => return level - wave.moduli[k],
            k if k < points => (wave.field[0][k], wave.moduli[k]),
            k => {
                let k = k - points + rows.targeted;
                (wave.field[1][k], wave.moduli[k])
            }
        };
        if modulus <= WITHIN * self.quiet * level { 0.0 } else { value * (WITHIN * self.quiet * level / modulus - 1.0) }
    }

    /// Computes the derivatives at a wave. If a `metric` is given, the derivatives of each transducer are multiplied by its
    /// entry.
    pub(crate) fn update(
        &mut self,
        rows: &Rows,
        wave: &Wave,
        metric: Option<&[f32]>,
        control: &mut Control,
    ) -> Result<(), Error> {
        let (targeted, points) = (rows.targeted, rows.order.len());
        let [f, g] = &mut self.dual.factors;
        // The derivative d|P| = Re(conj(P) dP)/|P| with dP = j G q d, for rotations d of the drives q.
        for k in 0..targeted {
            (f[k], g[k]) = (wave.field[1][k] / wave.moduli[k], -wave.field[0][k] / wave.moduli[k]);
        }
        self.dual.derive(rows, wave, (0..points).chain(targeted..points), metric, control)
    }

    /// Returns the factor of the matrix with a damping relative to its mean diagonal entry; `None` if f32 cannot factor
    /// it.
    pub(crate) fn factored(
        &self,
        rows: &Rows,
        damping: f32,
        control: &mut Control,
    ) -> Result<Option<Factor<'w>>, Error> {
        let (size, lanes) = (self.dual.size, self.dual.lanes());
        let mean = (0..size).map(|k| self.dual.matrix[k * lanes + k]).sum::<f32>() / size as f32;
        self.factored_by(rows, damping * mean, control)
    }

    /// Does the same as [`Newton::factored`] for a damping in the unit of the matrix.
    pub(super) fn factored_by(
        &self,
        rows: &Rows,
        damping: f32,
        control: &mut Control,
    ) -> Result<Option<Factor<'w>>, Error> {
        let factor = self.dual.factor(|k| damping * self.ease[k], control)?;
        let Some(cholesky) = factor else { return Ok(None) };
        let mut rise = self.dual.work.floats.take(self.dual.lanes());
        rise[..rows.targeted].fill(1.0);
        cholesky.solve(&mut rise);
        Ok(Some((cholesky, rise)))
    }

    /// Returns the multipliers y of a step from a wave.
    pub(crate) fn multipliers(
        &self,
        rows: &Rows,
        wave: &Wave,
        (cholesky, rise): &Factor<'w>,
        level: Level,
    ) -> Buffer<'w, f32> {
        // The solution is computed from the mean level. As the difference of s times one solution and another solution,
        // it would lose most digits.
        let middle = wave.level(rows);
        let mut dual = self.dual.work.floats.take(rise.len());
        for (k, dual) in dual.iter_mut().enumerate().take(self.dual.size) {
            *dual = self.missing(rows, wave, k, middle);
        }
        cholesky.solve(&mut dual);
        let total = |values: &[f32]| values[..rows.targeted].iter().map(|&x| f64::from(x)).sum::<f64>();
        let shift = match level {
            Level::Given(level) => level - middle,
            Level::Sum(sum) => ((sum - total(&dual)) / total(rise)) as f32,
        };
        dual.iter_mut().zip(&rise[..]).for_each(|(dual, rise)| *dual += shift * rise);
        dual
    }

    /// Writes the rotations of multipliers, and returns the largest; `roots` are those of the metric of the last update.
    pub(super) fn turn(&mut self, multipliers: &[f32], roots: Option<&[f32]>) -> f32 {
        let most = self.dual.back(multipliers, &mut self.rotations);
        let Some(roots) = roots else { return most };
        let turned = self.rotations.iter_mut().zip(roots).map(|(rotation, root)| {
            *rotation *= root;
            rotation.abs()
        });
        turned.fold(0.0, |most, turned| if turned > most || turned.is_nan() { turned } else { most })
    }

    /// Writes the steepest descent of the deviations from the mean level to `rotations`.
    pub(crate) fn descent(&mut self, rows: &Rows, wave: &Wave, control: &mut Control) -> Result<(), Error> {
        self.update(rows, wave, None, control)?;
        let level = wave.level(rows);
        let mut missing = self.dual.work.floats.take(self.dual.lanes());
        for (k, missing) in missing.iter_mut().enumerate().take(self.dual.size) {
            *missing = self.missing(rows, wave, k, level);
        }
        self.dual.back(&missing, &mut self.rotations);
        Ok(())
    }

    /// Writes the shortest step with a free level to `rotations`; a `metric` weighs the transducers in the length of the
    /// step. Returns `false` if f32 cannot find a step.
    pub(crate) fn direction(
        &mut self,
        rows: &Rows,
        wave: &Wave,
        metric: Option<&[f32]>,
        control: &mut Control,
    ) -> Result<bool, Error> {
        self.update(rows, wave, metric, control)?;
        let Some(factor) = self.factored(rows, DAMPING, control)? else { return Ok(false) };
        let dual = self.multipliers(rows, wave, &factor, FREE);
        Ok(self.dual.back(&dual, &mut self.rotations).is_finite())
    }
}

/// D^-1/2 of every transducer: a rotation d_i of the drive q_i lowers sum_j y_j |P_j| by D_i d_i^2/2, with
/// D_i = Re(q_i sum_j y_j conj(P_j/|P_j|) G_ji).
pub(super) struct Metric<'w> {
    /// Lower bound of D_i, relative to the mean. It limits the rotation of transducers of little effect.
    least: f32,
    pub(super) roots: Buffer<'w, f32>,
    /// y_j P_j/|P_j| over the rows j, with the multipliers y.
    pulls: [Buffer<'w, f32>; 2],
    /// sum_j conj(G_ji) y_j P_j/|P_j| over the transducers i.
    sums: [Buffer<'w, f32>; 2],
}

impl<'w> Metric<'w> {
    pub(super) fn new(rows: &Rows, least: f32, work: &'w Workspace) -> Self {
        Self {
            least,
            roots: work.floats.take(rows.lanes),
            pulls: [(); 2].map(|()| work.floats.take(rows.count)),
            sums: [(); 2].map(|()| work.floats.take_any(rows.lanes)),
        }
    }

    pub(super) fn measure(&mut self, rows: &Rows, wave: &Wave, multipliers: &[f32]) {
        for k in 0..rows.targeted {
            let part = if wave.moduli[k] > 0.0 { multipliers[k] / wave.moduli[k] } else { 0.0 };
            (self.pulls[0][k], self.pulls[1][k]) = (part * wave.field[0][k], part * wave.field[1][k]);
        }
        let ([pull_re, pull_im], [re, im]) = (&self.pulls, &mut self.sums);
        tiles::correlate(rows.set, rows.tiles(), [pull_re, pull_im], [&mut *re, &mut *im]);
        let curvature = |i: usize| wave.drive[0][i] * re[i] + wave.drive[1][i] * im[i];
        let mut mean = 0.0;
        for i in 0..rows.lanes {
            self.roots[i] = curvature(i).abs();
            mean += self.roots[i] / rows.lanes as f32;
        }
        let least = (self.least * mean).max(f32::MIN_POSITIVE);
        self.roots.iter_mut().for_each(|root| *root = 1.0 / sqrtf(root.max(least)));
    }
}
