//! First guess: the field of each frame's even drive, found from the drive of the frame before.

use crate::math::{atan2, phasor};
use crate::problem::Setup;
use crate::scene::{Aim, Request, Start};
use crate::sequence::frames::Frames;
use crate::solvers::prelude::*;
use crate::solvers::{Solve, Uniform};

/// Returns the field (T, M) of a first guess, real and imaginary parts. If it is `closed`, each point's phase is turned
/// back a little in each frame, so that the first frame follows the last without a jump.
pub(super) fn guess(frames: &Frames, closed: bool, control: &mut Control) -> Result<[Vec<f32>; 2]> {
    let (count, points) = (frames.count, frames.points);
    let mut field = [vec![0.0; frames.lanes()], vec![0.0; frames.lanes()]];
    // This setup has no channels: each column of G counts as one transducer, also if it is a channel.
    let setup = Setup { channels: None, ..Setup::of_model(frames.model) };
    let setup = Arc::new(setup);
    let mut work = Workspace::new();
    let mut last: Option<Vec<Complex32>> = None;
    for frame in 0..count + usize::from(closed) {
        let first = frame % count * points;
        let there: Vec<usize> = (first..first + points).filter(|&k| frames.targets[k] > 0.0).collect();
        if there.is_empty() {
            continue;
        }
        let chosen: Vec<usize> = there.iter().map(|k| k - first).collect();
        let pressures = there.iter().map(|&k| f64::from(frames.targets[k])).collect();
        let request = Request { pressures: Some(pressures), ..Request::default() };
        let propagation = frames.propagation(frame % count, &chosen);
        let mut problem = Problem::watched(propagation, Arc::clone(&setup), &request, control)?.with_aim(Aim::Max);
        if let Some(drive) = last.take() {
            problem = problem.with_start(Start::Drive(drive))?;
        }
        let solution = Uniform::default().solve(&problem, &mut work, &mut control.part())?;
        refuse_if!(solution.status == Status::Stopped, Error::stopped());
        for (&k, p) in there.iter().zip(&solution.pressures) {
            if frame < count {
                (field[0][k], field[1][k]) = (p.re, p.im);
                continue;
            }
            let (re, im) = (f64::from(field[0][k]), f64::from(field[1][k]));
            let (after_re, after_im) = (f64::from(p.re), f64::from(p.im));
            let missing = atan2(after_im * re - after_re * im, after_re * re + after_im * im);
            turn_back(&mut field, (k, points, count), missing);
        }
        last = Some(solution.drive);
    }
    Ok(field)
}

/// Turns the phase of a point's field by an angle that grows from frame to frame, up to `-angle` after `count` frames.
fn turn_back(field: &mut [Vec<f32>; 2], (point, points, count): (usize, usize, usize), angle: f64) {
    let [re, im] = field;
    for frame in 0..count {
        let (k, turn) = (frame * points + point, phasor(-angle * frame as f64 / count as f64));
        let (cos, sin) = (turn.re as f32, turn.im as f32);
        (re[k], im[k]) = (re[k] * cos - im[k] * sin, re[k] * sin + im[k] * cos);
    }
}
