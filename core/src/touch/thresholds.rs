//! Felt strength of a vibration of the palm, from the thresholds of its two tactile channels.

use crate::prelude::*;

/// Highest frequency, in Hz, of vibration that the skin perceives.
pub const HIGHEST: f64 = 1000.0;

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
/// (Lundstrom 1992, doi 10.1007/BF00380910, abstract); at 8 and 16 Hz it is 6 to 14 dB below it. Above 500 Hz both are
/// an extrapolation without a source.
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
                (500.0, 40.0),
                (1000.0, 60.0),
            ],
            Self::Fast => &[
                (1.0, 75.6),
                (250.0, -20.0),
                (300.0, -19.0),
                (400.0, -15.0),
                (500.0, -10.0),
                (700.0, 0.0),
                (1000.0, 15.0),
            ],
        }
    }

    /// Returns the smallest vibration that this channel perceives at a frequency in Hz, as peak displacement in m. The
    /// levels in dB are interpolated over the logarithm of the frequency. Outside of 1 to 1000 Hz the result is
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
        let mut sums = vec![0.0; places];
        for (&frequency, line) in frequencies.iter().zip(squares.chunks_exact(places)) {
            let threshold = self.threshold(frequency);
            let weight = 1.0 / (threshold * threshold);
            sums.iter_mut().zip(line).for_each(|(sum, &square)| *sum += weight * f64::from(square));
        }
        sums.into_iter().map(math::sqrt).collect()
    }
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
