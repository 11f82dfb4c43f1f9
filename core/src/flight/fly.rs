//! Fly: simulates beads in the traps of a sequence; which beads are lost, and when.

use alloc::collections::BTreeMap;
use core::array;

use crate::control::bytes;
use crate::error::one_each;
use crate::flight::around::{Around, Polynomial};
use crate::flight::course::Course;
use crate::flight::dynamics::{Flight, Force, State, begun, continued};
use crate::prelude::*;
use crate::propagation::Model;
use crate::scene::geometry::check_finite;
use crate::scene::{Bead, distance};

/// Largest phase in rad that the fastest oscillation advances per step. Its frequency then has an error of 1e-4.
const ANGLE: f64 = 0.3;

/// The largest share of a bead's velocity that drag may take in a step.
const DRAGGED: f64 = 0.1;

/// Number of knots (interpolation nodes in time) whose forces are computed together, as one block.
const KNOTS: usize = 1024;
/// Number of blocks that are stored for later laps: about 500 MB, in a browser 80 MB.
const STORED: usize = if cfg!(target_arch = "wasm32") { 5 } else { 32 };

/// Largest number of knots that are simulated in one call.
const FLOWN: usize = 8192;
/// Largest number of further knots in a call after a bead has left its cell, because it may soon be lost.
const SOON: usize = 16;

/// Distance between neighbouring cells, in radii of a cell, so that every place lies well inside of a cell.
const LATTICE: f64 = 0.8;

/// A bead farther than this from its point, in wavelengths, is lost: it is in another node or outside of the field.
const LOST: f64 = 0.5;

/// Number of beads that are simulated together.
const LANES: usize = 8;

/// x, y and z of eight beads.
type Vectors = [[f64; LANES]; 3];

/// A bead at the start of a flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeadStart {
    /// The place of the bead in m.
    pub place: [f64; 3],
    /// The velocity of the bead in m/s.
    pub speed: [f64; 3],
    /// The index of the point in whose trap the bead is.
    pub point: usize,
}

/// The tracks of simulated beads.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Flown {
    /// Places (K, B, 3) in m at the knots; NaN after a bead was lost.
    pub places: Vec<[f64; 3]>,
    /// Places (K, B, 3) in m of the points in whose traps the beads are.
    pub points: Vec<[f64; 3]>,
    /// Time (B,) in s at which each bead was lost; NaN for a bead that was not lost.
    pub lost: Vec<f64>,
}

impl Flown {
    /// Returns the largest distance (B,) in m of each bead from its point until it is lost.
    pub fn farthest(&self) -> Vec<f64> {
        let mut farthest = vec![0.0_f64; self.lost.len()];
        for row in self.places.chunks(farthest.len()).zip(self.points.chunks(farthest.len())) {
            let apart = row.0.iter().zip(row.1).map(|(&place, &point)| distance(place, point));
            // The distance of a lost bead is NaN, which `max` skips.
            farthest.iter_mut().zip(apart).for_each(|(most, apart)| *most = most.max(apart));
        }
        farthest
    }
}

impl Course {
    /// Simulates beads (B,) for a number of knots. Each bead obeys m x'' = F + weight - buoyancy - drag, with the
    /// force F of sound in the field at that time. A bead that is more than half a wavelength from its point is lost.
    ///
    /// # Errors
    /// A place that is not finite, no bead, fewer than two knots; a bead that reaches a place which [`crate::field()`]
    /// rejects; a stop.
    pub fn fly(
        &self,
        model: &Model,
        bead: Bead,
        beads: &[BeadStart],
        knots: usize,
        control: &mut Control,
    ) -> Result<Flown, Error> {
        if knots < 2 || beads.is_empty() {
            return Err(Error::out_of_range("beads", beads.len(), "give at least one, and two knots"));
        }
        let points: Vec<usize> = beads.iter().map(|start| start.point).collect();
        let states: Vec<[f64; 3]> = beads.iter().flat_map(|start| [start.place, start.speed]).collect();
        check_finite("beads", &states)?;
        one_each("drives", model.array().len(), "transducers", self.drive(0).len(), "of the course")?;
        control.room("the tracks of beads", [model.array().len(), knots], bytes(48, &[knots, beads.len()]))?;
        let around = Around::new(model, bead.particle);
        let mut flown = Flown {
            places: vec![[f64::NAN; 3]; knots * beads.len()],
            points: self.ways(knots, &points),
            lost: vec![f64::NAN; beads.len()],
        };
        for (first, some) in (0..).step_by(LANES).zip(beads.chunks(LANES)) {
            Group::new(self, &around, model, bead, some, knots, control)?.fly(&mut flown, first, control)?;
        }
        Ok(flown)
    }
}

/// Index of each bead's cell in the lattice of cells around its point; `None` in a lane without a bead, and
/// for a lost bead.
type Cells = [Option<[i32; 3]>; LANES];

/// Knots of a lap whose forces are computed together.
#[derive(Clone, Copy)]
struct Stretch {
    first: usize,
    count: usize,
}

/// Forces (K,) at the knots of a stretch, and centres (S, 3) of the cells at the steps.
struct Solved {
    forces: Vec<Force>,
    centres: Vec<Vectors>,
}

/// Up to eight beads that are simulated together, each in a cell: a ball that moves with the bead's point.
struct Group<'a> {
    course: &'a Course,
    around: &'a Around<'a>,
    model: &'a Model,
    flight: Flight,
    points: Vec<usize>,
    /// The number of knots of a lap, or the last knot of the flight if the flight is shorter.
    end: usize,
    cells: Cells,
    stored: BTreeMap<(usize, Cells), Solved>,
    state: State,
}

impl<'a> Group<'a> {
    fn new(
        course: &'a Course,
        around: &'a Around<'a>,
        model: &'a Model,
        Bead { particle, gravity }: Bead,
        beads: &[BeadStart],
        knots: usize,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let each = |of: fn(&BeadStart) -> [f64; 3]| {
            [0, 1, 2].map(|axis| array::from_fn(|lane| beads.get(lane).map_or(0.0, |bead| of(bead)[axis])))
        };
        let state = begun(each(|bead| bead.place), each(|bead| bead.speed));
        let unit = around.unit;
        let mut group = Self {
            course,
            around,
            model,
            flight: Flight { particle, gravity, step: course.spacing(), steps: 1, unit },
            points: beads.iter().map(|bead| bead.point).collect(),
            end: course.lap().min(knots - 1),
            cells: array::from_fn(|lane| (lane < beads.len()).then_some([0; 3])),
            stored: BTreeMap::new(),
            state,
        };
        group.settle(&group.centres(Stretch { first: 0, count: 0 })[0]);
        let first = group.stretch(0);
        let solved = group.solve(first, control)?;
        let steps = group.fine(&solved.forces);
        group.flight = Flight { step: course.spacing() / steps as f64, steps, ..group.flight };
        let centres = group.centres(first);
        // The first knot is in the middle of the first part of a frame. A step from the start leads there.
        let steps = math::ceil(course.time(0.0) / group.flight.step).max(1.0) as usize;
        let lead = Flight { step: course.time(0.0) / steps as f64, steps, ..group.flight };
        let reach = group.cells.map(|cell| if cell.is_some() { unit } else { f64::NAN });
        let (forces, still) = (vec![solved.forces[0]; 2], vec![centres[0]; steps + 1]);
        let mut places = [group.state[0]; 2];
        lead.fly(model.set, model.medium(), &mut group.state, reach, &forces, &still, 0, &mut places, control)?;
        group.state = continued(group.state);
        group.stored.insert((first.first, group.cells), Solved { centres, ..solved });
        Ok(group)
    }

    /// Simulates the beads of this group, the first of which is bead `bead` of the flight. Writes their places, and the times
    /// at which beads are lost.
    fn fly(&mut self, flown: &mut Flown, bead: usize, control: &mut Control) -> Result<(), Error> {
        let (count, most) = (flown.lost.len(), LOST * self.model.medium().wavelength());
        let last = flown.points.len() / count - 1;
        let mut first = 0;
        while first < last && self.cells.iter().any(Option::is_some) {
            let places = self.through(first, last - first, control)?;
            for lane in 0..self.points.len() {
                for (knot, all) in (first..).zip(&places) {
                    let (place, at) = (of(all, lane), knot * count + bead + lane);
                    if self.cells[lane].is_some() && distance(place, flown.points[at]) > most {
                        flown.lost[bead + lane] = self.course.time(knot as f64);
                        self.cells[lane] = None;
                    }
                    flown.places[at] = if self.cells[lane].is_some() { place } else { [f64::NAN; 3] };
                }
            }
            first += places.len() - 1;
        }
        Ok(())
    }

    /// Returns the stretch that contains a knot.
    fn stretch(&self, knot: usize) -> Stretch {
        let first = knot % self.course.lap() / KNOTS * KNOTS;
        Stretch { first, count: KNOTS.min(self.end - first) }
    }

    /// Returns the places (K, 3) at the knot `first` and at up to `most` knots after it; at fewer knots if a bead has
    /// left its cell.
    fn through(&mut self, first: usize, most: usize, control: &mut Control) -> Result<Vec<Vectors>, Error> {
        let (stretch, lap, steps) = (self.stretch(first), self.course.lap(), self.flight.steps);
        let start = first % lap - stretch.first;
        // A short lap is simulated repeatedly with the same forces.
        let most = most.min(if stretch.count == lap { FLOWN } else { stretch.count - start });
        let mut places = vec![[[f64::NAN; LANES]; 3]; start + most + 1];
        places[start] = self.state[0];
        let (mut step, mut last) = (start * steps, (start + most) * steps);
        while step < last {
            if !self.stored.contains_key(&(stretch.first, self.cells)) {
                let solved = self.solve(stretch, control)?;
                if self.stored.len() >= STORED {
                    self.stored.clear();
                }
                self.stored.insert((stretch.first, self.cells), solved);
            }
            let Solved { forces, centres } = &self.stored[&(stretch.first, self.cells)];
            let reach = self.cells.map(|cell| if cell.is_some() { self.flight.unit } else { f64::NAN });
            let some = &mut places[..=last / steps];
            step = self.flight.fly(
                self.model.set,
                self.model.medium(),
                &mut self.state,
                reach,
                forces,
                centres,
                step,
                some,
                control,
            )?;
            if step < last {
                last = last.min((step / steps + SOON) * steps);
            }
            let centre = centres[(step - 1) % (stretch.count * steps) + 1];
            self.settle(&centre);
        }
        places.truncate(last / steps + 1);
        Ok(places.split_off(start))
    }

    /// Returns the cells' centres (S, 3) at the steps of a stretch. They follow the points with a delay of the
    /// transducers' time constant.
    fn centres(&self, stretch: Stretch) -> Vec<Vectors> {
        let steps = self.flight.steps;
        let at = |step: usize| {
            let time = self.time(stretch.first as f64 + step as f64 / steps as f64);
            let mut centre = [[0.0; LANES]; 3];
            for (lane, &point) in self.points.iter().enumerate() {
                let place = self.offset(lane) + self.course.place(time, point);
                (0..3).for_each(|axis| centre[axis][lane] = place[axis]);
            }
            centre
        };
        (0..=stretch.count * steps).map(at).collect()
    }

    /// Returns the time in s at which the points are where the traps are at a knot: traps are late by the transducers'
    /// time constant.
    fn time(&self, knot: f64) -> f64 {
        self.course.time(knot) - self.course.envelope.tau
    }

    /// Returns the centre of a bead's cell relative to its point.
    fn offset(&self, lane: usize) -> Vec3 {
        Vec3(self.cells[lane].unwrap_or_default().map(|k| f64::from(k) * LATTICE * self.flight.unit))
    }

    /// Moves each bead that is outside of its cell, whose centre is given, to the cell that contains it.
    fn settle(&mut self, centre: &Vectors) {
        for lane in 0..self.points.len() {
            let (unit, apart) = (self.flight.unit, Vec3(of(&self.state[0], lane)) - of(centre, lane));
            if self.cells[lane].is_some() && apart.norm() > unit {
                let way = apart + self.offset(lane);
                self.cells[lane] = Some(way.map(|x| math::round(x / (LATTICE * unit)) as i32));
            }
        }
    }

    /// Returns the forces in the cells at the knots of a stretch. Stored forces of the same bead in the same cell are copied.
    fn solve(&self, stretch: Stretch, control: &mut Control) -> Result<Solved, Error> {
        let knots = stretch.count + 1;
        control.room("the forces on beads", [LANES, knots], bytes(size_of::<Force>(), &[knots]))?;
        let mut forces = vec![[[[0.0; LANES]; 3]; 84]; knots];
        for lane in (0..self.points.len()).filter(|&lane| self.cells[lane].is_some()) {
            let same = |key: &(usize, Cells)| key.0 == stretch.first && key.1[lane] == self.cells[lane];
            if let Some((_, known)) = self.stored.iter().find(|(key, _)| same(key)) {
                for (force, known) in forces.iter_mut().zip(&known.forces) {
                    let each = force.as_flattened_mut().iter_mut().zip(known.as_flattened());
                    each.for_each(|(term, known)| term[lane] = known[lane]);
                }
                continue;
            }
            let (polynomials, which) = self.cell(stretch, lane, control)?;
            for (force, &k) in forces.iter_mut().zip(&which) {
                let each = force.as_flattened_mut().iter_mut().zip(polynomials[k].as_flattened());
                each.for_each(|(term, &coefficient)| term[lane] = coefficient);
            }
        }
        Ok(Solved { forces, centres: self.centres(stretch) })
    }

    /// Returns the forces in the cell of one bead, and for each knot (K,) the index of its force. Knots with equal drives and
    /// places share a force.
    fn cell(
        &self,
        stretch: Stretch,
        lane: usize,
        control: &mut Control,
    ) -> Result<(Vec<Polynomial>, Vec<usize>), Error> {
        let (lap, offset) = (self.course.lap(), self.offset(lane));
        let (mut places, mut drives, mut which): (Vec<[f64; 3]>, Vec<&[Complex32]>, Vec<usize>) = Default::default();
        for knot in stretch.first..=stretch.first + stretch.count {
            let knot = knot % lap;
            let place = (offset + self.course.place(self.time(knot as f64), self.points[lane])).0;
            let drive = self.course.drive(knot);
            // The knot after the last knot of a lap is the first knot of the lap.
            if knot == 0 && !places.is_empty() && stretch.first == 0 {
                which.push(0);
                continue;
            }
            if places.last() != Some(&place) || drives.last() != Some(&drive) {
                places.push(place);
                drives.push(drive);
            }
            which.push(places.len() - 1);
        }
        Ok((self.around.at(&places, &drives, control)?, which))
    }

    /// Returns the number of steps between two knots that the stiffest trap needs.
    fn fine(&self, forces: &[Force]) -> usize {
        let square = |force: &Force, lane: usize| {
            force[1..4].as_flattened().iter().map(|axis| axis[lane] * axis[lane]).sum::<f64>()
        };
        let all = forces.iter().flat_map(|force| (0..LANES).map(move |lane| square(force, lane)));
        let slope = math::sqrt(all.fold(0.0, f64::max)) / self.flight.unit;
        let speed = math::sqrt(slope / self.flight.particle.mass(self.model.medium()));
        let (particle, medium) = (self.flight.particle, self.model.medium());
        let [friction, history] =
            [particle.friction(medium), particle.history(medium)].map(|x| x / particle.mass(medium));
        // The step h with friction h + 2 history h^(1/2) = DRAGGED: with longer steps the drag of a light bead grows without end.
        let root = (math::sqrt(history * history + friction * DRAGGED) - history) / friction;
        math::ceil((self.course.spacing() * speed / ANGLE).max(self.course.spacing() / (root * root))).max(1.0) as usize
    }
}

/// Returns the vector of one bead.
fn of(all: &Vectors, lane: usize) -> [f64; 3] {
    [0, 1, 2].map(|axis| all[axis][lane])
}

#[cfg(test)]
#[path = "tests/fly.rs"]
mod tests;
