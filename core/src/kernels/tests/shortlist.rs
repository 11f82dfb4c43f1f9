//! The shortlist of a small grid compared with energies in f64.

use alloc::vec;

use crate::kernels::greedy::candidates::L2;
use crate::kernels::greedy::energies::Energies;
use crate::kernels::greedy::moments::Moments;
use crate::kernels::greedy::shortlist;
use crate::kernels::lanes::{LANES, padded};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::tests::search::{Scene, candidates, least};
use crate::kernels::tests::wide;

#[test]
fn the_shortlist_contains_the_best() {
    for set in InstructionSet::all() {
        for count in [1, 2, 5, 16, 17, 40, 67] {
            for loud in [0.3, 3.0, 30.0] {
                for (phases, amplitudes) in [(16, 1), (7, 3), (60, 2)] {
                    let scene = Scene::new((count + phases) as u64, count, loud);
                    let candidates = candidates(phases, amplitudes);
                    let (state, energy) = scene.state(set);
                    let points = scene.points(&state);
                    let mut near = vec![0; padded(count)];
                    let mut close = vec![0; shortlist::MOST];
                    let mut floats = vec![f32::NAN; shortlist::MOST];
                    let (slack, overflows, close) = dispatch!(set, s => {
                        let mut lane = [0.0; LANES];
                        lane[0] = energy;
                        let (moments, nearby) = Moments::new::<_, false>(s, points, s.load(&lane), &mut near, &mut [[0.0; 16]; 16]);
                        let near = &near[..nearby];
                        let energies = Energies { s, points, moments: &moments, near, candidates: &candidates };
                        let mut list = shortlist::shortlist(&energies, &mut floats, &mut close);
                        (list.slack, list.overflows(), if list.overflows() { vec![] } else { list.indices().to_vec() })
                    });
                    if overflows {
                        continue;
                    }
                    assert!(close.is_sorted() && !close.is_empty());
                    let reached = |index: &u32| scene.total::<L2>(candidates.drive(*index as usize));
                    let lowest = close.iter().map(reached).fold(f64::INFINITY, f64::min);
                    // The slack is larger than rounding; a larger loss would mean that an arc was left out by mistake.
                    let lost = lowest - least::<L2>(&scene, &candidates, false);
                    assert!(lost <= 0.1 * wide(slack), "{set}: M = {count}, L = {phases}: {lost:e} of {slack:e}");
                }
            }
        }
    }
}
