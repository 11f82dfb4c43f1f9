//! fast: greedy in closed form: computes the phase that a search would find (majorise-minimise).
//!
//! For a point of pressure P and target t, `(t - |P + G q|)^2 <= |t P/|P| - P - G q|^2` for every q, with equality at q
//! = 0. The right side is the squared distance to t P/|P|, the point of the circle |p| = t that is nearest to P. Summed
//! over the points it majorises eq. (7), and its least value over |q| = 1 needs no search:
//!
//! ```text
//! sum_j w_j |d_j - G_ji q|^2 = const - 2 Re(conj(q) sum_j w_j conj(G_ji) d_j),   d_j = t_j P_j/|P_j| - P_j
//! q_i = e^{j arg sum_j w_j conj(G_ji) d_j}
//! ```
//!
//! (majorise-minimise, Hunter and Lange, Am. Statistician 58(1), 2004). While P_j = 0 its phase is taken as 0. One sum
//! over the points replaces L candidates. A transducer changes P by one part in N, so the transducers of a block share
//! the same d, and their sums fill a register. A further sweep updates each transducer again, with a part `OWN` of its
//! own wave removed from P, so that the members of a block do not all rotate at once.

use core::any::Any;

use crate::kernels::closed_form;
use crate::kernels::closed_form::{Memory, Sweep, interleaved_sweep};
use crate::kernels::grid::Phases;
use crate::math::modulus;
use crate::solvers::common::interleaved_batch::InterleavedBatch;
use crate::solvers::prelude::*;
use crate::workspace::Aligned;

/// The part of its old wave that a transducer removes from P in a further sweep. In trials .3 to .5 converged fastest.
const OWN: f32 = 0.4;

options! {
    /// Greedy in closed form, |q| = 1. Time O(N M) a sweep, memory O(N + M).
    pub struct Fast {
        /// Number of transducers that are updated from the same field, 1 to 8.
        pub block: u32 = 8,
        /// Further sweeps over all transducers, 0 to 1000.
        pub sweeps: u32 = 0,
        /// Seed of the order of the updates, 0 to 2^64 - 1.
        pub seed: u64 = 0,
    }
}

impl Method for Fast {
    const INFO: Info = Info::new(
        "fast",
        "greedy in closed form: one sum instead of a search",
        "majorise-minimise on eq. (7) of Suzuki et al. 2021",
    )
    .balanced()
    .within(0.02);

    fn check(&self) -> Result<()> {
        let most = closed_form::MOST as u32;
        refuse_if!(!(1..=most).contains(&self.block), Error::out_of_range("block", self.block, "give 1 to 8"));
        refuse_if!(self.sweeps > 1000, Error::out_of_range("sweeps", self.sweeps, "give 0 to 1000"));
        Ok(())
    }
}

impl Solve for Fast {
    facts!(computes_rows = true);

    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        self.check()?;
        let propagation = problem.propagation();
        let (count, lanes) = (propagation.transducers(), propagation.lanes());
        let mut drive = work.complexes.take(count);
        let mut field = Planar::zeros(1, lanes, work);
        let mut memory = Aligned::take(closed_form::floats(lanes), work);
        let phases = phases(problem);
        let block = self.block as usize;
        let sweeps = 1 + self.sweeps as usize;
        let steps = count.div_ceil(block) * sweeps;
        let (mut status, mut step) = (Status::Done, 0);
        for sweep in 0..sweeps {
            let task = Sweep {
                rows: problem.rows(),
                target: problem.targets(),
                weight: problem.weights(),
                count: propagation.points(),
                block,
                own: if sweep == 0 { 0.0 } else { OWN },
                phases,
                memory: Memory::of(&mut memory),
            };
            let report = |[re, im]: [&[f32]; 2]| {
                step += 1;
                let moduli = re.iter().zip(im).map(|(&re, &im)| modulus(Complex32::new(re, im)));
                control.step(step, steps, || problem.residual_of(moduli.clone())).is_continue()
            };
            let pressures = [&mut field.re[..], &mut field.im[..]];
            if !closed_form::sweep(
                propagation.instruction_set(),
                task,
                stride(count, self.seed),
                &mut drive,
                pressures,
                report,
            ) {
                status = Status::Stopped;
                break;
            }
        }
        let solution = Solution::of_field(problem, drive.into_vec(), &field, status, step, work, control)?;
        Ok(if phases.is_some() { solution.on_grid() } else { solution })
    }

    fn interleaved(&self) -> Option<&dyn Any> {
        Some(self)
    }
}

impl Fast {
    /// Solves several problems of one model at once, or returns `None` if that saves no work.
    pub(super) fn solve_interleaved(&self, problems: &[Problem], work: &mut Workspace) -> Option<Vec<Solution>> {
        self.check().ok()?;
        let mut batch = InterleavedBatch::of(problems, work)?;
        let (count, lanes) = (problems.first()?.propagation().transducers(), batch.target.len());
        let phases = problems.first().and_then(phases);
        let mut memory = work.floats.take(closed_form::floats(lanes));
        for sweep in 0..=self.sweeps {
            let task = Sweep {
                rows: batch.points.rows(),
                target: &batch.target,
                weight: &batch.weight,
                count: lanes,
                block: self.block as usize,
                own: if sweep == 0 { 0.0 } else { OWN },
                phases,
                memory: Memory::of(&mut memory),
            };
            let [re, im] = &mut batch.pressures;
            let order = stride(count, self.seed);
            interleaved_sweep::sweep(batch.points.set, task, order, &mut batch.drives, [re, im]);
        }
        let steps = count.div_ceil(self.block as usize) * (1 + self.sweeps as usize);
        let mut solutions = batch.solutions(problems, steps, work)?;
        if phases.is_some() {
            solutions = solutions.into_iter().map(Solution::on_grid).collect();
        }
        Some(solutions)
    }
}

/// Returns the phases that the board can play; `None` if it can play any phase.
fn phases(problem: &Problem) -> Option<&Phases> {
    problem.quantization()?.grid().phases.as_ref()
}

/// Iterates over 0..count in strides near the golden section, from an index that the seed gives. Successive transducers
/// are far apart on the board, as after a shuffle, at no cost.
fn stride(count: usize, seed: u64) -> impl Iterator<Item = usize> {
    let golden = (count as f64 * 0.618_033_988_749_895) as usize;
    let step = (golden.max(1)..=golden.max(1) + count).find(|&step| coprime(step, count)).unwrap_or(1) % count;
    let start = (Rng::new(seed).uniform() * count as f64) as usize;
    (0..count).scan(start, move |at, _| {
        let i = *at;
        *at += step;
        *at -= if *at >= count { count } else { 0 };
        Some(i)
    })
}

fn coprime(mut a: usize, mut b: usize) -> bool {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

#[cfg(test)]
#[path = "tests/fast.rs"]
mod tests;
