//! Tests of channels: transducers that are wired together. Every method is compared with sums of columns in double precision.

use midair::sequence::{Ahead, Ends, ahead};
use midair::solvers::SOLVERS;
use midair::{
    Array, Board, Complex32, Complex64, Control, Frames, InstructionSet, Medium, Model, Precision, Problem,
    Propagation, Request, Scene, Session, Setup, Signature, Solution, SolveRequest, Start, Workspace, bound,
};

const POINTS: [[f64; 3]; 2] = [[-0.02, 0.004, 0.11], [0.021, -0.003, 0.12]];

/// Returns 8 x 8 transducers with neighbours wired together in pairs. Their responses are different, and one is 0.
fn array() -> Array {
    let response = (0..64)
        .map(|i| Complex64::from_polar(if i == 9 { 0.0 } else { 0.8 + 0.003 * f64::from(i) }, 0.1 * f64::from(i % 7)));
    let array = Array::grid(8, 8, 10.5e-3).and_then(|array| array.with_response(Some(response.collect())));
    array.and_then(|array| array.with_channels(Some((0..64).map(|i| (i / 2 * 5) % 32).collect()))).expect("an array")
}

fn scene(signature: Option<Signature>) -> Scene {
    let scene = Scene::new(array(), Medium::default(), POINTS.to_vec(), Request::default());
    scene.and_then(|scene| scene.with_signature(signature)).expect("a scene")
}

/// The entries (j, c) of the propagation matrix G in double precision, each summed over the transducers of channel c.
fn summed(scene: &Scene) -> Vec<Complex64> {
    let propagation = Model::of(scene, InstructionSet::best()).propagation(scene.points()).expect("a matrix");
    let channels = scene.array().channels().expect("channels").to_vec();
    let mut sums = vec![Complex64::ZERO; scene.points().len() * 32];
    for (i, channel) in channels.into_iter().enumerate() {
        (0..scene.points().len()).for_each(|j| sums[j * 32 + channel] += propagation.exact(j, i));
    }
    sums
}

fn solved(problem: &Problem, name: &str) -> Solution {
    let solver = midair::solvers::find(name).and_then(|entry| entry.configure(&[].into())).expect("a solver");
    midair::solve(problem, &*solver.solver, true, &mut Workspace::new(), &mut Control::none()).expect(name)
}

/// The drive of each channel; checks that all transducers of a channel have the same drive.
fn of_channels(array: &Array, drive: &[Complex32]) -> Vec<Complex32> {
    let channels = array.channels().expect("channels");
    let mut own = vec![None; 32];
    for (&channel, &q) in channels.iter().zip(drive) {
        assert_eq!(*own[channel].get_or_insert(q), q);
    }
    own.into_iter().flatten().collect()
}

#[test]
fn every_method_solves_with_summed_columns() {
    for signature in [None, Some(Signature::Twin)] {
        let scene = scene(signature);
        let (problem, sums) = (Problem::new(&scene).expect("a problem"), summed(&scene));
        let given = Propagation::from_matrix(&sums, 2).expect("a matrix");
        let matrix = Problem::with_propagation(given, Setup::default(), &Request::default()).expect("a problem");
        for j in 0..2 {
            let alone: f64 = sums[32 * j..32 * (j + 1)].iter().map(|g| g.norm()).sum();
            let reach = problem.reach(&mut Control::none()).expect("a reach").alone[j];
            assert!((reach / alone - 1.0).abs() < 1e-12);
        }
        let bounds = [&problem, &matrix].map(|problem| bound(problem, &mut Control::none()).expect("a bound"));
        assert!((bounds[0] / bounds[1] - 1.0).abs() < 1e-3, "{bounds:?}");
        for entry in SOLVERS {
            let name = entry.info.name;
            let solution = solved(&problem, name);
            assert_eq!(solution.drive.len(), 64);
            let own = of_channels(scene.array(), &solution.drive);
            for j in 0..2 {
                let wide = |q: &Complex32| Complex64::new(f64::from(q.re), f64::from(q.im));
                let p: Complex64 = sums[32 * j..].iter().zip(&own).map(|(g, q)| g * wide(q)).sum();
                let reported = wide(&solution.pressures[j]);
                assert!(
                    (p - reported).norm() < 1e-5 * sums[32 * j..32 * (j + 1)].iter().map(|g| g.norm()).sum::<f64>()
                );
            }
            let same = solved(&matrix, name).metrics().accuracy;
            let found = solution.metrics().accuracy;
            assert!((found - same).abs() < 0.03 * same, "{name}: {found} is {same} by the matrix");
            let judged =
                problem.judge(&solution.drive, Precision::Double, &mut Control::none()).expect("a judgement").accuracy;
            assert!((judged - found).abs() < 1e-4 * found, "{name}");
        }
    }
}

#[test]
fn sessions_batches_and_starts_are_those_of_a_single_solve() {
    let (scene, control) = (scene(None), &mut Control::none());
    let model = Model::of(&scene, InstructionSet::best());
    for name in ["fast", "uniform", "greedy"] {
        let alone = solved(&Problem::new(&scene).expect("a problem"), name);
        let solver =
            midair::solvers::find(name).and_then(|entry| entry.configure(&[].into())).expect("a solver").solver;
        let mut session = Session::new(model.clone(), solver, true);
        assert_eq!(session.solve(&SolveRequest::of_scene(&scene), control).expect(name).drive, alone.drive);
        assert_eq!(session.transducers(), 64);
        let mut drives = vec![Complex32::ZERO; 20 * 64];
        let ask = |_, ask: &mut SolveRequest| {
            ask.points = POINTS.to_vec();
            Ok(())
        };
        session.solve_batch(20, 2, &ask, &mut drives, control).expect(name);
        assert!(drives.chunks(64).all(|row| row == alone.drive), "{name}");
        let problem = Problem::new(&scene).and_then(|problem| problem.with_start(Start::Drive(alone.drive.clone())));
        assert_eq!(problem.expect("a start").start_drive().expect("a start"), of_channels(scene.array(), &alone.drive));
    }
}

#[test]
fn moving_points_keep_their_bounds_and_their_channels() {
    let (array, frames) = (array(), 12);
    let points: Vec<_> = (0..frames).map(|t| [5e-4 * f64::from(t) - 3e-3, 0.0, 0.12]).collect();
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("a model");
    let solver = midair::solvers::find("glide").and_then(|entry| entry.configure(&[].into())).expect("glide").solver;
    let mut drives = vec![Complex32::ZERO; points.len() * 64];
    let moved = Frames { points: &points, count: 1, ..Frames::default() };
    let mut session = Session::new(model.clone(), solver, true);
    session.follow(moved, &mut SolveRequest::default(), &mut drives, &mut Control::none()).expect("drives");
    drives.chunks(64).for_each(|row| assert_eq!(of_channels(&array, row).len(), 32));
    let how = Ahead { change: 0.4, phases: 64, ends: Ends::Open, rounds: 3 };
    let run = |start: Option<&[u16]>| {
        ahead(&model, &points, &[1.0; 12], 12, &how, start, &mut Control::none()).expect("codes")
    };
    let codes = run(None);
    for row in [&codes[..], &run(Some(&codes))].into_iter().flat_map(|codes| codes.chunks(64)) {
        let drives: Vec<_> = row.iter().map(|&code| Complex32::new(f32::from(code), 0.0)).collect();
        assert_eq!(of_channels(&array, &drives).len(), 32);
    }
    let sums = summed(&Scene::new(array, Medium::default(), points, Request::default()).expect("a scene"));
    for (t, row) in codes.chunks(64).enumerate() {
        let q = |i: usize| Complex64::from_polar(1.0, core::f64::consts::TAU * f64::from(row[i]) / 64.0);
        let first = |channel| (0..64).find(|&i| (i / 2 * 5) % 32 == channel).expect("a transducer");
        let own = &sums[32 * t..32 * (t + 1)];
        let p: Complex64 = own.iter().enumerate().map(|(channel, g)| g * q(first(channel))).sum();
        assert!(p.norm() > 0.95 * own.iter().map(|g| g.norm()).sum::<f64>());
    }
}

#[test]
fn a_tinylev_has_two_channels_that_a_nano_plays() {
    let array = Array::preset("tinylev", [1, 1]).expect("a preset");
    assert_eq!(array.channels().expect("channels"), [[0; 36], [1; 36]].concat());
    let scene = Scene::new(array.clone(), None, vec![[0.0; 3]], Request::default()).expect("a scene");
    let scene = scene.with_signature(Some(Signature::Trap)).expect("a trap");
    let solution = solved(&Problem::new(&scene).expect("a problem"), "uniform");
    // The trap's node lies slightly above the point, because the weight pulls the bead down; so the foci lose a little of their
    // level.
    assert!(solution.metrics().accuracy > 1.0 - 1e-4);
    for kind in ["nano", "nano16", "mega64"] {
        let (wired, plain) = (array.board(kind).expect(kind), Board::new(kind, 2).expect(kind));
        let mut frames = [vec![0; wired.frame_size()], vec![0; plain.frame_size()]];
        wired.encode(&solution.drive, &mut frames[0]).expect(kind);
        plain.encode(&[solution.drive[0], solution.drive[36]], &mut frames[1]).expect(kind);
        assert_eq!(frames[0], frames[1]);
        let mut back = vec![Complex32::ZERO; 72];
        wired.decode(&frames[0], &mut back).expect(kind);
        assert!(back[..36].iter().all(|q| *q == back[0]) && back[36..].iter().all(|q| *q == back[36]));
        // The trap has a node in the middle, so the two caps differ by half a turn. With the unequal ticks of a MEGA64 the
        // difference is only approximate.
        let grid = wired.quantization().expect(kind);
        // The bytes of a MEGA64 correct the delays of its ports, which the array lacks, to half a step of ten.
        let near = |i: usize| {
            let (back, wanted) = (back[i], grid.nearest(solution.drive[i]));
            let half = std::f32::consts::PI / 10.0 + 1e-4;
            if kind == "mega64" { (back / wanted).arg().abs() < half } else { (back - wanted).norm() < 1e-6 }
        };
        assert!(near(0) && near(36), "{kind}");
        let apart = (back[0] + back[36]).norm();
        assert!(apart < if kind == "mega64" { 0.2 } else { 1e-6 }, "{kind}: {apart}");
    }
    let masked = array.with_mask(Some((0..72).map(|i| i >= 36).collect())).and_then(|array| array.board("nano"));
    let (board, mut frame, mut back) = (masked.expect("a board"), vec![0; 49], vec![Complex32::ZERO; 72]);
    board.encode(&[Complex32::ONE; 72], &mut frame).expect("a frame");
    board.decode(&frame, &mut back).expect("drives");
    assert!(back[..36].iter().all(|q| *q == Complex32::ZERO) && back[36..].iter().all(|q| q.norm() > 0.5));
}

#[test]
fn what_cannot_be_wired_is_refused_in_one_line() {
    let reported = |channels: &[usize]| {
        let array = Array::grid(2, 2, 10e-3).expect("an array").with_channels(Some(channels.to_vec()));
        array.map_or_else(|error| error.to_string(), |array| format!("{:?}", array.channels()))
    };
    assert_eq!(reported(&[0, 1, 2, 3]), "None");
    assert_eq!(reported(&[0, 1]), "array.channels is 2 values: give one for each of the 4 transducers");
    assert_eq!(
        reported(&[0, 0, 2, 2]),
        "array.channels is up to 2: number them 0 to C - 1: no transducer is on channel 1"
    );
    assert_eq!(
        reported(&[0, 0, 0, 4]),
        "array.channels[3] is 4: give 0 to 3: there are no more channels than transducers"
    );
    let rows = Array::grid(16, 16, 10.5e-3).expect("an array").with_channels(Some((0..256).map(|i| i / 16).collect()));
    let rows = rows.expect("rows");
    assert_eq!(rows.board("nano16").expect("as many channels as rows").channels().len(), 16);
    let refused = |array: &Array| array.board("nano").err().expect("refused").to_string();
    assert_eq!(refused(&rows), "array.channels is 16 of them: nano has 8: wire more transducers together");
    let board = rows.board("nano16").expect("a board");
    let mut drive = vec![Complex32::ONE; 256];
    drive[17] = Complex32::I;
    let reported = board.encode(&drive, &mut [0; 65]).expect_err("two drives").to_string();
    assert_eq!(reported, "drive[17] is 0+1i: drive[16] on the same channel 1 is 1+0i: give both one");
}
