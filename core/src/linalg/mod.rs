//! Planar vectors, the Cholesky factor of a real matrix, and Hermitian systems.
//!
//! All numbers are f32 in padded rows, which the kernels process. The matrices are regularised (condition below 1e5),
//! so that f32 suffices; `docs/performance/steps.md` has measurements against a library.

pub(crate) mod leading_eigenvector;
pub(crate) mod symmetric;

pub(crate) use leading_eigenvector::leading_eigenvector;

use crate::kernels;
use crate::kernels::{InstructionSet, cholesky};
use crate::prelude::*;
use crate::workspace::{Buffer, Workspace};

/// A complex vector or matrix of padded rows: real and imaginary parts in separate lists.
#[derive(Debug)]
pub(crate) struct Planar<'w> {
    pub(crate) re: Buffer<'w, f32>,
    pub(crate) im: Buffer<'w, f32>,
    pub(crate) lanes: usize,
}

impl<'w> Planar<'w> {
    /// Creates `rows` rows of zeros.
    pub(crate) fn zeros(rows: usize, lanes: usize, work: &'w Workspace) -> Self {
        Self { re: work.floats.take(rows * lanes), im: work.floats.take(rows * lanes), lanes }
    }

    /// Multiplies each entry of a vector by a factor of its own.
    pub(crate) fn scale(&mut self, factors: impl Iterator<Item = f32>) {
        for ((re, im), factor) in self.re.iter_mut().zip(&mut self.im).zip(factors) {
            *re *= factor;
            *im *= factor;
        }
    }

    /// Returns the diagonal of a Hermitian matrix.
    pub(crate) fn diagonal(&self) -> impl Iterator<Item = f32> {
        self.re.iter().step_by(self.lanes + 1).copied()
    }

    pub(crate) fn row(&self, k: usize) -> [&[f32]; 2] {
        let range = k * self.lanes..(k + 1) * self.lanes;
        [&self.re[range.clone()], &self.im[range]]
    }

    pub(crate) fn row_mut(&mut self, k: usize) -> [&mut [f32]; 2] {
        let range = k * self.lanes..(k + 1) * self.lanes;
        [&mut self.re[range.clone()], &mut self.im[range]]
    }
}

/// out = conj(`matrix`) `vector`, for a matrix that [`Strips::gram`](crate::propagation::Strips::gram) stored
/// conjugated.
///
/// # Errors
/// A requested stop.
pub(crate) fn times(
    set: InstructionSet,
    matrix: &Planar,
    vector: &Planar,
    out: &mut Planar,
    control: &mut Control,
) -> Result<()> {
    let Planar { re, im, .. } = out;
    kernels::correlate_rows(set, [&matrix.re, &matrix.im], vector.row(0), control, |k, p| {
        (re[k], im[k]) = (p.re, p.im);
    })
}

/// The Cholesky factor U of a real symmetric matrix A = U^T U, which solves A x = b. It takes n^3/6 multiply-adds.
#[derive(Debug)]
pub(crate) struct Cholesky<'w> {
    factor: Buffer<'w, f32>,
    set: InstructionSet,
}

impl<'w> Cholesky<'w> {
    /// Factors a matrix of `size` padded rows, whose upper half is read. Returns `None` if it is not positive definite
    /// in f32.
    pub(crate) fn new(
        set: InstructionSet,
        mut matrix: Buffer<'w, f32>,
        size: usize,
        control: &mut Control,
    ) -> Result<Option<Self>> {
        Ok(cholesky::factor(set, &mut matrix, size, control)?.then_some(Self { factor: matrix, set }))
    }

    /// Returns the pivots: what is left of each diagonal entry after the rows above are subtracted.
    pub(crate) fn pivots(&self, size: usize) -> impl Iterator<Item = f32> {
        let lanes = kernels::padded(size);
        (0..size).map(move |k| self.factor[k * lanes + k] * self.factor[k * lanes + k])
    }

    /// Replaces the padded vector b by A^-1 b.
    pub(crate) fn solve(&self, b: &mut [f32]) {
        cholesky::solve(self.set, &self.factor, b);
    }
}

/// A Hermitian positive definite system (A + jB) x = b, solved as the real one [[A, -B], [B, A]].
#[derive(Debug)]
pub(crate) struct Hermitian<'w> {
    cholesky: Cholesky<'w>,
    lanes: usize,
    work: &'w Workspace,
}

impl<'w> Hermitian<'w> {
    /// Factors `conj(matrix) + shift I`, with `matrix` from [`Strips::gram`](crate::propagation::Strips::gram). Returns
    /// `None` if it is not positive definite in f32.
    pub(crate) fn new(
        set: InstructionSet,
        matrix: &Planar,
        count: usize,
        shift: f32,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Option<Self>> {
        let lanes = matrix.lanes;
        let size = 2 * lanes;
        control.room("the Cholesky factor", [0, count], bytes(4, &[size, size]))?;
        let mut real = work.floats.take(size * size);
        for k in 0..lanes {
            control.pulse()?;
            let (upper, lower) = (k * size, (k + lanes) * size);
            if k < count {
                let [re, im] = matrix.row(k);
                for l in 0..lanes {
                    real[upper + l] = re[l];
                    // The stored matrix is conjugated: its imaginary part is -B.
                    real[upper + lanes + l] = im[l];
                    real[lower + lanes + l] = re[l];
                }
            }
            // The padding becomes the identity.
            let diagonal = if k < count { shift } else { 1.0 };
            real[upper + k] += diagonal;
            real[lower + lanes + k] += diagonal;
        }
        Ok(Cholesky::new(set, real, size, control)?.map(|cholesky| Self { cholesky, lanes, work }))
    }

    /// Does the same as [`Self::new`], and multiplies the damping by ten until f32 can factor the matrix.
    ///
    /// # Errors
    /// A matrix that is not finite.
    pub(crate) fn damped(
        set: InstructionSet,
        matrix: &Planar,
        count: usize,
        mut shift: f32,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self> {
        // Damping far above every entry leaves a multiple of the identity, which can always be factored.
        while shift.is_finite() {
            if let Some(solver) = Self::new(set, matrix, count, shift, work, control)? {
                return Ok(solver);
            }
            shift = 10.0 * shift.max(f32::MIN_POSITIVE);
        }
        Err(Error::lost())
    }

    /// Replaces the vector (one padded row) by the solution.
    pub(crate) fn solve(&self, vector: &mut Planar) {
        let mut both = self.work.floats.take(2 * self.lanes);
        both[..self.lanes].copy_from_slice(&vector.re);
        both[self.lanes..].copy_from_slice(&vector.im);
        self.cholesky.solve(&mut both);
        vector.re.copy_from_slice(&both[..self.lanes]);
        vector.im.copy_from_slice(&both[self.lanes..]);
    }
}

#[cfg(test)]
#[path = "tests/linalg.rs"]
pub(crate) mod tests;
