//! Join: paths at the same time, or one after the other with a fade where points do not continue.
//!
//! A path with M points has M slots. A point of the second path that starts where a point of the first one ends keeps that
//! point's slot. All other points of the first path fade to 0. All other points of the second path rise from 0, in slots whose
//! target is 0 or in new slots. A slot with target 0 has no point; only such a slot may change its place suddenly.

use crate::points::modulation::ROUNDING;
use crate::points::path::{Course, Link, Moment, Path};
use crate::prelude::*;
use crate::scene::{distance, figures};

/// Two closed paths played together must return to their starts within this many laps of one of them.
const MOST_LAPS: usize = 64;

/// An end and a start closer than this, in m, count as the same place: a ten-thousandth of the wavelength.
const MEET: f64 = 1e-6;

impl Path {
    /// Returns both paths at the same time, the points of this one first.
    ///
    /// # Errors
    /// Other durations, unless both are closed and their durations have a ratio of whole numbers up to 64; one path with
    /// pressures and one without.
    pub fn beside(&self, other: &Self) -> Result<Self> {
        self.same_unit(other)?;
        let parts = [self, other].into_iter().flat_map(|path| match &*path.course {
            Course::Beside(parts) => parts.clone(),
            _ => vec![path.clone()],
        });
        Ok(Self {
            points: self.points + other.points,
            duration: self.together(other)?,
            closed: self.closed && other.closed,
            pascals: self.pascals,
            modulation: self.modulation.max(other.modulation),
            course: Arc::new(Course::Beside(parts.collect())),
        })
    }

    /// Returns the duration in s after which both paths end or are at their starts again.
    fn together(&self, other: &Self) -> Result<f64> {
        let most = if self.closed && other.closed { MOST_LAPS } else { 1 };
        let lasts = [self.duration, other.duration];
        let ends = (1..=most).map(|laps| {
            let end = laps as f64 * lasts[0];
            let others = math::rint(end / lasts[1]);
            (end, (1.0..=most as f64).contains(&others).then_some(others * lasts[1]))
        });
        let both = |(end, other): &(f64, Option<f64>)| {
            other.is_some_and(|other| (end - other).abs() <= ROUNDING * end.max(other))
        };
        ends.clone().find(both).map(|(end, _)| end).ok_or_else(|| {
            let value = format!("{} and {} s", figures(lasts[0], 6), figures(lasts[1], 6));
            let ratio = format!("two closed ones durations in a ratio of whole numbers up to {MOST_LAPS}");
            Error::invalid("the duration of the paths", value, format!("give them one duration, or {ratio}"))
        })
    }

    fn same_unit(&self, other: &Self) -> Result<()> {
        if self.pascals == other.pascals {
            return Ok(());
        }
        let which = if self.pascals { "first" } else { "second" };
        let cure = "give them for both or for neither";
        Err(Error::invalid("pressures", format!("given for the {which} path only"), cure))
    }

    /// Returns the other path after this one. Where points, places or targets do not continue, a fade of `fade` s joins them:
    /// all points stand still, and targets change along a raised cosine.
    ///
    /// # Errors
    /// Paths that need a fade if there is none; one path with pressures and one without; a fade that is not above 0.
    pub fn then(&self, other: &Self, fade: Option<f64>) -> Result<Self> {
        let fade = fade.map(|fade| real("fade", fade, 0.0, true)).transpose()?;
        self.same_unit(other)?;
        let (end, begin): (Vec<_>, Vec<_>) = (self.moments(self.duration).collect(), other.moments(0.0).collect());
        let joint = Joint::of(&end, &begin);
        let points = joint.slots.iter().fold(self.points, |most, slot| most.max(slot + 1));
        let mut places: Vec<[f64; 3]> = end.iter().map(|moment| moment.place).collect();
        let mut before: Vec<f64> = end.iter().map(|moment| moment.target).collect();
        let mut after = vec![0.0; points];
        places.resize(points, [0.0; 3]);
        before.resize(points, 0.0);
        for (j, (&slot, moment)) in joint.slots.iter().zip(&begin).enumerate() {
            after[slot] = moment.target;
            if !joint.goes_on[j] {
                places[slot] = moment.place;
            }
        }
        let mut links = self.links();
        for link in &mut links {
            link.slots.resize(points, None);
            link.idle.extend_from_slice(&places[self.points..]);
        }
        let mut start = self.duration;
        if !same(&before, &after) {
            let Some(duration) = fade else { return Err(joint.jump(&end, &begin)) };
            let course = Arc::new(Course::Fade { places: places.clone(), before, after });
            let rest = Self { points, duration, closed: false, modulation: 0.0, course, ..self.clone() };
            links.push(Link { start, path: rest, slots: (0..points).map(Some).collect(), idle: places.clone() });
            start += duration;
        }
        for link in other.links() {
            let (mut slots, mut idle) = (vec![None; points], places.clone());
            for (j, &slot) in joint.slots.iter().enumerate() {
                slots[slot] = link.slots[j];
                idle[slot] = link.idle[j];
            }
            links.push(Link { start: start + link.start, path: link.path, slots, idle });
        }
        let duration = start + other.duration;
        let modulation = self.modulation.max(other.modulation);
        let course = Arc::new(Course::Chain(links));
        let chain = Self { points, duration, closed: false, modulation, course, ..self.clone() };
        let (first, last): (Vec<_>, Vec<_>) = (chain.moments(0.0).collect(), chain.moments(duration).collect());
        let meets = first.iter().zip(&last).all(|(a, b)| a.target <= 0.0 || distance(a.place, b.place) <= MEET);
        let targets = |state: &[Moment]| state.iter().map(|moment| moment.target).collect::<Vec<_>>();
        Ok(Self { closed: meets && same(&targets(&first), &targets(&last)), ..chain })
    }

    /// Returns the links of a chain; a path that is none is its only link.
    fn links(&self) -> Vec<Link> {
        if let Course::Chain(links) = &*self.course {
            return links.clone();
        }
        let (slots, idle) = ((0..self.points).map(Some).collect(), vec![[0.0; 3]; self.points]);
        vec![Link { start: 0.0, path: self.clone(), slots, idle }]
    }
}

/// Whether targets are the same up to rounding.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= ROUNDING * b.abs())
}

/// The joint of two paths: the slot of each point of the second path, and whether it continues a point of the first one.
struct Joint {
    slots: Vec<usize>,
    goes_on: Vec<bool>,
}

impl Joint {
    fn of(end: &[Moment], begin: &[Moment]) -> Self {
        let (mut slots, mut goes_on) = (vec![0; begin.len()], vec![false; begin.len()]);
        let mut free_ends: Vec<bool> = end.iter().map(|moment| moment.target > 0.0).collect();
        for (j, point) in begin.iter().enumerate().filter(|(_, point)| point.target > 0.0) {
            let apart = |slot: &usize| distance(end[*slot].place, point.place);
            let ends = (0..end.len()).filter(|&slot| free_ends[slot]);
            let nearest = ends.min_by(|a, b| apart(a).total_cmp(&apart(b))).filter(|slot| apart(slot) <= MEET);
            if let Some(slot) = nearest {
                (slots[j], goes_on[j], free_ends[slot]) = (slot, true, false);
            }
        }
        let mut free = (0..).filter(|&slot| end.get(slot).is_none_or(|moment| moment.target <= 0.0));
        for (j, slot) in slots.iter_mut().enumerate().filter(|(j, _)| !goes_on[*j]) {
            *slot = free.next().unwrap_or(j);
        }
        Self { slots, goes_on }
    }

    /// Returns the error for an end and a start that differ.
    fn jump(&self, end: &[Moment], begin: &[Moment]) -> Error {
        let refused = |item: &str, value: String| Error::invalid(item, value, "give a fade in s, such as fade=0.05");
        let [ends, begins] = [end, begin].map(|state| state.iter().filter(|moment| moment.target > 0.0).count());
        if ends != begins {
            return refused("the number of points", format!("{ends} before the joint and {begins} after it"));
        }
        let Some(point) = (0..begin.len()).find(|&j| begin[j].target > 0.0 && !self.goes_on[j]) else {
            let targets = |state: &[Moment]| state.iter().map(|moment| moment.target).collect::<Vec<_>>();
            return refused(
                "targets",
                format!("{:?} before the joint and {:?} after it", targets(end), targets(begin)),
            );
        };
        let taken = |slot: &usize| (0..begin.len()).any(|j| self.goes_on[j] && self.slots[j] == *slot);
        let left = (0..end.len()).filter(|slot| end[*slot].target > 0.0 && !taken(slot));
        let apart = left.map(|slot| distance(end[slot].place, begin[point].place)).fold(f64::INFINITY, f64::min);
        let value = format!("{} mm from where the first ends", figures(1e3 * apart, 4));
        refused(&format!("the start of point {point} of the second path"), value)
    }
}
