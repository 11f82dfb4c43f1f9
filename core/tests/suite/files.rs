//! Tests of reading and writing scene files.

use midair::files::{Format, Provenance, Source, read, read_from, references, write};
use midair::{Axis, Directivity, Error, Plane, Scene, Signature, Value};

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

/// Returns `WHOLE` with one part replaced.
fn with(part: &str, other: &str) -> String {
    assert!(WHOLE.contains(part), "{part}");
    WHOLE.replacen(part, other, 1)
}

#[test]
fn every_key_of_the_schema_is_read() {
    let scene = toml(WHOLE).expect("a scene");
    assert_eq!((scene.array().len(), scene.points().len()), (12, 2));
    assert_eq!(scene.array().transducer().directivity, Directivity::piston(4.5e-3));
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
        with("z = 0.15", "axis = \"y\"\nat = 0.01\ncenter = [0.02, 0.1]"),
        with("[medium]", "signature = \"twin\"\n[medium]"),
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
    // Two points 10 mm apart, with the middle at x = 5 mm, and two wavelengths on each side.
    let wavelength = toml(WHOLE).expect("a scene").medium().wavelength();
    assert_eq!((around.axis, around.at, around.pixels), (Axis::Z, 0.15, 200));
    assert!((around.size - 0.01 - 4.0 * wavelength).abs() < 1e-12);
    assert!((around.center[0] - 0.005).abs() < 1e-12 && around.center[1] == 0.0);
    assert_eq!(at("size = 0.2\npixels = 50"), Plane::new(0.15, 0.2, 50, [0.0, 0.0]).expect("a plane"));
    // An upright plane with a given size is centred horizontally on the array's axis, vertically on the points.
    let upright = |at, size, center| Plane::normal_to(Axis::Y, at, size, 200, center).expect("a plane");
    assert_eq!(at("axis = \"y\"\nat = 0.01\nsize = 0.2"), upright(0.01, 0.2, [0.0, 0.15]));
    assert_eq!(at("axis = \"Y\""), upright(0.0, around.size, [around.center[0], 0.15]));
    assert_eq!(at("axis = \"z\"\nat = 0.2").at, at("z = 0.2").at);
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
fn positions_may_lie_in_a_file_beside_the_scene() {
    let folder = std::env::temp_dir().join(format!("midair-positions-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let source = Source { name: "scene.toml", folder: Some(&folder) };
    let text = with("grid = { nx = 4, ny = 3, pitch = 10e-3 }", "positions = { file = \"bowl.csv\" }");
    let read = |csv: &str| {
        std::fs::write(folder.join("bowl.csv"), csv).expect("a file");
        read_from(text.as_bytes(), Format::Toml, source)
    };
    let flat = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]];
    for csv in [
        "0,0,0\n0.01,0,0\n",
        "x,y,z\r\n0,0,0\r\n\r\n1e-2,0,0",
        "\u{feff}X;Y;Z\n 0; 0; 0\n0.01;0;0\n",
        "0 0 0\n0.01  0  0\n",
        "% a bowl\nz (mm);y;x [mm]\n0;0;0;\n0;0,0;10,0;;\n;;\n",
        "[[0, 0, 0], [0.01, 0, 0]]",
        "# a bowl\nname\tz\ty\tx\n\"a\"\t0\t0\t0\nb\t0\t0\t0.01\n",
    ] {
        let scene = read(csv).expect(csv);
        assert_eq!((scene.array().positions(), scene.array().normals()[1]), (&flat[..], [0.0, 0.0, 1.0]), "{csv}");
        // A written scene contains the positions, not the name of their file.
        for format in [Format::Toml, Format::Json] {
            let written = write(&scene, format, &Provenance::default()).expect("text");
            assert_eq!(midair::files::read(written.as_bytes(), format).expect("a scene"), scene);
        }
    }
    let turned = read("0,0,0,1,0,0\n0.01,0,0,0,1,0\n").expect("a scene");
    assert_eq!(turned.array().normals(), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    for (csv, reported) in [
        ("", "empty: give rows x,y,z in metres"),
        ("x,y,z\n", "empty: give rows x,y,z in metres"),
        ("x,x,y,z\n0,1,0,0\n", ", line 1: column \"x\" is there twice: name them x,y,z or"),
        ("x,y,z\r0,0,0\rO,0,0\r", ", line 3: x is \"O\""),
        ("0,0,0\n0.01,O,0\n", ", line 2: y is \"O\": give a number, for example 0.01,0.0,0.0"),
        ("0,0,0\n0.01,0\n", ", line 2: z is \"\": give a number"),
        ("0,0,0\nnan,0,0\n", ", line 2: x is \"nan\""),
        ("0;0;0\n0.0,1;0;0\n", ", line 2: x is \"0.0,1\""),
        ("0,0\n", ", line 1: 2 columns: give x,y,z or x,y,z,nx,ny,nz in metres"),
        ("x_ft,y,z\n0,0,0\n", ", line 1: column is \"x_ft\", whose unit is unknown: give m, cm, mm,"),
        ("px,y,z\n0,0,0\n", ", line 1: columns are px, y, z: name them x,y,z or x,y,z,nx,ny,nz, in metres"),
        ("x,y,z,nx\n0,0,0,1\n", ", line 1: columns are x, y, z, nx"),
        ("0,0,0\n1e30,0,0\n", "scene.toml, line 9, column 13: array.positions[0] is"),
        ("0,0,0,0,0,0\n", "scene.toml, line 8, column 1: array.normals[0] is"),
    ] {
        let error = read(csv).expect_err(csv).to_string();
        assert!(error.contains(reported) && !error.contains('\n'), "{error:?} does not say {reported:?}");
        assert!(error.starts_with("scene.toml") || error.contains("bowl.csv"), "{error}");
    }
    std::fs::remove_file(folder.join("bowl.csv")).expect("the file");
    let error = read_from(text.as_bytes(), Format::Toml, source).unwrap_err().to_string();
    assert!(error.starts_with("scene.toml, line 9, column 22: array.positions.file is \""), "{error}");
    assert!(error.contains("it cannot be read"), "{error}");
    let error = midair::files::read(text.as_bytes(), Format::Toml).unwrap_err().to_string();
    assert!(error.contains("array.positions.file is \"bowl.csv\": this document has no folder"), "{error}");
    let named = references(text.as_bytes(), Format::Toml, source).expect("a document");
    assert_eq!(named, [folder.join("bowl.csv")]);
    std::fs::remove_dir(&folder).expect("an empty folder");
}

#[test]
fn a_signature_is_read_by_name() {
    let text = |name: &str| with("[medium]", &format!("signature = {name}\n[medium]"));
    assert_eq!(toml(&text("\"Vortex\"")).expect("a scene").signature(), Some(&Signature::Vortex));
    let refused = |name: &str| toml(&text(name)).unwrap_err().to_string();
    assert!(
        refused("\"bottle\"").contains("line 2, column 13: unknown signature \"bottle\": known are trap, twin, vortex")
    );
    assert!(refused("[1, 1]").contains("signature"), "{}", refused("[1, 1]"));
    let given = Signature::Given(vec![midair::Complex64::ONE; 12].into());
    let scene = toml(WHOLE).and_then(|scene| scene.with_signature(Some(given))).expect("a scene");
    let refused = write(&scene, Format::Toml, &Provenance::default()).unwrap_err().to_string();
    assert!(refused.starts_with("signature is a list of factors: files know trap, twin and vortex"), "{refused}");
}
