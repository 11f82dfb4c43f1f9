//! Tests of the constants behind all results: the random numbers, and the geometry of the presets compared with their sources.

use std::collections::BTreeMap;

use midair::presets::PRESETS;
use midair::{Array, Origin, Rng};

use crate::scenes::preset;

#[test]
fn random_numbers_are_those_of_splitmix64() {
    // The first values of the generator for this seed, as published in several places.
    let wanted = [
        6_457_827_717_110_365_317,
        3_203_168_211_198_807_973,
        9_817_491_932_198_370_423,
        4_593_380_528_125_082_431,
        16_408_922_859_458_223_821,
    ];
    let mut rng = Rng::new(1_234_567);
    assert_eq!([(); 5].map(|()| rng.next_u64()), wanted);
    let (mut rng, mut raw) = (Rng::new(7), Rng::new(7));
    for _ in 0..1000 {
        let bits = raw.next_u64();
        assert_eq!(rng.uniform().to_bits(), ((bits >> 11) as f64 / 9_007_199_254_740_992.0).to_bits());
    }
}

#[test]
fn every_permutation_is_as_likely_as_any_other() {
    let mut seen: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    for seed in 0..24_000 {
        *seen.entry(Rng::new(seed).permutation(4)).or_default() += 1;
    }
    assert_eq!(seen.len(), 24);
    // Each permutation occurs about 1000 times, with a standard deviation of 31. The bounds are five standard deviations away.
    assert!(seen.values().all(|&count| (845..1155).contains(&count)), "{seen:?}");
}

/// The positions (x, y) of an array in micrometres, sorted.
fn sites(array: &Array) -> Vec<[i64; 2]> {
    let micron = |x: f64| (x * 1e6).round() as i64;
    let mut sites: Vec<_> = array.positions().iter().map(|[x, y, _]| [micron(*x), micron(*y)]).collect();
    sites.sort_unstable();
    sites
}

#[test]
fn an_autd3_is_18_by_14_sites_less_three() {
    let found = sites(&preset("autd3"));
    let mut wanted = Vec::new();
    for (x, y) in (0..18).flat_map(|x| (0..14).map(move |y| (x, y))) {
        if ![(1, 1), (2, 1), (16, 1)].contains(&(x, y)) {
            // Sites 10.16 mm apart, the middle of the lattice at the origin.
            wanted.push([10_160 * x - 86_360, 10_160 * y - 66_040]);
        }
    }
    assert_eq!((found.len(), found), (249, wanted));
}

#[test]
fn autd3_boards_lie_192_by_151_mm_apart() {
    let one = sites(&preset("autd3"));
    let four = Array::preset("autd3", [2, 2]).expect("four boards");
    let mut wanted = Vec::new();
    for (dx, dy) in [(-96_000, -75_700), (96_000, -75_700), (-96_000, 75_700), (96_000, 75_700)] {
        wanted.extend(one.iter().map(|[x, y]| [x + dx, y + dy]));
    }
    wanted.sort_unstable();
    assert_eq!(sites(&four), wanted);
    assert_eq!(four.origin(), &Origin::Preset { name: "autd3", tiles: [2, 2] });
}

#[test]
fn the_papers_arrays_are_centred_grids_in_the_papers_unit() {
    for (name, side) in [("paper20", 20), ("paper36", 36)] {
        let array = preset(name);
        let grid = Array::grid(side, side, 10e-3).expect("a grid");
        assert_eq!(sites(&array), sites(&grid));
        // Transducers are ordered with x fastest, from the corner with the lowest x and y.
        let (first, second) = (array.positions()[0], array.positions()[1]);
        assert!(first[0] < second[0] && first[1].to_bits() == second[1].to_bits());
        assert!(array.in_paper_unit() && !grid.in_paper_unit());
    }
}

#[test]
fn every_preset_makes_the_array_it_describes() {
    for entry in &PRESETS {
        let array = preset(entry.name);
        assert_eq!(array.len(), entry.count, "{}", entry.name);
        assert_eq!(array.transducer(), entry.transducer, "{}", entry.name);
        assert!(!entry.summary.is_empty() && !entry.source.is_empty(), "{} has no source", entry.name);
        // Each preset is of one of three kinds: flat at z = 0 and radiating to +z, around the origin and facing it, or a bowl
        // around an axis.
        let flat = array.positions().iter().all(|p| p[2] == 0.0) && array.normals().iter().all(|n| n[2] == 1.0);
        let faces = |(p, n): (&[f64; 3], &[f64; 3])| p[2] * n[2] < 0.0 && (0..3).all(|axis| p[axis] * n[axis] <= 0.0);
        let around = array.positions().iter().zip(array.normals()).all(faces);
        let towards = |(p, n): (&[f64; 3], &[f64; 3])| n[2] > 0.0 && (0..2).all(|axis| p[axis] * n[axis] <= 0.0);
        let bowl = array.positions().iter().zip(array.normals()).all(towards);
        assert!(flat || around || bowl, "{} radiates elsewhere", entry.name);
        let tiled = Array::preset(entry.name, [2, 3]);
        assert_eq!(tiled.map(|array| array.len()).ok(), entry.tiles.then_some(6 * entry.count), "{}", entry.name);
        assert!(Array::preset(entry.name, [1, 0]).is_err(), "{} of no boards", entry.name);
    }
}
