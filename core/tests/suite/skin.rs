//! Compares the skin under a focus that moves on a circle with results of an earlier program in Python (NumPy).
//!
//! The program is independent of this code. Its results are in golden/touch/ring.json.

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use midair::touch::{Membrane, Pushes, Skin, felt_width, strength};
use midair::{Array, Complex32, Control, Model, Problem, Request, Scene, Workspace, solvers};
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|each| each.as_f64().expect("a number")).collect()
}

#[test]
fn a_circle_moves_the_skin_as_the_record_has_it() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../golden/touch/ring.json");
    let record: Value = serde_json::from_str(&fs::read_to_string(path).expect("a record")).expect("JSON");
    let real = |key: &str| record[key].as_f64().expect("a number");
    let whole = |key: &str| record[key].as_u64().expect("a count") as usize;
    let (count, side, height) = (whole("frames"), whole("side"), real("height"));
    let array = Array::preset("autd3", [1, 1]).expect("an array");
    let medium = array.medium(&[]).expect("air");
    let step = real("size") / (side - 1) as f64;
    let along = |k: usize| step * k as f64 - real("size") / 2.0;
    let places: Vec<[f64; 3]> = (0..side * side).map(|k| [along(k % side), along(k / side), height]).collect();
    let model = Model::new(&array, medium, midair::InstructionSet::best()).expect("a model");
    let solver = solvers::find("naive").and_then(|found| found.configure(&[].into())).expect("naive").solver;
    let mut pushes = Pushes::new(count, real("rate"), side * side, &Control::none()).expect("pushes");
    for t in 0..count {
        let angle = TAU * t as f64 / count as f64;
        let point = [real("radius") * angle.cos(), real("radius") * angle.sin(), height];
        let scene = Scene::new(array.clone(), medium, vec![point], Request::default()).expect("a scene");
        let problem = Problem::new(&scene).expect("a problem");
        let solved = midair::solve(&problem, &*solver, false, &mut Workspace::new(), &mut Control::none());
        let drive: Vec<Complex32> = solved.expect("a solution").drive;
        let field = midair::field(&model, &drive, &places, &mut Control::none()).expect("a field");
        let pushed: Vec<f32> = field.iter().map(|p| medium.radiation(p.norm().into()) as f32).collect();
        pushes.add(t, &pushed, &mut Control::none()).expect("added");
    }
    let membrane = Membrane::new(6.0, 0.4, 6.4).expect("a membrane");
    let frequencies = numbers(&record["frequencies"]);
    assert!(pushes.frequencies().iter().zip(&frequencies).all(|(a, b)| (a - b).abs() < 1e-9 * b));
    assert_eq!(pushes.frequencies().len(), frequencies.len());
    let skin =
        Skin::on_plane(&membrane, &frequencies, pushes.lines(), [side, side], [step, 2e-3], &mut Control::none())
            .expect("a skin");
    let kept: Vec<usize> = numbers(&record["places"]).iter().map(|&k| k as usize).collect();
    let close =
        |found: f64, exact: f64, part: f64| assert!((found - exact).abs() < part * exact.abs(), "{found} {exact}");
    for (k, &place) in kept.iter().enumerate() {
        close(pushes.mean()[place].into(), numbers(&record["pressure"])[k], 1e-3);
        close(skin.fast[place], numbers(&record["fast"])[k], 2e-3);
        close(skin.slow[place], numbers(&record["slow"])[k], 2e-3);
        let lines = record["displacement"][k].as_array().expect("lines");
        let largest = lines.iter().map(|line| numbers(line)[0].hypot(numbers(line)[1])).fold(0.0, f64::max);
        for (l, line) in lines.iter().enumerate() {
            let [found, exact] = [skin.displacement[l * side * side + place], {
                let parts = numbers(line);
                Complex32::new(parts[0] as f32, parts[1] as f32)
            }];
            assert!(f64::from((found - exact).norm()) < 2e-3 * largest, "line {l} at {place}: {found} {exact}");
        }
    }
    let felt: Vec<f64> = skin.slow.iter().zip(&skin.fast).map(|(&slow, &fast)| strength(slow, fast)).collect();
    let best = whole("strongest");
    assert!(felt.iter().all(|&each| each <= felt[best] * 1.001));
    close(20.0 * felt[best].log10(), real("level"), 1e-3);
    close(felt_width(&felt, &places, best), real("width"), 1e-6);
}
