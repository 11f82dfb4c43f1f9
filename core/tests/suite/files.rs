//! The scene file: what it says, and what it refuses in one line.

use midair::files::{Format, MOST_BYTES, Provenance, read, write};
use midair::{Directivity, Error, Plane, Scene, Value};

const WHOLE: &str = r#"
[medium]
frequency = 40e3
sound_speed = 340
absorption = 0.15
density = 1.2

[array]
grid = { nx = 4, ny = 3, pitch = 10e-3 }
source_pressure = 4.386
directivity = { piston = 4.5e-3 }

[[points]]
position = [0.0, 0.0, 0.15]
pressure = 500

[[points]]
position = [0.01, 0, 0.15]
pressure = 250.0
weight = 2.0

[solver]
name = "greedy"
phases = 32
order = "rows"
balance = true

[plane]
z = 0.15
size = 0.1
"#;

fn toml(text: &str) -> Result<Scene, Error> {
    read(text.as_bytes(), Format::Toml)
}

/// `WHOLE` with one part replaced.
fn with(part: &str, other: &str) -> String {
    assert!(WHOLE.contains(part), "{part}");
    WHOLE.replacen(part, other, 1)
}

#[test]
fn every_key_of_the_schema_is_read() {
    let scene = toml(WHOLE).expect("a scene");
    assert_eq!((scene.array().len(), scene.points().len()), (12, 2));
    assert_eq!(scene.array().transducer().directivity, Directivity::Piston(4.5e-3));
    let medium = scene.medium();
    assert_eq!([medium.frequency, medium.sound_speed, medium.absorption, medium.density], [40e3, 340.0, 0.15, 1.2]);
    assert_eq!(scene.request().pressures, Some(vec![500.0, 250.0]));
    assert_eq!(scene.request().weights, Some(vec![1.0, 2.0]));
    let choice = scene.solver.as_ref().expect("a solver");
    assert_eq!((choice.name.as_str(), choice.balance), ("greedy", Some(true)));
    assert_eq!(choice.options["phases"], Value::Integer(32));
    assert_eq!(scene.plane, Some(Plane::new(0.15, 0.1, 200, [0.0, 0.0]).expect("a plane")));
    let warm = toml(&with("sound_speed = 340", "temperature = 25.0")).expect("a scene");
    assert!((warm.medium().sound_speed - 346.13).abs() < 0.01);
}

#[test]
fn a_written_scene_reads_as_the_same_scene() {
    let positions = "positions = [[0, 0, 0], [0.01, 0, 0]]
normals = [[0, 0, 1], [0, 0.6, 0.8]]
response = [[1, 0], [0.5, -0.25]]";
    let texts = [
        WHOLE.to_owned(),
        with("grid = { nx = 4, ny = 3, pitch = 10e-3 }", positions),
        with("grid = { nx = 4, ny = 3, pitch = 10e-3 }", "preset = \"autd3\"\ntiles = [2, 1]"),
        with("directivity = { piston = 4.5e-3 }", "directivity = \"t4010a1\""),
        with("order = \"rows\"", "order = [3, 1, 0, 2, 4, 5, 6, 7, 8, 9, 10, 11]\nseed = 9007199254740993"),
    ];
    for text in texts {
        let scene = toml(&text).expect("a scene");
        for format in [Format::Toml, Format::Json] {
            let provenance = Provenance { version: Some("1".into()), status: Some("done".into()) };
            let written = write(&scene, format, &provenance).expect("text");
            assert_eq!(read(written.as_bytes(), format).expect("a scene"), scene, "{written}");
        }
    }
}

#[test]
fn a_plane_left_out_in_part_follows_the_points() {
    let at = |text: &str| toml(&with("z = 0.15\nsize = 0.1", text)).expect("a scene").plane.expect("a plane");
    let around = at("");
    // Two points 10 mm apart around x = 5 mm: the least size is 40 mm.
    assert_eq!((around.z, around.size, around.pixels), (0.15, 0.04, 200));
    assert!((around.center[0] - 0.005).abs() < 1e-12 && around.center[1] == 0.0);
    assert_eq!(at("size = 0.2\npixels = 50"), Plane::new(0.15, 0.2, 50, [0.0, 0.0]).expect("a plane"));
}

#[test]
fn bad_files_are_refused_in_one_line_that_names_the_item() {
    let grid = "grid = { nx = 4, ny = 3, pitch = 10e-3 }";
    let cases = [
        (String::new(), "empty"),
        (" \n\t\n".into(), "empty"),
        ("[array".into(), "line 1"),
        (with("density = 1.2", "densty = 1.2"), "line 6: unknown field `densty`"),
        (with("pitch", "pich"), "unknown field `pich`"),
        (with("weight = 2.0", "wait = 2.0"), "unknown field `wait`"),
        (with("[plane]", "[plain]"), "unknown field `plain`"),
        (with("size = 0.1", "sise = 0.1"), "unknown field `sise`"),
        (with("source_pressure", "pressure"), "unknown field `pressure`"),
        (with("phases = 32", "phase = 32"), "unknown option of greedy \"phase\": known are phases"),
        (with("\"greedy\"", "\"gredy\""), "unknown solver \"gredy\": known are uniform"),
        (with(grid, "preset = \"autd4\""), "unknown preset \"autd4\": known are paper20"),
        (with("{ piston = 4.5e-3 }", "\"pistn\""), "unknown directivity \"pistn\": known are point"),
        (with("{ piston = 4.5e-3 }", "{ piston = 1e-3, cos = 1.0 }"), "array.directivity"),
        (with("{ piston = 4.5e-3 }", "{ piston = 0 }"), "directivity.piston is 0.0"),
        (with("{ piston = 4.5e-3 }", "[1]"), "a name such as"),
        (with("pressure = 250.0\n", ""), "points[1].pressure is left out"),
        (with("pressure = 250.0", "pressure = \"loud\""), "line 19: invalid type: string \"loud\""),
        (with("pressure = 250.0", "pressure = true"), "invalid type: boolean"),
        (with("pressure = 250.0", "pressure = nan"), "points[1].pressure is NaN"),
        (with("pressure = 250.0", "pressure = -1"), "points[1].pressure is -1"),
        (with("weight = 2.0", "weight = inf"), "points[1].weight is inf"),
        (with("[0.01, 0, 0.15]", "[0.01, 0]"), "invalid length 2"),
        (with("[0.01, 0, 0.15]", "[0.01, inf, 0.15]"), "points[1].position is [0.01, inf, 0.15]"),
        (with("density = 1.2", "temperature = 20"), "medium.temperature is 20"),
        (with("frequency = 40e3", "frequency = 0"), "medium.frequency is 0"),
        (with("sound_speed = 340", "sound_speed = -340"), "medium.sound_speed is -340"),
        (with("absorption = 0.15", "absorption = -0.1"), "medium.absorption is -0.1"),
        (with(grid, "preset = \"autd3\"\ngrid = { nx = 1, ny = 1, pitch = 1 }"), "array is described 2 times"),
        (with(grid, ""), "array is described 0 times"),
        (with("nx = 4", "nx = 0"), "array.grid.nx is 0"),
        (with("nx = 4", "nx = -3"), "array.grid.nx is -3"),
        (with("nx = 4", "nx = 4.5"), "invalid type: floating point"),
        (with("nx = 4", "nx = 4000000"), "give at most 1048576 transducers"),
        (with("pitch = 10e-3", "pitch = 0"), "array.grid.pitch is 0"),
        (with(grid, "preset = \"autd3\"\ntiles = [0, 1]"), "array.tiles[0] is 0"),
        (with(grid, "preset = \"paper20\"\ntiles = [2, 1]"), "array.tiles[0] is 2"),
        (with(grid, "positions = []"), "array.positions is empty"),
        (with(grid, "positions = [[0, 0, 0]]\nnormals = []"), "array.normals is 0 normals"),
        (with(grid, "positions = [[0, 0, 0]]\nnormals = [[0, 0, 0]]"), "array.normals[0] is [0.0, 0.0, 0.0]"),
        (with(grid, &format!("{grid}\nresponse = [[1, 0]]")), "array.response is 1 values"),
        (with("phases = 32", "phases = 1"), "phases is 1: give 2 to 65536"),
        (with("phases = 32", "phases = 65537"), "phases is 65537"),
        (with("phases = 32", "amplitudes = 0"), "amplitudes is 0: give 1 to 256"),
        (with("phases = 32", "amplitudes = 257"), "amplitudes is 257"),
        (with("phases = 32", "seed = -1"), "seed is -1"),
        (with("phases = 32", "phases = 2.5"), "phases is 2.5"),
        (with("\"rows\"", "[0, -1]"), "order is [0, -1]"),
        (with("\"rows\"", "\"diagonal\""), "order is \"diagonal\""),
        (with("balance = true", "balance = 1"), "solver.balance is 1"),
        (with("size = 0.1", "size = 0"), "plane.size is 0"),
        (with("size = 0.1", "pixels = 1"), "plane.pixels is 1"),
        (with("size = 0.1", "pixels = -1"), "plane.pixels is -1"),
        ("[array]\npreset = \"paper20\"".into(), "points is empty"),
        ("[[points]]\nposition = [0, 0, 1]".into(), "missing field `array`"),
    ];
    for (text, item) in cases {
        let error = toml(&text).expect_err(item).to_string();
        assert!(error.contains(item) && !error.contains('\n'), "{error:?} does not say {item:?}");
    }
    let short = with("pressure = 500", "pressure = 0").replace("pressure = 250.0", "pressure = 0");
    assert_eq!(
        toml(&short).unwrap_err().to_string(),
        "pressures is all 0: give at least one point (of weight above 0) a pressure above 0 Pa"
    );
}

#[test]
fn an_order_that_is_no_permutation_of_this_array_is_refused_when_solving() {
    let scene = toml(&with("\"rows\"", "[0, 0]")).expect("two zeros may fit another array");
    let choice = scene.solver.as_ref().expect("a solver");
    let made = midair::solvers::find("greedy").and_then(|entry| entry.configure(&choice.options)).expect("options");
    let problem = midair::Problem::new(&scene).expect("a problem");
    let answer = made.solver.solve(&problem, &mut midair::Workspace::new(), &mut midair::Control::none()).unwrap_err();
    assert!(answer.to_string().starts_with("order is"), "{answer}");
}

#[test]
fn what_is_no_text_or_too_much_of_it_is_refused() {
    let binary = read(&[0xff, 0xfe, 0x00, 0x80], Format::Toml).unwrap_err().to_string();
    assert!(binary.contains("not text"), "{binary}");
    let large = read(&vec![b' '; MOST_BYTES + 1], Format::Json).unwrap_err().to_string();
    assert!(large.contains("64 MB"), "{large}");
    let json = read(b"{\"array\": {\"preset\": \"paper20\"},\n \"point\": []}", Format::Json).unwrap_err();
    assert!(json.to_string().starts_with("scene file, line 2: unknown field `point`"), "{json}");
}
