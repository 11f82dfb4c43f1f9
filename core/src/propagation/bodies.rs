//! Bodies: what spheres and meshes add to G.
//!
//! It is H S: waves or surface elements at a point times their response to each transducer. S is found once; a point
//! that moves needs its own row of H alone.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use num_complex::{Complex32, Complex64};

use crate::control::Control;
use crate::error::Error;
use crate::propagation::boundary::Boundary;
use crate::propagation::sources::Sources;
use crate::propagation::sphere::Sphere;

/// What the sound of bodies is made of: a trait, so that a program that has none is not linked with their mathematics.
trait Basis: fmt::Debug + Send + Sync {
    /// Each wave, or what each element sends, at a point outside.
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

/// Bodies and what each transducer makes of them.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    basis: Arc<dyn Basis>,
    /// S (K, N), wave by wave, real and imaginary parts apart; the transducers' responses left out.
    answers: [Vec<f32>; 2],
    transducers: usize,
}

impl Bodies {
    pub(crate) fn of_sphere(sphere: Sphere, sources: &Sources, control: &mut Control) -> Result<Self, Error> {
        let answers = sphere.answers(sources, control)?;
        let answers = [answers.iter().map(|a| a.re as f32).collect(), answers.iter().map(|a| a.im as f32).collect()];
        Ok(Self { basis: Arc::new(sphere), answers, transducers: sources.array.len() })
    }

    /// Of the sound on a boundary's elements (E, N).
    pub(crate) fn of_boundary(boundary: Arc<Boundary>, sound: &[Complex32]) -> Self {
        let answers = [sound.iter().map(|u| u.re).collect(), sound.iter().map(|u| u.im).collect()];
        let transducers = sound.len() / boundary.elements();
        Self { basis: boundary, answers, transducers }
    }

    /// The number of waves or elements.
    pub(crate) fn len(&self) -> usize {
        self.answers[0].len() / self.transducers
    }

    /// What each transducer sends to a point by way of them, its response left out, in Pa.
    pub(crate) fn sent(&self, point: [f64; 3]) -> Vec<Complex64> {
        let mut row = Vec::new();
        self.basis.row(point, &mut row);
        let [mut re, mut im] = [(); 2].map(|()| vec![0.0_f32; self.transducers]);
        for (received, [own_re, own_im]) in row.iter().zip(self.each()) {
            let (x, y) = (received.re as f32, received.im as f32);
            for (((re, im), a), b) in re.iter_mut().zip(&mut im).zip(own_re).zip(own_im) {
                *re += x * a - y * b;
                *im += x * b + y * a;
            }
        }
        re.into_iter().zip(im).map(|(re, im)| Complex64::new(f64::from(re), f64::from(im))).collect()
    }

    /// What all transducers make of each wave or element.
    fn each(&self) -> impl Iterator<Item = [&[f32]; 2]> {
        let [re, im] = &self.answers;
        re.chunks_exact(self.transducers).zip(im.chunks_exact(self.transducers)).map(|(re, im)| [re, im])
    }

    /// The waves or elements in the field of a drive (N,), responses counted in.
    pub(crate) fn driven(&self, sources: &Sources, drive: &[Complex32]) -> Vec<Complex64> {
        let played =
            |(i, q): (usize, &Complex32)| sources.array.effect(i) * Complex64::new(f64::from(q.re), f64::from(q.im));
        let played: Vec<Complex64> = drive.iter().enumerate().map(played).collect();
        let sum = |[re, im]: [&[f32]; 2]| {
            let own = re.iter().zip(im).map(|(&re, &im)| Complex64::new(f64::from(re), f64::from(im)));
            own.zip(&played).map(|(own, q)| own * q).sum()
        };
        self.each().map(sum).collect()
    }

    /// The pressure at a point of waves or elements so driven, in Pa.
    pub(crate) fn pressure(&self, driven: &[Complex64], point: [f64; 3], row: &mut Vec<Complex64>) -> Complex64 {
        self.basis.row(point, row);
        row.iter().zip(driven).map(|(received, driven)| received * driven).sum()
    }
}

#[cfg(test)]
#[path = "tests/bodies.rs"]
mod tests;
