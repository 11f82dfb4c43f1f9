//! Felt strength of a vibration of the palm, from the thresholds of its two tactile channels.

use crate::prelude::*;

/// Highest frequency, in Hz, of vibration that the model counts: no source has thresholds above it.
pub const HIGHEST: f64 = 500.0;

/// Distance in m over which the slow channel compares displacements. It is the radius of the receptive field of a
/// fast-adapting unit, 13 mm^2 (Johansson and Vallbo 1983).
pub const REACH: f64 = 2e-3;

/// A tactile channel of the palm.
///
/// The thresholds are for a contactor of 2.9 cm^2 and long bursts. Gescheider and Verrillo 1979 (doi
/// 10.1007/978-1-4613-3039-4_10) state that the threshold of the fast channel falls by 12 dB an octave from 40 Hz to
/// its minimum near 250 Hz. The levels are not verified: those of the fast channel are attributed to Verrillo 1963
/// (J. Acoust. Soc. Am. 35, 1962), those of the slow channel to Bolanowski et al. 1988 (84, 1680), whose tables were not
/// read. From 30 to 500 Hz the more sensitive channel is within the range of 171 men, 100 to 140 dB re 1e-6 m/s^2 rms
/// (Lundstrom 1992, doi 10.1007/BF00380910, abstract); at 8 and 16 Hz it is 6 to 14 dB below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Non-Pacinian I channel: senses differences of displacement over [`REACH`].
    Slow,
    /// Pacinian channel: senses displacement.
    Fast,
}

impl Channel {
    /// Returns the points of the threshold curve: frequencies in Hz and peak displacements in dB relative to 1 um.
    fn curve(self) -> &'static [(f64, f64)] {
        match self {
            Self::Slow => &[
                (1.0, 32.0),
                (3.0, 28.0),
                (10.0, 20.0),
                (30.0, 13.0),
                (60.0, 12.0),
                (100.0, 14.0),
                (200.0, 21.0),
                (300.0, 28.0),
                (HIGHEST, 40.0),
            ],
            Self::Fast => &[(1.0, 75.6), (250.0, -20.0), (300.0, -19.0), (400.0, -15.0), (HIGHEST, -10.0)],
        }
    }

    /// Returns the smallest vibration that this channel perceives at a frequency in Hz, as peak displacement in m. The
    /// levels in dB are interpolated over the logarithm of the frequency. Outside of 1 to 500 Hz the result is
    /// infinite.
    ///
    /// ```
    /// use midair::touch::Channel;
    ///
    /// assert!((Channel::Fast.threshold(250.0) - 1e-7).abs() < 1e-12);
    /// assert!(Channel::Slow.threshold(20.0) < Channel::Fast.threshold(20.0));
    /// ```
    pub fn threshold(self, frequency: f64) -> f64 {
        let parts = self.curve().windows(2).map(|pair| (pair[0], pair[1]));
        let part = parts.clone().find(|((low, _), (high, _))| (low..=high).contains(&&frequency));
        part.map_or(f64::INFINITY, |((low, below), (high, above))| {
            let share = math::log(frequency / low) / math::log(high / low);
            1e-6 * math::pow(10.0, (below + (above - below) * share) / 20.0)
        })
    }

    /// Returns the factor by which vibrations exceed the threshold at each of P places: sqrt(sum of
    /// |amplitude/threshold|^2) over L spectral lines. `squares` (L, P) are |amplitude|^2 in m^2 at the frequencies
    /// (L,) in Hz.
    pub fn excess(self, frequencies: &[f64], squares: &[f32], places: usize) -> Vec<f64> {
        rooted(frequencies, squares, places, |frequency| math::pow(self.threshold(frequency), -2.0))
    }
}

/// Returns sqrt(sum of weight(f) square) over L lines of frequencies (L,) in Hz and squares (L, P), at each of P places.
fn rooted(frequencies: &[f64], squares: &[f32], places: usize, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut sums = vec![0.0; places];
    for (&frequency, line) in frequencies.iter().zip(squares.chunks_exact(places)) {
        let weight = weight(frequency);
        sums.iter_mut().zip(line).for_each(|(sum, &square)| *sum += weight * f64::from(square));
    }
    sums.into_iter().map(math::sqrt).collect()
}

/// Frequency in Hz above which the channel of pressure (SA-I) passes less: the end of the 5 to 15 Hz at which a moving focus
/// is felt as a steady push (Morisaki et al., IEEE Trans. Haptics 15(2), 2022, doi 10.1109/TOH.2021.3125843).
const STEADY: f64 = 15.0;

/// Felt force over the force that the channel of pressure passes, fitted once: 0.21 N felt for 0.027 N (the same paper), with a
/// focus that swings by 3 mm at 5 Hz; the abstract does not state the swing.
pub const GAIN: f64 = 9.0;

/// Returns the part that the channel of pressure passes of lines (L, P) at frequencies (L,) in Hz above 0, at each of P places:
/// sqrt(sum of |line|^2/(1 + (f/15 Hz)^2)).
///
/// Slowly adapting units are most sensitive at the lowest frequencies, fast ones from 8 to 64 Hz (Johansson et al., Brain Res.
/// 244, 17, 1982). They sense curvature (IEEE EMBC 2009, 5334487), which in a sheet that moves slowly is the pressure over the
/// tension. A push at rest is not felt (Morisaki et al. 2022).
pub fn steady(frequencies: &[f64], lines: &[Complex32], places: usize) -> Vec<f64> {
    let squares: Vec<f32> = lines.iter().map(Complex32::norm_sqr).collect();
    rooted(frequencies, &squares, places, |frequency| 1.0 / (1.0 + (frequency / STEADY) * (frequency / STEADY)))
}

/// Returns the felt strength for the factors by which a vibration exceeds the thresholds of both channels; it is 1 at
/// the threshold. It is the larger factor plus half of the smaller one (Hollins and Roy, Somatosens. Motor Res. 13,
/// 1996).
pub fn strength(slow: f64, fast: f64) -> f64 {
    slow.max(fast) + slow.min(fast) / 2.0
}

/// Returns a felt strength in dB above the threshold; minus infinity for 0.
///
/// ```
/// assert_eq!([10.0, 1.0, 0.0].map(midair::touch::decibels), [20.0, 0.0, f64::NEG_INFINITY]);
/// ```
pub fn decibels(strength: f64) -> f64 {
    20.0 * math::log10(strength)
}

/// Returns the width of a felt spot in m: twice the distance from the place of index `middle` to the nearest place
/// whose value is less than half of the value at `middle`. It is infinite if there is no such place.
pub fn felt_width(values: &[f64], places: &[[f64; 3]], middle: usize) -> f64 {
    let apart = |place: &[f64; 3]| {
        let way = Vec3(*place) - places[middle];
        way.dot(way)
    };
    let below = values.iter().zip(places).filter(|&(&value, _)| value < values[middle] / 2.0);
    2.0 * math::sqrt(below.map(|(_, place)| apart(place)).fold(f64::INFINITY, f64::min))
}
