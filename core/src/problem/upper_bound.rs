//! Upper bound on the level that any drive can reach, from convex duality.
//!
//! With G_ji, targets t_j and h_ji = G_ji/t_j, the level of a drive q with |q_i| <= 1 is s = `min_j |sum_i h_ji q_i|`. Let h_j
//! be the vector of all h_ji, P_j the pressure at point j. For any weights w_j >= 0 of sum 1 and any d_i > 0 with diag(d) >=
//! `sum_j w_j h_j h_j^H` (as matrices over the transducers),
//!
//! ```text
//! s^2 <= sum_j w_j |P_j|^2 <= q^H diag(d) q <= sum_i d_i
//! ```
//!
//! By Schur's complement, that condition is the same as one on an M x M matrix, where h_i is now the vector over the points and
//! W = diag(w): `W^{1/2} (sum_i h_i h_i^H/d_i) W^{1/2} <= 1`. So any w and d give a bound, `s^2 <= lambda sum_i d_i`, with
//! lambda the largest eigenvalue of that matrix: the certificate. The best certificate is the value of the semidefinite
//! relaxation of the problem (the dual of "max s^2 such that Q >= 0, Q_ii <= 1, `h_j^H Q h_j >= s^2`").
//!
//! Good w and d come from solving the relaxation like weighted Gerchberg-Saxton. Each transducer has a unit vector of [`RANK`]
//! components instead of one number (Burer and Monteiro 2003), and each point a vector of pressures. Points with too low a
//! level gain weight. d_i is the length by which the vector of transducer i is normalised.

use crate::kernels::double::SPAN;
use crate::prelude::*;
use crate::problem::Problem;
use crate::problem::optimum::{self, Effort, ROUNDING};
use crate::workspace::Workspace;

/// The most points that the bound uses. The certificate takes time O(N M^2 + M^3), the search for it a hundred times O(N M).
const MOST_POINTS: usize = 400;

/// The most points for which the quick bound is computed.
pub(crate) const FEW_POINTS: usize = 64;

/// The number of components for each transducer: beyond 12 nothing was gained at M = 64, N = 400.
const RANK: usize = 12;

/// The most steps for up to [`FEW_POINTS`] points.
const STEPS: usize = 2000;
/// The most steps for more points.
const STEPS_OF_MANY: usize = 40;
/// The number of steps from one certificate to the next.
const CHECK: usize = 20;

/// The search ends if the certificate exceeds the relaxation's own level by less than this part.
const NEAR: f64 = 3e-4;

/// The limits of the search over the phases of few points. The search takes up to half a second at 1000 transducers.
const EFFORT: Effort = Effort { gap: 5e-5, boxes: 20_000 };

type Lanes = [Complex64; RANK];

/// Returns an upper bound on the level x = min |p_j| / target_j over the points with a pressure and a weight above 0. No drive
/// with |q| <= 1, quantised or not, exceeds it.
///
/// For up to three points it is the highest possible level, to 1e-4, and for four mostly to 1 %, by branch and bound over the
/// points' phases (`problem::optimum`). For five points and more it is the value of a relaxation, to 0.1 % for most scenes: in
/// the random scenes of Suzuki et al. 2021 it is 8 to 9 % above the best known field. Above 64 points the search is shorter;
/// above 400 it is the bound for 400 of them. It is 0 if no transducer reaches the points. Deterministic, in double precision;
/// time O(N M) for each of some hundred steps.
///
/// # Errors
/// A stop by the caller.
pub fn bound(problem: &Problem, control: &mut Control) -> Result<f64> {
    let rows = Rows::new(problem, MOST_POINTS, control)?;
    if rows.count() == 0 {
        return Ok(0.0);
    }
    let mut least = f64::INFINITY;
    if rows.points <= optimum::MOST {
        let set = problem.propagation().instruction_set();
        let planes = rows.planes();
        let work = Workspace::new();
        let optimum =
            optimum::search(set, planes.each_ref().map(|plane| &plane[..]), rows.points, EFFORT, &work, control)?;
        least = optimum.bound;
        if least <= (1.0 + 2.0 * EFFORT.gap) * optimum.level {
            return Ok(least);
        }
    }
    let mut weights = vec![1.0 / rows.points as f64; rows.points];
    let mut share = vec![0.0; rows.count()];
    let mut units = start(rows.count());
    let mut field = rows.field(&units, control)?;
    let mut reached = 0.0_f64;
    for step in 1..=if rows.points > FEW_POINTS { STEPS_OF_MANY } else { STEPS } {
        let levels: Vec<f64> = field.iter().map(norm).collect();
        reached = reached.max(levels.iter().copied().fold(f64::INFINITY, f64::min));
        let mean = levels.iter().sum::<f64>() / levels.len() as f64;
        // Points with too low a level gain weight. The gain becomes smaller from step to step.
        let pace = 1.0 / (1.0 + step as f64 / 10.0);
        for (weight, level) in weights.iter_mut().zip(&levels) {
            *weight *= crate::math::pow((mean / level.max(1e-6 * mean)).max(1e-6), pace);
        }
        let sum: f64 = weights.iter().sum();
        for (weight, pressure) in weights.iter_mut().zip(&mut field) {
            *weight /= sum;
            *pressure = pressure.map(|p| p * *weight);
        }
        rows.back(&field, &mut units, &mut share, control)?;
        field = rows.field(&units, control)?;
        if step % CHECK == 0 {
            least = least.min(rows.certificate(&weights, &share, control)?);
            if least <= (1.0 + NEAR) * reached {
                break;
            }
        }
    }
    Ok(least)
}

/// Returns a quick bound, up to 1.5 times the best one: with equal weights, and d_i the norm of each transducer's row of the
/// propagation matrix G.
///
/// # Errors
/// A stop by the caller.
pub(crate) fn rough_bound(problem: &Problem, control: &mut Control) -> Result<f64> {
    let rows = Rows::new(problem, MOST_POINTS, control)?;
    let share: Vec<f64> = rows.iter().map(|row| sqrt(row.iter().map(Complex64::norm_sqr).sum::<f64>())).collect();
    rows.certificate(&vec![1.0 / rows.points as f64; rows.points], &share, control)
}

/// Returns random unit vectors.
fn start(count: usize) -> Vec<Lanes> {
    let mut rng = Rng::new(0);
    let mut number = || 2.0 * rng.uniform() - 1.0;
    let mut units: Vec<Lanes> = (0..count).map(|_| [(); RANK].map(|()| Complex64::new(number(), number()))).collect();
    for unit in &mut units {
        let length = norm(unit);
        *unit = unit.map(|x| x / length);
    }
    units
}

fn norm(lanes: &Lanes) -> f64 {
    sqrt(lanes.iter().map(Complex64::norm_sqr).sum())
}

fn add(sum: &mut Lanes, factor: Complex64, lanes: &Lanes) {
    for (sum, x) in sum.iter_mut().zip(lanes) {
        *sum += factor * x;
    }
}

/// The vectors h_i of the transducers that have an effect.
struct Rows {
    entries: Vec<Complex64>,
    points: usize,
}

impl Rows {
    /// Returns the rows for at most `most` points, evenly chosen in their order. A bound for some of the points is a
    /// bound for all, because the level of some points is at least the level of all.
    fn new(problem: &Problem, most: usize, control: &mut Control) -> Result<Self> {
        let (propagation, mut targeted) = (&problem.targets.propagation, problem.targeted());
        let all = targeted.len();
        targeted = (0..all.min(most)).map(|k| targeted[k * all / all.min(most)]).collect();
        let mut entries = Vec::new();
        for i in 0..propagation.transducers() {
            control.pulse()?;
            let row = targeted.iter().map(|&j| propagation.exact(j, i) / problem.targets_in_pascals()[j]);
            let begin = entries.len();
            entries.extend(row);
            if entries[begin..].iter().all(|h: &Complex64| h.norm_sqr() == 0.0) {
                entries.truncate(begin);
            }
        }
        Ok(Self { entries, points: targeted.len() })
    }

    fn count(&self) -> usize {
        self.entries.len() / self.points
    }

    /// The real and the imaginary part, point by point, padded with zeros.
    fn planes(&self) -> [Vec<f64>; 2] {
        let lanes = self.count().next_multiple_of(SPAN);
        let mut planes = [(); 2].map(|()| vec![0.0; self.points * lanes]);
        for (i, row) in self.iter().enumerate() {
            for (j, h) in row.iter().enumerate() {
                (planes[0][j * lanes + i], planes[1][j * lanes + i]) = (h.re, h.im);
            }
        }
        planes
    }

    fn iter(&self) -> impl Iterator<Item = &[Complex64]> {
        self.entries.chunks_exact(self.points)
    }

    /// Returns P_j = `sum_i h_ji v_i` for the unit vectors v_i.
    fn field(&self, units: &[Lanes], control: &mut Control) -> Result<Vec<Lanes>> {
        let mut field = vec![[Complex64::ZERO; RANK]; self.points];
        for (row, unit) in self.iter().zip(units) {
            control.pulse()?;
            for (pressure, &h) in field.iter_mut().zip(row) {
                add(pressure, h, unit);
            }
        }
        Ok(field)
    }

    /// Computes v_i = y_i/|y_i| with y_i = `sum_j conj(h_ji) w_j P_j`; |y_i| becomes the share of transducer i.
    fn back(&self, weighted: &[Lanes], units: &mut [Lanes], share: &mut [f64], control: &mut Control) -> Result<()> {
        for ((row, unit), share) in self.iter().zip(units).zip(share) {
            control.pulse()?;
            let mut sum = [Complex64::ZERO; RANK];
            for (pressure, h) in weighted.iter().zip(row) {
                add(&mut sum, h.conj(), pressure);
            }
            *share = norm(&sum);
            if *share > 0.0 {
                *unit = sum.map(|x| x / *share);
            }
        }
        Ok(())
    }

    /// The bound on s that weights w and shares d prove: sqrt(lambda `sum_i d_i`).
    fn certificate(&self, weights: &[f64], share: &[f64], control: &mut Control) -> Result<f64> {
        // Any d_i > 0 is allowed, but one near 0 would make lambda huge.
        let floor = 1e-6 * share.iter().copied().fold(0.0, f64::max);
        let roots: Vec<f64> = weights.iter().copied().map(sqrt).collect();
        let m = self.points;
        let mut matrix = vec![Complex64::ZERO; m * m];
        let mut total = 0.0;
        for (row, &share) in self.iter().zip(share) {
            control.pulse()?;
            let share = share.max(floor);
            total += share;
            for j in 0..m {
                let left = row[j] * (roots[j] / share);
                for k in 0..=j {
                    matrix[j * m + k] += left * (row[k].conj() * roots[k]);
                }
            }
        }
        let bound = sqrt(largest_eigenvalue(&matrix, m, control)? * total) * (1.0 + ROUNDING);
        // If shares underflow, the result is NaN and proves nothing.
        Ok(if bound.is_nan() { f64::INFINITY } else { bound })
    }
}

/// Returns an upper bound, accurate to 1e-6, on the largest eigenvalue of a Hermitian positive semidefinite matrix A; only its
/// lower half is read. It is the least x found for which x - A has a Cholesky factor.
fn largest_eigenvalue(matrix: &[Complex64], size: usize, control: &mut Control) -> Result<f64> {
    let entry = |j: usize, k: usize| if k <= j { matrix[j * size + k] } else { matrix[k * size + j] };
    let row = |j: usize| (0..size).map(|k| entry(j, k).norm()).sum::<f64>();
    // NaN must stay NaN.
    let more = |most: f64, row: f64| if row <= most || most.is_nan() { most } else { row };
    let mut high = (0..size).map(row).fold(0.0, more) * (1.0 + ROUNDING);
    let mut low = 0.0;
    let mut spare = vec![Complex64::ZERO; size * size];
    while high - low > 1e-6 * high {
        let middle = 0.5 * (low + high);
        if is_positive(matrix, size, middle, &mut spare, control)? { high = middle } else { low = middle }
    }
    Ok(high)
}

/// Whether x - A is positive definite.
fn is_positive(
    matrix: &[Complex64],
    size: usize,
    x: f64,
    factor: &mut [Complex64],
    control: &mut Control,
) -> Result<bool> {
    for j in 0..size {
        control.pulse()?;
        for k in 0..=j {
            let dot: Complex64 = (0..k).map(|l| factor[j * size + l] * factor[k * size + l].conj()).sum();
            let entry = if j == k { Complex64::new(x, 0.0) } else { Complex64::ZERO };
            let rest = entry - matrix[j * size + k] - dot;
            if j > k {
                factor[j * size + k] = rest / factor[k * size + k].re;
            } else if rest.re > 0.0 {
                factor[j * size + j] = Complex64::new(sqrt(rest.re), 0.0);
            } else {
                return Ok(false);
            }
        }
    }
    Ok(true)
}

#[cfg(test)]
#[path = "tests/upper_bound.rs"]
mod tests;
