//! Tests of traps: the force on a bead against finite differences, and solutions with signatures by different functions.

use core::ops::ControlFlow;

use midair::sequence::{Ahead, Ends, ahead, stiffen};
use midair::solvers::Uniform;
use midair::{
    Array, Complex32, Complex64, Control, Directivity, Error, InstructionSet, Medium, Model, Particle, Problem,
    Progress, Propagation, Request, Scene, Session, Signature, SolveRequest, Transducer, Workspace, gorkov,
};

/// Returns two boards of 8 x 8 that face each other along an axis, 0.1 m apart.
fn facing(axis: usize) -> Array {
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for (side, i) in [-1.0, 1.0].into_iter().flat_map(|side| (0..64).map(move |i| (side, i))) {
        let [u, v] = [f64::from(i % 8) - 3.5, f64::from(i / 8) - 3.5];
        let (mut position, mut normal) = ([0.0105 * u, 0.0105 * v, 0.05 * side], [0.0, 0.0, -side]);
        position.rotate_right((axis + 1) % 3);
        normal.rotate_right((axis + 1) % 3);
        positions.push(position);
        normals.push(normal);
    }
    let transducer = Transducer { directivity: Directivity::piston(4.5e-3), ..Transducer::default() };
    Array::new(positions, Some(normals)).and_then(|array| array.with_transducer(transducer)).expect("an array")
}

fn scene(axis: usize, points: &[[f64; 3]], signature: Signature) -> Scene {
    let scene = Scene::new(facing(axis), Medium::default(), points.to_vec(), Request::default());
    scene.and_then(|scene| scene.with_signature(Some(signature))).expect("a scene")
}

fn solved(scene: &Scene) -> midair::Solution {
    let problem = Problem::new(scene).expect("a problem");
    midair::solve(&problem, &Uniform::default(), true, &mut Workspace::new(), &mut Control::none()).expect("a drive")
}

#[test]
fn force_and_stiffness_are_the_slopes_of_the_potential() {
    let scene = scene(2, &[[0.004, -0.003, 0.006]], Signature::Trap);
    let drive = solved(&scene).drive;
    let model = Model::of(&scene, InstructionSet::best());
    let felt = |at: [f64; 3], radius: f64| {
        let particle = Particle { radius, ..Particle::default() };
        gorkov(&model, &drive, &[at], particle, &mut Control::none()).expect("a force")
    };
    let (at, h) = ([0.0052, -0.0017, 0.0071], 2e-6);
    let beside = |axis: usize, radius: f64| {
        [-h, h].map(|h| {
            let mut near = at;
            near[axis] += h;
            felt(near, radius)
        })
    };
    // Travelling waves do not push so small a sphere, so its force is the slope of the potential.
    let here = felt(at, 5e-5);
    let strongest = here.force[0].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for axis in 0..3 {
        let [low, high] = beside(axis, 5e-5);
        let force = (low.potential[0] - high.potential[0]) / (2.0 * h);
        assert!((force - here.force[0][axis]).abs() < 1e-5 * strongest);
    }
    let here = felt(at, 1e-3);
    let stiffest = here.hessian[0][2][2].abs();
    let slopes = [0, 1, 2].map(|axis| {
        let [low, high] = beside(axis, 1e-3);
        [0, 1, 2].map(|other| (low.force[0][other] - high.force[0][other]) / (2.0 * h))
    });
    for axis in 0..3 {
        for other in 0..3 {
            let slope = 0.5 * (slopes[axis][other] + slopes[other][axis]);
            assert!((slope - here.hessian[0][axis][other]).abs() < 1e-5 * stiffest);
            assert_eq!(here.hessian[0][axis][other], here.hessian[0][other][axis]);
        }
    }
}

#[test]
fn boards_trap_whatever_axis_they_face_along() {
    for axis in 0..3 {
        let scene = scene(axis, &[[0.0; 3], [0.01, 0.01, 0.01]], Signature::Trap);
        let model = Model::of(&scene, InstructionSet::best());
        let felt = gorkov(&model, &solved(&scene).drive, scene.points(), Particle::default(), &mut Control::none());
        for stiffness in felt.expect("a force").hessian {
            assert!((0..3).all(|x| stiffness[x][x] > 0.0), "axis {axis}: {stiffness:?}");
        }
    }
}

#[test]
fn a_single_board_has_a_vortex_for_a_trap() {
    let array = Array::grid(16, 16, 10.5e-3).expect("an array");
    let of = |signature| {
        let scene = Scene::new(array.clone(), Medium::default(), vec![[0.01, 0.0, 0.1]], Request::default());
        let scene = scene.and_then(|scene| scene.with_signature(Some(signature))).expect("a scene");
        Problem::new(&scene).expect("a problem").propagation().clone()
    };
    let (trap, vortex) = (of(Signature::Trap), of(Signature::Vortex));
    assert!((0..256).all(|i| trap.exact(0, i) == vortex.exact(0, i)));
    assert!((0..256).any(|i| trap.exact(0, i) != of(Signature::Twin).exact(0, i)));
}

#[test]
fn a_session_and_points_without_weight_keep_the_signature() {
    let points = [[0.0; 3], [0.01, 0.0, 0.01], [0.0, -0.01, 0.02]];
    let whole = scene(2, &points, Signature::Trap);
    let expected = solved(&whole);
    assert_eq!(expected.scene().as_ref(), Some(&whole));
    let model = Model::of(&whole, InstructionSet::best());
    let mut session = Session::new(model, std::sync::Arc::new(Uniform::default()) as std::sync::Arc<_>, true);
    // Other points and other numbers of points do not change the result of a later call.
    for count in [1, 3, 2, 3] {
        let ask = SolveRequest { points: points[..count].to_vec(), ..SolveRequest::default() };
        let solution = session.solve(&ask, &mut Control::none()).expect("a drive");
        assert!(count < 3 || solution.drive == expected.drive);
    }
    let request = Request { weights: Some(vec![1.0, 0.0, 1.0]), ..Request::default() };
    let weighted = Scene::new(whole.array().clone(), Medium::default(), points.to_vec(), request);
    let weighted = weighted.and_then(|scene| scene.with_signature(Some(Signature::Trap))).expect("a scene");
    let two = scene(2, &[points[0], points[2]], Signature::Trap);
    assert_eq!(solved(&weighted).drive, solved(&two).drive);
}

#[test]
fn what_does_not_fit_is_refused() {
    let array = facing(2);
    let make = |factors: Vec<Complex64>| {
        let scene = Scene::new(array.clone(), Medium::default(), vec![[0.0; 3]; 2], Request::default());
        scene.and_then(|scene| scene.with_signature(Some(Signature::Given(factors.into())))).map(|_| ())
    };
    assert!(make(vec![Complex64::I; 128]).is_ok() && make(vec![Complex64::I; 256]).is_ok());
    let reported = |answer: Result<(), Error>| answer.expect_err("a refusal").to_string();
    assert!(
        reported(make(vec![Complex64::I; 384])).starts_with("signature is 384 factors: give one for each of the 128")
    );
    let mut factors = vec![Complex64::I; 256];
    factors[130] = Complex64::new(f64::NAN, 0.0);
    assert!(reported(make(factors)).starts_with("signature[1, 2] is NaN"));
    let signed = Problem::new(&scene(2, &[[0.0; 3]], Signature::Twin)).expect("a problem").propagation().clone();
    assert!(signed.with_mask(&[true; 128]).is_err());
    let real = Propagation::of(&scene(2, &[[0.0; 3]], Signature::Twin));
    assert!((0..128).all(|i| real.exact(0, i).re == real.exact(0, 127 - i).re));
}

/// An observer that always stops the computation.
struct Stop;

impl midair::Observe for Stop {
    fn step(&mut self, _: Progress<'_>) -> ControlFlow<()> {
        ControlFlow::Break(())
    }

    fn pulse(&mut self) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

#[test]
fn a_potential_can_be_stopped() {
    let model = Model::new(&facing(2), Medium::default(), InstructionSet::best()).expect("a model");
    // The computation would take seconds; the stop ends it within a tenth of a second.
    let points = vec![[0.0, 0.0, 0.01]; 200_000];
    let drive = vec![Complex32::ONE; 128];
    let mut stop = Stop;
    let answer = gorkov(&model, &drive, &points, Particle::default(), &mut Control::watched(&mut stop));
    assert_eq!(answer.err(), Some(Error::stopped()));
}

#[test]
fn traps_of_pressure_0_are_stiff_beside_foci_of_their_pressures() {
    let points = vec![[0.0; 3], [0.012, 0.0, 0.003], [-0.011, 0.004, -0.002]];
    let names = [Signature::Trap, Signature::Focus, Signature::Trap];
    let made = |pressures: [f64; 3]| {
        let request = Request { pressures: Some(pressures.to_vec()), ..Request::default() };
        let scene = Scene::new(facing(2), Medium::default(), points.clone(), request);
        scene.and_then(|scene| scene.with_signature(Some(Signature::Each(names.clone().into())))).expect("a scene")
    };
    let softest = |scene: &Scene| {
        let (model, solution) = (Model::of(scene, InstructionSet::best()), solved(scene));
        let traps = [points[0], points[2]];
        let felt = gorkov(&model, &solution.drive, &traps, Particle::default(), &mut Control::none());
        let stiffness = felt.expect("a force").hessian.into_iter().flat_map(|h| [h[0][0], h[1][1], h[2][2]]);
        (stiffness.fold(f64::INFINITY, f64::min), solution)
    };
    let (free, solution) = softest(&made([0.0, 3000.0, 0.0]));
    let (equal, _) = softest(&made([3000.0; 3]));
    assert!(free > 1.5 * equal && equal > 0.0, "{free} {equal}");
    assert!((solution.pressures[1].norm() - 3000.0).abs() < 15.0);
    // The metrics are those of the foci alone.
    let metrics = solution.metrics();
    assert!((metrics.accuracy - 1.0).abs() < 5e-3 && metrics.leak == 0.0);
}

#[test]
fn traps_of_a_lap_become_stiffer_within_the_bound() {
    const FRAMES: usize = 25;
    let (levels, reach) = (64, 4);
    let lap: Vec<[f64; 3]> = (0..2 * FRAMES)
        .map(|k| {
            let angle = std::f64::consts::TAU * (k / 2) as f64 / FRAMES as f64 + if k % 2 == 0 { 0.0 } else { 3.1 };
            [0.004 * angle.cos(), 0.001 * (k % 2) as f64, 0.004 * angle.sin()]
        })
        .collect();
    let whole = scene(2, &lap[..2], Signature::Trap);
    let model = Model::of(&whole, InstructionSet::best());
    let change = std::f64::consts::TAU * f64::from(reach) / f64::from(levels);
    let how = Ahead { change, phases: levels, ends: Ends::Closed, rounds: 5 };
    let codes = ahead(&model, &lap, &[1.0; 2 * FRAMES], FRAMES, &how, None, &mut Control::none()).expect("tracks");
    let mut stiff = codes.clone();
    stiffen(&model, &lap, &how, 100.0, 1, &mut stiff, &mut Control::none()).expect("stiff tracks");
    let turned = |t: usize, i: usize| {
        let steps = i32::from(stiff[(t + 1) % FRAMES * 128 + i]) - i32::from(stiff[t * 128 + i]);
        steps.rem_euclid(64).min((-steps).rem_euclid(64))
    };
    assert!((0..FRAMES).all(|t| (0..128).all(|i| turned(t, i) <= reach)));
    let softest = |codes: &[u16], t: usize| {
        let phase = |&code: &u16| std::f32::consts::TAU * f32::from(code) / 64.0;
        let drive: Vec<_> = codes[t * 128..(t + 1) * 128].iter().map(|code| Complex32::cis(phase(code))).collect();
        let felt = gorkov(&model, &drive, &lap[2 * t..2 * t + 2], Particle::default(), &mut Control::none());
        let stiffness = felt.expect("a force").hessian.into_iter().flat_map(|h| [h[0][0], h[1][1], h[2][2]]);
        stiffness.fold(f64::INFINITY, f64::min)
    };
    let mean = |codes: &[u16]| (0..FRAMES).map(|t| softest(codes, t)).sum::<f64>() / FRAMES as f64;
    assert!(mean(&stiff) > 1.05 * mean(&codes), "{} {}", mean(&stiff), mean(&codes));
    let mut stop = Stop;
    let stopped = stiffen(&model, &lap, &how, 100.0, 1, &mut stiff, &mut Control::watched(&mut stop));
    assert_eq!(stopped.err(), Some(Error::stopped()));
    let short = stiffen(&model, &lap, &how, 100.0, 1, &mut stiff[1..], &mut Control::none());
    assert!(short.expect_err("a refusal").to_string().starts_with("codes is 3199 of them"));
}
