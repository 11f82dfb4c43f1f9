//! Tests of the upper bound on the level, and of requests beyond reach.

use midair::solvers::SOLVERS;
use midair::{Beyond, Control, Medium, Options, Problem, Request, Scene, Workspace, bound};

use crate::oracle;
use crate::scenes::{preset, problem, propagation, random_points, scene, widen};

/// The smallest |p_j| / target_j of each solver's drive, in double precision.
fn levels(scene: &Scene, problem: &Problem) -> Vec<(&'static str, f64)> {
    let level = |entry: &midair::solvers::Entry| {
        let solver = entry.configure(&Options::new()).expect("defaults").solver;
        let solution =
            midair::solve(problem, &*solver, false, &mut Workspace::new(), &mut Control::none()).expect("an answer");
        let field = oracle::field(&propagation(scene), &widen(&solution.drive));
        let parts = field.iter().zip(problem.targets_in_pascals()).map(|(p, target)| p.norm() / target);
        (entry.info.name, parts.fold(f64::INFINITY, f64::min))
    };
    SOLVERS.iter().map(level).collect()
}

#[test]
#[ignore = "slow"]
fn no_solver_exceeds_the_bound_and_the_best_comes_near() {
    stay_below_the_bound(0);
}

#[test]
#[ignore = "slow"]
fn no_solver_exceeds_the_bound_in_more_scenes_at_length() {
    (1..4).for_each(stay_below_the_bound);
}

fn stay_below_the_bound(seed: u64) {
    for (count, near) in [(1, 1.0001), (2, 1.0002), (4, 1.12), (16, 1.12), (64, 1.20)] {
        let scene = scene(preset("paper20"), random_points(count, 0.1, 200 + seed), None);
        let problem = problem(&scene);
        let most = bound(&problem, &mut Control::none()).expect("a bound");
        let mut best = 0.0_f64;
        for (name, level) in levels(&scene, &problem) {
            // The tolerance is for |q| = 1 after rounding to f32.
            assert!(level <= most * (1.0 + 1e-6), "M = {count}: {name} reaches {level}, the bound is {most}");
            best = best.max(level);
        }
        // The bound of the relaxation is 6 to 10 % above the optimum, and `wgs` does not find the best field (at 64 points
        // it is uneven by 0.013).
        assert!(most < near * best, "M = {count}: the bound is {most}, the best level {best}");
    }
}

#[test]
fn one_point_is_bounded_by_its_reach_and_two_coincident_points_by_theirs() {
    let at = [0.03, -0.02, 0.15];
    let requested = |points: Vec<[f64; 3]>, pressures: Vec<f64>| {
        let scene = scene(preset("paper20"), points, Some(pressures));
        (
            bound(&problem(&scene), &mut Control::none()).expect("a bound"),
            problem(&scene).reach(&mut Control::none()).expect("it is not stopped").alone[0],
        )
    };
    let (most, alone) = requested(vec![at], vec![0.5]);
    assert!((most * 0.5 / alone - 1.0).abs() < 1e-6, "{most} for {alone}");
    let (most, _) = requested(vec![at, at], vec![0.5, 0.25]);
    assert!((most * 0.5 / alone - 1.0).abs() < 1e-3, "{most} for {alone}");
}

#[test]
fn quiet_and_weightless_points_do_not_bind_and_units_cancel() {
    let points = random_points(5, 0.08, 31);
    let with = |pressures: Vec<f64>, weights: Option<Vec<f64>>| {
        let request = Request { pressures: Some(pressures), weights, ..Request::default() };
        let scene = Scene::new(preset("paper20"), Medium::default(), points.clone(), request).expect("a scene");
        bound(&problem(&scene), &mut Control::none()).expect("a bound")
    };
    let three = with(vec![0.5, 1.0, 0.7, 0.0, 0.9], Some(vec![1.0, 1.0, 2.0, 1.0, 0.0]));
    let same = with(vec![0.5, 1.0, 0.7, 0.0, 0.0], None);
    assert!((three / same - 1.0).abs() < 1e-9, "{three} {same}");
    let double = with(vec![1.0, 2.0, 1.4, 0.0, 0.0], None);
    assert!((2.0 * double / same - 1.0).abs() < 1e-9, "{double} {same}");
}

#[test]
fn reach_is_the_sum_of_the_moduli_and_the_balanced_level() {
    let mask: Vec<bool> = (0..400).map(|i| i % 4 != 0).collect();
    let array = preset("paper20").with_mask(Some(mask)).expect("a mask");
    let request =
        Request { pressures: Some(vec![0.2, 0.1, 0.0]), weights: Some(vec![1.0, 2.0, 1.0]), ..Request::default() };
    let scene = Scene::new(array, Medium::default(), random_points(3, 0.08, 33), request).expect("a scene");
    let reach = problem(&scene).reach(&mut Control::none()).expect("it is not stopped");
    for (j, alone) in reach.alone.iter().enumerate() {
        let sum: f64 = propagation(&scene).iter().map(|row| row[j].norm()).sum();
        assert!((alone / sum - 1.0).abs() < 1e-12, "{alone} for {sum}");
    }
    let load: f64 = reach.level.iter().zip(&reach.alone).map(|(level, alone)| (level / alone).powi(2)).sum();
    // The balanced level is computed from rows in f32.
    assert!((load - 1.0).abs() < 1e-4 && reach.level[2] == 0.0, "{load}");
    assert!((reach.level[0] / reach.level[1] - 2.0).abs() < 1e-12);
}

#[test]
fn only_what_provably_cannot_be_had_is_beyond_reach() {
    let beyond = |points: &[[f64; 3]], pressures: Vec<f64>| {
        problem(&scene(preset("paper20"), points.to_vec(), Some(pressures)))
            .beyond(&mut Control::none())
            .expect("it is not stopped")
    };
    let p1 = 2.36066;
    for (count, factor, expected) in
        [(2, 1.0, false), (16, 1.0, false), (64, 1.0, false), (4, 1.6, true), (64, 2.6, true)]
    {
        for seed in 0..10 {
            let points = random_points(count, 0.1, 300 + seed);
            let found = beyond(&points, vec![factor * p1 / (count as f64).sqrt(); count]);
            // The targets of Suzuki et al. 2021 exceed the reach by up to 13 % for few points; they are not reported as
            // mistakes.
            assert_eq!(found.is_some(), expected, "M = {count}, seed {seed}: {found:?}");
        }
    }
    // The error names a point whose target exceeds the pressure of all transducers there.
    let points = random_points(3, 0.05, 34);
    let Some(Beyond::Alone { point, target, alone }) = beyond(&points, vec![0.1, 5.0, 6.0]) else {
        panic!("5 Pa is twice what the array can do")
    };
    assert!(point == 1 && target == 5.0 && alone < 2.4, "{point} {target} {alone}");
    let text = Beyond::Alone { point, target, alone }.to_string();
    assert!(text.starts_with("points[1].pressure is 5.000 Pa, beyond reach: ") && !text.contains('\n'), "{text}");
    // Points at one place can all have nearly the pressure that one of them alone can have. This is far above the balanced
    // level, and no mistake.
    assert_eq!(beyond(&[points[0], points[0], points[0]], vec![1.7; 3]), None);
    // Without pressures, the targets are the highest level of the array.
    assert_eq!(
        problem(&scene(preset("paper20"), random_points(64, 0.1, 35), None))
            .beyond(&mut Control::none())
            .expect("it is not stopped"),
        None
    );
}
