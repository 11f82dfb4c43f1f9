//! naive: superposed single foci.
//!
//! q_i = `sum_j conj(G_ji) p_j / sum_i |G_ji|^2`: every point is focused on as if it were the only one, at the
//! amplitude and phase that would give it its pressure (phase 0 where targets have none); what the foci do to each other
//! is left to chance. The baseline that every method has to beat (the back-projection with which Marzo et al. 2019 and
//! others start).

use crate::control::Control;
use crate::error::Error;
use crate::kernels;
use crate::problem::{Problem, Solution, Status};
use crate::solvers::amplitude_limit::AmplitudeLimit;
use crate::solvers::method::{Info, Method, Solve};
use crate::workspace::Workspace;

use num_complex::Complex32;

options! {
    /// The sum of single foci. Time O(N M), memory O(N + M).
    pub struct Naive {
        /// How a sum above full drive is brought back: "clamp", "normalize" or "full".
        pub limit: AmplitudeLimit = AmplitudeLimit::Clamp,
    }
}

impl Method for Naive {
    const INFO: Info = Info::new("naive", "single foci, superposed", "back-projection, e.g. Marzo et al., PNAS 2019");

    fn check(&self) -> Result<(), Error> {
        Ok(())
    }
}

impl Solve for Naive {
    fn plays_at_full(&self) -> bool {
        false
    }

    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution, Error> {
        let propagation = problem.propagation();
        let count = propagation.points();
        let mut buffers = [(); 4].map(|()| work.floats.take(propagation.lanes()));
        let [re, im, share, imag] = &mut buffers;
        for i in 0..propagation.transducers() {
            control.pulse()?;
            propagation.row(i, re, im);
            kernels::squares(propagation.instruction_set(), [re, im], count, share);
        }
        for ((share, imag), target) in share.iter_mut().zip(imag.iter_mut()).zip(problem.complex_targets()) {
            // A quiet point and one out of reach have no focus.
            let inverse = |part: f64| if *share > 0.0 { part as f32 / *share } else { 0.0 };
            (*share, *imag) = (inverse(target.re), inverse(target.im));
        }
        let mut drive = work.complexes.take(propagation.transducers());
        for (i, q) in drive.iter_mut().enumerate() {
            control.pulse()?;
            propagation.row(i, re, im);
            let [sum_re, sum_im] = kernels::correlate(propagation.instruction_set(), [re, im], [share, imag], count);
            *q = Complex32::new(sum_re, sum_im);
        }
        self.limit.apply(&mut drive);
        Solution::new(problem, drive.into_vec(), (Status::Done, 1), 1, work, control)
    }

    fn uses_phases(&self) -> bool {
        true
    }
}
