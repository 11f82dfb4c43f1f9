//! Scene: an array, a medium, control points and their targets, checked once.

pub(crate) mod air;
pub(crate) mod array;
pub(crate) mod bead;
pub(crate) mod body;
pub(crate) mod choice;
pub(crate) mod directivity;
pub(crate) mod extent;
pub(crate) mod geometry;
pub(crate) mod join;
pub(crate) mod key;
pub(crate) mod medium;
pub(crate) mod mesh;
pub(crate) mod obstacle;
pub(crate) mod order;
pub(crate) mod part;
pub(crate) mod plane;
pub(crate) mod plausibility;
pub(crate) mod pose;
pub mod presets;
pub(crate) mod request;
pub(crate) mod signature;
pub(crate) mod surface;
pub(crate) mod transducer;
pub(crate) mod value;
pub(crate) mod wall;
pub(crate) mod wiring;

pub(crate) use array::UNITS;
pub use array::{Array, Origin};
pub use bead::{Bead, Particle};
pub use choice::Choice;
pub use directivity::{Directivity, Parameter};
pub(crate) use extent::{check_array, check_places};
pub(crate) use geometry::{check_positions, distance, dot};
pub use key::Key;
pub use medium::{Medium, spl};
pub use mesh::Mesh;
pub use obstacle::{Body, Obstacle};
pub(crate) use obstacle::{Obstacles, element_size};
pub use part::{Part, PartKind, PartValue};
pub use plane::{Axis, Plane};
pub(crate) use plausibility::{Vicinity, contrary, distant, figures, short};
pub use pose::Pose;
pub(crate) use request::check_drive;
pub use request::{Aim, Request, Start};
pub use signature::Signature;
pub use surface::Surface;
pub use transducer::Transducer;
pub(crate) use value::words;
pub use value::{OptionValue, Options, Value, spell, word};

use crate::prelude::*;

/// The factor between the allowed distances of a trap and of a focus from the plane of a picture. For a trap the allowed
/// distance is then half a wavelength, which contains the loud shell around the trap.
const SHELL: f64 = 5.0;

/// The optional parts of a scene: all except array, medium, points and request.
///
/// Who makes a scene from another one names each part here, so that the compiler finds the copies that lack a new part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extras {
    /// The signature, which turns the foci into traps; `None` for plain foci.
    pub signature: Option<Signature>,
    /// The bead that traps are made for.
    pub bead: Bead,
    /// Bodies that reflect the waves.
    pub obstacles: Vec<Obstacle>,
    /// The solver that the scene file names.
    pub solver: Option<Choice>,
    /// The plane of the pictures, if the scene file gives one.
    pub plane: Option<Plane>,
}

/// An array, a medium, control points and the request at them. A scene is checked when it is made, and never changes
/// afterwards.
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
    signature: Option<Signature>,
    bead: Bead,
    obstacles: Obstacles,
    /// The solver that the scene file names.
    pub solver: Option<Choice>,
    /// The plane of the pictures, if the scene file gives one.
    pub plane: Option<Plane>,
}

impl Scene {
    /// Returns a scene with control points `points` (M, 3) in m. Without a medium it has the default of the array
    /// ([`Array::medium`]).
    ///
    /// # Errors
    /// No point, a value that is not finite or out of range, lists of unequal lengths, nothing requested, a transducer or point
    /// too far away for phases in f32. A point *on* a transducer is an error only when the scene is solved.
    pub fn new(
        array: Array,
        medium: impl Into<Option<Medium>>,
        points: Vec<[f64; 3]>,
        request: Request,
    ) -> Result<Self> {
        let medium = medium.into().map_or_else(|| array.medium(&[]), Ok)?;
        check_array(&array, medium)?;
        let scene = Self {
            array,
            medium,
            points: Vec::new(),
            request: Request::default(),
            signature: None,
            bead: Bead::default(),
            obstacles: Obstacles::default(),
            solver: None,
            plane: None,
        };
        scene.with_points(points, request)
    }

    /// Returns a copy of this scene with other control points (M, 3) in m and their request. All other parts stay.
    ///
    /// # Errors
    /// The errors of [`Scene::new`] for points and request; a signature of another number of points, a point behind an
    /// obstacle.
    pub fn with_points(self, points: Vec<[f64; 3]>, request: Request) -> Result<Self> {
        request.check(points.len())?;
        check_places(self.array.centre(), self.medium, "points", ".position", &points)?;
        self.signature.as_ref().map_or(Ok(()), |signature| signature.check(self.array.len(), points.len()))?;
        self.obstacles.check_points(&points)?;
        Ok(Self { points, request, ..self })
    }

    /// The optional parts of this scene.
    pub fn extras(&self) -> Extras {
        Extras {
            signature: self.signature.clone(),
            bead: self.bead,
            obstacles: self.obstacles().to_vec(),
            solver: self.solver.clone(),
            plane: self.plane,
        }
    }

    /// Returns a copy of this scene with these optional parts instead of its own.
    ///
    /// # Errors
    /// The errors of [`Scene::with_signature`], [`Scene::with_bead`] and [`Scene::with_obstacles`].
    pub fn with_extras(self, extras: Extras) -> Result<Self> {
        let Extras { signature, bead, obstacles, solver, plane } = extras;
        let scene = self.with_signature(signature)?.with_bead(bead)?.with_obstacles(obstacles)?;
        Ok(Self { solver, plane, ..scene })
    }

    /// Returns a copy of this scene with a signature, which turns foci into traps, or without a signature.
    ///
    /// # Errors
    /// Given factors of a modulus other than 1, or of a number that does not fit the transducers (and points).
    pub fn with_signature(mut self, signature: Option<Signature>) -> Result<Self> {
        signature.as_ref().map_or(Ok(()), |signature| signature.check(self.array.len(), self.points.len()))?;
        self.signature = signature;
        Ok(self)
    }

    /// Returns a copy of this scene with another bead, for which traps are made.
    ///
    /// # Errors
    /// A radius, density or sound speed that is not above 0, a gravity that is not finite.
    pub fn with_bead(mut self, bead: Bead) -> Result<Self> {
        bead.check()?;
        self.bead = bead;
        Ok(self)
    }

    /// Returns a copy of this scene with these obstacles instead of its own: see [`Obstacle`]. They change the waves as
    /// [`crate::Model::with_obstacles`] says.
    ///
    /// # Errors
    /// Numbers that are not finite, a normal of length 0, an obstacle that crosses the array or has a point behind it; walls
    /// that are neither parallel nor at right angles, more than six walls.
    ///
    /// ```
    /// use midair::{Array, Medium, Obstacle, Request, Scene, Surface};
    ///
    /// let array = Array::preset("paper20", [1, 1])?;
    /// let scene = Scene::new(array, Medium::default(), vec![[0.0, 0.0, 0.15]], Request::default())?;
    /// let wall = |z| Obstacle::Wall { point: [0.0, 0.0, z], normal: [0.0, 0.0, -1.0], kind: Surface::Rigid };
    /// assert_eq!(scene.clone().with_obstacles(vec![wall(0.2)])?.obstacles().len(), 1);
    /// assert_eq!(
    ///     scene.with_obstacles(vec![wall(0.1)]).unwrap_err().to_string(),
    ///     "points[0].position is [0.0, 0.0, 0.15]: behind the wall obstacles[0], where no sound is: bring it to the array's side"
    /// );
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn with_obstacles(mut self, obstacles: Vec<Obstacle>) -> Result<Self> {
        self.obstacles = Obstacles::new(obstacles, &self.array, self.medium)?;
        self.obstacles.check_points(&self.points)?;
        Ok(self)
    }

    /// Returns probable mistakes in array, medium, points and plane; each mistake is listed once.
    ///
    /// ```
    /// use midair::{Array, Medium, Request, Scene};
    ///
    /// let array = Array::grid(10, 10, 10.5)?;
    /// let scene = Scene::new(array, Medium::default(), vec![[0.0, 0.0, 0.15]], Request::default())?;
    /// assert_eq!(
    ///     scene.doubts()[0].to_string(),
    ///     "array.grid.pitch is 10.5 m: no neighbours within five wavelengths of 0.0085 m: give m (10.5 mm are 0.0105 m)"
    /// );
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn doubts(&self) -> Vec<Notice> {
        let mut doubts = self.array.doubts(self.medium);
        doubts.extend(self.own_doubts());
        doubts
    }

    /// Returns the probable mistakes in points and plane, without those of [`Array::doubts`].
    pub fn own_doubts(&self) -> Vec<Notice> {
        let mut doubts = Vec::new();
        let place = |j| format!("points[{j}].position");
        doubts.extend(Vicinity::of(&self.array).doubt(self.medium, &self.points, place));
        doubts.extend(distant(&self.array, self.obstacles.list()));
        doubts.extend(contrary(self.medium, &self.points, &self.request));
        doubts.extend(self.plane.and_then(|plane| plane.doubt()));
        doubts.extend(self.bead.doubt(self.medium));
        doubts
    }

    /// Returns a warning if a place in m is so far from the array that its unit is probably wrong; `name` names place k.
    pub fn doubt_places(&self, places: &[[f64; 3]], name: impl Fn(usize) -> String) -> Option<Notice> {
        Vicinity::of(&self.array).far(places, name)
    }

    /// Returns planes that show the points and the obstacles. For foci they are those of [`Plane::around`]. Each trap has two
    /// upright planes. Each body that none of these planes cuts has an upright plane of its own.
    pub fn planes_around(&self) -> Vec<Plane> {
        let (points, wavelength) = (&self.points, self.medium.wavelength());
        let traps = self.signature.is_some() && !points.is_empty();
        let mut planes = if traps { Plane::upright(points, wavelength) } else { Plane::around(points, wavelength) };
        for body in self.obstacles.list().iter().filter_map(Obstacle::bounds) {
            if !planes.iter().any(|plane| plane.cuts(body)) {
                planes.push(Plane::through_body(body, points, wavelength));
            }
        }
        planes
    }

    /// Whether a picture of the plane shows a point or, for traps, the loud shell around one: the middle of a trap is dark.
    pub fn is_shown(&self, plane: &Plane) -> bool {
        let wavelength = self.medium.wavelength() * if self.signature.is_some() { SHELL } else { 1.0 };
        self.points.iter().any(|&point| plane.shows(point, wavelength))
    }
}

getters! {
    Scene:

    /// The bead that traps are made for.
    pub bead(self) -> Bead = self.bead;

    /// The obstacles as given.
    pub obstacles(self) -> &[Obstacle] = self.obstacles.list();

    /// The obstacles with the results of their checks.
    pub(crate) checked_obstacles(self) -> &Obstacles = &self.obstacles;

    /// The signature, which turns the foci into traps; `None` for plain foci.
    pub signature(self) -> Option<&Signature> = self.signature.as_ref();

    /// The array that plays the scene.
    pub array(self) -> &Array = &self.array;

    /// The medium around the array.
    pub medium(self) -> Medium = self.medium;

    /// The control points (M, 3) in m.
    pub points(self) -> &[[f64; 3]] = &self.points;

    /// The request: targets and weights of the points.
    pub request(self) -> &Request = &self.request;

    /// The planes for pictures of this scene: its own plane, or [`Scene::planes_around`] if it has none.
    pub picture_planes(self) -> Vec<Plane> = self.plane.map_or_else(|| self.planes_around(), |plane| [plane].into());
}
