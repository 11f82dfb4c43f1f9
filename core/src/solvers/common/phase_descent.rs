//! Phase descent: L-BFGS steps that rotate the drives, for any cost of the field at some rows.
//!
//! ```text
//! dE/dphi_i = Im(conj(q_i) sum_k conj(G_ki) (dE/dRe P_k + j dE/dIm P_k))        P = G q, |q_i| = 1
//! ```
//!
//! E is the cost, phi_i the phase of the drive q_i, P_k the pressure at row k. A step takes two products with G,
//! however many rows there are, and uses the curvature of the last steps ([`crate::solvers::common::quasi_newton`]).
//! Each drive rotates by the arc tangent of its entry of the step.
//!
//! With free amplitudes a drive is the mean of a pair of phasors, q_i = (a_i + b_i)/2, so that |q_i| <= 1 always holds.
//! The steps rotate both phasors, each with half of that slope.
//!
//! Within an arc around 1, drives that a step would turn out of the arc stay at its end. They are left out of the next
//! direction.

use crate::kernels::tiles;
use crate::math::{sqrtf, unit};
use crate::solvers::common::quasi_newton::{QuasiNewton, dot};
use crate::solvers::prelude::*;

/// The part of the predicted decrease that a step must reach.
const ENOUGH: f64 = 1e-4;

/// Number of trials of a step; each is at most half as long as the one before.
const TRIALS: usize = 12;

/// The largest entry of a first step. Its arc tangent, the rotation, is 0.29 rad.
const FIRST: f32 = 0.3;

/// The largest entry of a later step. The drive rotates by its arc tangent, which is always less than a quarter turn.
const LONGEST: f32 = 2.0;

/// A drive is at an end of its arc if its cosine differs from that of the end by at most this.
const AT_END: f32 = 1e-6;

/// The cost E that is minimised.
pub(crate) trait Cost {
    /// Returns E of a wave.
    fn of(&self, wave: &Wave) -> f64;

    /// Writes dE/dRe P and dE/dIm P of the rows.
    fn pull(&self, wave: &Wave, pulls: [&mut [f32]; 2]);
}

/// The largest modulus with which a pair begins: at 1 its two phasors would be equal, and no step would separate them.
const MOST_BEGUN: f32 = 0.97;

/// The pairs of phasors of all drives: the first phasor of each drive, then the second of each.
type Pairs<'w> = [Buffer<'w, f32>; 2];

/// The state of a descent.
pub(crate) struct PhaseDescent<'w> {
    pub(crate) wave: Wave<'w>,
    /// The cost E of the wave.
    pub(crate) cost: f64,
    trial: Wave<'w>,
    /// With free amplitudes, the pairs of the wave, and of the trial.
    pairs: Option<[Pairs<'w>; 2]>,
    /// Cosine and sine of the arc around 1 in which each drive must stay.
    arcs: Option<[Buffer<'w, f32>; 2]>,
    gradient: Buffer<'w, f32>,
    newton: QuasiNewton<'w>,
    pulls: [Buffer<'w, f32>; 2],
    sums: [Buffer<'w, f32>; 2],
}

impl<'w> PhaseDescent<'w> {
    /// Begins a descent by phases alone, |q| = 1.
    pub(crate) fn new(wave: Wave<'w>, cost: &impl Cost, rows: &Rows, work: &'w Workspace) -> Self {
        Self::by(None, None, wave, cost, rows, work)
    }

    /// Begins a descent by phases within an arc around 1, |q| = 1.
    pub(crate) fn within(
        arcs: [Buffer<'w, f32>; 2],
        wave: Wave<'w>,
        cost: &impl Cost,
        rows: &Rows,
        work: &'w Workspace,
    ) -> Self {
        Self::by(None, Some(arcs), wave, cost, rows, work)
    }

    /// Begins a descent by phases and amplitudes, |q| <= 1.
    pub(crate) fn with_amplitudes(mut wave: Wave<'w>, cost: &impl Cost, rows: &Rows, work: &'w Workspace) -> Self {
        let mut pairs = [(); 2].map(|()| [(); 2].map(|()| work.floats.take(2 * rows.lanes)));
        split(&wave.drive, rows, &mut pairs[0]);
        mean(&pairs[0], &mut wave);
        wave.hear(rows);
        Self::by(Some(pairs), None, wave, cost, rows, work)
    }

    fn by(
        pairs: Option<[Pairs<'w>; 2]>,
        arcs: Option<[Buffer<'w, f32>; 2]>,
        wave: Wave<'w>,
        cost: &impl Cost,
        rows: &Rows,
        work: &'w Workspace,
    ) -> Self {
        let phases = if pairs.is_some() { 2 * rows.lanes } else { rows.lanes };
        let mut descent = Self {
            trial: Wave::new(rows, work),
            wave,
            pairs,
            arcs,
            cost: 0.0,
            gradient: work.floats.take(phases),
            newton: QuasiNewton::new(work),
            pulls: [(); 2].map(|()| work.floats.take(rows.count)),
            sums: [(); 2].map(|()| work.floats.take_any(rows.lanes)),
        };
        descent.follow(cost, rows);
        descent
    }

    /// Continues with another cost.
    pub(crate) fn follow(&mut self, cost: &impl Cost, rows: &Rows) {
        self.newton.forget();
        self.cost = cost.of(&self.wave);
        self.slope(cost, rows);
    }

    /// Writes the gradient at the wave.
    fn slope(&mut self, cost: &impl Cost, rows: &Rows) {
        cost.pull(&self.wave, self.pulls.each_mut().map(|plane| &mut plane[..]));
        let ([re, im], [sum_re, sum_im]) = (&self.pulls, &mut self.sums);
        tiles::correlate(rows.set, rows.tiles(), [re, im], [&mut *sum_re, &mut *sum_im]);
        let (share, [qr, qi]) = self.pairs.as_ref().map_or((1.0, &self.wave.drive), |[own, _]| (0.5, own));
        for (k, own) in self.gradient.chunks_exact_mut(rows.lanes).enumerate() {
            let [qr, qi] = [qr, qi].map(|part| &part[k * rows.lanes..]);
            for (i, gradient) in own.iter_mut().enumerate() {
                *gradient = share * (qr[i] * sum_im[i] - qi[i] * sum_re[i]);
            }
        }
    }

    /// Sets the entries to 0 that would turn drives out of their arc, along `sign` times the direction.
    fn hold(&self, direction: &mut [f32], sign: f32) {
        let Some([cos, _]) = &self.arcs else { return };
        let [re, im] = &self.wave.drive;
        for (((re, im), cos), x) in re.iter().zip(&im[..]).zip(&cos[..]).zip(direction) {
            if *cos > -1.0 && *re <= cos + AT_END && sign * *x * im > 0.0 {
                *x = 0.0;
            }
        }
    }

    /// Writes the wave after a part of a step to the trial.
    fn turn(&mut self, rows: &Rows, direction: &[f32], part: f32) {
        if let Some([cos, sin]) = &self.arcs {
            let mut turns = self.newton.work.floats.take_any(direction.len());
            turns.iter_mut().zip(direction).for_each(|(turn, x)| *turn = part * x);
            return self.trial.rotate_within(rows, &self.wave, &turns, [cos, sin]);
        }
        let Some([own, trial]) = &mut self.pairs else {
            return self.trial.rotate(rows, &self.wave, direction, part);
        };
        rotate(own, direction, part, trial);
        mean(trial, &mut self.trial);
        self.trial.hear(rows);
    }

    /// Makes the trial the present wave.
    fn accept(&mut self) {
        core::mem::swap(&mut self.wave, &mut self.trial);
        if let Some([own, trial]) = &mut self.pairs {
            core::mem::swap(own, trial);
        }
    }

    /// Writes the rotation of each drive by the last step, as the sine of the angle: arcs are short, so that the
    /// sine is near the angle.
    fn turned(&self, turns: &mut [f32]) {
        let ([re, im], [old_re, old_im]) = (&self.wave.drive, &self.trial.drive);
        for (i, turn) in turns.iter_mut().enumerate() {
            *turn = im[i] * old_re[i] - re[i] * old_im[i];
        }
    }

    /// Takes one step that lowers the cost; returns `false` if it finds none.
    pub(crate) fn step(&mut self, cost: &impl Cost, rows: &Rows) -> bool {
        loop {
            let work = self.newton.work;
            let [mut direction, mut change] = [(); 2].map(|()| work.floats.take_any(self.gradient.len()));
            direction.copy_from_slice(&self.gradient);
            self.hold(&mut direction, -1.0);
            self.newton.descend(&mut direction);
            self.hold(&mut direction, 1.0);
            let longest = direction.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
            let slope = dot(&direction, &self.gradient);
            if longest > 0.0 && slope < 0.0 {
                let limit = if self.newton.knows_nothing() { FIRST / longest } else { (LONGEST / longest).min(1.0) };
                let mut part = limit;
                for _ in 0..TRIALS {
                    self.turn(rows, &direction, part);
                    let trial = cost.of(&self.trial);
                    if trial <= self.cost + ENOUGH * f64::from(part) * slope {
                        self.accept();
                        self.cost = trial;
                        change.copy_from_slice(&self.gradient);
                        self.slope(cost, rows);
                        for (change, gradient) in change.iter_mut().zip(&self.gradient) {
                            *change = gradient - *change;
                        }
                        match self.arcs {
                            None => direction.iter_mut().for_each(|x| *x = libm::atanf(part * *x)),
                            Some(_) => self.turned(&mut direction),
                        }
                        self.newton.remember(&direction, &change);
                        return true;
                    }
                    // The minimum of the parabola through both costs and the slope.
                    let bend = trial - self.cost - f64::from(part) * slope;
                    let least = -0.5 * f64::from(part) * slope / bend;
                    part *= if bend > 0.0 { (least as f32).clamp(0.1, 0.5) } else { 0.5 };
                }
            }
            // No step along the direction lowers the cost: try once more along the gradient alone.
            if !self.newton.forget() {
                return false;
            }
        }
    }
}

/// Writes the pair of phasors whose mean is each drive; 0 for a transducer without effect.
fn split([qr, qi]: &[Buffer<'_, f32>; 2], rows: &Rows, [re, im]: &mut Pairs<'_>) {
    for i in (0..rows.lanes).filter(|&i| rows.tiles().reaches(i)) {
        let modulus = sqrtf(qr[i] * qr[i] + qi[i] * qi[i]);
        let (x, y) = unit(qr[i], qi[i]);
        let cos = modulus.min(MOST_BEGUN);
        let sin = sqrtf(1.0 - cos * cos);
        (re[i], im[i]) = (x * cos - y * sin, y * cos + x * sin);
        (re[rows.lanes + i], im[rows.lanes + i]) = (x * cos + y * sin, y * cos - x * sin);
    }
}

/// Writes the mean of each pair to the drives of a wave. Its field remains the old one.
fn mean(pairs: &Pairs<'_>, wave: &mut Wave<'_>) {
    for (drive, phasors) in wave.drive.iter_mut().zip(pairs) {
        let (first, second) = phasors.split_at(drive.len());
        drive.iter_mut().zip(first.iter().zip(second)).for_each(|(q, (a, b))| *q = 0.5 * (a + b));
    }
}

/// Rotates each phasor by the phase atan(`part` `direction`) at modulus 1; 0 stays 0.
fn rotate([qr, qi]: &Pairs<'_>, direction: &[f32], part: f32, [re, im]: &mut Pairs<'_>) {
    for (i, direction) in direction.iter().enumerate() {
        let slope = part * direction;
        let (x, y) = (qr[i] - slope * qi[i], qi[i] + slope * qr[i]);
        let scale = 1.0 / sqrtf((x * x + y * y).max(f32::MIN_POSITIVE));
        (re[i], im[i]) = (scale * x, scale * y);
    }
}
