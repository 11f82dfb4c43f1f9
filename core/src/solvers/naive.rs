//! naive: superposed single foci.
//!
//! q_i = `sum_j conj(G_ji) p_j / sum_i |G_ji|^2`: every point gets the focus that would give it its pressure if it were
//! the only point (phase 0 where targets have no phases). The method ignores the effect of the foci on each other. It
//! is the baseline for all other methods (the back-projection with which Marzo et al. 2019 and others start).

use crate::propagation::Strips;
use crate::solvers::amplitude_limit::AmplitudeLimit;
use crate::solvers::common::alternating_projection::back_projected;
use crate::solvers::prelude::*;

options! {
    /// The sum of single foci. Time O(N M), memory O(N + M).
    pub struct Naive {
        /// Rule that reduces drives above 1: "clamp", "normalize" or "full".
        pub limit: AmplitudeLimit = AmplitudeLimit::Clamp,
    }
}

impl Method for Naive {
    const INFO: Info = Info::new("naive", "single foci, superposed", "back-projection, e.g. Marzo et al., PNAS 2019");

    fn check(&self) -> Result<()> {
        Ok(())
    }
}

impl Solve for Naive {
    facts!(plays_at_full = false, uses_phases = true);

    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let propagation = problem.propagation();
        let mut strips = Strips::new(propagation, work);
        let powers = strips.powers(control)?;
        let mut wanted = Planar::zeros(1, propagation.lanes(), work);
        for (j, (target, &power)) in problem.complex_targets().zip(&powers).enumerate() {
            // Quiet points, and points that no transducer reaches, have no focus.
            let share = |part: f64| if power > 0.0 { part as f32 / power } else { 0.0 };
            (wanted.re[j], wanted.im[j]) = (share(target.re), share(target.im));
        }
        back_projected(problem, strips, &wanted, |_| 1.0, self.limit, ((Status::Done, 1), 1), work, control)
    }
}
