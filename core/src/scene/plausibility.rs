//! Plausibility: warns of values that can be computed but are probably mistakes, and names the unit that was probably meant.
//!
//! The limits are chosen so that every array that has been built is within all of them, and that an error by a factor of 1000
//! exceeds one.

use core::ops::RangeInclusive;

use crate::prelude::*;
use crate::scene::order::is_of_boards;
use crate::scene::{Array, Bead, Medium, Obstacle, Origin, Particle, Plane, Request, distance};

/// Plausible frequencies in Hz. Air-coupled arrays use 20 kHz to 1 MHz; the margin is for audible and laboratory frequencies.
const FREQUENCY: RangeInclusive<f64> = 5e3..=2e6;

/// Plausible temperatures in degrees C: those at which people work.
const TEMPERATURE: RangeInclusive<f64> = -60.0..=60.0;

/// Plausible densities in kg/m^3: air from high mountains to deep frost.
const DENSITY: RangeInclusive<f64> = 0.5..=2.0;

/// The largest plausible absorption in Np/m at 40 kHz; it grows as the frequency squared. It is about four times that of air at
/// any humidity, and below air's absorption in dB/m, so that a value in dB/m is noticed.
const ABSORPTION: f64 = 1.0;

/// Plausible source pressures of a transducer in Pa m, from a weak buzzer to a horn. The unit of the paper is an exception, see
/// [`Array::in_paper_unit`].
const SOURCE_PRESSURE: RangeInclusive<f64> = 0.01..=100.0;

/// Plausible distances between neighbours in wavelengths: nearer transducers overlap, and farther ones do not form a beam.
const SPACING: RangeInclusive<f64> = 0.05..=5.0;

/// The largest plausible width of a piston over the distance of its neighbour: an effective radius may exceed the case a little.
const WIDER: f64 = 1.05;

/// The largest plausible array or picture in m.
const LARGEST: f64 = 10.0;

/// The largest plausible distance in m between a point and the array. For a larger array the limit is the array's
/// size. At this distance the air has absorbed half of the pressure at 40 kHz.
const FARTHEST: f64 = 5.0;

fn doubt(item: impl Into<String>, value: impl Into<String>, cure: impl Into<String>) -> Notice {
    Notice::new(ErrorCode::Doubtful, item, value.into(), cure)
}

/// A number with four significant digits, in its shortest form.
pub(crate) fn short(x: f64) -> String {
    figures(x, 4)
}

/// A number with this many significant digits, in its shortest form.
pub(crate) fn figures(x: f64, digits: usize) -> String {
    let x: f64 = format!("{x:.0$e}", digits - 1).parse().unwrap_or(x);
    if x == 0.0 || (1e-4..1e7).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") }
}

/// Returns the cure "give m (150 mm are 0.15 m)". It names the first of `others` (unit, factor) in which the value would be in
/// range.
fn in_unit(value: f64, unit: &str, others: &[(&str, f64)], range: &RangeInclusive<f64>) -> String {
    let meant = others.iter().find(|(_, factor)| range.contains(&(value * factor)));
    let meant = meant.map(|(name, factor)| format!(" ({} {name} are {} {unit})", short(value), short(value * factor)));
    format!("give {unit}{}", meant.unwrap_or_default())
}

/// The cure of [`in_unit`] for a length in m.
fn metres(value: f64, range: &RangeInclusive<f64>) -> String {
    in_unit(value, "m", &[("mm", 1e-3), ("cm", 1e-2)], range)
}

impl Bead {
    /// Returns a probable mistake in a bead: a radius larger than the wavelength, or a density below that of the air. The default
    /// bead, which most scenes do not use, is not judged.
    pub(crate) fn doubt(&self, medium: Medium) -> Option<Notice> {
        let (radius, wavelength) = (self.particle.radius, medium.wavelength());
        let sure = self.particle != Particle::default() && is_sure(medium);
        let density = self.particle.density;
        if sure && density < medium.density {
            let cure = in_unit(density, "kg/m^3", &[("g/cm^3", 1e3)], &(5.0..=20_000.0));
            let cure = format!("lighter than the air, {} kg/m^3: {cure}", short(medium.density));
            return Some(doubt("bead.density", format!("{} kg/m^3", short(density)), cure));
        }
        (sure && radius > wavelength).then(|| {
            let cure = metres(radius, &(1e-5..=wavelength));
            let cure = format!("larger than the wavelength of {} m: {cure}", short(wavelength));
            doubt("bead.radius", format!("{} m", short(radius)), cure)
        })
    }
}

impl Plane {
    /// Returns a probable mistake in a plane: a length larger than any array.
    pub fn doubt(&self) -> Option<Notice> {
        let [across, up] = self.center;
        let place = format!("plane.{}", self.axis);
        let lengths = [(&*place, self.at), ("plane.size", self.size), ("plane.center", across), ("plane.center", up)];
        let (item, length) = lengths.into_iter().find(|(_, length)| length.abs() > LARGEST)?;
        Some(doubt(item, format!("{} m", short(length)), metres(length.abs(), &(0.001..=2.0))))
    }
}

impl Array {
    /// Returns probable mistakes in an array and its medium; each mistake is listed once.
    pub fn doubts(&self, medium: Medium) -> Vec<Notice> {
        let mut doubts = of_medium(medium);
        let pressure = self.transducer().source_pressure;
        if !SOURCE_PRESSURE.contains(&pressure) && !self.in_paper_unit() {
            let cure = in_unit(pressure, "Pa m", &[("mPa m", 1e-3), ("kPa m", 1e3)], &(0.1..=20.0));
            doubts.push(doubt("array.source_pressure", format!("{} Pa m", short(pressure)), cure));
        }
        doubts.extend(extent(self, medium).or_else(|| by_hand(self, medium)));
        doubts
    }

    /// Returns a probable mistake in an array alone: a width larger than that of any array.
    pub fn doubt(&self) -> Option<Notice> {
        let side = largest(&self.bounds());
        (side > LARGEST)
            .then(|| doubt("array.positions", format!("{} m wide", short(side)), metres(side, &(0.01..=2.0))))
    }
}

fn of_medium(medium: Medium) -> Vec<Notice> {
    let mut doubts = Vec::new();
    let Medium { frequency, sound_speed, absorption, density, .. } = medium;
    if !FREQUENCY.contains(&frequency) {
        let cure = in_unit(frequency, "Hz", &[("kHz", 1e3), ("MHz", 1e6)], &(20e3..=1e6));
        let cure = format!("ultrasound in air is 20000 to 1000000 Hz: {cure}");
        doubts.push(doubt("medium.frequency", format!("{} Hz", short(frequency)), cure));
    }
    let celsius = medium.temperature();
    if !TEMPERATURE.contains(&celsius) {
        let (value, cure) = of_speed(sound_speed, celsius);
        doubts.push(doubt("medium.sound_speed", value, cure));
        // Absorption and density depend on the temperature, so they are not judged if it is in doubt.
        return doubts;
    }
    let most = ABSORPTION * (frequency / 40e3) * (frequency / 40e3);
    if absorption > most && FREQUENCY.contains(&frequency) {
        let [number, nepers] = [absorption, absorption / 8.686].map(short);
        let cure = format!("air has less at this frequency: give Np/m ({number} dB/m are {nepers} Np/m)");
        doubts.push(doubt("medium.absorption", format!("{number} Np/m"), cure));
    }
    if !DENSITY.contains(&density) {
        let cure = in_unit(density, "kg/m^3", &[("g/m^3", 1e-3), ("g/cm^3", 1e3)], &DENSITY);
        doubts.push(doubt("medium.density", format!("{} kg/m^3", short(density)), cure));
    }
    doubts
}

/// Returns the text and the cure for a sound speed that air does not have; the cure names the unit that was probably meant.
fn of_speed(speed: f64, celsius: f64) -> (String, String) {
    let value = format!("{} m/s", short(speed));
    let scales = [("K", celsius - 273.15), ("degrees F", (celsius - 32.0) / 1.8)];
    if let Some((scale, meant)) = scales.into_iter().find(|(_, meant)| TEMPERATURE.contains(meant)) {
        let number = short(celsius);
        let cure = format!("give the temperature in degrees C ({number} {scale} are {}), -60 to 60", short(meant));
        return (format!("{value}, that of air at {number} degrees C"), cure);
    }
    let cure = in_unit(speed, "m/s", &[("cm/s", 1e-2), ("km/s", 1e3), ("mm/s", 1e-3)], &(290.0..=370.0));
    (value, format!("air has 293 to 366 m/s, at -60 to 60 degrees C: {cure}"))
}

/// Returns whether the wavelength is plausible. With a doubtful wavelength, distances between transducers cannot be judged.
fn is_sure(medium: Medium) -> bool {
    FREQUENCY.contains(&medium.frequency) && TEMPERATURE.contains(&medium.temperature())
}

/// Returns a probable mistake in positions: neighbours too close or too far apart, or an array too large.
fn extent(array: &Array, medium: Medium) -> Option<Notice> {
    let places = array.positions();
    let wavelength = medium.wavelength();
    if is_sure(medium) && places.len() > 1 {
        let (usual, length) = (&(wavelength / 4.0..=wavelength * 3.0), distance(places[0], places[1]));
        let [close, far] = [*SPACING.start(), *SPACING.end()].map(|part| part * wavelength);
        let reported = |pair: Option<[usize; 2]>, length: f64, what: &str| {
            let (item, value) = match (array.origin(), pair) {
                (Origin::Grid { pitch, .. }, _) => ("array.grid.pitch", format!("{} m", short(*pitch))),
                (_, Some([i, k])) => ("array.positions", format!("{} m from [{i}] to [{k}]", short(length))),
                _ => ("array.positions", format!("{} m and more from one to the next", short(length))),
            };
            let cure = if length == 0.0 { "leave one out".into() } else { metres(length, usual) };
            let mm = item == "array.positions" && cure.contains(" mm are ");
            let cure = if mm { cure + ", or unit=\"mm\"" } else { cure };
            doubt(item, value, format!("{what} of {} m: {cure}", short(wavelength)))
        };
        let neighbours = Neighbours::of(places);
        if let Some((pair, length)) = neighbours.pair(close, |_, _| true) {
            return Some(reported(Some(pair), length, "neighbours nearer than a twentieth of the wavelength"));
        }
        if let Some(notice) = overlapping(array, &neighbours) {
            return Some(notice);
        }
        // Two or three sources may be anywhere, unless another unit explains their distance.
        if neighbours.pair(far, |_, _| true).is_none() && (places.len() > 3 || metres(length, usual) != "give m") {
            return Some(reported(None, length, "no neighbours within five wavelengths"));
        }
    }
    array.doubt()
}

/// Returns the probable mistake of boards put together by their places alone, which have lost the air of the hardware.
fn by_hand(array: &Array, medium: Medium) -> Option<Notice> {
    (array.hardware().is_none() && medium == Medium::default() && is_of_boards(array)).then(|| {
        let value = format!("those of boards, in a medium of {} m/s", short(medium.sound_speed));
        doubt("array.positions", value, "join arrays by Array.join, or give the air (temperature = 25)").verb("are")
    })
}

/// Returns the probable mistake of a diameter given as the radius: every piston overlaps a neighbour.
fn overlapping(array: &Array, neighbours: &Neighbours) -> Option<Notice> {
    let radius = array.transducer().directivity.radius()?;
    let (places, most) = (array.positions(), 2.0 * radius / WIDER);
    let overlaps = |i: usize| (0..places.len()).any(|k| k != i && distance(places[i], places[k]) < most);
    let (_, pitch) = neighbours.pair(most, |_, _| true)?;
    if !(0..places.len()).all(overlaps) {
        return None;
    }
    let [diameter, half, pitch] = [radius, radius / 2.0, pitch].map(short);
    let cure = format!(
        "wider than the {pitch} m from one transducer to the next: give the radius (a diameter of {diameter} m is a \
         radius of {half} m)"
    );
    Some(doubt("directivity.piston", format!("a radius of {diameter} m"), cure))
}

fn largest(bounds: &[[f64; 2]; 3]) -> f64 {
    bounds.iter().fold(0.0, |most, [low, high]| f64::max(most, high - low))
}

/// An array and the box around it in which points are plausible.
#[derive(Clone, Debug)]
pub(crate) struct Vicinity {
    array: Array,
    bounds: [[f64; 2]; 3],
    size: f64,
}

impl Vicinity {
    pub(crate) fn of(array: &Array) -> Self {
        let bounds = array.bounds();
        let size = largest(&bounds);
        let most = FARTHEST.max(size);
        Self { array: array.clone(), bounds: bounds.map(|[low, high]| [low - most, high + most]), size }
    }

    /// Returns the first point outside of the box or, if all are inside, the first one behind every transducer, else
    /// the first one [`beside`] the array. The text may also give the number of such points; `name` makes the name from
    /// the index.
    pub(crate) fn doubt(&self, medium: Medium, points: &[[f64; 3]], name: impl Fn(usize) -> String) -> Option<Notice> {
        if let Some(far) = self.far(points, &name) {
            return Some(far);
        }
        let Some((j, value)) = first(points, |point| self.array.is_behind(point)) else {
            return beside(&self.array, medium, points, name);
        };
        let cure = "behind every transducer, where a board sends no sound: give a point in front";
        Some(Notice::new(ErrorCode::Behind, name(j), value, cure))
    }

    /// Returns the first point outside of the box, and the number of such points.
    pub(crate) fn far(&self, points: &[[f64; 3]], name: impl Fn(usize) -> String) -> Option<Notice> {
        let outside = |point: [f64; 3]| point.iter().zip(&self.bounds).any(|(x, [low, high])| x < low || x > high);
        let (j, value) = first(points, outside)?;
        let away = points[j].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let length = metres(away, &(0.01..=2.0));
        let cure = format!("far beyond an array of {} m: {length}", short(self.size));
        Some(Notice::new(ErrorCode::TooFar, name(j), value, cure))
    }
}

/// Returns the index of the first doubtful point, and a text of its coordinates and of the number of further such points.
fn first(points: &[[f64; 3]], doubtful: impl Fn([f64; 3]) -> bool) -> Option<(usize, String)> {
    let finite = |point: [f64; 3]| point.iter().all(|x| x.is_finite());
    let mut indices = (0..points.len()).filter(|&j| finite(points[j]) && doubtful(points[j]));
    let j = indices.next()?;
    let [x, y, z] = points[j].map(short);
    let others = match indices.count() {
        0 => String::new(),
        more => format!(" (and {more} more)"),
    };
    Some((j, format!("[{x}, {y}, {z}] m{others}")))
}

/// Returns the first point that is too near to a transducer, or that is in front of no transducer.
///
/// Within a quarter of the wavelength the model of a point source is wrong. A point within a hundredth of the wavelength is an
/// error, reported elsewhere. A piston of radius a has its far field from k a^2 / 2 on ([`Directivity::near_field`]).
fn beside(array: &Array, medium: Medium, points: &[[f64; 3]], name: impl Fn(usize) -> String) -> Option<Notice> {
    let [error, quarter] = [100.0, 4.0].map(|part| medium.wavelength() / part);
    let directivity = array.transducer().directivity;
    let within = directivity.near_field(medium.wavenumber()).max(quarter);
    let bounds = array.bounds();
    let close = |(x, [low, high]): (&f64, &[f64; 2])| (low - within..=high + within).contains(x);
    let reason = |point: &[f64; 3]| {
        let apart = |i: &usize| distance(array.positions()[*i], *point);
        let inside = is_sure(medium) && point.iter().zip(&bounds).all(close);
        let nearest = if inside { (0..array.len()).min_by(|i, k| apart(i).total_cmp(&apart(k))) } else { None };
        match nearest.map(|i| (i, apart(&i))) {
            Some((_, length)) if length < error => None,
            Some((i, length)) if length < within => Some((
                ErrorCode::TooNear,
                format!(", {} m from transducer {i}", short(length)),
                if length < quarter {
                    "nearer than a quarter of the wavelength a transducer is no point source: give a point farther away"
                        .into()
                } else {
                    let (reach, a) = (short(within), short(directivity.parameter));
                    format!(
                        "nearer than k a^2/2 = {reach} m the far field of a piston of radius a = {a} m is wrong by 5 % \
                         and more: give a point farther away"
                    )
                },
            )),
            _ if array.is_in_front(*point) => None,
            _ => Some((
                ErrorCode::InPlane,
                String::new(),
                "in the plane of the transducers, where a board sends little sound: give a point in front".into(),
            )),
        }
    };
    let (j, (code, value, cure)) = points.iter().enumerate().find_map(|(j, point)| Some((j, reason(point)?)))?;
    let [x, y, z] = points[j].map(short);
    Some(Notice::new(code, name(j), format!("[{x}, {y}, {z}] m{value}"), cure))
}

/// Returns the first obstacle that is farther away than any room is large.
pub(crate) fn distant(array: &Array, obstacles: &[Obstacle]) -> Option<Notice> {
    let centre = array.centre();
    let away = |obstacle: &Obstacle| match (obstacle, obstacle.bounds()) {
        (Obstacle::Wall { point, normal, .. }, _) => (Vec3(centre) - *point).dot(*normal).abs() / Vec3(*normal).norm(),
        (_, Some(bounds)) => {
            let nearest: [f64; 3] = core::array::from_fn(|axis| centre[axis].clamp(bounds[axis][0], bounds[axis][1]));
            distance(nearest, centre)
        }
        _ => 0.0,
    };
    let most = LARGEST.max(largest(&array.bounds()));
    let (k, length) = obstacles.iter().map(away).enumerate().find(|(_, length)| *length > most)?;
    let (value, cure) = (format!("{} m from the array", short(length)), metres(length, &(0.01..=2.0)));
    Some(Notice::new(ErrorCode::TooFar, format!("obstacles[{k}]"), value, cure))
}

/// Returns two points that are too close for their different pressures: over a distance d, the pressure of a wave changes by at
/// most k d times its greatest pressure (Bernstein's inequality).
pub(crate) fn contrary(medium: Medium, points: &[[f64; 3]], request: &Request) -> Option<Notice> {
    let pressures = request.pressures.as_ref()?;
    let taking_part: Vec<usize> = (0..points.len()).filter(|&j| request.weight(j) > 0.0).collect();
    // In most requests all pressures are equal.
    if taking_part.iter().all(|&j| pressures[j] == pressures[taking_part[0]]) {
        return None;
    }
    let places: Vec<[f64; 3]> = taking_part.iter().map(|&j| points[j]).collect();
    let apart = |pair: [usize; 2], distance: f64| {
        let [one, other] = pair.map(|k| pressures[taking_part[k]]);
        (one - other).abs() > (medium.wavenumber() * distance).max(1e-3) * one.max(other)
    };
    let (pair, distance) = Neighbours::of(&places).pair(medium.wavelength() / 10.0, apart)?;
    let [j, k] = pair.map(|k| taking_part[k]);
    let value =
        format!("{} Pa, {} m from points[{k}] with {} Pa", short(pressures[j]), short(distance), short(pressures[k]));
    let cure = "less than a tenth of the wavelength apart they cannot differ so: give them one pressure, or move one";
    Some(Notice::new(ErrorCode::Contrary, format!("points[{j}].pressure"), value, cure).other(format!("points[{k}]")))
}

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
