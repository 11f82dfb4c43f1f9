//! Propagation matrix G, row by row: computed from positions on request, or given.

pub(crate) mod bodies;
pub(crate) mod boundary;
pub(crate) mod dense;
pub(crate) mod element;
pub(crate) mod field;
pub(crate) mod gorkov;
pub(crate) mod gradient;
mod inside;
pub(crate) mod jet;
pub(crate) mod kept;
pub(crate) mod local;
pub(crate) mod model;
mod momentum;
pub(crate) mod particle;
pub(crate) mod quantity;
pub(crate) mod reach;
pub(crate) mod reflection;
pub(crate) mod rest;
pub(crate) mod scattering;
pub(crate) mod sources;
pub(crate) mod sphere;
pub(crate) mod stiffness;
pub(crate) mod strips;
pub(crate) mod taylor;

pub use boundary::Boundary;
pub(crate) use field::field_of;
pub use field::{KeptField, field};
pub use model::Model;
pub(crate) use sources::Sources;
pub(crate) use strips::Strips;

use alloc::{format, sync::Arc, vec, vec::Vec};

use num_complex::Complex64;

use crate::device::channels::Channels;
use crate::error::{Error, one_each};
use crate::kernels::propagate::rows;
use crate::kernels::{self, ControlPoints, InstructionSet, Row, padded};
use crate::math;
use crate::propagation::kept::{Kept, Known};
use crate::scene::{Array, Bead, Scene, UNITS};

/// A source of rows of G, one row a transducer: computed from positions on request, or a matrix of the user's
/// own (measured, scattered by obstacles). A solver cannot tell which.
///
/// Rows are planar f32 in units of [`Propagation::reference`], padded with zeros to [`Propagation::lanes`].
#[derive(Clone, Debug)]
pub struct Propagation {
    rows: Rows,
    count: usize,
    set: InstructionSet,
    /// Whether its rows are computed after the sums of |G|.
    rows_follow: bool,
}

#[derive(Clone, Debug)]
enum Rows {
    Computed {
        sources: Arc<Sources>,
        frame: Arc<[Vec<f32>; 3]>,
        points: Arc<[[f64; 3]]>,
    },
    /// The user's numbers, transducer by transducer, and the padded f32 rows made of them.
    Stored {
        matrix: Arc<[Complex64]>,
        planar: Arc<[Vec<f32>; 2]>,
        reference: f64,
        /// The obstacles, signature or channels that they were made from, if there are any.
        kept: Option<Arc<Kept>>,
    },
}

/// Array and points (M, 3) in m that a G was made of, and obstacles and signature where it has any.
type Origin<'a> = (&'a Array, &'a [[f64; 3]], Option<&'a Kept>);

/// Compared by the data that G is made from, not by the kernels that make it.
impl PartialEq for Propagation {
    fn eq(&self, other: &Self) -> bool {
        match (&self.rows, &other.rows) {
            (Rows::Stored { matrix, kept, .. }, Rows::Stored { matrix: others, kept: theirs, .. }) => {
                self.count == other.count && matrix == others && kept == theirs
            }
            (Rows::Computed { sources, points, .. }, Rows::Computed { sources: others, points: elsewhere, .. }) => {
                sources.array == others.array && sources.medium == others.medium && points == elsewhere
            }
            _ => false,
        }
    }
}

impl Propagation {
    /// G of a scene's array at its points, whatever its signature and obstacles.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        Self::at(Arc::new(Sources::new(scene.array(), scene.medium())), scene.points().into(), InstructionSet::best())
    }

    /// G of some sources at points that have been checked.
    pub(crate) fn at(sources: Arc<Sources>, points: Arc<[[f64; 3]]>, set: InstructionSet) -> Self {
        let frame = Arc::new(sources.frame(&points));
        let count = points.len();
        Self { count, rows: Rows::Computed { sources, frame, points }, set, rows_follow: false }
    }

    /// G that is kept, at points that have been checked; what is `known` of it is not made again.
    pub(crate) fn kept(kept: Kept, known: Known<'_>, set: InstructionSet) -> Result<Self, Error> {
        let (count, reference) = (kept.points.len(), kept.sources.reference());
        Ok(Self::stored((kept.make.matrix)(&kept, known)?, count, reference, set, Some(kept.into())))
    }

    /// The same with a column a channel, the sum of its transducers'; a given matrix has such columns already.
    pub(crate) fn driven(self, channels: Option<&Channels>) -> Result<Self, Error> {
        let Some(channels) = channels else { return Ok(self) };
        let mut kept = match &self.rows {
            Rows::Computed { sources, points, .. } => Kept {
                sources: Arc::clone(sources),
                points: Arc::clone(points),
                scattering: None,
                signature: None,
                bead: Bead::default(),
                channels: None,
                make: Kept::BARE,
            },
            Rows::Stored { kept: Some(kept), .. } => Kept::clone(kept),
            Rows::Stored { kept: None, .. } => return Ok(self),
        };
        if kept.channels.is_some() {
            return Ok(self);
        }
        one_each("array.channels", channels.of().len(), "values", self.transducers(), "transducers")?;
        kept.channels = Some(channels.clone());
        Self::kept(kept, (&[], &[]), self.set)
    }

    /// The same by the kernels of another instruction set than the machine's best.
    #[must_use]
    pub fn with_instruction_set(self, set: InstructionSet) -> Self {
        Self { set, ..self }
    }

    /// The instruction set of the kernels.
    #[must_use]
    pub fn instruction_set(&self) -> InstructionSet {
        self.set
    }

    /// A user's own G (M, N) in Pa, point by point, as the matrix reads.
    ///
    /// # Errors
    /// No entries, a length that is no multiple of `points`, an entry that is not finite (named by [j, i]).
    pub fn from_matrix(matrix: &[Complex64], points: usize) -> Result<Self, Error> {
        if matrix.is_empty() || points == 0 || !matrix.len().is_multiple_of(points) {
            let value = format!("{} entries for {points} points", matrix.len());
            return Err(Error::invalid("propagation", value, "give an (M, N) matrix with M and N at least 1"));
        }
        let transducers = matrix.len() / points;
        if let Some(at) = matrix.iter().position(|g| !g.re.is_finite() || !g.im.is_finite()) {
            let item = format!("propagation[{}, {}]", at / transducers, at % transducers);
            return Err(Error::invalid(item, matrix[at], "give finite numbers"));
        }
        // Each number is divided before the sum, because the sum of large finite numbers can overflow.
        let mean = matrix.iter().map(|g| math::hypot(g.re, g.im) / matrix.len() as f64).sum::<f64>();
        if mean > 0.0 && !UNITS.contains(&mean) {
            return Err(Error::invalid("propagation", format!("{mean:e} in the mean"), "give Pa: 1e-15 to 1e15"));
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
        kept: Option<Arc<Kept>>,
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
            rows: Rows::Stored { matrix, planar: Arc::new(planar), reference, kept },
            set,
            rows_follow: false,
        }
    }

    /// The same with some transducers of a given matrix switched off: where the mask (N,) is false, G is 0, and so is then
    /// the drive. An array that G is computed from has a mask of its own.
    ///
    /// # Errors
    /// Another number of entries than transducers, a computed G.
    pub fn with_mask(mut self, mask: &[bool]) -> Result<Self, Error> {
        let Rows::Stored { matrix, planar, kept: None, .. } = &mut self.rows else {
            return Err(Error::invalid("mask", "given", "an array has its own: give it there"));
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

    /// Number of transducers N, or of channels for solvers of an array that has them.
    #[must_use]
    pub fn transducers(&self) -> usize {
        match &self.rows {
            Rows::Computed { sources, .. } => sources.transducers.len(),
            Rows::Stored { matrix, .. } => matrix.len() / self.count,
        }
    }

    /// Number of points M.
    #[must_use]
    pub fn points(&self) -> usize {
        self.count
    }

    /// Length of a row: M padded to 16.
    #[must_use]
    pub fn lanes(&self) -> usize {
        padded(self.count)
    }

    /// Pa of one unit: 1000 P0, or the mean modulus of a user's own G.
    #[must_use]
    pub fn reference(&self) -> f64 {
        match &self.rows {
            Rows::Computed { sources, .. } => sources.reference(),
            Rows::Stored { reference, .. } => *reference,
        }
    }

    /// Its origin, if known.
    pub(crate) fn origin(&self) -> Option<Origin<'_>> {
        match &self.rows {
            Rows::Computed { sources, points, .. } => Some((&sources.array, points, None)),
            Rows::Stored { kept, .. } => kept.as_ref().map(|kept| (&kept.sources.array, &*kept.points, Some(&**kept))),
        }
    }

    /// The points (M, 3) in m, where these are known.
    pub(crate) fn control_points(&self) -> Option<&[[f64; 3]]> {
        self.origin().map(|(_, points, _)| points)
    }

    /// The cure where no transducer has any effect at a point.
    pub(crate) fn cure_of_silence(&self) -> &'static str {
        match self.origin() {
            None => "give its row of the matrix an entry that is neither 0 nor masked, or ask for pressure 0 there",
            Some((array, ..)) if (0..array.len()).all(|i| array.effect(i) == Complex64::ZERO) => {
                "all are off, switch some on in the array's mask and response"
            }
            Some(_) => "move it in front of the array, turn a normal or ask for pressure 0 there",
        }
    }

    /// Writes row `i`: `re` and `im` of length [`Propagation::lanes`], zeros in the padding. Relative error of an
    /// entry against eq. (5) in f64: below 2e-4 up to 1 m at 40 kHz, growing with the distance.
    ///
    /// # Panics
    /// If `i` is no transducer or a slice has another length.
    pub fn row(&self, i: usize, re: &mut [f32], im: &mut [f32]) {
        assert!(re.len() == self.lanes() && im.len() == self.lanes(), "a row is M padded to 16 long");
        match &self.rows {
            Rows::Computed { sources, frame, .. } => {
                kernels::row(
                    self.set,
                    &sources.radiation,
                    (&sources.transducers, i),
                    self.padded_points(frame),
                    &mut Row { re, im },
                );
            }
            Rows::Stored { planar, .. } => {
                let range = i * self.lanes()..(i + 1) * self.lanes();
                re.copy_from_slice(&planar[0][range.clone()]);
                im.copy_from_slice(&planar[1][range]);
            }
        }
    }

    /// The rows as the kernels read them.
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

    /// The inputs of rows, unless the rows are kept.
    pub(crate) fn computed(&self) -> Option<(&Arc<Sources>, ControlPoints<'_>)> {
        match &self.rows {
            Rows::Computed { sources, frame, .. } => Some((sources, self.padded_points(frame))),
            Rows::Stored { .. } => None,
        }
    }

    /// The same transducers at other points, in the same memory if it has no other owner.
    pub(crate) fn carry(&mut self, points: &[[f64; 3]]) -> Result<(), Error> {
        let (sources, frame, old) = match &mut self.rows {
            Rows::Computed { sources, frame, points } => (sources, frame, points),
            Rows::Stored { kept: Some(kept), matrix, .. } => {
                kept.sources.check_points(points)?;
                let moved = Kept { points: points.into(), ..Kept::clone(kept) };
                return Self::kept(moved, (&kept.points, matrix), self.set).map(|moved| *self = moved);
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

    /// Entry (j, i) in double precision, in Pa: eq. (5) itself.
    #[must_use]
    pub fn exact(&self, j: usize, i: usize) -> Complex64 {
        match &self.rows {
            Rows::Computed { sources, points, .. } => sources.exact(i, points[j]),
            Rows::Stored { matrix, .. } => matrix[i * self.count + j],
        }
    }

    /// The same transducers at some of the points.
    pub(crate) fn select(&self, chosen: &[usize]) -> Self {
        match &self.rows {
            Rows::Computed { sources, points, .. } => {
                let points = chosen.iter().map(|&j| points[j]).collect();
                Self { rows_follow: self.rows_follow, ..Self::at(Arc::clone(sources), points, self.set) }
            }
            Rows::Stored { matrix, reference, kept, .. } => {
                let rows = matrix.chunks(self.count);
                let picked = rows.flat_map(|row| chosen.iter().map(move |&j| row[j])).collect();
                let kept = kept.as_ref().map(|kept| kept.select(chosen).into());
                Self::stored(picked, chosen.len(), *reference, self.set, kept)
            }
        }
    }

    /// The same with each point's row multiplied by a factor of its own, kept as a matrix.
    pub(crate) fn stretched(&self, factors: &[f64]) -> Self {
        let entry = |k: usize| self.exact(k % self.count, k / self.count) * factors[k % self.count];
        let entries = (0..self.transducers() * self.count).map(entry).collect();
        Self::stored(entries, self.count, self.reference(), self.set, None)
    }

    fn padded_points<'a>(&self, frame: &'a [Vec<f32>; 3]) -> ControlPoints<'a> {
        ControlPoints { coordinates: [&frame[0], &frame[1], &frame[2]], count: self.count }
    }
}
