//! Extent: rejects coordinates that are too far away for phases in f32.

use alloc::format;

use crate::error::Error;
use crate::scene::array::Array;
use crate::scene::geometry::vector;
use crate::scene::medium::Medium;

/// Wavelengths from the array's middle, 279 m at 40 kHz: there phases in f32 are wrong by 0.004 rad in the mean and by
/// 0.02 at most, moduli by 6e-5, and a focus loses 1.4e-5 of its pressure. All grow with the distance, the last with its
/// square.
const MOST_WAVELENGTHS: f64 = (1 << 15) as f64;

/// Refuses a medium, and an array that cannot be computed with in it.
pub(crate) fn check_array(array: &Array, medium: Medium) -> Result<(), Error> {
    medium.check()?;
    array.transducer().directivity.check_beam(medium.wavenumber())?;
    let check = |places: &[[f64; 3]]| check_places(array.centre(), medium, "array.positions", "", places);
    // No point of a box is farther from its middle than two of its corners: all points are checked to name one.
    let corners = [0, 1].map(|end| array.bounds().map(|bound| bound[end]));
    check(&corners).or_else(|_| check(array.positions()))
}

/// The farthest in m from the array's middle along an axis.
pub(crate) fn reach(medium: Medium) -> f64 {
    MOST_WAVELENGTHS * medium.wavelength()
}

/// Refuses places that are not finite or too far away from the array's middle for phases in f32.
pub(crate) fn check_places(
    centre: [f64; 3],
    medium: Medium,
    item: &str,
    part: &str,
    places: &[[f64; 3]],
) -> Result<(), Error> {
    let reach = reach(medium);
    for (k, place) in places.iter().enumerate() {
        let far = (0..3).any(|axis| (place[axis] - centre[axis]).abs() > reach);
        if far || !place.iter().all(|x| x.is_finite()) {
            let item = format!("{item}[{k}]{part}");
            vector(&item, place)?;
            let frequency = medium.frequency;
            let cure = format!(
                "bring it within {reach:.3e} m of the array's middle, 2^15 wavelengths at {frequency} Hz (coordinates are in metres)"
            );
            return Err(Error::invalid(item, format!("{place:?}"), cure));
        }
    }
    Ok(())
}
