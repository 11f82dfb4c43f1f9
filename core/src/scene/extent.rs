//! Extent: rejects coordinates that are so far from the array that phases in f32 become inaccurate.

use crate::prelude::*;
use crate::scene::geometry::vector;
use crate::scene::{Array, Medium};

/// The largest distance from the array's middle in wavelengths, 279 m at 40 kHz. At this distance, phases in f32 are wrong by
/// 0.004 rad on average and by at most 0.02 rad, and moduli by 6e-5. A focus loses 1.4e-5 of its pressure. The errors grow with
/// the distance, the loss of pressure with its square.
const MOST_WAVELENGTHS: f64 = (1 << 15) as f64;

/// Checks a medium, and whether an array can be computed in it.
pub(crate) fn check_array(array: &Array, medium: Medium) -> Result<()> {
    medium.check()?;
    array.transducer().directivity.check_beam(medium.wavenumber())?;
    let check = |places: &[[f64; 3]]| check_places(array.centre(), medium, "array.positions", "", places);
    // No point of a box is farther from its middle than the corners. All positions are checked only if a corner is
    // too far away, so that the error can name one of them.
    let corners = [0, 1].map(|end| array.bounds().map(|bound| bound[end]));
    check(&corners).or_else(|_| check(array.positions()))
}

/// The largest distance in m from the array's middle, along each axis.
pub(crate) fn reach(medium: Medium) -> f64 {
    MOST_WAVELENGTHS * medium.wavelength()
}

/// Checks that places are finite and within [`reach`] of the array's middle. Errors name the place as `item[k]part`.
pub(crate) fn check_places(
    centre: [f64; 3],
    medium: Medium,
    item: &str,
    part: &str,
    places: &[[f64; 3]],
) -> Result<()> {
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
            return Err(Error::new(ErrorCode::TooFar, item, format!("{place:?}"), cure));
        }
    }
    Ok(())
}
