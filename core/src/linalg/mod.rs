//! What the methods need of linear algebra and no more: G G^H, a Cholesky solve.
//!
//! All in f32 over padded rows, so that the kernels' lanes do the work. The matrices solved are regularised
//! (condition below 1e5), which f32 bears; `docs/design.md` has the measurements against a library.

pub(crate) mod leading_eigenvector;

use alloc::vec::Vec;

use crate::kernels;
use crate::kernels::cholesky;
use crate::kernels::lanes::LANES;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tiles;
use crate::kernels::tiles::Tiles;
use crate::kernels::tiles::products;
use crate::math::sqrtf;
use crate::propagation::Propagation;
use crate::workspace::{Aligned, Workspace};

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

/// conj(G diag(f) G^H), row k padded: entry l is `conj(sum_i f_i G_ki conj(G_li))`, f_i >= 0, 1 where left out. Time
/// O(N M^2), memory O(M^2).
///
/// Conjugated so that `correlate` with row k is row k of G G^H times a vector.
pub(crate) fn gram(propagation: &Propagation, factors: Option<&[f32]>, work: &mut Workspace) -> Planar {
    const TOGETHER: usize = products::RUN * LANES;
    let (set, count, lanes) = (propagation.instruction_set(), propagation.points(), propagation.lanes());
    let mut product = Planar::zeros(count, lanes, work);
    let mut order = work.indices.take(count);
    order.iter_mut().zip(0..).for_each(|(row, j)| *row = j);
    let mut roots = work.floats.take(TOGETHER);
    let most = tiles::size(tiles::height(count), tiles::lanes(propagation.transducers().min(TOGETHER)));
    let mut planes = [(); 2].map(|()| Aligned::take(most, work));
    for first in (0..propagation.transducers()).step_by(TOGETHER) {
        let members = first..propagation.transducers().min(first + TOGETHER);
        let across = tiles::lanes(members.len());
        let size = tiles::size(tiles::height(count), across);
        let [re, im] = planes.each_mut().map(|plane| &mut plane[..size]);
        tiles::pack(set, propagation.rows(), members.clone(), &order, [&mut *re, &mut *im]);
        if let Some(factors) = factors {
            roots.iter_mut().zip(&factors[members]).for_each(|(root, factor)| *root = sqrtf(*factor));
            tiles::weigh(set, re, &roots[..across]);
            tiles::weigh(set, im, &roots[..across]);
        }
        let to = [&mut product.re[..], &mut product.im[..]];
        let tiles = Tiles { planes: [re, im], lanes: across };
        products::couplings(set, tiles, 0..across / LANES, count, to);
    }
    for k in 0..count {
        for l in k..count {
            let (upper, lower) = (k * lanes + l, l * lanes + k);
            let (re, im) = (product.re[upper], product.im[upper]);
            (product.re[lower], product.im[lower]) = (re, im);
            product.im[upper] = -im;
        }
    }
    for plane in planes {
        plane.give(work);
    }
    work.floats.give(roots);
    work.indices.give(order);
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
    fn gram_is_the_weighted_conjugate_product() {
        let mut work = Workspace::new();
        let mut rng = Rng::new(1);
        for (set, count) in InstructionSet::all().flat_map(|set| (1..=67).map(move |count| (set, count))) {
            // One run of tiles, and two with a rest.
            for transducers in [1, 37, 530] {
                let mut number = || 2.0 * rng.uniform() - 1.0;
                let matrix: Vec<Complex64> =
                    (0..count * transducers).map(|_| Complex64::new(number(), number())).collect();
                let propagation =
                    Propagation::from_matrix(&matrix, count).expect("propagation").with_instruction_set(set);
                let unit = 1.0 / propagation.reference();
                let factors: Vec<f32> = (0..transducers).map(|i| 0.25 + (i % 3) as f32).collect();
                for factors in [None, Some(&factors[..])] {
                    // Twice, over dirty memory.
                    gram(&propagation, factors, &mut work).give(&mut work);
                    let product = gram(&propagation, factors, &mut work);
                    for k in (0..count).step_by(1 + count / 9) {
                        for l in 0..count {
                            let factor = |i: usize| factors.map_or(1.0, |factors| f64::from(factors[i]));
                            let at = |k: usize, i: usize| matrix[k * transducers + i] * unit;
                            let want: Complex64 =
                                (0..transducers).map(|i| at(k, i).conj() * at(l, i) * factor(i)).sum();
                            let [re, im] = product.row(k).map(|row| f64::from(row[l]));
                            // Terms below 8, some two roundings each.
                            let allowed = 15.0 * f64::from(f32::EPSILON) * (transducers + 8) as f64;
                            assert!(
                                (Complex64::new(re, im) - want).norm() <= allowed,
                                "{set} {count} {k} {l}"
                            );
                        }
                        assert!(product.row(k).iter().all(|row| row[count..].iter().all(|&x| x == 0.0)));
                    }
                    product.give(&mut work);
                }
            }
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
