//! The search of large grids against energies in f64.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::Complex64;

use crate::kernels::greedy::energies::Energies;
use crate::kernels::greedy::large_grid;
use crate::kernels::greedy::moments::Moments;
use crate::kernels::greedy::search::{Candidates, L2};
use crate::kernels::lanes::{LANES, padded};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::tests::search::{Scene, least, tolerance};
use crate::kernels::tests::{ROUNDING, assert_near, wide};
use crate::rng::Rng;

/// Amplitudes as uneven as a device's table may be.
fn uneven(amplitudes: usize) -> impl Iterator<Item = f64> {
    (1..=amplitudes).map(move |k| (k as f64 / amplitudes as f64).powf(1.7))
}

fn grid(phases: usize, amplitudes: usize) -> Candidates {
    Candidates::grid(phases, uneven(amplitudes), [const { Vec::new() }; 3])
}

/// A scene of which every seventh point is to be quiet.
fn scene(seed: u64, count: usize, loud: f64) -> Scene {
    let mut scene = Scene::new(seed, count, loud);
    scene.target.iter_mut().skip(3).step_by(7).for_each(|target| *target = 0.0);
    scene
}

/// Calls `check` with the energies of a turn.
macro_rules! with_energies {
    ($set:expr, $scene:expr, $candidates:expr, |$s:ident, $energies:ident| $check:expr) => {{
        let (kept, energy) = $scene.kept($set);
        let points = $scene.points(&kept);
        let mut near = vec![0; padded($scene.count)];
        dispatch!($set, s => {
            let mut lane = [0.0; LANES];
            lane[0] = energy;
            let (moments, nearby) = Moments::new::<_, true>(s, &kept, points.gain, s.load(&lane), &mut near);
            let ($s, $energies) =
                (s, Energies { s, points, moments: &moments, near: &near[..nearby], candidates: $candidates });
            $check
        })
    }};
}

/// Random drives of modulus up to 1.
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
fn the_fourth_order_misses_by_its_remainder_and_differences_by_their_distance() {
    let candidates = grid(64, 1);
    for set in InstructionSet::all() {
        for count in [1, 2, 5, 16, 17, 40, 67, 300] {
            for loud in [0.5, 3.0, 10.0, 100.0] {
                let scene = scene(count as u64, count, loud);
                let [re, im] = drives(7);
                let mut found = [0.0; LANES];
                let (remainder, steep, rounding, near) = with_energies!(set, scene, &candidates, |s, energies| {
                    s.store(energies.moments.fine_change(s, s.load(&re), s.load(&im)), &mut found);
                    let moments = energies.moments;
                    (moments.fine_remainder(), moments.steepness(), moments.rounding(1.0), energies.near.to_vec())
                });
                let miss: Vec<f64> = (0..LANES)
                    .map(|lane| {
                        let q = [wide(re[lane]), wide(im[lane])];
                        let far = (0..count).filter(|&j| !near.contains(&(j as u32)));
                        wide(found[lane]) - far.map(|j| scene.change::<L2>(j, q)).sum::<f64>()
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

/// Point j's change under the drive q with |1 + w| to the fourth order: sum b_p b_q w^p conj(w)^q of p + q up to 4,
/// where sqrt(1 + x) = sum b_n x^n.
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
                let mut found = [0.0; LANES];
                let (rounding, near) = with_energies!(set, scene, &candidates, |s, energies| {
                    s.store(energies.moments.fine_change(s, s.load(&re), s.load(&im)), &mut found);
                    (energies.moments.rounding(1.0), energies.near.to_vec())
                });
                for lane in 0..LANES {
                    let q = Complex64::new(wide(re[lane]), wide(im[lane]));
                    let far = (0..count).filter(|&j| !near.contains(&(j as u32)));
                    let want: f64 = far.map(|j| truncated(&scene, j, q)).sum();
                    assert_near(found[lane], want, wide(rounding), "the fourth order");
                }
            }
        }
    }
}

#[test]
fn lower_amplitudes_and_the_second_derivative_are_bounded() {
    const STEPS: usize = 256;
    let candidates = grid(64, 1);
    for set in InstructionSet::all() {
        for count in [1, 2, 5, 17, 67] {
            for loud in [0.05, 0.5, 3.0, 30.0] {
                let scene = scene(count as u64, count, loud);
                let change = |a: f64| -> (Vec<f64>, [f64; 3]) {
                    with_energies!(set, scene, &candidates, |s, energies| {
                        let at = |step: usize| (TAU * step as f64 / STEPS as f64).sin_cos();
                        let mut found = Vec::new();
                        for step in 0..STEPS {
                            let ((sin, cos), mut lanes) = (at(step), [0.0; LANES]);
                            let z = [s.splat((a * cos) as f32), s.splat((a * sin) as f32)];
                            s.store(energies.roughly(z), &mut lanes);
                            found.push(wide(lanes[0]));
                        }
                        (found, [energies.rounding(), energies.curvature(a as f32), energies.bow()].map(wide))
                    })
                };
                let (full, [rounding, curvature, bow]) = change(1.0);
                // Whatever the stretch, the middle lies below its ends' mean by no more than c h^2/8.
                for half in [1, 3, 8] {
                    let dip = curvature * (TAU * 2.0 * half as f64 / STEPS as f64).powi(2) / 8.0;
                    for step in 0..STEPS {
                        let (v, w) = (full[step], full[(step + 2 * half) % STEPS]);
                        let middle = full[(step + half) % STEPS];
                        assert!(middle >= 0.5 * (v + w) - dip - 2.0 * rounding, "{set}: M = {count}, loud {loud}");
                    }
                }
                for a in [0.1, 0.5, 0.9] {
                    let (lower, _) = change(a);
                    for (lower, full) in lower.into_iter().zip(&full) {
                        let bound = a * full - a * (1.0 - a) * bow - 2.0 * rounding;
                        assert!(lower >= bound, "{set}: M = {count}, loud {loud}, a = {a}: {lower} < {bound}");
                    }
                }
            }
        }
    }
}

/// The candidate that a search of the grid finds, and what rounding leaves open.
fn best(set: InstructionSet, scene: &Scene, candidates: &Candidates, matters: f32) -> (Option<usize>, f32) {
    with_energies!(set, scene, candidates, |s, energies| {
        let mut floats = vec![f32::NAN; large_grid::floats(candidates.phases)];
        let mut close = vec![u32::MAX; large_grid::list(candidates.phases)];
        let Energies { points, moments, near, .. } = energies;
        let found = large_grid::best(s, points, moments, near, candidates, matters, &mut floats, &mut close);
        (found, energies.rounding())
    })
}

fn assert_best(scene: &Scene, phases: usize, amplitudes: usize) {
    let candidates = grid(phases, amplitudes);
    let least = least::<L2>(scene, &candidates, false);
    let silence: f64 = scene.count as f64;
    for set in InstructionSet::all() {
        for matters in [0.0, 1e-4 * silence] {
            let (index, rounding) = best(set, scene, &candidates, matters as f32);
            let bounds: f64 = (0..scene.count).map(|j| scene.bound::<L2>(j)).sum();
            // What need not be told, the tolerance of ties and a term's few roundings as in the exact search, and
            // the rounding of the polynomial.
            let exact = wide(tolerance::<L2>(set, scene)) + 12.0 * ROUNDING * bounds;
            let index = index.expect("a transducer that has an effect");
            let regret = scene.total::<L2>(candidates.drive(index)) - least;
            let allowed = matters + exact + 3.0 * wide(rounding);
            assert!(
                regret <= allowed,
                "{set}: M = {}, L = {phases}, K = {amplitudes}: {regret:e} > {allowed:e}",
                scene.count
            );
        }
    }
}

#[test]
fn the_best_of_a_large_grid_is_found() {
    for count in [1, 2, 5, 16, 17, 40, 67] {
        for loud in [0.05, 0.3, 1.0, 3.0, 10.0, 30.0, 300.0] {
            for (phases, amplitudes) in [(64, 1), (65, 4), (100, 2), (256, 1), (256, 16), (1000, 3)] {
                assert_best(&scene((count + phases) as u64, count, loud), phases, amplitudes);
            }
        }
    }
    for loud in [0.3, 3.0, 30.0] {
        assert_best(&scene(5, 300, loud), 256, 16);
        assert_best(&scene(6, 20, loud), 64, 256);
        assert_best(&scene(7, 9, loud), 65_536, 1);
        assert_best(&scene(8, 3, loud), 10_000, 7);
    }
}

#[test]
fn where_every_point_has_its_target_the_first_moment_tells_nothing() {
    for count in [1, 2, 3, 8, 17, 67] {
        for loud in [0.7, 3.0, 10.0] {
            for (phases, amplitudes) in [(64, 1), (100, 2), (256, 1), (256, 16)] {
                let mut scene = Scene::new((3 * count + phases) as u64, count, loud);
                for j in 0..count {
                    let [re, im, ..] = scene.numbers(j);
                    scene.target[j] = re.hypot(im) as f32;
                }
                assert_best(&scene, phases, amplitudes);
            }
        }
    }
}

#[test]
fn more_rivals_than_a_list_holds_are_decided_all_the_same() {
    // A point that the transducer hardly moves: every candidate is within rounding of every other, and of 16 rings
    // of 256 phases none is passed over.
    for set in InstructionSet::all() {
        let mut scene = scene(3, 2, 1e4);
        scene.target.fill(1e4);
        let candidates = grid(256, 16);
        let (index, rounding) = best(set, &scene, &candidates, 0.0);
        let index = index.expect("a transducer that has an effect");
        let regret = scene.total::<L2>(candidates.drive(index)) - least::<L2>(&scene, &candidates, false);
        assert!(regret <= 3.0 * wide(rounding), "{set}: {regret:e}");
    }
}

#[test]
fn a_transducer_that_reaches_no_point_has_no_best() {
    for set in InstructionSet::all() {
        let mut scene = scene(3, 20, 1.0);
        scene.gain.iter_mut().for_each(|part| part.fill(0.0));
        assert_eq!(best(set, &scene, &grid(256, 16), 0.0).0, None);
        assert_eq!(best(set, &scene, &grid(256, 16), 1.0).0, None);
    }
}
