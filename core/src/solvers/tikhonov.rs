//! tikhonov: regularised pseudo-inverse for targets with phases; phase 0 where they have none.
//!
//! q = G^H (G G^H + mu I)^-1 p is the M x M dual of least squares, damped by mu = regularization * mean diag(G G^H),
//! with p the targets. Weights multiply rows of G and p by their square roots. If the phases at the points are free, 0
//! is a poor choice; the paper's methods differ in how they choose better ones.

use crate::linalg::Hermitian;
use crate::propagation::Strips;
use crate::solvers::amplitude_limit::AmplitudeLimit;
use crate::solvers::common::alternating_projection::back_projected;
use crate::solvers::prelude::*;

options! {
    /// Tikhonov-regularised pseudo-inverse. Time O(N M^2 + M^3), memory O(N + M^2).
    pub struct Tikhonov {
        /// Damping relative to the mean of diag(G G^H), above 0.
        pub regularization: f64 = 0.07,
        /// Rule that reduces drives above 1: "clamp", "normalize" or "full".
        pub limit: AmplitudeLimit = AmplitudeLimit::Clamp,
    }
}

impl Method for Tikhonov {
    const INFO: Info = Info::new(
        "tikhonov",
        "regularised pseudo-inverse, target phases 0 unless given",
        "Tikhonov's regularisation of G q = p",
    )
    .within(1e-3);

    fn check(&self) -> Result<()> {
        real("regularization", self.regularization, 0.0, true).map(|_| ())
    }
}

impl Solve for Tikhonov {
    facts!(plays_at_full = false, uses_phases = true);

    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let propagation = problem.propagation();
        let count = propagation.points();
        let mut strips = Strips::new(propagation, work);
        let mut matrix = strips.gram(None, control)?;
        // Weighted least squares: rows of G and p times the square root of the weight.
        let mut trace = 0.0;
        for k in 0..count {
            for l in 0..count {
                let weight = sqrtf(problem.weights()[k] * problem.weights()[l]);
                let [re, im] = matrix.row_mut(k);
                re[l] *= weight;
                im[l] *= weight;
            }
            trace += matrix.row(k)[0][k];
        }
        // The rounding of G G^H in f32 is a lower bound of the damping.
        let shift = (self.regularization as f32).max(1e-6) * trace / count as f32;
        let solver = Hermitian::damped(propagation.instruction_set(), &matrix, count, shift, work, control)?;
        let mut phasors = Planar::zeros(1, propagation.lanes(), work);
        for (k, target) in problem.complex_targets().enumerate() {
            let root = sqrtf(problem.weights()[k]);
            (phasors.re[k], phasors.im[k]) = (root * target.re as f32, root * target.im as f32);
        }
        solver.solve(&mut phasors);
        phasors.scale((0..count).map(|k| sqrtf(problem.weights()[k])));
        back_projected(problem, strips, &phasors, |_| 1.0, self.limit, ((Status::Done, 1), 1), work, control)
    }
}
