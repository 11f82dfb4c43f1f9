//! Sphere: the sound that a sphere scatters, as a series of outgoing spherical waves.
//!
//! At the sphere, r = a, the wave of a transducer (p_i, or dp_i/dr) is expanded in real spherical harmonics Y_k of order n. The
//! integrals use a Gauss rule in cos(theta) and equal steps in phi. The scattered wave consists of the outgoing waves that meet
//! the boundary condition,
//!
//! ```text
//! p_s(r) = sum_k c_k h_n(kr)/h_n(ka) Y_k,   c_k = - <p_i, Y_k> (soft),   c_k = - <dp_i/dr, Y_k> h_n(ka)/(k h_n'(ka)) (rigid)
//! ```
//!
//! (P. M. Morse and K. U. Ingard, Theoretical Acoustics, 1968, section 8.2). This works for any directivity; for a point source
//! it is the classical series. The wavenumber k is complex: its imaginary part is the absorption of the air in Np/m.

use crate::prelude::*;
use crate::propagation::sources::Sources;
use crate::scene::{Medium, Surface, distance};

/// Terms smaller than e^-10 = 5e-5 of a transducer's largest term are left out.
const CUT: f64 = 10.0;

/// The most orders above k a that a transducer close to the surface may add.
const MOST_EXTRA: f64 = 90.0;

/// The step along the radius for numerical derivatives, in wavelengths. The truncation error, proportional to the square of the
/// step, and the rounding error are both below 1e-7.
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
    /// h_n(ka) for the orders 0 to `order` + 1.
    surface: Vec<Complex64>,
    /// Factors in the recurrence of the Legendre functions, for each order n and m = 0..=n.
    factors: Vec<[f64; 2]>,
}

impl Sphere {
    /// Returns a sphere that has been checked. Its highest order is chosen for the distance of the nearest of `places`, the
    /// transducers.
    pub(crate) fn new(center: [f64; 3], radius: f64, kind: Surface, medium: Medium, places: &[[f64; 3]]) -> Self {
        let size = medium.wavenumber() * radius;
        let nearest = places.iter().map(|&place| distance(place, center)).fold(f64::INFINITY, f64::min);
        // Beyond n = k r, the terms of a source at the distance r fall as (a/r)^n.
        let far = 6.0 * math::cbrt(size) + 12.0;
        let near = (CUT / math::log(nearest / radius)).min(MOST_EXTRA);
        let order = math::ceil(size + far.max(near)) as usize;
        Self::of_order(center, radius, kind, medium, order)
    }

    /// Returns a sphere with a given highest order.
    pub(crate) fn of_order(center: [f64; 3], radius: f64, kind: Surface, medium: Medium, order: usize) -> Self {
        let wavenumber = medium.complex_wavenumber();
        let surface = hankel(wavenumber * radius, order + 1);
        Self { center, radius, kind, wavenumber, order, surface, factors: factors(order) }
    }

    /// The number K of waves.
    pub(crate) fn waves(&self) -> usize {
        (self.order + 1) * (self.order + 1)
    }

    /// Writes each outgoing wave h_n(kr)/h_n(ka) Y_k at a point outside of the sphere. The ratio of Hankel functions has a
    /// modulus of at most 1.
    pub(crate) fn row(&self, point: [f64; 3], row: &mut Vec<Complex64>) {
        let ray = Vec3(point) - self.center;
        let r = ray.norm().max(self.radius);
        let outgoing = hankel(self.wavenumber * r, self.order);
        let angle = math::atan2(ray[1], ray[0]);
        let legendre = self.legendre((ray[2] / r).clamp(-1.0, 1.0));
        row.clear();
        row.resize(self.waves(), Complex64::ZERO);
        let ratios: Vec<Complex64> = outgoing.iter().zip(&self.surface).map(|(wave, surface)| wave / surface).collect();
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

    /// Returns the amplitudes (K, N) in Pa of the scattered waves for each transducer. The transducer's own response is not
    /// included.
    ///
    /// # Errors
    /// A stop by the caller.
    pub(crate) fn answers(&self, sources: &Sources, control: &mut Control) -> Result<Vec<Complex64>> {
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

    /// Returns the amplitudes (K,) in Pa of the scattered waves for one transducer.
    fn answers_to(&self, sources: &Sources, i: usize, rules: &Rules, control: &mut Control) -> Result<Vec<Complex64>> {
        let met = |direction: [f64; 3]| Ok([self.met(sources, i, direction)]);
        let [mut answers] = rules.waves(met, control)?;
        for n in 0..=self.order {
            let answer = self.answer(n);
            answers[n * n..(n + 1) * (n + 1)].iter_mut().for_each(|amplitude| *amplitude *= answer);
        }
        Ok(answers)
    }

    /// The wave of a transducer at the surface in a direction: p for a soft sphere, dp/dr for a rigid one.
    fn met(&self, sources: &Sources, i: usize, direction: [f64; 3]) -> Complex64 {
        let sent = |r: f64| sources.sent(i, (Vec3(self.center) + r * Vec3(direction)).0);
        match self.kind {
            Surface::Soft => sent(self.radius),
            Surface::Rigid => {
                let step = STEP * sources.medium.wavelength();
                (sent(self.radius + step) - sent(self.radius - step)) / (2.0 * step)
            }
        }
    }

    /// The amplitude at the surface of the outgoing wave of order n that cancels an incident amplitude of 1.
    fn answer(&self, n: usize) -> Complex64 {
        match self.kind {
            Surface::Soft => Complex64::new(-1.0, 0.0),
            Surface::Rigid => {
                let [h, slope] = self.outgoing(n);
                -h / (self.wavenumber * slope)
            }
        }
    }

    /// `h_n` and its derivative at the surface, h' = n/z h_n - h_(n+1).
    pub(crate) fn outgoing(&self, n: usize) -> [Complex64; 2] {
        let z = self.wavenumber * self.radius;
        [self.surface[n], self.surface[n] * n as f64 / z - self.surface[n + 1]]
    }

    /// Legendre functions of a cosine, normalised so that their products with cos(m phi) and sin(m phi) are orthonormal on the
    /// unit sphere.
    fn legendre(&self, cosine: f64) -> Vec<f64> {
        let sine = math::sqrt(1.0 - cosine * cosine);
        let mut values = vec![0.0; self.factors.len()];
        let mut diagonal = 1.0 / math::sqrt(4.0 * PI);
        for m in 0..=self.order {
            if m > 0 {
                diagonal *= sine * self.factors[at(m, m)][0];
            }
            let mut last = [0.0, diagonal];
            values[at(m, m)] = diagonal;
            for n in m + 1..=self.order {
                let [forward, back] = self.factors[at(n, m)];
                last = [last[1], forward * (cosine * last[1] - back * last[0])];
                values[at(n, m)] = last[1];
            }
        }
        values
    }
}

/// The directions in which the wave at the surface is sampled, and their weights.
pub(crate) struct Rules {
    /// The nodes of a Gauss rule in cos(theta).
    heights: Vec<f64>,
    weights: Vec<f64>,
    /// The Legendre functions at each node.
    legendre: Vec<Vec<f64>>,
    /// e^{j phi} at equal steps of phi.
    turns: Vec<Complex64>,
}

impl Rules {
    /// Returns enough directions to integrate the product of two waves and a direction exactly.
    pub(crate) fn new(sphere: &Sphere) -> Self {
        let count = sphere.order + 1;
        let (heights, weights) = gauss(count);
        let legendre = heights.iter().map(|&height| sphere.legendre(height)).collect();
        let turns = (0..2 * count).map(|l| math::phasor(TAU * l as f64 / (2 * count) as f64)).collect();
        Self { heights, weights, legendre, turns }
    }

    /// Returns the coefficients (K,) in Y_k of some functions of the direction.
    ///
    /// # Errors
    /// The errors of the functions, a stop by the caller.
    pub(crate) fn waves<const F: usize>(
        &self,
        of: impl Fn([f64; 3]) -> Result<[Complex64; F]>,
        control: &mut Control,
    ) -> Result<[Vec<Complex64>; F]> {
        let count = self.heights.len();
        let mut shares = [(); F].map(|()| vec![Complex64::ZERO; count * count]);
        for (h, legendre) in self.legendre.iter().enumerate() {
            control.pulse()?;
            let met = (0..2 * count).map(|l| of(self.direction(h, l))).collect::<Result<Vec<_>>>()?;
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

    /// Returns the integral over all directions of the direction times Re(a conj(b)); the functions a and b are given by their
    /// coefficients (K,).
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

    /// Returns, for each m, the factors of cos(m phi) and of sin(m phi) in a function of the direction at one height.
    /// `shares` are the function's coefficients in Y_k.
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

/// The index of order n and m = 0..=n in a list.
fn at(n: usize, m: usize) -> usize {
    n * (n + 1) / 2 + m
}

/// Factors in the recurrence of normalised Legendre functions (NIST's Digital Library of Mathematical Functions,
/// 14.10.3 and 14.30.1). At n = m the first factor is sqrt((2m + 1)/2m), and the second is unused. At n = m = 1 the
/// first factor is multiplied by sqrt(2), which all real harmonics with m > 0 have.
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

/// Spherical Hankel functions h_n(z) of the first kind for the orders 0 to `order`. The recurrence runs towards
/// higher orders. It is stable, because the functions grow in this direction.
fn hankel(z: Complex64, order: usize) -> Vec<Complex64> {
    let wave = math::phasor(z.re) * math::exp(-z.im);
    let first = Complex64::new(wave.im, -wave.re) / z;
    let mut values = vec![first, first / z - Complex64::I * first];
    for n in 1..order {
        let next = values[n] * (2 * n + 1) as f64 / z - values[n - 1];
        values.push(next);
    }
    values.truncate(order + 1);
    values
}

/// Nodes and weights of the Gauss rule on [-1, 1]; Newton's method finds the roots of the Legendre polynomial.
pub(crate) fn gauss(count: usize) -> (Vec<f64>, Vec<f64>) {
    let node = |k: usize| {
        let mut x = math::cos(PI * (k as f64 + 0.75) / (count as f64 + 0.5));
        let mut slope = 1.0;
        // Convergence is quadratic from a start that is accurate to 1e-3: five steps are more than enough.
        for _ in 0..6 {
            let [mut last, mut value] = [1.0, x];
            for n in 2..=count {
                let n = n as f64;
                [last, value] = [value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * last) / n];
            }
            slope = count as f64 * (x * value - last) / (x * x - 1.0);
            x -= value / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).unzip()
}
