//! Response: the force of sound on a small sphere as a bilinear form of the derivatives of the pressure.
//!
//! A sphere of fluid of density rho_p, sound speed c_p and radius a sends s_n times the outgoing wave of each order n that it
//! meets ([`crate::propagation::forces::momentum`]). Its force is a sum over pairs of neighbouring orders, with T_n = s_n +
//! s_(n+1)* + 2 s_n s_(n+1)* (O. A. Sapozhnikov and M. R. Bailey, J. Acoust. Soc. Am. 133, 661, 2013). A regular wave of order
//! n is a combination of the n-th derivatives of p at the centre. Up to n = 2 the sum is
//!
//! ```text
//! F_i = Re[ C_0 p* p_i + C_1 p_j* p_ij + C_2 p_jk* p_ijk ],   p_i = dp/dx_i, summed over j and k
//! C_0 = D (W_0 + W_1* - 3/2 W_2),   C_1 = 3 D/k^2 (W_1 + W_2*),   C_2 = 15/2 D/k^4 W_2
//! W_n = j T_n*,   D = 2 pi/(rho c^2 k^3)
//! ```
//!
//! The real parts of C have the potential U = -1/2 (Re C_0 |p|^2 + Re C_1 |p_j|^2 + Re C_2 |p_jk|^2). For small k a this is
//! Gor'kov's. The imaginary parts are the push of travelling waves. The term n = 3, which is left out, is at most 1.2e-3 of
//! the force in a standing wave, for a heavy sphere of a = lambda/8. It grows as a^4.

use crate::prelude::*;
use crate::propagation::forces::momentum::scattered;
use crate::propagation::jet::{EXPONENTS, degree, factorial, place};
use crate::scene::{Medium, Particle};

/// Part of the sound speed by which it changes for a derivative by it.
const CHANGE: f64 = 1e-5;

/// A real number that is bilinear in the Taylor coefficients c of a pressure: the sum of Re(weight c_t* c_u).
#[derive(Clone, Debug)]
pub(crate) struct Form(pub(crate) Vec<Product>);

/// A product of two Taylor coefficients with these indices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Product {
    pub(crate) terms: [usize; 2],
    pub(crate) weight: Complex64,
}

impl Form {
    /// Returns the value for coefficients, given as real and imaginary part.
    pub(crate) fn value<const N: usize>(&self, [re, im]: [&[f64; N]; 2]) -> f64 {
        let each = |&Product { terms: [t, u], weight }: &Product| {
            weight.re * (re[t] * re[u] + im[t] * im[u]) - weight.im * (re[t] * im[u] - im[t] * re[u])
        };
        self.0.iter().map(each).sum()
    }

    /// Adds the derivatives of `share` times the value by the coefficients, real and imaginary part.
    pub(crate) fn pull<const N: usize>(&self, share: f64, [re, im]: [&[f64; N]; 2], pulls: &mut [[f64; N]; 2]) {
        for &Product { terms: [t, u], weight } in &self.0 {
            let [first, second] = [t, u].map(|term| Complex64::new(re[term], im[term]));
            for (term, pull) in [(t, weight * second), (u, weight.conj() * first)] {
                pulls[0][term] += share * pull.re;
                pulls[1][term] += share * pull.im;
            }
        }
    }
}

/// The forms of a sphere in a medium: its potential, its force and its stiffness.
#[derive(Clone, Debug)]
pub(crate) struct Response {
    pub(crate) potential: Form,
    pub(crate) force: [Form; 3],
    /// -(dF_i/dx_a + dF_a/dx_i)/2 at [i][a].
    pub(crate) hessian: [[Form; 3]; 3],
}

impl Response {
    pub(crate) fn new(particle: Particle, medium: Medium) -> Self {
        Self::of(coefficients(particle, medium))
    }

    /// Returns the derivatives of all forms by the sound speed of the medium, at constant frequency and density.
    pub(crate) fn by_speed(particle: Particle, medium: Medium) -> Self {
        let step = CHANGE * medium.sound_speed;
        let [before, after] = [-step, step]
            .map(|step| coefficients(particle, Medium { sound_speed: medium.sound_speed + step, ..medium }));
        Self::of(core::array::from_fn(|n| (after[n] - before[n]) / (2.0 * step)))
    }

    fn of(coefficients: [Complex64; 3]) -> Self {
        // The sum over n of share C_n times p differentiated along j, k, ... and `ways[0]`, conjugated, times p differentiated
        // along j, k, ... and `ways[1]`.
        let sum = |share: f64, coefficients: [Complex64; 3], all: &[[&[usize]; 2]]| {
            let mut products = Vec::new();
            for (term, inner) in EXPONENTS.iter().enumerate().filter(|(term, _)| degree(*term) < 3) {
                let n = degree(term) as usize;
                let orderings = [1.0, 1.0, 2.0][n] / factorial(term);
                for ways in all {
                    let terms = ways.map(|axes| {
                        let mut exponents = *inner;
                        for &axis in axes {
                            exponents[axis] += 1;
                        }
                        place(exponents)
                    });
                    let scale = share * orderings * factorial(terms[0]) * factorial(terms[1]);
                    products.push(Product { terms, weight: scale * coefficients[n] });
                }
            }
            Form(products)
        };
        Self {
            potential: sum(-0.5, coefficients.map(|c| c.re.into()), &[[&[], &[]]]),
            force: [0, 1, 2].map(|i| sum(1.0, coefficients, &[[&[], &[i]]])),
            hessian: [0, 1, 2].map(|i| {
                [0, 1, 2].map(|a| {
                    // The same order of sums on both sides of the diagonal.
                    let (i, a) = (i.min(a), i.max(a));
                    let all: [[&[usize]; 2]; 4] = [[&[a], &[i]], [&[i], &[a]], [&[], &[i, a]], [&[], &[i, a]]];
                    sum(-0.5, coefficients, &all)
                })
            }),
        }
    }
}

/// Returns C_0, C_1 and C_2 of the module's head.
pub(crate) fn coefficients(particle: Particle, medium: Medium) -> [Complex64; 3] {
    let s = scattered(particle, medium, 3);
    let [w0, w1, w2] = [0, 1, 2].map(|n| {
        let (low, high) = (s[n], s[n + 1].conj());
        Complex64::I * (low + high + 2.0 * low * high).conj()
    });
    let (k, square) = (medium.wavenumber(), medium.sound_speed * medium.sound_speed);
    let unit = core::f64::consts::TAU / (medium.density * square * k * k * k);
    [unit * (w0 + w1.conj() - 1.5 * w2), 3.0 * unit / (k * k) * (w1 + w2.conj()), 7.5 * unit / (k * k * k * k) * w2]
}

#[cfg(test)]
#[path = "tests/response.rs"]
mod tests;
