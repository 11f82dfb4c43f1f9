//! Interleaved batch: up to 16 problems of one array, one per SIMD lane.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::array;

use crate::kernels::closed_form::interleaved::{EIGHT, deal_out};
use crate::kernels::{ControlPoints, InstructionSet, LANES, Rows, add_moduli};
use crate::linalg::Planar;
use crate::problem::{Problem, Solution, Status};
use crate::propagation::Sources;
use crate::propagation::{NEAR, TOGETHER};
use crate::workspace::{Buffer, Workspace};

/// The points of up to 16 problems of one model, point after point.
pub(crate) struct Abreast<'w> {
    prepared: Arc<Sources>,
    pub(crate) set: InstructionSet,
    places: [Buffer<'w, f32>; 3],
}

impl<'w> Abreast<'w> {
    /// The points of weight above 0 of some problems, where that saves work: a point costs a group of lanes here, as a
    /// lone problem does.
    fn of(problems: &[Problem], work: &'w Workspace) -> Option<Self> {
        let first = problems.first()?.propagation();
        let (prepared, _) = first.computed()?;
        let points = problems.iter().map(|problem| problem.propagation().points()).max()?;
        if problems.len() > LANES || points > problems.len() {
            return None;
        }
        let mut places = [(); 3].map(|()| work.floats.take(points * LANES));
        // A lane without a problem repeats the last one, a problem of fewer points its last point: far from a transducer.
        for lane in 0..LANES {
            let propagation = problems[lane.min(problems.len() - 1)].propagation();
            let (own, control_points) = propagation.computed()?;
            if !Arc::ptr_eq(own, prepared) {
                return None;
            }
            for (list, places) in control_points.coordinates.into_iter().zip(&mut places) {
                deal(list, lane, places);
            }
        }
        Some(Self { prepared: Arc::clone(prepared), set: first.instruction_set(), places })
    }

    /// Rows of G at these points.
    pub(crate) fn rows(&self) -> Rows<'_> {
        Rows::Computed {
            law: &self.prepared.law,
            sources: &self.prepared.sources,
            control_points: self.control_points(),
        }
    }

    fn control_points(&self) -> ControlPoints<'_> {
        let [x, y, z] = &self.places;
        ControlPoints { coordinates: [x, y, z], count: self.lanes() }
    }

    /// Length of a row: 16 times the largest number of points.
    fn lanes(&self) -> usize {
        self.places[0].len()
    }
}

/// What solvers of problems abreast work on. Drives have two groups of lanes a transducer, re and im.
pub(crate) struct Together<'w> {
    pub(crate) abreast: Abreast<'w>,
    pub(crate) target: Buffer<'w, f32>,
    pub(crate) weight: Buffer<'w, f32>,
    pub(crate) drives: Buffer<'w, f32>,
    pub(crate) pressures: [Buffer<'w, f32>; 2],
}

impl<'w> Together<'w> {
    /// Some problems, silent, where [`Abreast::of`] has them.
    pub(crate) fn of(problems: &[Problem], work: &'w Workspace) -> Option<Self> {
        let abreast = Abreast::of(problems, work)?;
        let lanes = abreast.lanes();
        let [mut target, mut weight] = [(); 2].map(|()| work.floats.take(lanes));
        for (lane, problem) in problems.iter().enumerate() {
            deal(problem.targets(), lane, &mut target);
            deal(problem.weights(), lane, &mut weight);
        }
        let padded = abreast.prepared.sources.len().next_multiple_of(EIGHT);
        let drives = work.floats.take(2 * LANES * padded);
        let pressures = [(); 2].map(|()| work.floats.take(lanes));
        Some(Self { abreast, target, weight, drives, pressures })
    }

    /// Each problem's solution, all done; gives the memory back.
    pub(crate) fn solutions(self, problems: &[Problem], steps: usize, work: &Workspace) -> Vec<Solution> {
        let Self { abreast, drives, pressures: [re, im], .. } = self;
        let count = abreast.prepared.sources.len();
        let mut own = array::from_fn(|_| work.complexes.empty(count.next_multiple_of(EIGHT)));
        deal_out(abreast.set, &drives, &mut own);
        let mut own = own.into_iter();
        let solutions = problems.iter().enumerate().zip(&mut own).map(|((lane, problem), mut drive)| {
            drive.truncate(count);
            let mut field = Planar::zeros(1, problem.propagation().lanes(), work);
            for (own, all) in [(&mut field.re, &re), (&mut field.im, &im)] {
                own.iter_mut().zip(all.as_chunks::<LANES>().0).for_each(|(own, all)| *own = all[lane]);
            }
            Solution::of_field(problem, drive, &field, Status::Done, steps, work)
        });
        let solutions = solutions.collect();
        own.for_each(|list| work.complexes.give(list));
        solutions
    }
}

/// Sums |G| at the points of some problems, each bit for bit as [`Problem::sum_moduli`] does. Whether that was possible: it
/// is not where a point may lie on a transducer, which is then to be looked at more closely.
pub(crate) fn sum_moduli(problems: &mut [Problem], work: &Workspace) -> bool {
    let Some(abreast) = Abreast::of(problems, work) else { return false };
    let mut others = problems.iter_mut();
    let mut reaches: [Option<&mut Vec<f64>>; LANES] = array::from_fn(|_| others.next().map(Problem::cleared_reach));
    let mut sums = work.floats.take(abreast.lanes());
    let mut near = false;
    for sources in abreast.prepared.sources.chunks(TOGETHER) {
        sums.fill(0.0);
        near |= add_moduli(abreast.set, &abreast.prepared.law, sources, abreast.control_points(), NEAR, &mut sums);
        for (lane, reach) in reaches.iter_mut().flatten().enumerate() {
            for (reach, sums) in reach.iter_mut().zip(sums.as_chunks::<LANES>().0) {
                *reach += f64::from(sums[lane]);
            }
        }
    }
    !near
}

/// Writes a problem's list into its lane.
fn deal(list: &[f32], lane: usize, lanes: &mut [f32]) {
    for (group, &x) in lanes.as_chunks_mut::<LANES>().0.iter_mut().zip(list) {
        group[lane] = x;
    }
}
