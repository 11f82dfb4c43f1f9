//! Files of moving points: `golden/motion/` has the bytes that a board gets, which the tests of every language read; errors
//! have their place; frames of files.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use midair::files::{Drawing, Format, Source, open, read_motion};
use midair::{Aim, Complex32, Control, Error, InstructionSet, Model, Moving};
use serde_json::{Value, json};

/// For each motion: name, board, document without the paths, paths.
const MOTIONS: [(&str, &str, &str, &str); 3] = [
    (
        "circle",
        "sonicsurface",
        r#"{"array": {"preset": "sonicsurface"}, "motion": {"rate": 400}}"#,
        r#"[{"kind": "circle", "center": [0, 0, 0.15], "radius": 0.01, "frequency": 40, "points": 2}]"#,
    ),
    (
        "pressures",
        "autd3",
        r#"{"array": {"preset": "autd3"}, "motion": {"rate": 1000, "change": 0.4, "tau": 0.0002}}"#,
        r#"[{"kind": "line", "start": [-0.02, 0, 0.13], "end": [0.02, 0.01, 0.15], "frequency": 90, "pressure": 90},
            {"kind": "lissajous", "center": [0, 0, 0.15], "size": [0.02, 0.01], "ratio": [1, 2], "frequency": 90,
             "pressures": [150], "am": {"frequency": 180, "depth": 0.5}}]"#,
    ),
    (
        "traps",
        "openmpd",
        r#"{"signature": "trap", "array": {"preset": "openmpd_pair"}, "bead": {"radius": 0.0012}, "motion": {"rate": 2000}}"#,
        r#"[{"kind": "polyline", "corners": [[0, 0, 0], [0.002, 0, 0], [0, 0, 0.002]], "closed": true, "speed": 1}]"#,
    ),
];

const SCALAR: InstructionSet = InstructionSet::SCALAR;

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../golden/motion/{name}.json"))
}

/// Returns the frames of a document, and the bytes with which a board plays them.
fn played(document: &Value, board: &str) -> (Moving, Vec<String>) {
    let opened = open(document.to_string().as_bytes(), Format::Json, Source::default(), SCALAR).expect("a motion");
    let moving = opened.1.expect("frames");
    let mut session = moving.session(SCALAR).expect("a session");
    let (frames, transducers) = (moving.frames(), moving.scene.array().len());
    let mut drives = vec![Complex32::ZERO; frames * transducers];
    // In two calls, of which the second follows the first.
    for part in [0..frames / 3, frames / 3..frames] {
        let some = &mut drives[part.start * transducers..part.end * transducers];
        session.follow_moving(&moving, part, some, &mut Control::none()).expect("drives");
    }
    let board = moving.scene.array().board(board).expect("a board");
    let mut bytes = vec![0; board.frame_size()];
    let hex = drives.chunks(transducers).map(|drive| {
        board.encode(drive, &mut bytes).expect("bytes");
        bytes.iter().fold(String::new(), |mut text, byte| {
            write!(text, "{byte:02x}").expect("a string");
            text
        })
    });
    let hex = hex.collect();
    (moving, hex)
}

#[test]
fn a_board_gets_the_bytes_of_a_motion_under_the_scalar_set() {
    let write_anew = std::env::var("MIDAIR_GOLDEN").is_ok_and(|wish| wish == "write");
    for (name, board, document, paths) in MOTIONS {
        let mut document: Value = serde_json::from_str(document).expect("JSON");
        document["motion"]["path"] = serde_json::from_str(paths).expect("JSON");
        let (moving, bytes) = played(&document, board);
        let record = json!({
            "motion": document, "board": board, "points": moving.points, "targets": moving.targets, "bytes": bytes,
        });
        if write_anew {
            fs::write(file(name), record.to_string() + "\n").expect("a file");
        }
        let text = fs::read_to_string(file(name)).expect("make golden");
        assert_eq!(serde_json::from_str::<Value>(&text).expect("JSON"), record, "{name}");
    }
}

#[test]
fn what_a_motion_leaves_out_follows_from_its_path() {
    let opened = |more: &str| {
        let text = format!(
            "{more}[motion]\nrate = 100\n[[motion.path]]\nkind = 'still'\nplaces = [0, 0, 0.1]\nduration = 0.1\n"
        );
        open(text.as_bytes(), Format::Toml, Source::default(), SCALAR).expect("a motion").1.expect("frames")
    };
    let moving = opened("[array]\npreset = 'openmpd_board'\n");
    assert_eq!(
        (moving.frames(), moving.count(), moving.closed, moving.aim, moving.stiff),
        (10, 1, true, Aim::Max, false)
    );
    let choice = moving.scene.solver.expect("a solver");
    assert_eq!(choice.name, "glide");
    assert_eq!(choice.options["change"], midair::Value::Real(std::f64::consts::PI / 16.0));
    assert!(opened("signature = 'trap'\n[array]\npreset = 'openmpd_board'\n").stiff);
    let other = opened("[array]\npreset = 'paper20'\n[solver]\nname = 'naive'\n").scene.solver.expect("a solver");
    assert_eq!((other.options, other.aim), (midair::Options::new(), None));
}

/// Returns the error of a motion with these lines in `[motion]`.
fn refused(lines: &str, folder: Option<&Path>) -> String {
    let text = format!("[array]\npreset = \"autd3\"\n[motion]\n{lines}\n");
    let source = Source { name: "a.toml", folder };
    let draw = &mut |_: &str, _: &str| Ok(Drawing::Outline(vec![[0.0; 3]], false));
    let error = read_motion(text.as_bytes(), Format::Toml, source, draw)
        .and_then(|motion| motion.expect("a motion").moving(SCALAR).map(|_| ()));
    error.expect_err(lines).to_string()
}

#[test]
fn every_mistake_of_a_motion_has_its_place() {
    let ring = "rate = 1e3\n[[motion.path]]\nkind = \"circle\"\ncenter = [0, 0, 0.1]\nradius = 0.01\nfrequency = 50\n";
    for (was, now, fault) in [
        ("rate = 1e3", "rate = 60", "a.toml, line 4, column 8: motion.rate is 60.0: that is 1 frames in 0.02 s"),
        (
            "rate = 1e3",
            "rate = 1e3\nchange = -1",
            "line 5, column 10: motion.change is -1.0: give a number of at least 0",
        ),
        ("rate = 1e3", "rate = 1e3\ntau = inf", "line 5, column 7: motion.tau is inf: give a finite number"),
        (
            "rate = 1e3",
            "rate = 1e3\nahead = \"some\"",
            "line 5, column 9: motion.ahead is \"some\": give a whole number",
        ),
        ("rate = 1e3", "rate = 1e3\nahead = 2", "line 5, column 9: motion.ahead is 2: midair's Python package"),
        ("rate = 1e3", "rate = 1e3\nclosed = true", "line 5, column 10: motion.closed is true, but ahead is 0"),
        (
            "rate = 1e3",
            "rate = 1e3\nchange = 1\nchange_rate = 9",
            "line 6, column 15: motion.change_rate is 9.0: change is",
        ),
        ("radius = 0.01", "radius = 0", "line 8, column 10: motion.path[0].radius is 0.0: give a number above 0"),
        (
            "frequency = 50",
            "frequency = 50\nspeed = 2",
            "line 10, column 9: motion.path[0].speed is 2 and frequency is 50",
        ),
        ("frequency = 50", "", "line 5, column 1: motion.path[0].speed is left out, and so is frequency"),
        ("\"circle\"", "\"ring\"", "line 6, column 8: motion.path[0].kind is \"ring\": give one of circle, line"),
        ("\"circle\"", "\"line\"", "line 7, column 10: motion.path[0].center is [0, 0, 0.1]: line has start, end"),
        ("radius = 0.01\n", "", "line 5, column 1: motion.path[0].radius is left out: circle needs center, radius"),
        (
            "frequency = 50",
            "frequency = 50\nam = { frequency = 70 }",
            "line 10, column 20: motion.path[0].am.frequency is 70",
        ),
        (
            "frequency = 50",
            "frequency = 50\npressures = [1, 2]",
            "line 10, column 13: motion.path[0].pressures is 2 numbers",
        ),
    ] {
        let error = refused(&ring.replace(was, now), None);
        assert!(error.contains(fault) && !error.contains('\n'), "{error}\n  should say {fault}");
    }
    let together = format!("{ring}[[motion.path]]\nkind = \"still\"\nplaces = [0, 0, 0.2]\nduration = 0.0301\n");
    assert!(refused(&together, None).contains("the duration of the paths is 0.02 and 0.0301 s"));
    let drawn = ring.replace(
        "kind = \"circle\"\ncenter = [0, 0, 0.1]\nradius = 0.01",
        "kind = \"svg\"\nfile = \"a.svg\"\nsize = 0.1\nz = 0.1",
    );
    assert!(refused(&drawn, None).contains("corners") || refused(&drawn, None).contains("outline"));
}

#[test]
fn frames_of_a_table_or_of_numpy_are_read() -> Result<(), Error> {
    let folder = std::env::temp_dir().join(format!("midair-frames-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("a.csv"), "frame,point,z,x,y\n1,0,0.15,0.02,0\n0,0,0.15,0.01,0\n").expect("a file");
    let numbers = [0.01, 0.0, 0.15, 0.02, 0.0, 0.15];
    let npy = |descr: &str, shape: &str, values: Vec<u8>| {
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
        [b"\x93NUMPY\x01\x00".as_slice(), &(header.len() as u16).to_le_bytes(), header.as_bytes(), &values].concat()
    };
    let doubles: Vec<u8> = numbers.iter().flat_map(|x: &f64| x.to_le_bytes()).collect();
    let singles: Vec<u8> = numbers.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect();
    fs::write(folder.join("b.npy"), npy("<f8", "(2, 1, 3)", doubles.clone())).expect("a file");
    fs::write(folder.join("c.npy"), npy("<f4", "(2, 1, 3)", singles)).expect("a file");
    let text = |name: &str| format!("[array]\npreset = 'autd3'\n[motion]\nrate = 100\nfile = '{name}'\n");
    let source = Source { name: "a.toml", folder: Some(&folder) };
    for name in ["a.csv", "b.npy", "c.npy"] {
        let moving = open(text(name).as_bytes(), Format::Toml, source, SCALAR)?.1.expect("frames");
        for (place, wanted) in moving.points.as_flattened().iter().zip(numbers) {
            assert!((place - wanted).abs() < if name == "c.npy" { 1e-8 } else { 1e-300 }, "{name}");
        }
    }
    for (name, bytes, fault) in [
        ("d.csv", "frame,point,x,y,z\n0,0,0,0,1\n.5,0,0,0,1\n".into(), "d.csv, line 3: frame is 0.5: count them 0, 1"),
        ("e.csv", "frame,point,x,y,z\n0,0,0,0,1\n0,0,0,0,2\n".into(), "line 3: point 0 of frame 0 is there twice"),
        (
            "f.csv",
            "frame,point,x,y,z\n4e9,0,0,0,1\n".into(),
            "the table is 1 rows long: 4000000001 frames of 1 points need 4000000001 rows",
        ),
        ("g.npy", npy("<f8", "(2, 3)", doubles.clone()), "motion.file is \"g.npy\": its shape is (2, 3): give points"),
        ("h.npy", npy("<f8", "(9999999999, 9, 3)", doubles.clone()), "but it has 6 numbers: give points"),
        ("i.npy", npy(">f8", "(2, 1, 3)", doubles), "of another type or order"),
        ("j.npy", b"PK\x03\x04".to_vec(), "motion.file is \"j.npy\": give .npy of points (T, M, 3)"),
    ] {
        fs::write(folder.join(name), bytes).expect("a file");
        let error = refused(&format!("rate = 100\nfile = '{name}'"), Some(&folder));
        assert!(error.contains(fault), "{error}\n  should say {fault}");
    }
    assert!(refused("rate = 100\nfile = 'none.csv'", Some(&folder)).contains("line 5, column 8: motion.file is"));
    assert!(refused("rate = 100\nfile = 'a.csv'", None).contains("has no folder to find files in"));
    fs::remove_dir_all(&folder).expect("removed");
    Ok(())
}

#[test]
fn points_and_traps_that_are_too_fast_are_reported() {
    let warned = |paths: Value, aim: &str, signature: bool| {
        let mut document = json!({
            "array": {"grid": {"nx": 8, "ny": 8, "pitch": 0.01}, "quantization": {"phases": 256}},
            "solver": {"name": "glide", "aim": aim}, "motion": {"rate": 2000, "path": paths},
        });
        if signature {
            document["signature"] = "trap".into();
        }
        let text = document.to_string();
        let opened = open(text.as_bytes(), Format::Json, Source::default(), SCALAR).expect("a motion");
        let moving = opened.1.expect("frames");
        let (model, frames) = (Model::of(&moving.scene, SCALAR), moving.frames());
        let mut drives = vec![Complex32::ZERO; frames * 64];
        let mut session = moving.session(SCALAR).expect("a session");
        session.follow_moving(&moving, 0..frames, &mut drives, &mut Control::none()).expect("drives");
        let strain = moving.strain(0..frames, &drives, &model, &mut Control::none()).expect("a judgement");
        moving.doubts().into_iter().chain(strain).map(|doubt| doubt.to_string()).collect::<Vec<_>>()
    };
    let line =
        |speed: f64| json!([{"kind": "line", "start": [-0.01, 0, 0.12], "end": [0.01, 0, 0.12], "speed": speed}]);
    let text =
        "2 m/s needs 0.21 rad a frame, 0.196 allowed: the level falls; rate = 2.2 kHz or change = pi/14 would do";
    assert_eq!(warned(line(2.0), "max", false), [text]);
    assert_eq!(warned(line(1.0), "max", false), [""; 0]);
    let circle = json!([{"kind": "circle", "center": [0, 0, 0.12], "radius": 0.02, "frequency": 30}]);
    let trap = "point 1 takes 692 m/s^2 in frame 50, more than its trap can give a bead of 1 mm radius: go slower, or by \
                midair.path.fastest";
    assert_eq!(warned(circle, "max", true).last().map(String::as_str), Some(trap));
    let am = json!([{"kind": "still", "places": [[0, 0, 0.12]], "duration": 0.01, "am": {"frequency": 200}}]);
    let aim = "aim is \"max\", but pressures change between frames: leave it out, it plays each frame in full";
    assert_eq!(warned(am, "max", false), [aim]);
}
