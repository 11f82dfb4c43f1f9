//! Damped Gauss-Newton steps on |P_j| = s p_j in the phases of the drives.
//!
//! With J the derivatives of the moduli, the shortest step that meets a level s is d = J^T y,
//! (J J^T + mu W^-1) y = s p - |P|: an M x M system however many transducers there are. The free level is the one
//! of the shortest step. A quiet point enters with two rows, Re P = Im P = 0, and a heavy one is damped less.

use alloc::vec::Vec;

use crate::kernels::lanes::padded;
use crate::kernels::tiles;
use crate::kernels::tiles::products;
use crate::linalg::Cholesky;
use crate::problem::Problem;
use crate::solvers::even_field::{Rows, Watch, Wave};
use crate::workspace::{Aligned, Workspace};

/// Steps at most: four are enough where the points are fewer than a quarter of the transducers, ten where they are
/// half as many.
pub(super) const MOST_STEPS: usize = 20;

/// Damping mu of the first step, relative to the mean diagonal entry of J J^T.
const DAMPING: f32 = 1e-6;

/// Derivatives serve once more while a step leaves less than this part of the squares: most of a step's time goes into
/// them.
const SLOW: f64 = 0.01;

/// The largest change of a phase in rad: beyond it |P| is no longer near its tangent.
const MOST_TURN: f32 = 1.0;

/// The least weight told apart from 0.
const LEAST_WEIGHT: f32 = 1e-6;

/// Makes `wave` even at `level`, or at the level nearest by; whether it is, to `tolerance`.
pub(super) fn polish(
    problem: &Problem,
    rows: &Rows,
    level: Option<f32>,
    tolerance: f32,
    wave: &mut Wave,
    watch: &mut Watch,
    work: &mut Workspace,
) -> bool {
    let mut newton = Newton::new(problem, rows, work);
    let mut trial = Wave::new(rows, work);
    let mut begun = Wave::new(rows, work);
    begun.copy(wave);
    let mut damping = DAMPING;
    let mut even = false;
    let (mut renew, mut fresh) = (true, false);
    for step in 0..=MOST_STEPS {
        let level_here = |wave: &Wave| level.unwrap_or_else(|| wave.level(rows));
        even = wave.unevenness(rows, level_here(wave)) <= tolerance;
        if even || watch.stopped || step == MOST_STEPS {
            break;
        }
        if renew {
            newton.forget(work);
            newton.update(rows, wave);
            fresh = true;
        }
        let before = newton.cost(rows, wave, level_here(wave));
        let tried = newton.step(rows, wave, level, damping, &mut trial, work);
        let after = if tried { newton.cost(rows, &trial, level_here(&trial)) } else { f64::INFINITY };
        if after < before {
            core::mem::swap(wave, &mut trial);
            damping *= 0.1;
            renew = after > SLOW * before;
            fresh = false;
        } else {
            // Of old derivatives nothing is concluded.
            (renew, damping) = if fresh { (false, 10.0 * damping) } else { (true, damping) };
            newton.forget(work);
        }
        watch.told(rows, wave);
    }
    // More points than the transducers can make alike: no weaker for having tried, but for the sake of quiet ones.
    if !even && rows.loud == rows.order.len() && wave.lowest(rows) < begun.lowest(rows) {
        core::mem::swap(wave, &mut begun);
    }
    newton.give(work);
    trial.give(work);
    begun.give(work);
    even
}

/// What an equation is about: |P|, Re P or Im P.
fn heard(rows: &Rows, wave: &Wave, equation: usize) -> f32 {
    let points = rows.order.len();
    match equation {
        k if k < rows.loud => wave.moduli[k],
        k if k < points => wave.field[0][k],
        k => wave.field[1][k - points + rows.loud],
    }
}

/// The linear system at a wave.
struct Newton {
    /// Equations: the loud points, then the quiet ones' real and imaginary parts.
    size: usize,
    /// Rows of J: the equations, and zeros.
    count: usize,
    /// J.
    slopes: Aligned,
    /// J J^T, its upper half.
    matrix: Vec<f32>,
    /// Its factor, damped, and the solution for a rise of the level.
    factor: Option<(Cholesky, Vec<f32>)>,
    /// 1 / weight of each equation.
    ease: Vec<f32>,
    /// J d = f Re(dP) + g Im(dP).
    factors: [Vec<f32>; 2],
    turns: Vec<f32>,
}

impl Newton {
    fn new(problem: &Problem, rows: &Rows, work: &mut Workspace) -> Self {
        let quiet = rows.order.len() - rows.loud;
        let size = rows.loud + 2 * quiet;
        let count = tiles::height(size);
        let mut ease = work.floats.take(size);
        let points = rows.order.iter().chain(&rows.order[rows.loud..]);
        for (ease, &j) in ease.iter_mut().zip(points) {
            *ease = 1.0 / problem.weights()[j as usize].max(LEAST_WEIGHT);
        }
        Self {
            size,
            count,
            slopes: Aligned::take(tiles::size(count, rows.lanes), work),
            matrix: work.floats.take_any(size * padded(size)),
            factor: None,
            ease,
            factors: [(); 2].map(|()| work.floats.take(count)),
            turns: work.floats.take_any(rows.lanes),
        }
    }

    /// The weighted squares of what is missing from `level`, relative to it.
    fn cost(&self, rows: &Rows, wave: &Wave, level: f32) -> f64 {
        let missing = |k: usize| heard(rows, wave, k) / level - if k < rows.loud { 1.0 } else { 0.0 };
        (0..self.size).map(|k| f64::from(missing(k) * missing(k) / self.ease[k])).sum()
    }

    fn update(&mut self, rows: &Rows, wave: &Wave) {
        let (loud, points) = (rows.loud, rows.order.len());
        let [f, g] = &mut self.factors;
        // dP = j G q d, so that Re dP is -Im(G q) d and Im dP is Re(G q) d.
        for k in 0..loud {
            (f[k], g[k]) = (wave.field[1][k] / wave.moduli[k], -wave.field[0][k] / wave.moduli[k]);
        }
        (loud..points).for_each(|k| (f[k], g[k]) = (0.0, -1.0));
        (points..self.size).for_each(|k| (f[k], g[k]) = (1.0, 0.0));
        let (tiles, set) = (rows.tiles(), rows.set);
        let equations = (0..points).chain(loud..points);
        tiles::slopes(set, tiles, wave.drive(), [&*f, &*g], equations, &mut self.slopes);
        products::products(set, &self.slopes, rows.lanes, self.size, &mut self.matrix);
    }

    /// The factor of the damped matrix and the solution for a rise of the level; `None` if f32 cannot factor it.
    fn factored(&self, rows: &Rows, damping: f32, work: &mut Workspace) -> Option<(Cholesky, Vec<f32>)> {
        let (size, lanes) = (self.size, padded(self.size));
        let mut matrix = work.floats.take_any(size * lanes);
        matrix.copy_from_slice(&self.matrix);
        let mean = (0..size).map(|k| matrix[k * lanes + k]).sum::<f32>() / size as f32;
        for k in 0..size {
            matrix[k * lanes + k] += damping * mean * self.ease[k];
        }
        let cholesky = Cholesky::new(rows.set, matrix, size, work)?;
        let mut rise = work.floats.take(lanes.max(self.count));
        rise[..rows.loud].fill(1.0);
        cholesky.solve(&mut rise[..lanes]);
        Some((cholesky, rise))
    }

    /// Drops the factor.
    fn forget(&mut self, work: &mut Workspace) {
        if let Some((cholesky, rise)) = self.factor.take() {
            cholesky.give(work);
            work.floats.give(rise);
        }
    }

    /// Writes the wave after a step into `trial`; `false` if f32 cannot factor the system.
    fn step(
        &mut self,
        rows: &Rows,
        wave: &Wave,
        level: Option<f32>,
        damping: f32,
        trial: &mut Wave,
        work: &mut Workspace,
    ) -> bool {
        let factor = self.factor.take().or_else(|| self.factored(rows, damping, work));
        let Some((cholesky, rise)) = factor else { return false };
        // From the mean level, since s times one solution less another would cancel most digits.
        let middle = wave.level(rows);
        let mut dual = work.floats.take(rise.len());
        for (k, dual) in dual.iter_mut().enumerate().take(self.size) {
            *dual = if k < rows.loud { middle } else { 0.0 } - heard(rows, wave, k);
        }
        cholesky.solve(&mut dual[..padded(self.size)]);
        let sum = |values: &[f32]| values[..rows.loud].iter().map(|&x| f64::from(x)).sum::<f64>();
        let shift = level.map_or_else(|| (-sum(&dual) / sum(&rise)) as f32, |level| level - middle);
        dual.iter_mut().zip(&rise).for_each(|(dual, rise)| *dual += shift * rise);
        let most = tiles::combine(rows.set, &self.slopes, &dual[..self.count], &mut self.turns);
        work.floats.give(dual);
        self.factor = Some((cholesky, rise));
        let factor = if most > MOST_TURN { MOST_TURN / most } else { 1.0 };
        if !most.is_finite() {
            return false;
        }
        trial.set(|to| tiles::turn(rows.set, rows.tiles(), wave.drive(), &self.turns, factor, to));
        true
    }

    fn give(mut self, work: &mut Workspace) {
        self.forget(work);
        self.slopes.give(work);
        work.floats.give_all([self.matrix, self.ease, self.turns]);
        work.floats.give_all(self.factors);
    }
}
