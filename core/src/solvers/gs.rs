//! gs: Gerchberg-Saxton, iterative back-propagation (Marzo and Drinkwater, PNAS 116(1), 2019).
//!
//! It begins with q = 1. A step computes p = G q, keeps its phases and sets its moduli to the targets, then computes q
//! = G^H p, keeps its phases and sets its moduli to 1. The paper's authors start from q = 1, too; starting from the
//! back-projection changes sigma by .007.

use crate::solvers::common::alternating_projection::Projector;
use crate::solvers::iterate::{iterate, largest_change, projections};
use crate::solvers::prelude::*;

options! {
    /// Gerchberg-Saxton. Time O(N M) a step, memory O(N M).
    pub struct Gs {
        /// Largest number of steps.
        pub steps: u32 = 100,
        /// Ends when no |p| changes by more than this part of its target in a step; 0 takes all steps.
        pub tolerance: f64 = 0.0,
    }
}

impl Method for Gs {
    const INFO: Info = Info::new("gs", "Gerchberg-Saxton, |q| = 1", "Marzo and Drinkwater, PNAS 116(1), 2019")
        .with_start()
        .within(1e-3);

    fn check(&self) -> Result<()> {
        check_iteration(self.steps, self.tolerance)
    }
}

impl Solve for Gs {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let (steps, tolerance) = projections(problem, self.steps, self.tolerance);
        let rows = Rows::new(problem, work, control)?;
        let mut projector = Projector::new(&rows, work);
        let targets = problem.targets();
        let mut wave = projector.begin(problem, &rows, work, control)?;
        let [mut moduli, mut before] = [(); 2].map(|()| work.floats.take(rows.count));
        // Only ratios matter: in units of the largest target no square under- or overflows.
        moduli.iter_mut().zip(targets).for_each(|(modulus, target)| *modulus = target / rows.target);
        let ended = iterate(
            (steps, tolerance),
            &mut wave,
            control,
            |wave, _| {
                projector.want(wave, &moduli);
                before.copy_from_slice(&wave.moduli);
                projector.project(&rows, wave);
                Ok(tolerance > 0.0 && largest_change(&wave.moduli, &before, targets) <= tolerance)
            },
            |wave| problem.residual(&wave.moduli),
        )?;
        wave.solution(problem, ended, steps as usize, work, control)
    }
}
