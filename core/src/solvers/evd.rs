//! evd: phases of the leading eigenvector, then a regularised solve (Long et al., ACM Trans. Graphics 33(6), 2014).
//!
//! The matrix R has entries R_kj: the field at point k of a focus of target t_j at point j. The phases of its leading
//! eigenvector are those at which the points support each other. They become the phases of p. Then (G^H G + diag(w^2))
//! q = G^H p is solved for the drive q, w_i = sqrt(mean_j t_j |G_ji|)^gamma. Here its M x M dual is used: q = W^-2 G^H
//! (G W^-2 G^H + I)^-1 p. gamma is an exponent, 1 in the paper. The authors of the greedy paper read a row of the
//! eigenvectors' matrix and rescale q by a mean below 1; this method uses the eigenvector, unscaled.

use crate::linalg::{Hermitian, leading_eigenvector};
use crate::math::{pow, unit};
use crate::propagation::Strips;
use crate::solvers::amplitude_limit::AmplitudeLimit;
use crate::solvers::common::alternating_projection::back_projected;
use crate::solvers::prelude::*;

options! {
    /// Leading eigenvector and Long's regularisation. Time O(N M^2 + M^3), memory O(N + M^2).
    pub struct Evd {
        /// Exponent of Long's regularising weights, 0 to 10.
        pub gamma: f64 = 1.0,
        /// Rule that reduces drives above 1: "clamp", "normalize" or "full".
        pub limit: AmplitudeLimit = AmplitudeLimit::Clamp,
    }
}

/// Upper bound of 1 / w_i^2, with which products with |G|^2 stay within f32.
const MOST_EASE: f64 = 1e18;

impl Method for Evd {
    const INFO: Info = Info::new(
        "evd",
        "leading eigenvector's phases, then a regularised solve",
        "Long et al., ACM Trans. Graphics 33(6), 2014",
    )
    .within(1e-2);

    fn check(&self) -> Result<()> {
        real("gamma", self.gamma, 0.0, false)?;
        refuse_if!(self.gamma > 10.0, Error::out_of_range("gamma", self.gamma, "give 0 to 10"));
        Ok(())
    }
}

impl Solve for Evd {
    facts!(plays_at_full = false);

    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let propagation = problem.propagation();
        let (count, targets) = (propagation.points(), problem.targets());
        let mut strips = Strips::new(propagation, work);
        let mut phasors = phases(problem, &mut strips, work, control)?;
        phasors.scale(targets.iter().copied());
        // 1 / w_i^2 = (mean_j t_j |G_ji|)^-gamma; 0 for a transducer without effect.
        let mut inverse = strips.moduli(targets, control)?;
        for inverse in &mut inverse {
            let mean = f64::from(*inverse) / count as f64;
            let ease = if self.gamma == 1.0 { 1.0 / mean } else { pow(mean, -self.gamma) };
            *inverse = if mean > 0.0 { ease.min(MOST_EASE) as f32 } else { 0.0 };
        }
        let matrix = strips.gram(Some(&inverse), control)?;
        // Damping by less than 1e-6 of the diagonal would be lost in the rounding of f32.
        let largest = matrix.diagonal().fold(0.0, f32::max);
        let shift = f32::max(1.0, 1e-6 * largest);
        let solver = Hermitian::damped(propagation.instruction_set(), &matrix, count, shift, work, control)?;
        solver.solve(&mut phasors);
        back_projected(problem, strips, &phasors, |i| inverse[i], self.limit, ((Status::Done, 1), 1), work, control)
    }
}

/// Returns the unit phasors of R's leading eigenvector; 1 where it is 0.
///
/// R = G G^H D with D = diag(t_j / sum_i |G_ji|^2) is similar to the Hermitian D^1/2 G G^H D^1/2, whose eigenvectors
/// have the same phases.
fn phases<'w>(
    problem: &Problem,
    strips: &mut Strips<'w>,
    work: &'w Workspace,
    control: &mut Control,
) -> Result<Planar<'w>> {
    let propagation = problem.propagation();
    let count = propagation.points();
    let mut matrix = strips.gram(None, control)?;
    let mut root = work.floats.take(propagation.lanes());
    for ((root, power), target) in root.iter_mut().zip(matrix.diagonal()).zip(problem.targets()) {
        *root = if power > 0.0 { sqrtf(target / power) } else { 0.0 };
    }
    for k in 0..count {
        let [re, im] = matrix.row_mut(k);
        for l in 0..count {
            re[l] *= root[k] * root[l];
            im[l] *= root[k] * root[l];
        }
    }
    let mut vector = Planar::zeros(1, propagation.lanes(), work);
    for j in 0..count {
        vector.re[j] = if root[j] > 0.0 { 1.0 } else { 0.0 };
    }
    leading_eigenvector(propagation.instruction_set(), &matrix, &mut vector, count, work, control)?;
    for j in 0..count {
        (vector.re[j], vector.im[j]) = unit(vector.re[j], vector.im[j]);
    }
    Ok(vector)
}
