//! Tests of image sources, against sums written out in f64 and against the boundary conditions.

use core::f64::consts::TAU;

use num_complex::{Complex32, Complex64};

use crate::control::Control;
use crate::kernels::InstructionSet;
use crate::propagation::{Model, Propagation, field};
use crate::scene::{Array, Directivity, Medium, Obstacle, Request, Scene, Surface, Transducer};

fn wall(point: [f64; 3], normal: [f64; 3], kind: Surface) -> Obstacle {
    Obstacle::Wall { point, normal, kind }
}

fn array(directivity: Directivity) -> Array {
    let array = Array::grid(6, 4, 9e-3).expect("a grid");
    array.with_transducer(Transducer { directivity, ..Transducer::default() }).expect("a transducer")
}

fn model(array: &Array, obstacles: &[Obstacle]) -> Model {
    let medium = Medium { absorption: 0.3, ..Medium::default() };
    let model = Model::new(array, medium, InstructionSet::best()).expect("a model");
    model.with_obstacles(obstacles).expect("obstacles")
}

fn all(propagation: &Propagation, j: usize) -> Vec<Complex64> {
    (0..propagation.transducers()).map(|i| propagation.exact(j, i)).collect()
}

/// The pressure of a piston i with absorption, mirrored at the plane x = `at`, as a formula written out.
fn mirrored(array: &Array, i: usize, at: f64, [x, y, z]: [f64; 3]) -> Complex64 {
    let [a, b, c] = array.positions()[i];
    let ray = [x - (2.0 * at - a), y - b, z - c];
    let r = ray.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (k, n) = (TAU * 40e3 / Medium::default().sound_speed, array.normals()[i]);
    let cosine = (-ray[0] * n[0] + ray[1] * n[1] + ray[2] * n[2]) / r;
    let argument = k * 4.5e-3 * (1.0 - cosine * cosine).sqrt();
    let directivity = if cosine < 0.0 { 0.0 } else { 2.0 * libm::j1(argument) / argument };
    Complex64::from_polar(4.386 / r * directivity * (-0.3 * r).exp(), k * r)
}

#[test]
fn a_wall_adds_its_image() {
    let array = array(Directivity::piston(4.5e-3));
    let tilted = Array::new(array.positions().to_vec(), Some(vec![[0.3, 0.1, 1.0]; array.len()])).expect("an array");
    let array = tilted.with_transducer(array.transducer()).expect("a transducer");
    let points = [[0.01, 0.02, 0.15], [0.0599, -0.03, 0.1], [-0.2, 0.1, 0.3]];
    for (kind, sign) in [(Surface::Rigid, 1.0), (Surface::Soft, -1.0)] {
        // Sound is on the array's side of the wall, whatever the sign and the length of the normal.
        for normal in [[1.0, 0.0, 0.0], [-3e-5, 0.0, 0.0]] {
            let behind = model(&array, &[wall([0.06, 7.0, 7.0], normal, kind)]);
            let [walled, bare] =
                [&behind, &model(&array, &[])].map(|model| model.propagation(&points).expect("points"));
            for (j, &point) in points.iter().enumerate() {
                for i in 0..array.len() {
                    let expected = bare.exact(j, i) + sign * mirrored(&array, i, 0.06, point);
                    assert!((walled.exact(j, i) - expected).norm() < 1e-9, "{j} {i} {kind:?}");
                }
            }
        }
    }
}

#[test]
fn surfaces_do_what_they_must() {
    let array = array(Directivity::POINT);
    let [floor, side, back] = [
        ([0.0, -0.05, 0.0], [0.0, 1.0, 0.2]),
        ([0.07, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.4], [0.0, -0.2, 1.0]),
    ];
    for kinds in [[Surface::Rigid; 3], [Surface::Soft; 3], [Surface::Rigid, Surface::Soft, Surface::Rigid]] {
        let corner: Vec<_> =
            [floor, side, back].iter().zip(kinds).map(|((point, normal), kind)| wall(*point, *normal, kind)).collect();
        let model = model(&array, &corner);
        // For each wall: a place on it, far from the other walls, and places 10 and 20 um in front of it.
        for ((point, normal), kind) in [floor, side, back].into_iter().zip(kinds) {
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            let unit = normal.map(|x| x / length);
            let inside = [0.02, 0.03, 0.2];
            let height: f64 = (0..3).map(|x| (inside[x] - point[x]) * unit[x]).sum();
            let place = |h: f64| [0, 1, 2].map(|x| inside[x] - (height - h * height.signum()) * unit[x]);
            let values = [0.0, 1e-5, 2e-5].map(|h| all(&model.propagation(&[place(h)]).expect("a point"), 0));
            for i in 0..array.len() {
                let [on, near, far] = [values[0][i], values[1][i], values[2][i]];
                // The derivative along the normal from three values, a difference of second order.
                let slope = (4.0 * near - far - 3.0 * on) / 2e-5;
                match kind {
                    Surface::Rigid => assert!(slope.norm() < 1e-3 * 740.0 * 40.0, "{slope} {i}"),
                    Surface::Soft => assert!(on.norm() < 1e-9, "{on} {i}"),
                }
            }
        }
    }
}

#[test]
fn images_are_counted() {
    let array = array(Directivity::POINT);
    let x = |at: f64| wall([at, 0.0, 0.0], [1.0, 0.0, 0.0], Surface::Rigid);
    let y = |at: f64| wall([0.0, at, 0.0], [0.0, 1.0, 0.0], Surface::Rigid);
    let z = wall([0.0, 0.0, 0.3], [0.0, 0.0, 1.0], Surface::Soft);
    let images = |obstacles: &[Obstacle]| model(&array, obstacles).scattering.map_or(0, |all| all.images.len());
    assert_eq!(images(&[]), 0);
    assert_eq!(images(&[x(0.1)]), 1);
    assert_eq!(images(&[x(0.1), y(0.1)]), 3);
    assert_eq!(images(&[x(0.1), y(0.1), z]), 7);
    // Up to three reflections between two opposite walls; the first one is at either wall.
    assert_eq!(images(&[x(0.1), x(-0.1)]), 6);
}

#[test]
fn fields_and_pressures_are_those_of_the_images() {
    let array = array(Directivity::piston(4.5e-3));
    let model = model(&array, &[wall([0.06, 0.0, 0.0], [1.0, 0.0, 0.0], Surface::Soft)]);
    let drive: Vec<_> = (0..array.len()).map(|i| Complex32::from_polar(1.0, i as f32)).collect();
    let points: Vec<_> = (0..300).map(|j| [0.1 - 1e-3 * f64::from(j), 0.01, 0.1 + 2e-4 * f64::from(j)]).collect();
    let pressures = field(&model, &drive, &points, &mut Control::none()).expect("a field");
    let largest = pressures.iter().map(|p| p.norm()).fold(0.0, f32::max);
    for (p, point) in pressures.iter().zip(&points) {
        if point[0] > 0.06 + 1e-9 {
            assert_eq!(*p, Complex32::ZERO);
            continue;
        }
        let row = all(&model.propagation(&[*point]).expect("a point"), 0);
        let wide = |q: &Complex32| Complex64::new(f64::from(q.re), f64::from(q.im));
        let exact: Complex64 = row.iter().zip(&drive).map(|(g, q)| g * wide(q)).sum();
        assert!((wide(p) - exact).norm() < 1e-5 * f64::from(largest), "{p} {exact}");
    }
}

#[test]
fn scenes_keep_obstacles_and_refuse_what_cannot_be() {
    let scene = |points: Vec<[f64; 3]>, obstacles: Vec<Obstacle>| {
        let scene = Scene::new(array(Directivity::POINT), Medium::default(), points, Request::default());
        scene.and_then(|scene| scene.with_obstacles(obstacles))
    };
    let reported = |obstacles: Vec<Obstacle>| scene(vec![[0.0, 0.0, 0.1]], obstacles).expect_err("refused").to_string();
    let rigid = |point, normal| wall(point, normal, Surface::Rigid);
    let cases = [
        (
            vec![rigid([0.0, f64::NAN, 0.0], [1.0, 0.0, 0.0])],
            "obstacles[0].point is [0.0, NaN, 0.0]: give three finite",
        ),
        (vec![rigid([0.0; 3], [0.0; 3])], "obstacles[0].normal is [0.0, 0.0, 0.0]: give the direction the wall faces"),
        (vec![rigid([0.01, 0.0, 0.0], [1.0, 0.0, 0.0])], "obstacles[0] is a wall through [0.01, 0.0, 0.0]: it crosses"),
        (vec![rigid([0.0, 0.0, 0.05], [0.0, 0.0, 1.0])], "points[0].position is [0.0, 0.0, 0.1]: behind the wall obst"),
        (vec![rigid([1e9, 0.0, 0.0], [1.0, 0.0, 0.0])], "obstacles[0] is 1.000e9 m from the array: leave it out or"),
        (
            vec![rigid([0.1, 0.0, 0.0], [1.0, 0.0, 0.0]), rigid([0.0, 0.1, 0.0], [1.0, 1.0, 0.0])],
            "obstacles[1].normal is turned by 45.000 degrees: walls are parallel or at right angles",
        ),
        (
            vec![rigid([0.1, 0.0, 0.0], [1.0, 0.0, 0.0]), rigid([0.2, 0.0, 0.0], [1.0, 0.0, 0.0])],
            "obstacles[1] is a wall on the same side: obstacles[0] is parallel to it, one hides the other",
        ),
    ];
    for (obstacles, cure) in cases {
        let line = reported(obstacles);
        assert!(line.starts_with(cure), "{line}");
    }
    // If the array lies in the wall, the normal decides which side has sound.
    assert!(scene(vec![[0.0, 0.0, 0.1]], vec![rigid([0.0; 3], [0.0, 0.0, 1.0])]).is_ok());
    assert!(scene(vec![[0.0, 0.0, -0.1]], vec![rigid([0.0; 3], [0.0, 0.0, 1.0])]).is_err());
    let many = (0..3000).map(|j| [1e-5 * f64::from(j), 0.0, 0.1]).collect();
    let scene = scene(many, vec![rigid([0.1, 0.0, 0.0], [1.0, 0.0, 0.0])]).expect("a scene");
    assert_eq!(Model::of(&scene, InstructionSet::best()).obstacles(), scene.obstacles());
}
