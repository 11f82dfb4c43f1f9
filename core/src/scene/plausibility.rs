//! Plausibility: values that are computed but probably mistakes, and the unit that was probably meant.
//!
//! A wrong factor of 1000 is beyond each limit for every array that has been built, and no array that has been built
//! is beyond one.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::ops::RangeInclusive;

use crate::scene::array::Array;
use crate::scene::geometry::distance;
use crate::scene::medium::Medium;
use crate::scene::neighbours::Neighbours;
use crate::scene::origin::Origin;
use crate::scene::plane::Plane;
use crate::scene::request::Request;

/// Hz of air-coupled arrays, 20 kHz to 1 MHz, with a margin for audible and for laboratory frequencies.
const FREQUENCY: RangeInclusive<f64> = 5e3..=2e6;

/// Temperatures in degrees C at which people work.
const TEMPERATURE: RangeInclusive<f64> = -60.0..=60.0;

/// kg/m^3 of air from high mountains to deep frost.
const DENSITY: RangeInclusive<f64> = 0.5..=2.0;

/// Np/m at 40 kHz, growing as the frequency squared: some four times what the dampest or driest air takes, and below that
/// air's dB/m.
const ABSORPTION: f64 = 1.0;

/// Pa m of a transducer, from a dead buzzer to a horn; the paper's unit is apart.
const SOURCE_PRESSURE: RangeInclusive<f64> = 0.01..=100.0;

/// Wavelengths between neighbours: nearer than the first they overlap, farther than the second they do not act together.
const SPACING: RangeInclusive<f64> = 0.05..=5.0;

/// The largest array and picture in m.
const LARGEST: f64 = 10.0;

/// The farthest point from an array in m, unless the array itself is larger: sound of 40 kHz is down to half there.
const FARTHEST: f64 = 5.0;

/// A value that is answered, but probably a mistake that way.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Doubt {
    /// The item, as in the scene file: `array.grid.pitch`.
    pub item: String,
    /// The value found.
    pub value: String,
    /// The cure.
    pub cure: String,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { item, value, cure } = self;
        write!(f, "{item} is {value}: {cure}")
    }
}

fn doubt(item: impl Into<String>, value: impl Into<String>, cure: impl Into<String>) -> Doubt {
    Doubt { item: item.into(), value: value.into(), cure: cure.into() }
}

/// A number to four digits, as short as it can be written.
pub(crate) fn short(x: f64) -> String {
    let x: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    if x == 0.0 || (1e-4..1e7).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") }
}

/// "give m (150 mm are 0.15 m)": the first of some units in which a value would be in range.
fn in_unit(value: f64, unit: &str, others: &[(&str, f64)], range: &RangeInclusive<f64>) -> String {
    let meant = others.iter().find(|(_, factor)| range.contains(&(value * factor)));
    let meant = meant.map(|(name, factor)| format!(" ({} {name} are {} {unit})", short(value), short(value * factor)));
    format!("give {unit}{}", meant.unwrap_or_default())
}

/// Like [`in_unit`] for a length.
fn metres(value: f64, range: &RangeInclusive<f64>) -> String {
    in_unit(value, "m", &[("mm", 1e-3), ("cm", 1e-2)], range)
}

impl Plane {
    /// Probable mistakes in a plane: a length beyond every array's.
    #[must_use]
    pub fn doubt(&self) -> Option<Doubt> {
        let [across, up] = self.center;
        let place = format!("plane.{}", self.axis);
        let lengths = [(&*place, self.at), ("plane.size", self.size), ("plane.center", across), ("plane.center", up)];
        let (item, length) = lengths.into_iter().find(|(_, length)| length.abs() > LARGEST)?;
        Some(doubt(item, format!("{} m", short(length)), metres(length.abs(), &(0.001..=2.0))))
    }
}

impl Array {
    /// Probable mistakes in an array and its medium: each slip once.
    #[must_use]
    pub fn doubts(&self, medium: Medium) -> Vec<Doubt> {
        let mut doubts = of_medium(medium);
        let pressure = self.transducer().source_pressure;
        if !SOURCE_PRESSURE.contains(&pressure) && !self.in_paper_unit() {
            let cure = in_unit(pressure, "Pa m", &[("mPa m", 1e-3), ("kPa m", 1e3)], &(0.1..=20.0));
            doubts.push(doubt("array.source_pressure", format!("{} Pa m", short(pressure)), cure));
        }
        doubts.extend(extent(self, medium));
        doubts
    }

    /// Probable mistakes in an array, whatever its medium: a width beyond every array's.
    #[must_use]
    pub fn doubt(&self) -> Option<Doubt> {
        let side = largest(&self.bounds());
        (side > LARGEST)
            .then(|| doubt("array.positions", format!("{} m wide", short(side)), metres(side, &(0.01..=2.0))))
    }
}

fn of_medium(medium: Medium) -> Vec<Doubt> {
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
        // The air of a doubtful temperature is no measure.
        return doubts;
    }
    let most = ABSORPTION * (frequency / 40e3) * (frequency / 40e3);
    if absorption > most && FREQUENCY.contains(&frequency) {
        let [own, nepers] = [absorption, absorption / 8.686].map(short);
        let cure = format!("air has less at this frequency: give Np/m ({own} dB/m are {nepers} Np/m)");
        doubts.push(doubt("medium.absorption", format!("{own} Np/m"), cure));
    }
    if !DENSITY.contains(&density) {
        let cure = in_unit(density, "kg/m^3", &[("g/m^3", 1e-3), ("g/cm^3", 1e3)], &DENSITY);
        doubts.push(doubt("medium.density", format!("{} kg/m^3", short(density)), cure));
    }
    doubts
}

/// A sound speed that air does not have, and the unit that was probably meant.
fn of_speed(speed: f64, celsius: f64) -> (String, String) {
    let value = format!("{} m/s", short(speed));
    let scales = [("K", celsius - 273.15), ("degrees F", (celsius - 32.0) / 1.8)];
    if let Some((scale, meant)) = scales.into_iter().find(|(_, meant)| TEMPERATURE.contains(meant)) {
        let own = short(celsius);
        let cure = format!("give the temperature in degrees C ({own} {scale} are {}), -60 to 60", short(meant));
        return (format!("{value}, that of air at {own} degrees C"), cure);
    }
    let cure = in_unit(speed, "m/s", &[("cm/s", 1e-2), ("km/s", 1e3), ("mm/s", 1e-3)], &(290.0..=370.0));
    (value, format!("air has 293 to 366 m/s, at -60 to 60 degrees C: {cure}"))
}

/// Neighbours too close or too far apart, or an array too large.
fn extent(array: &Array, medium: Medium) -> Option<Doubt> {
    let places = array.positions();
    let wavelength = medium.wavelength();
    // A doubtful wavelength is no measure.
    let sure = FREQUENCY.contains(&medium.frequency) && TEMPERATURE.contains(&medium.temperature());
    if sure && places.len() > 1 {
        let usual = &(wavelength / 4.0..=wavelength * 3.0);
        let [close, far] = [*SPACING.start(), *SPACING.end()].map(|part| part * wavelength);
        let reported = |pair: Option<[usize; 2]>, length: f64, what: &str| {
            let (item, value) = match (array.origin(), pair) {
                (Origin::Grid { pitch, .. }, _) => ("array.grid.pitch", format!("{} m", short(*pitch))),
                (_, Some([i, k])) => ("array.positions", format!("{} m from [{i}] to [{k}]", short(length))),
                _ => ("array.positions", format!("{} m and more from one to the next", short(length))),
            };
            let cure = if length == 0.0 { "leave one out".into() } else { metres(length, usual) };
            doubt(item, value, format!("{what} of {} m: {cure}", short(wavelength)))
        };
        let neighbours = Neighbours::of(places);
        if let Some((pair, length)) = neighbours.pair(close, |_, _| true) {
            return Some(reported(Some(pair), length, "neighbours nearer than a twentieth of the wavelength"));
        }
        if neighbours.pair(far, |_, _| true).is_none() {
            return Some(reported(None, distance(places[0], places[1]), "no neighbours within five wavelengths"));
        }
    }
    array.doubt()
}

fn largest(bounds: &[[f64; 2]; 3]) -> f64 {
    bounds.iter().fold(0.0, |most, [low, high]| f64::max(most, high - low))
}

/// An array and the box around it in which its points are looked for.
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

    /// The first point far away, or else behind every transducer, and how many there are, named by its index.
    pub(crate) fn doubt(&self, points: &[[f64; 3]], name: impl Fn(usize) -> String) -> Option<Doubt> {
        let outside = |point: &[f64; 3]| point.iter().zip(&self.bounds).any(|(x, [low, high])| x < low || x > high);
        let first = |doubtful: &dyn Fn(&[f64; 3]) -> bool| {
            let all =
                points.iter().enumerate().filter(|(_, point)| point.iter().all(|x| x.is_finite()) && doubtful(point));
            let indices: Vec<usize> = all.map(|(j, _)| j).collect();
            let &j = indices.first()?;
            let others = if indices.len() > 1 { format!(" (and {} more)", indices.len() - 1) } else { String::new() };
            let [x, y, z] = points[j].map(short);
            Some((j, format!("[{x}, {y}, {z}] m{others}")))
        };
        if let Some((j, value)) = first(&outside) {
            let away = points[j].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let length = metres(away, &(0.01..=2.0));
            return Some(doubt(name(j), value, format!("far beyond an array of {} m: {length}", short(self.size))));
        }
        let (j, value) = first(&|point| self.array.is_behind(*point))?;
        Some(doubt(name(j), value, "behind every transducer, where a board sends no sound: give a point in front"))
    }
}

/// Two points so close that no wave has their two pressures: over a distance d it changes by no more than k d of its
/// greatest pressure (Bernstein's inequality).
pub(crate) fn contrary(medium: Medium, points: &[[f64; 3]], request: &Request) -> Option<Doubt> {
    let pressures = request.pressures.as_ref()?;
    let taking_part: Vec<usize> = (0..points.len()).filter(|&j| request.weight(j) > 0.0).collect();
    // Mostly all ask for the same.
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
    Some(doubt(format!("points[{j}].pressure"), value, cure))
}
