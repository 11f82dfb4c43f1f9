//! Energies of candidates: the polynomial of the moments, and eq. (7) at the points that it leaves out.

use crate::kernels::greedy::candidates::Candidates;
use crate::kernels::greedy::moments::Moments;
use crate::kernels::greedy::search::Points;
use crate::kernels::lanes::LANES;
use crate::kernels::simd::{Simd, TINY};

/// What the energies of one update depend on.
pub(crate) struct Energies<'a, S: Simd> {
    pub(crate) s: S,
    pub(crate) points: Points<'a>,
    pub(crate) moments: &'a Moments,
    /// The points that the moments leave out.
    pub(crate) near: &'a [u32],
    pub(crate) candidates: &'a Candidates,
}

impl<S: Simd> Energies<'_, S> {
    /// The changes of 16 drives, to the fourth order (of such moments).
    #[inline(always)]
    pub(crate) fn evaluate(&self, z: [S::V; 2]) -> S::V {
        self.add_left_out(z, self.moments.fine_change(self.s, z[0], z[1]))
    }

    /// The changes of 16 drives, to the third order.
    #[inline(always)]
    pub(crate) fn roughly(&self, [re, im]: [S::V; 2]) -> S::V {
        self.add_left_out([re, im], self.moments.change(self.s, re, im))
    }

    /// Adds to `total` the terms that the moments leave out, w (|P + G z|^2 - |P|^2 - 2 t (|P + G z| - |P|)): fewer
    /// instructions than [`crate::kernels::greedy::search::add_changes`] and more rounding, see [`Self::rounding`].
    #[inline(always)]
    fn add_left_out(&self, [re, im]: [S::V; 2], mut total: S::V) -> S::V {
        let s = self.s;
        for &j in self.near {
            let (gr, gi) = (s.splat(self.points.row[0][j as usize]), s.splat(self.points.row[1][j as usize]));
            let (group, lane) = (&self.points.groups[j as usize / LANES], j as usize % LANES);
            let (old, target) = (group.modulus[lane], group.target[lane]);
            let x = s.fma(gr, re, s.fnma(gi, im, s.splat(group.re[lane])));
            let y = s.fma(gr, im, s.fma(gi, re, s.splat(group.im[lane])));
            let square = s.max(s.fma(x, x, s.mul(y, y)), s.splat(TINY));
            let guess = s.rsqrt_estimate(square);
            let root = s.mul(square, guess);
            let root = s.fma(s.mul(guess, s.splat(0.5)), s.fnma(root, root, square), root);
            let term = s.sub(s.fnma(s.splat(2.0 * target), root, square), s.splat(old * (old - 2.0 * target)));
            total = s.fma(s.splat(group.weight[lane]), term, total);
        }
        total
    }

    /// How far the tolerance of ties and the rounding of the changes leave a comparison open. At a point left out the
    /// square of up to 5 |G| is rounded four times, and so is 2 t times its root, t being up to 4 |G| and the gap.
    #[inline(always)]
    pub(crate) fn rounding(&self) -> f32 {
        let moments = self.moments;
        let left_out = if self.near.is_empty() { 0.0 } else { 4.0 * moments.rounding(1.0) + 1.1e-5 * moments.power() };
        moments.rounding(1.0) + left_out
    }

    /// A bound on the second derivative over the phase of [`Self::roughly`]. A point left out has the term
    /// |P + e|^2 - 2 t |P + e|: the first part's is at most 2 a |P| |G|; the second is concave in |P + e|, which on an
    /// arc of length h is at most its chord plus a |G| h^2/8.
    #[inline(always)]
    pub(crate) fn curvature(&self, a: f32) -> f32 {
        let left_out = |&j: &u32| {
            let (group, lane) = (&self.points.groups[j as usize / LANES], j as usize % LANES);
            let gain = self.points.row[0][j as usize].abs() + self.points.row[1][j as usize].abs();
            2.0 * a * group.weight[lane] * gain * (group.modulus[lane] + group.target[lane])
        };
        self.moments.curvature(a) + self.near.iter().map(left_out).sum::<f32>()
    }

    /// Q: [`Self::roughly`] at amplitude a is at least a times that at 1 less a (1 - a) Q.
    #[inline(always)]
    pub(crate) fn bow(&self) -> f32 {
        let left_out = |&j: &u32| {
            let (re, im) = (self.points.row[0][j as usize], self.points.row[1][j as usize]);
            self.points.groups[j as usize / LANES].weight[j as usize % LANES] * (re * re + im * im)
        };
        self.moments.bow() + self.near.iter().map(left_out).sum::<f32>()
    }
}
