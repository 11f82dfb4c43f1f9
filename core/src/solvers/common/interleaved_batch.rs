//! Interleaved batch: up to 16 problems of one array, one in each SIMD lane.

use core::array;

use crate::kernels::closed_form::interleaved_sweep::{EIGHT, deal_in, deal_out};
use crate::kernels::propagate::field::interleaved_field;
use crate::kernels::{ControlPoints, Rows, Run, interleaved_moduli};
use crate::propagation::Sources;
use crate::propagation::reach::NEAR;
use crate::solvers::prelude::*;

/// The control points of up to 16 problems of one model: a lane group for each point, a lane for each problem.
pub(crate) struct InterleavedPoints<'w> {
    prepared: Arc<Sources>,
    pub(crate) set: InstructionSet,
    coordinates: [Buffer<'w, f32>; 3],
}

impl<'w> InterleavedPoints<'w> {
    /// Creates the points of some problems. Returns `None` if there are fewer problems than points: a point takes a
    /// lane group here, and a problem that is solved alone takes at least one.
    fn of(problems: &[Problem], work: &'w Workspace) -> Option<Self> {
        let first = problems.first()?.propagation();
        let (prepared, _) = first.computed()?;
        let points = problems.iter().map(|problem| problem.propagation().points()).max()?;
        if problems.len() > LANES || points > problems.len() {
            return None;
        }
        let mut coordinates = [(); 3].map(|()| work.floats.take(points * LANES));
        // A lane without a problem repeats the last problem, a problem of fewer points its last point. So no unused
        // lane is at a transducer.
        for lane in 0..LANES {
            let (own, points) = problems[lane.min(problems.len() - 1)].propagation().computed()?;
            if !Arc::ptr_eq(own, prepared) {
                return None;
            }
            for (list, lanes) in points.coordinates.into_iter().zip(&mut coordinates) {
                deal(list, lane, lanes);
            }
        }
        Some(Self { prepared: Arc::clone(prepared), set: first.instruction_set(), coordinates })
    }

    /// Returns the rows of G at these points.
    pub(crate) fn rows(&self) -> Rows<'_> {
        let Sources { radiation, transducers, .. } = &*self.prepared;
        Rows::Computed { radiation, sources: transducers, control_points: self.control_points(), amplitudes: &[] }
    }

    fn control_points(&self) -> ControlPoints<'_> {
        let [x, y, z] = &self.coordinates;
        ControlPoints { coordinates: [x, y, z], count: self.lanes() }
    }

    /// Returns the length of a row: 16 times the largest number of points.
    fn lanes(&self) -> usize {
        self.coordinates[0].len()
    }
}

/// The lists of an interleaved batch that solvers use. Drives have two lane groups for each transducer: real and
/// imaginary parts.
pub(crate) struct InterleavedBatch<'w> {
    pub(crate) points: InterleavedPoints<'w>,
    pub(crate) target: Buffer<'w, f32>,
    pub(crate) weight: Buffer<'w, f32>,
    pub(crate) drives: Buffer<'w, f32>,
    pub(crate) pressures: [Buffer<'w, f32>; 2],
}

impl<'w> InterleavedBatch<'w> {
    /// Creates the lists of some problems with drives of 0, or returns `None` where [`InterleavedPoints::of`] does.
    pub(crate) fn of(problems: &[Problem], work: &'w Workspace) -> Option<Self> {
        let points = InterleavedPoints::of(problems, work)?;
        let [mut target, mut weight, re, im] = [(); 4].map(|()| work.floats.take(points.lanes()));
        for (lane, problem) in problems.iter().enumerate() {
            deal(problem.targets(), lane, &mut target);
            deal(problem.weights(), lane, &mut weight);
        }
        let padded = points.prepared.transducers.len().next_multiple_of(EIGHT);
        let drives = work.floats.take(2 * LANES * padded);
        Some(Self { points, target, weight, drives, pressures: [re, im] })
    }

    /// Returns the solution of each problem, with all steps done.
    pub(crate) fn solutions(self, problems: &[Problem], steps: usize, work: &Workspace) -> Option<Vec<Solution>> {
        let count = self.points.prepared.transducers.len();
        let mut drives = array::from_fn(|_| work.complexes.empty(count.next_multiple_of(EIGHT)));
        deal_out(self.points.set, &self.drives, &mut drives);
        let mut drives = drives.into_iter();
        let solution = |((lane, problem), mut drive): ((usize, &Problem), Vec<Complex32>)| {
            drive.truncate(count);
            let mut field = Planar::zeros(1, problem.propagation().lanes(), work);
            for (own, all) in [&mut field.re, &mut field.im].into_iter().zip(&self.pressures) {
                own.iter_mut().zip(all.as_chunks::<LANES>().0).for_each(|(own, all)| *own = all[lane]);
            }
            Solution::of_field(problem, drive, &field, Status::Done, steps, work, &mut Control::none()).ok()
        };
        let mut solutions = Vec::with_capacity(problems.len());
        solutions.extend(problems.iter().enumerate().zip(&mut drives).map_while(solution));
        drives.for_each(|unused| work.complexes.give(unused));
        (solutions.len() == problems.len()).then_some(solutions)
    }
}

/// Sums |G| at the points of some problems, bit for bit as [`Problem::sum_moduli`] does. Returns false if a point may
/// be at a transducer; the caller then uses another method.
pub(crate) fn sum_moduli(problems: &mut [Problem], work: &Workspace) -> bool {
    let Some(points) = InterleavedPoints::of(problems, work) else { return false };
    problems.iter_mut().for_each(Problem::clear_reach);
    let mut sums = work.floats.take(points.lanes());
    let mut near = false;
    let Sources { radiation, transducers, .. } = &*points.prepared;
    for run in Run::all(radiation, transducers) {
        near |= interleaved_moduli(points.set, &run, points.control_points(), NEAR, &mut sums, &mut []);
        for (lane, problem) in problems.iter_mut().enumerate() {
            for (reach, sums) in problem.reach.iter_mut().zip(sums.as_chunks::<LANES>().0) {
                *reach += f64::from(sums[lane]);
            }
        }
    }
    !near
}

/// Returns P = G q of the drives of some problems, given one after another, in units of the reference: a lane group for
/// each point, a lane for each problem. The bits are those of [`crate::propagation::field_of`]. Returns `None` if that
/// saves no work.
pub(crate) fn fields<'w>(
    problems: &[Problem],
    drives: &[Complex32],
    work: &'w Workspace,
) -> Option<[Buffer<'w, f32>; 2]> {
    let points = InterleavedPoints::of(problems, work)?;
    let Sources { radiation, transducers, .. } = &*points.prepared;
    let mut lanes = work.floats.take_any(2 * LANES * transducers.len().next_multiple_of(EIGHT));
    deal_in(points.set, drives, transducers.len(), &mut lanes);
    let mut field = [(); 2].map(|()| work.floats.take(points.lanes()));
    let out = field.each_mut().map(|part| &mut part[..]);
    interleaved_field(points.set, radiation, transducers, &lanes, points.control_points(), out);
    Some(field)
}

/// Writes a problem's list into its lane.
fn deal(list: &[f32], lane: usize, lanes: &mut [f32]) {
    for (group, &x) in lanes.as_chunks_mut::<LANES>().0.iter_mut().zip(list) {
        group[lane] = x;
    }
}
