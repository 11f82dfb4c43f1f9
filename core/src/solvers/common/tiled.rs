//! G stored as tiles, and a drive with what it makes at the points: what every method that passes over G again and again
//! works on.

use alloc::vec::Vec;

use num_complex::Complex32;

use crate::kernels::simd::instruction_set::InstructionSet;
use crate::kernels::tiles;
use crate::kernels::tiles::Tiles;
use crate::math::sqrtf;
use crate::problem::Problem;
use crate::workspace::{Aligned, Workspace};

/// The most that a target may be raised to the largest one's size: squares stay within f32.
const MOST_RAISED: f32 = 1e12;

/// G as tiles of 16 transducers, a row a point.
pub(crate) struct Rows {
    /// The problem's point of each row.
    pub(crate) order: Vec<u32>,
    /// Rows of points with a target, where these come first.
    pub(crate) loud: usize,
    /// Rows of G: the points, and zeros.
    pub(crate) count: usize,
    /// Length of a vector over the transducers.
    pub(crate) lanes: usize,
    /// Factor of each row.
    pub(crate) scale: Vec<f32>,
    /// The largest target.
    pub(crate) target: f32,
    pub(crate) set: InstructionSet,
    planes: [Aligned; 2],
}

impl Rows {
    /// G as it is, point by point.
    pub(crate) fn new(problem: &Problem, work: &mut Workspace) -> Self {
        Self::ordered(problem, 0..problem.propagation().points() as u32, work)
    }

    /// Each row divided by its point's target and multiplied by the largest, so that all points ask for the same; the quiet
    /// ones come last, as they are.
    pub(crate) fn alike(problem: &Problem, work: &mut Workspace) -> Self {
        let targets = problem.targets();
        let heard = |j: &u32| targets[*j as usize] > 0.0;
        let all = 0..problem.propagation().points() as u32;
        let mut rows =
            Self::ordered(problem, all.clone().filter(heard).chain(all.filter(|j| !heard(j))), work);
        for k in 0..rows.loud {
            let own = targets[rows.order[k] as usize];
            if own < rows.target {
                rows.rescale(k, (rows.target / own).min(MOST_RAISED));
            }
        }
        rows
    }

    /// The points' rows of G in an order of theirs.
    fn ordered(problem: &Problem, points: impl Iterator<Item = u32>, work: &mut Workspace) -> Self {
        let (propagation, targets) = (problem.propagation(), problem.targets());
        let mut order = work.indices.take(propagation.points());
        order.iter_mut().zip(points).for_each(|(own, j)| *own = j);
        let mut scale = work.floats.take(propagation.points());
        scale.fill(1.0);
        let (count, lanes) = (tiles::height(propagation.points()), tiles::lanes(propagation.transducers()));
        let mut planes = [(); 2].map(|()| Aligned::take(tiles::size(count, lanes), work));
        let [re, im] = &mut planes;
        tiles::pack(
            propagation.instruction_set(),
            propagation.rows(),
            0..propagation.transducers(),
            &order,
            [re, im],
        );
        let loud = targets.iter().filter(|&&target| target > 0.0).count();
        let target = targets.iter().copied().fold(0.0, f32::max);
        Self { order, loud, count, lanes, scale, target, set: propagation.instruction_set(), planes }
    }

    /// Multiplies row `k` by `factor`.
    pub(crate) fn rescale(&mut self, k: usize, factor: f32) {
        self.scale[k] *= factor;
        for plane in &mut self.planes {
            tiles::rescale(plane, self.lanes, k, factor);
        }
    }

    pub(crate) fn tiles(&self) -> Tiles<'_> {
        let [re, im] = &self.planes;
        Tiles { planes: [re, im], lanes: self.lanes }
    }

    pub(crate) fn give(self, work: &mut Workspace) {
        work.indices.give(self.order);
        work.floats.give(self.scale);
        self.planes.into_iter().for_each(|plane| plane.give(work));
    }
}

/// A drive q and its field P = G q at the rows.
pub(crate) struct Wave {
    pub(crate) drive: [Vec<f32>; 2],
    pub(crate) field: [Vec<f32>; 2],
    /// |P|.
    pub(crate) moduli: Vec<f32>,
}

impl Wave {
    /// A wave to write: only its moduli are set, to 0.
    pub(crate) fn new(rows: &Rows, work: &mut Workspace) -> Self {
        let mut pair = |size: usize| [(); 2].map(|()| work.floats.take_any(size));
        let (drive, field) = (pair(rows.lanes), pair(rows.count));
        Self { drive, field, moduli: work.floats.take(rows.count) }
    }

    /// What a kernel makes of it, and the moduli.
    pub(crate) fn set(&mut self, kernel: impl FnOnce(tiles::Wave<'_>)) {
        let [drive, field] =
            [&mut self.drive, &mut self.field].map(|pair| pair.each_mut().map(Vec::as_mut_slice));
        kernel(tiles::Wave { drive, field });
        for (modulus, (re, im)) in self.moduli.iter_mut().zip(self.field[0].iter().zip(&self.field[1])) {
            *modulus = sqrtf(re * re + im * im);
        }
    }

    /// Takes another `drive` and P = G q of it.
    pub(crate) fn play(&mut self, rows: &Rows, drive: impl Iterator<Item = Complex32>) {
        self.take(drive);
        self.set(|wave| tiles::play(rows.set, rows.tiles(), wave));
    }

    /// The same with every |q| made 1, 0 staying 0.
    pub(crate) fn play_at_full(&mut self, rows: &Rows, drive: impl Iterator<Item = Complex32>) {
        self.take(drive);
        tiles::normalise(rows.set, self.drive.each_mut().map(Vec::as_mut_slice));
        self.set(|wave| tiles::play(rows.set, rows.tiles(), wave));
    }

    fn take(&mut self, drive: impl Iterator<Item = Complex32>) {
        let [re, im] = &mut self.drive;
        re.fill(0.0);
        im.fill(0.0);
        for ((re, im), q) in re.iter_mut().zip(im).zip(drive) {
            (*re, *im) = (q.re, q.im);
        }
    }

    /// Turns each q of the wave `from` by the phase atan(`factor` `turns`) at |q| = 1, 0 staying 0, and P = G q.
    pub(crate) fn turn(&mut self, rows: &Rows, from: &Self, turns: &[f32], factor: f32) {
        let [re, im] = &from.drive;
        self.set(|wave| tiles::turn(rows.set, rows.tiles(), [re, im], turns, factor, wave));
    }

    pub(crate) fn copy(&mut self, other: &Self) {
        let own = self.drive.iter_mut().chain(&mut self.field).chain([&mut self.moduli]);
        let others = other.drive.iter().chain(&other.field).chain([&other.moduli]);
        own.zip(others).for_each(|(own, other)| own.copy_from_slice(other));
    }

    /// The drives of `count` transducers.
    pub(crate) fn drives(&self, count: usize, work: &mut Workspace) -> Vec<Complex32> {
        let mut drive = work.complexes.take(count);
        for (q, (&re, &im)) in drive.iter_mut().zip(self.drive[0].iter().zip(&self.drive[1])) {
            *q = Complex32::new(re, im);
        }
        drive
    }

    pub(crate) fn give(self, work: &mut Workspace) {
        work.floats.give_all(self.drive);
        work.floats.give_all(self.field);
        work.floats.give(self.moduli);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::propagation::Propagation;
    use crate::rng::Rng;
    use crate::scene::Request;
    use num_complex::Complex64;

    /// A random matrix of propagation with targets that differ, its rows as they are, and a random wave.
    pub(crate) fn random(points: usize, transducers: usize, work: &mut Workspace) -> (Problem, Rows, Wave) {
        let mut rng = Rng::new(points as u64);
        let mut number = || Complex64::new(2.0 * rng.uniform() - 1.0, 2.0 * rng.uniform() - 1.0);
        let matrix: Vec<Complex64> = (0..points * transducers).map(|_| number()).collect();
        let pressures = Some((1..=points).map(|j| j as f64).collect());
        let propagation = Propagation::from_matrix(&matrix, points).expect("propagation");
        let problem =
            Problem::with_propagation(propagation, &Request { pressures, weights: None }).expect("a problem");
        let rows = Rows::new(&problem, work);
        let mut wave = Wave::new(&rows, work);
        let drive: Vec<Complex64> = (0..transducers).map(|_| number() * 0.7).collect();
        wave.play(&rows, drive.iter().map(|q| Complex32::new(q.re as f32, q.im as f32)));
        (problem, rows, wave)
    }

    pub(crate) fn wide(z: Complex32) -> Complex64 {
        Complex64::new(f64::from(z.re), f64::from(z.im))
    }

    /// G in double precision.
    pub(crate) struct Exact<'a>(&'a Problem);

    impl<'a> Exact<'a> {
        pub(crate) fn new(problem: &'a Problem) -> Self {
            Self(problem)
        }

        pub(crate) fn gain(&self, j: usize, i: usize) -> Complex64 {
            self.0.propagation().exact(j, i) / self.0.propagation().reference()
        }

        pub(crate) fn drive(&self, wave: &Wave) -> Vec<Complex32> {
            wave.drives(self.0.propagation().transducers(), &mut Workspace::new())
        }

        /// The largest error of a wave's field and moduli.
        pub(crate) fn miss(&self, rows: &Rows, wave: &Wave) -> f64 {
            let drive = self.drive(wave);
            let misses = rows.order.iter().enumerate().map(|(k, &j)| {
                let propagation = drive.iter().enumerate().map(|(i, &q)| self.gain(j as usize, i) * wide(q));
                let want = propagation.sum::<Complex64>() * f64::from(rows.scale[k]);
                let field = Complex32::new(wave.field[0][k], wave.field[1][k]);
                (wide(field) - want).norm().max((want.norm() - f64::from(wave.moduli[k])).abs())
            });
            misses.fold(0.0, f64::max)
        }
    }

    #[test]
    fn a_wave_is_a_drive_and_its_field() {
        let mut work = Workspace::new();
        for points in 1..=20 {
            let (problem, rows, mut wave) = random(points, 37, &mut work);
            let exact = Exact::new(&problem);
            assert!(exact.miss(&rows, &wave) < 1e-4, "{points}: as it is");
            let mut other = Wave::new(&rows, &mut work);
            other.turn(&rows, &wave, &alloc::vec![0.5; rows.lanes], -0.2);
            assert!(exact.miss(&rows, &other) < 1e-4, "{points}: turned");
            for (q, before) in exact.drive(&other).into_iter().zip(exact.drive(&wave)) {
                let angle = (wide(q) / wide(before)).arg();
                assert!((q.norm() - 1.0).abs() < 1e-6 && (angle + libm::atan(0.1)).abs() < 1e-6);
            }
            wave.copy(&other);
            assert_eq!(exact.drive(&wave), exact.drive(&other));
        }
    }

    #[test]
    fn rows_made_alike_ask_for_one_modulus_and_end_with_the_quiet_ones() {
        let mut work = Workspace::new();
        let matrix: Vec<Complex64> = (0..5 * 37).map(|k| Complex64::cis(f64::from(k))).collect();
        let propagation = Propagation::from_matrix(&matrix, 5).expect("propagation");
        let request = Request { pressures: Some(alloc::vec![2.0, 0.0, 4.0, 1.0, 0.0]), weights: None };
        let problem = Problem::with_propagation(propagation, &request).expect("a problem");
        let rows = Rows::alike(&problem, &mut work);
        assert_eq!((&rows.order[..], rows.loud), (&[0, 2, 3, 1, 4][..], 3));
        assert_eq!(rows.scale, [2.0, 1.0, 4.0, 1.0, 1.0]);
        let mut wave = Wave::new(&rows, &mut work);
        wave.play(&rows, core::iter::repeat_n(Complex32::new(0.6, -0.8), 37));
        assert!(Exact::new(&problem).miss(&rows, &wave) < 1e-4);
    }
}
