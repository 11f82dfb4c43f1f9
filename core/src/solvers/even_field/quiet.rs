//! Quiet: a few points that stand for many.
//!
//! At points a fraction of a wavelength apart a field has far fewer degrees of freedom than there are points. Of crowded
//! quiet points some are chosen one after another: each time the one whose row of G depends least on the chosen rows,
//! until all others depend on them up to a small part. This is the pivoted Cholesky factorisation of G G^H (Higham,
//! Accuracy and Stability of Numerical Algorithms, 2002, section 10.3), a row at a time. If the chosen points are silent,
//! so are the others, up to that small part. Points with targets in one place get the mean of their targets.

use crate::control::bytes;
use crate::kernels::tiles::products;
use crate::kernels::{LANES, padded, vector};
use crate::math::sqrtf;
use crate::prelude::*;
use crate::problem::Problem;
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::{Buffer, Workspace};

/// The least part of |G_j|, the norm of a point's row, that f32 can distinguish from rounding.
const LEAST: f32 = 1e-3;

/// A point depends on others if less than this part of its row's norm |G_j| remains without them.
const DEPENDENT: f32 = 0.5;

/// Quiet points are crowded if more than this part of them depends on others.
const CROWDED: f32 = 0.2;

/// Part of the transducers' phases that the equations may use: two for each quiet point and one for each target. With a
/// larger part the level falls.
const MOST: f32 = 0.8;

/// If there are at most this many quiet points, all are made silent, even if they are crowded.
const FEW: usize = 8;

/// Returns the number of independent quiet points that an array of `transducers` can silence besides its targets.
pub(crate) fn silenceable(transducers: usize, targets: usize) -> usize {
    ((MOST * transducers as f32 - targets as f32) / 2.0).max(0.0) as usize
}

/// The quiet points that will be made silent.
pub(super) struct Silence<'w> {
    /// Indices of the problem's points.
    pub(super) points: Buffer<'w, u32>,
    /// Whether the array has enough transducers to silence all these points.
    pub(super) enough: bool,
    /// Whether many of these points depend on others.
    pub(super) crowded: bool,
}

impl<'w> Silence<'w> {
    /// Chooses the quiet points that represent all, where each may leak `quiet` of the largest target.
    ///
    /// # Errors
    /// More memory than allowed is needed, or a stop.
    pub(super) fn of(problem: &Problem, quiet: f32, work: &'w Workspace, control: &mut Control) -> Result<Self, Error> {
        let propagation = problem.propagation();
        let silent = |j: &u32| problem.targets()[*j as usize] == 0.0;
        let all = 0..propagation.points() as u32;
        let count = all.clone().filter(silent).count();
        let most = silenceable(propagation.transducers(), propagation.points() - count);
        let mut points = work.indices.take(count);
        points.iter_mut().zip(all.filter(silent)).for_each(|(own, j)| *own = j);
        if count <= FEW {
            return Ok(Self { points, enough: count <= most, crowded: false });
        }
        let rows = Rows::of(problem, points, work, control)?;
        independent(&rows, quiet.max(LEAST), most, work, control)
    }
}

/// Chooses at most `most` of the rows' points. The others depend on them up to `part` of their moduli.
fn independent<'w>(
    rows: &Rows,
    part: f32,
    most: usize,
    work: &'w Workspace,
    control: &mut Control,
) -> Result<Silence<'w>, Error> {
    let (count, lanes) = (rows.order.len(), padded(rows.count));
    let mut own = work.floats.take(count);
    products::powers(rows.set, rows.tiles(), &mut own);
    let mut left = work.floats.take(count);
    left.copy_from_slice(&own);
    let most = most.min(count);
    control.room("the couplings of the quiet points", [count, most], bytes(8, &[most, lanes]))?;
    let mut factor = [(); 2].map(|()| work.floats.take(most * lanes));
    let mut column = [(); 2].map(|()| work.floats.take(lanes));
    let mut taken = work.indices.take(most);
    let mut wave = Wave::new(rows, work);
    let mut separate = count;
    for step in 0..=most {
        control.pulse()?;
        let share = |k: usize| if own[k] > 0.0 { left[k] / own[k] } else { 0.0 };
        let next = (0..count).fold(0, |next, k| if share(k) > share(next) { k } else { next });
        if share(next) < DEPENDENT * DEPENDENT {
            separate = separate.min(step);
        }
        let done = share(next) <= part * part;
        if done || step == most {
            let mut points = work.indices.take(step);
            points.iter_mut().zip(&taken).for_each(|(point, &k)| *point = rows.order[k as usize]);
            let crowded = count - separate.min(step) > (CROWDED * count as f32) as usize;
            return Ok(Silence { points, enough: done, crowded });
        }
        taken[step] = next as u32;
        // The column of G G^H is the field of the drive conj(G_next).
        rows.conjugate(next, wave.drive.each_mut().map(|plane| &mut plane[..]));
        wave.hear(rows);
        let [re, im] = &mut column;
        re[..rows.count].copy_from_slice(&wave.field[0]);
        im[..rows.count].copy_from_slice(&wave.field[1]);
        for before in 0..step {
            let row = before * lanes..(before + 1) * lanes;
            let [known_re, known_im] = factor.each_ref().map(|plane| &plane[row.clone()]);
            vector::accumulate(rows.set, [known_re, known_im], [-known_re[next], known_im[next]], re, im);
        }
        let scale = 1.0 / sqrtf(left[next]);
        for (factor, column) in factor.iter_mut().zip(&column) {
            let new = &mut factor[step * lanes..(step + 1) * lanes];
            new.iter_mut().zip(&column[..]).for_each(|(new, column)| *new = scale * column);
        }
        for (k, left) in left.iter_mut().enumerate() {
            let [re, im] = factor.each_ref().map(|plane| plane[step * lanes + k]);
            *left = if k == next { 0.0 } else { (*left - re * re - im * im).max(0.0) };
        }
    }
    unreachable!("the last step returns")
}

/// Rows of G that are parallel within this part belong to coincident points, about lambda/1000 apart.
const COINCIDENT: f64 = 1e-5;

/// Gives coincident points the mean of their targets. `powers` are the sums of |G|^2 over each row.
///
/// Most points differ in one tile in the middle. Only rows that look parallel there are compared as a whole.
pub(super) fn merge(rows: &mut Rows, powers: &mut [f32], work: &Workspace, control: &mut Control) -> Result<(), Error> {
    let points = rows.targeted;
    let middle = rows.lanes / LANES / 2;
    control.room("the matrix G G^H", [rows.lanes, points], bytes(8, &[points, points]))?;
    let mut matrix = [(); 2].map(|()| work.floats.take(points * points));
    let [re, im] = &mut matrix;
    products::couplings(rows.set, rows.tiles(), middle..middle + 1, points, [&mut *re, &mut *im], control)?;
    let entry = |k: usize, l: usize| [&*re, &*im].map(|plane| f64::from(plane[k * points + l]));
    let own = |k: usize| entry(k, k)[0].max(f64::from(f32::MIN_POSITIVE));
    // If two rows are parallel, they differ in the middle tile by at most this part of their power in that tile.
    let slack = |k: usize| 4.0 * COINCIDENT * (f64::from(powers[k]) / own(k)).max(1.0);
    let mut homes = work.counting(points);
    let mut apart = true;
    for first in 0..points {
        control.pulse()?;
        if homes[first] != first as u32 {
            continue;
        }
        let (power, slack_here) = (own(first), slack(first));
        for k in first + 1..points {
            let [re, im] = entry(first, k);
            let looks = re * re + im * im >= (1.0 - slack_here.min(slack(k))) * power * own(k);
            if looks && parallel(rows, powers, first, k) {
                (homes[k], apart) = (first as u32, false);
            }
        }
    }
    if !apart {
        for first in 0..points as u32 {
            let group = || (0..points).filter(|&k| homes[k] == first);
            let mean = group().map(|k| 1.0 / rows.scale[k]).sum::<f32>() / group().count() as f32;
            for k in group() {
                let factor = 1.0 / (mean * rows.scale[k]);
                rows.rescale(k, factor);
                powers[k] *= factor * factor;
            }
        }
    }
    Ok(())
}

/// Returns whether two whole rows are parallel.
fn parallel(rows: &Rows, powers: &[f32], k: usize, l: usize) -> bool {
    let [re, im] = products::coupling(rows.set, rows.tiles(), k, l).map(f64::from);
    re * re + im * im >= (1.0 - 2.0 * COINCIDENT) * f64::from(powers[k]) * f64::from(powers[l])
}
