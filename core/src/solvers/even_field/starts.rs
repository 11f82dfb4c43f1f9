//! Starts: point phases from which a search begins, so that the foci of the points reinforce each other.
//!
//! The drive b = G^H v has the energy v^H (G G^H) v. The moduli of v are fixed. Each phase in turn is set to that of
//! the other points' waves at its point. This is Gerchberg-Saxton as in GS-PAT, but point after point and without a
//! point's own contribution, which would only keep the old phase. A single start is computed from G itself. Several
//! starts, or that of few points, use the M x M matrix of couplings, sixteen side by side.
//!
//! Two or three points start from the phases of their highest level, found by branch and bound. Rings, grids and lines
//! have equal couplings, for which a single start is sometimes bad. Crowded points also start from cones: waves with one
//! focus in front of or behind all points, whose fields are smooth there.

use crate::control::bytes;
use crate::kernels::tiles::{phases, products};
use crate::kernels::{InstructionSet, LANES};
use crate::math::{phasor, sqrt, sqrtf};
use crate::prelude::*;
use crate::problem::Problem;
use crate::problem::optimum::{self, Effort};
use crate::scene::distance;
use crate::solvers::common::alternating_projection::start_phasors;
use crate::solvers::common::tiled::Rows;
use crate::solvers::even_field::quiet::merge;
use crate::solvers::even_field::run::{Plan, Run};
use crate::workspace::{Buffer, Workspace};

/// Number of rounds over the points with the M x M matrix: in trials eight reach the energy within a thousandth.
const ROUNDS: usize = 8;

/// Number of rounds over the points with G itself instead of the matrix. Each takes as long as a weighted sweep, and the
/// sweeps gain more.
const ROUNDS_ALONE: usize = 3;

/// Up to this number of points the matrix takes less time than the rounds with G.
const FEW_COUPLED: usize = 16;

/// Starts whose energies differ by less than this part count as the same start.
const SAME: f32 = 1e-5;

/// Sets of point phases from which a search starts, the best first.
pub(super) struct Starts<'w> {
    /// The number of starts.
    pub(super) count: usize,
    /// Moduli of v (see the module's head) for which each point's own wave has the same |P|.
    pub(super) weights: Buffer<'w, f32>,
    /// Phasors of the points, start after start.
    pub(super) phasors: [Buffer<'w, f32>; 2],
    /// For each start, the part of |P| that is a point's own contribution; 0 where it is not known.
    pub(super) echoes: Buffer<'w, f32>,
}

/// The foci of the targeted rows.
pub(super) struct Foci<'w> {
    /// Sums of |G|^2 over the transducers.
    powers: Buffer<'w, f32>,
    /// See [`Starts::weights`].
    pub(super) weights: Buffer<'w, f32>,
    /// The points in falling order of their power, so that the result does not depend on the order in the scene.
    visits: Buffer<'w, u32>,
}

impl<'w> Foci<'w> {
    /// Computes the foci, after giving coincident points the mean of their targets.
    pub(super) fn of(rows: &mut Rows, work: &'w Workspace, control: &mut Control) -> Result<Self, Error> {
        let mut powers = work.floats.take(rows.targeted);
        products::powers(rows.set, rows.tiles(), &mut powers);
        merge(rows, &mut powers, work, control)?;
        for power in &mut powers {
            *power = power.max(f32::MIN_POSITIVE);
        }
        let weakest = sqrtf(powers.iter().copied().fold(f32::INFINITY, f32::min));
        let mut weights = work.floats.take(rows.targeted);
        weights.iter_mut().zip(&powers).for_each(|(weight, power)| *weight = weakest / power);
        let mut visits = work.counting(rows.targeted);
        // Unstable sorting needs no memory; the index makes the order unique.
        visits.sort_unstable_by(|&a, &b| powers[b as usize].total_cmp(&powers[a as usize]).then(a.cmp(&b)));
        Ok(Self { powers, weights, visits })
    }
}

impl<'w> Starts<'w> {
    /// Returns the problem's own start, or else the best that a search finds.
    pub(super) fn new(
        problem: &Problem,
        rows: &Rows,
        foci: &Foci,
        plan: &Plan,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let Foci { powers, visits, .. } = foci;
        let mut weights = work.floats.take_any(rows.targeted);
        weights.copy_from_slice(&foci.weights);
        if problem.has_start() {
            Self::given(problem, rows, weights, work, control)
        } else if plan.starts == 1 {
            Self::alone(rows, weights, (powers, visits), work, control)
        } else {
            let couplings = Couplings::new(rows, powers, work, control)?;
            couplings.search(weights, visits, plan, work, control)
        }
    }

    fn given(
        problem: &Problem,
        rows: &Rows,
        weights: Buffer<'w, f32>,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let phasors = start_phasors(problem, work, control)?;
        let mut own = [(); 2].map(|()| work.floats.take(rows.targeted));
        for (own, phasors) in own.iter_mut().zip([&phasors.re, &phasors.im]) {
            own.iter_mut().zip(&rows.order).for_each(|(own, &j)| *own = phasors[j as usize]);
        }
        Ok(Self { count: 1, weights, phasors: own, echoes: work.floats.take(1) })
    }

    /// Finds the phases of a single start by adding one point after another: with G itself, or with the matrix if the
    /// points are few enough for it to be faster.
    fn alone(
        rows: &Rows,
        weights: Buffer<'w, f32>,
        (powers, visits): (&[f32], &[u32]),
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Self, Error> {
        if rows.targeted <= FEW_COUPLED {
            return Couplings::new(rows, powers, work, control)?.alone(weights, visits, work, control);
        }
        let mut phasors = [(); 2].map(|()| work.floats.take(rows.targeted));
        let mut wave = [(); 2].map(|()| work.floats.take(rows.lanes));
        let [re, im] = &mut phasors;
        let [wave_re, wave_im] = &mut wave;
        let lists = (&weights[..], powers);
        let (vector, wave) = ([&mut re[..], &mut im[..]], [&mut wave_re[..], &mut wave_im[..]]);
        let energy = phases::align_rows(rows.set, rows.tiles(), lists, visits, ROUNDS_ALONE, vector, wave, control)?;
        for plane in &mut phasors {
            plane.iter_mut().zip(&weights).for_each(|(part, weight)| *part /= weight);
        }
        let own = weights.iter().zip(powers).map(|(weight, power)| weight * weight * power).sum::<f32>();
        let mut echoes = work.floats.take(1);
        echoes[0] = own / (own + energy);
        Ok(Self { count: 1, weights, phasors, echoes })
    }
}

/// The matrix G G^H of the targeted rows of G, each divided by its norm.
struct Couplings<'w> {
    set: InstructionSet,
    points: usize,
    matrix: [Buffer<'w, f32>; 2],
    /// The norms of the rows.
    norms: Buffer<'w, f32>,
}

impl<'w> Couplings<'w> {
    fn new(rows: &Rows, powers: &[f32], work: &'w Workspace, control: &mut Control) -> Result<Self, Error> {
        let points = rows.targeted;
        control.room("the matrix G G^H", [rows.lanes, points], bytes(8, &[points, points]))?;
        let mut matrix = [(); 2].map(|()| work.floats.take(points * points));
        let mut norms = work.floats.take(points);
        norms.iter_mut().zip(powers).for_each(|(norm, &power)| *norm = sqrtf(power));
        let [re, im] = &mut matrix;
        products::couplings(rows.set, rows.tiles(), 0..rows.lanes / LANES, points, [re, im], control)?;
        for k in 0..points {
            // A point's own contribution is left out.
            (re[k * points + k], im[k * points + k]) = (0.0, 0.0);
            for l in k + 1..points {
                let (real, imag) = (re[k * points + l] / norms[k] / norms[l], im[k * points + l] / norms[k] / norms[l]);
                (re[k * points + l], im[k * points + l]) = (real, imag);
                (re[l * points + k], im[l * points + k]) = (real, -imag);
            }
        }
        Ok(Self { set: rows.set, points, matrix, norms })
    }

    fn planes(&self) -> [&[f32]; 2] {
        [&self.matrix[0], &self.matrix[1]]
    }

    /// Returns |v_k| (see the module's head) times the norm of row k, for each point k.
    fn shares(&self, weights: &[f32], work: &'w Workspace) -> Buffer<'w, f32> {
        let mut shares = work.floats.take(self.points);
        for ((share, weight), norm) in shares.iter_mut().zip(weights).zip(&self.norms) {
            *share = weight * norm;
        }
        shares
    }

    /// Finds the phases of a single start by adding one point after another. At first v is 0 except at the strongest
    /// point.
    fn alone(
        &self,
        weights: Buffer<'w, f32>,
        visits: &[u32],
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Starts<'w>, Error> {
        let shares = self.shares(&weights, work);
        let mut vectors = [(); 2].map(|()| work.floats.take(self.points * LANES));
        let [re, im] = &mut vectors;
        if let Some(&first) = visits.first() {
            re[first as usize * LANES..][..LANES].fill(shares[first as usize]);
        }
        let energy = phases::align(self.set, self.planes(), &shares, visits, ROUNDS, [re, im], control)?[0];
        let mut phasors = [(); 2].map(|()| work.floats.take(self.points));
        for (k, share) in shares.iter().enumerate() {
            let [x, y] = [&vectors[0], &vectors[1]].map(|plane| plane[k * LANES] / share);
            // Where there is no other wave the phase is 0.
            (phasors[0][k], phasors[1][k]) = if [x, y] == [0.0; 2] { (1.0, 0.0) } else { (x, y) };
        }
        let own = shares.iter().map(|share| share * share).sum::<f32>();
        let mut echoes = work.floats.take(1);
        echoes[0] = own / (own + energy);
        Ok(Starts { count: 1, weights, phasors, echoes })
    }

    /// Returns the phases of the largest energies that the plan's starts reach.
    fn search(
        &self,
        weights: Buffer<'w, f32>,
        visits: &[u32],
        plan: &Plan,
        work: &'w Workspace,
        control: &mut Control,
    ) -> Result<Starts<'w>, Error> {
        let points = self.points;
        let groups = plan.starts.div_ceil(LANES);
        let shares = self.shares(&weights, work);
        let mut energies = work.floats.take(groups * LANES);
        let mut found = [(); 2].map(|()| work.floats.take(groups * points * LANES));
        let mut turns = work.floats.take(points * LANES);
        let mut rng = Rng::new(plan.seed);
        for group in 0..groups {
            let range = group * points * LANES..(group + 1) * points * LANES;
            let [re, im] = &mut found;
            let vectors = [&mut re[range.clone()], &mut im[range]];
            for &k in visits {
                let own = k as usize * LANES..(k as usize + 1) * LANES;
                turns[own].fill_with(|| rng.uniform() as f32);
            }
            let [re, im] = vectors;
            phases::phasors(self.set, &turns, &shares, [&mut *re, &mut *im]);
            let energy = phases::align(self.set, self.planes(), &shares, visits, ROUNDS, [re, im], control)?;
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
            let best = (0..plan.starts).fold(0, |best, s| if energies[s] > energies[best] { s } else { best });
            let energy = core::mem::replace(&mut energies[best], -1.0);
            if energy < 0.0 {
                break;
            }
            if energy >= last * (1.0 - SAME) {
                continue;
            }
            last = energy;
            let first = best / LANES * points * LANES + best % LANES;
            for (phasors, found) in starts.phasors.iter_mut().zip(&found) {
                for k in 0..points {
                    // The vectors contain v; the quotient is its phasor.
                    phasors[starts.count * points + k] = found[first + k * LANES] / shares[k];
                }
            }
            starts.echoes[starts.count] = own / (own + energy);
            starts.count += 1;
        }
        Ok(starts)
    }
}

/// Largest number of targets. The search of the phases takes milliseconds for three points, and a hundred times as long
/// for four.
pub(super) const FEW: usize = 3;

/// Effort of the search. It is small, because later steps improve the field.
const EFFORT: Effort = Effort { gap: 1e-4, boxes: 512 };

/// Returns the point phases and weights of the highest level; `None` after a stop.
///
/// # Errors
/// More memory than allowed is needed.
pub(super) fn loudest_of_few<'w>(run: &mut Run<'_, '_, 'w>) -> Result<Option<Starts<'w>>, Error> {
    let (rows, work) = (run.rows, run.work);
    let mut own = [(); 2].map(|()| work.floats.take(rows.lanes));
    let mut planes = [(); 2].map(|()| work.doubles.take(rows.targeted * rows.lanes));
    for k in 0..rows.targeted {
        rows.conjugate(k, own.each_mut().map(|plane| &mut plane[..]));
        for (plane, own) in planes.iter_mut().zip(&own) {
            let to = &mut plane[k * rows.lanes..][..rows.lanes];
            to.iter_mut().zip(own).for_each(|(to, own)| *to = f64::from(*own));
        }
    }
    // The planes contain conj(G), so the found phases are the negatives of the wanted ones.
    let planes = planes.each_ref().map(|plane| &plane[..]);
    let found = match optimum::search(rows.set, planes, rows.targeted, EFFORT, work, run.control) {
        Err(error) if error.is_stop() => {
            run.stopped = true;
            return Ok(None);
        }
        found => found?,
    };
    let mut weights = work.floats.take(rows.targeted);
    let mut phasors = [(); 2].map(|()| work.floats.take(rows.targeted));
    for k in 0..rows.targeted {
        let v = phasor(-found.phases[k]);
        (phasors[0][k], phasors[1][k]) = (v.re as f32, v.im as f32);
        weights[k] = found.weights[k] as f32;
    }
    Ok(Some(Starts { count: 1, weights, phasors, echoes: work.floats.take(1) }))
}

/// Distances that agree within this part count as equal.
const ALIKE: f32 = 1e-3;

/// Largest number of points checked: the loop is quadratic.
const MOST_CHECKED: usize = 256;

/// Returns whether three quarters of the points are at equal distances from their nearest neighbours. Of random
/// points at most half have equal distances: those in pairs that are each other's nearest neighbours.
pub(super) fn regular(points: &[[f64; 3]], work: &Workspace) -> bool {
    if !(3..=MOST_CHECKED).contains(&points.len()) {
        return false;
    }
    let nearest = |j: usize| {
        let others = (0..points.len()).filter(|&k| k != j);
        others.map(|k| distance(points[j], points[k])).fold(f64::INFINITY, f64::min)
    };
    let mut distances = work.floats.take(points.len());
    distances.iter_mut().enumerate().for_each(|(j, distance)| *distance = nearest(j) as f32);
    distances.sort_unstable_by(f32::total_cmp);
    let middle = distances[points.len() / 2];
    let alike = distances.iter().filter(|distance| (**distance - middle).abs() <= ALIKE * middle).count();
    4 * alike >= 3 * points.len()
}

/// Distances of the focus from the middle of the points, away from the array, relative to their root mean square
/// distance.
const PLACES: [f64; 6] = [1.0, 2.0, 4.0, -1.0, -2.0, -4.0];

/// Returns the phases of a cone at the points; `None` if the points have no known places.
pub(super) fn cone<'w>(run: &Run<'_, '_, 'w>, foci: &Foci, which: usize) -> Option<Starts<'w>> {
    let (rows, work, setup) = (run.rows, run.work, run.problem.setup());
    let points = run.problem.propagation().control_points()?;
    let at = |k: usize| points[rows.order[k] as usize];
    let middle = |places: &mut dyn Iterator<Item = [f64; 3]>, count: usize| {
        places.fold([0.0; 3], |sum, place| [0, 1, 2].map(|axis| sum[axis] + place[axis] / count as f64))
    };
    let positions = setup.positions.as_ref()?;
    let array = middle(&mut positions.iter().copied(), positions.len());
    let centre = middle(&mut (0..rows.targeted).map(at), rows.targeted);
    let spread = (0..rows.targeted).map(|k| distance(at(k), centre)).map(|r| r * r).sum::<f64>() / rows.targeted as f64;
    let (place, away) = (PLACES[which], distance(array, centre).max(f64::MIN_POSITIVE));
    let focus = [0, 1, 2].map(|axis| centre[axis] + place * sqrt(spread) * (centre[axis] - array[axis]) / away);
    let mut phasors = [(); 2].map(|()| work.floats.take(rows.targeted));
    for k in 0..rows.targeted {
        let v = phasor(-place.signum() * setup.medium.wavenumber() * distance(at(k), focus));
        (phasors[0][k], phasors[1][k]) = (v.re as f32, v.im as f32);
    }
    let mut weights = work.floats.take_any(rows.targeted);
    weights.copy_from_slice(&foci.weights);
    Some(Starts { count: 1, weights, phasors, echoes: work.floats.take(1) })
}
