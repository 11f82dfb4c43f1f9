//! Coordinate descent: improves a drive by replacing one transducer after another.
//!
//! ```text
//! P = G q of the first drive q
//! for each sweep, for each transducer i in order:
//!     P -= G_i q_i
//!     q_i = argmin of eq. (7) over the candidates whose phase is within `change` of that of the last q_i
//!     P += G_i q_i
//! ```
//!
//! Suppose that a transducer with a small range of phases chose its phase while the later transducers are silent. Its
//! choice would not include their waves, and all transducers would end at an end of their range. Here each choice
//! includes the waves of all other transducers; those not yet replaced have their old drives. After a pass that begins
//! in silence, further sweeps update the first transducers again, with all waves known.

use crate::kernels;
use crate::kernels::greedy::candidates::Term;
use crate::kernels::{Candidates, PhaseRange, PointGroup};
use crate::math::{atan2, ceil, floor, modulus, round};
use crate::propagation::field_of;
use crate::solvers::prelude::*;

/// Largest distance in turns between a phase on a grid and its value in f32.
const ROUNDING: f64 = 3e-8;

/// Allowance in steps where the bound is a whole number of phase steps: the rounding of `change`.
const STEP_ROUNDING: f64 = 1e-9;

/// Parameters of the sweeps over all transducers.
pub(crate) struct CoordinateDescent<'a> {
    pub(crate) candidates: &'a Candidates,
    /// The transducers in the order of their updates.
    pub(crate) order: &'a [u32],
    /// The largest change of a phase from the last drive, in rad.
    pub(crate) change: f64,
    pub(crate) sweeps: usize,
}

impl CoordinateDescent<'_> {
    /// Returns the drive that follows `last`, which is first rounded to the device's grid. A drive without a candidate
    /// within the bound stays. A drive of 0 has no phase and may take any. The time is O(N M) times the candidates
    /// within the bound, the memory O(N + M).
    pub(crate) fn solve<T: Term>(
        &self,
        problem: &Problem,
        last: &[Complex32],
        work: &Workspace,
        control: &mut Control,
    ) -> Result<Solution> {
        let propagation = problem.propagation();
        let (set, lanes, phases) = (propagation.instruction_set(), propagation.lanes(), self.candidates.phases);
        let mut grid = phases;
        let mut drive = work.complexes.take(last.len());
        drive.copy_from_slice(last);
        if let Some(quantization) = problem.quantization() {
            quantization.grid().round(set, 1.0, [1.0; 2], &mut drive);
            grid = quantization.phases().map_or(phases, |phases| phases as usize);
        }
        // When the last solution was balanced, its drives were divided by the problem's factor: this is undone.
        for q in drive.iter_mut().filter(|_| problem.factor() > 1.0) {
            *q *= problem.factor().min(1.0 / modulus(*q)) as f32;
        }
        let mut begin = work.complexes.take(last.len());
        begin.copy_from_slice(&drive);
        let mut field = field_of(propagation, &drive, work, control)?;
        let mut points = work.points.take(lanes / LANES);
        kernels::keep(set, [problem.targets(), problem.weights()], field.row(0), &mut points);
        let steps = [0, self.sweeps * last.len()];
        let ranges = |i: usize| within(begin[i], self.change, phases, grid);
        let (status, updates) = self.sweep::<T>(problem, &mut drive, &mut points, ranges, steps, work, control);
        collect(&points, &mut field);
        // All drives are on the device's grid: the first ones were rounded to it, and the candidates are on it.
        Ok(Solution::of_field(problem, drive.into_vec(), &field, status, updates, work, control)?.on_grid())
    }

    /// Sweeps over a drive whose field is in `points`: each transducer takes the best candidate of its range. The two
    /// step counts are the number of updates done before and the number of all updates. Returns the number of updates
    /// done afterwards.
    #[allow(clippy::too_many_arguments, reason = "a drive, its field, and the report to a control")]
    pub(crate) fn sweep<T: Term>(
        &self,
        problem: &Problem,
        drive: &mut [Complex32],
        points: &mut [PointGroup],
        range: impl Fn(usize) -> Option<PhaseRange>,
        [mut updates, all]: [usize; 2],
        work: &Workspace,
        control: &mut Control,
    ) -> (Status, usize) {
        let propagation = problem.propagation();
        let (set, count) = (propagation.instruction_set(), propagation.points());
        let mut row = Planar::zeros(1, propagation.lanes(), work);
        for &i in (0..self.sweeps).flat_map(|_| self.order) {
            let i = i as usize;
            propagation.row(i, &mut row.re, &mut row.im);
            let (present, range) = ([drive[i].re, drive[i].im], range(i));
            let [re, im] = kernels::replace::<T>(set, row.row(0), present, self.candidates, range, points, count);
            drive[i] = Complex32::new(re, im);
            updates += 1;
            if control.step(updates, all, || problem.residual_of(moduli(points))).is_break() {
                return (Status::Stopped, updates);
            }
        }
        (Status::Done, updates)
    }
}

/// Copies the pressures of the points from their groups to a field.
pub(crate) fn collect(points: &[PointGroup], field: &mut Planar<'_>) {
    let pressures = field.re.chunks_exact_mut(LANES).zip(field.im.chunks_exact_mut(LANES));
    for (group, (re, im)) in points.iter().zip(pressures) {
        re.copy_from_slice(&group.re);
        im.copy_from_slice(&group.im);
    }
}

/// Returns |P| at the points, and 0 for the padding.
pub(crate) fn moduli(points: &[PointGroup]) -> impl Iterator<Item = f64> + Clone {
    let pressures = points.iter().flat_map(|group| group.re.into_iter().zip(group.im));
    pressures.map(|(re, im)| modulus(Complex32::new(re, im)))
}

/// Returns the phases 2 pi l/L, L = `phases`, within `change` rad of the phase of q, the nearest first; `None` if there
/// are none. For q = 0 it returns all phases. The device's grid has `grid` phases, among them these L. If the phase of
/// q is on this grid, the comparison is in whole steps.
fn within(q: Complex32, change: f64, phases: usize, grid: usize) -> Option<PhaseRange> {
    if q == Complex32::ZERO {
        return Some(PhaseRange::whole(phases));
    }
    let (turns, grid, count) = (atan2(q.im.into(), q.re.into()) / TAU, grid as f64, phases as f64);
    let known = round(turns * grid) / grid;
    let on_grid = (turns - known).abs() <= ROUNDING;
    let (present, slack) = if on_grid { (known * count, STEP_ROUNDING) } else { (turns * count, ROUNDING * count) };
    let reach = (change / TAU * count).min(count) + slack;
    let [low, nearest, high] = [ceil(present - reach), round(present), floor(present + reach)];
    if low > high {
        return None;
    }
    let from = (nearest as i64).rem_euclid(phases as i64) as usize;
    let [below, above] = [nearest - low, high - nearest].map(|steps| steps as usize);
    if below + above < phases {
        Some(PhaseRange { from, above, below })
    } else {
        Some(PhaseRange { from, ..PhaseRange::whole(phases) })
    }
}
