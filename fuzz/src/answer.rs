//! Answers: requirements of every solution, and the largest differences of f32 from f64.

use midair::{Array, Complex32, Complex64, Directivity, Error, Medium, Metrics, Problem, Propagation, Solution};

/// Relative error of sums of a hundred or so elements of G, each within 2e-4 near the array.
const NEAR: f64 = 1e-3;

/// Numbers beside the reference that f32 does not hold.
const NOTHING: f64 = 1e-34;

/// Pa: the spacing of pressures in f32 below its normal numbers.
const SPACING: f64 = 1.5e-45;

/// What was answered; a refusal must be one line that says something.
pub fn one_line<T>(result: Result<T, Error>) -> Option<T> {
    result
        .map_err(|error| {
            let line = error.to_string();
            assert!(!line.trim().is_empty() && !line.contains(['\n', '\r']), "not one line: {line:?}");
            assert!(line.len() < 2000, "no line but a page: {line:?}");
        })
        .ok()
}

/// Errors allowed in Pa at full drive: of every element of G, point by point.
pub struct Allowed(Vec<Vec<f64>>);

impl Allowed {
    /// Of a computed G: relative to the transducers straight ahead, since a directivity has zeros, and all of that at the
    /// baffle, where it jumps. A phase in f32 is off in proportion to the distance, some ten roundings of a turn.
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

    /// Of a matrix.
    pub fn given(propagation: &Propagation) -> Self {
        let element = |j: usize, i: usize| NEAR * propagation.exact(j, i).norm();
        let row = |j: usize| (0..propagation.transducers()).map(|i| element(j, i)).collect();
        Self((0..propagation.points()).map(row).collect())
    }

    /// The largest relative error allowed of a point's level, the sum of its moduli: 1 and more where f32 may round it to
    /// silence, at an angle where a directivity is nearly 0.
    pub fn doubt(&self, propagation: &Propagation) -> f64 {
        let level = |j: usize| (0..propagation.transducers()).map(|i| propagation.exact(j, i).norm()).sum::<f64>();
        let doubts = self.0.iter().enumerate().map(|(j, row)| row.iter().sum::<f64>() / level(j));
        doubts.map(|doubt| if doubt.is_nan() { f64::INFINITY } else { doubt }).fold(NEAR, f64::max)
    }

    /// Holds every row to eq. (5) in f64, and its padding to silence.
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

    /// Holds pressures to `scale` G q in f64.
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

    /// Checks a solution against its request: a drive that can be played, pressures that are those of the drive in f64,
    /// metrics that are numbers.
    pub fn check(&self, problem: &Problem, propagation: &Propagation, solution: &Solution, name: &str) {
        let drive = &solution.drive;
        assert_eq!(drive.len(), propagation.transducers(), "{name}");
        assert!(drive.iter().all(|q| q.norm() <= 1.0 + 1e-6), "{name}: {drive:?}");
        if let Some(quantization) = problem.quantization() {
            // Rounding once more turns the last bit of a phase that is not on a grid.
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

/// Metrics are numbers, and those with bounds within them.
fn check_metrics(metrics: Metrics, name: &str) {
    let Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
    let all = [accuracy, sigma, uniformity, level, residual, leak];
    assert!(all.iter().all(|x| x.is_finite() && *x >= 0.0), "{name}: {metrics:?}");
    assert!(uniformity <= 1.0 && sigma <= 1.0, "{name}: {metrics:?}");
}

fn wide(z: Complex32) -> Complex64 {
    Complex64::new(f64::from(z.re), f64::from(z.im))
}
