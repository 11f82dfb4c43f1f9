//! Model: an array in a medium, prepared once for control points that change.

use crate::device::channels::Channels;
use crate::kernels::InstructionSet;
use crate::prelude::*;
use crate::propagation::recipe::{Known, Make, Recipe};
use crate::propagation::scattering::Scattering;
use crate::propagation::scattering::bodies::Bodies;
use crate::propagation::{Boundary, Propagation, Sources};
use crate::scene::{Array, Bead, Medium, Obstacle, Obstacles, Scene, Signature, check_array};

/// An array in a medium, prepared once to compute the propagation matrix G and fields for points that change.
///
/// ```
/// use midair::{Array, InstructionSet, Medium, Model};
///
/// let model = Model::new(&Array::grid(8, 8, 10e-3)?, Medium::default(), InstructionSet::best())?;
/// let propagation = model.propagation(&[[0.0, 0.0, 0.1]])?;
/// assert_eq!((propagation.points(), propagation.transducers()), (1, 64));
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) sources: Arc<Sources>,
    pub(crate) set: InstructionSet,
    pub(crate) scattering: Option<Arc<Scattering>>,
    signature: Option<Signature>,
    bead: Bead,
    /// Whether the method computes the rows of the propagation matrix G one by one, see [`Model::for_rows`].
    rows_follow: bool,
    /// The functions that compute a stored propagation matrix G, with obstacles or a signature; `None` without both.
    make: Option<Make>,
}

impl Model {
    /// Prepares an array in a medium.
    ///
    /// # Errors
    /// The errors of [`Scene::new`]: a medium out of range, a beam too narrow or a transducer too far away for f32 phases.
    pub fn new(array: &Array, medium: Medium, set: InstructionSet) -> Result<Self> {
        check_array(array, medium)?;
        let (sources, bead) = (Arc::new(Sources::new(array, medium)), Bead::default());
        Self { sources, set, scattering: None, signature: None, bead, rows_follow: false, make: None }
            .scattered(&Obstacles::default(), &mut Control::none())
    }

    /// Returns the model of a scene. The scene has been checked already.
    pub fn of(scene: &Scene, set: InstructionSet) -> Self {
        let sources = Arc::new(Sources::new(scene.array(), scene.medium()));
        let bead = scene.bead();
        let bare = Self { sources, set, scattering: None, signature: None, bead, rows_follow: false, make: None };
        bare.with_signature(scene.signature().cloned())
            .scattered(scene.checked_obstacles(), &mut Control::none())
            .unwrap_or_else(|_| unreachable!("it is not stopped"))
    }

    /// Returns the model of a stored propagation matrix G, without its signature.
    pub(crate) fn of_recipe(recipe: &Recipe) -> Self {
        let (sources, scattering) = (Arc::clone(&recipe.sources), recipe.scattering.clone());
        let (set, make) = (InstructionSet::best(), scattering.as_ref().map(|_| Recipe::MAKE));
        Self { sources, set, scattering, signature: None, bead: Bead::default(), rows_follow: false, make }
    }

    /// Returns a copy of this model with these obstacles instead of its own. G and the field are then the direct wave of each
    /// transducer plus the waves that the obstacles reflect or scatter. The walls' part is computed in double precision.
    ///
    /// One wall is exact: image sources with the same directivity and absorption as the transducers. So are two or three walls
    /// at right angles. Between two walls that face each other, up to three reflections are computed. A sphere is computed by
    /// its wave series, with an error of 1e-5 of the largest |p|. A mesh needs the sound on its surface from
    /// [`Model::with_sound`]; without it, G and fields are errors.
    ///
    /// # Errors
    /// The errors of [`Scene::with_obstacles`].
    ///
    /// ```
    /// use midair::{Array, InstructionSet, Medium, Model, Obstacle, Surface};
    ///
    /// let bare = Model::new(&Array::grid(1, 1, 10e-3)?, Medium::default(), InstructionSet::best())?;
    /// let wall = Obstacle::Wall { point: [0.1, 0.0, 0.0], normal: [1.0, 0.0, 0.0], kind: Surface::Rigid };
    /// let model = bare.clone().with_obstacles(&[wall])?;
    /// // On a rigid wall the pressure is twice what it is without.
    /// let [own, alone] = [model, bare].map(|model| model.propagation(&[[0.1, 0.0, 0.2]]).unwrap().exact(0, 0));
    /// assert!((own / alone - 2.0).norm() < 1e-12);
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn with_obstacles(self, obstacles: &[Obstacle]) -> Result<Self> {
        self.with_obstacles_watched(obstacles, &mut Control::none())
    }

    /// Does the same as [`Model::with_obstacles`] on the control's threads, and can be stopped: a sphere as large as a head
    /// takes seconds.
    ///
    /// # Errors
    /// The errors of [`Model::with_obstacles`]; a stop by the caller.
    pub fn with_obstacles_watched(self, obstacles: &[Obstacle], control: &mut Control) -> Result<Self> {
        let checked = Obstacles::new(obstacles.to_vec(), self.array(), self.medium())?;
        self.scattered(&checked, control)
    }

    /// Returns a copy of this model with the obstacles of a boundary. `sound` (E, N) in Pa is the sound on its elements: the
    /// solution u of the equations of [`Boundary::matrix`] and [`Boundary::incident`].
    ///
    /// # Errors
    /// A boundary of another array or medium, another number of values than E times N, a value that is not finite.
    pub fn with_sound(self, boundary: Arc<Boundary>, sound: &[Complex32]) -> Result<Self> {
        if !boundary.fits(self.array(), self.medium()) {
            let cure = "make it of the model's own array and medium";
            return Err(Error::invalid("boundary", "of another array or medium", cure));
        }
        boundary.check_sound(sound)?;
        let scattering = Scattering::new(&self.sources, boundary.obstacles.clone(), &mut Control::none())?;
        let scattering = scattering.with_bodies(Bodies::of_boundary(boundary, sound));
        Ok(Self { scattering: Some(Arc::new(scattering)), make: Some(Recipe::MAKE), ..self })
    }

    fn scattered(mut self, obstacles: &Obstacles, control: &mut Control) -> Result<Self> {
        self.scattering = None;
        self.make = self.signature.as_ref().and(self.make);
        if !obstacles.is_empty() || self.array().reflecting() > 0.0 {
            self.scattering = Some(Arc::new(Scattering::new(&self.sources, obstacles.clone(), control)?));
            self.make = Some(Recipe::MAKE);
        }
        Ok(self)
    }

    /// Returns a copy of this model with a signature. Only solvers use it: the field of a drive is that of the array itself.
    #[must_use]
    pub fn with_signature(self, signature: Option<Signature>) -> Self {
        let is_stored = signature.is_some() || self.scattering.is_some();
        Self { signature, make: is_stored.then_some(Recipe::MAKE), ..self }
    }

    /// Returns a copy of this model that states whether the method computes the rows of the propagation matrix G one
    /// by one. If it does, intermediate values of the sums of |G| are stored and used again. Results do not depend on
    /// it.
    #[doc(hidden)]
    #[must_use]
    pub fn for_rows(self, rows_follow: bool) -> Self {
        Self { rows_follow, ..self }
    }

    /// Returns a copy of this model with another bead, for which traps are made.
    #[must_use]
    pub fn with_bead(self, bead: Bead) -> Self {
        Self { bead, ..self }
    }

    /// Returns the propagation matrix G at `points` (M, 3) in m, multiplied by the factors of the signature if there is one.
    ///
    /// # Errors
    /// No point, a coordinate that is not finite or too far away; a point inside an obstacle; factors that do not fit; with a
    /// signature or obstacles, more than 2^20 entries (fewer if there are many images).
    pub fn propagation(&self, points: &[[f64; 3]]) -> Result<Propagation> {
        self.columns(points, None)
    }

    /// Returns the propagation matrix G as solvers need it: for an array with channels, one column for each channel, the sum of
    /// its transducers' columns.
    ///
    /// # Errors
    /// The errors of [`Model::propagation`], and more than 2^20 entries (N, M) with channels.
    pub(crate) fn driven(&self, points: &[[f64; 3]]) -> Result<Propagation> {
        self.columns(points, self.array().wiring().cloned())
    }

    fn columns(&self, points: &[[f64; 3]], channels: Option<Channels>) -> Result<Propagation> {
        self.sources.check_points(points)?;
        let sources = Arc::clone(&self.sources);
        let Some(make) = self.make.or(channels.as_ref().map(|_| Recipe::BARE)) else {
            return Ok(Propagation {
                rows_follow: self.rows_follow,
                ..Propagation::at(sources, points.into(), self.set)
            });
        };
        let (scattering, signature) = (self.scattering.clone(), self.signature.clone());
        let recipe = Recipe { sources, points: points.into(), scattering, signature, channels, make };
        Propagation::from_recipe(recipe, Known::default(), self.set)
    }

    /// Checks that a point is not inside an obstacle; `name` makes its name for the error.
    pub(crate) fn check_point(&self, point: [f64; 3], name: impl FnOnce() -> String) -> Result<()> {
        self.scattering.as_ref().map_or(Ok(()), |scattering| scattering.obstacles.check_point(point, name))
    }
}

getters! {
    Model:

    /// The obstacles that change the waves; empty without obstacles.
    pub obstacles(self) -> &[Obstacle] = self.scattering.as_ref().map_or(&[], |scattering| scattering.obstacles.list());

    /// The bead that traps are made for.
    pub bead(self) -> Bead = self.bead;

    /// The bytes of a stored propagation matrix G for each point, in f64 and f32; 0 if G is computed when needed.
    pub(crate) bytes_a_point(self) -> usize =
        if self.make.is_some() || self.array().wiring().is_some() { 24 * self.array().len() } else { 0 };

    /// The array whose waves this model computes.
    pub array(self) -> &Array = &self.sources.array;

    /// The signature, which turns foci into traps for solvers; `None` for plain foci.
    pub signature(self) -> Option<&Signature> = self.signature.as_ref();

    /// The medium in which the waves propagate.
    pub medium(self) -> Medium = self.sources.medium;
}
