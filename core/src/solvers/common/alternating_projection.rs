//! Alternating projection (Gerchberg-Saxton): from requested pressures to drives of |q| = 1, and back; starts.

use crate::kernels::tiles;
use crate::kernels::tiles::unit::Arc;
use crate::propagation::{Strips, field_of};
use crate::solvers::amplitude_limit::AmplitudeLimit;
use crate::solvers::prelude::*;
use crate::workspace::Aligned;

/// Alternating projections on the tiles of G: from requested pressures at the points to |q| = 1 and its field.
pub(crate) struct Projector<'w> {
    /// The requested pressures at the rows, in any unit.
    pub(crate) wanted: [Buffer<'w, f32>; 2],
    /// Working memory of the sweep.
    memory: Aligned<'w>,
}

impl<'w> Projector<'w> {
    pub(crate) fn new(rows: &Rows, work: &'w Workspace) -> Self {
        let wanted = [(); 2].map(|()| work.floats.take(rows.count));
        Self { wanted, memory: Aligned::take(tiles::unit::sweep_floats(rows.count), work) }
    }

    /// Requests p_j = a_j P_j/|P_j|: the phases of a wave's field with moduli a; phase 0 where the field is 0.
    pub(crate) fn want(&mut self, wave: &Wave, moduli: &[f32]) {
        let [re, im] = &mut self.wanted;
        let field = wave.field[0].iter().zip(&wave.field[1]).zip(&wave.moduli);
        for (((re, im), ((x, y), length)), &modulus) in re.iter_mut().zip(im).zip(field).zip(moduli) {
            let scale = if *length > 0.0 { modulus / length } else { 0.0 };
            *re = if scale > 0.0 { x * scale } else { modulus };
            *im = y * scale;
        }
    }

    /// Computes q_i = b_i/|b_i| with b = G^H p of the requested pressures p (0 where b_i is 0), and P = G q.
    pub(crate) fn project(&mut self, rows: &Rows, wave: &mut Wave) {
        let Self { wanted: [re, im], memory } = self;
        wave.set(|wave| tiles::unit::sweep(rows.set, rows.tiles(), [re, im], wave, memory));
    }

    /// Does the same as [`Projector::project`], with each q within an arc around 1.
    pub(crate) fn project_within(&mut self, rows: &Rows, arc: Arc, wave: &mut Wave) {
        let Self { wanted: [re, im], memory } = self;
        wave.set(|wave| tiles::unit::sweep_within(rows.set, rows.tiles(), [re, im], arc, wave, memory));
    }

    /// Returns the wave (drive and field) of the problem's start, or of q = 1 if it has none.
    pub(crate) fn begin(
        &mut self,
        problem: &Problem,
        rows: &Rows,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Wave<'w>> {
        Ok(self.start(problem, rows, work, control)?.unwrap_or_else(|| {
            let mut wave = Wave::new(rows, work);
            wave.play(rows, core::iter::repeat_n(Complex32::ONE, problem.propagation().transducers()));
            wave
        }))
    }

    /// Returns the wave of the problem's start: its drive as it is, or the projection of its phases with the targets as
    /// moduli. Returns `None` if the problem has no start. The rows are in the problem's order.
    pub(crate) fn start(
        &mut self,
        problem: &Problem,
        rows: &Rows,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Option<Wave<'w>>> {
        if !problem.has_start() {
            return Ok(None);
        }
        let mut wave = Wave::new(rows, work);
        if let Some(drive) = problem.start_drive() {
            wave.play(rows, drive.iter().copied());
            return Ok(Some(wave));
        }
        let phasors = start_phasors(problem, work, control)?;
        for (wanted, phasors) in self.wanted.iter_mut().zip([&phasors.re, &phasors.im]) {
            for ((wanted, phasor), target) in wanted.iter_mut().zip(phasors).zip(problem.targets()) {
                *wanted = phasor * target / rows.target;
            }
        }
        self.project(rows, &mut wave);
        Ok(Some(wave))
    }
}

/// Returns the unit phasors at the points of a problem's start; 1 if it has none, or where the pressure is 0.
pub(crate) fn start_phasors<'w>(problem: &Problem, work: &'w Workspace, control: &mut Control) -> Result<Planar<'w>> {
    let propagation = problem.propagation();
    let mut phasors = Planar::zeros(1, propagation.lanes(), work);
    phasors.re[..propagation.points()].fill(1.0);
    if let Some(phases) = problem.start_phases() {
        for (j, phase) in phases.enumerate() {
            (phasors.re[j], phasors.im[j]) = (math::cos(phase) as f32, math::sin(phase) as f32);
        }
    }
    if let Some(drive) = problem.start_drive() {
        let field = field_of(propagation, drive, work, control)?;
        for j in 0..propagation.points() {
            (phasors.re[j], phasors.im[j]) = math::unit(field.re[j], field.im[j]);
        }
    }
    Ok(phasors)
}

/// Creates a solver's solution q_i = `factor`_i sum_j conj(G_ji) x_j within the `limit`. `ended` is its status and the
/// number of steps taken, of `steps`.
#[allow(clippy::too_many_arguments, reason = "what every solver ends with, and what it wants")]
pub(crate) fn back_projected(
    problem: &Problem,
    mut strips: Strips<'_>,
    wanted: &Planar,
    factor: impl Fn(usize) -> f32,
    limit: AmplitudeLimit,
    (ended, steps): ((Status, usize), usize),
    work: &Workspace,
    control: &mut Control,
) -> Result<Solution> {
    let propagation = problem.propagation();
    let mut parts = strips.back_project(wanted, control)?;
    for part in &mut parts {
        part.iter_mut().enumerate().for_each(|(i, x)| *x *= factor(i));
    }
    limit.apply(propagation.instruction_set(), parts.each_mut().map(|part| &mut part[..]));
    let field = strips.field(&mut parts, control)?;
    let mut drive = work.complexes.empty(propagation.transducers());
    drive.extend(
        parts[0].iter().zip(&parts[1]).map(|(&re, &im)| Complex32::new(re, im)).take(propagation.transducers()),
    );
    let mut solution = Solution::of_field(problem, drive, &field, ended.0, ended.1, work, control)?;
    solution.tell(problem, steps, control);
    Ok(solution)
}

#[cfg(test)]
#[path = "tests/alternating_projection.rs"]
mod tests;
