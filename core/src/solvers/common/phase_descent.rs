//! Phase descent: L-BFGS steps that rotate the drives, for any cost of the field at some rows.
//!
//! ```text
//! dE/dphi_i = Im(conj(q_i) sum_k conj(G_ki) (dE/dRe P_k + j dE/dIm P_k))        P = G q, |q_i| = 1
//! ```
//!
//! A step costs two products with G, however many rows there are, and curvature is learnt from the last steps
//! ([`crate::solvers::common::quasi_newton`]). Each drive rotates by the arc tangent of what a step asks for.
//!
//! With amplitudes free a drive is the mean of a pair of phasors, q_i = (a_i + b_i)/2, so that |q_i| <= 1 holds by itself:
//! the steps rotate both, each by half of that slope.
//!
//! Within an arc around 1 drives that a step would turn out of it stay at its end, and are left out of the next direction.

use crate::kernels::tiles;
use crate::kernels::tiles::unit::Arc;
use crate::math::{sqrtf, unit};
use crate::solvers::common::quasi_newton::{QuasiNewton, dot};
use crate::solvers::common::tiled::{Rows, Wave};
use crate::workspace::{Buffer, Workspace};

/// The part of the predicted decrease that a step must bring.
const ENOUGH: f64 = 1e-4;

/// Trials of a step, each at most half as long as the last.
const TRIALS: usize = 12;

/// The largest rotation of a first step, in rad.
const FIRST: f32 = 0.3;

/// The largest rotation of a step: its arc tangent is less than a quarter turn.
const LONGEST: f32 = 2.0;

/// A drive is at an end of its arc where its cosine is no further than this from that of the end.
const AT_END: f32 = 1e-6;

/// The quantity that is minimised.
pub(crate) trait Cost {
    /// E of a wave.
    fn of(&self, wave: &Wave) -> f64;

    /// Writes dE/dRe P and dE/dIm P of the rows.
    fn pull(&self, wave: &Wave, pulls: [&mut [f32]; 2]);
}

/// The largest modulus that a pair begins at: at 1 its two phasors are one, and nothing would draw them apart.
const MOST_BEGUN: f32 = 0.97;

/// The pairs of phasors of all drives: the first of each, then the second.
type Pairs<'w> = [Buffer<'w, f32>; 2];

/// A descent under way.
pub(crate) struct PhaseDescent<'w> {
    pub(crate) wave: Wave<'w>,
    /// E of the wave.
    pub(crate) cost: f64,
    trial: Wave<'w>,
    /// Where amplitudes are free: those of the wave, and of the trial.
    pairs: Option<[Pairs<'w>; 2]>,
    /// The penalty that keeps drives near 1.
    arc: Option<Arc>,
    gradient: Buffer<'w, f32>,
    newton: QuasiNewton<'w>,
    pulls: [Buffer<'w, f32>; 2],
    sums: [Buffer<'w, f32>; 2],
}

impl<'w> PhaseDescent<'w> {
    /// Descent by phases alone, |q| = 1.
    pub(crate) fn new(wave: Wave<'w>, cost: &impl Cost, rows: &Rows, work: &'w Workspace) -> Self {
        Self::by(None, None, wave, cost, rows, work)
    }

    /// Descent by phases within an arc around 1, |q| = 1.
    pub(crate) fn within(arc: Arc, wave: Wave<'w>, cost: &impl Cost, rows: &Rows, work: &'w Workspace) -> Self {
        Self::by(None, Some(arc), wave, cost, rows, work)
    }

    /// Descent by phases and amplitudes, |q| <= 1.
    pub(crate) fn with_amplitudes(mut wave: Wave<'w>, cost: &impl Cost, rows: &Rows, work: &'w Workspace) -> Self {
        let mut pairs = [(); 2].map(|()| [(); 2].map(|()| work.floats.take(2 * rows.lanes)));
        split(&wave.drive, rows, &mut pairs[0]);
        mean(&pairs[0], &mut wave);
        wave.hear(rows);
        Self::by(Some(pairs), None, wave, cost, rows, work)
    }

    fn by(
        pairs: Option<[Pairs<'w>; 2]>,
        arc: Option<Arc>,
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
            arc,
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
        let Some([cos, _]) = self.arc.filter(|[cos, _]| *cos > -1.0) else { return };
        let [re, im] = &self.wave.drive;
        for ((re, im), x) in re.iter().zip(&im[..]).zip(direction) {
            if *re <= cos + AT_END && sign * *x * im > 0.0 {
                *x = 0.0;
            }
        }
    }

    /// Writes the wave after a part of a step into the trial.
    fn turn(&mut self, rows: &Rows, direction: &[f32], part: f32) {
        if let Some(arc) = self.arc {
            let mut turns = self.newton.work.floats.take_any(direction.len());
            turns.iter_mut().zip(direction).for_each(|(turn, x)| *turn = part * x);
            return self.trial.rotate_within(rows, &self.wave, &turns, arc);
        }
        let Some([own, trial]) = &mut self.pairs else {
            return self.trial.rotate(rows, &self.wave, direction, part);
        };
        rotate(own, direction, part, trial);
        mean(trial, &mut self.trial);
        self.trial.hear(rows);
    }

    /// Takes the trial.
    fn accept(&mut self) {
        core::mem::swap(&mut self.wave, &mut self.trial);
        if let Some([own, trial]) = &mut self.pairs {
            core::mem::swap(own, trial);
        }
    }

    /// Writes by how much the last step turned each drive: by its sine, for arcs are short.
    fn turned(&self, turns: &mut [f32]) {
        let ([re, im], [old_re, old_im]) = (&self.wave.drive, &self.trial.drive);
        for (i, turn) in turns.iter_mut().enumerate() {
            *turn = im[i] * old_re[i] - re[i] * old_im[i];
        }
    }

    /// One step; whether there was one that lowers the cost.
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
                        match self.arc {
                            None => direction.iter_mut().for_each(|x| *x = libm::atanf(part * *x)),
                            Some(_) => self.turned(&mut direction),
                        }
                        self.newton.remember(&direction, &change);
                        return true;
                    }
                    // The least of the parabola through both costs and the slope.
                    let bend = trial - self.cost - f64::from(part) * slope;
                    let least = -0.5 * f64::from(part) * slope / bend;
                    part *= if bend > 0.0 { (least as f32).clamp(0.1, 0.5) } else { 0.5 };
                }
            }
            // The learnt direction leads nowhere: once more along the gradient alone.
            if !self.newton.forget() {
                return false;
            }
        }
    }
}

/// Writes the pair of phasors whose mean is each drive; none for a transducer without effect.
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

/// Writes the mean of each pair into the drives of a wave; its field is still the old one.
fn mean(pairs: &Pairs<'_>, wave: &mut Wave<'_>) {
    for (drive, phasors) in wave.drive.iter_mut().zip(pairs) {
        let (first, second) = phasors.split_at(drive.len());
        drive.iter_mut().zip(first.iter().zip(second)).for_each(|(q, (a, b))| *q = 0.5 * (a + b));
    }
}

/// Rotates each phasor by the phase atan(`part` `direction`) at modulus 1, 0 staying 0.
fn rotate([qr, qi]: &Pairs<'_>, direction: &[f32], part: f32, [re, im]: &mut Pairs<'_>) {
    for (i, direction) in direction.iter().enumerate() {
        let slope = part * direction;
        let (x, y) = (qr[i] - slope * qi[i], qi[i] + slope * qr[i]);
        let scale = 1.0 / sqrtf((x * x + y * y).max(f32::MIN_POSITIVE));
        (re[i], im[i]) = (scale * x, scale * y);
    }
}
