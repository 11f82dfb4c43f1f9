//! What a person asks for: an array, a medium, points and what each shall feel. Checked once, here.

pub(crate) mod array;
pub(crate) mod medium;
pub mod presets;
pub(crate) mod transducer;

use alloc::format;
use alloc::vec::Vec;

use crate::error::{Error, real};
use crate::scene::array::{Array, bounds, vector};
use crate::scene::medium::Medium;
use crate::solvers::options::Choice;

/// Beyond this many wavelengths from the array's middle f32 can no longer tell one phase from another (2^20
/// wavelengths are 9 km at 40 kHz).
const MOST_WAVELENGTHS: f64 = (1 << 20) as f64;

/// Pressures (M,) in Pa and weights (M,) of M points; each may be left out.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "a pair of lists, checked where it is used")]
pub struct Request {
    /// Peak pressures |p| in Pa; left out all are the balanced level. 0 asks for a quiet point.
    pub pressures: Option<Vec<f64>>,
    /// Weights of the points' terms in eq. (7); left out all are 1. A point of weight 0 takes no part.
    pub weights: Option<Vec<f64>>,
}

impl Request {
    /// Checks both lists against `points` points.
    ///
    /// # Errors
    /// No points; another length; a value that is negative or not finite; nothing asked for (every pressure 0
    /// or every weight 0).
    pub fn check(&self, points: usize) -> Result<(), Error> {
        if points == 0 {
            return Err(Error::invalid("points", "empty", "give at least one point"));
        }
        for (name, values) in [("pressure", &self.pressures), ("weight", &self.weights)] {
            let Some(values) = values else { continue };
            if values.len() != points {
                return Err(Error::invalid(
                    format!("{name}s"),
                    format!("{} values", values.len()),
                    format!("give one for each of the {points} points"),
                ));
            }
            // Named only when refused: this runs for every frame of a moving hand.
            let refused = |value: &f64| !(value.is_finite() && *value >= 0.0);
            if let Some(j) = values.iter().position(refused) {
                let value = values[j];
                real(&format!("points[{j}].{name}"), value, 0.0, false)?;
            }
        }
        if self.weights.as_ref().is_some_and(|weights| weights.iter().all(|&w| w == 0.0)) {
            return Err(Error::invalid("weights", "all 0", "give at least one point a weight above 0"));
        }
        let asked = |j: usize| self.pressure(j) > 0.0 && self.weight(j) > 0.0;
        if !(0..points).any(asked) {
            return Err(Error::invalid(
                "pressures",
                "all 0",
                "give at least one point (of weight above 0) a pressure above 0 Pa",
            ));
        }
        Ok(())
    }

    /// Pressure of point j, 1 where pressures are left out.
    pub(crate) fn pressure(&self, j: usize) -> f64 {
        self.pressures.as_ref().map_or(1.0, |pressures| pressures[j])
    }

    /// Weight of point j.
    pub(crate) fn weight(&self, j: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |weights| weights[j])
    }
}

/// A square of pixels at height z, for pictures of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Height in m.
    pub z: f64,
    /// Side in m.
    pub size: f64,
    /// Pixels along each side, ends included.
    pub pixels: usize,
    /// Middle (x, y) in m.
    pub center: [f64; 2],
}

impl Plane {
    /// A plane of `pixels` x `pixels` samples at center + linspace(-size/2, size/2, pixels).
    ///
    /// # Errors
    /// A coordinate that is not finite, a size that is not above 0, fewer than 2 or more than 8192 pixels.
    pub fn new(z: f64, size: f64, pixels: usize, center: [f64; 2]) -> Result<Self, Error> {
        vector("plane z and center", &[z, center[0], center[1]])?;
        real("plane.size", size, 0.0, true)?;
        if !(2..=8192).contains(&pixels) {
            return Err(Error::invalid("plane.pixels", pixels, "give 2 to 8192"));
        }
        Ok(Self { z, size, pixels, center })
    }

    /// The plane around `points`: z is theirs if equal within 1 um, else their mean; the centre the middle of
    /// their bounding box; the side 1.25 times its larger one, at least 0.04 m.
    #[must_use]
    pub fn around(points: &[[f64; 3]]) -> Self {
        let [x, y, z] = bounds(points);
        let middle = |[low, high]: [f64; 2]| 0.5 * low + 0.5 * high;
        let mean = points.iter().map(|point| point[2] / points.len() as f64).sum();
        let size = (1.25 * (x[1] - x[0]).max(y[1] - y[0])).max(0.04);
        let z = if z[1] - z[0] <= 1e-6 { points.first().map_or(0.0, |point| point[2]) } else { mean };
        Self { z, size, pixels: 200, center: [middle(x), middle(y)] }
    }

    /// The samples along x (axis 0) or y (axis 1), in m.
    #[must_use]
    pub fn axis(&self, axis: usize) -> Vec<f64> {
        let step = self.size / (self.pixels as f64 - 1.0);
        (0..self.pixels).map(|i| self.center[axis] - self.size / 2.0 + i as f64 * step).collect()
    }

    /// The samples row by row, x fastest: pixel (y, x) is at index y * pixels + x.
    #[must_use]
    pub fn points(&self) -> Vec<[f64; 3]> {
        let xs = self.axis(0);
        self.axis(1).iter().flat_map(|&y| xs.iter().map(move |&x| [x, y, self.z])).collect()
    }
}

/// Refuses a medium, and an array that cannot be computed with in it.
pub(crate) fn check_array(array: &Array, medium: Medium) -> Result<(), Error> {
    medium.check()?;
    array.transducer().directivity.check_beam(medium.wavenumber())?;
    check_places(array.centre(), medium, "array.positions", "", array.positions())
}

/// Refuses places that are not finite or too far away from the array's middle for phases in f32.
pub(crate) fn check_places(
    centre: [f64; 3],
    medium: Medium,
    item: &str,
    part: &str,
    places: &[[f64; 3]],
) -> Result<(), Error> {
    let reach = MOST_WAVELENGTHS * medium.wavelength();
    for (k, place) in places.iter().enumerate() {
        let far = (0..3).any(|axis| (place[axis] - centre[axis]).abs() > reach);
        if far || !place.iter().all(|x| x.is_finite()) {
            let item = format!("{item}[{k}]{part}");
            vector(&item, place)?;
            let cure =
                format!("bring it within {reach:.3e} m of the array's middle (coordinates are in metres)");
            return Err(Error::invalid(item, format!("{place:?}"), cure));
        }
    }
    Ok(())
}

/// A request: checked when made, and unchanged from then on.
///
/// ```
/// use midair::{Array, Medium, Request, Scene};
///
/// let array = Array::preset("paper20", [1, 1])?;
/// let scene = Scene::new(array, Medium::default(), vec![[0.0, 0.0, 0.15]], Request::default())?;
/// let nowhere = Scene::new(scene.array().clone(), Medium::default(), vec![[0.0, f64::NAN, 0.15]], Request::default());
/// assert_eq!(nowhere.unwrap_err().to_string(), "points[0].position is [0.0, NaN, 0.15]: give three finite numbers");
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    array: Array,
    medium: Medium,
    points: Vec<[f64; 3]>,
    request: Request,
    /// The solver a scene file names.
    pub solver: Option<Choice>,
    /// The plane a scene file asks pictures of.
    pub plane: Option<Plane>,
}

impl Scene {
    /// A scene of M `points` (M, 3) in m.
    ///
    /// # Errors
    /// No point, a value that is not finite or out of range, lists of unequal lengths, nothing asked for, a
    /// transducer or point too far away for f32 phases. A point *on* a transducer is found when solving.
    pub fn new(array: Array, medium: Medium, points: Vec<[f64; 3]>, request: Request) -> Result<Self, Error> {
        check_array(&array, medium)?;
        request.check(points.len())?;
        let scene = Self { array, medium, points, request, solver: None, plane: None };
        scene.check_places("points", ".position", &scene.points)?;
        Ok(scene)
    }

    /// Refuses places that are not finite or too far away for phases in f32.
    pub(crate) fn check_places(&self, item: &str, part: &str, places: &[[f64; 3]]) -> Result<(), Error> {
        check_places(self.array.centre(), self.medium, item, part, places)
    }

    /// The array.
    #[must_use]
    pub fn array(&self) -> &Array {
        &self.array
    }

    /// The medium.
    #[must_use]
    pub fn medium(&self) -> Medium {
        self.medium
    }

    /// The control points (M, 3) in m.
    #[must_use]
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// What is asked for at the points.
    #[must_use]
    pub fn request(&self) -> &Request {
        &self.request
    }

    /// The plane for pictures: the scene's own, else [`Plane::around`] its points.
    #[must_use]
    pub fn picture_plane(&self) -> Plane {
        self.plane.unwrap_or_else(|| Plane::around(&self.points))
    }
}
