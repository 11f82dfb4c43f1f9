//! Drives of modulus 1: sweeps back from the points, and rotations; both also within an arc of phases around 1.

use crate::kernels::prelude::*;
use crate::kernels::tiles::{Tiles, Wave, add_wave, blocks_mut, correlated, hear, sound};

/// Returns z/|z|; 0 where |z|^2 is below [`TINY`].
#[inline(always)]
fn unit<S: Simd>(s: S, [re, im]: [S::V; 2]) -> [S::V; 2] {
    let square = s.fma(re, re, s.mul(im, im));
    let tiny = s.splat(TINY);
    let inverse = s.select_less(square, tiny, s.splat(0.0), s.rsqrt(s.max(square, tiny)));
    [s.mul(re, inverse), s.mul(im, inverse)]
}

/// cos and sin of the largest angle of a drive from 1.
pub(crate) type Arc = [f32; 2];

/// One [`Arc`] for each drive: cosines, then sines.
pub(crate) type Arcs<'a> = [&'a [f32]; 2];

/// Moves a phasor outside of an arc around 1 to the nearer end of the arc. It moves 0 too, which has no effect because
/// G is 0 there.
#[inline(always)]
fn within<S: Simd>(s: S, [re, im]: [S::V; 2], [cos, sin]: [S::V; 2]) -> [S::V; 2] {
    let end = s.select_less(im, s.splat(0.0), s.sub(s.splat(0.0), sin), sin);
    [s.max(re, cos), s.select_less(re, cos, end, im)]
}

/// Writes the drives of a list times a factor, and zeros in the padding.
pub(crate) fn scaled(set: InstructionSet, list: &[Complex32], factor: f32, [re, im]: [&mut [f32]; 2]) {
    dispatch!(set, _s => {
        for ((re, im), q) in re.iter_mut().zip(&mut *im).zip(list) {
            (*re, *im) = (q.re * factor, q.im * factor);
        }
        re[list.len()..].fill(0.0);
        im[list.len()..].fill(0.0);
    });
}

/// Writes the drives of a list times the conjugates of another list's, and zeros in the padding.
pub(crate) fn relative(set: InstructionSet, [list, to]: [&[Complex32]; 2], [re, im]: [&mut [f32]; 2]) {
    dispatch!(set, _s => {
        for ((re, im), (q, to)) in re.iter_mut().zip(&mut *im).zip(list.iter().zip(to)) {
            (*re, *im) = (q.re * to.re + q.im * to.im, q.im * to.re - q.re * to.im);
        }
        re[list.len()..].fill(0.0);
        im[list.len()..].fill(0.0);
    });
}

/// Multiplies each drive of a list by another drive, both of modulus 1 or 0. A step of Newton's method removes the
/// rounding of the modulus.
pub(crate) fn rotate_list(set: InstructionSet, [re, im]: [&[f32]; 2], list: &mut [Complex32]) {
    dispatch!(set, _s => {
        for ((re, im), q) in re.iter().zip(im).zip(list) {
            let (x, y) = (re * q.re - im * q.im, re * q.im + im * q.re);
            let step = 1.5 - 0.5 * (x * x + y * y);
            *q = Complex32::new(x * step, y * step);
        }
    });
}

/// Makes every |q| 1; 0 stays 0.
pub(crate) fn normalise(set: InstructionSet, drive: [&mut [f32]; 2]) {
    dispatch!(set, s => {
        let [qr, qi] = drive.map(groups_mut);
        for (qr, qi) in qr.iter_mut().zip(qi) {
            let [re, im] = unit(s, [s.load(qr), s.load(qi)]);
            s.store(re, qr);
            s.store(im, qi);
        }
    });
}

/// Returns the length of the working memory of [`sweep`] for `rows` (whole blocks).
pub(crate) const fn sweep_floats(rows: usize) -> usize {
    2 * rows * LANES
}

/// q = b/|b| with b = sum_j conj(G_j) p_j (0 where b is 0), and P = G q, in one pass over G: two tiles are still in the
/// nearest cache when P needs them. `memory` contains the lanes of P meanwhile.
pub(crate) fn sweep(set: InstructionSet, tiles: Tiles<'_>, target: [&[f32]; 2], wave: Wave<'_>, memory: &mut [f32]) {
    dispatch!(set, s => swept::<_, false>(s, tiles, target, wave, memory, [-1.0, 0.0]));
}

/// Does the same as [`sweep`], with each q limited to an arc around 1.
pub(crate) fn sweep_within(
    set: InstructionSet,
    tiles: Tiles<'_>,
    target: [&[f32]; 2],
    arc: Arc,
    wave: Wave<'_>,
    memory: &mut [f32],
) {
    dispatch!(set, s => swept::<_, true>(s, tiles, target, wave, memory, arc));
}

#[inline(always)]
fn swept<S: Simd, const WITHIN: bool>(
    s: S,
    tiles: Tiles<'_>,
    target: [&[f32]; 2],
    wave: Wave<'_>,
    memory: &mut [f32],
    arc: Arc,
) {
    let Wave { drive: [qr, qi], field: [re, im] } = wave;
    let (qr, qi) = (groups_mut(qr), groups_mut(qi));
    let [pr, pi] = target.map(|plane| plane.as_chunks::<BLOCK>().0);
    memory.fill(0.0);
    let parts = blocks_mut(memory).as_chunks_mut::<2>().0;
    for t in (0..qr.len()).step_by(2) {
        let q = correlated(s, tiles, t, [pr, pi]).map(
            #[inline(always)]
            |b| if WITHIN { within(s, unit(s, b), arc.map(|part| s.splat(part))) } else { unit(s, b) },
        );
        for (tile, [real, imag]) in q.into_iter().enumerate() {
            s.store(real, &mut qr[t + tile]);
            s.store(imag, &mut qi[t + tile]);
        }
        for ([gr, gi], [re, im]) in tiles.columns::<2>(t).zip(&mut *parts) {
            for row in 0..BLOCK {
                let mut sum = [s.load(&re[row]), s.load(&im[row])];
                for (tile, q) in q.into_iter().enumerate() {
                    sum = add_wave(s, [s.load(&gr[tile][row]), s.load(&gi[tile][row])], q, sum);
                }
                s.store(sum[0], &mut re[row]);
                s.store(sum[1], &mut im[row]);
            }
        }
    }
    let field = re.as_chunks_mut().0.iter_mut().zip(im.as_chunks_mut().0);
    for ([real, imag], (re, im)) in parts.iter().zip(field) {
        let sum = |row: usize| [s.load(&real[row]), s.load(&imag[row])];
        hear(s, [sum(0), sum(1), sum(2), sum(3)], re, im);
    }
}

/// Writes q = (r + j f d r)/|r + j f d r| for another drive r, rotations d (`turns`) and a factor f, and P = G q. This
/// q differs from e^{jfd} r by at most (f d)^3/3.
pub(crate) fn turn(
    set: InstructionSet,
    tiles: Tiles<'_>,
    from: [&[f32]; 2],
    turns: &[f32],
    factor: f32,
    wave: Wave<'_>,
) {
    // Without limits the kernel does not use the arcs.
    dispatch!(set, s => turned::<_, false>(s, tiles, from, turns, factor, [turns; 2], wave));
}

/// Does the same as [`turn`] with factor 1, and each q limited to its own arc around 1.
pub(crate) fn turn_within(
    set: InstructionSet,
    tiles: Tiles<'_>,
    from: [&[f32]; 2],
    turns: &[f32],
    arcs: Arcs<'_>,
    wave: Wave<'_>,
) {
    dispatch!(set, s => turned::<_, true>(s, tiles, from, turns, 1.0, arcs, wave));
}

#[inline(always)]
fn turned<S: Simd, const WITHIN: bool>(
    s: S,
    tiles: Tiles<'_>,
    from: [&[f32]; 2],
    turns: &[f32],
    factor: f32,
    arcs: Arcs<'_>,
    wave: Wave<'_>,
) {
    let ([re, im], [cos, sin], turns) = (from.map(groups), arcs.map(groups), groups(turns));
    let [qr, qi] = wave.drive.map(groups_mut);
    let limited = turns.iter().zip(cos.iter().zip(sin));
    for (((re, im), (turn, (cos, sin))), (qr, qi)) in re.iter().zip(im).zip(limited).zip(qr.iter_mut().zip(&mut *qi)) {
        let (re, im) = (s.load(re), s.load(im));
        let turn = s.mul(s.splat(factor), s.load(turn));
        let q = unit(s, [s.fnma(turn, im, re), s.fma(turn, re, im)]);
        let [real, imag] = if WITHIN { within(s, q, [s.load(cos), s.load(sin)]) } else { q };
        s.store(real, qr);
        s.store(imag, qi);
    }
    sound(s, tiles, [qr, qi], wave.field);
}
