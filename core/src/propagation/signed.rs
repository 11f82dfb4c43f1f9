//! Signed: G under a signature, kept as a matrix, of an array and points that are known.

use alloc::format;
use alloc::sync::Arc;
use alloc::vec::Vec;

use num_complex::Complex64;

use crate::error::Error;
use crate::propagation::sources::Sources;
use crate::scene::Signature;

/// Entries of G that are kept at most: a tenth of a second's work, and a few MB.
const MOST_ENTRIES: usize = 1 << 20;

/// What such a matrix is made of.
#[derive(Clone, Debug)]
pub(crate) struct Signed {
    pub(crate) sources: Arc<Sources>,
    pub(crate) points: Arc<[[f64; 3]]>,
    pub(crate) signature: Signature,
}

impl PartialEq for Signed {
    fn eq(&self, other: &Self) -> bool {
        let same = self.sources.array == other.sources.array && self.sources.medium == other.sources.medium;
        same && self.points == other.points && self.signature == other.signature
    }
}

impl Signed {
    /// Refuses factors that do not fit, and more entries than are kept.
    pub(crate) fn new(sources: Arc<Sources>, points: Arc<[[f64; 3]]>, signature: Signature) -> Result<Self, Error> {
        let transducers = sources.array.len();
        signature.check(transducers, points.len())?;
        if transducers.saturating_mul(points.len()) > MOST_ENTRIES {
            let cure = format!("with a signature G is kept: give at most {}", (MOST_ENTRIES / transducers).max(1));
            return Err(Error::invalid("points", format!("{} of them", points.len()), cure));
        }
        Ok(Self { sources, points, signature })
    }

    /// G s (N, M) in Pa, transducer by transducer.
    pub(crate) fn matrix(&self) -> Arc<[Complex64]> {
        let (transducers, points) = (self.sources.array.len(), self.points.len());
        let mut matrix = alloc::vec![Complex64::ZERO; transducers * points];
        for (j, &point) in self.points.iter().enumerate() {
            let row: Vec<Complex64> = (0..transducers).map(|i| self.sources.exact(i, point)).collect();
            let reach: Vec<f64> = row.iter().map(|g| g.norm()).collect();
            let factors = self.signature.factors(&self.sources.array, j, point, &reach);
            for (i, (g, s)) in row.iter().zip(factors).enumerate() {
                matrix[i * points + j] = g * s;
            }
        }
        matrix.into()
    }

    /// The same at some of the points, whose matrix is known.
    pub(crate) fn select(&self, chosen: &[usize]) -> Self {
        Self { points: chosen.iter().map(|&j| self.points[j]).collect(), ..self.clone() }
    }
}
