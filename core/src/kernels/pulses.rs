//! Pulses: drives that go up at one edge of a period and down at another, and the one nearest to a drive.
//!
//! ```text
//! E_k = e^{2 pi j t_k}            edge k of L lies t_k turns into the period, w = 1 to L/2 ticks before edge k + w
//! q   = (E_s - E_{s+w})/2         a pulse from edge s over w ticks: its first harmonic, and 1 of half a period
//! q   = (A - B)/2,  A, B = j h u +- q,  h = sqrt(1 - |q|^2),  u = q/|q|         the edges that would make q itself
//! ```
//!
//! The nearest pulse begins and ends beside A and B. At full power an edge that is late makes up for one that is early, so
//! two to either side are compared, of many ticks, which are nearly equal. Edges are counted from where they differ least from equal ones on the whole.

use alloc::vec::Vec;
use core::f32::consts::TAU;

use num_complex::{Complex32, Complex64};

use crate::math;
use crate::math::sqrtf;

/// Edges that are compared: the one before a place, the one before that, and two after it; all of few, which may be uneven.
const BESIDE: usize = 4;
const FEW: usize = 16;

/// The edges of a period.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pulses {
    /// Turns from the first edge to each.
    begins: Vec<f32>,
    /// Turns of the first.
    first: f32,
    /// E, and the same to be searched.
    edges: Vec<Complex64>,
    short: Vec<Complex32>,
}

impl Pulses {
    /// Pulses of an even number of ticks, of any lengths in any unit.
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

    /// L.
    pub(crate) fn ticks(&self) -> usize {
        self.edges.len()
    }

    /// The drive of a pulse of `width` ticks from an edge on; 0 for no pulse.
    pub(crate) fn drive(&self, start: usize, width: usize) -> Complex32 {
        rounded(0.5 * (self.edges[start] - self.edges[(start + width) % self.ticks()]))
    }

    /// Start and width of the pulse nearest to q, a width of 0 where that is off; of two as near that of the later start.
    pub(crate) fn nearest(&self, q: Complex32) -> [usize; 2] {
        let (count, modulus) = (self.ticks(), sqrtf(q.norm_sqr()));
        if modulus == 0.0 {
            return [0, 0];
        }
        let (unit, modulus) = (q / modulus, modulus.min(1.0));
        let (along, across) = (unit * modulus, unit * Complex32::I * sqrtf((1.0 - modulus) * (1.0 + modulus)));
        let [up, down] = [across + along, across - along].map(|place| self.before(place));
        let beside = if count <= FEW { count } else { BESIDE };
        let (mut least, mut found) = (4.0 * modulus * modulus, [0, 0]);
        for start in (count - 1..).take(beside).map(|k| (up + k) % count) {
            for end in (count - 1..).take(beside).map(|k| (down + k) % count) {
                let width = (end + count - start) % count;
                let miss = (self.short[start] - self.short[end] - 2.0 * along).norm_sqr();
                if (1..=count / 2).contains(&width) && miss <= least {
                    (least, found) = (miss, [start, width]);
                }
            }
        }
        found
    }

    /// The drive of the nearest pulse.
    pub(crate) fn rounded(&self, q: Complex32) -> Complex32 {
        let [start, width] = self.nearest(q);
        self.drive(start, width)
    }

    /// Divides every drive by `factor` and rounds it; returns whether no drive has changed.
    pub(crate) fn round(&self, factor: f32, drive: &mut [Complex32]) -> bool {
        let mut stayed = true;
        for q in drive {
            let new = self.rounded(*q / factor);
            stayed &= new == *q;
            *q = new;
        }
        stayed
    }

    /// The last edge before a place on the circle.
    fn before(&self, place: Complex32) -> usize {
        let turns = math::atan2f(place.im, place.re) / TAU - self.first;
        let turns = turns - math::floorf(turns);
        self.begins.partition_point(|&begin| begin <= turns).max(1) - 1
    }
}

fn rounded(q: Complex64) -> Complex32 {
    Complex32::new(q.re as f32, q.im as f32)
}
