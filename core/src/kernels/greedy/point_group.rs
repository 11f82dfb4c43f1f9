//! Point group: pressures, targets and weights of 16 points, and the values that the greedy search computes from them.

use crate::kernels::greedy::candidates::{L2, Term, rise};
use crate::kernels::prelude::*;

/// 16 points of one problem, or one point of 16 problems; computed again when the pressures change.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct PointGroup {
    /// Real and imaginary parts of the pressures P.
    pub(crate) re: Lanes,
    pub(crate) im: Lanes,
    /// |P|.
    pub(crate) modulus: Lanes,
    /// 1/|P|^2, limited so that |u| = |G/P| exceeds [`crate::kernels::greedy::moments::FAR`] where P is 0; 0 at a quiet
    /// point, whose term has no remainder.
    pub(crate) inverse: Lanes,
    /// w (1 - t/|P|) with the weight w and the target t.
    pub(crate) pull: Lanes,
    /// w t |P| with the weight w and the target t.
    pub(crate) product: Lanes,
    pub(crate) target: Lanes,
    pub(crate) weight: Lanes,
}

impl PointGroup {
    /// Creates a group with all pressures 0, targets t and weights w.
    #[inline(always)]
    pub(crate) fn silent<S: Elementwise>(s: S, target: &Lanes, weight: &Lanes) -> Self {
        let mut group = Self { target: *target, weight: *weight, ..Self::default() };
        group.refresh(s, s.splat(0.0), s.splat(0.0));
        group
    }

    /// Gathers the points of the problem in one lane of an interleaved batch.
    #[inline(always)]
    pub(crate) fn of_lane<S: Elementwise>(s: S, points: &[Self], lane: usize) -> Self {
        let mut group = Self::silent(s, &[0.0; LANES], &[0.0; LANES]);
        for (j, point) in points.iter().enumerate() {
            (group.re[j], group.im[j]) = (point.re[lane], point.im[lane]);
            (group.modulus[j], group.inverse[j]) = (point.modulus[lane], point.inverse[lane]);
            (group.pull[j], group.product[j]) = (point.pull[lane], point.product[lane]);
            (group.target[j], group.weight[j]) = (point.target[lane], point.weight[lane]);
        }
        group
    }

    /// Sets the pressures; returns the energies w (t - |P|)^2.
    #[inline(always)]
    fn refresh<S: Elementwise>(&mut self, s: S, re: S::V, im: S::V) -> S::V {
        let (target, weight) = (s.load(&self.target), s.load(&self.weight));
        let square = s.fma(re, re, s.mul(im, im));
        let (root, inverse) = s.sqrt_rsqrt(s.max(square, s.splat(TINY)));
        let zero = s.splat(0.0);
        let modulus = s.select_less(square, s.splat(TINY), zero, root);
        let weighted = s.mul(weight, target);
        s.store(re, &mut self.re);
        s.store(im, &mut self.im);
        s.store(modulus, &mut self.modulus);
        s.store(s.select_less(zero, target, s.mul(inverse, inverse), zero), &mut self.inverse);
        s.store(s.fnma(weighted, inverse, weight), &mut self.pull);
        s.store(s.mul(weighted, modulus), &mut self.product);
        let gap = s.sub(target, modulus);
        s.mul(s.mul(weight, gap), gap)
    }

    /// Adds the wave G q of a transducer to the pressures P; returns the energies w (t - |P|)^2.
    #[inline(always)]
    pub(crate) fn add<S: Elementwise>(&mut self, s: S, [gr, gi]: [&Lanes; 2], [qr, qi]: [S::V; 2]) -> S::V {
        let (gr, gi) = (s.load(gr), s.load(gi));
        let re = s.fma(gr, qr, s.fnma(gi, qi, s.load(&self.re)));
        let im = s.fma(gr, qi, s.fma(gi, qr, s.load(&self.im)));
        self.refresh(s, re, im)
    }

    /// Adds the changes of the points' terms by the drive q to `total`, as [`crate::kernels::greedy::search::changes`]
    /// does.
    #[inline(always)]
    pub(crate) fn add_change<S: Elementwise>(
        &self,
        s: S,
        [gr, gi]: [&Lanes; 2],
        [qr, qi]: [S::V; 2],
        total: S::V,
    ) -> S::V {
        let (gr, gi) = (s.load(gr), s.load(gi));
        let e = [s.fnma(gi, qi, s.mul(gr, qr)), s.fma(gi, qr, s.mul(gr, qi))];
        let old = [s.load(&self.re), s.load(&self.im), s.load(&self.modulus)];
        let gap = s.sub(s.load(&self.target), old[2]);
        let change = L2::change(s, rise(s, old, e), gap);
        s.fma(s.load(&self.weight), change, total)
    }
}

/// Adds the wave G q of a transducer to the pressures at `count` points; returns the energy as a partial sum in each
/// lane.
#[inline(always)]
pub(crate) fn add<S: Simd>(s: S, points: &mut [PointGroup], count: usize, row: [&[f32]; 2], q: [f32; 2]) -> S::V {
    let mut added = Added { points, row, q, energy: [0.0; LANES] };
    s.apart(count, &mut added);
    s.load(&added.energy)
}

struct Added<'a> {
    points: &'a mut [PointGroup],
    row: [&'a [f32]; 2],
    q: [f32; 2],
    energy: Lanes,
}

impl Apart for Added<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let q = [s.splat(self.q[0]), s.splat(self.q[1])];
        let mut energy = s.splat(0.0);
        for (group, (gr, gi)) in self.points.iter_mut().zip(groups(self.row[0]).iter().zip(groups(self.row[1]))) {
            energy = s.add(energy, group.add(s, [gr, gi], q));
        }
        s.store(energy, &mut self.energy);
    }
}
