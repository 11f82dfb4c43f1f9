//! Change of the energy by each candidate: a polynomial of the moments, and eq. (7) at the points left out of them.

use crate::kernels::greedy::candidates::{Candidates, Sixteen};
use crate::kernels::greedy::moments::Moments;
use crate::kernels::greedy::search::Points;
use crate::kernels::prelude::*;

/// The values on which the energies in one transducer's update depend.
pub(crate) struct Energies<'a, S: Simd> {
    pub(crate) s: S,
    pub(crate) points: Points<'a>,
    pub(crate) moments: &'a Moments,
    /// The points that the moments leave out.
    pub(crate) near: &'a [u32],
    pub(crate) candidates: &'a Candidates,
}

impl<S: Simd> Energies<'_, S> {
    /// Returns the changes of the energy by 16 drives, up to the fourth order if the moments have it.
    #[inline(always)]
    pub(crate) fn evaluate(&self, z: Sixteen<'_>) -> S::V {
        self.changes::<true>(z)
    }

    /// Returns the changes of the energy by 16 drives, up to the third order.
    #[inline(always)]
    pub(crate) fn roughly(&self, z: Sixteen<'_>) -> S::V {
        self.changes::<false>(z)
    }

    #[inline(always)]
    fn changes<const FOURTH: bool>(&self, z: Sixteen<'_>) -> S::V {
        let Self { s, points, moments, near, .. } = *self;
        let mut changes = Changes::<FOURTH> { points, moments, near, z, out: [0.0; LANES] };
        s.apart(LANES, &mut changes);
        s.load(&changes.out)
    }

    /// Returns the difference of two changes up to which rounding and the tolerance of ties leave their order open. At
    /// a point that the moments leave out, two terms are rounded four times each: the square of a modulus of up to 5
    /// |G|, and 2 t times this modulus. Here t is at most 4 |G| plus the gap.
    #[inline(always)]
    pub(crate) fn rounding(&self) -> f32 {
        let moments = self.moments;
        let left_out = if self.near.is_empty() { 0.0 } else { 4.0 * moments.rounding(1.0) + 1.1e-5 * moments.power() };
        moments.rounding(1.0) + left_out
    }

    /// Returns a bound on the second derivative of [`Self::roughly`] over the phase, at amplitude a. A point that the
    /// moments leave out has the term |P + e|^2 - 2 t |P + e|: pressure P, target t, added wave e = G z. The first part
    /// contributes at most 2 a |P| |G|. The second is concave in |P + e|, which on an arc of length h is at most its
    /// chord plus a |G| h^2/8.
    #[inline(always)]
    pub(crate) fn curvature(&self, a: f32) -> f32 {
        let left_out = |&j: &u32| {
            let (group, lane) = (&self.points.groups[j as usize / LANES], j as usize % LANES);
            let gain = self.points.row[0][j as usize].abs() + self.points.row[1][j as usize].abs();
            2.0 * a * group.weight[lane] * gain * (group.modulus[lane] + group.target[lane])
        };
        self.moments.curvature(a) + self.near.iter().map(left_out).sum::<f32>()
    }

    /// Returns Q: [`Self::roughly`] at amplitude a is at least a times its value at amplitude 1, less a (1 - a) Q.
    #[inline(always)]
    pub(crate) fn bow(&self) -> f32 {
        let left_out = |&j: &u32| {
            let (re, im) = (self.points.row[0][j as usize], self.points.row[1][j as usize]);
            self.points.groups[j as usize / LANES].weight[j as usize % LANES] * (re * re + im * im)
        };
        self.moments.bow() + self.near.iter().map(left_out).sum::<f32>()
    }
}

/// Kernel of the changes of the energy by 16 drives `z`.
struct Changes<'a, const FOURTH: bool> {
    points: Points<'a>,
    moments: &'a Moments,
    near: &'a [u32],
    z: Sixteen<'a>,
    out: Lanes,
}

impl<const FOURTH: bool> Apart for Changes<'_, FOURTH> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let [re, im] = self.z.load(s);
        let total = if FOURTH { self.moments.fine_change(s, re, im) } else { self.moments.change(s, re, im) };
        s.store(self.add_left_out(s, [re, im], total), &mut self.out);
    }
}

impl<const FOURTH: bool> Changes<'_, FOURTH> {
    /// Adds to `total` the terms that the moments leave out, w (|P + G z|^2 - |P|^2 - 2 t (|P + G z| - |P|)), of points
    /// with weight w, target t, pressure P and gain G. It has fewer instructions than
    /// [`crate::kernels::greedy::search::changes`] and more rounding, see [`Energies::rounding`].
    #[inline(always)]
    fn add_left_out<S: Elementwise>(&self, s: S, [re, im]: [S::V; 2], mut total: S::V) -> S::V {
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
}
