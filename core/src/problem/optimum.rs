//! Optimum: the highest level that a drive can give at a few points, by branch and bound over the phases of the points.
//!
//! With G_ji, targets t_j and h_ji = G_ji/t_j, and for given phases of the points v_j = e^{j phase_j}, the level is a concave
//! function of the drives. Its maximum over |q_i| <= 1 is the minimum of the dual problem over weights w_j >= 0 of sum 1:
//!
//! ```text
//! s(v) = min_w sum_i |x_i|                                     x_i = sum_j w_j conj(v_j) h_ji
//!     <= sum_i (|x_i|^2/d_i + d_i)/2                           for any w and d > 0, at any v:
//!      = (sum_j w_j^2 M_jj + sum_i d_i)/2 + sum_{j<k} w_j w_k Re(conj(v_j) v_k M_jk)      M_jk = sum_i h_ji conj(h_ki)/d_i
//! ```
//!
//! The bound is a sum of cosines of phase differences, which is bounded over a box of phases: the certificate. For d_i >= |x_i|
//! the drive conj(x_i)/d_i has |q_i| <= 1, and its level is the level reached. A box whose certificate exceeds the best level
//! is halved. Good weights w come from iteratively reweighted least squares, which minimises the certificate in the middle of
//! the box.

use core::cmp::Ordering;

use crate::kernels::InstructionSet;
use crate::kernels::double::{self, MOST_ROWS};
use crate::math::{cos, sin};
use crate::prelude::*;
use crate::workspace::{Buffer, Workspace};

/// The most points: for more points, there are too many boxes of phases.
pub(crate) const MOST: usize = 5;

/// A generous bound on the rounding of sums in double precision.
pub(crate) const ROUNDING: f64 = 1e-9;

/// The number of intervals into which each phase is cut first.
const CUT: usize = 4;

/// How often the weights of a box are computed, each time from the previous ones.
const TRIES: usize = 4;

/// Better weights are computed for a box if, in its middle, the bound exceeds the level by more than this part of the
/// amount that the box's width adds to the bound.
const WORTH: f64 = 0.1;

/// The shortest step of a phase in rad: near its maximum the level hardly changes.
const SETTLED: f64 = 3e-3;

/// The length of the list that describes a box: its certificate, the phases of its middle, and weights.
const BOX: usize = 1 + 2 * MOST;

/// The term added to the diagonal of the equations for the weights, relative to the mean of the diagonal. Without it, points at
/// the same place make them singular.
const RIDGE: f64 = 1e-12;

/// The number of rows of the matrix in the equations for the weights.
const SIDE: usize = 8;

/// The result of the search.
#[derive(Clone, Copy)]
pub(crate) struct Optimum {
    /// An upper bound: no drive has a higher level.
    pub(crate) bound: f64,
    /// The level of the best drive that was found.
    pub(crate) level: f64,
    /// The phases of the points in rad, and their weights, for that drive. Its phases are those of `sum_j w_j v_j conj(h_ji)`.
    pub(crate) phases: [f64; MOST],
    pub(crate) weights: [f64; MOST],
}

/// The limits at which the search ends: the first one that is reached.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// The search ends if the bound exceeds the level by no more than this part of the level.
    pub(crate) gap: f64,
    /// The search ends after this many boxes.
    pub(crate) boxes: usize,
}

/// Finds the highest level for `points` points, at most [`MOST`]. `re` and `im` contain h, point by point, padded over the
/// transducers.
///
/// # Errors
/// More memory than allowed, a stop by the caller.
pub(crate) fn search(
    set: InstructionSet,
    [re, im]: [&[f64]; 2],
    points: usize,
    effort: Effort,
    work: &Workspace,
    control: &mut Control,
) -> Result<Optimum> {
    let lanes = re.len() / points;
    let taken = bytes(8, &[lanes, points, points]).saturating_add(bytes(16, &[BOX, effort.boxes]));
    control.room("the phases of the points", [lanes, points], taken)?;
    let mut products = work.doubles.take_any(points * points * lanes);
    for (to, [j, k, part]) in products.chunks_exact_mut(lanes).zip(terms(points)) {
        let entry = |plane: &[f64], j: usize, i: usize| plane[j * lanes + i];
        for (i, to) in to.iter_mut().enumerate() {
            let (a, b) = ([entry(re, j, i), entry(im, j, i)], [entry(re, k, i), entry(im, k, i)]);
            *to = if part == 0 { a[0] * b[0] + a[1] * b[1] } else { a[1] * b[0] - a[0] * b[1] };
        }
    }
    let powers = products.chunks_exact(lanes).take(points).map(|row| row.iter().sum::<f64>()).sum::<f64>();
    let best = Optimum { bound: f64::INFINITY, level: 0.0, phases: [0.0; MOST], weights: [0.0; MOST] };
    let least = 1e-9 * sqrt(powers / lanes as f64) / points as f64;
    let mut torus = Torus { set, points, products, half: [0.0; MOST], least, best, left_out: 0.0, gap: effort.gap };
    torus.branch(effort.boxes, work, control)?;
    torus.settle(control)?;
    torus.best.bound *= 1.0 + ROUNDING;
    Ok(torus.best)
}

/// The terms [j, k, part] of each row of products: first |h_j|^2 for each j, then the real (0) and imaginary (1) part of h_j
/// conj(h_k) for each j < k.
fn terms(points: usize) -> impl Iterator<Item = [usize; 3]> {
    let pairs = (0..points).flat_map(move |j| (j + 1..points).flat_map(move |k| [[j, k, 0], [j, k, 1]]));
    (0..points).map(|j| [j, j, 0]).chain(pairs)
}

/// The boxes of phases in the search. The space of phases is a torus, because phases are periodic.
struct Torus<'w> {
    set: InstructionSet,
    points: usize,
    products: Buffer<'w, f64>,
    /// Half the width of a box along each phase. The first phase is fixed at 0.
    half: [f64; MOST],
    /// The least value of d_i (see the module's head).
    least: f64,
    best: Optimum,
    /// The highest certificate among the boxes that need no more work.
    left_out: f64,
    gap: f64,
}

impl Torus<'_> {
    fn branch(&mut self, most: usize, work: &Workspace, control: &mut Control) -> Result<()> {
        let points = self.points;
        let mut count = CUT.pow(points as u32 - 1);
        let [mut boxes, mut next] = [(); 2].map(|()| work.doubles.take(BOX * most.max(count)));
        self.half[1..points].fill(PI / CUT as f64);
        for (k, region) in boxes.as_chunks_mut::<BOX>().0.iter_mut().take(count).enumerate() {
            region[0] = f64::INFINITY;
            for j in 1..points {
                region[1 + j] = (2 * (k / CUT.pow(j as u32 - 1) % CUT) + 1) as f64 * self.half[j];
            }
            region[1 + MOST..][..points].fill(1.0 / points as f64);
        }
        let mut spent = 0;
        for axis in (1..points.max(2)).cycle() {
            let all = &mut boxes.as_chunks_mut::<BOX>().0[..count];
            // The boxes with the highest certificates come first, because they may have the best level.
            all.sort_unstable_by(|a, b| compare(b, a));
            for region in all.iter_mut() {
                control.pulse()?;
                self.measure(region, control)?;
            }
            spent += count;
            let enough = self.best.level * (1.0 + self.gap);
            let done = |region: &&[f64; BOX]| region[0] <= enough;
            self.left_out = all.iter().filter(done).fold(self.left_out, |most, region| most.max(region[0]));
            let open = count - all.iter().filter(done).count();
            if open == 0 || points == 1 || spent + 2 * open > most {
                self.best.bound = all.iter().fold(self.left_out, |most, region| most.max(region[0]));
                break;
            }
            self.half[axis] *= 0.5;
            let halves = next.as_chunks_mut::<BOX>().0.as_chunks_mut::<2>().0;
            for (region, halves) in all.iter().filter(|region| !done(region)).zip(halves) {
                *halves = [*region; 2];
                halves[0][1 + axis] -= self.half[axis];
                halves[1][1 + axis] += self.half[axis];
            }
            core::mem::swap(&mut boxes, &mut next);
            count = 2 * open;
        }
        Ok(())
    }

    /// Improves the phases of the best level by steps that become shorter, as long as the level rises.
    fn settle(&mut self, control: &mut Control) -> Result<()> {
        let mut step = PI / 32.0;
        (self.half, self.gap) = ([0.0; MOST], 0.0);
        while step > SETTLED {
            let before = self.best.level;
            for (axis, turn) in (1..self.points).flat_map(|axis| [(axis, step), (axis, -step)]) {
                control.pulse()?;
                let mut region = [f64::INFINITY; BOX];
                region[1..=MOST].copy_from_slice(&self.best.phases);
                region[1 + MOST..].copy_from_slice(&self.best.weights);
                region[1 + axis] += turn;
                self.measure(&mut region, control)?;
            }
            if self.best.level <= before {
                step *= 0.5;
            }
        }
        Ok(())
    }

    /// Lowers the certificate of a box by better weights. Stores its middle as the best if it has the highest level.
    fn measure(&mut self, region: &mut [f64; BOX], control: &mut Control) -> Result<()> {
        let points = self.points;
        let phases: [f64; MOST] = region[1..=MOST].try_into().expect("a phase each");
        let mut weights: [f64; MOST] = region[1 + MOST..].try_into().expect("a weight each");
        let turned = |j: usize, k: usize| Complex64::new(cos(phases[k] - phases[j]), sin(phases[k] - phases[j]));
        for _ in 0..TRIES {
            let mut factors = [0.0; MOST_ROWS];
            for (factor, [j, k, part]) in factors.iter_mut().zip(terms(points)) {
                let both = weights[j] * weights[k];
                *factor = match part {
                    // |x|^2 in the middle, plus a term for its variation over the box.
                    0 if j == k => both * (1.0 + self.half[j] * self.half[j] / 3.0),
                    0 => 2.0 * both * turned(j, k).re,
                    _ => -2.0 * both * turned(j, k).im,
                };
            }
            let mut sums = [0.0; MOST_ROWS];
            let count = points * points;
            let whole = double::divided(self.set, &self.products, &factors[..count], self.least, &mut sums[..count]);
            // The matrix of Re(conj(v_j) v_k M_jk) for all pairs.
            let mut matrix = [0.0; SIDE * SIDE];
            let mut swing = Swing::default();
            let mut certificate = 0.5 * whole;
            let mut pairs = sums[points..count].as_chunks::<2>().0.iter();
            for j in 0..points {
                matrix[j * SIDE + j] = sums[j];
                certificate += 0.5 * weights[j] * weights[j] * sums[j];
                for k in j + 1..points {
                    let &[re, im] = pairs.next().expect("a sum each");
                    let product = turned(j, k) * Complex64::new(re, im);
                    (matrix[j * SIDE + k], matrix[k * SIDE + j]) = (product.re, product.re);
                    swing.add([j, k], product * (weights[j] * weights[k]), self.half);
                }
            }
            certificate += swing.most(self.half);
            region[0] = region[0].min(certificate);
            let pressure = |j: usize| (0..points).map(|k| matrix[j * SIDE + k] * weights[k]).sum::<f64>();
            let level = (0..points).map(pressure).fold(f64::INFINITY, f64::min);
            if level > self.best.level {
                self.best = Optimum { level, phases, weights, ..self.best };
            }
            region[1 + MOST..].copy_from_slice(&weights);
            let dual = (0..points).map(|j| weights[j] * pressure(j)).sum::<f64>();
            let enough = self.best.level * (1.0 + self.gap);
            if region[0] <= enough || dual - level <= WORTH * (certificate - dual) {
                break;
            }
            let Some(better) = self.reweighted(&matrix, control)? else { break };
            weights = better;
        }
        Ok(())
    }

    /// Returns the weights that minimise the certificate in the middle: A w = 1 over the weights that are not negative, scaled
    /// to the sum 1. Returns `None` if the equations are singular.
    fn reweighted(&self, matrix: &[f64; SIDE * SIDE], control: &mut Control) -> Result<Option<[f64; MOST]>> {
        let (points, mut among) = (self.points, [true; MOST]);
        let mean = (0..points).map(|j| matrix[j * SIDE + j]).sum::<f64>() / points as f64;
        for _ in 0..points {
            let (mut system, mut weights) = ([0.0; SIDE * SIDE], [0.0; SIDE]);
            for j in 0..SIDE {
                let active = j < points && among[j];
                system[j * SIDE + j] = if active { matrix[j * SIDE + j] + RIDGE * mean } else { 1.0 };
                for k in (j + 1..points).filter(|&k| active && among[k]) {
                    system[j * SIDE + k] = matrix[j * SIDE + k];
                }
                weights[j] = if active { 1.0 } else { 0.0 };
            }
            if !double::factor(self.set, &mut system, SIDE, control)? {
                return Ok(None);
            }
            double::solve(self.set, &system, &mut weights);
            let below = (0..points).filter(|&j| weights[j] < 0.0);
            if below.clone().count() == 0 {
                let sum = weights.iter().sum::<f64>();
                return Ok((sum > 0.0).then(|| core::array::from_fn(|j| weights[j] / sum)));
            }
            below.for_each(|j| among[j] = false);
        }
        Ok(None)
    }
}

/// The part of a certificate that is a sum of cosines of phase differences: its value in the middle, and its maximum over the
/// box.
#[derive(Default)]
struct Swing {
    middle: f64,
    /// The derivative along each phase.
    slopes: [f64; MOST],
    /// Bounds on the terms of second and third order of all cosines.
    bent: f64,
    /// The sum of the maxima of the single cosines.
    apart: f64,
}

impl Swing {
    /// Adds the term `|product| cos(c + t)`, where c is the phase of the product, and |t| is at most the sum of two half
    /// widths. It is bounded by cos(c + t) <= cos c - t sin c + max(0, -cos c) t^2/2 + |t|^3/6.
    fn add(&mut self, [j, k]: [usize; 2], product: Complex64, half: [f64; MOST]) {
        let (size, width) = (product.norm(), half[j] + half[k]);
        self.middle += product.re;
        self.slopes[j] += product.im;
        self.slopes[k] -= product.im;
        self.bent += 0.5 * (-product.re).max(0.0) * width * width + size * width * width * width / 6.0;
        let within = width >= PI || product.re >= size * cos(width);
        self.apart += if within { size } else { product.re * cos(width) + product.im.abs() * sin(width) };
    }

    fn most(&self, half: [f64; MOST]) -> f64 {
        let along = self.slopes.iter().zip(half).map(|(slope, half)| slope.abs() * half).sum::<f64>();
        (self.middle + along + self.bent).min(self.apart)
    }
}

/// Orders boxes by the certificate, then by the phases, so that no two boxes are equal.
fn compare(a: &[f64; BOX], b: &[f64; BOX]) -> Ordering {
    a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}
