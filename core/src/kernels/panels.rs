//! Panels: waves of flat elements of surfaces at a point, eight elements at a time, and their sums.
//!
//! ```text
//! h_e  = sum over the nodes of w e^{jkr - alpha r}/r (beside + along (jk - alpha - 1/r) (-ray . n)/r)
//! out += sum_e h_e S_e                                  S_e: the response of element e to each transducer
//! ```
//!
//! r is the distance from a node of weight w to the point, n the element's normal, k the wavenumber, alpha the
//! absorption. The rows of S are long and many: eight of them stay in the nearest cache while the sums of all points
//! are computed. No products are fused: every instruction set gives the same bits.

use crate::kernels::phasor::phasor;
use crate::kernels::prelude::*;
use crate::kernels::simd::doubles::{Doubles, EIGHT, Eight, V, dot, loaded, ray, runs};
use crate::math::exp;

/// Number of nodes of an element.
pub(crate) const NODES: usize = 6;

/// Number of rows of the matrix S (see the module's head) that stay in the cache.
const TOGETHER: usize = 8;

/// Geometry and factors of eight elements.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Panels {
    pub(crate) center: [Eight; 3],
    pub(crate) normal: [Eight; 3],
    pub(crate) nodes: [[Eight; 3]; NODES],
    pub(crate) weights: [Eight; NODES],
    /// Factors of an element's wave itself and of its derivative along the normal, see the module's head.
    pub(crate) beside: Eight,
    pub(crate) along: Eight,
}

impl Panels {
    /// Eight lanes without elements.
    pub(crate) const NONE: Self = Self {
        center: [[0.0; EIGHT]; 3],
        normal: [[0.0; EIGHT]; 3],
        nodes: [[[0.0; EIGHT]; 3]; NODES],
        weights: [[0.0; EIGHT]; NODES],
        beside: [0.0; EIGHT],
        along: [0.0; EIGHT],
    };
}

/// Calls `take` with the waves h (see the module's head) of each eight elements at a point: real and imaginary parts.
/// No element may be near the point. `wave` is a wavenumber in rad/m and an absorption in 1/m.
pub(crate) fn each(
    set: InstructionSet,
    wave: [f64; 2],
    panels: &[Panels],
    point: [f64; 3],
    mut take: impl FnMut(&[Eight; 2]),
) {
    dispatch!(set, s => {
        for block in panels {
            let mut sent = [[0.0; EIGHT]; 2];
            for at in runs(s) {
                let [re, im] = eight(s, wave, block, at, point);
                re.put(&mut sent[0][at..]);
                im.put(&mut sent[1][at..]);
            }
            take(&sent);
        }
    });
}

#[inline(always)]
fn eight<S: Doubles>(
    s: S,
    [wavenumber, absorption]: [f64; 2],
    block: &Panels,
    at: usize,
    point: [f64; 3],
) -> [V<S>; 2] {
    let normal = loaded(s, &block.normal, at);
    let (beside, along) = (V::of(s, &block.beside[at..]), V::of(s, &block.along[at..]));
    let mut absorbed = None;
    if absorption > 0.0 {
        let d = ray(s, point, (&block.center, at));
        let away = dot(d, d).sqrt();
        absorbed = Some((away, away.each(|r| [exp(-absorption * r)])[0]));
    }
    let mut sums = [V::all(s, 0.0); 2];
    for (node, weight) in block.nodes.iter().zip(&block.weights) {
        let d = ray(s, point, (node, at));
        let r = dot(d, d).sqrt();
        let near = r.inverse();
        let mut g = V::of(s, &weight[at..]) * near;
        if let Some((away, grown)) = absorbed {
            // Within an element absorption is small, so four terms of its series suffice.
            let x = (r - away) * -absorption;
            g = g * grown * (x * (x * (x * (x * (1.0 / 24.0) + 1.0 / 6.0) + 0.5) + 1.0) + 1.0);
        }
        let (cos, sin) = phasor(s, r * (wavenumber / TAU));
        let across = dot(d, normal) * near * along;
        let factor = [across * (near + absorption) + beside, across * -wavenumber];
        sums[0] = sums[0] + g * (cos * factor[0] - sin * factor[1]);
        sums[1] = sums[1] + g * (sin * factor[0] + cos * factor[1]);
    }
    sums
}

/// Adds to each point's sums over the transducers the waves h times the rows of S (see the module's head). `answers`
/// are the rows of S, `received` the h of each point, one number for each element. All are real and imaginary parts,
/// padded to whole lane groups.
pub(crate) fn add_answers(
    set: InstructionSet,
    answers: [&[f32]; 2],
    received: &[[impl AsRef<[f32]>; 2]],
    sums: &mut [[impl AsMut<[f32]>; 2]],
    lanes: usize,
) {
    dispatch!(set, s => {
        let [re, im] = answers.map(|plane| plane.chunks(TOGETHER * lanes));
        for (k, (re, im)) in re.zip(im).enumerate() {
            let rows = k * TOGETHER..k * TOGETHER + re.len() / lanes;
            for (received, [to_re, to_im]) in received.iter().zip(&mut *sums) {
                let [x, y] = received.each_ref().map(|plane| &plane.as_ref()[rows.clone()]);
                let to = groups_mut(to_re.as_mut()).iter_mut().zip(groups_mut(to_im.as_mut()));
                for (g, (to_re, to_im)) in to.enumerate() {
                    let (mut sum_re, mut sum_im) = (s.load(to_re), s.load(to_im));
                    let rows = re.chunks_exact(lanes).zip(im.chunks_exact(lanes));
                    for ((re, im), (x, y)) in rows.zip(x.iter().zip(y)) {
                        let (a, b) = (s.load(&groups(re)[g]), s.load(&groups(im)[g]));
                        let (x, y) = (s.splat(*x), s.splat(*y));
                        sum_re = s.add(sum_re, s.sub(s.mul(x, a), s.mul(y, b)));
                        sum_im = s.add(sum_im, s.add(s.mul(x, b), s.mul(y, a)));
                    }
                    s.store(sum_re, to_re);
                    s.store(sum_im, to_im);
                }
            }
        }
    });
}
