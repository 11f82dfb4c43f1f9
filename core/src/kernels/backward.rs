//! Backward pass in double precision: gradients of a point's pressure by transducers, point and wavenumber.
//!
//! d is the ray of length r from a transducer with unit normal n to the point, e = d/r, c = e . n. The transducer's
//! wave is F = f g D(c): f its complex factor, D the directivity, g = e^{ur}/r, u = jk - alpha (wavenumber k,
//! absorption alpha). The pressure is the sum of q F over drives q. For a cotangent w, with S = w* q F and T = Re(w* q
//! f g D'), the derivatives of Re(w* q F) are
//!
//! ```text
//! with respect to q   F* w   (as dL/dRe q + j dL/dIm q)
//! with respect to d   a e + (T/r)(n - c e),   a = -(alpha + 1/r) Re S - k Im S
//! with respect to n   T (e - c n)             along the sphere of unit normals
//! with respect to k   -r Im S - T (1 - c^2)/(k c)   the second term only where D is a function of k sin(theta)
//! ```
//!
//! The forward pass stores 1/r, F and f g D' of each transducer, so that the backward pass computes no phase and no
//! root. Both passes take eight transducers at a time.
//!
//! Plain loops without fused products: every instruction set gives the same bits.

use crate::kernels::phasor::close_phasor;
use crate::kernels::prelude::*;
use crate::kernels::simd::doubles::{Doubles, EIGHT, Eight, V, dot, list, loaded, ray, runs, scaled, total};
use crate::kernels::waves::{Emitters, Slopes, Waves, against, decay, even};

/// Number of blocks of eight transducers between two checks for a stop.
const RUN: usize = 32;

/// Transducers, or their images in a wall, with their drives.
#[derive(Clone, Copy)]
pub(crate) struct Senders<'a> {
    pub(crate) waves: &'a Waves,
    pub(crate) emitters: &'a [Emitters],
    pub(crate) drives: &'a [[Eight; 2]],
}

/// Values of eight transducers at one point, stored by the forward pass for the backward pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sent {
    /// 1/r, r the distance to the point.
    near: Eight,
    /// F, the wave at drive 1: real and imaginary part.
    wave: [Eight; 2],
    /// f g D' (see the module's head): real and imaginary part; 0 where D = 1.
    bend: [Eight; 2],
}

impl Sent {
    pub(crate) const ZERO: Self = Self { near: [0.0; EIGHT], wave: [[0.0; EIGHT]; 2], bend: [[0.0; EIGHT]; 2] };
}

/// Gradients with respect to eight transducers, summed over points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull {
    pub(crate) drive: [Eight; 2],
    pub(crate) position: [Eight; 3],
    pub(crate) normal: [Eight; 3],
}

impl Pull {
    pub(crate) const ZERO: Self =
        Self { drive: [[0.0; EIGHT]; 2], position: [[0.0; EIGHT]; 3], normal: [[0.0; EIGHT]; 3] };

    /// Adds the gradients of other points.
    pub(crate) fn add(&mut self, other: &Self) {
        let sums = self.drive.iter_mut().chain(&mut self.position).chain(&mut self.normal);
        let other = other.drive.iter().chain(&other.position).chain(&other.normal);
        sums.zip(other).for_each(|(sums, other)| (0..EIGHT).for_each(|lane| sums[lane] += other[lane]));
    }
}

/// Returns the pressure of some drives at a point, and the largest 1/r; stores in `sent` the values that [`back`]
/// needs.
pub(crate) fn forth(
    set: InstructionSet,
    Senders { waves, emitters, drives }: Senders<'_>,
    point: [f64; 3],
    sent: &mut [Sent],
    control: &mut Control,
) -> Result<([f64; 2], f64)> {
    let (mut sums, mut nearest) = ([[0.0; EIGHT]; 2], [0.0; EIGHT]);
    let all = emitters.chunks(RUN).zip(drives.chunks(RUN)).zip(sent.chunks_mut(RUN));
    for ((blocks, drives), sent) in all {
        control.pulse()?;
        dispatch!(set, s => {
            for at in runs(s) {
                let mut sum = loaded(s, &sums, at);
                let mut most = V::of(s, &nearest[at..]);
                for ((block, drive), sent) in blocks.iter().zip(drives).zip(sent.iter_mut()) {
                    let [g_re, g_im] = send(s, waves, block, at, point, sent);
                    let [re, im] = loaded(s, drive, at);
                    sum[0] = sum[0] + (g_re * re - g_im * im);
                    sum[1] = sum[1] + (g_re * im + g_im * re);
                    let near = V::of(s, &sent.near[at..]);
                    most = near.where_less(most, near, most);
                }
                sum[0].put(&mut sums[0][at..]);
                sum[1].put(&mut sums[1][at..]);
                most.put(&mut nearest[at..]);
            }
        });
    }
    Ok((sums.map(total), nearest.into_iter().fold(0.0, f64::max)))
}

/// Returns F of at most eight transducers; stores it with 1/r and f g D' in `sent`.
#[inline(always)]
fn send<S: Doubles>(s: S, waves: &Waves, block: &Emitters, at: usize, point: [f64; 3], sent: &mut Sent) -> [V<S>; 2] {
    let d = ray(s, point, (&block.position, at));
    let square = dot(d, d);
    // The phase needs only r, so it can begin before `near` is computed.
    let (r, near) = (square.sqrt(), square.inverse_root());
    let (cos, sin) = close_phasor(s, r * (waves.wavenumber * (1.0 / TAU)));
    let amplitude = if waves.absorption > 0.0 { near * decay(s, r * waves.absorption) } else { near };
    let [re, im] = loaded(s, &block.factor, at);
    let (cos, sin) = (amplitude * cos, amplitude * sin);
    let g = [cos * re - sin * im, cos * im + sin * re];
    near.put(&mut sent.near[at..]);
    let slopes = match &waves.slopes {
        Slopes::One => {
            g[0].put(&mut sent.wave[0][at..]);
            g[1].put(&mut sent.wave[1][at..]);
            return g;
        }
        Slopes::Even { square, terms } => even(s, *square, terms, dot(d, loaded(s, &block.normal, at)) * near),
        Slopes::Each(of) => (dot(d, loaded(s, &block.normal, at)) * near).each(of),
    };
    let wave = scaled(g, slopes[0]);
    for part in 0..2 {
        wave[part].put(&mut sent.wave[part][at..]);
        (g[part] * slopes[1]).put(&mut sent.bend[part][at..]);
    }
    wave
}

/// Returns the gradients of Re(w* p), w the cotangent, with respect to the point (3 numbers) and to k (the last one);
/// adds those with respect to the transducers to `pulls`.
pub(crate) fn back(
    set: InstructionSet,
    Senders { waves, emitters, drives }: Senders<'_>,
    point: [f64; 3],
    cotangent: [f64; 2],
    sent: &[Sent],
    pulls: &mut [Pull],
    control: &mut Control,
) -> Result<[f64; 4]> {
    let mut sums = [[0.0; EIGHT]; 4];
    let all = emitters.chunks(RUN).zip(drives.chunks(RUN)).zip(sent.chunks(RUN)).zip(pulls.chunks_mut(RUN));
    for (((blocks, drives), sent), pulls) in all {
        control.pulse()?;
        dispatch!(set, s => {
            let w = list(s, |part| V::all(s, cotangent[part]));
            for at in runs(s) {
                let mut sum = loaded(s, &sums, at);
                for (((block, drive), sent), pull) in blocks.iter().zip(drives).zip(sent).zip(pulls.iter_mut()) {
                    let drive = loaded(s, drive, at);
                    let terms = pulled(s, waves, block, at, point, w, drive, sent, pull);
                    for k in 0..4 {
                        sum[k] = sum[k] + terms[k];
                    }
                }
                for k in 0..4 {
                    sum[k].put(&mut sums[k][at..]);
                }
            }
        });
    }
    Ok(sums.map(total))
}

#[allow(clippy::too_many_arguments, reason = "part of a kernel")]
#[inline(always)]
fn pulled<S: Doubles>(
    s: S,
    waves: &Waves,
    block: &Emitters,
    at: usize,
    point: [f64; 3],
    w: [V<S>; 2],
    q: [V<S>; 2],
    sent: &Sent,
    pull: &mut Pull,
) -> [V<S>; 4] {
    let near = V::of(s, &sent.near[at..]);
    let d = ray(s, point, (&block.position, at));
    let e = scaled(d, near);
    let by_drive = against(w, loaded(s, &sent.wave, at));
    by_drive[0].onto(&mut pull.drive[0][at..]);
    (by_drive[1] * -1.0).onto(&mut pull.drive[1][at..]);
    let driven = [by_drive[0] * q[0] - by_drive[1] * q[1], by_drive[0] * q[1] + by_drive[1] * q[0]];
    let along = (driven[0] * (near + waves.absorption) + driven[1] * waves.wavenumber) * -1.0;
    let mut by_k = dot(d, e) * driven[1] * -1.0;
    let mut v = scaled(e, along);
    if !matches!(waves.slopes, Slopes::One) {
        let n = loaded(s, &block.normal, at);
        let c = dot(e, n);
        let bend = against(w, loaded(s, &sent.bend, at));
        let t = bend[0] * q[0] - bend[1] * q[1];
        let across = t * near;
        for axis in 0..3 {
            v[axis] = v[axis] + across * (n[axis] - e[axis] * c);
            (t * (e[axis] - n[axis] * c)).onto(&mut pull.normal[axis][at..]);
        }
        if waves.widening.is_some() {
            let floor = V::all(s, f64::MIN_POSITIVE);
            let ahead = c.where_less(floor, c, floor);
            by_k = by_k - t * (V::all(s, 1.0) - c * c) * (ahead * waves.wavenumber).inverse();
        }
    }
    for axis in 0..3 {
        (v[axis] * -1.0).onto(&mut pull.position[axis][at..]);
    }
    [v[0], v[1], v[2], by_k]
}
