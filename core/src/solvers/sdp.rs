//! sdp: semidefinite relaxation by block coordinate descent (Inoue et al., World Haptics 2015).
//!
//! The pseudo-inverse G^+ gives drives for points of unit phasors u and targets t. The phases that it meets best
//! minimise u^H Q u with Q = T (I - G G^+) T, T = diag(t). With G^+ = G^H (G G^H + alpha I)^-1 (singular values s/(s^2 +
//! alpha)) that is Q = alpha T (G G^H + alpha I)^-1 T. The relaxed problem is X = u u^H with X_jj = 1, X >= 0. It is
//! solved by one random column after another (Waldspurger, d'Aspremont and Mallat, Math. Programming 149, 2015): with m
//! the column of Q without its diagonal, x = X m and g = x^H m, the column becomes -sqrt(lambda/g) x, or 0. The leading
//! eigenvector of X is u, with its raw moduli (as in the paper, which loses points) or with moduli 1.

use crate::kernels;
use crate::linalg::{Hermitian, leading_eigenvector, times};
use crate::propagation::Strips;
use crate::scene::words;
use crate::solvers::amplitude_limit::AmplitudeLimit;
use crate::solvers::common::alternating_projection::{back_projected, start_phasors};
use crate::solvers::iterate::iterate;
use crate::solvers::prelude::*;

/// The moduli of the relaxation's eigenvector that the solution uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moduli {
    /// The eigenvector's own moduli, as in the paper. Points with a small modulus are lost.
    Raw,
    /// 1 for every point.
    Unit,
}

words!(Moduli: "raw" = Self::Raw, "unit" = Self::Unit);

options! {
    /// SDP relaxation by block coordinate descent. Time O(N M^2 + M^3) once and O(M^2) a step, memory O(N + M^2).
    pub struct Sdp {
        /// Largest number of random columns that are updated.
        pub steps: u32 = 1000,
        /// Ends when no update of a column changes an entry of X by more than this; 0 takes all steps. The descent
        /// comes to rest only with lambda near 1, not with 0.9.
        pub tolerance: f64 = 0.0,
        /// Factor lambda in the update of a column, above 0 and below 1.
        pub lambda: f64 = 0.9,
        /// Damping of the pseudo-inverse in units of 1/mm^2 (at P0 = 1e-3 Pa m), above 0.
        pub alpha: f64 = 1e-3,
        /// Moduli of the eigenvector: "raw" (the paper's) or "unit".
        pub moduli: Moduli = Moduli::Raw,
        /// Seed of the order of the columns, 0 to 2^64 - 1.
        pub seed: u64 = 0,
        /// Rule that reduces drives above 1: "clamp", "normalize" or "full".
        pub limit: AmplitudeLimit = AmplitudeLimit::Normalize,
    }
}

impl Method for Sdp {
    const INFO: Info = Info::new(
        "sdp",
        "SDP relaxation of the point phases, then the pseudo-inverse",
        "Inoue et al., World Haptics Conference 2015",
    )
    .with_start()
    .within(0.02);

    fn check(&self) -> Result<()> {
        check_iteration(self.steps, self.tolerance)?;
        real("alpha", self.alpha, 0.0, true)?;
        real("lambda", self.lambda, 0.0, true)?;
        refuse_if!(self.lambda >= 1.0, Error::out_of_range("lambda", self.lambda, "give a number above 0 and below 1"));
        Ok(())
    }
}

impl Solve for Sdp {
    facts!(plays_at_full = false);

    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let propagation = problem.propagation();
        let (count, lanes) = (propagation.points(), propagation.lanes());
        let mut strips = Strips::new(propagation, work);
        let product = strips.gram(None, control)?;
        let largest = product.diagonal().fold(0.0, f32::max);
        // Damping by less than 1e-6 of the diagonal would be lost in the rounding of f32.
        let shift = (self.alpha as f32).max(1e-6 * largest);
        let inverse = Hermitian::damped(propagation.instruction_set(), &product, count, shift, work, control)?;
        let quality = quality(problem, &inverse, work, control)?;
        let mut relaxed = begin(problem, work, control)?;
        let [mut column, mut image] = [(); 2].map(|()| Planar::zeros(1, lanes, work));
        let mut rng = Rng::new(self.seed);
        // Marks of the columns that were visited without an effect since the last change.
        let mut still = work.floats.take(count);
        let ended = iterate(
            (self.steps, self.tolerance),
            &mut relaxed,
            control,
            |relaxed, control| {
                let chosen = rng.below(count as u64) as usize;
                let [re, im] = quality.row(chosen);
                // Rows are stored conjugated, so the stored row of a Hermitian matrix is its column.
                column.re.copy_from_slice(re);
                column.im.copy_from_slice(im);
                (column.re[chosen], column.im[chosen]) = (0.0, 0.0);
                times(propagation.instruction_set(), relaxed, &column, &mut image, control)?;
                let [gain, _] = kernels::correlate(propagation.instruction_set(), image.row(0), column.row(0), count);
                let scale = if gain > 0.0 { -sqrt(self.lambda / f64::from(gain)) as f32 } else { 0.0 };
                let change = replace(relaxed, chosen, &image, scale, count);
                if change > self.tolerance as f32 {
                    still.fill(0.0);
                }
                still[chosen] = 1.0;
                Ok(self.tolerance > 0.0 && still.iter().all(|&mark| mark > 0.0))
            },
            |relaxed| relaxation(propagation.instruction_set(), relaxed, &quality, count),
        )?;
        let mut phasors = Planar::zeros(1, lanes, work);
        phasors.re[..count].fill(1.0);
        leading_eigenvector(propagation.instruction_set(), &relaxed, &mut phasors, count, work, control)?;
        for (j, &target) in problem.targets().iter().enumerate().take(count) {
            let modulus = sqrtf(phasors.re[j] * phasors.re[j] + phasors.im[j] * phasors.im[j]);
            let factor = match self.moduli {
                Moduli::Raw => target * sqrtf(count as f32),
                Moduli::Unit if modulus > 0.0 => target / modulus,
                Moduli::Unit => 0.0,
            };
            phasors.re[j] *= factor;
            phasors.im[j] *= factor;
        }
        inverse.solve(&mut phasors);
        let ended = (ended, self.steps as usize);
        back_projected(problem, strips, &phasors, |_| 1.0, self.limit, ended, work, control)
    }
}

/// Returns conj(Q)/alpha = conj(T (G G^H + alpha I)^-1 T), computed from one column of the inverse after another.
fn quality<'w>(
    problem: &Problem,
    inverse: &Hermitian,
    work: &'w Workspace,
    control: &mut Control,
) -> Result<Planar<'w>> {
    let (count, lanes) = (problem.propagation().points(), problem.propagation().lanes());
    let mut matrix = Planar::zeros(count, lanes, work);
    let mut column = Planar::zeros(1, lanes, work);
    let targets = problem.targets();
    for k in 0..count {
        control.pulse()?;
        column.re.fill(0.0);
        column.im.fill(0.0);
        column.re[k] = targets[k];
        inverse.solve(&mut column);
        // Column k of a Hermitian matrix is its conjugated row k.
        let [re, im] = matrix.row_mut(k);
        for l in 0..count {
            re[l] = targets[l] * column.re[l];
            im[l] = targets[l] * column.im[l];
        }
    }
    Ok(matrix)
}

/// Returns X = I, or the mean of I and u u^H for the phasors u of a start.
fn begin<'w>(problem: &Problem, work: &'w Workspace, control: &mut Control) -> Result<Planar<'w>> {
    let (count, lanes) = (problem.propagation().points(), problem.propagation().lanes());
    let mut matrix = Planar::zeros(count, lanes, work);
    let given = problem.has_start();
    let phasors = start_phasors(problem, work, control)?;
    for k in 0..count {
        let (uk, vk) = (phasors.re[k], phasors.im[k]);
        let [re, im] = matrix.row_mut(k);
        if given {
            for l in 0..count {
                re[l] = 0.5 * (phasors.re[l] * uk + phasors.im[l] * vk);
                im[l] = 0.5 * (phasors.im[l] * uk - phasors.re[l] * vk);
            }
        }
        (re[k], im[k]) = (1.0, 0.0);
    }
    Ok(matrix)
}

/// Writes `scale` times `image` to row and column `chosen`; returns the largest change of an entry.
fn replace(matrix: &mut Planar, chosen: usize, image: &Planar, scale: f32, count: usize) -> f32 {
    let mut change = 0.0_f32;
    for k in (0..count).filter(|&k| k != chosen) {
        let (re, im) = (scale * image.re[k], scale * image.im[k]);
        let [row_re, row_im] = matrix.row_mut(k);
        change = change.max((row_re[chosen] - re).abs()).max((row_im[chosen] + im).abs());
        (row_re[chosen], row_im[chosen]) = (re, -im);
        let [row_re, row_im] = matrix.row_mut(chosen);
        (row_re[k], row_im[k]) = (re, im);
    }
    change
}

/// Returns trace(Q X) relative to trace(Q). The descent lowers it, and reports it as its residual.
fn relaxation(set: InstructionSet, relaxed: &Planar, quality: &Planar, count: usize) -> f64 {
    let (mut sum, mut trace) = (0.0, 0.0);
    for k in 0..count {
        let [re, _] = kernels::correlate(set, quality.row(k), relaxed.row(k), count);
        sum += f64::from(re);
        trace += f64::from(quality.row(k)[0][k]);
    }
    sum / trace
}
