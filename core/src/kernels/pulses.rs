//! Pulses: drives that switch on at one edge of a period and off at another, and the pulse nearest to a drive.
//!
//! ```text
//! E_k = e^{2 pi j t_k}            edge k of L, at t_k turns of the period
//! q   = (E_s - E_{s+w})/2         a pulse from edge s over w = 1 to L/2 ticks: its first harmonic; 1 at half a period
//! A, B = j h u +- q,  h = sqrt(1 - |q|^2),  u = q/|q|         the exact edges of a pulse with q = (A - B)/2
//! ```
//!
//! The nearest pulse begins and ends near A and B. At full power a late edge compensates an early one. So if there are
//! many ticks, which are nearly equal, two edges on either side are compared. The origin of the phases is where the
//! edges differ least from equally spaced ones.

use core::f32::consts::TAU;

use crate::prelude::*;

/// BESIDE edges are compared with a place: two before it and two after it. If there are at most FEW edges, whose
/// distances may be uneven, all edges are compared.
const BESIDE: usize = 4;
const FEW: usize = 16;

/// The edges of a period.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pulses {
    /// Turns from the first edge to each edge.
    begins: Vec<f32>,
    /// Phase of the first edge in turns.
    first: f32,
    /// The phasor E of each edge (see the module's head) in f64, and rounded to f32 for the search.
    edges: Vec<Complex64>,
    short: Vec<Complex32>,
}

impl Pulses {
    /// Creates the pulses of a period from the lengths of its ticks in any unit; their number is even.
    pub(crate) fn new(ticks: &[f64]) -> Self {
        let (count, period) = (ticks.len() as f64, ticks.iter().sum::<f64>());
        let begins = ticks.iter().scan(0.0, |end, tick| {
            *end += tick;
            Some((*end - tick) / period)
        });
        let begins: Vec<f64> = begins.collect();
        let late = begins.iter().enumerate().map(|(k, begin)| begin - k as f64 / count);
        let first = -late.sum::<f64>() / count;
        let edges: Vec<_> = begins.iter().map(|begin| math::phasor(core::f64::consts::TAU * (first + begin))).collect();
        Self {
            begins: begins.iter().map(|&begin| begin as f32).collect(),
            first: first as f32,
            short: edges.iter().map(|&edge| rounded(edge)).collect(),
            edges,
        }
    }

    /// Returns the number L of ticks.
    pub(crate) fn ticks(&self) -> usize {
        self.edges.len()
    }

    /// Returns the drive of a pulse of `width` ticks from edge `start` on; 0 for width 0.
    pub(crate) fn drive(&self, start: usize, width: usize) -> Complex32 {
        rounded(0.5 * (self.edges[start] - self.edges[(start + width) % self.ticks()]))
    }

    /// Returns start and width of the pulse nearest to q; width 0 if no pulse is nearer. If two are equally near, the
    /// later start is chosen.
    pub(crate) fn nearest(&self, q: Complex32) -> [usize; 2] {
        let (count, modulus) = (self.ticks(), sqrtf(q.norm_sqr()));
        if modulus == 0.0 {
            return [0, 0];
        }
        let (unit, modulus) = (q / modulus, modulus.min(1.0));
        let (along, across) = (unit * modulus, unit * Complex32::I * sqrtf((1.0 - modulus) * (1.0 + modulus)));
        let [up, down] = [across + along, across - along].map(|place| self.before(place));
        let beside = if count <= FEW { count } else { BESIDE };
        let (mut least, mut pulse) = (4.0 * modulus * modulus, [0, 0]);
        for start in (count - 1..).take(beside).map(|k| (up + k) % count) {
            for end in (count - 1..).take(beside).map(|k| (down + k) % count) {
                let width = (end + count - start) % count;
                let miss = (self.short[start] - self.short[end] - 2.0 * along).norm_sqr();
                if (1..=count / 2).contains(&width) && miss <= least {
                    (least, pulse) = (miss, [start, width]);
                }
            }
        }
        pulse
    }

    /// Returns the drive of the pulse nearest to q.
    pub(crate) fn rounded(&self, q: Complex32) -> Complex32 {
        let [start, width] = self.nearest(q);
        self.drive(start, width)
    }

    /// Divides every drive by `factor` and rounds it to a pulse; returns whether no drive has changed.
    pub(crate) fn round(&self, factor: f32, drive: &mut [Complex32]) -> bool {
        let mut stayed = true;
        for q in drive {
            let new = self.rounded(*q / factor);
            stayed &= new == *q;
            *q = new;
        }
        stayed
    }

    /// Returns the last edge before a place on the unit circle.
    fn before(&self, place: Complex32) -> usize {
        let turns = math::atan2f(place.im, place.re) / TAU - self.first;
        let turns = turns - math::floorf(turns);
        self.begins.partition_point(|&begin| begin <= turns).max(1) - 1
    }
}

fn rounded(q: Complex64) -> Complex32 {
    Complex32::new(q.re as f32, q.im as f32)
}
