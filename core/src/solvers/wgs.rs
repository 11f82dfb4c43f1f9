//! wgs: weighted Gerchberg-Saxton, damped, best iterate kept (Di Leonardo et al. 2007).
//!
//! The weights are those of Di Leonardo, Ianni and Ruocco (Optics Express 15(4), 2007), but with a damped exponent:
//! with the full ratio two points alternate. The solution is the iterate whose worst point is best.

use crate::solvers::common::alternating_projection::Projector;
use crate::solvers::iterate::{iterate, projections};
use crate::solvers::prelude::*;

options! {
    /// Weighted Gerchberg-Saxton, damped. Time O(N M) a step, memory O(N M).
    pub struct Wgs {
        /// Largest number of steps.
        pub steps: u32 = 100,
        /// Ends when 1 - uniformity is at most this; 0 takes all steps.
        pub tolerance: f64 = 0.0,
    }
}

impl Method for Wgs {
    const INFO: Info = Info::new(
        "wgs",
        "weighted Gerchberg-Saxton, damped, |q| = 1, best iterate kept",
        "Di Leonardo et al., Optics Express 15(4), 2007",
    )
    .balanced()
    .with_start()
    .within(5e-3);

    fn check(&self) -> Result<()> {
        check_iteration(self.steps, self.tolerance)
    }
}

/// Returns the least, the mean and the largest |p|/target over the points with a target.
fn spread(moduli: &[f32], targets: &[f32]) -> (f32, f32, f32) {
    let (mut low, mut sum, mut high, mut count) = (f32::INFINITY, 0.0, 0.0_f32, 0.0);
    for (&modulus, &target) in moduli.iter().zip(targets).filter(|(_, target)| **target > 0.0) {
        let x = modulus / target;
        (low, sum, high, count) = (low.min(x), sum + x, high.max(x), count + 1.0);
    }
    (low, sum / count, high)
}

/// Multiplies the requested modulus of each point by the square root of (mean |p|/target) over its |p|/target, at most
/// 2.
fn raise(raised: &mut [f32], moduli: &[f32], targets: &[f32], mean: f32) {
    if mean > 0.0 {
        for ((raised, &modulus), &target) in raised.iter_mut().zip(moduli).zip(targets) {
            // A quiet point stays at 0.
            *raised *= sqrtf((mean * target / modulus.max(f32::MIN_POSITIVE)).min(4.0));
        }
    }
    // Only ratios matter: the largest is scaled to 1.
    let largest = raised.iter().copied().fold(0.0, f32::max);
    for x in raised {
        *x /= largest;
    }
}

impl Solve for Wgs {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let (steps, tolerance) = projections(problem, self.steps, self.tolerance);
        let rows = Rows::new(problem, work, control)?;
        let mut projector = Projector::new(&rows, work);
        let targets = problem.targets();
        let mut wave = projector.begin(problem, &rows, work, control)?;
        let mut raised = work.floats.take(rows.count);
        raised.iter_mut().zip(targets).for_each(|(raised, target)| *raised = target / rows.target);
        // The start is the first candidate, so the solution is never worse than the start.
        let mut best = Wave::new(&rows, work);
        best.copy(&wave);
        let mut worst = spread(&best.moduli, targets).0;
        let ended = iterate(
            (steps, tolerance),
            &mut best,
            control,
            |best, _| {
                projector.want(&wave, &raised);
                projector.project(&rows, &mut wave);
                let (low, mean, high) = spread(&wave.moduli, targets);
                if low > worst {
                    worst = low;
                    best.copy(&wave);
                }
                raise(&mut raised, &wave.moduli, targets, mean);
                Ok(tolerance > 0.0 && f64::from(1.0 - low / high) <= tolerance)
            },
            |best| problem.residual(&best.moduli),
        )?;
        best.solution(problem, ended, steps as usize, work, control)
    }
}
