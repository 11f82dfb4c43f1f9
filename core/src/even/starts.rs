//! Point phases that reinforce one another, found on the M x M matrix of couplings alone.
//!
//! The drive b = G^H v has the energy v^H (G G^H) v. With the moduli of v fixed, each phase in turn is set to what
//! the other points' waves make at its point: Gerchberg-Saxton as GS-PAT runs it on the matrix, but point after
//! point and without a point's own echo, which would only hold its phase back. Sixteen starts run side by side.

use alloc::vec::Vec;

use super::{Plan, Rows};
use crate::kernels::{LANES, Level, phases, products};
use crate::math::sqrtf;
use crate::problem::Problem;
use crate::projection::start_phasors;
use crate::rng::Rng;
use crate::workspace::Workspace;

/// Rounds over the points: in trials eight reach all but a thousandth of the energy.
const ROUNDS: usize = 8;

/// Points coincide whose rows are parallel to this part: they are about lambda/1000 apart.
const COINCIDENT: f32 = 1e-5;

/// Starts whose energies agree to this part are one start.
const ALIKE: f32 = 1e-5;

/// Point phases to go on from, the best first.
pub(super) struct Starts {
    /// How many.
    pub(super) count: usize,
    /// Moduli of v at which each point's own wave makes the same |P|.
    pub(super) weights: Vec<f32>,
    /// Phasors, start by start.
    pub(super) phasors: [Vec<f32>; 2],
    /// The part of |P| that is a point's own echo, start by start; 0 where it is not known.
    pub(super) echoes: Vec<f32>,
}

impl Starts {
    /// The problem's own start, else the best that a search finds.
    pub(super) fn new(problem: &Problem, rows: &mut Rows, plan: &Plan, work: &mut Workspace) -> Self {
        let couplings = Couplings::new(rows, work);
        let mut weights = work.floats.take(rows.loud);
        let weakest = couplings.norms.iter().copied().fold(f32::INFINITY, f32::min);
        for (weight, norm) in weights.iter_mut().zip(&couplings.norms) {
            *weight = weakest / norm / norm;
        }
        let given = problem.start_drive().is_some() || problem.start_phases().is_some();
        let starts = if given {
            let phasors = start_phasors(problem, work);
            let mut own = [(); 2].map(|()| work.floats.take(rows.loud));
            for (own, phasors) in own.iter_mut().zip([&phasors.re, &phasors.im]) {
                own.iter_mut().zip(&rows.order).for_each(|(own, &j)| *own = phasors[j as usize]);
            }
            phasors.give(work);
            Self { count: 1, weights, phasors: own, echoes: work.floats.take(1) }
        } else {
            couplings.search(weights, plan, work)
        };
        couplings.give(work);
        starts
    }

    pub(super) fn give(self, work: &mut Workspace) {
        work.floats.give_all(self.phasors);
        work.floats.give_all([self.weights, self.echoes]);
    }
}

/// G G^H of the loud rows, each divided by its norm.
struct Couplings {
    level: Level,
    points: usize,
    matrix: [Vec<f32>; 2],
    /// The norms of the rows.
    norms: Vec<f32>,
}

impl Couplings {
    fn new(rows: &mut Rows, work: &mut Workspace) -> Self {
        let points = rows.loud;
        let mut matrix = [(); 2].map(|()| work.floats.take(points * points));
        let mut norms = work.floats.take(points);
        let [re, im] = &mut matrix;
        products::couplings(rows.level, rows.tiles(), points, [re, im]);
        for k in 0..points {
            for l in 0..k {
                (re[k * points + l], im[k * points + l]) = (re[l * points + k], -im[l * points + k]);
            }
        }
        for (k, norm) in norms.iter_mut().enumerate() {
            *norm = sqrtf(matrix[0][k * points + k].max(f32::MIN_POSITIVE));
        }
        for plane in &mut matrix {
            for (row, own) in plane.chunks_exact_mut(points).zip(&norms) {
                row.iter_mut().zip(&norms).for_each(|(entry, other)| *entry = *entry / own / other);
            }
        }
        let mut couplings = Self { level: rows.level, points, matrix, norms };
        couplings.merge(rows);
        // Without a point's own echo.
        (0..points).for_each(|k| couplings.matrix[0][k * points + k] = 0.0);
        couplings
    }

    /// Gives points in the same place the mean of their targets: they cannot have two pressures.
    fn merge(&mut self, rows: &mut Rows) {
        let Self { points, matrix: [re, im], norms, .. } = self;
        for first in 0..*points {
            let own = first * *points..(first + 1) * *points;
            let (re, im) = (&re[own.clone()], &im[own]);
            let coincide = |k: &usize| re[*k] * re[*k] + im[*k] * im[*k] >= 1.0 - 2.0 * COINCIDENT;
            // A group is seen to by its first point.
            if (0..first).any(|k| coincide(&k)) || !(first + 1..*points).any(|k| coincide(&k)) {
                continue;
            }
            let group = || core::iter::once(first).chain((first + 1..*points).filter(coincide));
            let mean = group().map(|k| 1.0 / rows.scale[k]).sum::<f32>() / group().count() as f32;
            for k in group() {
                let factor = 1.0 / (mean * rows.scale[k]);
                rows.rescale(k, factor);
                norms[k] *= factor;
            }
        }
    }

    fn give(self, work: &mut Workspace) {
        work.floats.give_all(self.matrix);
        work.floats.give(self.norms);
    }

    fn planes(&self) -> [&[f32]; 2] {
        [&self.matrix[0], &self.matrix[1]]
    }

    /// The phases of the greatest energies that any of the plan's starts ends in.
    fn search(&self, weights: Vec<f32>, plan: &Plan, work: &mut Workspace) -> Starts {
        let points = self.points;
        let groups = plan.starts.div_ceil(LANES);
        // v_k times the norm of row k.
        let mut shares = work.floats.take(points);
        for ((share, weight), norm) in shares.iter_mut().zip(&weights).zip(&self.norms) {
            *share = weight * norm;
        }
        // From the strongest point on: an order that does not hang on how the scene is told.
        let mut visits = work.indices.take(points);
        visits.iter_mut().zip(0..).for_each(|(visit, k)| *visit = k);
        visits.sort_unstable_by(|&a, &b| self.norms[b as usize].total_cmp(&self.norms[a as usize]));
        let mut energies = work.floats.take(groups * LANES);
        let mut found = [(); 2].map(|()| work.floats.take(groups * points * LANES));
        let mut turns = work.floats.take(points * LANES);
        let mut rng = Rng::new(plan.seed);
        for group in 0..groups {
            let range = group * points * LANES..(group + 1) * points * LANES;
            let [re, im] = &mut found;
            let vectors = [&mut re[range.clone()], &mut im[range]];
            for &k in &visits {
                let own = k as usize * LANES..(k as usize + 1) * LANES;
                turns[own].fill_with(|| rng.uniform() as f32);
            }
            let [re, im] = vectors;
            phases::phasors(self.level, &turns, &shares, [&mut *re, &mut *im]);
            let energy = phases::align(self.level, self.planes(), &shares, &visits, ROUNDS, [re, im]);
            energies[group * LANES..][..LANES].copy_from_slice(&energy);
        }
        energies[plan.starts..].fill(-1.0);
        let count = plan.finalists.min(plan.starts);
        let mut starts = Starts {
            count: 0,
            weights,
            phasors: [(); 2].map(|()| work.floats.take(count * points)),
            echoes: work.floats.take(count),
        };
        let own = shares.iter().map(|share| share * share).sum::<f32>();
        let mut last = f32::INFINITY;
        while starts.count < count {
            let best =
                (0..plan.starts).fold(0, |best, s| if energies[s] > energies[best] { s } else { best });
            let energy = core::mem::replace(&mut energies[best], -1.0);
            if energy < 0.0 {
                break;
            }
            if energy >= last * (1.0 - ALIKE) {
                continue;
            }
            last = energy;
            let first = best / LANES * points * LANES + best % LANES;
            for (phasors, found) in starts.phasors.iter_mut().zip(&found) {
                for k in 0..points {
                    // The vectors hold v; its phase is wanted.
                    phasors[starts.count * points + k] = found[first + k * LANES] / shares[k];
                }
            }
            starts.echoes[starts.count] = own / (own + energy);
            starts.count += 1;
        }
        work.floats.give_all(found);
        work.floats.give_all([shares, energies, turns]);
        work.indices.give(visits);
        starts
    }
}
