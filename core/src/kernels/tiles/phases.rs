//! Alignment of point phases: one after another is set so that the energy v^H G G^H v grows, from G or from G G^H.

use crate::kernels::phasor::wave;
use crate::kernels::prelude::*;
use crate::kernels::tiles::Tiles;

/// Below this part of a point's own contribution, the contribution of the other points is only rounding.
const SILENT: f32 = 1e-5;

/// Aligns the phases of a vector v of moduli `weights`. In the order of `visits` v_k gets the phase of the pressure
/// that the other points' waves make at its point: row_k b - |row_k|^2 v_k with b = G^H v. At first v is 0, so that the
/// first of the `rounds` adds one point after another. Returns the sum of |v_k| times the moduli of those pressures in
/// the last round.
///
/// If the other points make no wave at a point, its v_k stays unchanged. `powers` are the sums of |G|^2 over the rows;
/// `wave` is memory for b.
///
/// # Errors
/// A requested stop, which is checked once a visit.
#[allow(clippy::too_many_arguments, reason = "a kernel over plain slices")]
pub(crate) fn align_rows(
    set: InstructionSet,
    tiles: Tiles<'_>,
    (weights, powers): (&[f32], &[f32]),
    visits: &[u32],
    rounds: usize,
    vector: [&mut [f32]; 2],
    wave: [&mut [f32]; 2],
    control: &mut Control,
) -> Result<f32> {
    dispatch!(set, s => {
        let [re, im] = vector;
        let [wave_re, wave_im] = wave.map(groups_mut);
        re.fill(0.0);
        im.fill(0.0);
        wave_re.fill([0.0; LANES]);
        wave_im.fill([0.0; LANES]);
        let mut energy = 0.0;
        let (mut last, mut change) = (0, [0.0; 2]);
        for _ in 0..rounds {
            energy = 0.0;
            for &k in visits {
                control.pulse()?;
                let k = k as usize;
                // One pass adds the change of the last point and computes the value at this point.
                let (dr, di) = (s.splat(change[0]), s.splat(change[1]));
                let mut sums = [s.splat(0.0); 4];
                let [[last_re, last_im], [now_re, now_im]] = [last, k].map(|k| tiles.rows(k / BLOCK));
                let before = last_re.iter().zip(last_im);
                let now = now_re.iter().zip(now_im).zip(wave_re.iter_mut().zip(wave_im.iter_mut()));
                for ((lr, li), ((gr, gi), (br, bi))) in before.zip(now) {
                    let (lr, li) = (s.load(&lr[last % BLOCK]), s.load(&li[last % BLOCK]));
                    let real = s.fma(lr, dr, s.fma(li, di, s.load(br)));
                    let imag = s.fma(lr, di, s.fnma(li, dr, s.load(bi)));
                    s.store(real, br);
                    s.store(imag, bi);
                    let (gr, gi) = (s.load(&gr[k % BLOCK]), s.load(&gi[k % BLOCK]));
                    sums = [
                        s.fma(gr, real, sums[0]),
                        s.fma(gi, imag, sums[1]),
                        s.fma(gr, imag, sums[2]),
                        s.fma(gi, real, sums[3]),
                    ];
                }
                let old = [re[k], im[k]];
                let x = s.reduce_add(s.sub(sums[0], sums[1])) - powers[k] * old[0];
                let y = s.reduce_add(s.add(sums[2], sums[3])) - powers[k] * old[1];
                let modulus = sqrtf(x * x + y * y);
                energy += weights[k] * modulus;
                if modulus > SILENT * powers[k] * weights[k] {
                    (re[k], im[k]) = (weights[k] * x / modulus, weights[k] * y / modulus);
                } else if old == [0.0; 2] {
                    re[k] = weights[k];
                }
                (last, change) = (k, [re[k] - old[0], im[k] - old[1]]);
            }
        }
        Ok(energy)
    })
}

/// Aligns the phases of sixteen vectors v, side by side, of moduli `shares`: `rounds` times each v_k gets the phase of
/// sum_l C_kl v_l, C the `matrix`, in the order of `visits`. Returns for each vector the sum of |v_k| |sum_l C_kl v_l|.
///
/// Where that sum is 0, v_k stays unchanged.
///
/// # Errors
/// A requested stop, which is checked once a visit.
pub(crate) fn align(
    set: InstructionSet,
    matrix: [&[f32]; 2],
    shares: &[f32],
    visits: &[u32],
    rounds: usize,
    vectors: [&mut [f32]; 2],
    control: &mut Control,
) -> Result<Lanes> {
    dispatch!(set, s => {
        let [re, im] = vectors.map(groups_mut);
        let size = shares.len();
        let tiny = s.splat(TINY);
        let mut energy = s.splat(0.0);
        for _ in 0..rounds {
            energy = s.splat(0.0);
            for &k in visits {
                control.pulse()?;
                let k = k as usize;
                let row = matrix.map(|plane| &plane[k * size..(k + 1) * size]);
                let mut sums = [s.splat(0.0); 4];
                for ((&cr, &ci), (re, im)) in row[0].iter().zip(row[1]).zip(re.iter().zip(im.iter())) {
                    let (cr, ci, re, im) = (s.splat(cr), s.splat(ci), s.load(re), s.load(im));
                    sums = [s.fma(cr, re, sums[0]), s.fma(ci, im, sums[1]), s.fma(cr, im, sums[2]), s.fma(ci, re, sums[3])];
                }
                let (x, y) = (s.sub(sums[0], sums[1]), s.add(sums[2], sums[3]));
                let square = s.fma(x, x, s.mul(y, y));
                let (root, inverse) = s.sqrt_rsqrt(s.max(square, tiny));
                let share = s.splat(shares[k]);
                energy = s.fma(share, root, energy);
                let scale = s.mul(share, inverse);
                s.store(s.select_less(square, tiny, s.load(&re[k]), s.mul(scale, x)), &mut re[k]);
                s.store(s.select_less(square, tiny, s.load(&im[k]), s.mul(scale, y)), &mut im[k]);
            }
        }
        let mut lanes = [0.0; LANES];
        s.store(energy, &mut lanes);
        Ok(lanes)
    })
}

/// Writes v = share e^{2 pi j x}, sixteen numbers for each share; x are the `turns`.
pub(crate) fn phasors(set: InstructionSet, turns: &[f32], shares: &[f32], out: [&mut [f32]; 2]) {
    dispatch!(set, s => {
        let [re, im] = out.map(groups_mut);
        for ((turns, &share), (re, im)) in groups(turns).iter().zip(shares).zip(re.iter_mut().zip(im)) {
            let [x, y] = wave(s, s.load(turns), s.splat(share));
            s.store(x, re);
            s.store(y, im);
        }
    });
}
