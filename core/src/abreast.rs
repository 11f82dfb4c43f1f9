//! Problems of few points side by side: problem b in lane b, a group of lanes a point.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::array;

use crate::emitters::Emitters;
use crate::gains::{NEAR, TOGETHER};
use crate::kernels::{LANES, Level, Rows, Spots, add_moduli};
use crate::problem::Problem;
use crate::workspace::Workspace;

/// The points of up to 16 problems of one transmitter, point after point.
pub(crate) struct Abreast {
    emitters: Arc<Emitters>,
    pub(crate) level: Level,
    places: [Vec<f32>; 3],
}

impl Abreast {
    /// The points of weight above 0 of some problems, where that saves work: a point costs a group of lanes here, as a
    /// lone problem does.
    pub(crate) fn of(problems: &[Problem], work: &mut Workspace) -> Option<Self> {
        let first = problems.first()?.gains();
        let (emitters, _) = first.computed()?;
        let points = problems.iter().map(|problem| problem.gains().points()).max()?;
        if problems.len() > LANES || points > problems.len() {
            return None;
        }
        let mut places = [(); 3].map(|()| work.floats.take(points * LANES));
        // A lane without a problem repeats the last one, a problem of fewer points its last point: far from a transducer.
        for lane in 0..LANES {
            let gains = problems[lane.min(problems.len() - 1)].gains();
            let (own, spots) = gains.computed()?;
            if !Arc::ptr_eq(own, emitters) {
                return None;
            }
            for (list, places) in spots.coordinates.into_iter().zip(&mut places) {
                deal(list, lane, places);
            }
        }
        Some(Self { emitters: Arc::clone(emitters), level: first.level(), places })
    }

    /// Rows of G at these points.
    pub(crate) fn rows(&self) -> Rows<'_> {
        Rows::Computed { law: &self.emitters.law, sources: &self.emitters.sources, spots: self.spots() }
    }

    fn spots(&self) -> Spots<'_> {
        let [x, y, z] = &self.places;
        Spots { coordinates: [x, y, z], count: self.lanes() }
    }

    /// Length of a row: 16 times the largest number of points.
    pub(crate) fn lanes(&self) -> usize {
        self.places[0].len()
    }

    /// Gives the memory back.
    pub(crate) fn give(self, work: &mut Workspace) {
        work.floats.give_all(self.places);
    }
}

/// Sums |G| at the points of some problems, each bit for bit as [`Problem::measure`] does. Whether that was possible: it
/// is not where a point may lie on a transducer, which is then to be looked at more closely.
pub(crate) fn measure(problems: &mut [Problem], work: &mut Workspace) -> bool {
    let Some(abreast) = Abreast::of(problems, work) else { return false };
    let mut others = problems.iter_mut();
    let mut reaches: [Option<&mut Vec<f64>>; LANES] =
        array::from_fn(|_| others.next().map(Problem::cleared_reach));
    let mut sums = work.floats.take(abreast.lanes());
    let mut near = false;
    for sources in abreast.emitters.sources.chunks(TOGETHER) {
        sums.fill(0.0);
        near |= add_moduli(abreast.level, &abreast.emitters.law, sources, abreast.spots(), NEAR, &mut sums);
        for (lane, reach) in reaches.iter_mut().flatten().enumerate() {
            for (reach, sums) in reach.iter_mut().zip(sums.as_chunks::<LANES>().0) {
                *reach += f64::from(sums[lane]);
            }
        }
    }
    work.floats.give(sums);
    abreast.give(work);
    !near
}

/// Writes a problem's list into its lane.
pub(crate) fn deal(list: &[f32], lane: usize, lanes: &mut [f32]) {
    for (group, &x) in lanes.as_chunks_mut::<LANES>().0.iter_mut().zip(list) {
        group[lane] = x;
    }
}
