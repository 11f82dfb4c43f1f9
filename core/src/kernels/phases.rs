//! Point phases on a matrix of couplings, sixteen tries side by side.

use super::level::{Level, dispatch};
use super::simd::TINY;
use super::turns::wave;
use super::{LANES, Lanes, groups, groups_mut};

/// Vectors v of the moduli `shares` and the phases `turns`, sixteen side by side, brought into line: `rounds` times
/// each v_k gets the phase of sum_l C_kl v_l, in the order of `visits`. The sum of |v_k| |sum_l C_kl v_l|.
///
/// Where the sum is silent v_k stays.
pub(crate) fn align(
    level: Level,
    matrix: [&[f32]; 2],
    shares: &[f32],
    visits: &[u32],
    rounds: usize,
    vectors: [&mut [f32]; 2],
) -> Lanes {
    dispatch!(level, s => {
        let [re, im] = vectors.map(groups_mut);
        let size = shares.len();
        let tiny = s.splat(TINY);
        let mut energy = s.splat(0.0);
        for _ in 0..rounds {
            energy = s.splat(0.0);
            for &k in visits {
                let k = k as usize;
                let row = matrix.map(|plane| &plane[k * size..(k + 1) * size]);
                let mut sums = [s.splat(0.0); 4];
                for ((&cr, &ci), (re, im)) in row[0].iter().zip(row[1]).zip(re.iter().zip(im.iter())) {
                    let (cr, ci, re, im) = (s.splat(cr), s.splat(ci), s.load(re), s.load(im));
                    sums = [s.fma(cr, re, sums[0]), s.fma(ci, im, sums[1]), s.fma(cr, im, sums[2]), s.fma(ci, re, sums[3])];
                }
                let (x, y) = (s.sub(sums[0], sums[1]), s.add(sums[2], sums[3]));
                let square = s.fma(x, x, s.mul(y, y));
                let (root, inverse) = s.roots(s.max(square, tiny));
                let share = s.splat(shares[k]);
                energy = s.fma(share, root, energy);
                let scale = s.mul(share, inverse);
                s.store(s.select_less(square, tiny, s.load(&re[k]), s.mul(scale, x)), &mut re[k]);
                s.store(s.select_less(square, tiny, s.load(&im[k]), s.mul(scale, y)), &mut im[k]);
            }
        }
        let mut lanes = [0.0; LANES];
        s.store(energy, &mut lanes);
        lanes
    })
}

/// v = share e^{2 pi j x}, sixteen numbers of each share.
pub(crate) fn phasors(level: Level, turns: &[f32], shares: &[f32], out: [&mut [f32]; 2]) {
    dispatch!(level, s => {
        let [re, im] = out.map(groups_mut);
        for ((turns, &share), (re, im)) in groups(turns).iter().zip(shares).zip(re.iter_mut().zip(im)) {
            let [x, y] = wave(s, s.load(turns), s.splat(share));
            s.store(x, re);
            s.store(y, im);
        }
    });
}
