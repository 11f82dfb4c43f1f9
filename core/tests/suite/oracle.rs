//! Double-precision reference for the kernels: plain loops that follow the definitions.
//!
//! SI units, time factor e^{-jwt}: an outgoing wave runs as e^{+jkr}. Propagation are stored
//! transducer-major, `propagation[i][j]` being transducer i at point j.

use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

const ZERO: Complex64 = Complex64::new(0.0, 0.0);

/// Part of E(0) by which a later candidate has to beat an earlier one, so that rounding does not
/// decide between candidates that are equal on paper.
const TIE: f64 = 1e-12;

/// D of the T4010A1 at 0, 10, ..., 90 degrees.
const T4010A1: [f64; 10] = [1.0, 1.0, 1.0, 0.8913, 0.7079, 0.5012, 0.3548, 0.2512, 0.1995, 0.1778];

/// Far-field pattern of one transducer. All but `Point` are baffled: silent behind.
#[derive(Clone, Copy, Debug)]
pub enum Directivity {
    /// Radiates alike in every direction, also backwards.
    Point,
    /// Circular piston of this radius.
    Piston(f64),
    /// Strip of this width.
    Sinc(f64),
    /// Cosine of the angle to this power.
    Cos(f64),
    /// Measured pattern, interpolated.
    T4010a1,
}

/// An array of transducers in a medium. Normals may have any length; `response` is `c_i`,
/// `source_pressure` is in Pa m and `absorption` in Np/m.
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
/// The quotient is integrated as a whole, hence no loss of digits at small x. The integrand is
/// smooth and periodic, so the trapezoid rule converges exponentially once nodes outnumber x.
fn jinc(x: f64) -> f64 {
    let nodes = 256;
    let mut sum = 0.0;
    for m in 1..nodes {
        let t = PI * f64::from(m) / f64::from(nodes);
        sum += (x * t.cos()).cos() * t.sin().powi(2);
    }
    2.0 * sum / f64::from(nodes)
}

/// Monotone cubic (Fritsch-Butland slopes) through values 1 apart, the first at x = 0.
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

/// Pattern towards an angle given by its cosine and sine, `wavenumber` in rad/m.
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

/// Pressure at each point per unit of drive, `[i][j]`. No point may sit on a transducer.
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
            // From the cross product: sqrt(1 - cos^2) loses digits near the axis.
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

/// Pressure at each point under the drive.
pub fn field(propagation: &[Vec<Complex64>], drive: &[Complex64]) -> Vec<Complex64> {
    let at = |j: usize| propagation.iter().zip(drive).map(|(row, q)| row[j] * q).sum();
    (0..propagation[0].len()).map(at).collect()
}

/// The highest pressure that drives of at most 1 can give at each point alone.
pub fn reach(propagation: &[Vec<Complex64>]) -> Vec<f64> {
    let at = |j: usize| propagation.iter().map(|row| row[j].norm()).sum();
    (0..propagation[0].len()).map(at).collect()
}

/// Factor s for which the sum of `(s t / p1)^2` over points of weight > 0 is 1.
///
/// Targets of 0 add nothing. A target out of reach gives 0, no target above 0 gives infinity.
pub fn balanced_factor(reach: &[f64], targets: &[f64], weights: &[f64]) -> f64 {
    let part = |j: usize| (targets[j] / reach[j]).powi(2);
    let counted = (0..targets.len()).filter(|&j| weights[j] > 0.0 && targets[j] > 0.0);
    1.0 / counted.map(part).sum::<f64>().sqrt()
}

/// The energy that the greedy search lowers.
#[derive(Clone, Copy, Debug)]
pub enum Objective {
    /// Sum of `w (t - |P|)^2`.
    L2,
    /// Sum of `w |t - |P||`.
    L1,
}

/// The greedy search of Suzuki et al. 2021 (Algorithm 2). Points of weight 0 take no part; there
/// are `phases` per turn and `amplitudes` evenly spaced up to 1; `order` is a permutation.
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
    /// Drive found by walking along the order once.
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

    /// For each step along the order, the energy with this drive's value less the least among the
    /// candidates, over E(0) unless that is 0. Below 0 for a value between candidates that beats all.
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

    /// As [`Search::regrets`] for an exchange: each step takes the transducer's part in `start` out of the field before, and
    /// its candidates are those within `change` rad of that part's phase, or `start` where there are none.
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

    /// Candidates for transducer i, each with the change of energy it makes. None where the
    /// transducer reaches no point; phase 0 alone in silence, where all phases are equal.
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

    /// E(0).
    fn silent_energy(&self) -> f64 {
        let cost = |j: usize| match self.objective {
            Objective::L2 => self.weights[j] * self.targets[j].powi(2),
            Objective::L1 => self.weights[j] * self.targets[j].abs(),
        };
        self.live().map(cost).sum()
    }

    /// E(P + G q) - E(P), summed as differences: one transducer changes a large field by little,
    /// and two whole energies would cancel.
    fn change(&self, field: &[Complex64], i: usize, q: Complex64) -> f64 {
        let mut total = 0.0;
        for j in self.live() {
            let step = self.propagation[i][j] * q;
            let both = field[j].norm() + (field[j] + step).norm();
            // |P + s|^2 - |P|^2 = Re(conj(s) (2 P + s)), over the sum of both magnitudes.
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

/// The rule that limits a drive to what the transducers can play.
#[derive(Clone, Copy, Debug)]
pub enum AmplitudeLimit {
    /// Magnitudes above 1 become 1.
    Clamp,
    /// The largest magnitude becomes 1, the ratios stay.
    Normalize,
    /// Every magnitude becomes 1, but 0 stays 0.
    Full,
}

/// Sum of the back-propagated single foci, then limited. Points out of reach add nothing.
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

/// How well magnitudes meet their targets: sums of both compared, spread, minimum over maximum
/// and mean of `|p| / t`, weighted squared error, and the most at points of target 0.
#[derive(Clone, Copy, Debug)]
pub struct Metrics {
    pub accuracy: f64,
    pub sigma: f64,
    pub uniformity: f64,
    pub level: f64,
    pub residual: f64,
    pub leak: f64,
}

/// Metrics of the magnitudes `pressures`; some point must have target > 0 and weight > 0.
pub fn metrics(pressures: &[f64], targets: &[f64], weights: &[f64]) -> Metrics {
    let live = (0..targets.len()).filter(|&j| weights[j] > 0.0);
    let (foci, quiet): (Vec<usize>, Vec<usize>) = live.partition(|&j| targets[j] > 0.0);
    let sum = |of: &dyn Fn(usize) -> f64| foci.iter().map(|&j| of(j)).sum::<f64>();
    let max = |of: &[f64], at: &[usize]| at.iter().map(|&j| of[j]).fold(0.0, f64::max);
    let ratios: Vec<f64> = pressures.iter().zip(targets).map(|(p, t)| p / t).collect();
    let count = foci.len() as f64;
    let level = sum(&|j| ratios[j]) / count;
    // In silence there is no largest ratio to divide by; sigma and uniformity are then 0.
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
