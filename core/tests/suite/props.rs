//! Property tests: statements that hold for any input, tested with random inputs.

use midair::solvers::{Greedy, Objective, SOLVERS};
use midair::{
    Array, Complex64, Control, Directivity, Medium, Precision, Problem, Request, Rng, Scene, Solve, Transducer,
    Workspace,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::oracle::{self, Search};
use crate::scenes::{propagation, widen};

/// The same random cases in every run, so that a failure can be repeated.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() }
}

fn place(half: f64, low: f64, high: f64) -> impl Strategy<Value = [f64; 3]> {
    (-half..half, -half..half, low..high).prop_map(|(x, y, z)| [x, y, z])
}

prop_compose! {
    fn arrays()(
        places in prop::collection::vec((place(0.05, -0.01, 0.01), place(1.0, 0.1, 1.0)), 1..13),
        kind in 0..4_usize,
        response in prop::option::of((0.0..2.0, -3.0..3.0)),
    ) -> Array {
        let (positions, normals): (Vec<_>, Vec<_>) = places.into_iter().unzip();
        let count = positions.len();
        let directivity =
            [Directivity::POINT, Directivity::T4010A1, Directivity::piston(5e-3), Directivity::cos(2.0)][kind];
        let array = Array::new(positions, Some(normals)).expect("an array");
        let array = array.with_transducer(Transducer { directivity, ..Transducer::default() }).expect("a transducer");
        let response = response.map(|(r, phi)| (0..count).map(|i| Complex64::from_polar(r * i as f64, phi)).collect());
        array.with_response(response).expect("responses")
    }
}

prop_compose! {
    fn requests()(
        points in prop::collection::vec((place(0.05, -0.05, 0.2), 0.0..400.0, 0..3_u8), 1..7),
        given in any::<bool>(),
        weighted in any::<bool>(),
        array in arrays(),
        absorption in 0.0..1.0,
    ) -> Option<Scene> {
        // About every sixth pressure is 0, a quiet point.
        let pressures = points.iter().map(|(_, pressure, _)| if *pressure < 60.0 { 0.0 } else { *pressure }).collect();
        let weights = points.iter().map(|(.., weight)| f64::from(*weight)).collect();
        let request = Request { pressures: given.then_some(pressures), weights: weighted.then_some(weights), ..Request::default() };
        let medium = Medium { absorption, ..Medium::default() };
        Scene::new(array, medium, points.into_iter().map(|(place, ..)| place).collect(), request).ok()
    }
}

proptest! {
    #![proptest_config(config(300))]

    #[test]
    fn any_scene_is_refused_or_answered_with_finite_numbers(scene in requests(), balance in any::<bool>()) {
        let Some(problem) = scene.as_ref().and_then(|scene| Problem::new(scene).ok()) else { return Ok(()) };
        for entry in SOLVERS {
            let solver = entry.configure(&midair::Options::new()).expect("defaults").solver;
            let mut work = Workspace::new();
            let solution = midair::solve(&problem, &*solver, balance, &mut work, &mut Control::none()).expect("an answer");
            prop_assert!(solution.drive.iter().all(|q| q.norm() <= 1.0 + 1e-6), "{}", entry.info.name);
            prop_assert!(solution.pressures.iter().all(|p| p.norm().is_finite()), "{}", entry.info.name);
            let metrics = solution.metrics();
            prop_assert!(metrics.residual.is_finite() && metrics.sigma.is_finite(), "{metrics:?}");
            let judged = problem.judge(&solution.drive, Precision::Double, &mut Control::none()).expect("its own drive");
            // Pressures in f32 are compared with those in f64: the tolerance is 1e-4 of the pressure of a dozen transducers,
            // relative to the targets.
            let unit = problem.balance().max(1.0);
            prop_assert!((judged.level - metrics.level).abs() < 1e-3 * unit * judged.level.max(1.0), "{judged:?} {metrics:?}");
        }
    }

    #[test]
    fn greedy_never_regrets_a_choice(
        scene in requests(), phases in 2..40_u32, amplitudes in 1..4_u32, l1 in any::<bool>(), seed in any::<u64>(),
    ) {
        let Some(scene) = scene else { return Ok(()) };
        let Ok(problem) = Problem::new(&scene) else { return Ok(()) };
        // If one transducer far exceeds a target, or a directivity is nearly 0, E(0) is too small a reference for G in f32:
        // 1e-6 of it is less than the rounding.
        let strong = propagation(&scene).iter().flatten().map(|g| g.norm()).fold(0.0, f64::max);
        let faint = propagation(&scene).iter().flatten().any(|g| g.norm() > 0.0 && g.norm() < 0.01 * strong);
        let least = problem.targets_in_pascals().iter().copied().filter(|&target| target > 0.0).fold(f64::MAX, f64::min);
        if faint || least < 0.5 * strong {
            return Ok(());
        }
        let objective = if l1 { Objective::L1 } else { Objective::L2 };
        let greedy = Greedy { phases, amplitudes, objective, seed, ..Greedy::default() };
        let solution = greedy.solve(&problem, &mut Workspace::new(), &mut Control::none()).expect("an answer");
        let count = u32::try_from(scene.array().len()).expect("small");
        let order: Vec<usize> = Rng::new(seed).permutation(count).into_iter().map(|i| i as usize).collect();
        let search = Search {
            propagation: &propagation(&scene),
            targets: problem.targets_in_pascals(),
            weights: problem.point_weights(),
            phases: phases as usize,
            amplitudes: amplitudes as usize,
            objective: if l1 { oracle::Objective::L1 } else { oracle::Objective::L2 },
            order: &order,
        };
        let worst = search.regrets(&widen(&solution.drive)).into_iter().fold(0.0, f64::max);
        prop_assert!(worst < 1e-6, "regret {worst:e}");
    }
}

#[cfg(feature = "scene-file")]
mod files {
    use super::*;
    use midair::files::{Format, Provenance, read, write};

    const TOML: &str = "[medium]\nfrequency = 40e3\n[array]\ngrid = { nx = 2, ny = 3, pitch = 1e-2 }\ndirectivity = \"point\"\n[[points]]\nposition = [0.0, 0.0, 0.15]\npressure = 500.0\n[solver]\nname = \"greedy\"\nphases = 16\n";
    const JSON: &str = r#"{ "medium": { "frequency": 4e4 }, "array": { "grid": { "nx": 2, "ny": 3, "pitch": 0.01 },
        "directivity": { "piston": 0.0045 } }, "points": [{ "position": [0.0, 0.0, 0.15], "pressure": 500.0 }],
        "solver": { "name": "greedy", "phases": 16 }, "plane": { "size": 0.1 } }"#;

    /// Random errors in a file: any bytes, or bytes that have a meaning in the formats.
    fn slips() -> impl Strategy<Value = Vec<u8>> {
        let useful = prop::sample::select(b"0123456789-+.e\"{}[]=,:#\n ".to_vec());
        prop::collection::vec(prop_oneof![1 => any::<u8>(), 4 => useful], 0..4)
    }

    #[test]
    fn the_texts_that_are_spoilt_are_scenes() {
        for (text, format) in [(TOML, Format::Toml), (JSON, Format::Json)] {
            assert!(read(text.as_bytes(), format).is_ok(), "{text}");
        }
    }

    #[test]
    fn a_refusal_is_no_page_however_long_what_is_refused() {
        let (key, word) = ("k\u{e9} ".repeat(50_000), "w".repeat(100_000));
        let spoilt = [
            TOML.replace("frequency", &format!("\"{key}\"")),
            TOML.replace("\"greedy\"", &format!("\"{key}\"")),
            TOML.replace("\"point\"", &format!("\"{word}\"")),
            TOML.replace("phases = 16", &format!("\"{key}\" = 16")),
            TOML.replace("phases = 16", &format!("phases = \"{word}\"")),
            format!("{word}\n{TOML}"),
        ];
        for text in spoilt {
            let line = read(text.as_bytes(), Format::Toml).expect_err("refused").to_string();
            assert!(line.len() < 1500 && !line.contains('\n'), "{line}");
        }
    }

    proptest! {
        #![proptest_config(config(3000))]

        #[test]
        fn no_text_makes_the_reader_panic(
            json in any::<bool>(), at in any::<prop::sample::Index>(), cut in 0..4_usize, put in slips(),
        ) {
            let (text, format) = if json { (JSON, Format::Json) } else { (TOML, Format::Toml) };
            let mut bytes = text.as_bytes().to_vec();
            let at = at.index(bytes.len());
            let end = (at + cut).min(bytes.len());
            bytes.splice(at..end, put);
            if let Err(error) = read(&bytes, format) {
                prop_assert!(!error.to_string().contains('\n'), "{error}");
            }
        }

        #[test]
        fn any_scene_survives_being_written_and_read(scene in requests()) {
            let Some(scene) = scene else { return Ok(()) };
            for format in [Format::Toml, Format::Json] {
                let text = write(&scene, format, &Provenance::default()).expect("text");
                let again = read(text.as_bytes(), format).expect("a scene");
                prop_assert_eq!(&again, &scene);
                prop_assert_eq!(again.array().origin(), scene.array().origin());
            }
        }
    }
}
