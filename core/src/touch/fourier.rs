//! Discrete Fourier transforms, in place, of lists whose length n is a power of two.

use crate::prelude::*;

/// Constants of the transforms of lists of one length n.
#[derive(Debug)]
pub(crate) struct Fourier {
    /// e^{-2 pi j k/n} for k < n/2.
    roots: Vec<Complex64>,
}

impl Fourier {
    /// Creates the constants for lists of `length` numbers, a power of two.
    pub(crate) fn new(length: usize) -> Self {
        debug_assert!(length.is_power_of_two());
        let root = |k| math::phasor(-TAU * k as f64 / length as f64);
        Self { roots: (0..length / 2).map(root).collect() }
    }

    /// Replaces x by X_k = sum_i x_i e^{-2 pi j i k/n}.
    pub(crate) fn forward(&self, line: &mut [Complex64]) {
        let length = line.len();
        for k in 1..length {
            let mirrored = k.reverse_bits() >> (usize::BITS - length.trailing_zeros());
            if k < mirrored {
                line.swap(k, mirrored);
            }
        }
        let mut half = 1;
        while half < length {
            for block in line.chunks_exact_mut(2 * half) {
                let (even, odd) = block.split_at_mut(half);
                let roots = self.roots.iter().step_by(length / (2 * half));
                for ((a, b), root) in even.iter_mut().zip(odd).zip(roots) {
                    let turned = *b * root;
                    (*a, *b) = (*a + turned, *a - turned);
                }
            }
            half *= 2;
        }
    }

    /// Replaces X by n x, where X is the result of [`Fourier::forward`] for x.
    pub(crate) fn backward(&self, line: &mut [Complex64]) {
        self.forward(line);
        line[1..].reverse();
    }
}

#[cfg(test)]
#[path = "tests/fourier.rs"]
mod tests;
