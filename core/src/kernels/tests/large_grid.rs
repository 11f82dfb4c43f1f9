//! The search of large grids compared with energies in f64.

use alloc::vec;

use crate::kernels::greedy::candidates::Candidates;
use crate::kernels::greedy::candidates::L2;
use crate::kernels::greedy::large_grid;
use crate::kernels::lanes::{LANES, padded};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::tests::energies::{grid, scene, with_energies};
use crate::kernels::tests::search::{Scene, least, tolerance};
use crate::kernels::tests::{ROUNDING, wide};

/// Returns the candidate that a search of the grid finds, and the rounding error of a comparison.
fn best(set: InstructionSet, scene: &Scene, candidates: &Candidates, matters: f32) -> (Option<usize>, f32) {
    with_energies!(set, scene, candidates, |_s, energies| {
        let mut floats = vec![f32::NAN; large_grid::floats(candidates.phases)];
        let mut close = vec![u32::MAX; large_grid::list(candidates.phases)];
        (large_grid::best(&energies, matters, &mut floats, &mut close), energies.rounding())
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
            // The allowed loss: differences that are ignored, the tolerance of ties, a term's few roundings as in the
            // exact search, and the rounding of the polynomial.
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
fn the_first_moment_is_0_where_every_point_has_its_target() {
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
fn more_rivals_than_a_list_has_room_for_are_compared_exactly() {
    // The transducer hardly changes the pressure at these points. So all candidates of 16 amplitudes and 256 phases
    // agree within rounding, and the bounds exclude none of them.
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
