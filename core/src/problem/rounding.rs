//! Rounding: lowers a solution to its targets, and rounds its drives to what the board can play.

use crate::kernels;
use crate::linalg::Planar;
use crate::prelude::*;
use crate::problem::Problem;
use crate::problem::mix::{ALIKE, mix};
use crate::problem::solution::{Solution, divided};
use crate::problem::status::Status;
use crate::propagation::field_of;
use crate::workspace::Workspace;

impl Solution {
    /// Lowers the full drives of a problem to the part `factor` by a mix of two amplitudes of its board, if that is more
    /// accurate than one amplitude; else returns `None`. `field` is the field of the drives at the problem's points, if it is
    /// known.
    pub(crate) fn mixed<'w>(
        problem: &Problem,
        drive: &mut Vec<Complex32>,
        (factor, field): (f64, Option<Planar<'w>>),
        (status, steps): (Status, usize),
        work: &'w Workspace,
        control: &mut Control,
    ) -> Option<Self> {
        let request = Arc::clone(&problem.targets);
        let whole = !problem.is_stretched() && request.active.len() == request.pascals.len();
        let field = mix(&request, drive, 1.0, factor, field.filter(|_| whole), work, control)?;
        Some(Self::with_pressures(request, core::mem::take(drive), &field, status, steps, work))
    }

    /// Marks all drives as drives that the board can play. Boards with ticks of unequal length are an exception: their pulses
    /// are still rounded at the end.
    pub(crate) fn on_grid(self) -> Self {
        let on_grid = self.request.setup.quantization.as_deref().is_none_or(|board| board.uneven().is_none());
        Self { on_grid, ..self }
    }

    /// Divides drives and pressures by `factor`, which is at least 1, and rounds each drive to one that the board can play.
    /// Returns whether a drive changed.
    ///
    /// # Errors
    /// A stop by the caller, unless it was noticed before.
    pub(crate) fn quantize(&mut self, factor: f64, work: &Workspace, control: &mut Control) -> Result<bool, Error> {
        let Some(quantization) = self.request.setup.quantization.as_deref() else {
            if factor > 1.0 {
                for list in [&mut self.drive, &mut self.pressures] {
                    for z in list {
                        *z = divided(*z, factor);
                    }
                }
            }
            return Ok(false);
        };
        if self.on_grid && factor == 1.0 {
            return Ok(false);
        }
        let set = self.request.propagation.instruction_set();
        let [least, largest] = kernels::grid::range(set, &self.drive);
        let of_one = self.request.given && least > largest * (1.0 - ALIKE);
        let largest = f64::from(largest) / factor;
        let scale = quantization.scale(largest);
        // Pulses of equal ticks include all phases and amplitudes of the grid. If full drives are lowered, they are rounded to
        // the grid below, because its phases are possible at every amplitude.
        let lowered = self.on_grid || of_one && quantization.between(largest).is_some();
        if let Some(pulses) = if lowered { quantization.uneven() } else { quantization.pulses() } {
            let stayed = pulses.round((factor * scale) as f32, &mut self.drive);
            self.scale *= scale;
            if !stayed {
                self.set_pressures(&field_of(&self.request.propagation, &self.drive, work, control)?);
            }
            return Ok(!stayed);
        }
        // If all drives had full amplitude and phases of the board, they now have one common amplitude: the field is only
        // scaled.
        let most = (largest / scale) as f32;
        let common = quantization.nearest(Complex32::new(most, 0.0)).re;
        let alike = quantization.grid().round(set, (factor * scale) as f32, [most, common], &mut self.drive);
        let q = f64::from(common);
        let known = (alike && of_one).then(|| self.field(q, work));
        self.scale *= scale;
        let mixed = if of_one { mix(&self.request, &mut self.drive, q, largest, known, work, control) } else { None };
        if let Some(field) = &mixed {
            self.set_pressures(field);
        } else if !alike {
            self.set_pressures(&field_of(&self.request.propagation, &self.drive, work, control)?);
        } else if common != 1.0 || scale != 1.0 {
            let change = f64::from(common) * scale;
            self.pressures.iter_mut().for_each(|p| *p = divided(*p, 1.0 / change));
        }
        Ok(mixed.is_some() || !alike || common != 1.0)
    }

    /// Returns the field of the solution's pressures multiplied by `times`, in units of the reference: one padded row.
    fn field<'w>(&self, times: f64, work: &'w Workspace) -> Planar<'w> {
        let propagation = &self.request.propagation;
        let mut field = Planar::zeros(1, propagation.lanes(), work);
        let unit = propagation.reference() * self.scale / times;
        for (pressure, (re, im)) in self.pressures.iter().zip(field.re.iter_mut().zip(&mut *field.im)) {
            let relative = divided(*pressure, unit);
            (*re, *im) = (relative.re, relative.im);
        }
        field
    }
}
