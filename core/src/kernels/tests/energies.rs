//! Changes of the energy by the polynomial and by eq. (7), and their bounds, compared with f64.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use crate::kernels::greedy::candidates::{Candidates, Sixteen};
use crate::kernels::lanes::{LANES, padded};
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::tests::search::Scene;
use crate::kernels::tests::wide;

/// Returns amplitudes as uneven as a device's table may be.
fn uneven(amplitudes: usize) -> impl Iterator<Item = f64> {
    (1..=amplitudes).map(move |k| (k as f64 / amplitudes as f64).powf(1.7))
}

pub(super) fn grid(phases: usize, amplitudes: usize) -> Candidates {
    Candidates::grid(phases, uneven(amplitudes), [const { Vec::new() }; 3])
}

/// Creates a scene in which every seventh point is quiet.
pub(super) fn scene(seed: u64, count: usize, loud: f64) -> Scene {
    let mut scene = Scene::new(seed, count, loud);
    scene.target.iter_mut().skip(3).step_by(7).for_each(|target| *target = 0.0);
    scene
}

/// Evaluates `check` with the energies of an update.
macro_rules! with_energies {
    ($set:expr, $scene:expr, $candidates:expr, |$s:ident, $energies:ident| $check:expr) => {{
        let (state, energy) = $scene.state($set);
        let points = $scene.points(&state);
        let mut near = vec![0; padded($scene.count)];
        dispatch!($set, s => {
            let mut lane = [0.0; LANES];
            lane[0] = energy;
            let (moments, nearby) = $crate::kernels::greedy::moments::Moments::new::<_, true>(s, points, s.load(&lane), &mut near, &mut [[0.0; 16]; 16]);
            let ($s, $energies) =
                (s, $crate::kernels::greedy::energies::Energies { s, points, moments: &moments, near: &near[..nearby], candidates: $candidates });
            $check
        })
    }};
}
pub(super) use with_energies;

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
                        let mut values = Vec::new();
                        for step in 0..STEPS {
                            let ((sin, cos), mut lanes) = (at(step), [0.0; LANES]);
                            let [re, im] = [cos, sin].map(|part| [(a * part) as f32; LANES]);
                            let z = Sixteen { amplitude: 1.0, phasors: [&re, &im] };
                            s.store(energies.roughly(z), &mut lanes);
                            values.push(wide(lanes[0]));
                        }
                        (values, [energies.rounding(), energies.curvature(a as f32), energies.bow()].map(wide))
                    })
                };
                let (full, [rounding, curvature, bow]) = change(1.0);
                // On an arc of length h the value in the middle is below the mean of the ends by at most c h^2/8, c the
                // bound of the curvature.
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
