//! Geometry: lattices of positions, bounding boxes, distances, and checks of coordinates.

use crate::prelude::*;

/// Returns `nx` x `ny` positions `pitch` metres apart, centred on the origin; x varies fastest.
pub(crate) fn lattice([nx, ny]: [usize; 2], pitch: f64) -> Vec<[f64; 3]> {
    let centred = |i: usize, n: usize| (i as f64 - (n as f64 - 1.0) / 2.0) * pitch;
    (0..nx * ny).map(|i| [centred(i % nx, nx), centred(i / nx, ny), 0.0]).collect()
}

/// The lowest and highest coordinate along each axis; [0, 0] if there are no points.
pub(crate) fn bounds(points: &[[f64; 3]]) -> [[f64; 2]; 3] {
    let Some(first) = points.first() else { return [[0.0; 2]; 3] };
    points.iter().fold(first.map(|x| [x, x]), |mut bounds, point| {
        for (bound, &x) in bounds.iter_mut().zip(point) {
            *bound = [bound[0].min(x), bound[1].max(x)];
        }
        bounds
    })
}

/// The mean of places; the origin if there are none.
pub(crate) fn middle(places: &[[f64; 3]]) -> [f64; 3] {
    *(places.iter().fold(Vec3::default(), |sum, &place| sum + place) / places.len().max(1) as f64)
}

/// The dot product a . b.
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    Vec3(a).dot(b)
}

/// The distance between two places.
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    Vec3(a).distance(b)
}

/// Checks that there is one position for each transducer, and that all are finite.
pub(crate) fn check_positions(positions: &[[f64; 3]], transducers: usize) -> Result<()> {
    one_each("positions", positions.len(), "of them", transducers, "transducers")?;
    check_finite("positions", positions)
}

/// Checks that all coordinates are finite. The error names the first vector that is not, as `item[i]`.
pub(crate) fn check_finite(item: &str, vectors: &[[f64; 3]]) -> Result<()> {
    match vectors.iter().position(|vector| !vector.iter().all(|x| x.is_finite())) {
        Some(i) => vector(&format!("{item}[{i}]"), &vectors[i]),
        None => Ok(()),
    }
}

/// Checks that the three coordinates of a vector are finite.
pub(crate) fn vector(item: &str, vector: &[f64; 3]) -> Result<()> {
    if vector.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err(Error::new(ErrorCode::NotFinite, item, format!("{vector:?}"), "give three finite numbers"))
}
