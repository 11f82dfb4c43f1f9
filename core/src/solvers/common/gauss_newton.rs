//! Damped Gauss-Newton step in the dual: d = -J^T (J J^T + D)^-1 r.
//!
//! For real equations of the pressures with residuals r and derivatives J by the drives' phases, the step d = -(J^T J +
//! mu I)^-1 J^T r equals -J^T (J J^T + mu I)^-1 r. The system then has as many unknowns as equations, however many
//! transducers there are.

use crate::kernels::tiles::products;
use crate::kernels::{padded, tiles};
use crate::linalg::Cholesky;
use crate::solvers::prelude::*;
use crate::workspace::Aligned;

/// The derivatives J of some equations, and J J^T.
pub(crate) struct Dual<'w> {
    /// The number of equations.
    pub(crate) size: usize,
    /// Factors f and g of each equation: rotations d of the drives q change its residual r by dr = f Re(G q d) + g Im(G
    /// q d). With dP = j G q d, Re P has f = 0, g = -1, and Im P has f = 1, g = 0.
    pub(crate) factors: [Buffer<'w, f32>; 2],
    /// The upper half of J J^T, in rows padded to 16.
    pub(crate) matrix: Buffer<'w, f32>,
    /// J as the rows of a plane.
    slopes: Aligned<'w>,
    set: InstructionSet,
    pub(crate) work: &'w Workspace,
}

impl<'w> Dual<'w> {
    pub(crate) fn new(rows: &Rows, size: usize, work: &'w Workspace, control: &mut Control) -> Result<Self> {
        let (slopes, sides) = (tiles::size(tiles::height(size), rows.lanes), [rows.lanes, rows.order.len()]);
        let taken = bytes(4, &[slopes]).saturating_add(bytes(8, &[size, padded(size)]));
        control.room("the Jacobian and its normal equations", sides, taken)?;
        Ok(Self {
            size,
            factors: [(); 2].map(|()| work.floats.take(size)),
            matrix: work.floats.take_any(size * padded(size)),
            slopes: Aligned::take(slopes, work),
            set: rows.set,
            work,
        })
    }

    /// Returns the length of a vector over the equations.
    pub(crate) fn lanes(&self) -> usize {
        padded(self.size)
    }

    /// Computes J and J J^T at a wave. `points` are the rows of G of the equations. If a `metric` is given, each column
    /// of J is multiplied by its entry.
    pub(crate) fn derive(
        &mut self,
        rows: &Rows,
        wave: &Wave,
        points: impl Iterator<Item = usize>,
        metric: Option<&[f32]>,
        control: &mut Control,
    ) -> Result<()> {
        let [[re, im], [f, g]] = [&wave.drive, &self.factors];
        tiles::slopes(self.set, rows.tiles(), [re, im], [f, g], points, &mut self.slopes, control)?;
        if let Some(metric) = metric {
            tiles::weigh(self.set, &mut self.slopes, metric);
        }
        products::products(self.set, &self.slopes, rows.lanes, self.size, &mut self.matrix, control)?;
        control.beat()
    }

    /// Returns the Cholesky factor of J J^T with `damping` of each equation added to the diagonal; `None` if f32 cannot
    /// factor it.
    pub(crate) fn factor(&self, damping: impl Fn(usize) -> f32, control: &mut Control) -> Result<Option<Cholesky<'w>>> {
        let mut matrix = self.work.floats.take_any(self.matrix.len());
        matrix.copy_from_slice(&self.matrix);
        for k in 0..self.size {
            matrix[k * self.lanes() + k] += damping(k);
        }
        Cholesky::new(self.set, matrix, self.size, control)
    }

    /// Returns how many of the first `count` equations depend on earlier equations. Such an equation has a pivot below
    /// `part` of its diagonal entry.
    pub(crate) fn dependent(&self, cholesky: &Cholesky, count: usize, part: f32) -> usize {
        let lanes = self.lanes();
        let left = cholesky.pivots(self.size).enumerate().take(count);
        left.filter(|(k, pivot)| *pivot < part * self.matrix[k * lanes + k]).count()
    }

    /// Writes J^T y over the transducers; returns the largest modulus.
    pub(crate) fn back(&self, y: &[f32], out: &mut [f32]) -> f32 {
        tiles::combine(self.set, &self.slopes, y, out)
    }
}

#[cfg(test)]
#[path = "tests/gauss_newton.rs"]
mod tests;
