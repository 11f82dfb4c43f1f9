//! What the methods need of linear algebra and no more: G stored, G G^H, a Cholesky solve.
//!
//! All in f32 over padded rows, so that the kernels' lanes do the work. The matrices solved are regularised
//! (condition below 1e5), which f32 bears; `docs/performance.md` has the measurements against a library.

pub(crate) mod leading_eigenvector;

use alloc::vec::Vec;

use crate::kernels;
use crate::kernels::cholesky;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::propagation::Propagation;
use crate::workspace::Workspace;

/// A complex vector or matrix of padded rows, planar.
#[derive(Debug)]
pub(crate) struct Planar {
    pub(crate) re: Vec<f32>,
    pub(crate) im: Vec<f32>,
    pub(crate) lanes: usize,
}

impl Planar {
    /// `rows` rows of zeros.
    pub(crate) fn zeros(rows: usize, lanes: usize, work: &mut Workspace) -> Self {
        Self { re: work.floats.take(rows * lanes), im: work.floats.take(rows * lanes), lanes }
    }

    /// G itself, a row a transducer.
    pub(crate) fn stored(propagation: &Propagation, work: &mut Workspace) -> Self {
        let mut rows = Self::zeros(propagation.transducers(), propagation.lanes(), work);
        for i in 0..propagation.transducers() {
            let [re, im] = rows.row_mut(i);
            propagation.row(i, re, im);
        }
        rows
    }

    pub(crate) fn row(&self, k: usize) -> [&[f32]; 2] {
        let range = k * self.lanes..(k + 1) * self.lanes;
        [&self.re[range.clone()], &self.im[range]]
    }

    pub(crate) fn row_mut(&mut self, k: usize) -> [&mut [f32]; 2] {
        let range = k * self.lanes..(k + 1) * self.lanes;
        [&mut self.re[range.clone()], &mut self.im[range]]
    }

    pub(crate) fn give(self, work: &mut Workspace) {
        work.floats.give_all([self.re, self.im]);
    }
}

/// conj(G G^H), row k padded: entry l is `conj(sum_i G_ki conj(G_li))`. Time O(N M^2), memory O(M^2).
///
/// Conjugated so that `correlate` with row k is row k of G G^H times a vector. `factor` weighs transducer i.
pub(crate) fn gram(propagation: &Propagation, factor: impl Fn(usize) -> f32, work: &mut Workspace) -> Planar {
    let (count, lanes) = (propagation.points(), propagation.lanes());
    let mut product = Planar::zeros(count, lanes, work);
    let mut memory = work.floats.take(kernels::gram_floats(lanes));
    let Planar { re, im, .. } = &mut product;
    kernels::gram(
        propagation.instruction_set(),
        propagation.rows(),
        factor,
        propagation.transducers(),
        count,
        &mut memory,
        [re, im],
    );
    work.floats.give(memory);
    product
}

/// The matrix that [`gram`] conjugates, times `vector`.
pub(crate) fn times(set: InstructionSet, matrix: &Planar, vector: &Planar, out: &mut Planar) {
    let Planar { re, im, .. } = out;
    kernels::correlate_rows(set, [&matrix.re, &matrix.im], vector.row(0), |k, p| {
        (re[k], im[k]) = (p.re, p.im);
    });
}

/// A Cholesky factor U of a real symmetric matrix A = U^T U, and solves with it. Time O(n^3/6) each multiply-add.
#[derive(Debug)]
pub(crate) struct Cholesky {
    factor: Vec<f32>,
    set: InstructionSet,
}

impl Cholesky {
    /// Factors the matrix of `size` padded rows in `matrix`, of which the upper half is read; `None` (and the buffer
    /// back in `work`) if it is not positive definite in f32.
    pub(crate) fn new(
        set: InstructionSet,
        mut matrix: Vec<f32>,
        size: usize,
        work: &mut Workspace,
    ) -> Option<Self> {
        if cholesky::factor(set, &mut matrix, size) {
            return Some(Self { factor: matrix, set });
        }
        work.floats.give(matrix);
        None
    }

    /// Replaces b (padded) by A^-1 b.
    pub(crate) fn solve(&self, b: &mut [f32]) {
        cholesky::solve(self.set, &self.factor, b);
    }

    pub(crate) fn give(self, work: &mut Workspace) {
        work.floats.give(self.factor);
    }
}

/// A Hermitian positive definite system (A + jB) x = b, solved as the real one [[A, -B], [B, A]].
#[derive(Debug)]
pub(crate) struct Hermitian {
    cholesky: Cholesky,
    lanes: usize,
}

impl Hermitian {
    /// Factors `conj(matrix) + shift I`, `matrix` as [`gram`] makes it. `None` if not positive definite in f32.
    pub(crate) fn new(
        set: InstructionSet,
        matrix: &Planar,
        count: usize,
        shift: f32,
        work: &mut Workspace,
    ) -> Option<Self> {
        let lanes = matrix.lanes;
        let size = 2 * lanes;
        let mut real = work.floats.take(size * size);
        for k in 0..lanes {
            let (upper, lower) = (k * size, (k + lanes) * size);
            if k < count {
                let [re, im] = matrix.row(k);
                for l in 0..lanes {
                    real[upper + l] = re[l];
                    // The stored matrix is conjugated: its im is -B.
                    real[upper + lanes + l] = im[l];
                    real[lower + lanes + l] = re[l];
                }
            }
            // Padding becomes the identity.
            let diagonal = if k < count { shift } else { 1.0 };
            real[upper + k] += diagonal;
            real[lower + lanes + k] += diagonal;
        }
        Cholesky::new(set, real, size, work).map(|cholesky| Self { cholesky, lanes })
    }

    /// The same with as much more damping as f32 needs to factor it: tenfold and tenfold again.
    pub(crate) fn damped(
        set: InstructionSet,
        matrix: &Planar,
        count: usize,
        mut shift: f32,
        work: &mut Workspace,
    ) -> Self {
        loop {
            // Damping far above every entry leaves a multiple of the identity, which always factors.
            if let Some(solver) = Self::new(set, matrix, count, shift, work) {
                return solver;
            }
            shift = 10.0 * shift.max(f32::MIN_POSITIVE);
        }
    }

    /// Replaces the vector (one padded row) by the solution.
    pub(crate) fn solve(&self, vector: &mut Planar, work: &mut Workspace) {
        let mut both = work.floats.take(2 * self.lanes);
        both[..self.lanes].copy_from_slice(&vector.re);
        both[self.lanes..].copy_from_slice(&vector.im);
        self.cholesky.solve(&mut both);
        vector.re.copy_from_slice(&both[..self.lanes]);
        vector.im.copy_from_slice(&both[self.lanes..]);
        work.floats.give(both);
    }

    pub(crate) fn give(self, work: &mut Workspace) {
        self.cholesky.give(work);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::rng::Rng;
    use num_complex::Complex64;

    /// A random Hermitian positive semidefinite matrix of rank at most `rank`, and the same stored conjugated.
    pub(crate) fn random(count: usize, rank: usize, work: &mut Workspace) -> (Vec<Vec<Complex64>>, Planar) {
        let mut rng = Rng::new((count * 1000 + rank) as u64);
        let mut number = || 2.0 * rng.uniform() - 1.0;
        let columns: Vec<Vec<Complex64>> =
            (0..rank).map(|_| (0..count).map(|_| Complex64::new(number(), number())).collect()).collect();
        let entry = |k: usize, l: usize| columns.iter().map(|g| g[k] * g[l].conj()).sum::<Complex64>();
        let matrix: Vec<Vec<Complex64>> =
            (0..count).map(|k| (0..count).map(|l| entry(k, l)).collect()).collect();
        let mut stored = Planar::zeros(count, crate::kernels::lanes::padded(count), work);
        for k in 0..count {
            let [re, im] = stored.row_mut(k);
            for l in 0..count {
                (re[l], im[l]) = (matrix[k][l].re as f32, -matrix[k][l].im as f32);
            }
        }
        (matrix, stored)
    }

    pub(crate) fn entry(vector: &Planar, j: usize) -> Complex64 {
        Complex64::new(f64::from(vector.re[j]), f64::from(vector.im[j]))
    }

    pub(crate) fn apply(matrix: &[Vec<Complex64>], vector: &Planar, k: usize) -> Complex64 {
        matrix[k].iter().enumerate().map(|(l, entry_)| entry_ * entry(vector, l)).sum()
    }

    #[test]
    fn a_hermitian_system_is_solved_at_every_size() {
        let mut work = Workspace::new();
        for count in 1..=40 {
            let (matrix, stored) = random(count, 2 * count, &mut work);
            let solver = Hermitian::new(InstructionSet::best(), &stored, count, 0.5, &mut work)
                .expect("positive definite");
            let mut x = Planar::zeros(1, crate::kernels::lanes::padded(count), &mut work);
            for j in 0..count {
                (x.re[j], x.im[j]) = (1.0 + j as f32, 2.0 - j as f32);
            }
            solver.solve(&mut x, &mut work);
            for k in 0..count {
                let wanted = Complex64::new(1.0 + k as f64, 2.0 - k as f64);
                let got = apply(&matrix, &x, k) + 0.5 * entry(&x, k);
                // Backward stable: rounding times the size of matrix and solution, which stay below 1e3 here.
                assert!((got - wanted).norm() < 1e-3 * count as f64, "{count}: {got} for {wanted}");
            }
            assert!(x.re[count..].iter().all(|&x| x == 0.0));
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        let mut work = Workspace::new();
        let (_, stored) = random(8, 2, &mut work);
        assert!(Hermitian::new(InstructionSet::best(), &stored, 8, -1.0, &mut work).is_none());
        assert!(Cholesky::new(InstructionSet::best(), alloc::vec![0.0; 256], 16, &mut work).is_none());
    }
}
