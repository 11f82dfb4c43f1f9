//! Follow: solves the frames of a motion one after another, each with the previous one as its start.

use crate::scene::Start;
use crate::session::{Session, SolveRequest};
use crate::solvers::prelude::*;
use crate::solvers::remark::FALLEN;

/// Moving points: T frames of M points.
#[derive(Clone, Copy, Debug, Default)]
pub struct Frames<'a> {
    /// Points (T + 2 margin, M, 3) in m.
    pub points: &'a [[f64; 3]],
    /// Targets (T, M) in Pa; 0 means that the point does not exist in that frame. Left out, all points have the balanced level.
    pub targets: Option<&'a [f64]>,
    /// The number of points M.
    pub count: usize,
    /// How many additional frames of points there are before the first and after the last frame. Methods for traps then compute
    /// accelerations from frames at this distance on both sides. With 0 they estimate them from earlier frames.
    pub margin: usize,
    /// The number of the first frame, for errors.
    pub first: usize,
}

impl Session {
    /// Solves T frames one after another and writes their drives into `drives` (T, N). A solver with a memory continues from
    /// the last frame, also from one call to the next, until [`Session::last`] is cleared. Other solvers start from the
    /// previous drive, if they use a start. `ask` contains the other parts of the request; its lists are overwritten. The
    /// drive of a frame without points is 0.
    ///
    /// # Errors
    /// Lists of lengths that do not fit, the errors of [`Session::solve`] with the index of the frame; a stop by the caller.
    ///
    /// ```
    /// use midair::{Array, SolveRequest, Complex32, Control, Frames, InstructionSet, Medium, Model, Session, solvers};
    ///
    /// let array = Array::grid(16, 16, 10e-3)?;
    /// let model = Model::new(&array, Medium::default(), InstructionSet::best())?;
    /// let mut session = Session::new(model, solvers::find("glide")?.configure(&[].into())?.solver, true);
    /// let points: Vec<[f64; 3]> = (0..20).map(|t| [5e-5 * f64::from(t), 0.0, 0.15]).collect();
    /// let mut drives = vec![Complex32::ZERO; 20 * 256];
    /// let frames = Frames { points: &points, count: 1, ..Frames::default() };
    /// session.follow(frames, &mut SolveRequest::default(), &mut drives, &mut Control::none())?;
    /// let change = |t: usize, i: usize| (drives[256 * t + i] * drives[256 * (t - 1) + i].conj()).arg().abs();
    /// assert!((1..20).all(|t| (0..256).all(|i| change(t, i) < 0.2)));
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn follow(
        &mut self,
        frames: Frames<'_>,
        ask: &mut SolveRequest,
        drives: &mut [Complex32],
        control: &mut Control,
    ) -> Result<()> {
        let (transducers, Frames { points: all, targets, count, margin, .. }) = (self.transducers(), frames);
        let steps = drives.len() / transducers;
        let fits = |length: usize, frames: usize| length == frames * count;
        if count == 0
            || !fits(all.len(), steps + 2 * margin)
            || targets.is_some_and(|targets| !fits(targets.len(), steps))
        {
            let cure =
                format!("give {steps} frames of {count} points, as many targets, and {margin} frames on both sides");
            return Err(Error::shape("points", format!("{} of them", all.len()), cure));
        }
        let points = &all[margin * count..];
        let starts = !self.task.solver.remembers();
        // Beads that move are simulated by `flight`.
        self.reported[FALLEN] = true;
        let mut before: Option<usize> = None;
        for t in 0..steps {
            let frame = t * count..(t + 1) * count;
            ask.points.clear();
            let pressures = match targets {
                None => {
                    ask.points.extend_from_slice(&points[frame]);
                    None
                }
                Some(targets) => {
                    let mut pressures = ask.request.pressures.take().unwrap_or_default();
                    pressures.clear();
                    for (point, &target) in points[frame.clone()].iter().zip(&targets[frame]) {
                        if target != 0.0 {
                            ask.points.push(*point);
                            pressures.push(target);
                        }
                    }
                    Some(pressures)
                }
            };
            ask.request.pressures = pressures;
            let there = |j: &usize| targets.is_none_or(|targets| targets[t * count + j] != 0.0);
            let (around, apart) = &mut self.last.around;
            around.clear();
            *apart = margin;
            if margin > 0 {
                let places = [t, t + 2 * margin].map(|t| &all[t * count..]);
                around.extend(places.iter().flat_map(|places| (0..count).filter(there).map(|j| places[j])));
            }
            let row = t * transducers..(t + 1) * transducers;
            if ask.points.is_empty() {
                drives[row].fill(Complex32::ZERO);
                continue;
            }
            ask.start = match before {
                Some(before) if starts => Some(Start::Drive(drives[before..before + transducers].to_vec())),
                _ => None,
            };
            let status = self.solve(ask, &mut control.part()).map(|solution| {
                drives[row.clone()].copy_from_slice(&solution.drive);
                solution.status
            });
            self.last.around.0.clear();
            let status = status.map_err(|error| error.of_one("frames", frames.first + t))?;
            refuse_if!(status == Status::Stopped, Error::stopped());
            before = Some(row.start);
            control.pulse()?;
        }
        Ok(())
    }
}
