//! Rounding to a board's grid compared with f64; every instruction set gives the same bits.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::Complex32;

use crate::kernels::grid::{Amplitudes, Grid, Phases, range};
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::rng::Rng;

fn grid(phases: Option<u32>, table: Option<&[f64]>) -> Grid {
    Grid { phases: phases.map(Phases::new), amplitudes: table.map(Amplitudes::new) }
}

fn rounded(set: InstructionSet, grid: &Grid, drive: &[Complex32]) -> Vec<Complex32> {
    let mut out = drive.to_vec();
    grid.round(set, 1.0, [1.0; 2], &mut out);
    out
}

fn tables() -> Vec<Vec<f64>> {
    let even = |count: u32| (0..count).map(|k| f64::from(k) / f64::from(count - 1)).collect();
    // Pulse widths: the amplitude is the sine of the width, and hundreds of values are close below 1.
    let pulses = (0..=256).map(|k| (TAU * f64::from(k) / 1024.0).sin().min(1.0)).collect();
    vec![vec![1.0], vec![0.0, 1.0], even(256), even(65_536), pulses, vec![0.0, 1e-6, 0.3, 0.301, 1.0]]
}

#[test]
#[ignore = "slow"]
fn every_set_finds_the_nearest_code_with_the_same_bits() {
    let mut rng = Rng::new(1);
    for length in super::LENGTHS {
        let polar = |modulus: f64, turns: f64| Complex32::from_polar(modulus as f32, (TAU * turns) as f32);
        let mut drive: Vec<_> = (0..length).map(|_| polar(rng.uniform().min(1.0), rng.uniform())).collect();
        drive[0] = Complex32::ZERO;
        for phases in [2, 3, 16, 32, 256, 65_536] {
            for table in tables() {
                let grid = grid(Some(phases), Some(&table));
                let first = rounded(InstructionSet::SCALAR, &grid, &drive);
                for set in InstructionSet::all() {
                    assert_eq!(rounded(set, &grid, &drive), first, "{set}");
                    assert_eq!(rounded(set, &grid, &first), first, "{set}: what lies on the grid stays");
                }
                assert_eq!(first[0], Complex32::ZERO);
                for (q, got) in drive.iter().zip(&first).skip(1) {
                    let modulus = f64::from(q.re).hypot(f64::from(q.im));
                    let misses = table.iter().map(|a| (a - modulus).abs());
                    let amplitude = f64::from(got.re).hypot(f64::from(got.im));
                    let least = misses.fold(f64::INFINITY, f64::min);
                    assert!((amplitude - modulus).abs() <= least + 2e-7, "{amplitude} for {modulus} of {table:?}");
                    if amplitude > 0.0 {
                        let turn = |z: &Complex32| f64::from(z.im).atan2(f64::from(z.re)) / TAU;
                        let code = turn(got) * f64::from(phases);
                        assert!((code - code.round()).abs() < 2e-7 * f64::from(phases), "phase {code} of {phases}");
                        let off = (turn(q) * f64::from(phases) - code).rem_euclid(f64::from(phases));
                        let off = off.min(f64::from(phases) - off);
                        assert!(off <= 0.5 + 1e-7 * f64::from(phases), "{off} codes off of {phases}");
                    }
                }
            }
        }
    }
}

#[test]
fn of_two_equally_near_the_later_phase_and_the_larger_amplitude_win() {
    let diagonal = |re: f32, im: f32| Complex32::new(0.5 * re, 0.5 * im);
    for set in InstructionSet::all() {
        let quarters = grid(Some(4), Some(&[1.0]));
        let drive = [diagonal(1.0, 1.0), diagonal(-1.0, 1.0), diagonal(-1.0, -1.0), diagonal(1.0, -1.0)];
        let axes = [(0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0)].map(|(re, im)| Complex32::new(re, im));
        for (got, want) in rounded(set, &quarters, &drive).iter().zip(axes) {
            assert!((got - want).norm() < 1e-7, "{set}: {got} for {want}");
        }
        let halves = grid(Some(2), Some(&[1.0]));
        let upright = rounded(set, &halves, &[Complex32::new(0.0, 1.0), Complex32::new(0.0, -1.0)]);
        assert!((upright[0] + 1.0).norm() < 1e-7 && (upright[1] - 1.0).norm() < 1e-7, "{set}: {upright:?}");
        let table = grid(Some(1 << 10), Some(&[0.0, 0.25, 1.0]));
        for (modulus, nearest) in [(0.1, 0.0), (0.125, 0.25), (0.3, 0.25), (0.62, 0.25), (0.625, 1.0), (1.1, 1.0)] {
            let got = rounded(set, &table, &[Complex32::new(modulus, 0.0)])[0];
            assert_eq!(got, Complex32::new(nearest, 0.0), "{set}: {modulus}");
        }
    }
}

#[test]
fn tiny_drives_and_drives_that_are_not_finite_are_rounded() {
    let odd = [1e-30, 1e-40, f32::NAN, f32::INFINITY].map(|x| Complex32::new(x, x));
    for set in InstructionSet::all() {
        for table in tables() {
            let got = rounded(set, &grid(Some(256), Some(&table)), &odd);
            let least = *table.first().unwrap() as f32;
            assert!((got[0].norm() - least).abs() < 1e-6, "{set}: {got:?}");
        }
    }
}

#[test]
fn continuous_phases_or_amplitudes_stay() {
    let mut rng = Rng::new(2);
    let drive: Vec<_> =
        (0..100).map(|_| Complex32::from_polar(rng.uniform() as f32, 7.0 * rng.uniform() as f32)).collect();
    for set in InstructionSet::all() {
        assert_eq!(rounded(set, &grid(None, None), &drive), drive);
        for half in [grid(Some(10), None), grid(None, Some(&[0.0, 0.3, 1.0]))] {
            let once = rounded(set, &half, &drive);
            assert_eq!(rounded(set, &half, &once), once, "{set}");
            for (q, got) in drive.iter().zip(&once) {
                let turn = |z: &Complex32| z.im.atan2(z.re);
                if half.phases.is_some() {
                    assert!((q.norm() - got.norm()).abs() < 1e-6);
                } else if got.norm() > 0.0 {
                    assert!((turn(q) - turn(got)).abs() < 1e-6);
                }
            }
        }
    }
}

#[test]
fn factor_and_range() {
    for set in InstructionSet::all() {
        let grid = grid(Some(256), Some(&[0.0, 0.25, 0.5, 1.0]));
        let phases: Vec<_> = (0..50).map(|l| Complex32::from_polar(1.0, (TAU * f64::from(l) / 256.0) as f32)).collect();
        let full = rounded(set, &grid, &phases);
        assert!(range(set, &full).iter().all(|modulus| (modulus - 1.0).abs() < 2e-7), "{set}");
        let mut half = full.clone();
        assert!(grid.round(set, 2.0, [0.5; 2], &mut half), "{set}: all are what they were times a half");
        assert_eq!(half, full.iter().map(|q| q * 0.5).collect::<Vec<_>>());
        let mut other = full.clone();
        other[49] *= 0.3;
        other[7] = Complex32::ZERO;
        let [least, most] = range(set, &other);
        assert!((least - 0.3).abs() < 1e-7 && (most - 1.0).abs() < 2e-7, "{set}: silence is left out");
        assert_eq!(range(set, &[Complex32::ZERO; 3]), [1.0, 0.0]);
        assert!(!grid.round(set, 1.0, [1.0; 2], &mut other), "{set}: one is not");
    }
}

#[test]
fn moduli_whose_squares_underflow_stay_accurate() {
    let drive = [4.7e-23, 5.1e-23].map(|modulus| Complex32::new(0.0, modulus));
    for set in InstructionSet::all() {
        let mut out = drive.to_vec();
        grid(Some(16), None).round(set, 1.0, [5.1e-23; 2], &mut out);
        for (got, q) in out.iter().zip(drive) {
            assert!((got.im / q.im - 1.0).abs() < 1e-6, "{set}: {got} for {q}");
        }
    }
}
