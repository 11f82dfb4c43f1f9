//! Sine, cosine and decay of phases counted in turns: polynomials without branches or tables.

use super::Lanes;
use core::array::from_fn;

/// Adding and subtracting 1.5 * 2^23 rounds to the nearest integer any |x| below 2^22.
const ROUND: f32 = 12_582_912.0;

/// sin(2 pi x)/x in powers of x^2, least maximal error on |x| <= 1/4 (3e-9, below f32 rounding).
#[allow(clippy::approx_constant, reason = "fitted coefficients that lie near a constant")]
const SINE: [f32; 5] = [6.283_185, -41.341_656, 81.601_006, -76.549_78, 39.536_705];

/// 2^x in powers of x, least relative error on |x| <= 1/2 (2e-9).
#[allow(clippy::approx_constant, reason = "fitted coefficients that lie near a constant")]
const POWER: [f32; 7] =
    [1.0, 0.693_147_2, 0.240_226_47, 0.055_503_29, 0.009_618_489, 0.001_339_993_1, 0.000_153_458_12];

#[inline(always)]
fn sine(x: f32) -> f32 {
    let square = x * x;
    let [c0, c1, c2, c3, c4] = SINE;
    ((((c4 * square + c3) * square + c2) * square + c1) * square + c0) * x
}

/// (cos 2 pi x, sin 2 pi x) of |x| < 2^22 turns, absolute error below 3e-7.
#[inline(always)]
pub(crate) fn cis(turns: &Lanes) -> (Lanes, Lanes) {
    // The fraction in [-1/2, 1/2] is exact; so are the two foldings into the sine's own quarter turn.
    let fraction: Lanes = from_fn(|l| turns[l] - ((turns[l] + ROUND) - ROUND));
    let cos = from_fn(|l| sine(0.25 - fraction[l].abs()));
    let sin = from_fn(|l| {
        let size = fraction[l].abs();
        let other = 0.5 - size;
        sine(if size < other { size } else { other }).copysign(fraction[l])
    });
    (cos, sin)
}

/// 2^x for x <= 0; what would be below 2^-126 is 2^-126 times a number near 1.
#[inline(always)]
pub(crate) fn power_of_two(x: &Lanes) -> Lanes {
    let clamped: Lanes = from_fn(|l| if x[l] > -126.0 { x[l] } else { -126.0 });
    let whole: Lanes = from_fn(|l| (clamped[l] + ROUND) - ROUND);
    from_fn(|l| {
        let x = clamped[l] - whole[l];
        let [c0, c1, c2, c3, c4, c5, c6] = POWER;
        let mantissa = (((((c6 * x + c5) * x + c4) * x + c3) * x + c2) * x + c1) * x + c0;
        // The exponent's bits: whole is an integer in -126..=0.
        mantissa * f32::from_bits(((whole[l] as i32 + 127) as u32) << 23)
    })
}

#[cfg(test)]
mod tests {
    use super::super::LANES;
    use super::*;

    #[test]
    fn cis_is_within_3e_7_over_the_whole_range() {
        for scale in [1e-7_f32, 1e-3, 0.3, 1.0, 7.7, 117.6, 1e4, 4e6] {
            for step in -4000..4000_i16 {
                let lanes: Lanes = from_fn(|l| scale * (f32::from(step) + l as f32 / 16.0) / 4000.0);
                let (cos, sin) = cis(&lanes);
                for l in 0..LANES {
                    let angle = core::f64::consts::TAU * f64::from(lanes[l]).fract();
                    assert!((f64::from(cos[l]) - angle.cos()).abs() < 3e-7, "cos {}", lanes[l]);
                    assert!((f64::from(sin[l]) - angle.sin()).abs() < 3e-7, "sin {}", lanes[l]);
                }
            }
        }
    }

    #[test]
    fn cis_is_exact_at_quarter_turns() {
        let (cos, sin) = cis(&from_fn(|l| l as f32 / 4.0));
        for l in 0..LANES {
            let (c, s) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][l % 4];
            assert!((cos[l] - c).abs() < 2e-7 && (sin[l] - s).abs() < 2e-7);
        }
    }

    #[test]
    fn power_of_two_is_within_2e_7() {
        for step in 0..4000_i16 {
            let lanes: Lanes = from_fn(|l| -126.0 * (f32::from(step) + l as f32 / 16.0) / 4000.0);
            for (power, x) in power_of_two(&lanes).into_iter().zip(lanes) {
                assert!((f64::from(power) / f64::from(x).exp2() - 1.0).abs() < 2e-7, "2^{x}");
            }
        }
        assert!(power_of_two(&[-1e9; LANES])[0] <= 2.0_f32.powi(-125));
    }
}
