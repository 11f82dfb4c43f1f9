//! glide: even points in motion; each phase stays within a bound of its value in the last frame.
//!
//! ```text
//! psi = arg(G' q')                         point phases that the last drive q' makes at the new points
//! sweeps:  S_i = sum_j w_j e^{j psi_j} conj(G_ji);   q_i = S_i/|S_i|, limited to within `change` of q'_i;
//!          psi and w_j from the field of q (weighted Gerchberg-Saxton)
//! steps:   the shortest step of the phases not at their bound to |P_j| = s t_j, s free; limited again
//! ```
//!
//! The last frame's point phases, with their global phase, need the fewest changes. A transducer at its bound matters
//! little: the waves to the points nearly cancel there. With an envelope of time constant tau, y' = (q - y)/tau, the
//! field at a frame's end is P = a G y + (1 - a) G q with a = e^{-1/(rate tau)}. This field is made even.
//!
//! Traps without requested pressures are made stiff instead ([`within`]), in twice as many steps.
//!
//! All drives are relative to the last ones: G's columns are multiplied by q', and the bound is an arc around 1, or a
//! largest code on a board's grid.

mod arc;

use crate::device::quantization::steps_within;
use crate::kernels::tiles::unit::{Arc, rotate_list};
use crate::kernels::tiles::{all_sound, error_diffusion};
use crate::solvers::common::alternating_projection::Projector;
use crate::solvers::even_field::grid::Answer;
use crate::solvers::even_field::run::{Plan, QUIET, SWEEPS};
use crate::solvers::even_field::traps::within::{self, Turn};
use crate::solvers::glide::arc::{Steps, even_within};
use crate::solvers::prelude::*;
use crate::solvers::{Last, even_field};

options! {
    /// Even points in motion, |q| = 1 before all drives are reduced to the targets. Time O(N M^2 + M^3) a frame, memory O(N M + M^2).
    pub struct Glide {
        /// Largest change of a phase from the last frame to this one, in rad; pi or more leaves phases free.
        pub change: f64 = PI / 16.0,
        /// Time constant of the transducers' envelopes in s; 0 means no envelope.
        pub tau: f64 = 0.0,
        /// Frames a second; envelopes and traps in motion depend on it.
        pub rate: f64 = 10e3,
        /// Weighted Gerchberg-Saxton sweeps a frame.
        pub sweeps: u32 = 3,
        /// Largest number of Gauss-Newton steps a frame.
        pub steps: u32 = 6,
    }
}

/// Deviation that counts as even: the effect of a phase step of 2 pi/65536 on a point.
const EVEN: f32 = 1e-5;

/// The first frame, which has no bound, has this many times as many sweeps: points at rest then keep its phases.
const FIRST: u32 = 10;

/// On a board's grid the last codes are kept if their deviation is at most this multiple of the deviation when they were
/// chosen, or of the deviation of the new codes; see [`AS_LOUD`].
const NO_WORSE: f32 = 1.05;

/// The last codes are kept only if their level is at least this part of the level of the new codes.
const AS_LOUD: f32 = 1.0 - 2e-4;

/// A frame is done if no point is off the level by more than this part.
const NEARLY: f32 = 0.01;

/// The largest factor of a weight in a sweep.
const MOST_CHANGE: f32 = 2.0;

/// Longest time constant of an envelope in frames: in a longer one, f32 could not resolve the change in one frame.
const MOST_FRAMES: f64 = 1000.0;

impl Method for Glide {
    const INFO: Info = Info::new(
        "glide",
        "even points in motion, phases within a bound of the last frame's",
        "point phases of the last drive, clipped weighted Gerchberg-Saxton, Gauss-Newton on |P| = s p",
    )
    .balanced()
    .with_start()
    .with_aim();

    fn check(&self) -> Result<()> {
        real("change", self.change, 0.0, false)?;
        real("tau", self.tau, 0.0, false)?;
        frame_rate(self.rate)?;
        if self.tau * self.rate > MOST_FRAMES {
            let cure = format!("give at most {:e} s, the time of {MOST_FRAMES} frames", MOST_FRAMES / self.rate);
            return Err(Error::out_of_range("tau", self.tau, cure));
        }
        Ok(())
    }
}

impl Solve for Glide {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let propagation = problem.propagation();
        let mut last = Last::taken(work, propagation.transducers(), propagation.points());
        let solution = self.follow(problem, &mut last, work, control);
        last.recycle(work);
        solution
    }

    fn follow(
        &self,
        problem: &Problem,
        last: &mut Last,
        work: &mut Workspace,
        control: &mut Control,
    ) -> Result<Solution> {
        let mut free = false;
        if let Some(drive) = problem.start_drive() {
            begin(last, problem, drive)?;
        } else if last.played.len() != problem.propagation().transducers() {
            // Only the phases of this drive are used. The steps of its search do not count as steps of the frame.
            let plan = Plan::alone(SWEEPS, f64::from(EVEN), QUIET);
            let first = even_field::solve(problem, &[plan], work, &mut control.part())?;
            if first.status == Status::Stopped {
                return Ok(first);
            }
            last.begin(first.drive.iter().map(|&q| placed(problem, q)));
            first.recycle(work);
            free = true;
        }
        self.next(problem, last, free, work, control)
    }

    facts!(finds_level = true, meets_targets = true, remembers = true);

    fn bound(&self) -> Option<f64> {
        Some(self.change)
    }
}

impl Glide {
    /// Computes the frame after the last one. Its phases are within the bound of the last ones, unless they are `free`.
    fn next(
        &self,
        problem: &Problem,
        last: &mut Last,
        free: bool,
        work: &Workspace,
        control: &mut Control,
    ) -> Result<Solution> {
        let mut frame = Frame::new(self, free, problem, last, work, control)?;
        let Some(mut traps) = within::requested(problem, last, control)? else {
            frame.sweep(self, control)?;
            let status = frame.level(self, problem, work, control)?;
            frame.keep_foci(problem, last, work, control)?;
            return frame.answer(problem, status, last, work, control);
        };
        let motion = within::accelerate(&mut traps, problem, self.rate, last);
        let turn = Turn { arc: frame.arc, steps: 2 * self.steps, kept: f64::from(1.0 - frame.part) };
        let relative = frame.wave.drive.each_mut().map(|plane| &mut plane[..]);
        within::stiffen(&traps, problem, last, turn, relative, work, control)?;
        let drives = frame.wave.drives(last.played.len(), work);
        let played = within::keep(&traps, problem, frame.most, &drives, last);
        frame.wave.play(&frame.rows, played.into_iter());
        work.complexes.give(drives);
        last.motion = motion;
        frame.answer(problem, Status::Done, last, work, control)
    }
}

/// Returns q/|q|; 0 stays 0.
fn unit(q: Complex32) -> Complex32 {
    let (re, im) = math::unit(q.re, q.im);
    if q == Complex32::ZERO { q } else { Complex32::new(re, im) }
}

/// Returns q/|q| at the nearest phase of the board, from which codes are counted.
fn placed(problem: &Problem, q: Complex32) -> Complex32 {
    problem.quantization().map_or(unit(q), |board| board.nearest(unit(q)))
}

/// Sets the last drive, rounded to the board's nearest phases. Every transducer that reaches a point must have a phase.
fn begin(last: &mut Last, problem: &Problem, drive: &[Complex32]) -> Result<()> {
    let propagation = problem.propagation();
    let reaches = |i: usize| (0..propagation.points()).any(|j| propagation.exact(j, i).norm() > 0.0);
    if let Some(i) = drive.iter().enumerate().position(|(i, q)| *q == Complex32::ZERO && reaches(i)) {
        let cure = "a transducer that is off has no phase to begin with: give |q| above 0, or no start";
        return Err(Error::invalid(format!("start[{i}]"), 0, cure));
    }
    last.begin(drive.iter().map(|&q| placed(problem, q)));
    Ok(())
}

/// A frame while it is computed. Its drives are relative to the drives played last.
struct Frame<'w> {
    rows: Rows<'w>,
    wave: Wave<'w>,
    trial: Wave<'w>,
    projector: Projector<'w>,
    weights: Buffer<'w, f32>,
    /// The pressures a G y (see the module's head) that earlier envelopes still make; `None` without an envelope.
    rest: Option<[Buffer<'w, f32>; 2]>,
    /// The part of an envelope that a frame replaces.
    part: f32,
    /// Whether phases are not bounded, as in the first frame.
    free: bool,
    arc: Arc,
    /// The largest code on the board's grid; infinite where phases are free.
    most: f32,
}

impl<'w> Frame<'w> {
    fn new(
        glide: &Glide,
        free: bool,
        problem: &Problem,
        last: &mut Last,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self> {
        let mut rows = Rows::alike(problem, &[], work, control)?;
        let mut wave = Wave::new(&rows, work);
        let kept = if glide.tau > 0.0 { math::exp(-1.0 / (glide.rate * glide.tau)) } else { 0.0 };
        let part = (1.0 - kept) as f32;
        let rest = (kept > 0.0).then(|| {
            wave.scaled(&rows, &last.envelope, kept as f32);
            wave.hear(&rows);
            [0, 1].map(|plane: usize| {
                let mut rest = work.floats.take_any(rows.count);
                rest.copy_from_slice(&wave.field[plane]);
                rest
            })
        });
        wave.scaled(&rows, &last.played, part);
        if !all_sound(rows.set, rows.tiles(), [&wave.drive[0], &wave.drive[1]], last.played.len()) {
            last.reach(|i| rows.tiles().reaches(i));
            wave.scaled(&rows, &last.played, part);
        }
        rows.rotate(&wave.drive);
        wave.relate(&rows, &last.wave, &last.played);
        let phases = problem.quantization().and_then(Quantization::phases);
        let step = phases.map(|count| TAU / f64::from(count));
        let codes = phases.map_or(f64::INFINITY, |count| steps_within(glide.change, count));
        let change = if free { PI } else { step.map_or(glide.change, |step| codes * step).min(PI) };
        let most = if change < PI { codes as f32 } else { f32::INFINITY };
        let arc = [math::cos(change), math::sin(change)].map(|x| x as f32);
        let (trial, projector) = (Wave::new(&rows, work), Projector::new(&rows, work));
        let mut weights = work.floats.take_any(rows.targeted);
        if last.weights.len() == weights.len() {
            weights.copy_from_slice(&last.weights);
        } else {
            weights.fill(1.0);
        }
        let mut frame = Self { rows, wave, trial, projector, weights, rest, part, free, arc, most };
        frame.wave.hear(&frame.rows);
        add(&mut frame.wave, frame.rest.as_ref());
        Ok(frame)
    }

    /// Does weighted sweeps within the arc, from the point phases of the wave.
    fn sweep(&mut self, glide: &Glide, control: &mut Control) -> Result<()> {
        let Self { rows, wave, projector, weights, rest, arc, free, .. } = self;
        // A single point needs no weight, so one sweep is enough for it.
        let sweeps = match rows.targeted {
            1 => glide.sweeps.min(1),
            _ if *free => glide.sweeps.saturating_mul(FIRST),
            _ => glide.sweeps,
        };
        for _ in 0..sweeps {
            control.pulse()?;
            projector.want(wave, weights);
            projector.project_within(rows, *arc, wave);
            add(wave, rest.as_ref());
            let level = wave.level(rows);
            let mut largest = 0.0_f32;
            for (weight, &modulus) in weights.iter_mut().zip(&wave.moduli) {
                let change = if modulus > 0.0 { level / modulus } else { MOST_CHANGE };
                *weight *= change.clamp(1.0 / MOST_CHANGE, MOST_CHANGE);
                largest = largest.max(*weight);
            }
            for weight in weights.iter_mut() {
                *weight /= largest;
            }
        }
        Ok(())
    }

    /// Does Gauss-Newton steps of the phases that are not at their bound; returns whether all points are nearly even.
    fn level(
        &mut self,
        glide: &Glide,
        problem: &Problem,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Status> {
        let Self { rows, wave, trial, rest, arc, .. } = self;
        let hear = |wave: &mut Wave<'_>| add(wave, rest.as_ref());
        let steps = Steps { arc: *arc, most: glide.steps, even: EVEN };
        let off = even_within(steps, problem, rows, &hear, (wave, trial), work, control)?;
        Ok(if off <= NEARLY { Status::Done } else { Status::OutOfSteps })
    }

    /// Rounds foci to the board's grid, and stores them. The last codes are kept if they are nearly even and no worse than
    /// when they were chosen, or if the new codes are not better although they come from an even field.
    fn keep_foci(
        &mut self,
        problem: &Problem,
        last: &mut Last,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<()> {
        let Self { rows, wave, trial, weights, rest, most, .. } = self;
        let grid = problem.quantization().map(Quantization::grid);
        let phases = grid.and_then(|grid| grid.phases.as_ref());
        let off = |wave: &Wave| wave.unevenness(rows, wave.level(rows), 0.0);
        let keeps = |trial: &Wave, wave: &Wave, unevenness: f32| {
            off(trial) <= NO_WORSE * unevenness && trial.level(rows) >= AS_LOUD * wave.level(rows)
        };
        if phases.is_some() {
            trial.relate(rows, &last.played, &last.played);
            trial.hear(rows);
            add(trial, rest.as_ref());
            if off(trial) <= NEARLY && keeps(trial, wave, last.unevenness) {
                // The new wave is not stored: if the points do not move, the next frame finds the same result and keeps
                // its codes, too.
                core::mem::swap(wave, trial);
                return Ok(());
            }
        }
        last.wave.copy_from_slice(&last.played);
        rotate_list(rows.set, [&wave.drive[0], &wave.drive[1]], &mut last.wave);
        last.weights.clear();
        last.weights.extend_from_slice(weights);
        if let Some(phases) = phases {
            let even = off(wave) <= NEARLY;
            weights.fill(1.0);
            let mut memory = work.floats.take_any(error_diffusion::floats(rows.targeted));
            let mut codes = work.floats.take_any(rows.lanes);
            let (most, targeted) = (*most, rows.targeted);
            let tiles = rows.tiles();
            let choice = error_diffusion::Choice::in_motion(phases, most);
            let task = error_diffusion::Task { tiles, choice, weights, targeted, memory: &mut memory };
            let field = wave.field.each_ref().map(|plane| &plane[..targeted]);
            let drive = wave.drive.each_mut().map(|plane| &mut plane[..]);
            error_diffusion::diffuse(rows.set, task, drive, field, &mut codes, control)?;
            wave.hear(rows);
            add(wave, rest.as_ref());
            let kept = even && keeps(trial, wave, off(wave) / NO_WORSE);
            if kept {
                core::mem::swap(wave, trial);
            }
            last.unevenness = off(wave);
            if kept {
                return Ok(());
            }
        }
        rotate_list(rows.set, [&wave.drive[0], &wave.drive[1]], &mut last.played);
        if let Some(grid) = grid {
            grid.round(rows.set, 1.0, [1.0; 2], &mut last.played);
        }
        Ok(())
    }

    /// Returns the solution, reduced to the targets.
    fn answer(
        self,
        problem: &Problem,
        status: Status,
        last: &mut Last,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Solution> {
        let Self { rows, mut wave, rest, part, .. } = self;
        for (y, q) in last.envelope.iter_mut().zip(&last.played) {
            *y += (q - *y) * part;
        }
        let grid = problem.quantization().map(Quantization::grid);
        if grid.is_some_and(|grid| grid.phases.is_none()) || rest.is_some() {
            // The reported field is the one that the drives make once the envelopes have reached them.
            wave.hear(&rows);
            let scale = 1.0 / part;
            wave.field.iter_mut().chain([&mut wave.moduli]).for_each(|list| list.iter_mut().for_each(|x| *x *= scale));
        }
        let mut drive = work.complexes.take(last.played.len()).into_vec();
        drive.copy_from_slice(&last.played);
        Answer { drive, status, steps: (1, 1), mixed: false }.brought_down(problem, &rows, &wave, work, control)
    }
}

/// Adds to a wave's field the field that remains of the last frame's envelopes.
fn add(wave: &mut Wave<'_>, rest: Option<&[Buffer<'_, f32>; 2]>) {
    let Some(rest) = rest else { return };
    for (field, rest) in wave.field.iter_mut().zip(rest) {
        field.iter_mut().zip(&rest[..]).for_each(|(field, rest)| *field += rest);
    }
    wave.measure();
}
