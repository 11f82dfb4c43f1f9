//! Sums of |G| compared with f64; the sums of an interleaved batch have the same bits as those of its problems alone.

use alloc::vec;
use alloc::vec::Vec;

use crate::control::Control;
use crate::kernels::lanes::{LANES, Line};
use crate::kernels::propagate::moduli::{Run, add_moduli, interleaved_moduli};
use crate::kernels::propagate::row::ControlPoints;
use crate::kernels::propagate::rows::Rows;
use crate::kernels::propagate::source::SourceList;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};
use crate::kernels::tests::{LENGTHS, Shot, wide};
use crate::rng::Rng;
use crate::scene::Directivity;

/// Returns several transducers, each with the points of the last one.
fn volley(pattern: &str, transducers: usize, points: usize) -> Vec<Shot> {
    let mut rng = Rng::new((100 * transducers + points) as u64);
    let directivity = Directivity::named(pattern, None).expect("a known name");
    let first = Shot::new(&mut rng, directivity, -0.002, points);
    let mut shots = vec![];
    for _ in 1..transducers {
        let coordinates = first.coordinates.clone();
        shots.push(Shot { coordinates, ..Shot::new(&mut rng, directivity, -0.002, points) });
    }
    shots.push(first);
    shots
}

fn sums(set: InstructionSet, shots: &[Shot], sources: &SourceList) -> Vec<f64> {
    let mut sums = vec![0.0; shots[0].count];
    for run in Run::all(&shots[0].radiation, sources) {
        let near = add_moduli(set, &run, shots[0].control_points(), 1e-4, &mut sums, &mut Control::none());
        assert!(!near.expect("no stop"), "{set}: no point is that near");
    }
    sums
}

fn list(shots: &[Shot]) -> SourceList {
    SourceList::new(&shots.iter().map(|shot| shot.source).collect::<Vec<_>>())
}

#[test]
fn moduli_of_any_number_of_transducers_add_up() {
    for set in InstructionSet::all() {
        for transducers in LENGTHS.chain([512, 513, 1100]) {
            let shots = volley("piston", transducers, 5);
            for (j, sum) in sums(set, &shots, &list(&shots)).into_iter().enumerate() {
                let moduli = || shots.iter().map(|shot| (wide(shot.source.amplitude), shot.spread(j)));
                let want: f64 = moduli().map(|(gain, (_, amplitude))| gain * amplitude.abs()).sum();
                let most: f64 = moduli().map(|(gain, (r, _))| gain / r).sum();
                // The error of each term is at most 4e-6 of the modulus on the transducer's axis. A sum in f32 has at
                // most 36 terms.
                assert!((sum - want).abs() <= 7e-6 * most, "{set}: N = {transducers}, point {j}: {sum} for {want}");
            }
        }
    }
}

#[test]
fn an_interleaved_batch_has_the_bits_of_its_problems() {
    for set in InstructionSet::all() {
        for (pattern, transducers) in [("point", 1), ("t4010a1", 40), ("cos", 700)] {
            let problems: Vec<_> = (0..LANES).map(|k| volley(pattern, transducers, 3 + k % 2)).collect();
            let (shots, sources) = (&problems[0], list(&problems[0]));
            // A problem with fewer points than another repeats its last point.
            let mut coordinates = [(); 3].map(|()| vec![0.0; 4 * LANES]);
            for (list, axis) in coordinates.iter_mut().zip(0..) {
                for (k, x) in list.iter_mut().enumerate() {
                    let single = &problems[k % LANES][0];
                    *x = single.coordinates[axis][(k / LANES).min(single.count - 1)];
                }
            }
            let [x, y, z] = &coordinates;
            let points = ControlPoints { coordinates: [x, y, z], count: x.len() };
            let mut total = vec![0.0; x.len()];
            for run in Run::all(&shots[0].radiation, &sources) {
                let mut sums = vec![f32::NAN; x.len()];
                assert!(
                    !interleaved_moduli(set, &run, points, 1e-4, &mut sums, &mut []),
                    "{set}: no point is that near"
                );
                assert!(
                    interleaved_moduli(set, &run, points, 1e9, &mut sums, &mut []),
                    "{set}: all points are that near"
                );
                total.iter_mut().zip(sums).for_each(|(total, sum)| *total += wide(sum));
            }
            for (lane, problem) in problems.iter().enumerate() {
                let alone = sums(set, problem, &sources);
                let together: Vec<f64> = (0..alone.len()).map(|j| total[j * LANES + lane]).collect();
                assert_eq!(alone, together, "{set}: {pattern}, problem {lane}");
            }
        }
    }
}

#[test]
fn kept_amplitudes_change_no_bit_of_sums_or_rows() {
    for set in InstructionSet::all() {
        for (pattern, transducers, count) in [("t4010a1", 40, 16), ("cos", 700, 29), ("piston", 17, 64)] {
            let shots = volley(pattern, transducers, count);
            let (sources, points) = (list(&shots), shots[0].control_points());
            let lanes = points.coordinates[0].len();
            let (mut total, mut sums) = (vec![0.0; count], vec![f32::NAN; lanes]);
            let mut lines = vec![Line([f32::NAN; LANES]); transducers * lanes / LANES];
            for run in Run::all(&shots[0].radiation, &sources) {
                let part = &mut lines[run.members.start * lanes / LANES..run.members.end * lanes / LANES];
                assert!(!interleaved_moduli(set, &run, points, 1e-4, &mut sums, part), "{set}: no point is that near");
                total.iter_mut().zip(&sums).for_each(|(total, &sum)| *total += wide(sum));
            }
            assert_eq!(total, self::sums(set, &shots, &sources), "{set}: {pattern}");
            let radiation = &shots[0].radiation;
            let of = |amplitudes| Rows::Computed { radiation, sources: &sources, control_points: points, amplitudes };
            let row = |rows: Rows<'_>, i: usize| {
                let mut row = [(); 2].map(|()| vec![f32::NAN; lanes]);
                let [re, im] = &mut row;
                dispatch!(set, s => rows.write(s, i, re, im));
                row
            };
            for i in 0..transducers {
                assert_eq!(row(of(&lines), i), row(of(&[]), i), "{set}: {pattern}, row {i}");
            }
        }
    }
}
