//! The dual of a damped Gauss-Newton step in the phases of the drives.
//!
//! For real equations of the pressures with residuals r and derivatives J by the phases, the step
//! d = -(J^T J + mu I)^-1 J^T r is also d = -J^T (J J^T + mu I)^-1 r: a system of as many unknowns as there are equations,
//! however many transducers there are.

use alloc::vec::Vec;

use crate::kernels::lanes::padded;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tiles;
use crate::kernels::tiles::products;
use crate::linalg::Cholesky;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::{Aligned, Workspace};

/// The derivatives of some equations and their products.
pub(crate) struct Dual {
    /// Equations.
    pub(crate) size: usize,
    /// f and g of each: dr = f Re(G q d) + g Im(G q d). With dP = j G q d, Re P has f = 0, g = -1, and Im P f = 1, g = 0.
    pub(crate) factors: [Vec<f32>; 2],
    /// J J^T, the upper half of rows padded to 16.
    pub(crate) matrix: Vec<f32>,
    /// J as the rows of a plane.
    slopes: Aligned,
    set: InstructionSet,
}

impl Dual {
    pub(crate) fn new(rows: &Rows, size: usize, work: &mut Workspace) -> Self {
        Self {
            size,
            factors: [(); 2].map(|()| work.floats.take(size)),
            matrix: work.floats.take_any(size * padded(size)),
            slopes: Aligned::take(tiles::size(tiles::height(size), rows.lanes), work),
            set: rows.set,
        }
    }

    /// Length of a vector over the equations.
    pub(crate) fn lanes(&self) -> usize {
        padded(self.size)
    }

    /// J and J J^T at a wave; `points` are the rows of G that the equations are about.
    pub(crate) fn derive(&mut self, rows: &Rows, wave: &Wave, points: impl Iterator<Item = usize>) {
        let [[re, im], [f, g]] = [&wave.drive, &self.factors];
        tiles::slopes(self.set, rows.tiles(), [re, im], [f, g], points, &mut self.slopes);
        products::products(self.set, &self.slopes, rows.lanes, self.size, &mut self.matrix);
    }

    /// The Cholesky factor of J J^T with `damping` of each equation added to the diagonal; `None` if f32 has none.
    pub(crate) fn factor(&self, damping: impl Fn(usize) -> f32, work: &mut Workspace) -> Option<Cholesky> {
        let mut matrix = work.floats.take_any(self.matrix.len());
        matrix.copy_from_slice(&self.matrix);
        for k in 0..self.size {
            matrix[k * self.lanes() + k] += damping(k);
        }
        Cholesky::new(self.set, matrix, self.size, work)
    }

    /// Writes J^T y over the transducers; the largest modulus.
    pub(crate) fn back(&self, y: &[f32], out: &mut [f32]) -> f32 {
        tiles::combine(self.set, &self.slopes, y, out)
    }

    pub(crate) fn give(self, work: &mut Workspace) {
        self.slopes.give(work);
        work.floats.give_all(self.factors);
        work.floats.give(self.matrix);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solvers::common::tiled::tests::{Exact, random, wide};

    #[test]
    fn a_step_solves_the_damped_system() {
        let mut work = Workspace::new();
        for points in 1..=20 {
            let (problem, rows, mut wave) = random(points, 37, &mut work);
            let exact = Exact::new(&problem);
            wave.play_at_full(&rows, exact.drive(&wave).into_iter());
            let drive = exact.drive(&wave);
            let mut dual = Dual::new(&rows, 2 * points, &mut work);
            dual.factors[1][..points].fill(-1.0);
            dual.factors[0][points..].fill(1.0);
            dual.derive(&rows, &wave, (0..points).chain(0..points));
            // Re P and Im P by the phase of transducer i: P = .. + j G q d.
            let slope = |e: usize, i: usize| {
                let wave = exact.gain(e % points, i) * wide(drive[i]);
                if e < points { -wave.im } else { wave.re }
            };
            let damping = |e: usize| 1.0 + e as f32;
            let factor = dual.factor(damping, &mut work).expect("positive definite");
            let mut y = work.floats.take(dual.lanes());
            (0..2 * points).for_each(|e| y[e] = 1.0 - 0.1 * e as f32);
            factor.solve(&mut y);
            let mut turns = work.floats.take_any(rows.lanes);
            let most = dual.back(&y, &mut turns);
            assert_eq!(most, turns.iter().fold(0.0, |most: f32, turn| most.max(turn.abs())));
            for i in 0..37 {
                let want: f64 = (0..2 * points).map(|e| slope(e, i) * f64::from(y[e])).sum();
                assert!((f64::from(turns[i]) - want).abs() < 1e-5, "{points}: turn {} for {want}", turns[i]);
            }
            for e in 0..2 * points {
                let product: f64 = (0..37).map(|i| slope(e, i) * f64::from(turns[i])).sum();
                let got = product + f64::from(damping(e) * y[e]);
                // f32 rounding times the size of the matrix, some hundred.
                assert!((got - (1.0 - 0.1 * e as f64)).abs() < 1e-4, "{points}: equation {e}: {got}");
            }
        }
    }
}
