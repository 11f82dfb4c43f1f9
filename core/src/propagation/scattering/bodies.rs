//! Bodies: the part of the propagation matrix G of spheres and meshes.
//!
//! This part is the product H S. H (M, K) contains the K waves, or surface elements, of the bodies at each of M points. S
//! (K, N) contains the response of each wave or element to each of N transducers. S is computed once. If a point
//! moves, only its own row of H is computed again.

use crate::kernels::{InstructionSet, padded, panels};
use crate::prelude::*;
use crate::propagation::jet::TERMS;
use crate::propagation::local::Local;
use crate::propagation::scattering::sphere::Sphere;
use crate::propagation::{Boundary, Sources};

/// The waves of bodies. This is a trait, so that a program without bodies is not linked with their code.
trait Basis: fmt::Debug + Send + Sync {
    /// Writes the value of each wave, or of the wave of each element, at a point outside of the bodies.
    fn row(&self, point: [f64; 3], row: &mut Vec<Complex64>);
}

impl Basis for Sphere {
    fn row(&self, point: [f64; 3], row: &mut Vec<Complex64>) {
        self.row(point, row);
    }
}

impl Basis for Boundary {
    fn row(&self, point: [f64; 3], row: &mut Vec<Complex64>) {
        self.row(point, row);
    }
}

/// Bodies and their response to each transducer.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    basis: Arc<dyn Basis>,
    /// S (K, N), row by row, padded: its real and its imaginary part. The transducers' own responses are not included.
    answers: [Vec<f32>; 2],
    transducers: usize,
}

impl Bodies {
    pub(crate) fn of_sphere(sphere: Sphere, sources: &Sources, control: &mut Control) -> Result<Self> {
        let answers = sphere.answers(sources, control)?;
        let answers = answers.iter().map(|answer| Complex32::new(answer.re as f32, answer.im as f32));
        Ok(Self::of(Arc::new(sphere), answers, sources.array.len()))
    }

    /// Returns the bodies of a boundary. `sound` (E, N) is the sound on each of its elements for each transducer.
    pub(crate) fn of_boundary(boundary: Arc<Boundary>, sound: &[Complex32]) -> Self {
        let transducers = boundary.transducers();
        Self::of(boundary, sound.iter().copied(), transducers)
    }

    fn of(basis: Arc<dyn Basis>, answers: impl ExactSizeIterator<Item = Complex32>, transducers: usize) -> Self {
        let lanes = padded(transducers);
        let mut planes = [(); 2].map(|()| vec![0.0; answers.len() / transducers * lanes]);
        for (k, answer) in answers.enumerate() {
            let at = k / transducers * lanes + k % transducers;
            (planes[0][at], planes[1][at]) = (answer.re, answer.im);
        }
        Self { basis, answers: planes, transducers }
    }

    /// The number K of waves or elements.
    pub(crate) fn len(&self) -> usize {
        self.answers[0].len() / padded(self.transducers)
    }

    /// Returns the scattered pressure of each transducer at each point, in Pa: real and imaginary part, padded. The
    /// transducers' own responses are not included.
    pub(crate) fn sent(&self, points: &[[f64; 3]]) -> Vec<[Vec<f32>; 2]> {
        let lanes = padded(self.transducers);
        let mut row = Vec::new();
        let received = |point: &[f64; 3]| {
            self.basis.row(*point, &mut row);
            let part = |of: fn(&Complex64) -> f64| row.iter().map(|received| of(received) as f32).collect();
            [part(|received| received.re), part(|received| received.im)]
        };
        let received: Vec<[Vec<f32>; 2]> = points.iter().map(received).collect();
        let mut sent = vec![[(); 2].map(|()| vec![0.0; lanes]); points.len()];
        let answers = self.answers.each_ref().map(|plane| &plane[..]);
        // The best instruction set can be used, because all sets give the same bits.
        panels::add_answers(InstructionSet::best(), answers, &received, &mut sent, lanes);
        sent
    }

    /// Returns the Taylor coefficients, around a point, of the pressures that [`Bodies::sent`] returns.
    pub(crate) fn expanded(
        &self,
        local: &Local,
        point: [f64; 3],
        control: &mut Control,
    ) -> Result<Vec<[Complex64; TERMS]>> {
        let (mut row, mut received) = (Vec::new(), vec![[Complex64::ZERO; TERMS]; self.len()]);
        for (place, terms) in local.around(point) {
            self.basis.row(place, &mut row);
            for (received, wave) in received.iter_mut().zip(&row) {
                received.iter_mut().zip(terms).for_each(|(received, term)| *received += wave * term);
            }
        }
        let mut sent = vec![[Complex64::ZERO; TERMS]; self.transducers];
        for (received, [re, im]) in received.iter().zip(self.each()) {
            control.pulse()?;
            for (sent, answer) in sent.iter_mut().zip(re.iter().zip(im)) {
                let answer = Complex64::new(f64::from(*answer.0), f64::from(*answer.1));
                sent.iter_mut().zip(received).for_each(|(sent, received)| *sent += received * answer);
            }
        }
        Ok(sent)
    }

    /// The rows of S, one for each wave or element: real and imaginary part.
    fn each(&self) -> impl Iterator<Item = [&[f32]; 2]> {
        let [re, im] = self.answers.each_ref().map(|plane| plane.chunks_exact(padded(self.transducers)));
        re.zip(im).map(|(re, im)| [re, im])
    }

    /// The amplitude of each wave or element in the field of a drive (N,), with the transducers' responses included.
    pub(crate) fn driven(&self, sources: &Sources, drive: &[Complex32]) -> Vec<Complex64> {
        let played =
            |(i, q): (usize, &Complex32)| sources.array.effect(i) * Complex64::new(f64::from(q.re), f64::from(q.im));
        let played: Vec<Complex64> = drive.iter().enumerate().map(played).collect();
        let sum = |[re, im]: [&[f32]; 2]| {
            let waves = re.iter().zip(im).map(|(&re, &im)| Complex64::new(f64::from(re), f64::from(im)));
            waves.zip(&played).map(|(waves, q)| waves * q).sum()
        };
        self.each().map(sum).collect()
    }

    /// The pressure at a point in Pa, for the amplitudes that [`Bodies::driven`] returns. `row` is scratch memory.
    pub(crate) fn pressure(&self, driven: &[Complex64], point: [f64; 3], row: &mut Vec<Complex64>) -> Complex64 {
        self.basis.row(point, row);
        row.iter().zip(driven).map(|(received, driven)| received * driven).sum()
    }
}

#[cfg(test)]
#[path = "tests/bodies.rs"]
mod tests;
