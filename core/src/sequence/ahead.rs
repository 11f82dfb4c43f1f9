//! Ahead: the drives of a whole sequence at once; each transducer gets the best track over all frames.

use crate::device::quantization::steps_within;
use crate::prelude::*;
use crate::propagation::Model;
use crate::sequence::alternation::{ComplexWeights, field, follow};
use crate::sequence::even_out::even_out;
use crate::sequence::first::guess;
use crate::sequence::frames::Frames;
use crate::sequence::track::{Circle, Ends};

/// The bound on the changes of phase from frame to frame, and the search of the tracks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ahead {
    /// The largest change of a transducer's phase from one frame to the next, in rad.
    pub change: f64,
    /// Number L of phases of the device, 2 to 65536: drives are e^{j 2 pi l/L}.
    pub phases: u32,
    /// The bounds of the first and the last frame.
    pub ends: Ends,
    /// Number of rounds; each computes tracks, point phases and weights.
    pub rounds: u32,
}

/// Returns codes l (T, N) for a whole sequence of T frames, with drives e^{j 2 pi l/L}: each of N transducers gets the
/// best track over all frames.
///
/// `points` (T, M, 3) are in m, `targets` (T, M) in Pa or any other unit: the points of a frame get pressures in these
/// ratios, as loud as possible. A point of target 0 is absent in that frame, and its coordinates are ignored. A
/// transducer without effect (masked, response 0) keeps the code 0. `start` (T, N) are the first codes; with
/// [`Ends::Held`] the result keeps those of the first frame. Without `start` the search begins with the drives of
/// [`crate::solvers::Uniform`], each frame from the one before. Transducers of one channel have one code; in `start` it
/// is that of the first.
///
/// In the formulas psi_j and w_j are phase and weight of point j, P_j its pressure, S_i the wave that transducer i is
/// to follow, G the propagation matrix and w the largest step.
///
/// ```text
/// |l_i(t) - l_i(t-1)| <= w = floor(change L / 2 pi), modulo L, and from the last frame to the first of a closed sequence
/// S_i(t) = sum_j w_j(t) e^{j psi_j(t)} conj(G_ji(t))
/// l_i = argmax sum_t Re(conj(S_i(t)) e^{j 2 pi l(t)/L})      exact, by dynamic programming (Viterbi 1967)
/// psi_j(t) = arg P_j(t), over-relaxed, and w_j(t) by level/|P_j(t)|, `rounds` times
/// ```
///
/// In the end single codes change by one where both neighbours in time allow it, until min |P_j|/t_j over max |P_j|/t_j
/// of the frame is above 0.995 or no change helps. Time O(rounds N T (L log w + M)), memory 4 N T bytes, and 4 T L
/// bytes for each thread. The result has the same bits for any number of threads.
///
/// # Errors
/// A change that is negative or not finite, L out of range, no round; fewer than two frames, lengths that do not fit, a
/// target that is negative or not finite, no target above 0; a point that is not finite, too far away, at a transducer
/// or reached by none; more memory than allowed; a stop.
///
/// ```
/// use midair::sequence::{Ahead, Ends, ahead};
/// use midair::{Array, Control, InstructionSet, Medium, Model};
///
/// let model = Model::new(&Array::grid(8, 8, 10e-3)?, Medium::default(), InstructionSet::best())?;
/// // Two points that part at 2 m/s, a frame every 0.1 ms.
/// let points: Vec<_> = (0..20).flat_map(|t| [-1.0, 1.0].map(|side| [side * (0.01 + 1e-4 * f64::from(t)), 0.0, 0.1])).collect();
/// let how = Ahead { change: 0.1, phases: 256, ends: Ends::Open, rounds: 5 };
/// let codes = ahead(&model, &points, &[1.0; 40], 20, &how, None, &mut Control::none())?;
/// // 0.1 rad are 4 phases of 256.
/// let step = |k: usize| (codes[k + 64] + 256 - codes[k]) % 256;
/// assert!((0..19 * 64).all(|k| step(k) <= 4 || step(k) >= 252));
/// # Ok::<(), midair::Error>(())
/// ```
pub fn ahead(
    model: &Model,
    points: &[[f64; 3]],
    targets: &[f64],
    frames: usize,
    ahead: &Ahead,
    start: Option<&[u16]>,
    control: &mut Control,
) -> Result<Vec<u16>> {
    let circle = ahead.circle()?;
    let frames = Frames::new(model, points, targets, frames, control)?;
    let (count, transducers) = (frames.count, frames.transducers);
    let (array, channels) = (model.array(), model.array().wiring());
    let sides = [transducers, frames.points];
    control.room("the codes of all frames", sides, bytes(4, &[count, transducers]))?;
    control.room("the tracks", sides, bytes(4 * control.threads(), &[count, circle.levels]))?;
    // Codes are ordered by transducers here, and by frames later when single frames are evened out.
    let mut codes = vec![0; transducers * count];
    let steps = ahead.rounds as usize + 1;
    let guess = match start {
        None if ahead.ends == Ends::Held => {
            return Err(Error::missing("start", "left out", "give codes, the first of which stay"));
        }
        None => guess(&frames, ahead.ends == Ends::Closed, control)?,
        Some(start) => {
            check_start(start, count, array.len(), ahead.phases)?;
            let columns = |row: &[u16]| channels.map_or(row.to_vec(), |channels| channels.gather(row));
            transpose(&start.chunks(array.len()).flat_map(columns).collect::<Vec<_>>(), count, &mut codes);
            field(&frames, &circle, &mut codes, control)?
        }
    };
    let mut weights = ComplexWeights::of(&frames, &guess);
    step(&frames, 1, steps, &guess, control)?;
    for round in 0..ahead.rounds as usize {
        let field = follow(&frames, &weights, &circle, ahead.ends, &mut codes, control)?;
        step(&frames, round + 2, steps, &field, control)?;
        weights.read(&frames, &field);
    }
    let mut by_frames = vec![0; codes.len()];
    transpose(&codes, transducers, &mut by_frames);
    even_out(&frames, &circle, ahead.ends, &mut by_frames, control)?;
    Ok(match channels {
        None => by_frames,
        Some(channels) => by_frames.chunks(transducers).flat_map(|row| channels.spread(row)).collect(),
    })
}

impl Ahead {
    pub(super) fn circle(&self) -> Result<Circle> {
        let change = real("change", self.change, 0.0, false)?;
        if !(2..=1 << 16).contains(&self.phases) {
            return Err(Error::out_of_range("phases", self.phases, "give 2 to 65536"));
        }
        refuse_if!(self.rounds == 0, Error::out_of_range("rounds", 0, "give at least 1: the first finds the tracks"));
        let reach = steps_within(change, self.phases).min(self.phases.into()) as usize;
        Ok(Circle::new(self.phases as usize, reach))
    }
}

fn check_start(start: &[u16], count: usize, transducers: usize, phases: u32) -> Result<()> {
    if start.len() != count * transducers {
        let cure = format!("give {transducers} in each of the {count} frames");
        return Err(Error::shape("start", format!("{} codes", start.len()), cure));
    }
    match start.iter().position(|&code| u32::from(code) >= phases) {
        None => Ok(()),
        Some(k) => {
            let item = format!("start[{}, {}]", k / transducers, k % transducers);
            Err(Error::out_of_range(item, start[k], format!("give codes below {phases}")))
        }
    }
}

/// Writes the transpose of `from`, which has `rows` rows.
pub(super) fn transpose(from: &[u16], rows: usize, to: &mut [u16]) {
    let columns = from.len() / rows;
    for (k, out) in to.iter_mut().enumerate() {
        *out = from[k % rows * columns + k / rows];
    }
}

/// Reports a step to the caller; returns an error if it requests a stop.
fn step(frames: &Frames, step: usize, steps: usize, field: &[Vec<f32>; 2], control: &mut Control) -> Result<()> {
    match control.step(step, steps, || frames.unevenness(field)) {
        core::ops::ControlFlow::Continue(()) => Ok(()),
        core::ops::ControlFlow::Break(()) => Err(Error::stopped()),
    }
}

#[cfg(test)]
#[path = "tests/ahead.rs"]
mod tests;
