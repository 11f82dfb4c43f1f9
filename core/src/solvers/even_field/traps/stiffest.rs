//! Traps without pressures: turns the phases until the softest of all traps is as stiff as possible.
//!
//! Foci beside the traps keep their pressures ([`crate::solvers::even_field::traps::foci`]).
//!
//! The objective is the soft minimum ([`soft_minimum`]) of K_ja, the stiffness at point j along its axis a, relative to
//! the least stiffness at the start of a stage. Subtracted from it is the mean square of the distances |H|^-1 (F - m g)
//! at which the beads rest, relative to [`APART`], times a weight. H are the second derivatives of the potential at the
//! start of the stage, F the force and m g the weight of a bead.
//!
//! Equal foci are not equal traps: each is in the waves of the others, and across the boards' axis traps are a tenth as
//! stiff as along it. Foci do not distinguish x and y, so that their levels alone reach at most nine tenths of what
//! direct optimisation finds. From the foci a few steps of [`crate::solvers::common::phase_descent`] reach 96 %.

use crate::kernels::InstructionSet;
use crate::kernels::propagate::rows;
use crate::prelude::*;
use crate::problem::Problem;
use crate::propagation::forces::rest::firmness;
use crate::propagation::forces::stiffness::Stiffness;
use crate::propagation::jet::TERMS;
use crate::scene::{Aim, Signature, dot};
use crate::solvers::common::phase_descent::{Cost, PhaseDescent};
use crate::solvers::common::tiled::{Rows, Wave};
use crate::solvers::even_field::run::Run;
use crate::solvers::even_field::traps::foci::{FixedFoci, Off};
use crate::solvers::even_field::traps::{on_grid, soft_minimum};
use crate::workspace::Workspace;

/// For each stage, the sharpness of the soft minimum and the weight of the resting places.
const STAGES: [(f64, f64); 2] = [(8.0, 0.02), (32.0, 0.1)];
/// Largest number of steps in a stage: twice as many gain only 1 %.
const STEPS: usize = 30;

/// Largest number of times that the last stage is repeated if there are foci.
const AGAIN: usize = 3;
/// The last stage is repeated until the relative error of each focus is at most this.
const NEAR: f64 = 3e-4;

/// Distance in m of beads from their points that costs as much as the loss of all stiffness, times the weight of the
/// stage.
const APART: f64 = 1e-4;

/// Lower bound of the unit of stiffness, relative to the largest stiffness: soft traps then become stiff, and no
/// division by 0 occurs.
const LEAST: f64 = 0.01;

/// The cost of traps: the negative soft minimum of their stiffnesses in parts of `unit`, and a penalty for the
/// distances of resting beads from their points.
pub(super) struct Softest<'a> {
    stiffness: &'a Stiffness,
    fixed: &'a FixedFoci,
    /// The sharpness of the minimum, and the weight of the resting places.
    stage: (f64, f64),
    /// The unit of stiffness: the least stiffness at the start of the stage, see [`LEAST`].
    pub(super) unit: f64,
    /// The inverse of |H| of each point (see the module's head).
    yielding: Vec<[[f64; 3]; 3]>,
    /// A field that is added to that of the drives.
    beside: Option<[&'a [f32]; 2]>,
}

impl<'a> Softest<'a> {
    /// Creates the cost of the last stage, with the unit of stiffness from a field.
    pub(super) fn last(
        traps: (&'a Stiffness, &'a FixedFoci),
        field: [&[f32]; 2],
        beside: Option<[&'a [f32]; 2]>,
    ) -> Self {
        Self { beside, ..Self::new(traps, field, STAGES[STAGES.len() - 1]) }
    }

    fn new((stiffness, fixed): (&'a Stiffness, &'a FixedFoci), field: [&[f32]; 2], stage: (f64, f64)) -> Self {
        let now: Vec<f64> = stiffness.at(field).collect();
        let largest = now.iter().fold(0.0, |most: f64, k| most.max(k.abs()));
        let unit = least(&now).max(LEAST * largest).max(f64::MIN_POSITIVE);
        Self { stiffness, fixed, stage, unit, yielding: stiffness.balance(field).1, beside: None }
    }

    /// Returns the cost of a field.
    pub(super) fn of_field(&self, field: [&[f32]; 2]) -> f64 {
        let fixed = self.fixed.cost(self.fixed.off(self.stiffness, field).map(|focus| focus.part));
        soft_minimum::negated(self.parts(field).into_iter(), self.stage.0) + self.apart(field).0 + fixed
    }

    /// Returns the field of a wave plus the field `beside`.
    fn field_at<'b>(&self, wave: &'b Wave) -> [Cow<'b, [f32]>; 2] {
        [0, 1].map(|part| match self.beside {
            None => Cow::Borrowed(&wave.field[part][..]),
            Some(beside) => wave.field[part].iter().zip(beside[part]).map(|(own, beside)| own + beside).collect(),
        })
    }

    fn parts(&self, field: [&[f32]; 2]) -> Vec<f64> {
        self.stiffness.at(field).map(|k| k / self.unit).collect()
    }

    /// Returns the penalty of the resting places, and its derivatives by the net forces (M, 3).
    fn apart(&self, field: [&[f32]; 2]) -> (f64, Vec<[f64; 3]>) {
        let (net, _) = self.stiffness.balance(field);
        let share = self.stage.1 / (APART * APART * net.len() as f64);
        let (mut sum, mut slopes) = (0.0, Vec::with_capacity(net.len()));
        for (net, yielding) in net.iter().zip(&self.yielding) {
            let shift = yielding.map(|row| dot(row, *net));
            sum += share * dot(shift, shift);
            slopes.push([0, 1, 2].map(|a| 2.0 * share * (0..3).map(|b| yielding[b][a] * shift[b]).sum::<f64>()));
        }
        (sum, slopes)
    }
}

impl Cost for Softest<'_> {
    fn of(&self, wave: &Wave) -> f64 {
        let field = self.field_at(wave);
        self.of_field([&field[0], &field[1]])
    }

    fn pull(&self, wave: &Wave, mut pulls: [&mut [f32]; 2]) {
        let field = self.field_at(wave);
        let field = [&field[0][..], &field[1]];
        let parts = self.parts(field);
        let (least, sum) = soft_minimum::shares(parts.iter().copied(), self.stage.0);
        let share = |k: &f64| math::exp(self.stage.0 * (least - k)) / (-self.unit * sum);
        let weights: Vec<f64> = parts.iter().map(share).collect();
        self.stiffness.pull(field, &weights, &self.apart(field).1, pulls.each_mut().map(|plane| &mut **plane));
        for (Off { row, slope, .. }, pulled) in self.fixed.pulled(self.fixed.off(self.stiffness, field)) {
            pulls.iter_mut().zip(slope).for_each(|(plane, slope)| plane[row * TERMS] = (pulled * slope) as f32);
        }
    }
}

/// Returns the traps of a problem that requests nothing from its traps but stiffness, together with the foci beside
/// them; `None` for any other problem.
///
/// # Errors
/// More memory than allowed, a stop.
pub(crate) fn requested(problem: &Problem, control: &mut Control) -> Result<Option<Stiffness>, Error> {
    let kept = problem.propagation().origin().and_then(|(_, _, kept)| kept);
    let trapping = problem.aim() == Aim::Max && !problem.asks_pressures() || problem.frees_traps();
    match kept.filter(|kept| trapping && kept.signature.as_ref().is_some_and(Signature::traps)) {
        Some(kept) => (kept.make.stiffness)(kept, problem.setup().bead, control),
        None => Ok(None),
    }
}

/// Returns the level of the foci beside traps in a field: |P| over the target of the weakest focus. For pressures
/// requested in Pa it returns 1.
pub(super) fn level(traps: &Stiffness, problem: &Problem, field: [&[f32]; 2]) -> f64 {
    if problem.holds_pressures() {
        return 1.0;
    }
    let targets = traps.chosen()[1].iter().map(|&j| f64::from(problem.targets()[j]));
    let foci = targets.zip(traps.foci(field)).filter(|(target, _)| *target > 0.0);
    foci.map(|(target, (_, [re, im]))| math::hypot(re, im) / target).fold(f64::INFINITY, f64::min)
}

/// Returns C, the matrix from drives to derivatives of the field at the traps, in the layout of the kernels.
///
/// # Errors
/// More memory than allowed is needed, or a stop.
pub(super) fn rows<'w>(
    traps: &Stiffness,
    (set, transducers): (InstructionSet, usize),
    work: &'w Workspace,
    control: &mut Control,
) -> Result<Rows<'w>, Error> {
    let [re, im] = traps.planes();
    let order = work.counting(traps.rows());
    Rows::packed(set, rows::Rows::Stored { re, im }, transducers, order, work, control)
}

/// Changes a wave of even foci to one of equally stiff traps, if the problem requests such traps (see [`requested`]).
/// Returns whether it did. After a stop the foci stay.
///
/// # Errors
/// More memory than allowed is needed.
pub(crate) fn stiffen(run: &mut Run, foci: &mut Wave) -> Result<bool, Error> {
    match if run.stopped { Ok(false) } else { descend(run, foci) } {
        Err(error) if error.is_stop() => {
            run.stopped = true;
            Ok(false)
        }
        stiffened => stiffened,
    }
}

// Inlined, this function would enlarge the stack of every solve.
#[inline(never)]
fn descend(run: &mut Run, foci: &mut Wave) -> Result<bool, Error> {
    let (problem, work) = (run.problem, run.work);
    let traps = if problem.has_start() { None } else { requested(problem, run.control)? };
    let Some(traps) = traps else { return Ok(false) };
    let (set, transducers) = (run.rows.set, problem.propagation().transducers());
    let rows = rows(&traps, (set, transducers), work, run.control)?;
    let mut wave = Wave::new(&rows, work);
    wave.play_at_full(&rows, foci.drives(transducers, work).into_iter());
    let requested = FixedFoci::of(&traps, problem, level(&traps, problem, planes(&wave)));
    let begun = Softest::new((&traps, &requested), planes(&wave), STAGES[1]);
    let before = begun.of(&wave);
    let mut descent = PhaseDescent::new(wave, &begun, &rows, work);
    let mut fixed = requested.clone();
    for (round, stage) in STAGES.into_iter().chain([STAGES[1]; AGAIN]).enumerate() {
        let off = if round > 0 { fixed.learn(&traps, planes(&descent.wave)) } else { 0.0 };
        if round >= STAGES.len() && off <= NEAR {
            break;
        }
        let cost = Softest::new((&traps, &fixed), planes(&descent.wave), stage);
        descent.follow(&cost, &rows);
        for _ in 0..STEPS {
            if run.stopped || !run.report(foci) || !descent.step(&cost, &rows) {
                break;
            }
        }
    }
    if begun.of(&descent.wave) >= before {
        return Ok(false);
    }
    let mut drive = descent.wave.drives(transducers, work);
    if holds_less(problem, &traps, [&drive, &foci.drives(transducers, work)]) {
        return Ok(false);
    }
    if let Some(quantization) = problem.quantization() {
        let unit = Softest::new((&traps, &fixed), planes(&descent.wave), STAGES[1]).unit;
        let stop = &mut || {
            run.stopped = run.stopped || run.control.beat().is_err();
            run.stopped
        };
        on_grid::bring(set, (&traps, &fixed, unit), quantization, (&[], f32::INFINITY), (&mut drive, stop));
    }
    foci.play(run.rows, drive.into_iter());
    Ok(true)
}

/// Whether the first drive of one board before a reflector holds its beads less firmly than the second. Nodes are at fixed
/// distances from a reflector, so that a bead which is drawn to its point may lose most of the force.
fn holds_less(problem: &Problem, traps: &Stiffness, drives: [&[Complex32]; 2]) -> bool {
    let (propagation, bead) = (problem.propagation(), problem.setup().bead);
    let [first, second] = drives.map(|drive| firmness(propagation, bead, traps.chosen()[0], drive));
    first < second
}

pub(super) fn planes<'a>(wave: &'a Wave) -> [&'a [f32]; 2] {
    wave.field.each_ref().map(|plane| &plane[..])
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}
