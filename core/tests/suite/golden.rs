//! Golden vectors: scenes with the exact bits of their results, which the tests of every language read.
//!
//! `make golden` writes `golden/` again from the scenes below, which is a breaking change.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use midair::files::{Format, Provenance, read, write};
use midair::{
    Complex32, Control, InstructionSet, Metrics, Problem, Propagation, Scene, Setup, Solution, Workspace, solvers,
};
use serde_json::{Value, json};

/// For each scene: name, array, points (x, y, z in mm, pressure in Pa, weight), table of the solver, balance.
const SCENES: [(&str, &str, &str, &str, bool); 18] = [
    ("focus", "preset = \"autd3\"", "0 0 150 500 1", "name = \"greedy\"\nseed = 1", false),
    (
        "pair",
        "grid = { nx = 6, ny = 5, pitch = 0.01 }",
        "-20 5 120 - 1,20 0 130 - 1",
        "name = \"greedy\"\nseed = 2",
        false,
    ),
    (
        "grid",
        "grid = { nx = 6, ny = 6, pitch = 0.0105 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 300 1,20 0 130 100 1,0 -18 110 200 2",
        "name = \"greedy\"\nphases = 10\namplitudes = 4\norder = \"columns\"",
        false,
    ),
    (
        "quiet",
        "grid = { nx = 8, ny = 8, pitch = 0.01 }\ndirectivity = { piston = 0.0045 }",
        "-20 5 120 900 1,20 0 120 0 3,5 20 120 900 0",
        "name = \"greedy\"\nobjective = \"l1\"\nphases = 32\nseed = 18446744073709551615",
        false,
    ),
    ("weak", "preset = \"autd3\"", "-20 5 120 20 1,20 0 120 10 1", "name = \"greedy\"\norder = \"rows\"", true),
    (
        "response",
        "positions = [[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0.002], [0.012, 0.011, 0]]\nnormals = [[0, 0, 1], [0.1, 0, 1], [0, 0.2, 1], [0, 0, 2]]\nresponse = [[1, 0], [0.5, 0.5], [0, 0], [-0.9, 0.1]]\ndirectivity = { cos = 3.376 }",
        "0 0 90 60 1,8 8 100 30 1",
        "name = \"greedy\"\nphases = 7\namplitudes = 2\norder = [3, 0, 2, 1]",
        false,
    ),
    ("clamp", "grid = { nx = 7, ny = 7, pitch = 0.01 }", "-20 5 120 2000 1,20 0 130 1500 1", "name = \"naive\"", false),
    (
        "normalize",
        "grid = { nx = 7, ny = 7, pitch = 0.01 }\ndirectivity = { sinc = 0.009 }",
        "-20 5 120 2000 1,20 0 130 1500 1",
        "name = \"naive\"\nlimit = \"normalize\"",
        false,
    ),
    (
        "lm",
        "grid = { nx = 7, ny = 6, pitch = 0.01 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 400 1,20 0 130 300 2,0 -18 110 350 1,10 20 125 0 1",
        "name = \"lm\"\nsteps = 12\nseed = 3",
        false,
    ),
    (
        "gspat",
        "grid = { nx = 7, ny = 6, pitch = 0.01 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 400 1,20 0 130 300 2,0 -18 110 350 1,10 20 125 0 1",
        "name = \"gspat\"\nsteps = 20",
        false,
    ),
    (
        "gs",
        "grid = { nx = 7, ny = 6, pitch = 0.01 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 400 1,20 0 130 300 2,0 -18 110 350 1,10 20 125 0 1",
        "name = \"gs\"\nsteps = 20",
        false,
    ),
    (
        "wgs",
        "grid = { nx = 7, ny = 6, pitch = 0.01 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 400 1,20 0 130 300 2,0 -18 110 350 1,10 20 125 0 1",
        "name = \"wgs\"\nsteps = 20",
        false,
    ),
    (
        "evd",
        "grid = { nx = 7, ny = 6, pitch = 0.01 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 400 1,20 0 130 300 2,0 -18 110 350 1,10 20 125 0 1",
        "name = \"evd\"\ngamma = 0.5",
        false,
    ),
    (
        "sdp",
        "grid = { nx = 7, ny = 6, pitch = 0.01 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 400 1,20 0 130 300 2,0 -18 110 350 1,10 20 125 0 1",
        "name = \"sdp\"\nsteps = 60\nseed = 4\nmoduli = \"unit\"",
        false,
    ),
    (
        "tikhonov",
        "grid = { nx = 7, ny = 6, pitch = 0.01 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 400 1,20 0 130 300 2,0 -18 110 350 1,10 20 125 0 1",
        "name = \"tikhonov\"\nlimit = \"full\"",
        false,
    ),
    (
        "uniform",
        "grid = { nx = 7, ny = 6, pitch = 0.01 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 400 1,20 0 130 300 2,0 -18 110 350 1,10 20 125 0 1",
        "name = \"uniform\"",
        true,
    ),
    (
        "best",
        "grid = { nx = 7, ny = 6, pitch = 0.01 }\ndirectivity = \"t4010a1\"",
        "-20 5 120 400 1,20 0 130 300 2,0 -18 110 350 1",
        "name = \"best\"\nstarts = 40\nseed = 5\naim = \"max\"",
        true,
    ),
    (
        "device",
        "grid = { nx = 4, ny = 3, pitch = 0.01 }\nquantization = { phases = 10, amplitudes = [0, 0.25, 1] }\nmask = [true, true, true, true, false, true, true, true, true, true, true, false]",
        "-20 5 120 100 1,20 0 130 80 1",
        "name = \"wgs\"\nsteps = 20",
        true,
    ),
];

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../golden")
}

fn scene((_, array, points, solver, _): &(&str, &str, &str, &str, bool)) -> Scene {
    let mut text = format!("[medium]\nabsorption = 0.15\n[array]\n{array}\n[solver]\n{solver}\n");
    // TOML cannot express a seed of 64 bits; JSON can, and the seed is added below.
    text = text.replace("seed = 18446744073709551615\n", "");
    for point in points.split(',') {
        let mut fields = point.split(' ');
        let mut next = || fields.next().expect("a field");
        let place: Vec<f64> = (0..3).map(|_| next().parse::<f64>().expect("mm") * 1e-3).collect();
        let (pressure, weight) = (next(), next());
        let pressure = if pressure == "-" { String::new() } else { format!("pressure = {pressure}.0\n") };
        writeln!(text, "[[points]]\nposition = {place:?}\n{pressure}weight = {weight}.0").expect("a string");
    }
    let mut scene = read(text.as_bytes(), Format::Toml).expect("a scene");
    if solver.contains("18446744073709551615") {
        let choice = scene.solver.as_mut().expect("a solver");
        choice.options.insert("seed".into(), midair::Value::Integer(u64::MAX.into()));
    }
    scene
}

fn solved(scene: &Scene, balance: bool, set: InstructionSet) -> Solution {
    let choice = scene.solver.as_ref().expect("a solver");
    let made = solvers::configure(choice, scene.array().quantization()).expect("options");
    let propagation = Propagation::of(scene).with_instruction_set(set);
    let mut problem = Problem::with_propagation(propagation, Setup::of(scene.array(), scene.medium()), scene.request())
        .expect("a problem");
    if let Some(aim) = choice.aim {
        problem = problem.with_aim(aim);
    }
    midair::solve(&problem, &*made.solver, balance, &mut Workspace::new(), &mut Control::none()).expect("an answer")
}

fn metrics(metrics: Metrics) -> Value {
    let Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
    json!({ "accuracy": accuracy, "sigma": sigma, "uniformity": uniformity, "level": level, "residual": residual, "leak": leak })
}

fn write_anew() {
    fs::create_dir_all(folder()).expect("golden/");
    for case in &SCENES {
        let scene = scene(case);
        let solution = solved(&scene, case.4, InstructionSet::SCALAR);
        let text = write(&scene, Format::Json, &Provenance::default()).expect("text");
        let record = json!({
            "scene": serde_json::from_str::<Value>(&text).expect("JSON"),
            "balance": case.4,
            "drive": solution.drive.iter().map(|q| [q.re, q.im]).collect::<Vec<_>>(),
            "metrics": metrics(solution.metrics()),
        });
        let text = serde_json::to_string(&record).expect("JSON");
        fs::write(folder().join(format!("{}.json", case.0)), text + "\n").expect("a file");
    }
}

#[test]
fn golden_vectors_come_out_bit_for_bit_under_the_scalar_set() {
    if std::env::var("MIDAIR_GOLDEN").is_ok_and(|wish| wish == "write") {
        write_anew();
    }
    for case in &SCENES {
        let text = fs::read_to_string(folder().join(format!("{}.json", case.0))).expect("make golden");
        let record: Value = serde_json::from_str(&text).expect("JSON");
        let text = record["scene"].to_string();
        let scene = read(text.as_bytes(), Format::Json).expect("a scene");
        let balance = record["balance"].as_bool().expect("yes or no");
        for level in InstructionSet::all() {
            // Greedy has near-ties, which rounding may decide differently on each instruction set.
            let metrics = solved(&scene, balance, level).metrics();
            let near = |name: &str, ours: f64, within: f64| {
                let theirs = record["metrics"][name].as_f64().expect("a number");
                assert!((theirs - ours).abs() < within, "{}: {name} is {ours} at {level}", case.0);
            };
            near("accuracy", metrics.accuracy, 2e-3);
            near("sigma", metrics.sigma, 5e-3);
        }
        let solution = solved(&scene, balance, InstructionSet::SCALAR);
        let number = |value: &Value| value.as_f64().expect("a number") as f32;
        let drive = record["drive"].as_array().expect("a list");
        assert_eq!(drive.len(), solution.drive.len());
        for (i, (theirs, ours)) in drive.iter().zip(&solution.drive).enumerate() {
            let theirs = Complex32::new(number(&theirs[0]), number(&theirs[1]));
            assert_eq!(theirs.re.to_bits(), ours.re.to_bits(), "{}: drive[{i}] is {ours}, was {theirs}", case.0);
            assert_eq!(theirs.im.to_bits(), ours.im.to_bits(), "{}: drive[{i}] is {ours}, was {theirs}", case.0);
        }
        for (name, theirs) in record["metrics"].as_object().expect("a table") {
            let ours = metrics(solution.metrics())[name].as_f64().expect("a number");
            // The tolerance is for a number that was written as decimal text.
            assert!((theirs.as_f64().expect("a number") - ours).abs() < 1e-12, "{}: {name} is {ours}", case.0);
        }
    }
}

/// The instruction sets simd128 and scalar give the same bits, because the scalar code is compiled to plain loops
/// with simd128 instructions.
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
#[test]
fn every_method_has_the_bits_of_the_scalar_set() {
    use midair::{Array, Directivity, Medium, Options, Request, Transducer};
    for directivity in [Directivity::POINT, Directivity::T4010A1] {
        let transducer = Transducer { directivity, ..Transducer::default() };
        let array = Array::grid(9, 7, 10e-3).and_then(|array| array.with_transducer(transducer));
        let medium = Medium { absorption: 0.15, ..Medium::default() };
        // More points than SIMD lanes, and not a multiple of their number.
        let points: Vec<[f64; 3]> =
            (0..19).map(|j| [f64::from(j % 5) * 0.012 - 0.02, f64::from(j / 5) * 0.013 - 0.02, 0.12]).collect();
        let request = Request { weights: Some(vec![1.5; points.len()]), ..Request::default() };
        let scene = Scene::new(array.expect("an array"), medium, points, request).expect("a scene");
        for entry in solvers::SOLVERS {
            let [simd, scalar] = [InstructionSet::best(), InstructionSet::SCALAR].map(|set| {
                let propagation = Propagation::of(&scene).with_instruction_set(set);
                let setup = Setup::of(scene.array(), scene.medium());
                let problem = Problem::with_propagation(propagation, setup, scene.request()).expect("a problem");
                let solver = entry.configure(&Options::new()).expect("defaults").solver;
                let none = &mut Control::none();
                let solution = midair::solve(&problem, &*solver, true, &mut Workspace::new(), none).expect("an answer");
                let bits = |z: &Complex32| [z.re.to_bits(), z.im.to_bits()];
                solution.drive.iter().chain(&solution.pressures).map(bits).collect::<Vec<_>>()
            });
            assert!(simd == scalar, "{}, {directivity:?}: not the bits of the scalar set", entry.info.name);
        }
    }
}
