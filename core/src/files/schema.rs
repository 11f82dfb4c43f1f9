//! Keys of a scene file, each with its meaning and an example; `book/schema.py` makes the JSON Schema of them.

use crate::files::source::Format;
use crate::prelude::*;
use crate::scene::{Array, Bead, Key, Medium, Obstacle};

/// Declares keys, each with its meaning and an example.
macro_rules! key_list {
    ($( $(#[doc = $doc:literal])+ $key:ident, such as $example:literal; )+) => {
        &[$( $crate::scene::Key::new(stringify!($key), $example, concat!($($doc),+)), )+]
    };
}
pub(super) use key_list;

/// The path of a table, and its keys.
type Table = (&'static str, &'static [Key]);

/// Declares the tables: each with keys of its own, or with a list of keys.
macro_rules! lists {
    ($( $path:literal $({ $($keys:tt)+ })? $(= $list:expr;)? )+) => {
        const TABLES: &[Table] = &[$( ($path, $(key_list! { $($keys)+ })? $($list)?), )+];
    };
}

lists! {
    "" {
        /// The air: frequency, sound speed, absorption and density.
        medium, such as r#"{"frequency": 40e3}"#;
        /// The transducers: exactly one of grid, preset, positions and part.
        array, such as r#"{"preset": "autd3"}"#;
        /// Control points, one table for each.
        points, such as r#"[{"position": [0.0, 0.0, 0.15]}]"#;
        /// Points along a line, circle or polyline. Texts and drawings need the Python package.
        shape, such as r#"[{"kind": "circle", "center": [0.0, 0.0, 0.15], "radius": 0.03}]"#;
        /// Points from a picture. This needs the Python package.
        image, such as r#"[{"file": "logo.png", "size": 0.08, "z": 0.15, "pixels": 18}]"#;
        /// Obstacles that reflect or scatter the waves: one table for each wall, sphere or mesh.
        obstacles, such as r#"[{"point": [0.1, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]}]"#;
        /// Turns the foci into traps: trap, twin or vortex; or a list with one of these words, or focus, for each point.
        signature, such as r#""trap""#;
        /// The sphere to be trapped, and gravity; by default a sphere of expanded polystyrene.
        bead, such as r#"{"radius": 1e-3}"#;
        /// Points that move, instead of points. Only `midair motion` and `midair play` use this table.
        motion, such as r#"{"rate": 10e3}"#;
        /// The method and its options, used if the command names no method.
        solver, such as r#"{"name": "greedy"}"#;
        /// The plane of pictures. Missing keys are chosen from the points.
        plane, such as r#"{"z": 0.15}"#;
        /// Version of midair that wrote a result; read and ignored.
        version, such as r#""1.0""#;
        /// How the solve ended, in a result; read and ignored.
        status, such as r#""done""#;
    }
    "medium" = Medium::KEYS;
    "bead" = Bead::KEYS;
    "array" {
        /// A flat grid in the plane z = 0, centred on the origin; x varies fastest.
        grid, such as r#"{"nx": 20, "ny": 20, "pitch": 10e-3}"#;
        /// Name of an array; `midair presets` lists the names.
        preset, such as r#""autd3""#;
        /// Numbers of boards of a preset along x and y.
        tiles, such as "[2, 2]";
        /// Position x, y, z of each transducer in m; or a table that names a CSV file.
        positions, such as "[[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]";
        /// Unit of `positions`: m, cm, mm or um. Columns of a file whose names state a unit keep it.
        unit, such as r#""mm""#;
        /// Direction that each transducer of `positions` faces; default +z.
        normals, such as "[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]";
        /// Arrays that are joined into one, such as the boards of a rig: tables with the keys of `array`.
        part, such as r#"[{"preset": "autd3"}, {"preset": "autd3", "translation": [0.2, 0.0, 0.0]}]"#;
        /// Rotation about the origin: axis times angle in rad; or a quaternion w, x, y, z; or a matrix of three rows.
        rotation, such as "[0.0, 1.5708, 0.0]";
        /// Translation in m, after the rotation.
        translation, such as "[0.0, 0.0, 0.1]";
    }
    "array" = Array::PART_KEYS;
    "array.grid" {
        /// Number of transducers along x.
        nx, such as "20";
        /// Number of transducers along y.
        ny, such as "20";
        /// Distance between neighbours in m.
        pitch, such as "10e-3";
    }
    "array.positions" {
        /// Table, relative to the scene file: for each transducer a row x, y, z or x, y, z, nx, ny, nz in m; in Python any file
        /// that Array.from_file reads.
        file, such as r#""bowl.csv""#;
        /// Unit of the file's positions, as in `array`.
        unit, such as r#""mm""#;
    }
    "array.quantization" {
        /// Number of evenly spaced phases, 2 to 65536.
        phases, such as "256";
        /// The possible amplitudes, each 0 to 1.
        amplitudes, such as "[0.0, 0.5, 1.0]";
        /// Lengths of the ticks of a period, in any unit, for a board that makes pulses; instead of the other two keys.
        pulses, such as "[1.0, 1.0, 1.0, 1.0]";
    }
    "points[]" {
        /// Position x, y, z in m.
        position, such as "[0.0, 0.0, 0.15]";
        /// Unit of the position, or of the file: m, cm, mm or um.
        unit, such as r#""mm""#;
        /// Table of points, relative to the scene file, instead of a position: x, y, z in m, and if you like pressure, phase,
        /// weight.
        file, such as r#""points.csv""#;
        /// Requested pressure in Pa (peak), on every point or on none; 0 makes a quiet point.
        pressure, such as "500.0";
        /// Requested phase in rad, for the methods that use phases; default 0.
        phase, such as "1.57";
        /// Weight of the point in the sum of squared errors; default 1. A point of weight 0 is ignored.
        weight, such as "1.0";
    }
    "shape[]" {
        /// Kind of shape: line, circle, polyline, text or svg.
        kind, such as r#""circle""#;
        /// First end of a line: x, y, z in m.
        start, such as "[-0.03, 0.0, 0.15]";
        /// Second end of a line: x, y, z in m.
        end, such as "[0.03, 0.0, 0.15]";
        /// Center of a circle: x, y, z in m.
        center, such as "[0.0, 0.0, 0.15]";
        /// Radius of a circle in m.
        radius, such as "0.03";
        /// Normal of a circle's plane; default +z.
        normal, such as "[0.0, 0.0, 1.0]";
        /// Corners of a polyline: x, y, z of each in m.
        points, such as "[[-0.03, 0.0, 0.15], [0.03, 0.0, 0.15], [0.0, 0.03, 0.15]]";
        /// Whether a polyline returns to its first corner; default false.
        closed, such as "true";
        /// Characters of a text.
        string, such as r#""hi""#;
        /// Height of a capital H of a text, in m.
        height, such as "0.03";
        /// Font of a text; default DejaVu Sans.
        font, such as r#""DejaVu Sans""#;
        /// File of an svg, relative to the scene file.
        file, such as r#""logo.svg""#;
        /// Longer side of an svg in m.
        size, such as "0.08";
        /// Height z of the plane of a text or svg, in m.
        z, such as "0.15";
        /// Distance between neighbouring points in m; default 2.125e-3.
        step, such as "0.002";
        /// Number of points on a circle, instead of a step.
        count, such as "12";
        /// Requested pressure of each point in Pa.
        pressure, such as "500.0";
        /// Weight of each point; default 1.
        weight, such as "1.0";
    }
    "image[]" {
        /// File of the picture, relative to the scene file.
        file, such as r#""logo.png""#;
        /// Longer side of the picture in m.
        size, such as "0.08";
        /// Height z of the picture's plane in m.
        z, such as "0.15";
        /// Number of pixels along the longer side; by default they are half a wavelength at 40 kHz apart.
        pixels, such as "18";
        /// Requested pressure of white pixels in Pa; default 1000.
        pressure, such as "500.0";
        /// Whether dark pixels become quiet points; default false.
        quiet, such as "true";
        /// Weight of each point; default 1.
        weight, such as "1.0";
    }
    "obstacles[]" = Obstacle::PARTS;
    "obstacles[]" {
        /// Boundary condition of the surface: rigid or soft; default rigid.
        kind, such as r#""rigid""#;
        /// Of a mesh: x, y, z of each vertex in m.
        vertices, such as "[[0.0, 0.0, 0.1], [0.01, 0.0, 0.1], [0.0, 0.01, 0.1], [0.0, 0.0, 0.11]]";
        /// Of a mesh: for each triangle, the indices of its three vertices.
        faces, such as "[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]";
        /// Of a mesh: its file, relative to the scene file, instead of vertices and faces.
        file, such as r#""hand.stl""#;
        /// Of a mesh's file: length of its unit in m.
        scale, such as "1e-3";
        /// Of a mesh's file: position of its origin in m.
        offset, such as "[0.0, 0.0, 0.1]";
        /// Of a mesh's file: rotation about its origin, as axis times angle in rad, quaternion w, x, y, z, or matrix.
        rotation, such as "[0.0, 0.0, 1.5708]";
        /// Of a mesh's file: its axis that becomes z; default y for .glb, else z.
        up, such as r#""y""#;
    }
    "motion" {
        /// Number of frames per second.
        rate, such as "10e3";
        /// Largest change of a phase from one frame to the next, in rad; default pi/16.
        change, such as "0.19635";
        /// Largest change of a phase in rad/s, instead of `change`.
        change_rate, such as "2000.0";
        /// Time constant of the transducers' amplitudes in s.
        tau, such as "0.15e-3";
        /// Whether the last frame continues to the first; needs ahead = "all".
        closed, such as "true";
        /// Number of following frames with which each frame is chosen together, 0 or more; or "all".
        ahead, such as "4";
        /// Points that move at the same time, one table for each path.
        path, such as r#"[{"kind": "circle", "center": [0.0, 0.0, 0.15], "radius": 0.02, "frequency": 25.0}]"#;
        /// File of the points, instead of `path`: .npy (T, M, 3) in m, or CSV with the columns frame, point, x, y, z.
        file, such as r#""points.npy""#;
    }
    "motion.path[]" {
        /// circle, line, polyline, lissajous, still, svg or morph. The other keys are those of `midair.path`.
        kind, such as r#""circle""#;
        /// Center of a circle or lissajous: x, y, z in m.
        center, such as "[0.0, 0.0, 0.15]";
        /// Radius of a circle in m.
        radius, such as "0.02";
        /// First end of a line: x, y, z in m.
        start, such as "[-0.03, 0.0, 0.15]";
        /// Second end of a line: x, y, z in m.
        end, such as "[0.03, 0.0, 0.15]";
        /// Corners of a polyline: x, y, z of each in m.
        corners, such as "[[-0.03, 0.0, 0.15], [0.03, 0.0, 0.15], [0.0, 0.03, 0.15]]";
        /// Positions of the points of a still: x, y, z of each in m.
        places, such as "[[0.0, 0.0, 0.15]]";
        /// Width and height of a lissajous in m; or longer side of an svg in m.
        size, such as "[0.04, 0.02]";
        /// Numbers of periods of a lissajous along x and along y, both whole.
        ratio, such as "[3, 2]";
        /// File of an svg, relative to the scene file.
        file, such as r#""logo.svg""#;
        /// Height z of the plane of an svg, in m.
        z, such as "0.15";
        /// Positions at the start of a morph: x, y, z of each point in m.
        from_points, such as "[[-0.02, 0.0, 0.15], [0.02, 0.0, 0.15]]";
        /// Positions at the end of a morph: x, y, z of each point in m.
        to_points, such as "[[0.0, -0.02, 0.15], [0.0, 0.02, 0.15]]";
        /// Speed in m/s; or give `frequency`.
        speed, such as "4.0";
        /// Number of rounds per second; or give `speed`.
        frequency, such as "25.0";
        /// Number of turns on a circle; default 1.
        turns, such as "1.0";
        /// Angle in rad at which a circle starts; default 0.
        start_angle, such as "0.0";
        /// Phase of the motion of a lissajous along x, in rad; default pi/2.
        phase, such as "1.57";
        /// Normal of a circle's plane; default +z.
        normal, such as "[0.0, 0.0, 1.0]";
        /// Number of points on a circle, evenly spaced; default 1.
        points, such as "3";
        /// Whether the point returns to the start of a line; default false.
        there_and_back, such as "true";
        /// Whether a polyline returns to its first corner; default false.
        closed, such as "true";
        /// Duration of a still or morph in s; a morph may have a speed instead.
        duration, such as "0.5";
        /// Requested pressure of each point in Pa; by default the balanced level.
        pressure, such as "500.0";
        /// Requested pressures in Pa, one for all points or one for each; by default the balanced level.
        pressures, such as "[500.0, 300.0]";
        /// Amplitude modulation of the pressure.
        am, such as r#"{"frequency": 200.0, "shape": "sqrt"}"#;
    }
    "motion.path[].am" {
        /// Frequency of the modulation in Hz.
        frequency, such as "200.0";
        /// Shape of the modulation: sqrt, cosine or square; default sqrt.
        shape, such as r#""sqrt""#;
        /// Depth of the modulation, 0 to 1; default 1.
        depth, such as "1.0";
        /// Samples of a modulation, 0 to 1, instead of frequency and shape.
        samples, such as "[1.0, 0.5, 0.0, 0.5]";
        /// Samples per second; they repeat.
        samples_rate, such as "800.0";
    }
    "solver" {
        /// Name of the method; `midair solvers` lists the names.
        name, such as r#""greedy""#;
        /// Whether to solve at the level that the array can reach and then to reduce the drives.
        balance, such as "true";
        /// target: the requested pressures; max: the highest pressures that the array can reach.
        aim, such as r#""max""#;
    }
    "plane" {
        /// Height z in m of a plane normal to z.
        z, such as "0.15";
        /// Axis to which the plane is normal: x, y or z.
        axis, such as r#""y""#;
        /// Position of the plane on this axis in m.
        at, such as "0.0";
        /// Side of the square in m.
        size, such as "0.1";
        /// Number of pixels along a side; default 200.
        pixels, such as "200";
        /// Center of the square in m: (x, y), (x, z) or (y, z).
        center, such as "[0.0, 0.0]";
    }
}

/// Former names and common misspellings of keys: table, former name, present name.
const FORMER: &[(&str, &str, &str)] = &[
    ("array", "levels", "quantization"),
    ("solver", "level", "aim"),
    ("plane", "resolution", "pixels"),
    ("shape[]", "centre", "center"),
    ("shape[]", "text", "string"),
    ("shape[]", "path", "file"),
    ("image[]", "path", "file"),
];

/// The present name of a former or misspelled key.
pub(super) fn renamed(table: &str, key: &str) -> Option<&'static str> {
    FORMER.iter().find(|(at, former, _)| is(at, &pattern(table)) && *former == key).map(|(.., now)| *now)
}

/// All tables of a scene file: path and keys. A list of tables has a path such as `points[]`. The same path may occur more than
/// once, each time with other keys.
pub fn tables() -> impl Iterator<Item = (&'static str, &'static [Key])> {
    TABLES.iter().copied()
}

/// The names of the keys of a table, whose path may have indices: `medium`, `points[3]`.
pub(super) fn keys(table: &str) -> impl Iterator<Item = &'static str> + Clone {
    rows(&pattern(table)).map(|key| key.name)
}

/// An example of a line for the key at a path, or for the nearest table around it.
pub(super) fn example(path: &str, format: Format) -> Option<String> {
    let path = pattern(path);
    let mut path = path.trim_end_matches("[]");
    loop {
        let (table, key) = path.rsplit_once('.').unwrap_or(("", path));
        if let Some(key) = rows(table).find(|known| known.name == key) {
            return Some(line(table, key.name, key.example, format));
        }
        path = table.trim_end_matches("[]");
        if path.is_empty() {
            return None;
        }
    }
}

/// An example of a line for a key, in the first table that has it.
pub(super) fn example_of_key(key: &str, format: Format) -> Option<String> {
    let table = TABLES.iter().find(|(_, rows)| rows.iter().any(|known| known.name == key))?.0;
    example(&if table.is_empty() { key.into() } else { format!("{table}.{key}") }, format)
}

/// A key and its value as a line in this format.
pub(super) fn line(table: &str, key: &str, json: &str, format: Format) -> String {
    if format == Format::Json {
        return format!("\"{key}\": {json}");
    }
    let toml = |json: &str| json.replace("{\"", "{ ").replace("\": ", " = ").replace(", \"", ", ").replace('}', " }");
    let inside = |open, close| json.strip_prefix(open).and_then(|rest: &str| rest.strip_suffix(close));
    match (table, inside("[{\"", "}]"), inside("{\"", "}")) {
        ("", Some(inner), _) => format!("[[{key}]] and under it {}", toml(inner)),
        ("", _, Some(inner)) => format!("[{key}] and under it {}", toml(inner)),
        _ => format!("{key} = {}", toml(json)),
    }
}

fn rows(pattern: &str) -> impl Iterator<Item = &'static Key> + Clone + use<> {
    let pattern = String::from(pattern);
    TABLES.iter().filter(move |(path, _)| is(path, &pattern)).flat_map(|(_, rows)| *rows)
}

/// Whether the path of a table in the schema fits a pattern. A list of tables and a single table fit each other:
/// `shape[]` and `shape`.
fn is(path: &str, pattern: &str) -> bool {
    path.trim_end_matches("[]") == pattern.trim_end_matches("[]")
}

/// Removes the indices from a path: `points[3].pressure` becomes `points[].pressure`. A part of an array has the keys of an
/// array: `array.part[1].tiles` becomes `array.tiles`.
fn pattern(path: &str) -> String {
    let mut within = false;
    let pattern: String = path
        .chars()
        .filter(|&letter| {
            within = (within && letter != ']') || letter == '[';
            !within || letter == '['
        })
        .collect();
    pattern.replace(".part[]", "")
}
