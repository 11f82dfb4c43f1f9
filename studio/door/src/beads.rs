//! Beads: counts those that the traps of a solution hold, and simulates them in the frames that `follow` has solved.

use midair::flight::{BeadStart, Course, Envelope};
use midair::{Control, Error, Result, frame_rate};

use crate::studio::Studio;

/// Time constant of the transducers in s, the default of `midair.fly`.
const TAU: f64 = 0.2e-3;

impl Studio {
    /// Writes how many traps of the last solution hold their bead, and the number of traps; nothing without traps.
    pub(crate) fn count_beads(&mut self) -> Result<()> {
        let solution = self.opened()?.session.solution();
        let beads = solution.map(|solution| solution.beads(&mut Control::none())).transpose()?.flatten();
        self.numbers = beads.into_iter().flatten().map(|count| count as f64).collect();
        Ok(())
    }

    /// Simulates the bead in the trap of a point while the frames repeat at `rate` frames/s. The numbers are the time in s at
    /// which it was lost or NaN, its largest distance from its point in m until then, and its places (F, 3) in m at the frames
    /// of all laps until then.
    pub(crate) fn fly(&mut self, point: usize, rate: f64) -> Result<()> {
        let rate = frame_rate(rate)?;
        if self.course.as_ref().is_none_or(|course| course.rate().to_bits() != rate.to_bits()) {
            let (drives, places) = (core::mem::take(&mut self.frames), core::mem::take(&mut self.places));
            let envelope = Envelope { rate, tau: TAU, linear: false };
            let course = self
                .opened()
                .and_then(|opened| Course::of(&places, &drives, &opened.model, envelope, true, &mut Control::none()));
            (self.frames, self.places) = (drives, places);
            self.course = Some(course?);
        }
        let course = self.course.take().ok_or_else(|| Error::invalid("frames", "none", "follow some first"))?;
        let flown = self.flown(&course, point, rate);
        self.course = Some(course);
        self.numbers = flown?;
        Ok(())
    }

    /// Returns the numbers of [`Studio::fly`].
    fn flown(&mut self, course: &Course, point: usize, rate: f64) -> Result<Vec<f64>> {
        let opened = self.opened()?;
        if point >= opened.scene.points().len() {
            return Err(Error::out_of_range("point", point, "give the number of one, from 0"));
        }
        let (model, bead, none) = (&opened.model, opened.scene.bead(), &mut Control::none());
        let place = course.resting(model, bead, &[point], none)?[0];
        let start = BeadStart { place, speed: course.moving(point)[0], point };
        let knots = course.knots(None)?;
        let flown = course.fly(model, bead, &[start], knots, none)?;
        let mut numbers = vec![flown.lost[0], flown.farthest()[0]];
        // The times of frames lie between knots, that of the first frame before the first knot.
        let lasts = course.spacing() * (knots - 1) as f64;
        for frame in 0..(lasts * rate).round() as usize {
            let knot = ((frame as f64 / rate - course.time(0.0)) / course.spacing()).max(0.0);
            let (before, share) = (knot as usize, knot.fract());
            let [from, to] = [before, before + 1].map(|knot| flown.places[knot.min(knots - 1)]);
            let place = [0, 1, 2].map(|axis| from[axis] + share * (to[axis] - from[axis]));
            if place[0].is_nan() {
                break;
            }
            numbers.extend(place);
        }
        Ok(numbers)
    }
}
