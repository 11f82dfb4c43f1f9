//! bounded: the least error of complex targets over all drives |q| <= 1, by an interior-point method.
//!
//! It minimises ||r||^2, r = W^(1/2) (p - G q), over |q_i| <= 1: complex targets p, weights W, drives q. This is
//! convex: bounded least squares. A logarithmic barrier -mu sum log(1 - |q_i|^2) keeps the drives inside (Boyd and
//! Vandenberghe, Convex Optimization, 2004, section 11.3), and Newton steps follow its minimum as mu falls. The Hessian
//! is G^H W G + D with 2 x 2 blocks D_i. So by Woodbury a step solves a real system of 2 M unknowns for M points, I + J
//! D^-1 J^T, however many transducers there are.
//!
//! Each step proves a lower bound of the error. With g = G^H W^(1/2) r no allowed drive has a smaller error than (Re
//! r^H W^(1/2) p - sum_i |g_i|) / ||r||, since |r^H (W^(1/2) p - W^(1/2) G q)| is at most ||r|| times the error of q.

use core::iter::zip;

use crate::kernels::double::{self, WIDE};
use crate::solvers::common::alternating_projection::start_phasors;
use crate::solvers::iterate::iterate;
use crate::solvers::prelude::*;

/// The tolerance is relative to the error, but to no less than this part of the targets' norm.
const LEAST_ERROR: f64 = 0.01;

/// A step aims at [`AIM`] times the present duality gap, and lowers mu at most to [`STEEPEST`] times its value.
const AIM: f64 = 0.1;
const STEEPEST: f64 = 0.01;

/// The largest part of the way to |q| = 1 that a step may go.
const INSIDE: f64 = 0.95;

/// Lower bound of 1 - |q|^2, near the resolution of f64.
const LEAST_ROOM: f64 = 1e-15;

/// Number of transducers whose columns of J are written together: the columns for 128 points stay in the second-level
/// cache.
const RUN: usize = 32;

options! {
    /// Bounded least squares on complex targets. Time O(N M^2 + M^3) a step, in double precision; memory O(N M + M^2).
    pub struct Bounded {
        /// Largest number of steps.
        pub steps: u32 = 100,
        /// Ends when the error is proven to be within this part of the least possible one; 0 takes all steps.
        pub tolerance: f64 = 1e-3,
    }
}

impl Method for Bounded {
    const INFO: Info = Info::new(
        "bounded",
        "the least error of complex targets, to a proven tolerance",
        "Boyd and Vandenberghe, Convex Optimization, 2004, section 11.3",
    )
    .with_start()
    .within(1e-3);

    fn check(&self) -> Result<()> {
        check_iteration(self.steps, self.tolerance)
    }
}

impl Solve for Bounded {
    fn solve(&self, problem: &Problem, work: &mut Workspace, control: &mut Control) -> Result<Solution> {
        let mut barrier = Barrier::new(problem, work, control)?;
        let ended = iterate(
            (self.steps, self.tolerance),
            &mut barrier,
            control,
            |barrier, control| {
                barrier.step(control)?;
                Ok(self.tolerance > 0.0 && barrier.is_proven(self.tolerance))
            },
            |barrier| problem.residual_of(barrier.moduli()),
        )?;
        let drive = barrier.drive(problem.propagation().transducers(), work);
        Solution::new(problem, drive.into_vec(), ended, self.steps as usize, work, control)
    }

    facts!(finds_level = true, uses_phases = true);
}

/// A complex vector: real and imaginary parts.
type Vector<'w> = [Buffer<'w, f64>; 2];

fn vector(len: usize, work: &Workspace) -> Vector<'_> {
    [(); 2].map(|()| work.doubles.take(len))
}

fn parts<'a>([re, im]: &'a Vector) -> [&'a [f64]; 2] {
    [re, im]
}

fn parts_mut<'a>([re, im]: &'a mut Vector) -> [&'a mut [f64]; 2] {
    [re, im]
}

fn entries<'a>([re, im]: &'a Vector) -> impl Iterator<Item = Complex64> + Clone + 'a {
    zip(&re[..], &im[..]).map(|(&re, &im)| Complex64::new(re, im))
}

fn set([re, im]: &mut Vector, k: usize, value: Complex64) {
    (re[k], im[k]) = (value.re, value.im);
}

fn modulus(z: Complex64) -> f64 {
    math::sqrt(z.norm_sqr())
}

/// Returns Re conj(a) b.
fn inner(a: Complex64, b: Complex64) -> f64 {
    a.re * b.re + a.im * b.im
}

/// An iterate within |q| < 1, and the values that its next step needs.
struct Barrier<'w> {
    set: InstructionSet,
    /// W^(1/2) G, row by row, and W^(1/2), with the weights W.
    rows: Vector<'w>,
    roots: Buffer<'w, f64>,
    /// W^(1/2) p, and its norm, with the targets p.
    targets: Vector<'w>,
    requested: f64,
    drive: Vector<'w>,
    residual: Vector<'w>,
    /// g = G^H W^(1/2) r: minus the gradient of ||r||^2 / 2.
    descent: Vector<'w>,
    /// The error and its largest lower bound so far, in the unit of the targets.
    error: f64,
    least: f64,
    mu: f64,
    /// For each transducer the radial and tangential eigenvalues of D^-1, and the radial direction q/|q|.
    inverse: Vector<'w>,
    radial: Vector<'w>,
    /// Over the transducers: the barrier's gradient, then the step. Over the points: fields.
    gradient: Vector<'w>,
    step: Vector<'w>,
    field: Vector<'w>,
    /// Columns of J, the real form of W^(1/2) G, for some transducers; and the matrix I + J D^-1 J^T.
    columns: Buffer<'w, f64>,
    matrix: Buffer<'w, f64>,
    dual: Buffer<'w, f64>,
}

impl<'w> Barrier<'w> {
    /// Creates the iterate at q = 0.
    fn new(problem: &Problem, work: &'w Workspace, control: &mut Control) -> Result<Self> {
        let propagation = problem.propagation();
        let (count, transducers) = (propagation.points(), propagation.transducers());
        let (lanes, size) = (transducers.next_multiple_of(WIDE), (2 * count).next_multiple_of(WIDE));
        let taken = bytes(16, &[count, lanes]).saturating_add(bytes(8, &[size, size + 2 * RUN]));
        control.room("the matrix G and the Newton system", [transducers, count], taken)?;
        let mut roots = work.doubles.take(count);
        zip(&mut *roots, problem.weights()).for_each(|(root, &weight)| *root = math::sqrt(f64::from(weight)));
        let mut rows = vector(count * lanes, work);
        let [mut re, mut im] = [(); 2].map(|()| work.floats.take(propagation.lanes()));
        for i in 0..transducers {
            control.pulse()?;
            propagation.row(i, &mut re, &mut im);
            for (j, root) in roots.iter().enumerate() {
                set(&mut rows, j * lanes + i, Complex64::new(f64::from(re[j]), f64::from(im[j])) * root);
            }
        }
        let mut targets = vector(count, work);
        for (j, target) in problem.complex_targets().enumerate() {
            set(&mut targets, j, target * roots[j]);
        }
        if problem.target_phases().is_none() && problem.has_start() {
            let start = start_phasors(problem, work, control)?;
            for (j, (&target, &root)) in zip(problem.targets(), &roots).enumerate() {
                let phasor = Complex64::new(f64::from(start.re[j]), f64::from(start.im[j]));
                set(&mut targets, j, phasor * f64::from(target) * root);
            }
        }
        let mut residual = vector(count, work);
        zip(&mut residual, &targets).for_each(|(residual, target)| residual.copy_from_slice(target));
        let requested = math::sqrt(entries(&targets).map(|target| target.norm_sqr()).sum());
        let mut barrier = Self {
            set: propagation.instruction_set(),
            rows,
            roots,
            targets,
            requested,
            drive: vector(lanes, work),
            residual,
            descent: vector(lanes, work),
            error: requested,
            least: 0.0,
            mu: f64::INFINITY,
            inverse: vector(lanes, work),
            radial: vector(lanes, work),
            gradient: vector(lanes, work),
            step: vector(lanes, work),
            field: vector(count, work),
            columns: work.doubles.take(2 * size * RUN),
            matrix: work.doubles.take_any(size * size),
            dual: work.doubles.take(size),
        };
        barrier.measure();
        Ok(barrier)
    }

    /// Computes g (see the module's head), the error, and the lower bound of the error that g proves.
    fn measure(&mut self) {
        double::times_adjoint(self.set, parts(&self.rows), parts(&self.residual), parts_mut(&mut self.descent));
        self.error = math::sqrt(entries(&self.residual).map(|r| r.norm_sqr()).sum());
        let along: f64 = zip(entries(&self.residual), entries(&self.targets)).map(|(r, p)| inner(r, p)).sum();
        let most: f64 = entries(&self.descent).map(modulus).sum();
        if self.error > 0.0 {
            self.least = self.least.max((along - most) / self.error);
        }
    }

    /// Returns whether the bound proves that no allowed drive lowers the error by more than the part `tolerance` of it.
    fn is_proven(&self, tolerance: f64) -> bool {
        self.error - self.least <= tolerance * self.least.max(LEAST_ERROR * self.requested)
    }

    /// Returns |p| at the points, without weights.
    fn moduli(&self) -> impl Iterator<Item = f64> + Clone + '_ {
        let fields = zip(entries(&self.targets), entries(&self.residual)).map(|(p, r)| modulus(p - r));
        zip(fields, &self.roots).map(|(field, &root)| if root > 0.0 { field / root } else { 0.0 })
    }

    fn drive(&self, count: usize, work: &'w Workspace) -> Buffer<'w, Complex32> {
        let mut drive = work.complexes.take(count);
        zip(&mut drive, entries(&self.drive)).for_each(|(q, own)| *q = Complex32::new(own.re as f32, own.im as f32));
        drive
    }

    /// Returns D^-1 z at transducer `i`, with the matrix D of the module's head.
    fn apply_inverse(&self, i: usize, z: Complex64) -> Complex64 {
        let radial = Complex64::new(self.radial[0][i], self.radial[1][i]);
        let z = radial.conj() * z;
        radial * Complex64::new(z.re * self.inverse[0][i], z.im * self.inverse[1][i])
    }

    /// Takes a Newton step towards the barrier's minimum at a smaller mu.
    fn step(&mut self, control: &mut Control) -> Result<()> {
        self.lower_mu();
        self.derive();
        self.factor(control)?;
        let lanes = self.step[0].len();
        // J is the real form of W^(1/2) G. With the gradient h and the dual y = (I + J D^-1 J^T)^-1 J D^-1 h, the step
        // is -D^-1 (h - J^T y).
        for i in 0..lanes {
            let own = self.apply_inverse(i, at(&self.gradient, i));
            set(&mut self.step, i, own);
        }
        double::times(self.set, parts(&self.rows), parts(&self.step), parts_mut(&mut self.field));
        self.dual.fill(0.0);
        zip(self.dual.as_chunks_mut().0, entries(&self.field)).for_each(|(dual, p)| *dual = [p.re, p.im]);
        double::solve(self.set, &self.matrix, &mut self.dual);
        for (j, &[re, im]) in self.dual.as_chunks().0.iter().enumerate().take(self.roots.len()) {
            set(&mut self.field, j, Complex64::new(re, im));
        }
        double::times_adjoint(self.set, parts(&self.rows), parts(&self.field), parts_mut(&mut self.step));
        // Along the step the quadratic model has the initial slope -`slope`. `curvature` becomes the sum of the
        // curvatures of the barrier and of the error.
        let (mut slope, mut curvature, mut room) = (0.0, 0.0, f64::INFINITY);
        for i in 0..lanes {
            let (h, q) = (at(&self.gradient, i), at(&self.drive, i));
            let rest = h - at(&self.step, i);
            let d = -self.apply_inverse(i, rest);
            set(&mut self.step, i, d);
            slope -= inner(h, d);
            curvature -= inner(rest, d);
            room = room.min(room_along(q, d));
        }
        double::times(self.set, parts(&self.rows), parts(&self.step), parts_mut(&mut self.field));
        curvature += entries(&self.field).map(|p| p.norm_sqr()).sum::<f64>();
        // The length is 1 where the system was solved exactly.
        let length = if curvature > 0.0 { (slope / curvature).clamp(0.0, 1.0).min(INSIDE * room) } else { 0.0 };
        refuse_if!(!length.is_finite(), Error::lost());
        let pairs = [(&mut self.drive, &self.step, length), (&mut self.residual, &self.field, -length)];
        for (to, from, factor) in pairs {
            zip(to.iter_mut().flatten(), from.iter().flatten()).for_each(|(to, from)| *to += factor * from);
        }
        self.measure();
        Ok(())
    }

    /// Lowers mu according to the duality gap ||r||^2 - Re r^H p + sum |g| = sum |g_i| - Re conj(q_i) g_i. At the
    /// barrier's minimum the gap is about 2 mu sum |q_i|.
    fn lower_mu(&mut self) {
        let own = zip(entries(&self.descent), entries(&self.drive)).map(|(g, q)| modulus(g) - inner(q, g));
        let share = own.sum::<f64>() / self.drive[0].len() as f64;
        let floor = f64::EPSILON * self.requested * self.requested / self.drive[0].len() as f64;
        self.mu = if self.mu.is_finite() { self.mu.min((AIM * share).max(STEEPEST * self.mu)) } else { 0.5 * share }
            .max(floor);
    }

    /// Computes h, the barrier's gradient, and D^-1. D_i = 2 mu (I/s + 2 q q^T/s^2), s = 1 - |q|^2, has the radial
    /// eigenvalue 2 mu (1 + |q|^2)/s^2 and the tangential one 2 mu/s.
    fn derive(&mut self) {
        for i in 0..self.drive[0].len() {
            let (q, g) = (at(&self.drive, i), at(&self.descent, i));
            let square = q.norm_sqr();
            let room = (1.0 - square).max(LEAST_ROOM);
            set(&mut self.radial, i, if square > 0.0 { q / math::sqrt(square) } else { Complex64::ONE });
            let tangential = room / (2.0 * self.mu);
            set(&mut self.inverse, i, Complex64::new(tangential * room / (1.0 + square), tangential));
            set(&mut self.gradient, i, q * (2.0 * self.mu / room) - g);
        }
    }

    /// Computes the Cholesky factor of I + J D^-1 J^T. J is the real form of G: a transducer has two columns, along and
    /// across its drive, with Re and Im at each point.
    fn factor(&mut self, control: &mut Control) -> Result<()> {
        let (lanes, size) = (self.drive[0].len(), self.dual.len());
        self.matrix.fill(0.0);
        for first in (0..lanes).step_by(RUN) {
            let members = first..(first + RUN).min(lanes);
            let columns = &mut self.columns[..2 * size * members.len()];
            for (i, pair) in zip(members, columns.chunks_exact_mut(2 * size)) {
                control.pulse()?;
                let radial = at(&self.radial, i);
                let [along, across] = [&self.inverse[0], &self.inverse[1]].map(|inverse| math::sqrt(inverse[i]));
                let (first, second) = pair.split_at_mut(size);
                let both = zip(first.as_chunks_mut::<2>().0, second.as_chunks_mut::<2>().0);
                for (j, (first, second)) in both.take(self.roots.len()).enumerate() {
                    let g = at(&self.rows, j * lanes + i) * radial;
                    (*first, *second) = ([g.re * along, g.im * along], [-g.im * across, g.re * across]);
                }
            }
            double::add_products(self.set, columns, size, &mut self.matrix, control)?;
        }
        // This shift exceeds the largest loss of a pivot by rounding, so that a factor always exists.
        let largest = (0..size).map(|k| self.matrix[k * size + k]).fold(0.0, f64::max);
        let shift = 1.0 + 4.0 * size as f64 * f64::EPSILON * largest;
        (0..size).for_each(|k| self.matrix[k * size + k] += shift);
        if double::factor(self.set, &mut self.matrix, size, control)? { Ok(()) } else { Err(Error::lost()) }
    }
}

fn at([re, im]: &Vector, k: usize) -> Complex64 {
    Complex64::new(re[k], im[k])
}

/// Returns the multiple of a step from q at which |q| = 1.
fn room_along(q: Complex64, step: Complex64) -> f64 {
    let (square, along) = (step.norm_sqr(), inner(q, step));
    let room = (1.0 - q.norm_sqr()).max(LEAST_ROOM);
    if square == 0.0 {
        return f64::INFINITY;
    }
    let root = math::sqrt(along * along + square * room);
    // One of the two forms is free of cancellation, depending on the direction of the step.
    if along > 0.0 { room / (along + root) } else { (root - along) / square }
}

#[cfg(test)]
#[path = "tests/bounded.rs"]
mod tests;
