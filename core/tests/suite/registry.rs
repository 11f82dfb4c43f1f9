//! Tests of what the registry states about its solvers: names, options, phases and amplitudes; and that memory of earlier
//! solves has no effect.

use std::f64::consts::TAU;

use midair::solvers::{DEFAULT, SOLVERS, find};
use midair::{
    Aim, Array, Choice, Complex32, Control, Directivity, InstructionSet, Options, Origin, Problem, Transducer, Value,
    Workspace,
};

use crate::scenes::{preset, problem, random_points, scene, widen};

fn drive(solver: &dyn midair::Solve, problem: &Problem, work: &mut Workspace) -> Vec<Complex32> {
    midair::solve(problem, solver, false, work, &mut Control::none()).expect("an answer").drive
}

#[test]
fn every_name_is_listed_once_and_found() {
    for (k, entry) in SOLVERS.iter().enumerate() {
        let name = entry.info.name;
        assert_eq!(find(name).expect("a listed name").info.name, name);
        assert!(SOLVERS[..k].iter().all(|other| other.info.name != name), "{name} twice");
        assert!(!entry.info.summary.is_empty() && !entry.info.source.is_empty(), "{name} has no source");
        assert!(entry.info.tolerance > 0.0 && entry.info.tolerance <= 0.02, "{name}: {}", entry.info.tolerance);
    }
    assert!(find(DEFAULT).is_ok());
    let error = find("no such").map(|entry| entry.info.name).expect_err("unknown").to_string();
    assert!(SOLVERS.iter().all(|entry| error.contains(entry.info.name)) && !error.contains('\n'), "{error}");
}

#[test]
fn every_option_is_documented_and_its_default_is_what_is_used() {
    for entry in SOLVERS {
        let name = entry.info.name;
        let made = entry.configure(&Options::new()).expect("defaults");
        let listed: Options = entry.options().into_iter().map(|o| (o.name.to_owned(), o.default)).collect();
        assert_eq!(made.options, listed, "{name}");
        // Each default may be given explicitly, alone or with the others.
        for (key, value) in &listed {
            let alone = entry.configure(&[(key.clone(), value.clone())].into());
            assert_eq!(alone.map(|made| made.options).ok().as_ref(), Some(&listed), "{name}.{key}");
        }
        for option in entry.options() {
            assert!(option.doc.len() > 3 && !option.doc.contains('\n'), "{name}.{} has no doc", option.name);
        }
    }
}

#[test]
fn what_is_no_option_or_no_value_of_it_is_refused_by_name() {
    for entry in SOLVERS {
        let name = entry.info.name;
        let message = |key: &str, value: Value| {
            let made = entry.configure(&[(key.to_owned(), value)].into());
            let text = made.map(|made| made.info.name).expect_err(key).to_string();
            assert!(!text.contains('\n'), "{text:?}");
            text
        };
        let unknown = message("no_such_option", Value::Bool(true));
        assert!(unknown.contains("no_such_option") && unknown.contains(name), "{unknown}");
        for option in entry.options() {
            assert!(unknown.contains(option.name), "{name} does not list {}: {unknown}", option.name);
            // No type of option accepts a negative number, an unknown word or NaN.
            let wrong =
                [Value::Integer(-1), Value::Real(-1.0), Value::Real(f64::NAN), Value::Text("no such word".into())];
            for value in wrong {
                let text = message(option.name, value.clone());
                assert!(text.starts_with(&format!("{} is", option.name)), "{name}: {text}");
            }
        }
    }
}

/// Returns a name in another spelling that must be accepted.
fn loosely(name: &str) -> String {
    let mut typed = name.to_uppercase().replace('_', "-");
    typed.insert(1, '_');
    typed
}

#[test]
fn names_ignore_case_hyphens_and_underscores() {
    for entry in SOLVERS {
        let name = entry.info.name;
        assert_eq!(find(&loosely(name)).expect("the same name").info.name, name);
        for option in entry.options() {
            // The words of an option may be in another spelling, too.
            let value = match &option.default {
                Value::Text(word) => Value::Text(loosely(word)),
                other => other.clone(),
            };
            let given: Options = [(loosely(option.name), value)].into();
            let made = entry.configure(&given).expect(option.name);
            assert_eq!(made.options, entry.configure(&Options::new()).expect("defaults").options, "{name}");
            assert_eq!(entry.spelled(&given).expect("a name").keys().collect::<Vec<_>>(), [option.name]);
            let twice = [(option.name.to_owned(), option.default.clone()), (loosely(option.name), option.default)];
            let error = entry.configure(&twice.into()).map(|made| made.info.name).expect_err("twice").to_string();
            assert!(error.starts_with(&format!("{} is given twice", option.name)), "{error}");
        }
    }
    for known in midair::presets::PRESETS {
        let array = Array::preset(&loosely(known.name), [1, 1]).expect("the same name");
        assert!(matches!(array.origin(), Origin::Preset { name, .. } if *name == known.name));
    }
    for (known, _) in Directivity::all().map(|directivity| directivity.name()) {
        assert_eq!(Directivity::named(&loosely(known), None).expect("the same name").name().0, known);
    }
    let choice = Choice::new("uniform".into(), [("A-IM".into(), Value::Text("MAX".into()))].into());
    assert_eq!(choice.expect("an aim").aim, Some(Aim::Max));
    assert!(InstructionSet::named("Scalar").is_some());
}

#[test]
fn a_near_miss_is_reported_what_was_meant_and_an_option_of_others_who_has_it() {
    let unknown = |name: &str| find(name).map(|entry| entry.info.name).expect_err(name).to_string();
    for (typed, meant) in [("gredy", "greedy"), ("unifrom", "uniform"), ("gs-pta", "gspat"), ("tikh", "tikhonov")] {
        let text = unknown(typed);
        assert!(text.contains(&format!("\"{typed}\": did you mean {meant}? known are uniform, best")), "{text}");
    }
    assert!(unknown("annealing").starts_with("unknown solver \"annealing\": known are"), "{}", unknown("annealing"));
    for entry in SOLVERS {
        let own = entry.options();
        for option in SOLVERS.iter().flat_map(midair::solvers::Entry::options) {
            if own.iter().any(|known| known.name == option.name) {
                continue;
            }
            let made = entry.configure(&[(option.name.to_owned(), option.default)].into());
            let text = made.map(|made| made.info.name).expect_err(option.name).to_string();
            let owners = SOLVERS.iter().filter(|entry| entry.options().iter().any(|known| known.name == option.name));
            for owner in owners {
                let (hint, _) = text.split_once(" it; ").expect("who has it");
                assert!(hint.contains(owner.info.name), "{text}");
            }
        }
    }
    let text = Array::preset("autd4", [1, 1]).expect_err("unknown").to_string();
    assert_eq!(
        text,
        "unknown preset \"autd4\": did you mean autd3? known are paper20, paper36, autd3, sonicsurface, sonicsurface_pair, openmpd_board, openmpd_pair, tinylev, biglev, ultraino_flat8x8, spherical_cap64, dragonfly, stratos"
    );
}

#[test]
fn phases_and_amplitudes_lie_on_the_grid_requested() {
    let problem = problem(&scene(preset("autd3").with_quantization(None), random_points(6, 0.08, 1), None));
    let mut checked = 0;
    for entry in SOLVERS {
        let options = entry.options();
        let has = |name: &str| options.iter().any(|option| option.name == name);
        if !has("phases") {
            continue;
        }
        for (phases, amplitudes) in [(2_i32, 1_i32), (3, 1), (16, 1), (10, 4), (256, 16)] {
            let mut chosen: Options = [("phases".to_owned(), Value::Integer(phases.into()))].into();
            let levels = if has("amplitudes") { amplitudes } else { 1 };
            if has("amplitudes") {
                chosen.insert("amplitudes".into(), Value::Integer(amplitudes.into()));
            }
            let made = entry.configure(&chosen).expect("options");
            for q in widen(&drive(&*made.solver, &problem, &mut Workspace::new())) {
                let turns = q.arg() / TAU * f64::from(phases);
                let steps = q.norm() * f64::from(levels);
                // The tolerance is one rounding to f32. An amplitude of 0 is not among (k+1)/K.
                let near = |x: f64| (x - x.round()).abs() < 1e-6 * f64::from(phases.max(levels));
                assert!(near(turns) && near(steps) && steps > 0.5, "{}: {q}", entry.info.name);
            }
            checked += 1;
        }
    }
    assert!(checked > 0, "no solver has a grid: this test tests nothing");
}

#[test]
fn a_seed_is_another_answer_and_an_index_of_nothing_else() {
    let array = preset("autd3").with_transducer(Transducer::default()).expect("point sources");
    let problem = problem(&scene(array, random_points(6, 0.08, 2), None));
    for entry in SOLVERS {
        let options = entry.options();
        let has = |name: &str| options.iter().any(|option| option.name == name);
        if !has("seed") {
            continue;
        }
        let with = |seed: u64| {
            let mut chosen: Options = [("seed".to_owned(), Value::Integer(seed.into()))].into();
            if has("starts") {
                // With few starts, the best may be one of the first two, which do not depend on the seed.
                chosen.insert("starts".into(), Value::Integer(16));
            }
            let made = entry.configure(&chosen).expect("a seed");
            drive(&*made.solver, &problem, &mut Workspace::new())
        };
        let answers = [1, 2, u64::MAX].map(with);
        assert!(answers[0] != answers[1] && answers[1] != answers[2], "{} ignores its seed", entry.info.name);
    }
}

#[test]
fn what_a_workspace_was_used_for_before_changes_no_bit() {
    let wide = scene(preset("autd3"), random_points(40, 0.08, 3), None);
    let narrow = scene(Array::grid(5, 4, 1e-2).expect("a grid"), random_points(3, 0.03, 4), None);
    for entry in SOLVERS {
        let solver = entry.configure(&Options::new()).expect("defaults").solver;
        let fresh = |problem: &Problem| drive(&*solver, problem, &mut Workspace::new());
        let mut work = Workspace::new();
        for scene in [&wide, &narrow, &wide, &narrow] {
            let problem = problem(scene);
            let mut control = Control::none();
            let solution = midair::solve(&problem, &*solver, false, &mut work, &mut control).expect("an answer");
            assert_eq!(solution.drive, fresh(&problem), "{}", entry.info.name);
            solution.recycle(&work);
        }
    }
}
