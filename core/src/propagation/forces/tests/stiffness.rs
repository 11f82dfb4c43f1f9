//! Tests of `stiffness`.

use super::*;
use crate::control::Control;
use crate::kernels::InstructionSet;
use crate::propagation::Model;
use crate::propagation::forces::gorkov::gorkov;
use crate::propagation::recipe::Recipe;
use crate::rng::Rng;
use crate::scene::{Array, Bead, Directivity, Obstacle, Particle, Signature, Surface, Transducer};

/// Returns a model of two facing arrays of 4 x 3 transducers with a wall beside them, and the stored propagation matrix G at
/// two points.
fn recipe() -> (Model, Recipe) {
    let place = |i: usize| [0.011 * (i % 4) as f64, 0.012 * (i / 4 % 3) as f64, if i < 12 { 0.0 } else { 0.08 }];
    let normals = (0..24).map(|i| [0.0, 0.0, if i < 12 { 1.0 } else { -1.0 }]).collect();
    let transducer = Transducer { directivity: Directivity::piston(4.5e-3), ..Transducer::default() };
    let array = Array::new((0..24).map(place).collect(), Some(normals));
    let array = array.and_then(|array| array.with_transducer(transducer)).expect("an array");
    let wall = Obstacle::Wall { point: [-0.05, 0.0, 0.0], normal: [1.0, 0.0, 0.0], kind: Surface::Rigid };
    let model = Model::new(&array, Medium::default(), InstructionSet::best())
        .and_then(|model| model.with_obstacles(&[wall]))
        .expect("a model")
        .with_signature(Some(Signature::Trap));
    let propagation = model.propagation(&[[0.01, 0.02, 0.037], [0.024, 0.005, 0.044]]).expect("points");
    let recipe = propagation.origin().and_then(|(_, _, recipe)| recipe).expect("kept").clone();
    (model, recipe)
}

#[test]
fn it_is_the_stiffness_of_gorkov_and_its_slope() {
    let (model, recipe) = recipe();
    let traps =
        (recipe.make.stiffness)(&recipe, Bead::default(), &mut Control::none()).expect("room").expect("derivatives");
    let mut rng = Rng::new(3);
    let drive: Vec<_> = (0..24).map(|_| Complex32::cis(6.3 * rng.uniform() as f32)).collect();
    let trap = gorkov(&model, &drive, &recipe.points, Particle::default(), &mut Control::none()).expect("a force");
    let c = traps.field(&drive);
    let planes = |c: &[Vec<f32>; 2]| -> Vec<f64> { traps.at([&c[0], &c[1]]).collect() };
    let reported = planes(&c);
    let exact: Vec<f64> = trap.hessian.iter().flat_map(|hessian| eigen(*hessian).0).collect();
    let largest = exact.iter().fold(0.0_f64, |most, k| most.max(k.abs()));
    assert_eq!(reported.len(), 6);
    for (reported, exact) in reported.iter().zip(&exact) {
        assert!((reported - exact).abs() < 1e-5 * largest, "{reported} {exact}");
    }
    // Compares the derivative in the direction of another field's coefficients with a central difference.
    let weights = [0.3, -0.2, 0.7, 0.1, 0.9, -0.4];
    let way = traps.field(&drive.iter().rev().copied().collect::<Vec<_>>());
    let shifted = |part: f32| [0, 1].map(|k| c[k].iter().zip(&way[k]).map(|(a, b)| a + part * b).collect());
    let forces = [[2e3, -1e3, 3e3], [-500.0, 700.0, 4e3]];
    let net = |c: &[Vec<f32>; 2]| traps.balance([&c[0], &c[1]]).0;
    for (sum, force) in net(&c).iter().zip(&trap.force) {
        let exact = [0, 1, 2].map(|axis| force[axis] + traps.load[0][axis]);
        assert!(sum.iter().zip(exact).all(|(sum, exact)| (sum - exact).abs() < 1e-8 * largest), "{sum:?} {exact:?}");
    }
    let sum = |c: &[Vec<f32>; 2]| {
        let pulled = net(c).as_flattened().iter().zip(forces.as_flattened()).map(|(f, v)| f * v).sum::<f64>();
        planes(c).iter().zip(&weights).map(|(k, w)| k * w).sum::<f64>() + pulled
    };
    let mut pulls = [vec![0.0; c[0].len()], vec![0.0; c[0].len()]];
    let [re, im] = &mut pulls;
    traps.pull([&c[0], &c[1]], &weights, &forces, [re, im]);
    let slope: f64 =
        pulls.iter().zip(&way).flat_map(|(p, w)| p.iter().zip(w)).map(|(p, w)| f64::from(*p) * f64::from(*w)).sum();
    let difference = (sum(&shifted(0.01)) - sum(&shifted(-0.01))) / 0.02;
    assert!((slope - difference).abs() < 1e-3 * largest, "{slope} {difference}");
}

#[test]
fn beside_a_ball_it_is_that_of_gorkov_and_on_its_surface_there_is_none() {
    let (model, recipe) = recipe();
    let ball = Obstacle::Sphere { center: [0.04, 0.02, 0.04], radius: 0.01, kind: Surface::Rigid };
    let model = model.with_obstacles(&[ball]).expect("a model");
    let traps = |points: &[[f64; 3]]| {
        let propagation = model.propagation(points).expect("points");
        let recipe = propagation.origin().and_then(|(_, _, recipe)| recipe).expect("kept");
        (recipe.make.stiffness)(recipe, Bead::default(), &mut Control::none()).expect("room")
    };
    let mut rng = Rng::new(4);
    let drive: Vec<_> = (0..24).map(|_| Complex32::cis(6.3 * rng.uniform() as f32)).collect();
    let trap = gorkov(&model, &drive, &recipe.points, Particle::default(), &mut Control::none()).expect("a force");
    let known = traps(&recipe.points).expect("derivatives");
    let c = known.field(&drive);
    let exact: Vec<f64> = trap.hessian.iter().flat_map(|hessian| eigen(*hessian).0).collect();
    let largest = exact.iter().fold(0.0_f64, |most, k| most.max(k.abs()));
    let (net, _) = known.balance([&c[0], &c[1]]);
    for (value, exact) in known.at([&c[0], &c[1]]).zip(&exact) {
        assert!((value - exact).abs() < 1e-4 * largest, "{value} {exact}");
    }
    for (net, force) in net.iter().zip(&trap.force) {
        let far = [0, 1, 2].map(|axis| (net[axis] - force[axis] - known.load[0][axis]).abs());
        assert!(far.iter().all(|far| *far < 1e-7 * largest), "{far:?}");
    }
    assert!(traps(&[[0.03 - 2e-5, 0.02, 0.04]]).is_none());
}
