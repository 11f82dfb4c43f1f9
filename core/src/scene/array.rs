//! Array: positions, normals, transducer, response, mask, channels and quantization; and how it was made.

use crate::device::channels::Channels;
use crate::device::quantization::Quantization;
use crate::prelude::*;
use crate::scene::geometry::{bounds, check_finite, lattice};
use crate::scene::{Medium, Pose, Transducer, presets};

/// The most transducers that an array may have: far above any array that was built, low enough to catch a typing error.
const MOST_TRANSDUCERS: usize = 1 << 20;

/// The allowed source pressures in Pa m: outside of them, values derived from the pressure could overflow or underflow f32.
pub(crate) const UNITS: core::ops::RangeInclusive<f64> = 1e-15..=1e15;

/// An array of N transducers. Clones share their memory.
///
/// ```text
///        z   theta = angle to the normal
///        |  .* point
///        | /
///  --o-o-o-o-o--> x        flat arrays lie in z = 0 and radiate to +z
/// ```
///
/// ```
/// let array = midair::Array::grid(20, 20, 10e-3)?;
/// assert_eq!(array.len(), 400);
/// assert_eq!(array.positions()[0], [-0.095, -0.095, 0.0]);
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Array {
    positions: Arc<[[f64; 3]]>,
    normals: Arc<[[f64; 3]]>,
    /// Lowest and highest coordinate along each axis.
    bounds: [[f64; 2]; 3],
    transducer: Transducer,
    response: Option<Arc<[Complex64]>>,
    mask: Option<Arc<[bool]>>,
    pub(super) channels: Option<Channels>,
    pins: Option<Arc<[usize]>>,
    quantization: Option<Arc<Quantization>>,
    /// The frequency in Hz of an array that is real hardware: its default medium is then real air. Comparisons of
    /// arrays ignore it.
    hardware: Option<f64>,
    /// The part of |p| that each of two boards face to face reflects; 0 for none.
    pub(super) reflecting: f64,
    origin: Origin,
}

impl Array {
    /// Returns an array of transducers at `positions` (N, 3) in m. They face along `normals` (N, 3), which are normalised;
    /// without normals all face +z.
    ///
    /// # Errors
    /// No position, more than 2^20, a coordinate that is not finite, another number of normals, a zero normal.
    pub fn new(positions: Vec<[f64; 3]>, normals: Option<Vec<[f64; 3]>>) -> Result<Self> {
        refuse_if!(positions.is_empty(), Error::missing("array.positions", "empty", "give at least one transducer"));
        count("array.positions", positions.len())?;
        check_finite("array.positions", &positions)?;
        let mut normals = normals.unwrap_or_else(|| vec![[0.0, 0.0, 1.0]; positions.len()]);
        one_each("array.normals", normals.len(), "normals", positions.len(), "positions")?;
        check_finite("array.normals", &normals)?;
        for (i, normal) in normals.iter_mut().enumerate() {
            // The normal is divided by its largest component first, so that the squares of its components neither overflow nor
            // underflow.
            let largest = normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            if largest == 0.0 {
                let cure = "give the direction the transducer looks";
                return Err(Error::invalid(format!("array.normals[{i}]"), format!("{normal:?}"), cure));
            }
            let scaled = normal.map(|x| x / largest);
            let length = math::sqrt(scaled.iter().map(|x| x * x).sum());
            // A normal of length 1 within rounding is not normalised again: otherwise each saving and loading would change it.
            if (largest * length - 1.0).abs() > 1e-15 {
                *normal = scaled.map(|x| x / length);
            }
        }
        Ok(Self {
            bounds: bounds(&positions),
            positions: positions.into(),
            normals: normals.into(),
            transducer: Transducer::default(),
            response: None,
            mask: None,
            channels: None,
            pins: None,
            quantization: None,
            hardware: None,
            reflecting: 0.0,
            origin: Origin::Positions,
        })
    }

    /// Returns a flat grid of `nx` x `ny` transducers `pitch` metres apart, centred on the origin; x varies fastest.
    ///
    /// # Errors
    /// A count of 0, more than 2^20 transducers, a pitch that is not above 0.
    pub fn grid(nx: usize, ny: usize, pitch: f64) -> Result<Self> {
        for (item, value) in [("array.grid.nx", nx), ("array.grid.ny", ny)] {
            refuse_if!(value == 0, Error::out_of_range(item, value, "give at least 1 transducer"));
        }
        count("array.grid nx * ny", nx.saturating_mul(ny))?;
        real("array.grid.pitch", pitch, 0.0, true)?;
        Ok(Self { origin: Origin::Grid { nx, ny, pitch }, ..Self::new(lattice([nx, ny], pitch), None)? })
    }

    /// Returns the array of a real board or of Suzuki et al. 2021; see [`crate::scene::presets`].
    ///
    /// # Errors
    /// An unknown name, 0 tiles, tiles for a preset that cannot be tiled.
    pub fn preset(name: &str, tiles: [usize; 2]) -> Result<Self> {
        let preset = presets::find(name)?;
        for (axis, &value) in tiles.iter().enumerate() {
            if value == 0 || (value != 1 && !preset.tiles) {
                let cure =
                    if preset.tiles { "give at least 1 board" } else { "this preset is one piece: leave tiles out" };
                return Err(Error::out_of_range(format!("array.tiles[{axis}]"), value, cure));
            }
        }
        count("array.tiles", tiles[0].saturating_mul(tiles[1]).saturating_mul(preset.count))?;
        let origin = Origin::Preset { name: preset.name, tiles };
        let positions = (preset.positions)(tiles);
        let normals = preset.normal.map(|normal| positions.iter().map(|&place| normal(place)).collect());
        let array = Self::new(positions, normals)?;
        let response = preset.response(array.len())?;
        let array = Self { origin, transducer: preset.transducer, hardware: preset.frequency()?, ..array };
        let channels = (0..array.len()).map(|i| i / preset.together).collect();
        array.with_quantization(preset.quantization()?).with_response(response)?.with_channels(Some(channels))
    }

    /// Returns a copy of this array with another source pressure and directivity.
    ///
    /// # Errors
    /// A source pressure or directivity parameter out of range.
    pub fn with_transducer(mut self, transducer: Transducer) -> Result<Self> {
        let pressure = real("array.source_pressure", transducer.source_pressure, 0.0, true)?;
        if !UNITS.contains(&pressure) {
            let cure = "give Pa m: 1e-15 to 1e15";
            return Err(Error::out_of_range("array.source_pressure", format!("{pressure:?}"), cure));
        }
        transducer.directivity.checked()?;
        self.transducer = transducer;
        Ok(self)
    }

    /// Returns a copy of this array with a complex response c_i (N,) of each transducer: its gain and phase offset. A
    /// transducer of response 0 is dead and gets drive 0. `None` stands for 1 everywhere.
    ///
    /// # Errors
    /// Another number of responses than transducers, a value that is not finite.
    pub fn with_response(mut self, response: Option<Vec<Complex64>>) -> Result<Self> {
        if let Some(response) = &response {
            one_each("array.response", response.len(), "values", self.len(), "transducers")?;
            if let Some((i, c)) = response.iter().enumerate().find(|(_, c)| !c.re.is_finite() || !c.im.is_finite()) {
                return Err(Error::not_finite(format!("array.response[{i}]"), c));
            }
            if let Some((i, c)) = response.iter().enumerate().find(|(_, c)| c.norm_sqr() > 1e6 * 1e6) {
                let cure = "a response is relative to source_pressure: give at most 1e6 in modulus";
                return Err(Error::invalid(format!("array.response[{i}]"), c, cure));
            }
        }
        self.response = response.map(Into::into);
        Ok(self)
    }

    /// Returns a copy of this array with a mask (N,): a transducer whose entry is false is off and gets drive 0. `None` leaves
    /// all on.
    ///
    /// # Errors
    /// Another number of entries than transducers.
    pub fn with_mask(mut self, mask: Option<Vec<bool>>) -> Result<Self> {
        if let Some(mask) = &mask {
            one_each("array.mask", mask.len(), "values", self.len(), "transducers")?;
        }
        self.mask = mask.map(Into::into);
        Ok(self)
    }

    /// Returns a copy of this array whose transducers are on these channels (N,) of its boards; the channels of a second board
    /// follow those of the first. `None` leaves this to the order of the transducers.
    ///
    /// # Errors
    /// Another number of entries than transducers, a channel given twice.
    pub fn with_pins(mut self, pins: Option<Vec<usize>>) -> Result<Self> {
        if let Some(pins) = &pins {
            one_each("array.pins", pins.len(), "values", self.len(), "transducers")?;
            let mut owners: Vec<usize> = (0..pins.len()).collect();
            owners.sort_by_key(|&i| (pins[i], i));
            if let Some(pair) = owners.windows(2).find(|pair| pins[pair[0]] == pins[pair[1]]) {
                let (one, other) = (pair[0], pair[1]);
                let cure = format!("array.pins[{one}] is the same: give each once");
                return Err(Error::invalid(format!("array.pins[{other}]"), pins[other], cure));
            }
        }
        self.pins = pins.map(Into::into);
        Ok(self)
    }

    /// Returns a copy of this array on a device that can play only some phases and amplitudes: every drive is then rounded to
    /// these. `None`, or a quantization without limits, allows any drive.
    #[must_use]
    pub fn with_quantization(mut self, quantization: Option<Quantization>) -> Self {
        self.quantization = quantization.filter(|quantization| !quantization.is_continuous()).map(Arc::new);
        self
    }

    /// Returns whether a point lies behind every transducer: in the half space that none of them looks into.
    pub fn is_behind(&self, point: [f64; 3]) -> bool {
        self.heights(point).all(|height| height < 0.0)
    }

    /// Returns whether a point lies in front of a transducer.
    pub(crate) fn is_in_front(&self, point: [f64; 3]) -> bool {
        self.heights(point).any(|height| height > 0.0)
    }

    /// Distances of a point from the plane of each transducer in m, positive in front of it.
    fn heights(&self, point: [f64; 3]) -> impl Iterator<Item = f64> {
        let height = move |(place, normal): (&[f64; 3], &[f64; 3])| (Vec3(point) - *place).dot(*normal);
        self.positions.iter().zip(&*self.normals).map(height)
    }

    /// The response of transducer i, a factor of the source pressure; 0 if the transducer is off.
    pub(crate) fn effect(&self, i: usize) -> Complex64 {
        if self.mask.as_ref().is_some_and(|mask| !mask[i]) {
            return Complex64::ZERO;
        }
        self.response.as_ref().map_or(Complex64::ONE, |response| response[i])
    }

    /// Returns a copy of this array that is rotated and translated. Everything else stays: the order, the transducers, their
    /// responses, mask, channels, pins and quantization, and the mark as hardware.
    ///
    /// # Errors
    /// Coordinates that are no longer finite.
    pub fn moved(&self, pose: &Pose) -> Result<Self> {
        if *pose == Pose::NONE {
            return Ok(self.clone());
        }
        let moved = self.mirrored(|place| pose.place(place), |normal| pose.direction(normal), 1.0);
        check_finite("array.positions", &moved.positions)?;
        Ok(moved)
    }

    /// Returns a copy of this array whose positions are mapped by `place` and whose normals are mapped by
    /// `direction`, as a mirror does; all responses are multiplied by `factor`.
    pub(crate) fn mirrored(
        &self,
        place: impl Fn([f64; 3]) -> [f64; 3],
        direction: impl Fn([f64; 3]) -> [f64; 3],
        factor: f64,
    ) -> Self {
        let positions: Arc<[[f64; 3]]> = self.positions.iter().map(|&position| place(position)).collect();
        let response = (factor != 1.0).then(|| (0..self.len()).map(|i| self.effect(i) * factor).collect());
        Self {
            bounds: bounds(&positions),
            positions,
            normals: self.normals.iter().map(|&normal| direction(normal)).collect(),
            response: response.or_else(|| self.response.clone()),
            origin: Origin::Positions,
            ..self.clone()
        }
    }

    /// Returns a copy of this array that is marked as real hardware of this frequency in Hz, or as no hardware. Use it for a
    /// subset of a board, or for a board with measured positions.
    #[must_use]
    pub fn with_hardware(mut self, hardware: Option<f64>) -> Self {
        self.hardware = hardware;
        self
    }

    /// The medium of a scene on this array, for some given values of [`Medium::KEYS`]. For real hardware it is based on
    /// [`Medium::room`] at the given frequency, or at the board's; otherwise on [`Medium::default`]. Then [`Medium::with`]
    /// applies the given values.
    ///
    /// ```
    /// use midair::{Array, Medium};
    ///
    /// let board = Array::preset("autd3", [1, 1])?;
    /// assert_eq!(board.medium(&[])?, Medium::room(40e3)?);
    /// assert_eq!(board.medium(&[("absorption", 0.0)])?, Medium { absorption: 0.0, ..Medium::room(40e3)? });
    /// assert_eq!(Array::preset("paper20", [1, 1])?.medium(&[])?, Medium::default());
    /// # Ok::<(), midair::Error>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Medium::with`].
    pub fn medium(&self, numbers: &[(&str, f64)]) -> Result<Medium> {
        let stated = numbers.iter().find(|(name, _)| *name == "frequency").map(|&(_, f)| f);
        self.hardware
            .map_or(Ok(Medium::default()), |frequency| Medium::room(stated.unwrap_or(frequency)))?
            .with(numbers)
    }
}

getters! {
    Array:

    /// Number of transducers N.
    #[allow(clippy::len_without_is_empty, reason = "an array is never empty")]
    pub len(self) -> usize = self.positions.len();

    /// Positions (N, 3) in m.
    pub positions(self) -> &[[f64; 3]] = &self.positions;

    /// Unit normals (N, 3).
    pub normals(self) -> &[[f64; 3]] = &self.normals;

    /// Source pressure and directivity of every transducer.
    pub transducer(self) -> Transducer = self.transducer;

    /// Responses (N,), or `None` where all are 1.
    pub response(self) -> Option<&[Complex64]> = self.response.as_deref();

    /// Which transducers are on (N,), or `None` where all are.
    pub mask(self) -> Option<&[bool]> = self.mask.as_deref();

    /// The channel of the boards of each transducer (N,), or `None` where the order of the transducers decides.
    pub pins(self) -> Option<&[usize]> = self.pins.as_deref();

    /// The part of |p| that each of two boards face to face reflects; 0 for none.
    pub reflecting(self) -> f64 = self.reflecting;

    /// The phases and amplitudes that the device can play, or `None` if it can play any.
    pub quantization(self) -> Option<&Quantization> = self.quantization.as_deref();

    /// Positions and quantization, as shared pointers.
    pub(crate) shared(self) -> (Arc<[[f64; 3]]>, Option<Arc<Quantization>>) =
        (Arc::clone(&self.positions), self.quantization.clone());

    /// The frequency in Hz of an array that is real hardware, such as every preset except the arrays of Suzuki et al. 2021. The
    /// default medium of its scenes is [`Medium::room`].
    pub hardware(self) -> Option<f64> = self.hardware;

    /// How the array was made: from positions, as a grid or by a preset.
    pub origin(self) -> &Origin = &self.origin;

    /// Whether pressures are in the unit of Suzuki et al. 2021, eq. (5) with lengths in millimetres: P0 is then 1e-3 Pa m.
    pub in_paper_unit(self) -> bool = self.transducer.source_pressure == 1e-3;

    /// Lowest and highest coordinate along each axis.
    pub(crate) bounds(self) -> [[f64; 2]; 3] = self.bounds;

    /// The middle of the positions' bounding box, from which all coordinates are measured before they are rounded to f32.
    pub(crate) centre(self) -> [f64; 3] = self.bounds.map(|[low, high]| 0.5 * low + 0.5 * high);
}

/// Compares two arrays by value. The origin, the mark as hardware and a mask that switches nothing off are ignored.
impl PartialEq for Array {
    fn eq(&self, other: &Self) -> bool {
        let on = |array: &Self, i: usize| array.mask.as_ref().is_none_or(|mask| mask[i]);
        self.positions == other.positions
            && self.normals == other.normals
            && self.transducer == other.transducer
            && self.response == other.response
            && self.channels == other.channels
            && self.pins == other.pins
            && self.quantization == other.quantization
            && self.reflecting == other.reflecting
            && (0..self.len()).all(|i| on(self, i) == on(other, i))
    }
}

fn count(item: &str, transducers: usize) -> Result<()> {
    if transducers > MOST_TRANSDUCERS {
        let cure = format!("give at most {MOST_TRANSDUCERS} transducers");
        return Err(Error::out_of_range(item, transducers, cure));
    }
    Ok(())
}

/// How an array was made. A scene file can then state the array in short form.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// From a list of positions and normals.
    Positions,
    /// By [`crate::Array::grid`].
    Grid {
        /// Transducers along x.
        nx: usize,
        /// Transducers along y.
        ny: usize,
        /// The distance between neighbours in m.
        pitch: f64,
    },
    /// By [`crate::Array::preset`].
    Preset {
        /// Name of the preset.
        name: &'static str,
        /// Boards along x and y.
        tiles: [usize; 2],
    },
}
