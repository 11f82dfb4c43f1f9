//! Drives within an arc of phases around 1 compared with f64: sweeps, rotations, and columns of relative drives.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tests::tiles::Scene;
use crate::kernels::tests::wide;
use crate::kernels::tiles;
use crate::kernels::tiles::unit::Arc;
use crate::rng::Rng;

/// Number of transducers: two whole pairs of tiles, because drives in the padding would be within the arc, too.
const TRANSDUCERS: usize = 64;

/// Half widths of the arc in rad, from 0 to more than a quarter turn.
const CHANGES: [f64; 4] = [0.0, 0.2, 1.3, 2.5];

fn arc(change: f64) -> Arc {
    [libm::cos(change), libm::sin(change)].map(|x| x as f32)
}

/// Returns the phasor within the arc that is nearest to q; `None` where both ends are equally near.
fn clipped(q: Complex64, change: f64) -> Option<Complex64> {
    let angle = q.arg();
    (angle.abs() < PI - 1e-3).then(|| Complex64::from_polar(1.0, angle.clamp(-change, change)))
}

fn each(test: impl Fn(InstructionSet, usize, f64, &mut Rng)) {
    for set in InstructionSet::all() {
        for count in [1, 3, 4, 9, 16] {
            for change in CHANGES {
                test(set, count, change, &mut Rng::new(count as u64));
            }
        }
    }
}

fn phasors(rng: &mut Rng) -> [Vec<f32>; 2] {
    let turns: Vec<f64> = (0..TRANSDUCERS).map(|_| TAU * rng.uniform()).collect();
    [libm::cos, libm::sin].map(|of: fn(f64) -> f64| turns.iter().map(|&turn| of(turn) as f32).collect())
}

fn near(drive: &[Complex64], exact: impl Fn(usize) -> Option<Complex64>, reported: &str) {
    let off = |i: usize| exact(i).map_or(0.0, |q| (drive[i] - q).norm());
    let most = (0..TRANSDUCERS).map(off).fold(0.0, f64::max);
    // The allowed error: some roundings of sums of 16 terms. It is relative to the sum, which may be a tenth of one
    // term.
    assert!(most < 1e-4, "{reported}: {most}");
}

#[test]
fn a_sweep_ends_within_the_arc() {
    each(|set, count, change, rng| {
        let scene = Scene::new(count, TRANSDUCERS, set);
        let rows = tiles::height(count);
        let mut target = [(); 2].map(|()| vec![0.0; rows]);
        for k in 0..count {
            let phase = TAU * rng.uniform();
            (target[0][k], target[1][k]) = (libm::cos(phase) as f32, libm::sin(phase) as f32);
        }
        let mut memory = vec![f32::NAN; tiles::unit::sweep_floats(rows)];
        let [drive, _] = scene.play(|wave| {
            let target = [&target[0][..], &target[1]];
            tiles::unit::sweep_within(set, scene.tiles(), target, arc(change), wave, &mut memory);
        });
        let aimed = |i: usize| {
            let part = |k: usize| scene.matrix[k][i].conj() * Complex64::new(wide(target[0][k]), wide(target[1][k]));
            let sum: Complex64 = (0..count).map(part).sum();
            if sum.norm() < 0.05 { None } else { clipped(sum, change) }
        };
        near(&drive, aimed, &format!("{set} {count} {change}"));
    });
}

#[test]
fn a_turn_ends_within_the_arc() {
    each(|set, count, change, rng| {
        let scene = Scene::new(count, TRANSDUCERS, set);
        let from = phasors(rng);
        let turns: Vec<f32> = (0..TRANSDUCERS).map(|_| (2.0 * rng.uniform() - 1.0) as f32).collect();
        // Each drive has its own arc.
        let bound = |i: usize| change * (1.0 + (i % 3) as f64) / 3.0;
        let [drive, _] = scene.play(|wave| {
            let (cos, sin): (Vec<f32>, Vec<f32>) = (0..TRANSDUCERS).map(|i| arc(bound(i)).into()).unzip();
            tiles::unit::turn_within(set, scene.tiles(), [&from[0], &from[1]], &turns, [&cos, &sin], wave);
        });
        let turned = |i: usize| {
            let q = Complex64::new(wide(from[0][i]), wide(from[1][i]));
            clipped(q * Complex64::from_polar(1.0, libm::atan(wide(turns[i]))), bound(i))
        };
        near(&drive, turned, &format!("{set} {count} {change}"));
    });
}

#[test]
fn columns_are_rotated_one_by_one() {
    each(|set, count, _, rng| {
        let mut scene = Scene::new(count, TRANSDUCERS, set);
        let q = phasors(rng);
        let [re, im] = &mut scene.planes;
        tiles::rotate_columns(set, [re, im], [&q[0], &q[1]]);
        let times = |i: usize| Complex64::new(wide(q[0][i]), wide(q[1][i]));
        for row in &mut scene.matrix {
            row.iter_mut().enumerate().for_each(|(i, g)| *g *= times(i));
        }
        // `play` compares the field with the product of drive and matrix.
        scene.play(|wave| {
            wave.drive.into_iter().for_each(|plane| plane.fill(0.5));
            let [re, im] = [vec![0.5; TRANSDUCERS], vec![0.5; TRANSDUCERS]];
            let mut drive = [re, im];
            let [re, im] = &mut drive;
            tiles::play(set, scene.tiles(), tiles::Wave { drive: [re, im], field: wave.field });
        });
    });
}
