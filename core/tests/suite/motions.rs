//! Tests that a scene's place and order do not change results: permuted, moved and mirrored scenes, for every registered
//! solver. The transducers have normals and responses, so that an error in these would be found.

use midair::solvers::{Entry, SOLVERS};
use midair::{
    Array, Complex64, Control, Directivity, Medium, Metrics, Options, Request, Rng, Scene, Transducer, Workspace,
};

use crate::scenes::{problem, random_points};

/// The parts of a scene, so that they can be changed.
#[derive(Clone)]
struct Parts {
    positions: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    response: Vec<Complex64>,
    points: Vec<[f64; 3]>,
    pressures: Vec<f64>,
    weights: Vec<f64>,
}

impl Parts {
    /// Returns 14 x 14 transducers with different responses and tilted normals, and five points at least 10 mm apart. Their
    /// targets are near the balanced level; the last point is quiet.
    fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let grid = Array::grid(14, 14, 10e-3).expect("a grid");
        let mut points: Vec<[f64; 3]> = Vec::new();
        for candidate in random_points(1000, 0.06, seed) {
            let near = |point: &[f64; 3]| (point[0] - candidate[0]).hypot(point[1] - candidate[1]) < 0.01;
            if points.len() < 5 && !points.iter().any(near) {
                points.push(candidate);
            }
        }
        let mut parts = Self {
            positions: grid.positions().to_vec(),
            normals: grid.positions().iter().map(|[x, y, _]| [-2.0 * x + 0.05, -y, 1.0]).collect(),
            response: (0..196).map(|_| Complex64::from_polar(0.7 + 0.6 * rng.uniform(), 6.0 * rng.uniform())).collect(),
            points,
            pressures: vec![1.0, 0.8, 1.0, 0.6, 0.0],
            weights: vec![1.0, 1.0, 2.0, 1.0, 0.5],
        };
        let factor = problem(&parts.scene()).balance();
        parts.pressures.iter_mut().for_each(|pressure| *pressure *= factor);
        parts
    }

    fn scene(&self) -> Scene {
        let transducer = Transducer { directivity: Directivity::T4010A1, ..Transducer::default() };
        let array = Array::new(self.positions.clone(), Some(self.normals.clone()))
            .and_then(|array| array.with_transducer(transducer))
            .and_then(|array| array.with_response(Some(self.response.clone())))
            .expect("an array");
        let request = Request {
            pressures: Some(self.pressures.clone()),
            weights: Some(self.weights.clone()),
            ..Request::default()
        };
        let medium = Medium { absorption: 0.15, ..Medium::default() };
        Scene::new(array, medium, self.points.clone(), request).expect("a scene")
    }

    /// Returns the scene with every position and every normal mapped.
    fn carried(&self, place: impl Fn([f64; 3]) -> [f64; 3], turn: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let map = |list: &[[f64; 3]], by: &dyn Fn([f64; 3]) -> [f64; 3]| list.iter().map(|&x| by(x)).collect();
        Self {
            positions: map(&self.positions, &place),
            normals: map(&self.normals, &turn),
            points: map(&self.points, &place),
            ..self.clone()
        }
    }

    /// Returns the scene with its transducers in another order.
    fn transducers_shuffled(&self) -> Self {
        let order = Rng::new(99).permutation(196);
        let by = |i: &u32| *i as usize;
        Self {
            positions: order.iter().map(|i| self.positions[by(i)]).collect(),
            normals: order.iter().map(|i| self.normals[by(i)]).collect(),
            response: order.iter().map(|i| self.response[by(i)]).collect(),
            ..self.clone()
        }
    }

    /// Returns the scene with its points in another order.
    fn points_shuffled(&self) -> Self {
        let order = [3, 0, 4, 2, 1];
        Self {
            points: order.map(|j| self.points[j]).to_vec(),
            pressures: order.map(|j| self.pressures[j]).to_vec(),
            weights: order.map(|j| self.weights[j]).to_vec(),
            ..self.clone()
        }
    }
}

fn metrics(entry: &Entry, parts: &Parts) -> [f64; 6] {
    let solver = entry.configure(&Options::new()).expect("defaults").solver;
    let answer = solver.solve(&problem(&parts.scene()), &mut Workspace::new(), &mut Control::none());
    let Metrics { accuracy, sigma, uniformity, level, residual, leak } = answer.expect("an answer").metrics();
    [accuracy, sigma, uniformity, level, residual, leak]
}

#[test]
#[ignore = "slow"]
fn permuting_moving_or_mirroring_a_whole_scene_changes_no_metric() {
    type Change = fn(&Parts) -> Parts;
    let changes: [(&str, Change); 5] = [
        ("transducers permuted", Parts::transducers_shuffled),
        ("points permuted", Parts::points_shuffled),
        ("moved", |parts| parts.carried(|[x, y, z]| [x + 3.0, y - 2.0, z + 7.0], |normal| normal)),
        ("mirrored", |parts| parts.carried(|[x, y, z]| [-x, y, z], |[x, y, z]| [-x, y, z])),
        ("turned over", |parts| parts.carried(|[x, y, z]| [z, -y, x], |[x, y, z]| [z, -y, x])),
    ];
    let parts: Vec<Parts> = (0..20).map(|seed| Parts::new(200 + seed)).collect();
    for entry in SOLVERS {
        // A method with a seed makes other random choices if the order changes, so only means are equal. Any other method must
        // give the same metrics for each scene.
        let drawn = entry.options().iter().any(|option| option.name == "seed");
        let before: Vec<_> = parts.iter().map(|parts| metrics(entry, parts)).collect();
        for (what, change) in changes {
            let mut sums = [0.0; 6];
            for (parts, before) in parts.iter().zip(&before) {
                for ((sum, after), before) in sums.iter_mut().zip(metrics(entry, &change(parts))).zip(before) {
                    let by = after - before;
                    *sum += if drawn { by } else { by.abs() } / 20.0;
                }
            }
            let most = sums.iter().fold(0.0, |most: f64, sum| most.max(sum.abs()));
            assert!(most <= entry.info.tolerance, "{} {what}: {sums:?}", entry.info.name);
        }
    }
}
