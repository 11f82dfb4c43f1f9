//! Propagation: the matrix G, one row for each transducer, computed from positions or given by the user.

pub(crate) mod dense;
pub(crate) mod field;
pub(crate) mod forces;
pub(crate) mod jet;
pub(crate) mod local;
pub(crate) mod model;
pub(crate) mod reach;
pub(crate) mod recipe;
pub(crate) mod scattering;
pub(crate) mod sources;
pub(crate) mod strips;
pub(crate) mod taylor;

pub(crate) use field::field_of;
pub use field::{FieldMatrix, field};
pub use model::Model;
pub use scattering::boundary::Boundary;
pub(crate) use sources::Sources;
pub(crate) use strips::Strips;

use crate::device::channels::Channels;
use crate::kernels::propagate::rows;
use crate::kernels::{self, ControlPoints, InstructionSet, Row, padded};
use crate::prelude::*;
use crate::propagation::recipe::{Known, Recipe};
use crate::scene::{Array, Scene, Signature, UNITS};

/// The matrix G, one row for each transducer. Rows are computed from positions when needed, or come from a matrix of the user's
/// own (measured, or computed elsewhere). Solvers work with both alike.
///
/// Rows are f32, real and imaginary part apart, in units of [`Propagation::reference`]. They are padded with zeros to
/// [`Propagation::lanes`].
#[derive(Clone, Debug)]
pub struct Propagation {
    rows: Rows,
    count: usize,
    set: InstructionSet,
    /// Whether the method computes the rows one by one after [`Propagation::reach`].
    rows_follow: bool,
}

#[derive(Clone, Debug)]
enum Rows {
    Computed {
        sources: Arc<Sources>,
        frame: Arc<[Vec<f32>; 3]>,
        points: Arc<[[f64; 3]]>,
    },
    /// The entries in f64, transducer by transducer, and the padded f32 rows made from them.
    Stored {
        matrix: Arc<[Complex64]>,
        planar: Arc<[Vec<f32>; 2]>,
        reference: f64,
        /// The obstacles, signature or channels that the entries were computed from; `None` for a user's own matrix.
        recipe: Option<Arc<Recipe>>,
    },
}

/// The array and the points (M, 3) in m from which the propagation matrix G was computed, and its obstacles and signature.
type Origin<'a> = (&'a Array, &'a [[f64; 3]], Option<&'a Recipe>);

/// Compares the data that the propagation matrix G is computed from; the instruction set is ignored.
impl PartialEq for Propagation {
    fn eq(&self, other: &Self) -> bool {
        match (&self.rows, &other.rows) {
            (Rows::Stored { matrix, recipe, .. }, Rows::Stored { matrix: others, recipe: theirs, .. }) => {
                self.count == other.count && matrix == others && recipe == theirs
            }
            (Rows::Computed { sources, points, .. }, Rows::Computed { sources: others, points: elsewhere, .. }) => {
                sources.array == others.array && sources.medium == others.medium && points == elsewhere
            }
            _ => false,
        }
    }
}

impl Propagation {
    /// Returns the propagation matrix G of a scene's array at its points, without the scene's signature and obstacles.
    pub fn of(scene: &Scene) -> Self {
        Self::at(Arc::new(Sources::new(scene.array(), scene.medium())), scene.points().into(), InstructionSet::best())
    }

    /// Returns the propagation matrix G of these sources at points that have been checked.
    pub(crate) fn at(sources: Arc<Sources>, points: Arc<[[f64; 3]]>, set: InstructionSet) -> Self {
        let frame = Arc::new(sources.frame(&points));
        let count = points.len();
        Self { count, rows: Rows::Computed { sources, frame, points }, set, rows_follow: false }
    }

    /// Returns a stored propagation matrix G at points that have been checked. Columns that are `known` are not computed again.
    pub(crate) fn from_recipe(recipe: Recipe, known: Known<'_>, set: InstructionSet) -> Result<Self> {
        let (count, reference) = (recipe.points.len(), recipe.sources.reference());
        Ok(Self::stored((recipe.make.matrix)(&recipe, known)?, count, reference, set, Some(recipe.into())))
    }

    /// Returns the propagation matrix G with one column for each channel: the sum of its transducers' columns. A user's own
    /// matrix has such columns already.
    pub(crate) fn driven(self, channels: Option<&Channels>) -> Result<Self> {
        let Some(channels) = channels else { return Ok(self) };
        let mut recipe = match &self.rows {
            Rows::Computed { sources, points, .. } => Recipe {
                sources: Arc::clone(sources),
                points: Arc::clone(points),
                scattering: None,
                signature: None,
                channels: None,
                make: Recipe::BARE,
            },
            Rows::Stored { recipe: Some(recipe), .. } => Recipe::clone(recipe),
            Rows::Stored { recipe: None, .. } => return Ok(self),
        };
        if recipe.channels.is_some() {
            return Ok(self);
        }
        one_each("array.channels", channels.of().len(), "values", self.transducers(), "transducers")?;
        recipe.channels = Some(channels.clone());
        Self::from_recipe(recipe, Known::default(), self.set)
    }

    /// Returns the same propagation matrix G with another instruction set for its kernels.
    #[must_use]
    pub fn with_instruction_set(self, set: InstructionSet) -> Self {
        Self { set, ..self }
    }

    /// Returns a user's own propagation matrix G (M, N) in Pa, given point by point.
    ///
    /// # Errors
    /// No entries, a length that is no multiple of `points`, an entry that is not finite (named by [j, i]).
    pub fn from_matrix(matrix: &[Complex64], points: usize) -> Result<Self> {
        if matrix.is_empty() || points == 0 || !matrix.len().is_multiple_of(points) {
            let value = format!("{} entries for {points} points", matrix.len());
            return Err(Error::invalid("propagation", value, "give an (M, N) matrix with M and N at least 1"));
        }
        let transducers = matrix.len() / points;
        if let Some(at) = matrix.iter().position(|g| !g.re.is_finite() || !g.im.is_finite()) {
            let item = format!("propagation[{}, {}]", at / transducers, at % transducers);
            return Err(Error::not_finite(item, matrix[at]));
        }
        // Each number is divided before the sum, because the sum of large finite numbers can overflow.
        let mean = matrix.iter().map(|g| math::hypot(g.re, g.im) / matrix.len() as f64).sum::<f64>();
        if mean > 0.0 && !UNITS.contains(&mean) {
            return Err(Error::out_of_range("propagation", format!("{mean:e} in the mean"), "give Pa: 1e-15 to 1e15"));
        }
        let transposed = (0..matrix.len()).map(|k| matrix[(k % points) * transducers + k / points]).collect();
        let reference = if mean > 0.0 { mean } else { 1.0 };
        Ok(Self::stored(transposed, points, reference, InstructionSet::best(), None))
    }

    fn stored(
        matrix: Arc<[Complex64]>,
        count: usize,
        reference: f64,
        set: InstructionSet,
        recipe: Option<Arc<Recipe>>,
    ) -> Self {
        let lanes = padded(count);
        let unit = 1.0 / reference;
        let mut planar = [(); 2].map(|()| vec![0.0; matrix.len() / count * lanes]);
        for (i, row) in matrix.chunks(count).enumerate() {
            for (j, g) in row.iter().enumerate() {
                planar[0][i * lanes + j] = (g.re * unit) as f32;
                planar[1][i * lanes + j] = (g.im * unit) as f32;
            }
        }
        Self {
            count,
            rows: Rows::Stored { matrix, planar: Arc::new(planar), reference, recipe },
            set,
            rows_follow: false,
        }
    }

    /// Switches off some transducers of a user's own matrix: where the mask (N,) is false, G is 0, and therefore the drive too.
    /// For a computed propagation matrix G, the array has the mask.
    ///
    /// # Errors
    /// Another number of entries than transducers, a propagation matrix G that is computed from an array.
    pub fn with_mask(mut self, mask: &[bool]) -> Result<Self> {
        let Rows::Stored { matrix, planar, recipe: None, .. } = &mut self.rows else {
            return Err(Error::conflict("mask", "given", "an array has its own: give it there"));
        };
        let transducers = matrix.len() / self.count;
        one_each("mask", mask.len(), "values", transducers, "transducers")?;
        let lanes = padded(self.count);
        for i in (0..transducers).filter(|&i| !mask[i]) {
            Arc::make_mut(matrix)[i * self.count..(i + 1) * self.count].fill(Complex64::ZERO);
            for plane in Arc::make_mut(planar) {
                plane[i * lanes..(i + 1) * lanes].fill(0.0);
            }
        }
        Ok(self)
    }

    /// The number of transducers N. For solvers of an array with channels it is the number of channels.
    pub fn transducers(&self) -> usize {
        match &self.rows {
            Rows::Computed { sources, .. } => sources.transducers.len(),
            Rows::Stored { matrix, .. } => matrix.len() / self.count,
        }
    }

    /// The unit of the rows in Pa: 1000 P0, or the mean modulus of a user's own propagation matrix G.
    pub fn reference(&self) -> f64 {
        match &self.rows {
            Rows::Computed { sources, .. } => sources.reference(),
            Rows::Stored { reference, .. } => *reference,
        }
    }

    /// The array, points and obstacles that the propagation matrix G was computed from; `None` for a user's own matrix.
    pub(crate) fn origin(&self) -> Option<Origin<'_>> {
        match &self.rows {
            Rows::Computed { sources, points, .. } => Some((&sources.array, points, None)),
            Rows::Stored { recipe, .. } => recipe.as_ref().map(|r| (&r.sources.array, &*r.points, Some(&**r))),
        }
    }

    /// The cure in the error for a point that no transducer reaches.
    pub(crate) fn cure_of_silence(&self) -> &'static str {
        match self.origin() {
            None => "give its row of the matrix an entry that is neither 0 nor masked, or ask for pressure 0 there",
            Some((array, ..)) if (0..array.len()).all(|i| array.effect(i) == Complex64::ZERO) => {
                "all are off, switch some on in the array's mask and response"
            }
            Some(_) => "move it in front of the array, turn a normal or ask for pressure 0 there",
        }
    }

    /// Writes row `i` into `re` and `im`, of length [`Propagation::lanes`], with zeros in the padding. The relative error of an
    /// entry, compared with [`Propagation::exact`], is below 2e-4 up to 1 m at 40 kHz and grows with the distance.
    ///
    /// # Panics
    /// If there is no transducer `i` or a slice has another length.
    pub fn row(&self, i: usize, re: &mut [f32], im: &mut [f32]) {
        assert!(re.len() == self.lanes() && im.len() == self.lanes(), "a row is M padded to 16 long");
        match &self.rows {
            Rows::Computed { sources, frame, .. } => {
                let (points, out) = (self.padded_points(frame), &mut Row { re, im });
                kernels::row(self.set, &sources.radiation, &sources.transducers, i, points, out);
            }
            Rows::Stored { planar, .. } => {
                let range = i * self.lanes()..(i + 1) * self.lanes();
                re.copy_from_slice(&planar[0][range.clone()]);
                im.copy_from_slice(&planar[1][range]);
            }
        }
    }

    /// The rows in the form that the kernels read.
    pub(crate) fn rows(&self) -> rows::Rows<'_> {
        match &self.rows {
            Rows::Computed { sources, frame, .. } => rows::Rows::Computed {
                radiation: &sources.radiation,
                sources: &sources.transducers,
                control_points: self.padded_points(frame),
                amplitudes: &[],
            },
            Rows::Stored { planar, .. } => rows::Rows::Stored { re: &planar[0], im: &planar[1] },
        }
    }

    /// The inputs of the kernels that compute rows; `None` if the rows are stored.
    pub(crate) fn computed(&self) -> Option<(&Arc<Sources>, ControlPoints<'_>)> {
        match &self.rows {
            Rows::Computed { sources, frame, .. } => Some((sources, self.padded_points(frame))),
            Rows::Stored { .. } => None,
        }
    }

    /// Replaces the points. The memory is reused unless another propagation matrix G shares it.
    pub(crate) fn carry(&mut self, points: &[[f64; 3]]) -> Result<()> {
        let (sources, frame, old) = match &mut self.rows {
            Rows::Computed { sources, frame, points } => (sources, frame, points),
            Rows::Stored { recipe: Some(recipe), matrix, .. } => {
                recipe.sources.check_points(points)?;
                let moved = Recipe { points: points.into(), ..Recipe::clone(recipe) };
                return Self::from_recipe(moved, Known { points: &recipe.points, entries: matrix }, self.set)
                    .map(|moved| *self = moved);
            }
            Rows::Stored { .. } => return Err(Error::given_points()),
        };
        sources.check_points(points)?;
        match (Arc::get_mut(frame), Arc::get_mut(old)) {
            (Some(frame), Some(old)) if old.len() == points.len() => {
                sources.write_frame(points, frame);
                old.copy_from_slice(points);
            }
            _ => {
                let moved = Self::at(Arc::clone(sources), points.into(), self.set);
                *self = Self { rows_follow: self.rows_follow, ..moved };
            }
        }
        Ok(())
    }

    /// Returns entry (j, i) of the propagation matrix in Pa, computed in double precision.
    pub fn exact(&self, j: usize, i: usize) -> Complex64 {
        match &self.rows {
            Rows::Computed { sources, points, .. } => sources.exact(i, points[j]),
            Rows::Stored { matrix, .. } => matrix[i * self.count + j],
        }
    }

    /// Returns the propagation matrix G at some of the points, by their indices.
    pub(crate) fn select(&self, chosen: &[usize]) -> Self {
        match &self.rows {
            Rows::Computed { sources, points, .. } => {
                let points = chosen.iter().map(|&j| points[j]).collect();
                Self { rows_follow: self.rows_follow, ..Self::at(Arc::clone(sources), points, self.set) }
            }
            Rows::Stored { matrix, reference, recipe, .. } => {
                let rows = matrix.chunks(self.count);
                let picked = rows.flat_map(|row| chosen.iter().map(move |&j| row[j])).collect();
                let recipe = recipe.as_ref().map(|recipe| recipe.select(chosen).into());
                Self::stored(picked, chosen.len(), *reference, self.set, recipe)
            }
        }
    }

    /// Returns the propagation matrix G with the row of each point multiplied by a factor, as a stored matrix.
    pub(crate) fn stretched(&self, factors: &[f64]) -> Self {
        let entry = |k: usize| self.exact(k % self.count, k / self.count) * factors[k % self.count];
        let entries = (0..self.transducers() * self.count).map(entry).collect();
        Self::stored(entries, self.count, self.reference(), self.set, None)
    }

    fn padded_points<'a>(&self, frame: &'a [Vec<f32>; 3]) -> ControlPoints<'a> {
        ControlPoints { coordinates: [&frame[0], &frame[1], &frame[2]], count: self.count }
    }
}

getters! {
    Propagation:

    /// The instruction set that the kernels use.
    pub instruction_set(self) -> InstructionSet = self.set;

    /// The number of points M.
    pub points(self) -> usize = self.count;

    /// The length of a row: M rounded up to a multiple of 16.
    pub lanes(self) -> usize = padded(self.count);

    /// The signature of the points, if they have one.
    pub(crate) signature(self) -> Option<&Signature> = self.origin()?.2?.signature.as_ref();

    /// The points (M, 3) in m; `None` for a user's own matrix.
    #[must_use]
    pub control_points(self) -> Option<&[[f64; 3]]> = self.origin().map(|(_, points, _)| points);
}
