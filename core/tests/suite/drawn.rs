//! Tests of tables that a binding draws: each is passed to the binding once, the points are joined in order, and errors have
//! their place.

use midair::files::{Drawing, Format, Source, read, read_drawn, references};
use midair::{Error, Request};

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
kind = "text"
height = 0.03
string = "hi"
z = 0.15

[[shape]]
kind = "svg"
file = "logo.svg"
size = 0.03
z = 0.15
"#;

const SOURCE: Source<'static> = Source { name: "drawn.toml", folder: None };

/// Returns two points for each table, with pressures and without weights, as a binding could.
fn pair(name: &str) -> Drawing {
    let z = if name == "image" { 0.2 } else { 0.1 };
    let request = Request { pressures: Some(vec![700.0, 800.0]), ..Request::default() };
    Drawing::Points(vec![[0.01, 0.0, z], [0.02, 0.0, z]], request)
}

#[test]
fn tables_are_drawn_in_order_after_the_points() {
    let mut requested = Vec::new();
    let mut draw = |name: &str, text: &str| {
        requested.push((name.to_owned(), text.to_owned()));
        Ok(pair(name))
    };
    let scene = read_drawn(SCENE.as_bytes(), Format::Toml, SOURCE, &mut draw).expect("a scene");
    let heights: Vec<f64> = scene.points().iter().map(|point| point[2]).collect();
    assert_eq!(heights, [0.15, 0.1, 0.1, 0.1, 0.1, 0.2, 0.2]);
    let pressures = scene.request().pressures.clone().expect("pressures");
    assert_eq!(pressures, [500.0, 700.0, 800.0, 700.0, 800.0, 700.0, 800.0]);
    assert_eq!(scene.request().weights, None);
    let names: Vec<&str> = requested.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["shape", "shape", "image"]);
    let text = toml::de::DeTable::parse(&requested[0].1).expect("TOML").into_inner();
    assert_eq!(text["height"].get_ref().as_float().map(toml::de::DeFloat::as_str), Some("0.03"));
    assert_eq!(text["string"].get_ref().as_str(), Some("hi"));
}

#[test]
fn files_of_drawn_tables_belong_to_the_scene() {
    let source = Source { name: "drawn.toml", folder: Some("folder".as_ref()) };
    let named = references(SCENE.as_bytes(), Format::Toml, source).expect("a document");
    assert_eq!(named, [std::path::PathBuf::from("folder/logo.svg"), "folder/logo.png".into()]);
}

/// Returns the error of a document when the drawing function returns `answer`.
fn reported(text: &str, format: Format, answer: &Result<Drawing, Error>) -> String {
    let error = read_drawn(text.as_bytes(), format, SOURCE, &mut |_, _| answer.clone()).expect_err(text).to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

#[test]
fn a_refusal_is_reported_with_the_place_of_its_key() {
    let refusal = |[item, value, cure]: [&str; 3]| Err(Error::invalid(item, value, cure));
    for (answer, begin) in [
        (
            ["height", "-1", "give more"],
            ", line 15, column 10: shape[0].height is -1: give more; for example height = 0.03",
        ),
        (["step", "left out", "give one"], ", line 13, column 1: shape[0].step is left out: give one"),
        (["svgelements", "missing", "install it"], ", line 13, column 1: svgelements is missing: install it"),
        (["it", "late", "come back"], ", line 13, column 1: it is late: come back"),
    ] {
        let error = reported(SCENE, Format::Toml, &refusal(answer));
        assert!(error.starts_with(&format!("drawn.toml{begin}")), "{error}");
    }
    let single = r#"{"array": {"preset": "paper20"}, "image": {"pixels": 0, "size": null}}"#;
    let error = reported(single, Format::Json, &refusal(["pixels", "0", "give more"]));
    assert_eq!(error, "drawn.toml, line 1, column 54: image.pixels is 0: give more; for example \"pixels\": 18");
}

#[test]
fn what_is_no_table_of_known_keys_never_reaches_the_door() {
    for (part, other, begin) in [
        (
            "height = 0.03",
            "hight = 0.03",
            ", line 15, column 1: unknown key of shape[0] \"hight\": did you mean height?",
        ),
        ("string = ", "text = ", ", line 16, column 1: unknown key of shape[0] \"text\": it is called string;"),
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
        let error = reported(&text, Format::Toml, &Ok(pair("shape")));
        assert!(error.starts_with("drawn.toml, line 1, column ") && error.contains("give a table"), "{error}");
    }
}

#[test]
fn pressures_are_of_all_or_none_across_tables() {
    let Drawing::Points(points, request) = pair("shape") else { unreachable!() };
    let none = reported(SCENE, Format::Toml, &Ok(Drawing::Points(points, Request { pressures: None, ..request })));
    assert!(none.starts_with("drawn.toml, line 13, column 1: shape[0].pressure is left out: 1 of 7 points"), "{none}");
}

#[test]
fn a_reader_without_a_door_says_who_draws() {
    let error = read(SCENE.as_bytes(), Format::Toml).expect_err("no drawing").to_string();
    let begin =
        "scene file, line 13, column 1: shape[0] is a table of kind, height, string, z: midair's Python package";
    assert!(error.starts_with(begin), "{error}");
}

/// Returns a scene file with a table `[shape]`.
fn shaped(shape: &str) -> String {
    format!("[array]\npreset = \"paper20\"\n[shape]\n{shape}\n")
}

#[test]
fn lines_circles_and_polylines_need_no_door() {
    use midair::points::{Curve, STEP};
    let [a, b, c] = [[0.0, 0.0, 0.15], [0.02, 0.0, 0.15], [0.02, 0.01, 0.15]];
    for (text, curve, step) in [
        ("kind = 'line'\nstart = [0, 0, 0.15]\nend = [0.02, 0, 0.15]", Curve::line(a, b, false), STEP),
        (
            "kind = 'circle'\ncenter = [0, 0, 0.15]\nradius = 0.02\nnormal = [1, 0, 1]\nstep = 0.003",
            Curve::circle(a, 0.02, [1.0, 0.0, 1.0], 0.0),
            0.003,
        ),
        (
            "kind = 'polyline'\npoints = [[0, 0, 0.15], [0.02, 0, 0.15], [0.02, 0.01, 0.15]]\nclosed = true",
            Curve::lines("points", &[a, b, c], true),
            STEP,
        ),
    ] {
        let scene = read(shaped(&format!("{text}\npressure = 70\nweight = 2")).as_bytes(), Format::Toml).expect(text);
        assert_eq!(scene.points(), curve.and_then(|curve| curve.points(step)).expect(text));
        assert_eq!(scene.request().pressures, Some(vec![70.0; scene.points().len()]));
        assert_eq!(scene.request().weights, Some(vec![2.0; scene.points().len()]));
    }
}

#[test]
fn a_wrong_shape_is_refused_with_its_place() {
    const LINE: &str = "kind = 'line'\nstart = [0, 0, 1]\n";
    for (text, begin) in [
        ("kind = 'square'", "4, column 8: shape.kind is \"square\": give one of line, circle, polyline, text, svg;"),
        ("radius = 1.0", "3, column 1: shape.kind is left out: give one of line, circle"),
        ("kind = 'circle'\nradius = 1.0", "3, column 1: shape.center is left out: circle needs center, radius;"),
        (
            "kind = 'line'\nradius = 1.0",
            "5, column 10: shape.radius is 1.0: line has start, end, step, pressure, weight, leave",
        ),
        (&format!("{LINE}end = [0, 1]"), "6, column 7: shape.end is [0, 1]: give 3 numbers"),
        (&format!("{LINE}end = [0, 0, 1]"), "6, column 7: shape.end is [0.0, 0.0, 1.0]: it is where the start is"),
        (&format!("{LINE}end = [0, 1, 0]\nstep = nan"), "7, column 8: shape.step is NaN: give a finite number"),
        (&format!("{LINE}end = [0, 1, 0]\nstep = 1e-9"), "7, column 8: shape.step is 1e-9: 1.414 m of contours"),
        (
            &format!("{LINE}end = [0, 1, 0]\npressure = -3"),
            "7, column 12: shape.pressure is -3: give a number of at least 0",
        ),
        (
            &format!("{LINE}end = [0, 1, 0]\nweight = inf"),
            "7, column 10: shape.weight is inf: give a number of at least 0",
        ),
        (
            "kind = 'polyline'\npoints = [[0, 0, 1]]",
            "5, column 10: shape.points is [[0.0, 0.0, 1.0]]: give at least two",
        ),
        (
            "kind = 'polyline'\npoints = [[0, 0, 1], [0, 0, nan]]",
            "5, column 10: shape.points is [0.0, 0.0, NaN]: give three",
        ),
        (
            "kind = 'polyline'\npoints = [[0, 0, 1], [0, 1, 1]]\nclosed = 1",
            "6, column 10: shape.closed is 1: give true",
        ),
        ("kind = 'svg'\nsize = 1\nz = 1", "3, column 1: shape.file is left out: svg needs file, size, z"),
    ] {
        let error = read(shaped(text).as_bytes(), Format::Toml).expect_err(text).to_string();
        assert!(error.starts_with(&format!("scene file, line {begin}")), "{error}");
        assert!(!error.contains('\n'), "{error}");
    }
}
