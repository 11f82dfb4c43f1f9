//! Tests of `tiled`.

use super::*;
use crate::problem::Setup;
use crate::propagation::Propagation;
use crate::rng::Rng;
use crate::scene::Request;
use num_complex::Complex64;

/// Returns a random problem with targets 1, 2, 3, ..., its rows of G unchanged, and a random wave.
pub(crate) fn random(points: usize, transducers: usize, work: &Workspace) -> (Problem, Rows<'_>, Wave<'_>) {
    let mut rng = Rng::new(points as u64);
    let mut number = || Complex64::new(2.0 * rng.uniform() - 1.0, 2.0 * rng.uniform() - 1.0);
    let matrix: Vec<Complex64> = (0..points * transducers).map(|_| number()).collect();
    let pressures = Some((1..=points).map(|j| j as f64).collect());
    let propagation = Propagation::from_matrix(&matrix, points).expect("propagation");
    let problem =
        Problem::with_propagation(propagation, Setup::default(), &Request { pressures, ..Request::default() })
            .expect("a problem");
    let rows = Rows::new(&problem, work, &mut Control::none()).expect("a few numbers");
    let mut wave = Wave::new(&rows, work);
    let drive: Vec<Complex64> = (0..transducers).map(|_| number() * 0.7).collect();
    wave.play(&rows, drive.iter().map(|q| Complex32::new(q.re as f32, q.im as f32)));
    (problem, rows, wave)
}

pub(crate) fn wide(z: Complex32) -> Complex64 {
    Complex64::new(f64::from(z.re), f64::from(z.im))
}

/// G of a problem in double precision.
pub(crate) struct Exact<'a>(&'a Problem);

impl<'a> Exact<'a> {
    pub(crate) fn new(problem: &'a Problem) -> Self {
        Self(problem)
    }

    pub(crate) fn gain(&self, j: usize, i: usize) -> Complex64 {
        self.0.propagation().exact(j, i) / self.0.propagation().reference()
    }

    pub(crate) fn drive(&self, wave: &Wave) -> Vec<Complex32> {
        wave.drives(self.0.propagation().transducers(), &Workspace::new())
    }

    /// Returns the largest error of a wave's field and moduli.
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
    let work = Workspace::new();
    for points in 1..=20 {
        let (problem, rows, mut wave) = random(points, 37, &work);
        let exact = Exact::new(&problem);
        assert!(exact.miss(&rows, &wave) < 1e-4, "{points}: as it is");
        let mut other = Wave::new(&rows, &work);
        other.rotate(&rows, &wave, &alloc::vec![0.5; rows.lanes], -0.2);
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
fn rows_made_alike_request_one_modulus_and_end_with_quiet_points() {
    let work = Workspace::new();
    let matrix: Vec<Complex64> = (0..5 * 37).map(|k| Complex64::cis(f64::from(k))).collect();
    let propagation = Propagation::from_matrix(&matrix, 5).expect("propagation");
    let request = Request { pressures: Some(alloc::vec![2.0, 0.0, 4.0, 1.0, 0.0]), ..Request::default() };
    let problem = Problem::with_propagation(propagation, Setup::default(), &request).expect("a problem");
    let rows = Rows::alike(&problem, &[1, 4], &work, &mut Control::none()).expect("a few numbers");
    assert_eq!((&rows.order[..], rows.targeted), (&[0, 2, 3, 1, 4][..], 3));
    assert_eq!(rows.scale[..], [2.0, 1.0, 4.0, 1.0, 1.0]);
    let mut wave = Wave::new(&rows, &work);
    wave.play(&rows, core::iter::repeat_n(Complex32::new(0.6, -0.8), 37));
    assert!(Exact::new(&problem).miss(&rows, &wave) < 1e-4);
}
