//! Reach: the sums of |G| at the points, the pressures that all transducers in phase give.

use alloc::vec::Vec;

use crate::control::Control;
use crate::error::Error;
use crate::kernels::lanes::Line;
use crate::kernels::propagate::rows;
use crate::kernels::{self, LANES, Run};
use crate::math;
use crate::propagation::sources::Sources;
use crate::propagation::{Propagation, Rows};

/// Square wavelengths, a little more than a hundredth squared: f32 decides where f64 is to look.
pub(crate) const NEAR: f32 = 1.01e-4;

/// The largest number of stored amplitudes: 1 MiB, which stays in the second-level cache until the rows are made.
const MOST_KEPT: usize = 1 << 18;

/// Amplitudes |c| D e^{-alpha r}/r of all elements of G, where they are kept: row after row.
#[derive(Clone, Debug, Default)]
pub(crate) struct Amplitudes {
    rows: Vec<Line>,
    sums: Vec<f32>,
}

impl Amplitudes {
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
    }
}

impl Propagation {
    /// p1_j = `sum_i |G_ji|` in units of the reference, refusing a point on a transducer. Where it saves a sweep to compute
    /// each directivity twice, `amplitudes` are kept for [`Propagation::rows_of`]; else it is empty.
    pub(crate) fn reach(
        &self,
        reach: &mut Vec<f64>,
        amplitudes: Option<&mut Amplitudes>,
        control: &mut Control,
    ) -> Result<(), Error> {
        reach.clear();
        reach.resize(self.count, 0.0);
        let amplitudes = match amplitudes {
            Some(amplitudes) if !self.keeps() => {
                amplitudes.clear();
                None
            }
            other => other,
        };
        match &self.rows {
            Rows::Computed { sources, frame, points } => {
                let place = self.padded_points(frame);
                let near = |sources: &Sources, run: Run<'_>| {
                    run.members.into_iter().try_for_each(|i| sources.check_distances(i, points))
                };
                let runs = Run::all(&sources.radiation, &sources.transducers);
                let Some(amplitudes) = amplitudes else {
                    for run in runs {
                        if kernels::add_moduli(self.set, &run, place, NEAR, reach, control)? {
                            near(sources, run)?;
                        }
                    }
                    return Ok(());
                };
                let lanes = self.lanes();
                let wide = lanes / LANES;
                // All of it is written anew.
                amplitudes.rows.resize(sources.transducers.len() * wide, Line([0.0; LANES]));
                amplitudes.sums.resize(lanes, 0.0);
                for run in runs {
                    control.pulse()?;
                    let own = &mut amplitudes.rows[run.members.start * wide..run.members.end * wide];
                    if kernels::keep_moduli(self.set, &run, place, NEAR, &mut amplitudes.sums, own) {
                        near(sources, run)?;
                    }
                    reach.iter_mut().zip(&amplitudes.sums).for_each(|(reach, &sum)| *reach += f64::from(sum));
                }
            }
            Rows::Stored { matrix, reference, kept, .. } => {
                if let Some(kept) = kept {
                    (0..kept.sources.array.len()).try_for_each(|i| kept.sources.check_distances(i, &kept.points))?;
                }
                for row in matrix.chunks(self.count) {
                    control.pulse()?;
                    for (reach, g) in reach.iter_mut().zip(row) {
                        *reach += math::hypot(g.re, g.im) / reference;
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether rows follow, the points fill three quarters of their lane groups, and an amplitude takes more than a quotient.
    fn keeps(&self) -> bool {
        let Rows::Computed { sources, .. } = &self.rows else { return false };
        let (lanes, pattern) = (self.lanes(), sources.radiation.pattern.is_some());
        self.rows_follow
            && pattern
            && 4 * (lanes - self.count) <= lanes
            && lanes * sources.transducers.len() <= MOST_KEPT
    }

    /// The rows as the kernels read them, with the amplitudes that [`Propagation::reach`] kept.
    pub(crate) fn rows_of<'a>(&'a self, kept: &'a Amplitudes) -> rows::Rows<'a> {
        match self.rows() {
            rows::Rows::Computed { radiation, sources, control_points, .. } => {
                rows::Rows::Computed { radiation, sources, control_points, amplitudes: &kept.rows }
            }
            stored @ rows::Rows::Stored { .. } => stored,
        }
    }
}
