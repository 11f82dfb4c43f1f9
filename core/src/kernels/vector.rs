//! Vectors over the points: moduli, inner products, sums of squares, and adding the field of one source.

use crate::kernels::prelude::*;

/// Returns the pressure P plus the wave G q.
#[inline(always)]
pub(crate) fn add_wave<S: Elementwise>(
    s: S,
    [gr, gi]: [S::V; 2],
    [qr, qi]: [S::V; 2],
    [re, im]: [S::V; 2],
) -> [S::V; 2] {
    [s.fma(gr, qr, s.fnma(gi, qi, re)), s.fma(gr, qi, s.fma(gi, qr, im))]
}

/// Adds the wave G q of one transducer to the pressures at all points.
#[inline(always)]
pub(crate) fn add_row<S: Simd>(s: S, row: [&[f32]; 2], drive: [f32; 2], re: &mut [f32], im: &mut [f32]) {
    let q = [s.splat(drive[0]), s.splat(drive[1])];
    let rows = groups(row[0]).iter().zip(groups(row[1]));
    for ((gr, gi), (re, im)) in rows.zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
        let [real, imaginary] = add_wave(s, [s.load(gr), s.load(gi)], q, [s.load(re), s.load(im)]);
        s.store(real, re);
        s.store(imaginary, im);
    }
}

/// Adds the wave G q of one transducer to the pressures at all points; q = (re, im).
pub(crate) fn accumulate(set: InstructionSet, row: [&[f32]; 2], drive: [f32; 2], re: &mut [f32], im: &mut [f32]) {
    dispatch!(set, s => add_row(s, row, drive, re, im));
}

/// out = |P| of pressures P; 0 where |P|^2 is below [`TINY`].
pub(crate) fn modulus(set: InstructionSet, re: &[f32], im: &[f32], out: &mut [f32]) {
    dispatch!(set, s => {
        for ((re, im), out) in groups(re).iter().zip(groups(im)).zip(groups_mut(out)) {
            let (re, im) = (s.load(re), s.load(im));
            s.store(root(s, s.fma(re, re, s.mul(im, im))), out);
        }
    });
}

/// Returns sqrt(a) of a >= 0; 0 below [`TINY`].
#[inline(always)]
pub(crate) fn root<S: Elementwise>(s: S, a: S::V) -> S::V {
    let least = s.splat(TINY);
    s.select_less(a, least, s.splat(0.0), s.sqrt_rsqrt(s.max(a, least)).0)
}

/// Returns sum_j conj(G_j) p_j of a row G and pressures p as partial sums in the lanes: (re, im).
#[inline(always)]
pub(crate) fn correlation<S: Elementwise>(s: S, row: [&[f32]; 2], pressure: [&[f32]; 2]) -> [S::V; 2] {
    let (mut re, mut im) = (s.splat(0.0), s.splat(0.0));
    let pressures = groups(pressure[0]).iter().zip(groups(pressure[1]));
    for ((gr, gi), (pr, pi)) in groups(row[0]).iter().zip(groups(row[1])).zip(pressures) {
        let (gr, gi, pr, pi) = (s.load(gr), s.load(gi), s.load(pr), s.load(pi));
        re = s.fma(gr, pr, s.fma(gi, pi, re));
        im = s.fma(gr, pi, s.fnma(gi, pr, im));
    }
    [re, im]
}

/// Returns sum_j conj(G_j) p_j of a row G and pressures p: (re, im). There are `count` points and padding.
pub(crate) fn correlate(set: InstructionSet, row: [&[f32]; 2], pressure: [&[f32]; 2], count: usize) -> [f32; 2] {
    dispatch!(set, s => {
        let mut sum = Correlation { row, pressure, out: [[0.0; LANES]; 2] };
        s.apart(count, &mut sum);
        [s.reduce_add(s.load(&sum.out[0])), s.reduce_add(s.load(&sum.out[1]))]
    })
}

struct Correlation<'a> {
    row: [&'a [f32]; 2],
    pressure: [&'a [f32]; 2],
    out: [Lanes; 2],
}

impl Apart for Correlation<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let [re, im] = correlation(s, self.row, self.pressure);
        s.store(re, &mut self.out[0]);
        s.store(im, &mut self.out[1]);
    }
}

/// Returns sum_j a_j b_j.
pub(crate) fn dot(set: InstructionSet, a: &[f32], b: &[f32]) -> f32 {
    dispatch!(set, s => {
        let mut total = s.splat(0.0);
        for (a, b) in groups(a).iter().zip(groups(b)) {
            total = s.fma(s.load(a), s.load(b), total);
        }
        s.reduce_add(total)
    })
}

/// out += |G|^2 for a row G of `count` numbers and padding.
pub(crate) fn squares(set: InstructionSet, row: [&[f32]; 2], count: usize, out: &mut [f32]) {
    dispatch!(set, s => s.apart(count, &mut Squares { row, out }));
}

struct Squares<'a> {
    row: [&'a [f32]; 2],
    out: &'a mut [f32],
}

impl Apart for Squares<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        for ((re, im), out) in groups(self.row[0]).iter().zip(groups(self.row[1])).zip(groups_mut(self.out)) {
            let (re, im) = (s.load(re), s.load(im));
            s.store(s.fma(re, re, s.fma(im, im, s.load(out))), out);
        }
    }
}
