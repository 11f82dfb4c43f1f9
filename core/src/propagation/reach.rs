//! Reach: the sum of |G| at each point, the pressure that all transducers in phase give there.

use crate::kernels::lanes::Line;
use crate::kernels::propagate::rows;
use crate::kernels::{self, LANES, Run};
use crate::prelude::*;
use crate::propagation::{Propagation, Rows, Sources};

/// The square of slightly more than a hundredth of a wavelength, in square wavelengths. Squared distances in f32
/// below it are checked again in f64.
pub(crate) const NEAR: f32 = 1.01e-4;

/// The most amplitudes that are stored: 1 MiB, which stays in the second-level cache until the rows are computed.
const MOST_KEPT: usize = 1 << 18;

/// The amplitudes |c| D e^{-alpha r}/r of all elements of the propagation matrix G, row by row, if they are stored.
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
    /// Computes p1_j = `sum_i |G_ji|` in units of the reference, and checks that no point is on a transducer. If it saves time
    /// to compute each directivity only once, stores the `amplitudes` for [`Propagation::rows_of`]; otherwise they are left
    /// empty.
    pub(crate) fn reach(
        &self,
        reach: &mut Vec<f64>,
        amplitudes: Option<&mut Amplitudes>,
        control: &mut Control,
    ) -> Result<()> {
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
                // All entries are overwritten below.
                amplitudes.rows.resize(sources.transducers.len() * wide, Line([0.0; LANES]));
                amplitudes.sums.resize(lanes, 0.0);
                for run in runs {
                    control.pulse()?;
                    let rows = &mut amplitudes.rows[run.members.start * wide..run.members.end * wide];
                    if kernels::interleaved_moduli(self.set, &run, place, NEAR, &mut amplitudes.sums, rows) {
                        near(sources, run)?;
                    }
                    reach.iter_mut().zip(&amplitudes.sums).for_each(|(reach, &sum)| *reach += f64::from(sum));
                }
            }
            Rows::Stored { matrix, reference, recipe, .. } => {
                if let Some(recipe) = recipe {
                    (0..recipe.sources.array.len())
                        .try_for_each(|i| recipe.sources.check_distances(i, &recipe.points))?;
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

    /// Whether storing the amplitudes saves time: rows are computed afterwards, the points fill three quarters of their lane
    /// groups, and the directivity makes an amplitude more costly than a division.
    fn keeps(&self) -> bool {
        let Rows::Computed { sources, .. } = &self.rows else { return false };
        let (lanes, pattern) = (self.lanes(), sources.radiation.pattern.is_some());
        self.rows_follow
            && pattern
            && 4 * (lanes - self.count) <= lanes
            && lanes * sources.transducers.len() <= MOST_KEPT
    }

    /// The rows in the form that the kernels read, with the amplitudes that [`Propagation::reach`] stored.
    pub(crate) fn rows_of<'a>(&'a self, known: &'a Amplitudes) -> rows::Rows<'a> {
        match self.rows() {
            rows::Rows::Computed { radiation, sources, control_points, .. } => {
                rows::Rows::Computed { radiation, sources, control_points, amplitudes: &known.rows }
            }
            stored @ rows::Rows::Stored { .. } => stored,
        }
    }
}
