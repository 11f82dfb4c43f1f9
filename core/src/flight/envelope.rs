//! Envelope of the transducers' radiation while their drives change from frame to frame.
//!
//! A transducer is a first-order system: its radiation y follows its drive q by y' = (q - y)/tau.

use crate::prelude::*;

/// Number of time constants after which an earlier drive has no effect: e^-40 is below the rounding error.
const FORGOTTEN: f64 = 40.0;

/// Rate of the frames, and the transducers' response.
///
/// An open sequence is preceded by its first drive for a long time, and followed by its last drive. A closed sequence
/// repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    /// Frames per second.
    pub rate: f64,
    /// Time constant in s; with 0 the transducers follow at once.
    pub tau: f64,
    /// Whether each drive changes linearly to the drive of the next frame: amplitude and phase separately, the phase by
    /// the shorter way. Otherwise each drive stays constant for its whole frame.
    pub linear: bool,
}

/// The part of y that follows the drive: (constant + slope t) e^(j speed t), with the time t since the frame's start.
#[derive(Clone, Copy)]
struct Course {
    constant: Complex64,
    slope: Complex64,
    speed: f64,
}

impl Envelope {
    /// Returns how many of the last frames of a lap of `frames` frames affect the radiation after the lap.
    pub fn memory(&self, frames: usize) -> usize {
        frames.min((math::ceil(FORGOTTEN * self.tau * self.rate) as usize).saturating_add(1))
    }

    /// Returns y (N,) at the start of a sequence that repeats, from the drives (L, N) of its last [`Envelope::memory`] frames
    /// and the `first` drive. In the steady state y = y0 + y e^(-T/tau), where y0 is y after L frames from silence and T
    /// their duration.
    pub fn repeated(&self, last: &[Complex32], first: &[Complex32]) -> Vec<Complex64> {
        let count = first.len();
        let mut state = vec![Complex64::ZERO; count];
        let following = last.chunks(count).skip(1).chain([first]);
        for (now, following) in last.chunks(count).zip(following) {
            self.frame(now, following, &mut state, 1, 0..0, &mut []);
        }
        let left = self.left((last.len() / count) as f64 / self.rate);
        state.iter().map(|y| y / (1.0 - left)).collect()
    }

    /// Plays a frame that is divided into `parts`: `state` (N,) is y at its start and becomes y at its end. Writes y at the
    /// starts of the parts in the range `steps` to `out` (S, N).
    ///
    /// # Panics
    /// If the lists do not fit each other.
    pub fn frame(
        &self,
        now: &[Complex32],
        following: &[Complex32],
        state: &mut [Complex64],
        parts: usize,
        steps: Range<usize>,
        out: &mut [Complex32],
    ) {
        let (count, lasts) = (state.len(), 1.0 / self.rate);
        assert!(now.len() == count && following.len() == count && out.len() == steps.len() * count, "one of each");
        let times: Vec<f64> = steps.map(|k| k as f64 * lasts / parts as f64).collect();
        let decays: Vec<f64> = times.iter().map(|&time| self.left(time)).collect();
        let left = self.left(lasts);
        for i in 0..count {
            let course = self.course(now[i], following[i]);
            let rest = state[i] - course.constant;
            for (step, (&time, &decay)) in times.iter().zip(&decays).enumerate() {
                let y = course.at(time) + rest * decay;
                out[step * count + i] = Complex32::new(y.re as f32, y.im as f32);
            }
            state[i] = course.at(lasts) + rest * left;
        }
    }

    /// Returns e^(-t/tau): the fraction of an initial deviation that remains after the time t.
    fn left(&self, time: f64) -> f64 {
        if self.tau > 0.0 { math::exp(-time / self.tau) } else { 0.0 }
    }

    /// Returns the course of y for a drive that stays or moves linearly from `now` to `following` during a frame.
    ///
    /// The drive is q = (a + b t) e^(j w t + j phase). In tau y' + y = q, the form y = (c + d t) e^(j w t + j phase) gives
    /// d = b/(1 + j w tau) and c = (a - tau d)/(1 + j w tau).
    fn course(&self, now: Complex32, following: Complex32) -> Course {
        let wide = |q: Complex32| Complex64::new(f64::from(q.re), f64::from(q.im));
        let (now, following) = (wide(now), wide(following));
        if !self.linear || now == following {
            return Course { constant: now, slope: Complex64::ZERO, speed: 0.0 };
        }
        let [amplitude, next] = [now, following].map(|q| math::hypot(q.re, q.im));
        // A drive of amplitude 0 has no phase; the phase of the other drive is used for it.
        let direction = if amplitude > 0.0 { now / amplitude } else { following / next };
        let turned = following * now.conj();
        let speed = math::atan2(turned.im, turned.re) * self.rate;
        let lag = Complex64::new(1.0, speed * self.tau);
        let slope = direction * ((next - amplitude) * self.rate) / lag;
        Course { constant: (direction * amplitude - slope * self.tau) / lag, slope, speed }
    }
}

impl Course {
    /// Returns the value at a time since the frame's start.
    fn at(&self, time: f64) -> Complex64 {
        let value = self.constant + self.slope * time;
        if self.speed == 0.0 { value } else { value * math::phasor(self.speed * time) }
    }
}

#[cfg(test)]
#[path = "tests/envelope.rs"]
mod tests;
