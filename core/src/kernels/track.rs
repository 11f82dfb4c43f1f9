//! One step of the best track over a circle of phases: for each phase the best sum of gains on a path that ends there.

use crate::kernels::prelude::*;

/// Returns the length of the working memory of [`advance`].
pub(crate) const fn advance_floats(levels: usize, reach: usize) -> usize {
    2 * (levels + 2 * reach)
}

/// The gain of each phase: re cos + im sin of the `wave` and the `circle`, less `base`.
pub(crate) struct Gain<'a> {
    pub(crate) base: f32,
    pub(crate) wave: [f32; 2],
    pub(crate) circle: [&'a [f32]; 2],
}

/// out_l = max over |d| <= `reach` of from_{l+d} (indices on a circle), plus the gain of l. Every instruction set gives the same bits. The time is O(L log reach): the maximum of a window is that of
/// two windows of half its width.
pub(crate) fn advance(
    set: InstructionSet,
    from: &[f32],
    reach: usize,
    gain: Gain<'_>,
    memory: &mut [f32],
    out: &mut [f32],
) {
    dispatch!(set, s => step(s, from, reach, gain, memory, out));
}

#[inline(always)]
fn step<S: Simd>(
    _: S,
    from: &[f32],
    reach: usize,
    Gain { base, wave: [re, im], circle: [cos, sin] }: Gain<'_>,
    memory: &mut [f32],
    out: &mut [f32],
) {
    let (levels, width) = (from.len(), 2 * reach + 1);
    let gains = cos.iter().zip(sin).map(
        #[inline(always)]
        |(cos, sin)| re * cos + im * sin - base,
    );
    if width >= levels {
        let best = from.iter().copied().fold(f32::NEG_INFINITY, greater);
        out.iter_mut().zip(gains).for_each(|(out, gain)| *out = best + gain);
        return;
    }
    let (mut here, mut there) = memory.split_at_mut(levels + 2 * reach);
    here[..reach].copy_from_slice(&from[levels - reach..]);
    here[reach..reach + levels].copy_from_slice(from);
    here[reach + levels..].copy_from_slice(&from[..reach]);
    let (mut covered, mut len) = (1, here.len());
    while 2 * covered <= width {
        len -= covered;
        widest(&here[..len], &here[covered..], &mut there[..len]);
        core::mem::swap(&mut here, &mut there);
        covered *= 2;
    }
    widest(&here[..levels], &here[width - covered..], out);
    out.iter_mut().zip(gains).for_each(|(out, gain)| *out += gain);
}

/// out = the greater of a and b.
#[inline(always)]
fn widest(a: &[f32], b: &[f32], out: &mut [f32]) {
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out = greater(*a, *b);
    }
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
