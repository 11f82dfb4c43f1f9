//! Evening out: changes single codes, where their neighbours in time allow it, until each frame is even.

use crate::prelude::*;
use crate::sequence::frames::{Frames, TOGETHER};
use crate::sequence::track::{Circle, Ends};

/// min |P_j|/t_j over max |P_j|/t_j at which a frame is even: a little above .995, because rows of G are accurate to
/// 2e-4.
const EVEN: f32 = 0.9965;

/// Largest number of passes over the frames: a frame may improve after its neighbours have changed.
const PASSES: usize = 3;

/// Largest number of rounds over the transducers of a frame.
const ROUNDS: usize = 30;

/// The rounds of a frame end when a round leaves more than this part of the error.
const KEPT: f32 = 0.99;

/// Makes the fields of frames even by changes of codes (T, N). Codes within the bound stay within it.
pub(super) fn even_out(
    frames: &Frames,
    circle: &Circle,
    ends: Ends,
    codes: &mut [u16],
    control: &mut Control,
) -> Result<()> {
    let (transducers, points) = (frames.transducers, frames.points);
    let lanes = frames.blocks[0].lanes();
    control.room("G of some frames", [transducers, points], bytes(8, &[transducers, lanes]))?;
    let mut rows = [(); 2].map(|()| vec![0.0; transducers * lanes]);
    let free = usize::from(ends == Ends::Held);
    for _ in 0..PASSES {
        let mut even = true;
        for (b, block) in frames.blocks.iter().enumerate() {
            let lanes = block.lanes();
            let [re, im] = &mut rows;
            for (i, (re, im)) in re.chunks_mut(lanes).zip(im.chunks_mut(lanes)).take(transducers).enumerate() {
                control.pulse()?;
                block.row(i, re, im);
            }
            for frame in free.max(b * TOGETHER)..frames.count.min((b + 1) * TOGETHER) {
                let first = frame % TOGETHER * points;
                let mut one = One {
                    frames,
                    circle,
                    targets: &frames.targets[frame * points..(frame + 1) * points],
                    rows: rows.each_ref().map(|plane| &plane[first..]),
                    lanes,
                    start: frame * transducers,
                    neighbours: neighbours(frame, frames.count, ends == Ends::Closed)
                        .map(|other| other.map(|t| t * transducers)),
                    field: vec![[0.0; 2]; points],
                };
                even &= one.settle(codes, control)?;
            }
        }
        if even {
            break;
        }
    }
    Ok(())
}

/// Returns the frames before and after a frame; `None` where there is no such frame.
pub(super) fn neighbours(frame: usize, count: usize, closed: bool) -> [Option<usize>; 2] {
    let round = |other: usize| closed.then_some(other);
    let before = frame.checked_sub(1).or(round(count - 1));
    [before, if frame + 1 < count { Some(frame + 1) } else { round(0) }]
}

/// One frame: its targets, G, codes and field.
struct One<'a> {
    frames: &'a Frames<'a>,
    circle: &'a Circle,
    targets: &'a [f32],
    /// G of all transducers; that of transducer i begins at i times `lanes`.
    rows: [&'a [f32]; 2],
    lanes: usize,
    /// First index of the frame's codes, and of those of the frames before and after.
    start: usize,
    neighbours: [Option<usize>; 2],
    field: Vec<[f32; 2]>,
}

impl One<'_> {
    /// Changes codes until the frame is even or no change helps; returns whether it is even.
    fn settle(&mut self, codes: &mut [u16], control: &mut Control) -> Result<bool> {
        for i in 0..self.frames.transducers {
            self.turn(i, [0.0; 2], self.circle.drive(codes[self.start + i]));
        }
        let mut last = f32::INFINITY;
        for _ in 0..ROUNDS {
            let level = self.level();
            let mut error = self.error(level);
            if self.is_even() || error > KEPT * last {
                break;
            }
            last = error;
            for i in 0..self.frames.transducers {
                control.pulse()?;
                error = self.exchange(i, level, error, codes);
                if self.is_even() {
                    return Ok(true);
                }
            }
        }
        Ok(self.is_even())
    }

    /// Changes the code of a transducer by the one step that leaves the least error, if a step does; returns that
    /// error.
    fn exchange(&mut self, i: usize, level: f32, mut error: f32, codes: &mut [u16]) -> f32 {
        let code = codes[self.start + i];
        let mut best = code;
        for new in [-1, 1].map(|step| self.circle.moved(code, step)) {
            let mut others = self.neighbours.iter().flatten().map(|other| codes[other + i]);
            if others.all(|other| self.circle.between(new, other) <= self.circle.reach) {
                let [old, new_drive] = [best, new].map(|code| self.circle.drive(code));
                self.turn(i, old, new_drive);
                let left = self.error(level);
                if left < error {
                    (error, best) = (left, new);
                } else {
                    self.turn(i, new_drive, old);
                }
            }
        }
        codes[self.start + i] = best;
        error
    }

    /// P += G (new - old) for a transducer that is on.
    fn turn(&mut self, i: usize, old: [f32; 2], new: [f32; 2]) {
        if self.frames.is_on(i) {
            let [qr, qi] = [new[0] - old[0], new[1] - old[1]];
            let [re, im] = self.rows.map(|plane| &plane[i * self.lanes..]);
            for ((p, gr), gi) in self.field.iter_mut().zip(re).zip(im) {
                p[0] += gr * qr - gi * qi;
                p[1] += gr * qi + gi * qr;
            }
        }
    }

    /// Returns |P_j|/t_j of the points that are present.
    fn parts(&self) -> impl Iterator<Item = f32> {
        let there = self.field.iter().zip(self.targets).filter(|(_, target)| **target > 0.0);
        there.map(|([re, im], target)| sqrtf(re * re + im * im) / target)
    }

    /// Returns s, the mean of |P_j|/t_j.
    fn level(&self) -> f32 {
        let (count, sum) = self.parts().fold((0, 0.0), |(count, sum), part| (count + 1, sum + part));
        sum / count.max(1) as f32
    }

    /// Returns the sum of (|P_j|/t_j - s)^2.
    fn error(&self, level: f32) -> f32 {
        self.parts().map(|part| (part - level) * (part - level)).sum()
    }

    fn is_even(&self) -> bool {
        let [least, most] = self.parts().fold([f32::INFINITY, 0.0], |[least, most], x| [least.min(x), most.max(x)]);
        least >= EVEN * most
    }
}
