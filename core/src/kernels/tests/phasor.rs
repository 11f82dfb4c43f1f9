//! Tests of `phasor`.

use super::*;
use crate::kernels::lanes::{LANES, Lanes};
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::simd::instruction_set::dispatch;
use crate::kernels::tests::STRIDE;
use core::array::from_fn;

fn cis(set: InstructionSet, turns: &Lanes) -> [Lanes; 2] {
    dispatch!(set, s => {
        let mut out = [[f32::NAN; LANES]; 2];
        for (v, lanes) in wave(s, s.load(turns), s.splat(1.0)).into_iter().zip(&mut out) {
            s.store(v, lanes);
        }
        out
    })
}

fn power(set: InstructionSet, x: &Lanes) -> Lanes {
    dispatch!(set, s => {
        let mut out = [f32::NAN; LANES];
        s.store(power_of_two(s, s.load(x)), &mut out);
        out
    })
}

#[test]
fn waves_are_accurate_over_the_whole_range() {
    for set in InstructionSet::all() {
        // The intermediate result sigma^2 of `wave` is up to 2. Without fused products it has one more rounding.
        let allowed = if ["scalar", "simd128"].contains(&set.name()) { 7e-7 } else { 6e-7 };
        for scale in [1e-7_f32, 1e-3, 0.3, 1.0, 7.7, 117.6, 1e4, 4e6] {
            for step in (-4000..4000_i16).step_by(STRIDE) {
                let turns: Lanes = from_fn(|l| scale * (f32::from(step) + l as f32 / 16.0) / 4000.0);
                let [cos, sin] = cis(set, &turns);
                for l in 0..LANES {
                    let angle = core::f64::consts::TAU * f64::from(turns[l]).fract();
                    assert!((f64::from(cos[l]) - angle.cos()).abs() < allowed, "{set}: cos {}", turns[l]);
                    assert!((f64::from(sin[l]) - angle.sin()).abs() < allowed, "{set}: sin {}", turns[l]);
                }
            }
        }
    }
}

#[test]
fn waves_at_quarter_turns() {
    for set in InstructionSet::all() {
        let [cos, sin] = cis(set, &from_fn(|l| l as f32 / 4.0));
        for l in 0..LANES {
            let (c, s) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][l % 4];
            assert!((cos[l] - c).abs() < 3e-7 && (sin[l] - s).abs() < 3e-7, "{set}");
        }
    }
}

#[test]
fn power_of_two_is_within_2e_7() {
    for set in InstructionSet::all() {
        for step in (0..4000_i16).step_by(STRIDE) {
            let x: Lanes = from_fn(|l| -126.0 * (f32::from(step) + l as f32 / 16.0) / 4000.0);
            for (power, x) in power(set, &x).into_iter().zip(x) {
                assert!((f64::from(power) / f64::from(x).exp2() - 1.0).abs() < 2e-7, "{set}: 2^{x}");
            }
        }
        assert!(power(set, &[-1e9; LANES])[0] <= 2.0_f32.powi(-125));
    }
}
