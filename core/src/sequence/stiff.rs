//! Stiff traps of a whole sequence: each frame is as stiff as its neighbouring frames allow.
//!
//! The search begins with the tracks of foci of [`crate::sequence::ahead()`], which keep the bound w and are closed in a
//! closed sequence. The objective of traps ([`crate::solvers::even_field::traps`]) then improves each frame t within
//!
//! ```text
//! |phi_i(t) - phi_i(t-1)| <= w   and   |phi_i(t+1) - phi_i(t)| <= w          phi_i: the phase of transducer i
//! ```
//!
//! For each transducer this is an arc around the middle of the phases in both neighbouring frames. If these phases
//! differ by d, the half width of the arc is w - |d|/2. Every second frame is improved at the same time, while the
//! other frames stay unchanged. So the bound always holds, and no frame gets worse. After these sweeps each transducer
//! takes the track of the board's phases that is nearest to its phases ([`Tracker`]). At the end single phases are
//! exchanged within the bound, so that beads rest at their points.

use core::ops::ControlFlow;

use crate::device::channels::Channels;
use crate::propagation::Model;
use crate::propagation::forces::stiffness::Stiffness;
use crate::sequence::ahead::{Ahead, transpose};
use crate::sequence::even_out::neighbours;
use crate::sequence::frames::{Frames, TOGETHER};
use crate::sequence::track::{Circle, Ends, Tracker};
use crate::solvers::even_field::traps::between::{Neighbours, carry_along, exchange, improve};
use crate::solvers::prelude::*;

/// Number of sweeps over all frames.
const SWEEPS: usize = 24;
/// Number of steps of each frame in a sweep.
const STEPS: usize = 6;

/// Number of rounds in which phases are exchanged after they have been rounded to the board's phases.
const EXCHANGES: usize = 2;

/// Changes codes (T, N) of [`crate::sequence::ahead()`] so that the traps of a model's signature are as stiff as
/// possible, within the bound of `how`. Each trap also gives the force that its bead needs to follow the points (T, M,
/// 3) at `rate` frames per second. The bead's acceleration is computed from the points `margin` frames before and
/// after. If the field has no derivatives, the codes stay unchanged.
///
/// # Errors
/// Fewer than two frames, lists that do not fit, a point that is rejected; more memory than allowed is needed; a stop.
pub fn stiffen(
    model: &Model,
    points: &[[f64; 3]],
    how: &Ahead,
    rate: f64,
    margin: usize,
    codes: &mut [u16],
    control: &mut Control,
) -> Result<()> {
    let (array, channels) = (model.array(), model.array().wiring());
    let count = codes.len() / array.len();
    if codes.len() != count * array.len() {
        let cure = format!("give {} in each frame", array.len());
        return Err(Error::shape("codes", format!("{} of them", codes.len()), cure));
    }
    let frames = Frames::new(model, points, &vec![1.0; points.len()], count, control)?;
    let circle = how.circle()?;
    let transducers = frames.transducers;
    control.room("the drives of all frames", [transducers, count], bytes(24, &[count, transducers]))?;
    let lap = Lap { frames: &frames, points, closed: how.ends == Ends::Closed, rate, margin, circle: &circle };
    let gather = |row: &[u16]| channels.map_or(row.to_vec(), |channels| channels.gather(row));
    let mut columns: Vec<u16> = codes.chunks(array.len()).flat_map(gather).collect();
    let mut drives = lap.drives(&columns);
    let board = Quantization::new(Some(how.phases), None)?;
    let steps = SWEEPS + EXCHANGES;
    for step in 0..steps {
        if step == SWEEPS {
            lap.follow(&drives, how.ends, &mut columns, control)?;
            drives = lap.drives(&columns);
        }
        for chosen in lap.parts() {
            lap.visit(&chosen, &mut drives, (step >= SWEEPS).then_some(&board), control)?;
        }
        refuse_if!(control.step(step + 1, steps, || 0.0) == ControlFlow::Break(()), Error::stopped());
    }
    for (code, q) in columns.iter_mut().zip(&drives) {
        *code = circle.nearest(*q);
    }
    let spread = |row: &[u16]| channels.map_or(row.to_vec(), |channels: &Channels| channels.spread(row));
    let rows = columns.chunks(transducers).flat_map(spread);
    codes.iter_mut().zip(rows).for_each(|(code, new)| *code = new);
    Ok(())
}

/// The frames of a sequence, and the bound on its phases.
struct Lap<'a> {
    frames: &'a Frames<'a>,
    points: &'a [[f64; 3]],
    closed: bool,
    rate: f64,
    margin: usize,
    circle: &'a Circle,
}

impl Lap<'_> {
    /// Returns the drives of codes (T, N).
    fn drives(&self, codes: &[u16]) -> Vec<Complex32> {
        let on: Vec<bool> = (0..self.frames.transducers).map(|i| self.frames.is_on(i)).collect();
        let drive = |(k, &code): (usize, &u16)| {
            if on[k % on.len()] { self.circle.phasor(code) } else { Complex32::ZERO }
        };
        codes.iter().enumerate().map(drive).collect()
    }

    /// Returns sets of frames that are improved at the same time: no set contains two neighbours.
    fn parts(&self) -> [Vec<usize>; 3] {
        let count = self.frames.count;
        let odd_lap = self.closed && count % 2 == 1;
        let end = if odd_lap { count - 1 } else { count };
        [(0..end).step_by(2).collect(), (1..end).step_by(2).collect(), (end..count).collect()]
    }

    /// Returns the drives of the frames before and after a frame, where there are such frames.
    fn beside<'b>(&self, t: usize, drives: &'b [Complex32]) -> [Option<&'b [Complex32]>; 2] {
        neighbours(t, self.frames.count, self.closed).map(|other| other.map(|other| self.row(other, drives)))
    }

    fn row<'b>(&self, t: usize, drives: &'b [Complex32]) -> &'b [Complex32] {
        &drives[t * self.frames.transducers..(t + 1) * self.frames.transducers]
    }

    /// Improves some frames on all threads: by steps of their phases, or on a board by exchanges of single phases.
    fn visit(
        &self,
        chosen: &[usize],
        drives: &mut [Complex32],
        board: Option<&Quantization>,
        control: &mut Control,
    ) -> Result<()> {
        let transducers = self.frames.transducers;
        let mut rows = vec![Complex32::ZERO; chosen.len() * transducers];
        let share = chosen.len().div_ceil(control.threads()).max(1);
        let parts: Vec<_> = chosen.chunks(share).zip(rows.chunks_mut(share * transducers)).collect();
        let old = &*drives;
        control.each(parts, &|(chosen, rows), control| {
            let work = Workspace::new();
            for (&t, row) in chosen.iter().zip(rows.chunks_mut(transducers)) {
                row.copy_from_slice(self.row(t, old));
                let Some(traps) = self.traps(t, row, control)? else { continue };
                let neighbours =
                    Neighbours { beside: self.beside(t, old), bound: self.bound(), codes: self.circle.reach };
                match board {
                    Some(board) => exchange(&traps, &neighbours, (self.frames.set(), board), row),
                    None => improve(&traps, &neighbours, (self.frames.set(), STEPS), row, &work, control)?,
                }
            }
            Ok(())
        })?;
        for (&t, row) in chosen.iter().zip(rows.chunks(transducers)) {
            drives[t * transducers..(t + 1) * transducers].copy_from_slice(row);
        }
        Ok(())
    }

    /// Returns the bound in rad: a whole number of the board's phase steps, at most pi.
    fn bound(&self) -> f64 {
        (TAU * self.circle.reach as f64 / self.circle.levels as f64).min(PI)
    }

    /// Returns the traps of a frame with the forces that their beads need for their acceleration.
    fn traps(&self, t: usize, drive: &[Complex32], control: &mut Control) -> Result<Option<Stiffness>> {
        let each = self.frames.points;
        let first = t % TOGETHER * each;
        let Some((.., Some(recipe))) = self.frames.blocks[t / TOGETHER].origin() else { return Ok(None) };
        let recipe = recipe.select(&(first..first + each).collect::<Vec<_>>());
        let bead = self.frames.model.bead();
        let Some(mut traps) = (recipe.make.stiffness)(&recipe, bead, control)? else { return Ok(None) };
        let places = |t: usize| &self.points[t * each..(t + 1) * each];
        let count = self.frames.count;
        let around = if self.closed {
            let margin = self.margin % count;
            [(t + count - margin) % count, (t + margin) % count]
        } else {
            [t.saturating_sub(self.margin), (t + self.margin).min(count - 1)]
        };
        let around = around.map(places).concat();
        let wavelength = self.frames.model.medium().wavelength();
        carry_along(&mut traps, (places(t), &around, self.margin), self.rate, drive, wavelength);
        Ok(Some(traps))
    }

    /// Writes to `codes` (T, N) the tracks of the board's phases that are nearest to the drives.
    fn follow(&self, drives: &[Complex32], ends: Ends, codes: &mut [u16], control: &mut Control) -> Result<()> {
        let (count, transducers) = (self.frames.count, self.frames.transducers);
        let mut tracks = vec![0; codes.len()];
        transpose(codes, count, &mut tracks);
        let share = transducers.div_ceil(control.threads());
        let parts: Vec<_> = tracks.chunks_mut(share * count).enumerate().collect();
        control.each(parts, &|(k, tracks), control| {
            let mut tracker = Tracker::new(self.circle, count, self.frames.set());
            for (i, track) in tracks.chunks_mut(count).enumerate().map(|(i, track)| (k * share + i, track)) {
                if self.frames.is_on(i) {
                    let wave = (0..count).map(|t| drives[t * transducers + i]);
                    let (re, im): (Vec<f32>, Vec<f32>) = wave.map(|q| (q.re, q.im)).unzip();
                    tracker.follow([&re, &im], ends, track, control)?;
                }
            }
            Ok(())
        })?;
        transpose(&tracks, transducers, codes);
        Ok(())
    }
}
