//! Neighbours: finds a pair of places nearer than a given distance, by sorting along one direction.

use crate::prelude::*;
use crate::scene::geometry::distance;

/// The direction along which places are sorted. No side or diagonal of a lattice is normal to it, so neighbours in a lattice
/// have different positions along it.
const ACROSS: [f64; 3] = [0.6180, 0.5310, 0.5797];

/// The search stops after this many pairs per place on average; a lattice of a million places needs 30.
const MOST_PAIRS: usize = 256;

/// Places, and their order along [`ACROSS`].
pub(crate) struct Neighbours<'a> {
    places: &'a [[f64; 3]],
    sorted: Vec<(f64, usize)>,
}

impl<'a> Neighbours<'a> {
    /// Sorts the places, in time O(N log N).
    pub(crate) fn of(places: &'a [[f64; 3]]) -> Self {
        let along = |place: &[f64; 3]| (0..3).map(|axis| place[axis] * ACROSS[axis]).sum::<f64>();
        let mut sorted: Vec<(f64, usize)> = places.iter().enumerate().map(|(k, place)| (along(place), k)).collect();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        Self { places, sorted }
    }

    /// Returns the first pair nearer than `within` for which `wanted(pair, distance)` is true, and its distance.
    pub(crate) fn pair(&self, within: f64, fits: impl Fn([usize; 2], f64) -> bool) -> Option<([usize; 2], f64)> {
        let Self { places, sorted } = self;
        let pairs = sorted.iter().enumerate().flat_map(|(at, &(from, k))| {
            let ahead = sorted[at + 1..].iter().take_while(move |(to, _)| to - from < within);
            ahead.map(move |&(_, l)| [k.min(l), k.max(l)])
        });
        let measured = pairs.take(MOST_PAIRS * places.len()).map(|[k, l]| ([k, l], distance(places[k], places[l])));
        measured.into_iter().find(|&(pair, apart)| apart < within && fits(pair, apart))
    }
}
