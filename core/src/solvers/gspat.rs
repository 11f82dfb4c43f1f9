//! gspat: Gerchberg-Saxton on the M x M matrix (Plasencia et al., ACM Trans. Graphics 39(4), 2020).
//!
//! Gerchberg-Saxton without the transducers in the loop. With the back-propagation X = G^H / diag(G G^H) the field of X
//! p is R p, where R = G X is M x M, so that a step takes O(M^2). The last step corrects the amplitudes: p = t^2
//! g/|g|^2 for the field g and the targets t. The amplitude is applied once. (The authors of the greedy paper also
//! apply it to X, which has no effect when all are equal.)

use crate::kernels;
use crate::linalg::times;
use crate::propagation::Strips;
use crate::solvers::amplitude_limit::AmplitudeLimit;
use crate::solvers::common::alternating_projection::{back_projected, start_phasors};
use crate::solvers::iterate::{iterate, largest_change, projections};
use crate::solvers::prelude::*;

/// Targets below this part of the reference count as quiet.
const QUIET: f32 = 1e-9;

/// Largest factor by which the last step raises a point: its square stays within f32.
const MOST_LOUDER: f32 = 1e12;

options! {
    /// GS-PAT. Time O(N M^2) once and O(M^2) a step, memory O(N + M^2).
    pub struct Gspat {
        /// Largest number of steps.
        pub steps: u32 = 100,
        /// Ends when no |p| changes by more than this part of its target in a step; 0 takes all steps.
        pub tolerance: f64 = 0.0,
        /// Rule that reduces drives above 1: "clamp", "normalize" or "full".
        pub limit: AmplitudeLimit = AmplitudeLimit::Clamp,
    }
}

impl Method for Gspat {
    const INFO: Info = Info::new(
        "gspat",
        "GS-PAT: Gerchberg-Saxton on the M x M matrix",
        "Plasencia et al., ACM Trans. Graphics 39(4), 2020",
    )
    .with_start()
    .within(1e-3);

    fn check(&self) -> Result<()> {
        check_iteration(self.steps, self.tolerance)
    }
}

impl Solve for Gspat {
    facts!(plays_at_full = false);

    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let (steps, tolerance) = projections(problem, self.steps, self.tolerance);
        let propagation = problem.propagation();
        let (count, lanes) = (propagation.points(), propagation.lanes());
        let mut strips = Strips::new(propagation, work);
        // If f32 would lose the squares of the targets, they are divided by the largest target, and the drive is
        // multiplied by it afterwards.
        let largest = problem.targets().iter().copied().fold(0.0, f32::max);
        let unit = if largest < QUIET { largest } else { 1.0 };
        let mut targets = work.floats.take(lanes);
        targets.iter_mut().zip(problem.targets()).for_each(|(own, target)| *own = target / unit);
        let matrix = strips.gram(None, control)?;
        // 1 / sum_i |G_ji|^2; 0 if it would overflow, because no transducer reaches this quiet point or all reach it
        // too weakly.
        let share = |j: usize| {
            let power = matrix.row(j)[0][j];
            if power >= f32::MIN_POSITIVE { 1.0 / power } else { 0.0 }
        };
        let mut wanted = start_phasors(problem, work, control)?;
        let mut field = Planar::zeros(1, lanes, work);
        let [mut moduli, mut before] = [(); 2].map(|()| work.floats.take(lanes));
        wanted.scale(targets.iter().copied());
        let propagate = |wanted: &mut Planar, field: &mut Planar, moduli: &mut [f32], control: &mut Control| {
            wanted.scale((0..count).map(share));
            times(propagation.instruction_set(), &matrix, wanted, field, control)?;
            kernels::modulus(propagation.instruction_set(), &field.re, &field.im, moduli);
            Ok::<_, Error>(())
        };
        let ended = iterate(
            (steps, tolerance),
            &mut moduli,
            control,
            |moduli, control| {
                before.copy_from_slice(moduli);
                propagate(&mut wanted, &mut field, moduli, control)?;
                for j in 0..count {
                    let scale = if moduli[j] > 0.0 { targets[j] / moduli[j] } else { 0.0 };
                    wanted.re[j] = if scale > 0.0 { field.re[j] * scale } else { targets[j] };
                    wanted.im[j] = field.im[j] * scale;
                }
                Ok(tolerance > 0.0 && largest_change(moduli, &before, &targets) <= tolerance)
            },
            // The residual of the field before the limit.
            |moduli| problem.residual_of(moduli.iter().map(|modulus| f64::from(modulus * unit))),
        )?;
        propagate(&mut wanted, &mut field, &mut moduli, control)?;
        for j in 0..count {
            let scale = if moduli[j] > 0.0 { (targets[j] / moduli[j]).min(MOST_LOUDER) } else { 0.0 };
            wanted.re[j] = field.re[j] * scale * scale * share(j);
            wanted.im[j] = field.im[j] * scale * scale * share(j);
        }
        let ended = (ended, steps as usize);
        back_projected(problem, strips, &wanted, |_| unit, self.limit, ended, work, control)
    }
}
