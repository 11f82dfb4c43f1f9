//! The slow part of the squared pressure of frames that repeat, which the air makes audible.

use crate::prelude::*;

/// Times of the transducers' answer, as the exponent of e, after which a transient is over.
const OVER: f64 = 18.0;

/// Adds the slow part E = |P|^2/2 of the squared pressure at V points to sums (K, B, 3, T) for K ears, B delays and T frames.
///
/// `amplitudes` (V, U) are those at which U different frames would settle, and frame t is number `order[t]`. A frame starts with
/// what the one before has left of itself, the part `late` = e^(-duration/tau), so that during a frame P = a + b e^(-t/tau). The
/// three terms |a|^2/2, Re(a b*) and |b|^2/2, times `weights` (K, V), go to the delay of index `bins` (K, V).
///
/// # Errors
/// Lengths that do not agree, an index that is too large, `late` outside of 0 to 1; a stop.
pub fn demodulate(
    amplitudes: &[Complex32],
    order: &[usize],
    late: f64,
    weights: &[f32],
    bins: &[usize],
    sums: &mut [f64],
    control: &mut Control,
) -> Result<()> {
    let frames = order.len();
    let unique = order.iter().max().map_or(1, |most| most + 1);
    let points = amplitudes.len() / unique;
    let ears = weights.len() / points.max(1);
    let delays = sums.len() / (3 * frames * ears).max(1);
    let fit =
        points * unique == amplitudes.len() && bins.len() == weights.len() && bins.iter().all(|&bin| bin < delays);
    if !fit || !(0.0..1.0).contains(&late) {
        return Err(Error::invalid("bins", bins.len(), "give a delay of the sums for each point and ear"));
    }
    let kept = if late == 0.0 { 1 } else { (OVER / -math::log(late)) as usize + 1 };
    let first = frames - kept.min(frames);
    let laps = 1.0 - math::pow(late, frames as f64) as f32;
    let late = late as f32;
    let mut terms = vec![0.0; 3 * frames];
    for (point, row) in amplitudes.chunks_exact(unique).enumerate() {
        control.pulse()?;
        let mut before = row[order[(first + frames - 1) % frames]];
        let mut b = Complex32::ZERO;
        let mut step = |b: Complex32, a: Complex32| b * late + (core::mem::replace(&mut before, a) - a);
        for &frame in &order[first..] {
            b = step(b, row[frame]);
        }
        b /= laps;
        let (squares, rest) = terms.split_at_mut(frames);
        let (products, lags) = rest.split_at_mut(frames);
        for (t, &frame) in order.iter().enumerate() {
            let a = row[frame];
            b = step(b, a);
            squares[t] = a.norm_sqr() / 2.0;
            products[t] = a.re * b.re + a.im * b.im;
            lags[t] = b.norm_sqr() / 2.0;
        }
        for ear in 0..ears {
            let (at, start) = (ear * points + point, 3 * frames);
            let to = &mut sums[(ear * delays + bins[at]) * start..][..start];
            to.iter_mut().zip(&terms).for_each(|(sum, term)| *sum += f64::from(weights[at] * term));
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "tests/audible.rs"]
mod tests;
