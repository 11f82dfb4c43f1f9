//! Tests that a scene made from another one, and the scene of a solution, keep every part.

use std::sync::Arc;

use midair::solvers::{DEFAULT, Glide, Remark, Uniform, remarks};
use midair::{
    Array, Bead, Beyond, Choice, Complex32, Control, Extras, InstructionSet, Model, Obstacle, Options, Particle, Plane,
    Problem, Quantization, Request, Scene, Session, Signature, Solve, SolveRequest, Start, Surface, Workspace,
};

use crate::scenes::preset;

/// Returns parts of which none is the default.
fn extras(signature: Option<Signature>) -> Extras {
    let particle = Particle { radius: 1.2e-3, density: 900.0, ..Particle::default() };
    let wall = Obstacle::Wall { point: [0.0, 0.0, 0.3], normal: [0.0, 0.0, -1.0], kind: Surface::Rigid };
    Extras {
        signature,
        bead: Bead { particle, ..Bead::default() },
        obstacles: vec![wall],
        solver: Some(Choice::new(DEFAULT.into(), Options::new()).expect("a choice")),
        plane: Some(Plane::around(&[[0.0, 0.0, 0.1]], 8.5e-3)[0]),
    }
}

fn scene(points: Vec<[f64; 3]>, extras: Extras) -> Scene {
    let scene = Scene::new(preset("autd3"), None, points, Request::default());
    scene.and_then(|scene| scene.with_extras(extras)).expect("a scene")
}

fn session(scene: &Scene, solver: impl Solve + Send + Sync + 'static) -> Session {
    let solver: Arc<dyn Solve + Send + Sync> = Arc::new(solver);
    Session::new(Model::of(scene, InstructionSet::best()), solver, true)
}

#[test]
fn a_scene_with_other_points_keeps_every_part() {
    let extras = extras(Some(Signature::Trap));
    let moved = scene(vec![[0.0, 0.0, 0.15]], extras.clone());
    assert_eq!(moved.extras(), extras);
    let there = vec![[0.0, 0.0, 0.15], [0.02, 0.0, 0.15]];
    let moved = moved.with_points(there.clone(), Request::default()).expect("other points");
    assert_eq!(moved, scene(there, extras));
}

#[test]
fn other_points_must_fit_what_stays() {
    let each = Signature::Each([Signature::Trap].into());
    let placed = scene(vec![[0.0, 0.0, 0.15]], extras(Some(each)));
    let two = placed.clone().with_points(vec![[0.0, 0.0, 0.15], [0.02, 0.0, 0.15]], Request::default());
    assert!(two.unwrap_err().to_string().starts_with("signature"));
    let behind = placed.clone().with_points(vec![[0.0, 0.0, 0.4]], Request::default());
    assert!(behind.unwrap_err().to_string().contains("behind the wall obstacles[0]"));
    let nowhere = placed.with_points(vec![[f64::NAN, 0.0, 0.15]], Request::default());
    assert!(nowhere.unwrap_err().to_string().starts_with("points[0].position"));
}

#[test]
fn the_scene_of_a_solution_has_the_bead_of_plain_foci() {
    let bare = Extras { obstacles: Vec::new(), solver: None, plane: None, ..extras(None) };
    for extras in [bare.clone(), Extras { signature: Some(Signature::Twin), ..bare }, extras(None)] {
        let own = scene(vec![[0.0, 0.0, 0.15]], Extras { solver: None, plane: None, ..extras });
        let mut session = session(&own, Uniform::default());
        let solution = session.solve(&SolveRequest::of_scene(&own), &mut Control::none()).expect("a solution");
        assert_eq!(solution.scene(), Some(own));
    }
}

/// The warnings of a lone solve are those of a session: in particular that of a bound below a step of the board's phases.
#[test]
fn a_solve_and_a_session_warn_of_the_same() {
    let board = |phases: u32| preset("autd3").with_quantization(Quantization::new(Some(phases), None).ok());
    let told = |array: Array, start: Option<Start>, pressures: Option<Vec<f64>>| {
        let glide = Glide { change: 0.05, ..Glide::default() };
        let request = Request { pressures, ..Request::default() };
        let own = Scene::new(array, None, vec![[0.0, 0.0, 0.15]], request).expect("a scene");
        let mut problem = Problem::new(&own).expect("a problem");
        if let Some(start) = start.clone() {
            problem = problem.with_start(start).expect("a start");
        }
        let solution = midair::solve(&problem, &glide, true, &mut Workspace::new(), &mut Control::none());
        let beyond = problem.beyond(&mut Control::none()).expect("it is not stopped");
        let alone = remarks(&problem, &glide, true, None, &solution.expect("a solution"), beyond);
        let mut session = session(&own, glide);
        let ask = SolveRequest { start, ..SolveRequest::of_scene(&own) };
        session.solve(&ask, &mut Control::none()).expect("a solution");
        let followed: Vec<String> = session.remarks().map(|remark| remark.to_string()).collect();
        (alone.iter().flatten().map(ToString::to_string).collect::<Vec<_>>(), followed)
    };
    let start = || Some(Start::Drive(vec![Complex32::ONE; 249]));
    let (alone, followed) = told(board(32), start(), Some(vec![1e5]));
    assert_eq!(alone, followed);
    assert!(alone[0].contains("beyond reach") && alone.iter().any(|text| text.contains("the drive stands still")));
    assert!(told(board(256), start(), None).0.is_empty());
    // Without a start, the phases of a lone solve are free. The next frame of a session is not.
    let (alone, followed) = told(board(32), None, None);
    assert!(alone.is_empty() && followed.len() == 1, "{alone:?}, {followed:?}");
}

#[test]
fn each_warning_about_a_solution_has_its_code() {
    for (remark, code) in [
        (Remark::Beyond(Beyond::Alone { point: 0, target: 2.0, alone: 1.0 }), "beyond-reach"),
        (Remark::Beyond(Beyond::Together { most: 0.5 }), "beyond-together"),
        (Remark::Missed(0.1), "missed"),
        (Remark::Weak(0.1), "weak"),
        (Remark::PhasesUnused, "phases-unused"),
        (Remark::Leak { leak: 0.1, quiet: 0.01, able: 9 }, "leak"),
        (Remark::Harmonic { share: 0.3, pressure: 7e3 }, "harmonic"),
        (Remark::Scaled(0.5), "scaled"),
        (Remark::Fallen { kept: 0, traps: 4 }, "fallen"),
        (Remark::Still { change: 0.1, phases: 10 }, "still"),
    ] {
        assert_eq!(remark.notice().code.name(), code, "{remark}");
    }
}
