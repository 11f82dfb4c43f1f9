//! Every kernel compared with plain f64 loops, at every length up to four lane groups, over memory full of NaN.

mod arc;
mod batch;
mod cholesky;
mod closed_form;
mod closed_form_interleaved;
mod directivity;
mod dither;
mod double;
mod energies;
mod error_diffusion;
mod greedy;
mod greedy_interleaved;
mod grid;
mod large_grid;
mod limit;
mod matrix;
mod moduli;
mod moments;
mod pulses;
mod search;
mod shortlist;
mod simd;
mod tiles;

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{LOG2_E, TAU};
use core::ops::RangeInclusive;

use num_complex::Complex32;

use crate::control::Control;
use crate::kernels::lanes::{LANES, padded};
use crate::kernels::propagate::moduli::{Run, add_moduli};
use crate::kernels::propagate::row::{ControlPoints, Row};
use crate::kernels::propagate::rows::Rows;
use crate::kernels::propagate::source::Radiation;
use crate::kernels::propagate::source::{Source, SourceList};
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tiles::{height, lanes, pack, size};
use crate::rng::Rng;
use crate::scene::Directivity;

/// Numbers of points in the tests. Miri takes a thousand times as long, so it tests only numbers close to one lane
/// group.
const LENGTHS: RangeInclusive<usize> = if cfg!(miri) { 15..=17 } else { 1..=67 };

/// Step over the values at which a polynomial is tested.
pub(super) const STRIDE: usize = if cfg!(miri) { 2000 } else { 1 };

/// The relative error of one rounding to f32.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;

/// k in rad/m at 40 kHz and 340 m/s.
const WAVENUMBER: f64 = TAU / 8.5e-3;

/// Returns `count` random numbers from `low` to `high`, padded with zeros.
fn numbers(rng: &mut Rng, count: usize, low: f64, high: f64) -> Vec<f32> {
    let mut list = vec![0.0; padded(count)];
    list[..count].fill_with(|| (low + (high - low) * rng.uniform()) as f32);
    list
}

fn wide(x: f32) -> f64 {
    f64::from(x)
}

fn assert_near(got: f32, want: f64, allowed: f64, what: &str) {
    // Below the normal numbers of f32 the rounding error is up to the least number above 0.
    let least = f64::from(f32::from_bits(1));
    assert!((wide(got) - want).abs() <= allowed + least && got.is_finite(), "{what}: {got:e} for {want:e}");
}

/// One transducer and some points, in the layout that `Sources` uses.
struct Shot {
    directivity: Directivity,
    /// A bound of the slope of the directivity D over the cosine of the angle.
    steepness: f64,
    radiation: Radiation,
    source: Source,
    coordinates: [Vec<f32>; 3],
    count: usize,
}

impl Shot {
    fn new(rng: &mut Rng, directivity: Directivity, decay: f32, count: usize) -> Self {
        let mut number = |low: f64, high: f64| (low + (high - low) * rng.uniform()) as f32;
        let mut normal = [number(-0.5, 0.5), number(-0.5, 0.5), 1.0];
        let length = normal.iter().map(|x| x * x).sum::<f32>().sqrt();
        normal = normal.map(|x| x / length);
        let position = [number(-12.0, 12.0), number(-12.0, 12.0), number(-1.0, 1.0)];
        let (gain, turns) = (number(0.1, 2.0), if count.is_multiple_of(2) { 0.0 } else { number(-0.5, 0.5) });
        // The padding may have any coordinates.
        let mut coordinates = [(); 3].map(|()| vec![4e6; padded(count)]);
        for j in 0..count {
            for (axis, (low, high)) in [(-20.0, 20.0), (-20.0, 20.0), (-5.0, 60.0)].into_iter().enumerate() {
                coordinates[axis][j] = number(low, high);
            }
        }
        let radiation = Radiation { decay: (decay < 0.0).then_some(decay), pattern: directivity.pattern(WAVENUMBER) };
        Self {
            directivity,
            steepness: 10.0,
            radiation,
            source: Source { position, normal, amplitude: gain, turns },
            coordinates,
            count,
        }
    }

    fn control_points(&self) -> ControlPoints<'_> {
        let [x, y, z] = &self.coordinates;
        ControlPoints { coordinates: [x, y, z], count: self.count }
    }

    /// Returns the distance of point j, at least a hundredth of a wavelength, and the real factor of eq. (5).
    fn spread(&self, j: usize) -> (f64, f64) {
        let ray = [0, 1, 2].map(|axis| wide(self.coordinates[axis][j]) - wide(self.source.position[axis]));
        let r = self.square(j).sqrt().max(wide(crate::kernels::propagate::row::NEAREST));
        let cos = (0..3).map(|axis| ray[axis] * wide(self.source.normal[axis])).sum::<f64>() / r;
        (r, self.directivity.value(cos, WAVENUMBER) * (wide(self.radiation.decay.unwrap_or(0.0)) * r).exp2() / r)
    }

    fn square(&self, j: usize) -> f64 {
        let part = |axis: usize| wide(self.coordinates[axis][j]) - wide(self.source.position[axis]);
        (0..3).map(|axis| part(axis).powi(2)).sum()
    }

    /// Asserts the result of each kernel, over memory full of NaN.
    fn check(&self, set: InstructionSet) {
        let [mut re, mut im] = [(); 2].map(|()| vec![f32::NAN; padded(self.count)]);
        let mut moduli = vec![1.0; self.count];
        let sources = SourceList::new(&[self.source]);
        let row = &mut Row { re: &mut re, im: &mut im };
        crate::kernels::row(set, &self.radiation, &sources, 0, self.control_points(), row);
        let nearest = (0..self.count).map(|j| self.square(j)).fold(f64::INFINITY, f64::min);
        // These limits are just above and just below the square distance: the kernel's square has five roundings.
        for (factor, near) in [(1.0 + 1e-6, true), (1.0 - 1e-6, false)] {
            moduli.fill(1.0);
            let limit = (nearest * factor) as f32;
            let run = Run::all(&self.radiation, &sources).next().expect("a source");
            let reported = add_moduli(set, &run, self.control_points(), limit, &mut moduli, &mut Control::none());
            assert!(reported.expect("no stop") == near || nearest == 0.0, "{set}: nearest point of {}", self.count);
        }
        for j in 0..self.count {
            let (r, amplitude) = self.spread(j);
            let (sin, cos) = (TAU * (r + wide(self.source.turns))).sin_cos();
            let gain = wide(self.source.amplitude);
            // Errors are relative to the modulus straight ahead, because D has zeros. They consist of a few roundings
            // of the amplitude, the polynomials' errors of 7e-7 and 3e-7, the error of the table, and the effect on D
            // of two roundings of the cosine. The phase has four roundings of the distance.
            let unit = gain / r;
            let (flat, phase) =
                ((2e-6 + 2.0 * ROUNDING * self.steepness) * unit, 4.0 * ROUNDING * TAU * (r + 0.5) * unit);
            let what = self.directivity.name().0;
            assert_near(re[j], gain * amplitude * cos, flat + phase, what);
            assert_near(im[j], gain * amplitude * sin, flat + phase, what);
            assert!((moduli[j] - 1.0 - gain * amplitude.abs()).abs() <= flat, "{what}: |G| of point {j}");
        }
        self.check_field(set, [&re, &im]);
        self.check_tile(set, [&re, &im]);
        for list in [&re, &im] {
            assert!(list[self.count..].iter().all(|&x| x == 0.0), "padding of {} is not silent", self.count);
        }
    }
}

impl Shot {
    /// Asserts the field of three transducers: this one, an equal one that is off, and an equal one again. It is the
    /// sum of their waves G q, and 0 in the padding.
    fn check_field(&self, set: InstructionSet, row: [&[f32]; 2]) {
        let sources = SourceList::new(&[self.source; 3]);
        let drive = [Complex32::new(0.6, -0.7), Complex32::ZERO, Complex32::new(-0.1, 0.3)];
        let [mut re, mut im] = [(); 2].map(|()| vec![0.0; padded(self.count)]);
        let (to, control) = ([&mut re[..], &mut im[..]], &mut Control::none());
        super::add_field(set, &self.radiation, &sources, &drive, self.control_points(), to, control).expect("no stop");
        let q = drive.iter().sum::<Complex32>();
        for j in 0..self.count {
            let ([gr, gi], [qr, qi]) = (row.map(|part| wide(part[j])), [q.re, q.im].map(wide));
            // The allowed error: six roundings of numbers below |G|.
            let allowed = 6.0 * ROUNDING * gr.hypot(gi);
            assert_near(re[j], gr * qr - gi * qi, allowed, "re");
            assert_near(im[j], gr * qi + gi * qr, allowed, "im");
        }
        assert!(re[self.count..].iter().chain(&im[self.count..]).all(|&x| x == 0.0), "padding was given sound");
        // At few points the lanes contain transducers. The results have the same bits as those of these points among
        // many others.
        let some = ControlPoints { count: self.count.min(4), ..self.control_points() };
        let [mut few_re, mut few_im] = [(); 2].map(|()| vec![0.0; LANES]);
        let (to, control) = ([&mut few_re[..], &mut few_im[..]], &mut Control::none());
        super::add_field(set, &self.radiation, &sources, &drive, some, to, control).expect("no stop");
        assert!(few_re[..some.count] == re[..some.count] && few_im[..some.count] == im[..some.count], "{set}");
    }

    /// Asserts that the tile of this transducer and a second one in phase has the same bits as their rows, else 0.
    fn check_tile(&self, set: InstructionSet, row: [&[f32]; 2]) {
        let sources = SourceList::new(&[self.source, Source { turns: 0.0, ..self.source }]);
        let order: Vec<u32> = (0..self.count as u32).collect();
        let whole = size(height(self.count), lanes(2));
        let [mut re, mut im] = [(); 2].map(|()| vec![f32::NAN; whole]);
        let rows = Rows::Computed {
            radiation: &self.radiation,
            sources: &sources,
            control_points: self.control_points(),
            amplitudes: &[],
        };
        pack(set, rows, 0..2, &order, [&mut re, &mut im], &mut Control::none()).expect("it is not stopped");
        // The rows have two tiles and a spare one, in blocks of four points.
        for (plane, row) in [re, im].iter().zip(row) {
            for j in 0..self.count {
                let first = (j / 4 * 3 * 4 + j % 4) * LANES;
                assert_eq!(plane[first], row[j], "{set}: point {j} of {}", self.count);
                assert!(plane[first + 2..first + LANES].iter().all(|&x| x == 0.0), "{set}: no transducer");
            }
        }
    }
}

/// Returns a shot for every directivity, without absorption and with 1.3 dB/m.
fn shots(seed: u64, count: usize) -> Vec<Shot> {
    let mut rng = Rng::new(seed);
    let mut list = Vec::new();
    for pattern in Directivity::all() {
        for decay in [0.0, (-0.15 * 8.5e-3 * LOG2_E) as f32] {
            list.push(Shot::new(&mut rng, pattern, decay, count));
        }
    }
    list
}

#[test]
fn row_and_moduli_are_eq_5() {
    for set in InstructionSet::all() {
        for count in LENGTHS {
            for shot in shots(count as u64, count) {
                shot.check(set);
            }
        }
    }
}

#[test]
fn sharp_and_steep_directivities_are_accurate() {
    for set in InstructionSet::all() {
        let sharp = [("piston", 0.1), ("piston", 0.02), ("sinc", 0.2), ("cos", 0.5), ("cos", 2.5), ("cos", 70.0)];
        for (name, parameter) in sharp {
            let pattern = Directivity::named(name, Some(parameter)).expect("a directivity");
            // The slope of D over cos(theta) is at most (k d)^2/12 for a sinc of width d, (k a)^2/4 for a piston of
            // radius a, and n for cos^n with n of 1 or more. The test allows more than that.
            let steepness = if name == "cos" { parameter.max(10.0) } else { (WAVENUMBER * parameter).powi(2) / 2.0 };
            let shot = Shot::new(&mut Rng::new(3), pattern, 0.0, 67);
            Shot { steepness, ..shot }.check(set);
        }
    }
}

#[test]
fn distances_below_a_hundredth_of_a_wavelength_count_as_that() {
    for mut shot in shots(1, 20) {
        for (j, step) in [(3, 0.0), (7, 0.004), (17, 0.02)] {
            for axis in 0..3 {
                shot.coordinates[axis][j] = shot.source.position[axis];
            }
            // The source is moved to z = 0, so that the distance is exact in f32.
            shot.source.position[2] = 0.0;
            shot.coordinates[2][j] = step;
        }
        InstructionSet::all().for_each(|set| shot.check(set));
    }
}

#[test]
fn accumulate_adds_g_q() {
    for set in InstructionSet::all() {
        for count in LENGTHS {
            let mut rng = Rng::new(count as u64);
            let [gr, gi, pr, pi] = [(); 4].map(|()| numbers(&mut rng, count, -1.0, 1.0));
            let [qr, qi] = [0.6_f32, -0.7];
            let (mut re, mut im) = (pr.clone(), pi.clone());
            super::accumulate(set, [&gr, &gi], [qr, qi], &mut re, &mut im);
            for j in 0..padded(count) {
                // The allowed error: two products, their difference and the sum round numbers below 1, 1, 2 and 3.
                let allowed = 7.0 * ROUNDING;
                assert_near(re[j], wide(pr[j]) + wide(gr[j]) * wide(qr) - wide(gi[j]) * wide(qi), allowed, "re");
                assert_near(im[j], wide(pi[j]) + wide(gr[j]) * wide(qi) + wide(gi[j]) * wide(qr), allowed, "im");
            }
            assert!(re[count..].iter().chain(&im[count..]).all(|&x| x == 0.0), "silent padding was given sound");
        }
    }
}

#[test]
fn modulus_and_squares_are_those_of_complex_numbers() {
    for set in InstructionSet::all() {
        for count in LENGTHS {
            let mut rng = Rng::new(count as u64);
            let [re, im] = [(); 2].map(|()| numbers(&mut rng, count, -1.0, 1.0));
            let start = numbers(&mut rng, count, 0.0, 1.0);
            let (mut moduli, mut sums) = (vec![f32::NAN; padded(count)], start.clone());
            super::modulus(set, &re, &im, &mut moduli);
            super::squares(set, [&re, &im], count, &mut sums);
            for j in 0..padded(count) {
                let (modulus, sum) = (wide(re[j]).hypot(wide(im[j])), wide(start[j]));
                // The allowed error: the squares and their sum have two roundings, whose effect the root halves. The
                // root itself has two roundings.
                assert_near(moduli[j], modulus, 2.0 * ROUNDING * modulus, "modulus");
                // The allowed error: roundings of the squares, of their sum, and of the sum with the earlier values.
                assert_near(sums[j], sum + modulus * modulus, 3.0 * ROUNDING * (sum + modulus * modulus), "square");
            }
        }
    }
}

#[test]
fn correlate_and_dot_are_their_sums() {
    for set in InstructionSet::all() {
        for count in LENGTHS {
            let mut rng = Rng::new(count as u64);
            let [a, b, c, d] = [(); 4].map(|()| numbers(&mut rng, count, -1.0, 1.0));
            let sum = |part: &dyn Fn(usize) -> f64| (0..count).map(part).sum::<f64>();
            // The allowed error: two products and their sum, at most five sums in a lane and four across, of terms
            // below 2.
            let allowed = 12.0 * ROUNDING * 2.0 * count as f64;
            let [re, im] = super::correlate(set, [&a, &b], [&c, &d], count);
            assert_near(re, sum(&|j| wide(a[j]) * wide(c[j]) + wide(b[j]) * wide(d[j])), allowed, "re");
            assert_near(im, sum(&|j| wide(a[j]) * wide(d[j]) - wide(b[j]) * wide(c[j])), allowed, "im");
            assert_near(super::dot(set, &a, &b), sum(&|j| wide(a[j]) * wide(b[j])), allowed, "dot");
        }
    }
}
