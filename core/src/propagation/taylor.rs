//! Taylor: the waves of an array's transducers as Taylor polynomials around a point, exact up to degree 4.

use crate::kernels::simd::doubles::{EIGHT, Eight};
use crate::kernels::waves::{Emitters, Waves};
use crate::kernels::{InstructionSet, derivatives};
use crate::prelude::*;
use crate::propagation::jet::{Jet, TERMS};
use crate::propagation::sources::Sources;

/// The transducers of an array that have a factor other than 0.
pub(crate) struct Taylor {
    set: InstructionSet,
    pub(super) waves: Waves,
    pub(super) emitters: Vec<Emitters>,
    /// The index of the transducer in each lane of the emitters.
    pub(super) members: Vec<usize>,
}

impl Taylor {
    /// Prepares some sources with a complex factor for each transducer, which includes its response.
    pub(crate) fn new(set: InstructionSet, sources: &Sources, factor: impl Fn(usize) -> Complex64) -> Self {
        let array = &sources.array;
        let factor = |i: usize| factor(i) * array.transducer().source_pressure;
        let members: Vec<usize> = (0..array.len()).filter(|&i| factor(i) != Complex64::ZERO).collect();
        let emitters = Emitters::all(members.iter().map(|&i| {
            let Complex64 { re, im } = factor(i);
            (array.positions()[i], array.normals()[i], [re, im])
        }));
        let wavenumber = sources.medium.wavenumber();
        let directivity = array.transducer().directivity;
        let (slopes, widening) = (directivity.slopes(wavenumber), directivity.widening(wavenumber));
        let waves = Waves { wavenumber, absorption: sources.medium.absorption, slopes, widening };
        Self { set, waves, emitters, members }
    }

    /// Adds the waves of all transducers around a point to a pressure, given as real and imaginary part.
    pub(crate) fn add(&self, point: [f64; 3], pressure: &mut [Jet; 2], control: &mut Control) -> Result<()> {
        let sums = derivatives::sum(self.set, &self.waves, &self.emitters, point, control)?;
        pressure.iter_mut().zip(sums).for_each(|(part, sum)| part.add(&Jet::of(&sum), 1.0));
        Ok(())
    }

    /// Calls `take` with the index of each transducer and its wave around a point, real and imaginary part.
    pub(crate) fn each(
        &self,
        point: [f64; 3],
        control: &mut Control,
        mut take: impl FnMut(usize, [[f64; TERMS]; 2]),
    ) -> Result<()> {
        let of = |b: usize, terms: &[[Eight; TERMS]; 2]| {
            for (lane, &i) in self.members[b * EIGHT..].iter().take(EIGHT).enumerate() {
                take(i, terms.each_ref().map(|part| part.each_ref().map(|term| term[lane])));
            }
        };
        derivatives::each(self.set, &self.waves, &self.emitters, point, of, control)
    }
}

/// Adds the propagation matrix in Pa to `rows`: for each of the points (M, 3), one row with the waves of all transducers (N,).
pub(crate) fn add_exact(sources: &Sources, points: &[[f64; 3]], rows: &mut [Vec<Complex64>]) {
    // The best instruction set can be used, because all sets give the same bits.
    let Taylor { set, waves, emitters, members } =
        Taylor::new(InstructionSet::best(), sources, |i| sources.array.effect(i));
    let mut values = vec![[[0.0; EIGHT]; 2]; emitters.len()];
    for (point, row) in points.iter().zip(rows) {
        derivatives::values(set, &waves, &emitters, *point, sources.medium.wavelength() / 100.0, &mut values);
        for (members, [re, im]) in members.chunks(EIGHT).zip(&values) {
            members.iter().zip(re.iter().zip(im)).for_each(|(&i, (&re, &im))| row[i] += Complex64::new(re, im));
        }
    }
}

#[cfg(test)]
#[path = "tests/taylor.rs"]
mod tests;
