//! Tables of a scene file that a door draws: handed over once each, joined in order, refused with their place.

use midair::Request;
use midair::files::{Drawing, Format, Source, read, read_drawn, references};

const SCENE: &str = r#"
[array]
preset = "paper20"

[[points]]
position = [0.0, 0.0, 0.15]
pressure = 500

[image]
file = "logo.png"
size = 0.08

[[shape]]
kind = "circle"
radius = 0.03
center = [0, 0.01, 0.15]

[[shape]]
kind = "svg"
file = "logo.svg"
"#;

const SOURCE: Source<'static> = Source { name: "drawn.toml", folder: None };

/// A door that draws two points for each table, of one pressure and no weight.
fn pair(name: &str) -> Drawing {
    let z = if name == "image" { 0.2 } else { 0.1 };
    let request = Request { pressures: Some(vec![700.0, 800.0]), ..Request::default() };
    Drawing::Points(vec![[0.01, 0.0, z], [0.02, 0.0, z]], request)
}

#[test]
fn tables_are_drawn_in_order_after_the_points() {
    let mut asked = Vec::new();
    let mut draw = |name: &str, text: &str| {
        asked.push((name.to_owned(), text.to_owned()));
        Ok(pair(name))
    };
    let scene = read_drawn(SCENE.as_bytes(), Format::Toml, SOURCE, &mut draw).expect("a scene");
    let heights: Vec<f64> = scene.points().iter().map(|point| point[2]).collect();
    assert_eq!(heights, [0.15, 0.1, 0.1, 0.1, 0.1, 0.2, 0.2]);
    let pressures = scene.request().pressures.clone().expect("pressures");
    assert_eq!(pressures, [500.0, 700.0, 800.0, 700.0, 800.0, 700.0, 800.0]);
    assert_eq!(scene.request().weights, None);
    let names: Vec<&str> = asked.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["shape", "shape", "image"]);
    let circle: toml::Table = asked[0].1.parse().expect("TOML");
    assert_eq!(circle["radius"].as_float(), Some(0.03));
    assert_eq!(circle["center"].as_array().map(Vec::len), Some(3));
}

#[test]
fn files_of_drawn_tables_belong_to_the_scene() {
    let source = Source { name: "drawn.toml", folder: Some("folder".as_ref()) };
    let named = references(SCENE.as_bytes(), Format::Toml, source).expect("a document");
    assert_eq!(named, [std::path::PathBuf::from("folder/logo.svg"), "folder/logo.png".into()]);
}

/// What a document is refused with, where the door answers so.
fn told(text: &str, format: Format, answer: &Result<Drawing, String>) -> String {
    let error = read_drawn(text.as_bytes(), format, SOURCE, &mut |_, _| answer.clone()).expect_err(text).to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

#[test]
fn a_refusal_is_told_with_the_place_of_its_key() {
    let refusal = |text: &str| Err(text.to_owned());
    for (answer, begin) in [
        (
            "radius is -1: give more",
            ", line 15, column 10: shape[0].radius is -1: give more; for example radius = 0.03",
        ),
        ("step is left out: give one", ", line 13, column 1: shape[0].step is left out: give one"),
        ("svgelements: there is none", ", line 13, column 1: shape[0] is a table of center, kind, radius: svgelements"),
        ("it is late: come back", ", line 13, column 1: shape[0] is a table of center, kind, radius: it is late: come"),
    ] {
        let error = told(SCENE, Format::Toml, &refusal(answer));
        assert!(error.starts_with(&format!("drawn.toml{begin}")), "{error}");
    }
    let lone = r#"{"array": {"preset": "paper20"}, "image": {"pixels": 0, "size": null}}"#;
    let error = told(lone, Format::Json, &refusal("pixels is 0: give more"));
    assert_eq!(error, "drawn.toml, line 1, column 54: image.pixels is 0: give more; for example \"pixels\": 18");
}

#[test]
fn what_is_no_table_of_known_keys_never_reaches_the_door() {
    for (part, other, begin) in [
        (
            "radius = 0.03",
            "radus = 0.03",
            ", line 15, column 1: unknown key of shape[0] \"radus\": did you mean radius?",
        ),
        ("center = [", "centre = [", ", line 16, column 1: unknown key of shape[0] \"centre\": it is called center;"),
        (
            "file = \"logo.png\"",
            "path = \"logo.png\"",
            ", line 10, column 1: unknown key of image \"path\": it is called",
        ),
    ] {
        assert!(SCENE.contains(part), "{part}");
        let mut draw = |name: &str, _: &str| if name == "shape" { Ok(pair(name)) } else { panic!("{name} was drawn") };
        let error = read_drawn(SCENE.replacen(part, other, 1).as_bytes(), Format::Toml, SOURCE, &mut draw);
        let error = error.expect_err(other).to_string();
        assert!(error.starts_with(&format!("drawn.toml{begin}")), "{error}");
    }
    for value in ["3", "[3]", "\"circle\"", "[[1, 2]]"] {
        let text = format!("shape = {value}\n[array]\npreset = \"paper20\"\n");
        let error = told(&text, Format::Toml, &Ok(pair("shape")));
        assert!(error.starts_with("drawn.toml, line 1, column ") && error.contains("give a table"), "{error}");
    }
}

#[test]
fn pressures_are_of_all_or_none_across_tables() {
    let Drawing::Points(points, request) = pair("shape") else { unreachable!() };
    let none = told(SCENE, Format::Toml, &Ok(Drawing::Points(points, Request { pressures: None, ..request })));
    assert!(none.starts_with("drawn.toml, line 13, column 1: shape[0].pressure is left out: 1 of 7 points"), "{none}");
}

#[test]
fn a_reader_without_a_door_says_who_draws() {
    let error = read(SCENE.as_bytes(), Format::Toml).expect_err("nobody draws").to_string();
    let begin = "scene file, line 13, column 1: shape[0] is a table of center, kind, radius: midair's Python package";
    assert!(error.starts_with(begin), "{error}");
}
