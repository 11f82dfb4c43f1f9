//! The moments' polynomials compared with energies in f64.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::Complex64;

use crate::kernels::greedy::candidates::L2;
use crate::kernels::greedy::moments::Moments;
use crate::kernels::lanes::{LANES, padded};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::tests::energies::{grid, scene, with_energies};
use crate::kernels::tests::search::Scene;
use crate::kernels::tests::{LENGTHS, assert_near, wide};
use crate::rng::Rng;

/// Returns random drives of modulus up to 1.
fn drives(seed: u64) -> [[f32; LANES]; 2] {
    let mut rng = Rng::new(seed);
    let mut drives = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        let ((sin, cos), size) = ((TAU * rng.uniform()).sin_cos(), rng.uniform());
        (drives[0][lane], drives[1][lane]) = ((size * cos) as f32, (size * sin) as f32);
    }
    drives
}

#[test]
fn moments_are_the_energy_within_their_remainder() {
    for set in InstructionSet::all() {
        for count in LENGTHS {
            for loud in [0.5, 3.0, 10.0, 100.0] {
                let scene = Scene::new(count as u64, count, loud);
                let (state, energy) = scene.state(set);
                let mut near = vec![u32::MAX; padded(count)];
                let (mut changes, mut re, mut im) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
                let mut rng = Rng::new(7);
                for lane in 0..LANES {
                    let (sin, cos) = (TAU * rng.uniform()).sin_cos();
                    let size = rng.uniform();
                    (re[lane], im[lane]) = ((size * cos) as f32, (size * sin) as f32);
                }
                let (moments, nearby) = dispatch!(set, s => {
                    let mut lane = [0.0; LANES];
                    lane[0] = energy;
                    let result = Moments::new::<_, false>(s, scene.points(&state), s.load(&lane), &mut near, &mut [[0.0; 16]; 16]);
                    s.store(result.0.change(s, s.load(&re), s.load(&im)), &mut changes);
                    result
                });
                let near = &near[..nearby];
                let size = |j: usize| {
                    let [pr, pi, gr, gi] = scene.numbers(j);
                    gr.hypot(gi) / pr.hypot(pi)
                };
                // Points with |u| = |G/P| above 1/4 are left out.
                for j in 0..count {
                    assert_eq!(near.contains(&(j as u32)), size(j) > 0.25, "{set}: point {j} of {count}");
                }
                for lane in 0..LANES {
                    let q = [re[lane], im[lane]].map(wide);
                    let far = (0..count).filter(|&j| !near.contains(&(j as u32)));
                    let exact: f64 = far.map(|j| scene.change::<L2>(j, q)).sum();
                    let reach = q[0].hypot(q[1]) as f32;
                    let allowed = wide(moments.slack(reach.max(1e-3)));
                    let miss = (wide(changes[lane]) - exact).abs();
                    assert!(miss <= allowed, "{set}: M = {count}, loud {loud}: {miss:e} > {allowed:e}");
                }
            }
        }
    }
}

#[test]
fn the_fourth_order_misses_by_its_remainder_and_differences_by_their_distance() {
    let candidates = grid(64, 1);
    for set in InstructionSet::all() {
        for count in [1, 2, 5, 16, 17, 40, 67, 300] {
            for loud in [0.5, 3.0, 10.0, 100.0] {
                let scene = scene(count as u64, count, loud);
                let [re, im] = drives(7);
                let mut values = [0.0; LANES];
                let (remainder, steep, rounding, near) = with_energies!(set, scene, &candidates, |s, energies| {
                    s.store(energies.moments.fine_change(s, s.load(&re), s.load(&im)), &mut values);
                    let moments = energies.moments;
                    (moments.fine_remainder(), moments.steepness(), moments.rounding(1.0), energies.near.to_vec())
                });
                let miss: Vec<f64> = (0..LANES)
                    .map(|lane| {
                        let q = [wide(re[lane]), wide(im[lane])];
                        let far = (0..count).filter(|&j| !near.contains(&(j as u32)));
                        wide(values[lane]) - far.map(|j| scene.change::<L2>(j, q)).sum::<f64>()
                    })
                    .collect();
                for a in 0..LANES {
                    assert!(miss[a].abs() <= wide(remainder + rounding), "{set}: M = {count}, loud {loud}: {miss:?}");
                    for b in 0..a {
                        let apart = f64::hypot(wide(re[a] - re[b]), wide(im[a] - im[b]));
                        let allowed = wide(steep) * apart + wide(rounding);
                        assert!((miss[a] - miss[b]).abs() <= allowed, "{set}: M = {count}, loud {loud}: {miss:?}");
                    }
                }
            }
        }
    }
}

/// Returns point j's change by the drive q with |1 + w| to the fourth order: the sum of b_p b_q w^p conj(w)^q for p + q
/// up to 4, where sqrt(1 + x) = sum b_n x^n.
fn truncated(scene: &Scene, j: usize, q: Complex64) -> f64 {
    const ROOT: [f64; 5] = [1.0, 0.5, -0.125, 0.0625, -5.0 / 128.0];
    let [pr, pi, gr, gi] = scene.numbers(j);
    let (p, e) = (Complex64::new(pr, pi), Complex64::new(gr, gi) * q);
    let w = e / p;
    let mut root = 0.0;
    for m in 0..5 {
        for n in 0..5 - m {
            root += ROOT[m] * ROOT[n] * (w.powu(m as u32) * w.conj().powu(n as u32)).re;
        }
    }
    let square = (p.conj() * e).re * 2.0 + e.norm_sqr();
    wide(scene.weight[j]) * (square - 2.0 * wide(scene.target[j]) * p.norm() * (root - 1.0))
}

#[test]
fn the_fourth_order_is_the_series() {
    let candidates = grid(64, 1);
    for set in InstructionSet::all() {
        for count in [1, 2, 5, 16, 17, 40, 67] {
            for loud in [1.0, 3.0, 10.0] {
                let scene = scene(count as u64, count, loud);
                let [re, im] = drives(8);
                let mut values = [0.0; LANES];
                let (rounding, near) = with_energies!(set, scene, &candidates, |s, energies| {
                    s.store(energies.moments.fine_change(s, s.load(&re), s.load(&im)), &mut values);
                    (energies.moments.rounding(1.0), energies.near.to_vec())
                });
                for lane in 0..LANES {
                    let q = Complex64::new(wide(re[lane]), wide(im[lane]));
                    let far = (0..count).filter(|&j| !near.contains(&(j as u32)));
                    let want: f64 = far.map(|j| truncated(&scene, j, q)).sum();
                    assert_near(values[lane], want, wide(rounding), "the fourth order");
                }
            }
        }
    }
}
