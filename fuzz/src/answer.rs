//! Checks of solutions: what every solution must fulfil, and the largest allowed differences between f32 and f64.

use midair::{Array, Complex32, Complex64, Directivity, Error, Medium, Metrics, Problem, Propagation, Solution};

/// The allowed relative error of a sum of about a hundred elements of the propagation matrix G, each accurate to 2e-4 near the
/// array.
const NEAR: f64 = 1e-3;

/// Numbers below this, relative to the reference, are lost in f32.
const NOTHING: f64 = 1e-34;

/// The spacing of subnormal pressures in f32, in Pa.
const SPACING: f64 = 1.5e-45;

/// Returns the value of a result. Checks that the message of an error is one line, neither empty nor very long.
pub fn one_line<T>(result: Result<T, Error>) -> Option<T> {
    result
        .map_err(|error| {
            let line = error.to_string();
            assert!(!line.trim().is_empty() && !line.contains(['\n', '\r']), "not one line: {line:?}");
            assert!(line.len() < 2000, "no line but a page: {line:?}");
        })
        .ok()
}

/// The allowed error of every element of the propagation matrix G in Pa at full drive, point by point.
pub struct Allowed(Vec<Vec<f64>>);

impl Allowed {
    /// Returns the allowed errors of a computed propagation matrix G. They are relative to the pressure on the axis, because
    /// directivities have zeros. Near the plane of a transducer, where its directivity jumps to 0, the error may be as large as
    /// that pressure. The allowed phase error grows with the distance, which f32 rounds in wavelengths.
    pub fn of(array: &Array, medium: Medium, points: &[[f64; 3]]) -> Self {
        let origin = array.positions()[0];
        let places = array.positions().iter().chain(points);
        let distances = places.flat_map(|place| (0..3).map(move |axis| (place[axis] - origin[axis]).abs()));
        let tolerance = NEAR + 4e-6 * distances.fold(0.0, f64::max) / medium.wavelength();
        let gain = |i: usize| match (array.mask(), array.response()) {
            (Some(mask), _) if !mask[i] => 0.0,
            (_, Some(response)) => response[i].norm(),
            _ => 1.0,
        };
        let element = |i: usize, point: &[f64; 3]| {
            let ray = [0, 1, 2].map(|axis| point[axis] - array.positions()[i][axis]);
            let distance = ray.iter().map(|x| x * x).sum::<f64>().sqrt();
            let cosine = ray.iter().zip(array.normals()[i]).map(|(x, n)| x * n).sum::<f64>() / distance;
            let jump = array.transducer().directivity != Directivity::POINT && cosine.abs() < tolerance;
            let part = if jump { 1.0 + tolerance } else { tolerance };
            part * array.transducer().source_pressure * gain(i) / distance
        };
        Self(points.iter().map(|point| (0..array.len()).map(|i| element(i, point)).collect()).collect())
    }

    /// Returns the allowed errors of a user's own propagation matrix G.
    pub fn given(propagation: &Propagation) -> Self {
        let element = |j: usize, i: usize| NEAR * propagation.exact(j, i).norm();
        let row = |j: usize| (0..propagation.transducers()).map(|i| element(j, i)).collect();
        Self((0..propagation.points()).map(row).collect())
    }

    /// Returns the largest allowed relative error of the sum of moduli at a point. It is 1 or more if f32 may round that sum to
    /// 0, at an angle where a directivity is nearly 0.
    pub fn doubt(&self, propagation: &Propagation) -> f64 {
        let level = |j: usize| (0..propagation.transducers()).map(|i| propagation.exact(j, i).norm()).sum::<f64>();
        let doubts = self.0.iter().enumerate().map(|(j, row)| row.iter().sum::<f64>() / level(j));
        doubts.map(|doubt| if doubt.is_nan() { f64::INFINITY } else { doubt }).fold(NEAR, f64::max)
    }

    /// Checks that every row agrees with the propagation matrix G in f64, and that its padding is 0.
    pub fn check_rows(&self, propagation: &Propagation) {
        let (points, set) = (propagation.points(), propagation.instruction_set());
        let [mut re, mut im] = [(); 2].map(|()| vec![f32::NAN; propagation.lanes()]);
        for i in 0..propagation.transducers() {
            propagation.row(i, &mut re, &mut im);
            for j in 0..points {
                let exact = propagation.exact(j, i) / propagation.reference();
                let error = (Complex64::new(f64::from(re[j]), f64::from(im[j])) - exact).norm();
                let allowed = self.0[j][i] / propagation.reference() + NOTHING;
                assert!(error <= allowed, "{set}: G[{j}, {i}] is off by {error:e} of {exact}, {allowed:e} allowed");
            }
            assert!(re[points..].iter().chain(&im[points..]).all(|&x| x == 0.0), "{set}: the padding is not silent");
        }
    }

    /// Checks that pressures agree with `scale` G q in f64.
    pub fn check_field(
        &self,
        propagation: &Propagation,
        drive: &[Complex32],
        scale: f64,
        pressures: &[Complex32],
        name: &str,
    ) {
        assert_eq!(pressures.len(), propagation.points(), "{name}");
        let largest = drive.iter().map(|q| f64::from(q.norm())).fold(0.0, f64::max);
        for (j, pressure) in pressures.iter().enumerate() {
            let exact = (0..drive.len()).map(|i| propagation.exact(j, i) * wide(drive[i])).sum::<Complex64>() * scale;
            let whole = self.0[j].iter().sum::<f64>() * largest * scale;
            let allowed = whole + NOTHING * propagation.reference() * drive.len() as f64 + SPACING;
            let error = (wide(*pressure) - exact).norm();
            assert!(
                error <= allowed,
                "{name}: p[{j}] is {pressure} for {exact}, off by {error:e}, {allowed:e} allowed"
            );
        }
    }

    /// Checks a solution: the drive can be played, the pressures are those of the drive in f64, and the metrics are finite.
    pub fn check(&self, problem: &Problem, propagation: &Propagation, solution: &Solution, name: &str) {
        let drive = &solution.drive;
        assert_eq!(drive.len(), propagation.transducers(), "{name}");
        assert!(drive.iter().all(|q| q.norm() <= 1.0 + 1e-6), "{name}: {drive:?}");
        if let Some(quantization) = problem.quantization() {
            // The tolerance is for the last bits of a phase, which may change when it is rounded again.
            let off = drive.iter().find(|q| (quantization.nearest(**q) - **q).norm() > 1e-6);
            assert!(off.is_none(), "{name}: {off:?} is not on the grid of the board");
        }
        assert!(solution.scale > 0.0 && solution.scale <= 1.0, "{name}: scale {}", solution.scale);
        let dead = |i: usize| self.0.iter().all(|row| row[i] == 0.0);
        let loud = drive.iter().enumerate().find(|&(i, q)| *q != Complex32::ZERO && dead(i));
        assert!(loud.is_none(), "{name}: a dead transducer is driven: {loud:?}");
        self.check_field(propagation, drive, solution.scale, &solution.pressures, name);
        check_metrics(solution.metrics(), name);
        assert!(solution.targets().iter().all(|target| target.is_finite()), "{name}");
    }
}

/// Checks that all metrics are finite and within their bounds.
fn check_metrics(metrics: Metrics, name: &str) {
    let Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
    let all = [accuracy, sigma, uniformity, level, residual, leak];
    assert!(all.iter().all(|x| x.is_finite() && *x >= 0.0), "{name}: {metrics:?}");
    assert!(uniformity <= 1.0 && sigma <= 1.0, "{name}: {metrics:?}");
}

fn wide(z: Complex32) -> Complex64 {
    Complex64::new(f64::from(z.re), f64::from(z.im))
}
