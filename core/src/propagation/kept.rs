//! Kept: G that no kernel computes, behind obstacles or under a signature: a matrix, of an array and points that are known.

use alloc::format;
use alloc::sync::Arc;
use alloc::vec::Vec;

use num_complex::Complex64;

use crate::control::Control;
use crate::error::Error;
use crate::propagation::scattering::Scattering;
use crate::propagation::sources::Sources;
use crate::propagation::stiffness::Stiffness;
use crate::scene::Signature;

/// Entries of G that are kept at most: a tenth of a second's work, and a few MB. Of more than eight waves each fewer.
const MOST_ENTRIES: usize = 1 << 20;

/// What is made of it: values, so that a program without obstacles and signatures is not linked with them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Make {
    /// [`Kept::matrix`]
    pub(crate) matrix: fn(&Kept) -> Result<Arc<[Complex64]>, Error>,
    /// [`Stiffness::of`]
    pub(crate) stiffness: fn(&Kept, &mut Control) -> Result<Option<Stiffness>, Error>,
}

/// What such a matrix is made of.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    pub(crate) sources: Arc<Sources>,
    pub(crate) points: Arc<[[f64; 3]]>,
    pub(crate) scattering: Option<Arc<Scattering>>,
    pub(crate) signature: Option<Signature>,
    pub(crate) make: Make,
}

impl PartialEq for Kept {
    fn eq(&self, other: &Self) -> bool {
        let same = self.sources.array == other.sources.array && self.sources.medium == other.sources.medium;
        let obstacles = [self, other].map(|kept| kept.scattering.as_ref().map(|scattering| &scattering.obstacles));
        same && self.points == other.points && obstacles[0] == obstacles[1] && self.signature == other.signature
    }
}

impl Kept {
    pub(crate) const MAKE: Make = Make { matrix: Self::matrix, stiffness: Stiffness::of };

    /// Refuses points inside obstacles, factors that do not fit, and more entries than are kept.
    fn check(&self) -> Result<(), Error> {
        let (transducers, points) = (self.sources.array.len(), self.points.len());
        self.signature.as_ref().map_or(Ok(()), |signature| signature.check(transducers, points))?;
        if let Some(scattering) = &self.scattering {
            scattering.check()?;
            scattering.obstacles.check_points(&self.points)?;
        }
        let waves = self.scattering.as_ref().map_or(1, |scattering| scattering.cost());
        let most = (8 * MOST_ENTRIES / waves.max(8) / transducers).max(1);
        if points > most {
            let why = if self.scattering.is_some() { "obstacles" } else { "a signature" };
            let cure = format!("with {why} G is kept: give at most {most}");
            return Err(Error::invalid("points", format!("{points} of them"), cure));
        }
        Ok(())
    }

    /// G (N, M) in Pa, transducer by transducer.
    ///
    /// # Errors
    /// Points inside obstacles, factors that do not fit, more entries than are kept.
    fn matrix(&self) -> Result<Arc<[Complex64]>, Error> {
        self.check()?;
        let (transducers, points) = (self.sources.array.len(), self.points.len());
        let mut matrix = alloc::vec![Complex64::ZERO; transducers * points];
        for (j, &point) in self.points.iter().enumerate() {
            let mut row: Vec<Complex64> = (0..transducers).map(|i| self.sources.exact(i, point)).collect();
            if let Some(scattering) = &self.scattering {
                scattering.add(&self.sources, point, &mut row);
            }
            if let Some(signature) = &self.signature {
                let reach: Vec<f64> = row.iter().map(|g| g.norm()).collect();
                let factors = signature.factors(&self.sources.array, j, point, &reach);
                row.iter_mut().zip(factors).for_each(|(g, s)| *g *= s);
            }
            row.into_iter().enumerate().for_each(|(i, g)| matrix[i * points + j] = g);
        }
        Ok(matrix.into())
    }

    /// The same at some of the points, whose matrix is known.
    pub(crate) fn select(&self, chosen: &[usize]) -> Self {
        Self { points: chosen.iter().map(|&j| self.points[j]).collect(), ..self.clone() }
    }
}
