//! Even fields at the highest common level: every |p_j| the same multiple of its target.
//!
//! Point phases that reinforce one another are found on G, or several on the matrix of couplings ([`point_phases`]); weighted
//! Gerchberg-Saxton sweeps with |q| = 1 raise the weakest points ([`weighted_sweeps`]); Gauss-Newton steps on
//! |P_j| = s p_j, the level s free, make all alike ([`common_level`]).
//!
//! Rows of G are divided by their targets, so that all points ask for the same; the quiet ones come last.

pub(crate) mod coincident;
pub(crate) mod common_level;
pub(crate) mod point_phases;
pub(crate) mod weighted_sweeps;

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::Control;
use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tiles;
use crate::kernels::tiles::Tiles;
use crate::linalg::Planar;
use crate::math::sqrtf;
use crate::problem::solution::{Solution, Status};
use crate::problem::{Aim, Problem};
use crate::solvers::common::refinement::refine;
use crate::solvers::even_field::point_phases::Starts;
use crate::workspace::{Aligned, Workspace};

/// The most that a target may be raised to the largest one's size: squares stay within f32.
const MOST_RAISED: f32 = 1e12;

/// How much work to spend.
pub(crate) struct Plan {
    /// Point phases tried: one on G, several on the matrix of couplings.
    pub(crate) starts: usize,
    /// How many of the best of them are carried on to drives.
    pub(crate) finalists: usize,
    /// Seed of the point phases.
    pub(crate) seed: u64,
    /// Weighted sweeps for each.
    pub(crate) sweeps: usize,
    /// Even enough: the largest deviation from the common level, relative to it.
    pub(crate) tolerance: f32,
}

/// G as tiles of 16 transducers, a row a point, each row in units of its target.
struct Rows {
    /// The problem's point of each row.
    order: Vec<u32>,
    /// Rows of points with a target: the first ones.
    loud: usize,
    /// Rows of G: the points, and zeros.
    count: usize,
    /// Length of a vector over the transducers.
    lanes: usize,
    /// Factor of each row.
    scale: Vec<f32>,
    /// What every loud row asks for.
    target: f32,
    planes: [Aligned; 2],
    set: InstructionSet,
}

impl Rows {
    fn new(problem: &Problem, work: &mut Workspace) -> Self {
        let (propagation, targets) = (problem.propagation(), problem.targets());
        let points = propagation.points();
        let count = tiles::height(points);
        let mut order = work.indices.take(points);
        let heard = |j: &u32| targets[*j as usize] > 0.0;
        let all = 0..points as u32;
        for (own, j) in order.iter_mut().zip(all.clone().filter(heard).chain(all.filter(|j| !heard(j)))) {
            *own = j;
        }
        let target = targets.iter().copied().fold(0.0, f32::max);
        let mut scale = work.floats.take(count);
        for (scale, &j) in scale.iter_mut().zip(&order) {
            let own = targets[j as usize];
            *scale = if own > 0.0 { (target / own).min(MOST_RAISED) } else { 1.0 };
        }
        let lanes = tiles::lanes(propagation.transducers());
        let mut planes = [(); 2].map(|()| Aligned::take(tiles::size(count, lanes), work));
        let [re, im] = &mut planes;
        tiles::pack(
            propagation.instruction_set(),
            propagation.rows(),
            propagation.transducers(),
            (&order, &scale),
            [re, im],
        );
        let loud = (0..points as u32).filter(heard).count();
        Self { order, loud, count, lanes, scale, target, planes, set: propagation.instruction_set() }
    }

    /// Multiplies row `k` by `factor`.
    fn rescale(&mut self, k: usize, factor: f32) {
        self.scale[k] *= factor;
        for plane in &mut self.planes {
            tiles::rescale(plane, self.lanes, k, factor);
        }
    }

    fn tiles(&self) -> Tiles<'_> {
        let [re, im] = &self.planes;
        Tiles { planes: [re, im], lanes: self.lanes }
    }

    fn give(self, work: &mut Workspace) {
        work.indices.give(self.order);
        work.floats.give(self.scale);
        self.planes.into_iter().for_each(|plane| plane.give(work));
    }
}

/// A drive and its field at the rows.
struct Wave {
    drive: [Vec<f32>; 2],
    field: [Vec<f32>; 2],
    moduli: Vec<f32>,
}

impl Wave {
    fn new(rows: &Rows, work: &mut Workspace) -> Self {
        let mut pair = |size: usize| [(); 2].map(|()| work.floats.take_any(size));
        let (drive, field) = (pair(rows.lanes), pair(rows.count));
        Self { drive, field, moduli: work.floats.take(rows.count) }
    }

    /// What `play` of a kernel makes of it, and the moduli.
    fn set(&mut self, play: impl FnOnce(tiles::Wave<'_>)) {
        let [drive, field] =
            [&mut self.drive, &mut self.field].map(|pair| pair.each_mut().map(Vec::as_mut_slice));
        play(tiles::Wave { drive, field });
        for (modulus, (re, im)) in self.moduli.iter_mut().zip(self.field[0].iter().zip(&self.field[1])) {
            *modulus = sqrtf(re * re + im * im);
        }
    }

    /// What the directions of another `drive` make.
    fn play(&mut self, rows: &Rows, drive: &[Complex32], work: &mut Workspace) {
        let size = self.drive[0].len();
        let [mut re, mut im, still] = [(); 3].map(|()| work.floats.take(size));
        for ((re, im), q) in re.iter_mut().zip(&mut im).zip(drive) {
            (*re, *im) = (q.re, q.im);
        }
        self.set(|wave| tiles::turn(rows.set, rows.tiles(), [&re, &im], &still, 0.0, wave));
        work.floats.give_all([re, im, still]);
    }

    fn copy(&mut self, other: &Self) {
        let own = self.drive.iter_mut().chain(&mut self.field).chain([&mut self.moduli]);
        let others = other.drive.iter().chain(&other.field).chain([&other.moduli]);
        own.zip(others).for_each(|(own, other)| own.copy_from_slice(other));
    }

    fn drive(&self) -> [&[f32]; 2] {
        [&self.drive[0], &self.drive[1]]
    }

    /// |P| of the weakest loud point.
    fn lowest(&self, rows: &Rows) -> f32 {
        self.moduli[..rows.loud].iter().copied().fold(f32::INFINITY, f32::min)
    }

    /// The mean |P| of the loud points.
    fn level(&self, rows: &Rows) -> f32 {
        self.moduli[..rows.loud].iter().sum::<f32>() / rows.loud as f32
    }

    /// The largest deviation from `level`, the quiet points' from silence, relative to it.
    fn unevenness(&self, rows: &Rows, level: f32) -> f32 {
        if level == 0.0 {
            return f32::INFINITY;
        }
        let (loud, quiet) = self.moduli.split_at(rows.loud);
        let deviations = loud.iter().map(|x| (x / level - 1.0).abs()).chain(quiet.iter().map(|x| x / level));
        deviations.fold(0.0, f32::max)
    }

    fn give(self, work: &mut Workspace) {
        work.floats.give_all(self.drive);
        work.floats.give_all(self.field);
        work.floats.give(self.moduli);
    }
}

/// The caller's hand on the solve: counts steps and tells each.
struct Watch<'a, 'b> {
    problem: &'a Problem,
    control: &'a mut Control<'b>,
    step: usize,
    steps: usize,
    stopped: bool,
    /// Moduli in the problem's order and unit.
    moduli: Vec<f32>,
}

impl Watch<'_, '_> {
    /// Whether to go on after a step to `wave`. A step is told when the next one is done: the last one's residual is
    /// that of the answer, which is told when it is made.
    fn told(&mut self, rows: &Rows, wave: &Wave) -> bool {
        let (problem, moduli) = (self.problem, &self.moduli);
        if self.step > 0 {
            self.stopped = self.control.step(self.step, self.steps, || problem.residual(moduli)).is_break();
        }
        if !self.stopped {
            self.step += 1;
            for (k, &j) in rows.order.iter().enumerate() {
                self.moduli[j as usize] = wave.moduli[k] / rows.scale[k];
            }
        }
        !self.stopped
    }
}

/// An even drive, at the level that the problem aims at.
pub(crate) fn solve(problem: &Problem, plan: &Plan, work: &mut Workspace, control: &mut Control) -> Solution {
    let mut rows = Rows::new(problem, work);
    let starts = Starts::new(problem, &mut rows, plan, work);
    let moduli = work.floats.take(problem.propagation().lanes());
    let steps = starts.count * (1 + plan.sweeps + common_level::MOST_STEPS) + common_level::MOST_STEPS;
    let mut watch = Watch { problem, control, step: 0, steps, stopped: false, moduli };
    let mut best = Wave::new(&rows, work);
    let mut wave = Wave::new(&rows, work);
    let mut reached = (false, -1.0);
    for start in 0..starts.count {
        weighted_sweeps::raise(&rows, &starts, start, plan.sweeps, &mut wave, &mut watch, work);
        let even = common_level::polish(problem, &rows, None, plan.tolerance, &mut wave, &mut watch, work);
        if (even, wave.lowest(&rows)) > reached {
            reached = (even, wave.lowest(&rows));
            core::mem::swap(&mut best, &mut wave);
        }
        if watch.stopped {
            break;
        }
    }
    let wanted = problem.aim() == Aim::Target;
    // With many points the target may lie above the level where free steps end, and still be in reach.
    if wanted
        && !watch.stopped
        && reached.1 < rows.target
        && 4 * rows.loud >= problem.propagation().transducers()
    {
        wave.copy(&best);
        let level = Some(rows.target);
        if common_level::polish(problem, &rows, level, plan.tolerance, &mut wave, &mut watch, work) {
            reached.0 = true;
            core::mem::swap(&mut best, &mut wave);
        }
    }
    let mut drive = work.complexes.take(problem.propagation().transducers());
    for (i, q) in drive.iter_mut().enumerate() {
        *q = Complex32::new(best.drive[0][i], best.drive[1][i]);
    }
    let quantization = problem.propagation().quantization();
    if quantization.is_some() {
        // At full drive, where the grid is finest; what it makes at the points is heard anew.
        refine(problem, &mut drive, work);
        best.play(&rows, &drive, work);
    }
    let loudest = best.moduli[..rows.loud].iter().copied().fold(0.0, f32::max);
    let factor = if wanted && loudest > rows.target { f64::from(rows.target / loudest) } else { 1.0 };
    let (amplitude, scale) = quantization.map_or((factor, 1.0), |quantization| quantization.lowered(factor));
    for q in &mut drive {
        *q *= amplitude as f32;
    }
    let mut field = Planar::zeros(1, problem.propagation().lanes(), work);
    for (field, own) in [&mut field.re, &mut field.im].into_iter().zip(&best.field) {
        for (k, &j) in rows.order.iter().enumerate() {
            field[j as usize] = own[k] / rows.scale[k] * amplitude as f32;
        }
    }
    let status = match (watch.stopped, reached.0) {
        (true, _) => Status::Stopped,
        (_, true) => Status::Done,
        _ => Status::OutOfSteps,
    };
    let step = watch.step;
    work.floats.give(watch.moduli);
    best.give(work);
    wave.give(work);
    starts.give(work);
    rows.give(work);
    let mut solution = Solution::of_field(problem, drive, field, status, step, work).scaled(scale);
    solution.tell(problem, steps, control);
    solution
}
