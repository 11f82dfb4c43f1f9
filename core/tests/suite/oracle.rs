//! Oracle: a reference in double precision for the kernels: plain loops that follow the definitions.
//!
//! SI units and the time factor e^{-jwt}: an outgoing wave is e^{+jkr}. `propagation[i][j]` is the pressure of transducer i at
//! point j.

use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

const ZERO: Complex64 = Complex64::new(0.0, 0.0);

/// A later candidate must be better than an earlier one by this part of E(0), so that rounding does not decide between
/// candidates that are mathematically equal.
const TIE: f64 = 1e-12;

/// The directivity D of the T4010A1 at 0, 10, ..., 90 degrees.
const T4010A1: [f64; 10] = [1.0, 1.0, 1.0, 0.8913, 0.7079, 0.5012, 0.3548, 0.2512, 0.1995, 0.1778];

/// The directivity of a transducer. All except `Point` are baffled: 0 behind.
#[derive(Clone, Copy, Debug)]
pub enum Directivity {
    /// Equal in all directions, also behind.
    Point,
    /// A circular piston with this radius.
    Piston(f64),
    /// A strip of this width.
    Sinc(f64),
    /// The cosine of the angle to this power.
    Cos(f64),
    /// Measured values, interpolated.
    T4010a1,
}

/// An array of transducers in a medium. Normals may have any length. `response` is `c_i`, `source_pressure` is in Pa m and
/// `absorption` in Np/m.
#[derive(Clone, Debug)]
pub struct Model {
    pub positions: Vec<[f64; 3]>,
    pub normals: Vec<[f64; 3]>,
    pub response: Vec<Complex64>,
    pub source_pressure: f64,
    pub directivity: Directivity,
    pub frequency: f64,
    pub sound_speed: f64,
    pub absorption: f64,
}

fn norm(a: [f64; 3]) -> f64 {
    (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt()
}

/// `2 J1(x) / x`, from Poisson's integral `(2/pi) int_0^pi cos(x cos t) sin(t)^2 dt`.
///
/// The quotient is integrated as a whole, so no digits are lost for small x. The integrand is smooth and periodic, so the
/// trapezoidal rule converges exponentially as soon as there are more nodes than x.
fn jinc(x: f64) -> f64 {
    let nodes = 256;
    let mut sum = 0.0;
    for m in 1..nodes {
        let t = PI * f64::from(m) / f64::from(nodes);
        sum += (x * t.cos()).cos() * t.sin().powi(2);
    }
    2.0 * sum / f64::from(nodes)
}

/// The monotone cubic with Fritsch-Butland slopes through values at x = 0, 1, 2, ...
fn monotone_cubic(values: &[f64], x: f64) -> f64 {
    let last = values.len() - 1;
    let secant = |m: usize| values[m + 1] - values[m];
    let end = |near: f64, far: f64| {
        let slope = 1.5 * near - 0.5 * far;
        let bound = if near * far > 0.0 { f64::INFINITY } else { 3.0 * near.abs() };
        if slope * near > 0.0 { slope.clamp(-bound, bound) } else { 0.0 }
    };
    let slope = |m: usize| match m {
        0 => end(secant(0), secant(1)),
        m if m == last => end(secant(last - 1), secant(last - 2)),
        m if secant(m - 1) * secant(m) <= 0.0 => 0.0,
        m => 2.0 / (1.0 / secant(m - 1) + 1.0 / secant(m)),
    };
    let m = (1..last).filter(|&m| m as f64 <= x).count();
    let (u, v) = (x - m as f64, (m + 1) as f64 - x);
    (values[m] * (1.0 + 2.0 * u) + slope(m) * u) * v * v + (values[m + 1] * (1.0 + 2.0 * v) - slope(m + 1) * v) * u * u
}

/// The directivity at an angle, given by its cosine and sine; `wavenumber` is in rad/m.
fn pattern(directivity: Directivity, wavenumber: f64, cos: f64, sin: f64) -> f64 {
    match directivity {
        Directivity::Point => 1.0,
        _ if cos < 0.0 => 0.0,
        Directivity::Piston(radius) => jinc(wavenumber * radius * sin),
        Directivity::Sinc(width) => match 0.5 * wavenumber * width * sin {
            0.0 => 1.0,
            x => x.sin() / x,
        },
        Directivity::Cos(power) => cos.powf(power),
        Directivity::T4010a1 => monotone_cubic(&T4010A1, sin.atan2(cos).to_degrees() / 10.0),
    }
}

/// Returns the pressure of each transducer i at each point j for drive 1, as `[i][j]`. No point may be on a transducer.
pub fn propagation(model: &Model, points: &[[f64; 3]]) -> Vec<Vec<Complex64>> {
    let wavenumber = TAU * model.frequency / model.sound_speed;
    let mut rows = Vec::new();
    for (i, at) in model.positions.iter().enumerate() {
        let [nx, ny, nz] = model.normals[i];
        let mut row = Vec::new();
        for point in points {
            let [dx, dy, dz] = [point[0] - at[0], point[1] - at[1], point[2] - at[2]];
            let r = norm([dx, dy, dz]);
            let unit = r * norm([nx, ny, nz]);
            let cos = (nx * dx + ny * dy + nz * dz) / unit;
            // The sine comes from the cross product, because sqrt(1 - cos^2) loses digits near the axis.
            let sin = norm([ny * dz - nz * dy, nz * dx - nx * dz, nx * dy - ny * dx]) / unit;
            let size = model.source_pressure / r
                * pattern(model.directivity, wavenumber, cos, sin)
                * (-model.absorption * r).exp();
            row.push(Complex64::from_polar(1.0, wavenumber * r) * size * model.response[i]);
        }
        rows.push(row);
    }
    rows
}

/// Returns the pressure at each point for a drive.
pub fn field(propagation: &[Vec<Complex64>], drive: &[Complex64]) -> Vec<Complex64> {
    let at = |j: usize| propagation.iter().zip(drive).map(|(row, q)| row[j] * q).sum();
    (0..propagation[0].len()).map(at).collect()
}

/// Returns the highest pressure at each point alone that drives with |q| <= 1 can give.
pub fn reach(propagation: &[Vec<Complex64>]) -> Vec<f64> {
    let at = |j: usize| propagation.iter().map(|row| row[j].norm()).sum();
    (0..propagation[0].len()).map(at).collect()
}

/// Returns the factor s for which the sum of `(s t / p1)^2` over the points of weight above 0 is 1.
///
/// Targets of 0 add nothing. If a target cannot be reached, s is 0; without targets above 0 it is infinity.
pub fn balanced_factor(reach: &[f64], targets: &[f64], weights: &[f64]) -> f64 {
    let part = |j: usize| (targets[j] / reach[j]).powi(2);
    let counted = (0..targets.len()).filter(|&j| weights[j] > 0.0 && targets[j] > 0.0);
    1.0 / counted.map(part).sum::<f64>().sqrt()
}

/// The energy that the greedy search minimises.
#[derive(Clone, Copy, Debug)]
pub enum Objective {
    /// Sum of `w (t - |P|)^2`.
    L2,
    /// Sum of `w |t - |P||`.
    L1,
}

/// The greedy search of Suzuki et al. 2021 (Algorithm 2). Points of weight 0 are ignored. There are `phases` phases per turn
/// and `amplitudes` evenly spaced amplitudes up to 1; `order` is a permutation of the transducers.
#[derive(Clone, Copy, Debug)]
pub struct Search<'a> {
    pub propagation: &'a [Vec<Complex64>],
    pub targets: &'a [f64],
    pub weights: &'a [f64],
    pub phases: usize,
    pub amplitudes: usize,
    pub objective: Objective,
    pub order: &'a [usize],
}

impl Search<'_> {
    /// Returns the drive after one pass through the order.
    pub fn greedy(&self) -> Vec<Complex64> {
        let tie = TIE * self.silent_energy();
        let mut drive = vec![ZERO; self.propagation.len()];
        let mut field = vec![ZERO; self.targets.len()];
        for &i in self.order {
            let mut best = f64::INFINITY;
            for (q, change) in self.candidates(&field, i) {
                if change < best - tie {
                    best = change;
                    drive[i] = q;
                }
            }
            self.add(&mut field, i, drive[i]);
        }
        drive
    }

    /// Returns for each step of the order the energy with this drive's value, less the smallest energy of all candidates,
    /// divided by E(0) unless that is 0. The result is negative if the value is better than all candidates.
    pub fn regrets(&self, drive: &[Complex64]) -> Vec<f64> {
        let unit = Some(self.silent_energy()).filter(|&energy| energy > 0.0).unwrap_or(1.0);
        let mut field = vec![ZERO; self.targets.len()];
        let mut regrets = Vec::new();
        for &i in self.order {
            let changes = self.candidates(&field, i).into_iter().map(|(_, change)| change);
            let least = changes.reduce(f64::min);
            let regret = |least| (self.change(&field, i, drive[i]) - least) / unit;
            regrets.push(least.map_or(0.0, regret));
            self.add(&mut field, i, drive[i]);
        }
        regrets
    }

    /// Does the same as [`Search::regrets`] for an exchange. Each step first removes the transducer's part of `start` from the
    /// field. Its candidates are those within `change` rad of the phase in `start`, or the value in `start` if there are none.
    pub fn exchange_regrets(&self, start: &[Complex64], drive: &[Complex64], change: f64) -> Vec<f64> {
        let unit = Some(self.silent_energy()).filter(|&energy| energy > 0.0).unwrap_or(1.0);
        let mut field = field(self.propagation, start);
        let mut regrets = Vec::new();
        for &i in self.order {
            self.add(&mut field, i, -start[i]);
            let near = |q: Complex64| start[i] == ZERO || (q * start[i].conj()).arg().abs() <= change + 1e-6;
            let candidates = self.candidates(&field, i).into_iter().filter(|&(q, _)| near(q));
            let least = candidates.map(|(_, change)| change).reduce(f64::min);
            let least = least.unwrap_or_else(|| self.change(&field, i, start[i]));
            regrets.push((self.change(&field, i, drive[i]) - least) / unit);
            self.add(&mut field, i, drive[i]);
        }
        regrets
    }

    fn live(&self) -> impl Iterator<Item = usize> {
        (0..self.targets.len()).filter(|&j| self.weights[j] > 0.0)
    }

    fn add(&self, field: &mut [Complex64], i: usize, q: Complex64) {
        for j in self.live() {
            field[j] += self.propagation[i][j] * q;
        }
    }

    /// Returns the candidates for transducer i, each with its change of the energy. There are none if the transducer reaches no
    /// point. In a silent field only phase 0 is a candidate, because all phases are equal.
    fn candidates(&self, field: &[Complex64], i: usize) -> Vec<(Complex64, f64)> {
        let mut all = Vec::new();
        if self.live().all(|j| self.propagation[i][j] == ZERO) {
            return all;
        }
        let silent = self.live().all(|j| field[j] == ZERO);
        for k in 0..self.amplitudes {
            let amplitude = (k + 1) as f64 / self.amplitudes as f64;
            for l in 0..if silent { 1 } else { self.phases } {
                let q = Complex64::from_polar(amplitude, TAU * l as f64 / self.phases as f64);
                all.push((q, self.change(field, i, q)));
            }
        }
        all
    }

    /// The energy E(0) without sound.
    fn silent_energy(&self) -> f64 {
        let cost = |j: usize| match self.objective {
            Objective::L2 => self.weights[j] * self.targets[j].powi(2),
            Objective::L1 => self.weights[j] * self.targets[j].abs(),
        };
        self.live().map(cost).sum()
    }

    /// Returns E(P + G q) - E(P) as a sum of differences. One transducer changes a large field only slightly, so the difference
    /// of two whole energies would lose digits.
    fn change(&self, field: &[Complex64], i: usize, q: Complex64) -> f64 {
        let mut total = 0.0;
        for j in self.live() {
            let step = self.propagation[i][j] * q;
            let both = field[j].norm() + (field[j] + step).norm();
            // |P + s|^2 - |P|^2 = Re(conj(s) (2 P + s)); divided by the sum of both moduli it is their difference.
            let squares = (step.conj() * (2.0 * field[j] + step)).re;
            let rise = if both > 0.0 { squares / both } else { 0.0 };
            let gap = self.targets[j] - field[j].norm();
            let cost = match self.objective {
                Objective::L2 => rise * (rise - 2.0 * gap),
                Objective::L1 => (gap - rise).abs() - gap.abs(),
            };
            total += self.weights[j] * cost;
        }
        total
    }
}

/// How drives are limited to a modulus of at most 1.
#[derive(Clone, Copy, Debug)]
pub enum AmplitudeLimit {
    /// Moduli above 1 become 1.
    Clamp,
    /// The largest modulus becomes 1; the ratios stay the same.
    Normalize,
    /// Every modulus becomes 1, except that 0 stays 0.
    Full,
}

/// Returns the sum of the back-propagated single foci, limited. Points out of reach add nothing.
pub fn naive(propagation: &[Vec<Complex64>], targets: &[f64], limit: AmplitudeLimit) -> Vec<Complex64> {
    let mut drive = vec![ZERO; propagation.len()];
    for (j, &target) in targets.iter().enumerate() {
        let power: f64 = propagation.iter().map(|row| row[j].norm_sqr()).sum();
        for (q, row) in drive.iter_mut().zip(propagation) {
            if power > 0.0 {
                *q += row[j].conj() * target / power;
            }
        }
    }
    let largest = drive.iter().map(|q| q.norm()).fold(0.0, f64::max);
    for q in drive.iter_mut().filter(|q| **q != ZERO) {
        *q /= match limit {
            AmplitudeLimit::Clamp => q.norm().max(1.0),
            AmplitudeLimit::Normalize => largest,
            AmplitudeLimit::Full => q.norm(),
        };
    }
    drive
}

/// How well moduli meet their targets: ratio of the sums, spread, minimum over maximum and mean of `|p| / t`, weighted squared
/// error, and the maximum at points of target 0.
#[derive(Clone, Copy, Debug)]
pub struct Metrics {
    pub accuracy: f64,
    pub sigma: f64,
    pub uniformity: f64,
    pub level: f64,
    pub residual: f64,
    pub leak: f64,
}

/// Returns the metrics of the moduli `pressures`. At least one point must have a target and a weight above 0.
pub fn metrics(pressures: &[f64], targets: &[f64], weights: &[f64]) -> Metrics {
    let live = (0..targets.len()).filter(|&j| weights[j] > 0.0);
    let (foci, quiet): (Vec<usize>, Vec<usize>) = live.partition(|&j| targets[j] > 0.0);
    let sum = |of: &dyn Fn(usize) -> f64| foci.iter().map(|&j| of(j)).sum::<f64>();
    let max = |of: &[f64], at: &[usize]| at.iter().map(|&j| of[j]).fold(0.0, f64::max);
    let ratios: Vec<f64> = pressures.iter().zip(targets).map(|(p, t)| p / t).collect();
    let count = foci.len() as f64;
    let level = sum(&|j| ratios[j]) / count;
    // In a silent field there is no largest ratio to divide by; sigma and uniformity are then 0.
    let unit = Some(max(&ratios, &foci)).filter(|&most| most > 0.0).unwrap_or(1.0);
    let least = foci.iter().map(|&j| ratios[j]).fold(f64::INFINITY, f64::min);
    Metrics {
        accuracy: sum(&|j| pressures[j]) / sum(&|j| targets[j]),
        sigma: (sum(&|j| (ratios[j] - level).powi(2)) / count).sqrt() / unit,
        uniformity: least / unit,
        level,
        residual: sum(&|j| weights[j] * (targets[j] - pressures[j]).powi(2))
            / sum(&|j| weights[j] * targets[j].powi(2)),
        leak: max(pressures, &quiet) / max(targets, &foci),
    }
}

mod known;
