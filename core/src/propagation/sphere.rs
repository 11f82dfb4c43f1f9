//! Sphere: the sound that a sphere sends on, by its series of outgoing waves.
//!
//! The wave of a transducer at the sphere, p_i or dp_i/dr at r = a, is expanded in real spherical harmonics Y_k of order n,
//! by Gauss' rule in cos(theta) and equal steps in phi. The sphere answers with the outgoing waves that cancel it,
//!
//! ```text
//! p_s(r) = sum_k c_k h_n(kr)/h_n(ka) Y_k,   c_k = - <p_i, Y_k> (soft),   c_k = - <dp_i/dr, Y_k> h_n(ka)/(k h_n'(ka)) (rigid)
//! ```
//!
//! (P. M. Morse and K. U. Ingard, Theoretical Acoustics, 1968, section 8.2). So any directivity goes through, and of a point
//! source it is the classical series. k is eq. (5)'s with its absorption, k + j alpha.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::control::Control;
use crate::error::Error;
use crate::math;
use crate::propagation::sources::Sources;
use crate::scene::{Medium, Surface, distance};

/// The terms below this part of the largest term are left out: e^-10 = 5e-5 of a transducer's own share.
const CUT: f64 = 10.0;

/// Orders above k a that a transducer close to the surface may add.
const MOST_EXTRA: f64 = 90.0;

/// A step along the radius for derivatives, in wavelengths: its square and rounding over it are both below 1e-7.
const STEP: f64 = 1e-4;

/// A sphere in a medium, prepared for an array.
#[derive(Clone, Debug)]
pub(crate) struct Sphere {
    center: [f64; 3],
    radius: f64,
    kind: Surface,
    wavenumber: Complex64,
    /// The highest order n.
    order: usize,
    /// h_n(ka) of orders 0 to one above the highest.
    surface: Vec<Complex64>,
    /// Factors of the recurrence of Legendre functions for each order n and m = 0..=n.
    factors: Vec<[f64; 2]>,
}

impl Sphere {
    /// One that has been checked, and the places of the transducers.
    pub(crate) fn new((center, radius, kind): ([f64; 3], f64, Surface), medium: Medium, places: &[[f64; 3]]) -> Self {
        let size = medium.wavenumber() * radius;
        let nearest = places.iter().map(|&place| distance(place, center)).fold(f64::INFINITY, f64::min);
        // The terms of a source at distance r fall as (a/r)^n beyond n = k r.
        let far = 6.0 * math::cbrt(size) + 12.0;
        let near = (CUT / math::log(nearest / radius)).min(MOST_EXTRA);
        let order = math::ceil(size + far.max(near)) as usize;
        Self::of_order((center, radius, kind), medium, order)
    }

    /// The series of a sphere with its own highest order.
    pub(crate) fn of_order((center, radius, kind): ([f64; 3], f64, Surface), medium: Medium, order: usize) -> Self {
        let wavenumber = medium.complex_wavenumber();
        let surface = hankel(wavenumber * radius, order + 1);
        Self { center, radius, kind, wavenumber, order, surface, factors: factors(order) }
    }

    /// The number of waves.
    pub(crate) fn waves(&self) -> usize {
        (self.order + 1) * (self.order + 1)
    }

    /// Each wave at a point outside, 1 in modulus or less but for Y.
    pub(crate) fn row(&self, point: [f64; 3], row: &mut Vec<Complex64>) {
        let ray = [0, 1, 2].map(|axis| point[axis] - self.center[axis]);
        let r = distance(point, self.center).max(self.radius);
        let outgoing = hankel(self.wavenumber * r, self.order);
        let angle = math::atan2(ray[1], ray[0]);
        let legendre = self.legendre((ray[2] / r).clamp(-1.0, 1.0));
        row.clear();
        row.resize(self.waves(), Complex64::ZERO);
        let ratios: Vec<Complex64> = outgoing.iter().zip(&self.surface).map(|(own, surface)| own / surface).collect();
        for m in 0..=self.order {
            let turn = math::phasor(m as f64 * angle);
            for n in m..=self.order {
                let wave = ratios[n] * legendre[at(n, m)];
                row[n * n + n + m] = wave * turn.re;
                if m > 0 {
                    row[n * n + n - m] = wave * turn.im;
                }
            }
        }
    }

    /// The amplitudes (K, N) of the waves that it answers each transducer with, in Pa, its response left out.
    ///
    /// # Errors
    /// A stop.
    pub(crate) fn answers(&self, sources: &Sources, control: &mut Control) -> Result<Vec<Complex64>, Error> {
        let transducers = sources.array.len();
        let rules = Rules::new(self);
        let mut each = vec![Vec::new(); transducers];
        control.each(
            each.iter_mut().enumerate().collect(),
            &|(i, answers): (usize, &mut Vec<Complex64>), control| {
                *answers = self.answers_to(sources, i, &rules, control)?;
                Ok(())
            },
        )?;
        Ok((0..self.waves()).flat_map(|wave| each.iter().map(move |answers| answers[wave])).collect())
    }

    /// The answers to one transducer (K,).
    fn answers_to(
        &self,
        sources: &Sources,
        i: usize,
        rules: &Rules,
        control: &mut Control,
    ) -> Result<Vec<Complex64>, Error> {
        let met = |direction: [f64; 3]| Ok([self.met(sources, i, direction)]);
        let [mut answers] = rules.waves(met, control)?;
        for n in 0..=self.order {
            let answer = self.answer(n);
            answers[n * n..(n + 1) * (n + 1)].iter_mut().for_each(|amplitude| *amplitude *= answer);
        }
        Ok(answers)
    }

    /// The wave of a transducer at the surface in a direction: p, or dp/dr of a rigid one.
    fn met(&self, sources: &Sources, i: usize, direction: [f64; 3]) -> Complex64 {
        let sent = |r: f64| sources.sent(i, [0, 1, 2].map(|axis| self.center[axis] + r * direction[axis]));
        match self.kind {
            Surface::Soft => sent(self.radius),
            Surface::Rigid => {
                let step = STEP * sources.medium.wavelength();
                (sent(self.radius + step) - sent(self.radius - step)) / (2.0 * step)
            }
        }
    }

    /// The amplitude at the surface of the outgoing wave of order n that cancels 1.
    fn answer(&self, n: usize) -> Complex64 {
        match self.kind {
            Surface::Soft => Complex64::new(-1.0, 0.0),
            Surface::Rigid => {
                let [h, slope] = self.outgoing(n);
                -h / (self.wavenumber * slope)
            }
        }
    }

    /// `h_n` and its slope at the surface, h' = n/z h_n - h_(n+1).
    pub(crate) fn outgoing(&self, n: usize) -> [Complex64; 2] {
        let z = self.wavenumber * self.radius;
        [self.surface[n], self.surface[n] * n as f64 / z - self.surface[n + 1]]
    }

    /// Legendre functions of a cosine, such that they times cos(m phi) and sin(m phi) are orthonormal on the unit sphere.
    fn legendre(&self, cosine: f64) -> Vec<f64> {
        let sine = math::sqrt(1.0 - cosine * cosine);
        let mut found = vec![0.0; self.factors.len()];
        let mut diagonal = 1.0 / math::sqrt(4.0 * PI);
        for m in 0..=self.order {
            if m > 0 {
                diagonal *= sine * self.factors[at(m, m)][0];
            }
            let mut last = [0.0, diagonal];
            found[at(m, m)] = diagonal;
            for n in m + 1..=self.order {
                let [forward, back] = self.factors[at(n, m)];
                last = [last[1], forward * (cosine * last[1] - back * last[0])];
                found[at(n, m)] = last[1];
            }
        }
        found
    }
}

/// Directions in which the wave at the surface is sampled.
pub(crate) struct Rules {
    /// Gauss' rule in the cosine to the z axis.
    heights: Vec<f64>,
    weights: Vec<f64>,
    /// Legendre functions at each.
    legendre: Vec<Vec<f64>>,
    /// e^{j phi} of equal steps.
    turns: Vec<Complex64>,
}

impl Rules {
    /// The directions that are exact for products of two waves and a direction.
    pub(crate) fn new(sphere: &Sphere) -> Self {
        let count = sphere.order + 1;
        let (heights, weights) = gauss(count);
        let legendre = heights.iter().map(|&height| sphere.legendre(height)).collect();
        let turns = (0..2 * count).map(|l| math::phasor(TAU * l as f64 / (2 * count) as f64)).collect();
        Self { heights, weights, legendre, turns }
    }

    /// The shares (K,) that each Y_k has in some functions of the direction.
    ///
    /// # Errors
    /// Those of the functions, a stop.
    pub(crate) fn waves<const F: usize>(
        &self,
        of: impl Fn([f64; 3]) -> Result<[Complex64; F], Error>,
        control: &mut Control,
    ) -> Result<[Vec<Complex64>; F], Error> {
        let count = self.heights.len();
        let mut shares = [(); F].map(|()| vec![Complex64::ZERO; count * count]);
        for (h, legendre) in self.legendre.iter().enumerate() {
            control.pulse()?;
            let met = (0..2 * count).map(|l| of(self.direction(h, l))).collect::<Result<Vec<_>, Error>>()?;
            let share = self.weights[h] * TAU / (2 * count) as f64;
            for (f, shares) in shares.iter_mut().enumerate() {
                for m in 0..count {
                    let [mut even, mut odd] = [Complex64::ZERO; 2];
                    for (l, met) in met.iter().enumerate() {
                        let turn = self.turns[m * l % (2 * count)];
                        even += met[f] * turn.re;
                        odd += met[f] * turn.im;
                    }
                    for n in m..count {
                        let scale = share * legendre[at(n, m)];
                        shares[n * n + n + m] += even * scale;
                        if m > 0 {
                            shares[n * n + n - m] += odd * scale;
                        }
                    }
                }
            }
        }
        Ok(shares)
    }

    /// The integral over all directions of the direction times Re(a conj(b)), of functions by their shares (K,).
    pub(crate) fn turned(&self, a: &[Complex64], b: &[Complex64]) -> [f64; 3] {
        let count = self.heights.len();
        let mut sum = [0.0; 3];
        for h in 0..count {
            let share = self.weights[h] * TAU / (2 * count) as f64;
            let parts = [a, b].map(|shares| self.along(h, shares));
            for l in 0..2 * count {
                let [a, b] = parts.each_ref().map(|part| {
                    let wave = |(m, [even, odd]): (usize, &[Complex64; 2])| {
                        let turn = self.turns[m * l % (2 * count)];
                        even * turn.re + odd * turn.im
                    };
                    part.iter().enumerate().map(wave).sum::<Complex64>()
                });
                let weight = share * (a * b.conj()).re;
                sum.iter_mut().zip(self.direction(h, l)).for_each(|(sum, x)| *sum += weight * x);
            }
        }
        sum
    }

    /// The parts with cos(m phi) and sin(m phi) of a function at a height, by its shares.
    fn along(&self, h: usize, shares: &[Complex64]) -> Vec<[Complex64; 2]> {
        let count = self.heights.len();
        let part = |m: usize, k: &dyn Fn(usize) -> usize| {
            (m..count).map(|n| shares[k(n)] * self.legendre[h][at(n, m)]).sum::<Complex64>()
        };
        let both = |m: usize| {
            let odd = if m == 0 { Complex64::ZERO } else { part(m, &|n| n * n + n - m) };
            [part(m, &|n| n * n + n + m), odd]
        };
        (0..count).map(both).collect()
    }

    fn direction(&self, h: usize, l: usize) -> [f64; 3] {
        let (height, turn) = (self.heights[h], self.turns[l]);
        let across = math::sqrt(1.0 - height * height);
        [across * turn.re, across * turn.im, height]
    }
}

/// Where order n and m = 0..=n are kept.
fn at(n: usize, m: usize) -> usize {
    n * (n + 1) / 2 + m
}

/// Factors in the recurrence of normalised Legendre functions (NIST's Digital Library of Mathematical Functions,
/// 14.10.3 and 14.30.1): [sqrt((2m + 1)/2m), -] at n = m, with sqrt(2) of m > 0 in the first.
fn factors(order: usize) -> Vec<[f64; 2]> {
    let mut factors = Vec::with_capacity((order + 1) * (order + 2) / 2);
    for n in 0..=order {
        for m in 0..=n {
            let [n, m] = [n, m].map(|x| x as f64);
            let (n2, m2, last) = (n * n, m * m, (n - 1.0) * (n - 1.0));
            factors.push(if n == m {
                [math::sqrt((2.0 * m + 1.0) / if m == 1.0 { m } else { (2.0 * m).max(1.0) }), 0.0]
            } else {
                let back = math::sqrt(((last - m2) / (4.0 * last - 1.0)).max(0.0));
                [math::sqrt((4.0 * n2 - 1.0) / (n2 - m2)), back]
            });
        }
    }
    factors
}

/// Spherical Hankel functions h_n(z) of the first kind, orders 0 to `order`: upwards, where they grow.
fn hankel(z: Complex64, order: usize) -> Vec<Complex64> {
    let wave = math::phasor(z.re) * math::exp(-z.im);
    let first = Complex64::new(wave.im, -wave.re) / z;
    let mut found = vec![first, first / z - Complex64::I * first];
    for n in 1..order {
        let next = found[n] * (2 * n + 1) as f64 / z - found[n - 1];
        found.push(next);
    }
    found.truncate(order + 1);
    found
}

/// Nodes and weights of Gauss' rule on [-1, 1], by Newton's method on the Legendre polynomial.
pub(crate) fn gauss(count: usize) -> (Vec<f64>, Vec<f64>) {
    let node = |k: usize| {
        let mut x = math::cos(PI * (k as f64 + 0.75) / (count as f64 + 0.5));
        let mut slope = 1.0;
        // Quadratic from a start that is right to 1e-3: five steps are more than enough.
        for _ in 0..6 {
            let [mut last, mut own] = [1.0, x];
            for n in 2..=count {
                let n = n as f64;
                [last, own] = [own, ((2.0 * n - 1.0) * x * own - (n - 1.0) * last) / n];
            }
            slope = count as f64 * (x * own - last) / (x * x - 1.0);
            x -= own / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).unzip()
}
