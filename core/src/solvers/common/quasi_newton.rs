//! Quasi-Newton directions with limited memory (L-BFGS; Nocedal and Wright 2006, algorithm 7.4).

use crate::solvers::prelude::*;

/// Number of steps stored; in trials 10 to 30 gave the same results.
const MEMORY: usize = 16;

/// A step is stored if the curvature along it is at least this, relative to its length and to the change of the
/// gradient.
const LEAST_CURVATURE: f64 = 1e-8;

/// The last steps and changes of the gradient, the latest last.
pub(crate) struct QuasiNewton<'w> {
    pairs: [Option<Pair<'w>>; MEMORY],
    count: usize,
    pub(crate) work: &'w Workspace,
}

struct Pair<'w> {
    step: Buffer<'w, f32>,
    change: Buffer<'w, f32>,
    /// 1/(step . change).
    inverse: f64,
}

/// Returns the inner product in double precision.
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f64 {
    // The four sums are independent, so the processor adds them at once.
    let mut sums = [0.0; 4];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += f64::from(*a) * f64::from(*b);
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// b += factor a.
fn add(factor: f64, a: &[f32], b: &mut [f32]) {
    for (b, &a) in b.iter_mut().zip(a) {
        *b += factor as f32 * a;
    }
}

impl<'w> QuasiNewton<'w> {
    pub(crate) fn new(work: &'w Workspace) -> Self {
        Self { pairs: [const { None }; MEMORY], count: 0, work }
    }

    /// Returns whether no step is stored.
    pub(crate) fn knows_nothing(&self) -> bool {
        self.count == 0
    }

    /// Removes all steps; returns whether there were any.
    pub(crate) fn forget(&mut self) -> bool {
        core::mem::take(&mut self.count) > 0
    }

    /// Stores a step and the change of the gradient by it, if the curvature along the step is at least
    /// [`LEAST_CURVATURE`].
    pub(crate) fn remember(&mut self, step: &[f32], change: &[f32]) {
        let (curvature, square) = (dot(step, change), dot(change, change));
        if curvature <= LEAST_CURVATURE * (square * dot(step, step)).max(f64::MIN_POSITIVE) {
            return;
        }
        let copy = |list: &[f32]| {
            let mut own = self.work.floats.take_any(list.len());
            own.copy_from_slice(list);
            own
        };
        let pair = Pair { step: copy(step), change: copy(change), inverse: 1.0 / curvature };
        if self.count == MEMORY {
            self.pairs.rotate_left(1);
            self.count -= 1;
        }
        self.pairs[self.count] = Some(pair);
        self.count += 1;
    }

    /// Iterates over the stored steps, the latest last.
    fn known(&self) -> impl DoubleEndedIterator<Item = &Pair<'w>> {
        self.pairs[..self.count].iter().flatten()
    }

    /// Replaces a gradient g by -H g, H the inverse curvature from the stored steps; by -g if there are none.
    pub(crate) fn descend(&self, gradient: &mut [f32]) {
        let mut shares = [0.0; MEMORY];
        for (share, pair) in shares.iter_mut().zip(self.known().rev()) {
            *share = pair.inverse * dot(&pair.step, gradient);
            add(-*share, &pair.change, gradient);
        }
        let scale = self.known().next_back().map_or(1.0, |pair| 1.0 / (pair.inverse * dot(&pair.change, &pair.change)));
        for g in &mut *gradient {
            *g *= -scale as f32;
        }
        for (share, pair) in shares[..self.count].iter().rev().zip(self.known()) {
            let back = pair.inverse * dot(&pair.change, gradient);
            // The gradient has been negated above, so this share is negated, too.
            add(-share - back, &pair.step, gradient);
        }
    }
}

#[cfg(test)]
#[path = "tests/quasi_newton.rs"]
mod tests;
