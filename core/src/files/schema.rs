//! Schema: all keys of a scene file, each with its meaning and an example, for editors and error messages.

use alloc::format;
use alloc::string::String;

use crate::files::source::Format;
use crate::scene::{Array, Bead, Key, Medium, Obstacle};

/// The path of a table, and its keys.
type Table = (&'static str, &'static [Key]);

const TABLES: &[Table] = &[
    (
        "",
        &[
            Key::new("medium", r#"{"frequency": 40e3}"#, "The air: frequency, sound speed, absorption and density."),
            Key::new(
                "array",
                r#"{"preset": "autd3"}"#,
                "The transducers: exactly one of grid, preset, positions and part.",
            ),
            Key::new("points", r#"[{"position": [0.0, 0.0, 0.15]}]"#, "Control points, one table for each."),
            Key::new(
                "shape",
                r#"[{"kind": "circle", "center": [0.0, 0.0, 0.15], "radius": 0.03}]"#,
                "Points along a line, circle or polyline. Texts and drawings need the Python package.",
            ),
            Key::new(
                "image",
                r#"[{"file": "logo.png", "size": 0.08, "z": 0.15, "pixels": 18}]"#,
                "Points from a picture. This needs the Python package.",
            ),
            Key::new(
                "obstacles",
                r#"[{"point": [0.1, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]}]"#,
                "Obstacles that reflect or scatter the waves: one table for each wall, sphere or mesh.",
            ),
            Key::new(
                "signature",
                r#""trap""#,
                "Turns the foci into traps: trap, twin or vortex; or a list with one of these words, or focus, for each point.",
            ),
            Key::new(
                "bead",
                r#"{"radius": 1e-3}"#,
                "The sphere to be trapped, and gravity; by default a sphere of expanded polystyrene.",
            ),
            Key::new(
                "motion",
                r#"{"rate": 10e3}"#,
                "Points that move, instead of points. Only `midair motion` and `midair play` use this table.",
            ),
            Key::new(
                "solver",
                r#"{"name": "greedy"}"#,
                "The method and its options, used if the command names no method.",
            ),
            Key::new("plane", r#"{"z": 0.15}"#, "The plane of pictures. Missing keys are chosen from the points."),
            Key::new("version", r#""1.0""#, "Version of midair that wrote a result; read and ignored."),
            Key::new("status", r#""done""#, "How the solve ended, in a result; read and ignored."),
        ],
    ),
    ("medium", Medium::KEYS),
    ("bead", Bead::KEYS),
    (
        "array",
        &[
            Key::new(
                "grid",
                r#"{"nx": 20, "ny": 20, "pitch": 10e-3}"#,
                "A flat grid in the plane z = 0, centred on the origin; x varies fastest.",
            ),
            Key::new("preset", r#""autd3""#, "Name of an array; `midair presets` lists the names."),
            Key::new("tiles", "[2, 2]", "Numbers of boards of a preset along x and y."),
            Key::new(
                "positions",
                "[[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]",
                "Position x, y, z of each transducer in m; or a table that names a CSV file.",
            ),
            Key::new(
                "normals",
                "[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]",
                "Direction that each transducer of `positions` faces; default +z.",
            ),
            Key::new(
                "part",
                r#"[{"preset": "autd3"}, {"preset": "autd3", "translation": [0.2, 0.0, 0.0]}]"#,
                "Arrays that are joined into one, such as the boards of a rig: tables with the keys of `array`.",
            ),
            Key::new(
                "rotation",
                "[0.0, 1.5708, 0.0]",
                "Rotation about the origin: axis times angle in rad; or a quaternion w, x, y, z; or a matrix of three rows.",
            ),
            Key::new("translation", "[0.0, 0.0, 0.1]", "Translation in m, after the rotation."),
        ],
    ),
    ("array", Array::PART_KEYS),
    (
        "array.grid",
        &[
            Key::new("nx", "20", "Number of transducers along x."),
            Key::new("ny", "20", "Number of transducers along y."),
            Key::new("pitch", "10e-3", "Distance between neighbours in m."),
        ],
    ),
    (
        "array.positions",
        &[Key::new(
            "file",
            r#""bowl.csv""#,
            "Table, relative to the scene file: for each transducer a row x, y, z or x, y, z, nx, ny, nz in m; in Python any file that Array.from_file reads.",
        )],
    ),
    (
        "array.quantization",
        &[
            Key::new("phases", "256", "Number of evenly spaced phases, 2 to 65536."),
            Key::new("amplitudes", "[0.0, 0.5, 1.0]", "The possible amplitudes, each 0 to 1."),
            Key::new(
                "pulses",
                "[1.0, 1.0, 1.0, 1.0]",
                "Lengths of the ticks of a period, in any unit, for a board that makes pulses; instead of the other two keys.",
            ),
        ],
    ),
    (
        "points[]",
        &[
            Key::new("position", "[0.0, 0.0, 0.15]", "Position x, y, z in m."),
            Key::new(
                "file",
                r#""points.csv""#,
                "Table of points, relative to the scene file, instead of a position: x, y, z in m, and if you like pressure, phase, weight.",
            ),
            Key::new(
                "pressure",
                "500.0",
                "Requested pressure in Pa (peak), on every point or on none; 0 makes a quiet point.",
            ),
            Key::new("phase", "1.57", "Requested phase in rad, for the methods that use phases; default 0."),
            Key::new(
                "weight",
                "1.0",
                "Weight of the point in the sum of squared errors; default 1. A point of weight 0 is ignored.",
            ),
        ],
    ),
    (
        "shape[]",
        &[
            Key::new("kind", r#""circle""#, "Kind of shape: line, circle, polyline, text or svg."),
            Key::new("start", "[-0.03, 0.0, 0.15]", "First end of a line: x, y, z in m."),
            Key::new("end", "[0.03, 0.0, 0.15]", "Second end of a line: x, y, z in m."),
            Key::new("center", "[0.0, 0.0, 0.15]", "Center of a circle: x, y, z in m."),
            Key::new("radius", "0.03", "Radius of a circle in m."),
            Key::new("normal", "[0.0, 0.0, 1.0]", "Normal of a circle's plane; default +z."),
            Key::new(
                "points",
                "[[-0.03, 0.0, 0.15], [0.03, 0.0, 0.15], [0.0, 0.03, 0.15]]",
                "Corners of a polyline: x, y, z of each in m.",
            ),
            Key::new("closed", "true", "Whether a polyline returns to its first corner; default false."),
            Key::new("string", r#""hi""#, "Characters of a text."),
            Key::new("height", "0.03", "Height of a capital H of a text, in m."),
            Key::new("font", r#""DejaVu Sans""#, "Font of a text; default DejaVu Sans."),
            Key::new("file", r#""logo.svg""#, "File of an svg, relative to the scene file."),
            Key::new("size", "0.08", "Longer side of an svg in m."),
            Key::new("z", "0.15", "Height z of the plane of a text or svg, in m."),
            Key::new("step", "0.002", "Distance between neighbouring points in m; default 2.125e-3."),
            Key::new("pressure", "500.0", "Requested pressure of each point in Pa."),
            Key::new("weight", "1.0", "Weight of each point; default 1."),
        ],
    ),
    (
        "image[]",
        &[
            Key::new("file", r#""logo.png""#, "File of the picture, relative to the scene file."),
            Key::new("size", "0.08", "Longer side of the picture in m."),
            Key::new("z", "0.15", "Height z of the picture's plane in m."),
            Key::new(
                "pixels",
                "18",
                "Number of pixels along the longer side; by default they are half a wavelength at 40 kHz apart.",
            ),
            Key::new("pressure", "500.0", "Requested pressure of white pixels in Pa; default 1000."),
            Key::new("quiet", "true", "Whether dark pixels become quiet points; default false."),
            Key::new("weight", "1.0", "Weight of each point; default 1."),
        ],
    ),
    ("obstacles[]", Obstacle::PARTS),
    (
        "obstacles[]",
        &[
            Key::new("kind", r#""rigid""#, "Boundary condition of the surface: rigid or soft; default rigid."),
            Key::new(
                "vertices",
                "[[0.0, 0.0, 0.1], [0.01, 0.0, 0.1], [0.0, 0.01, 0.1], [0.0, 0.0, 0.11]]",
                "Of a mesh: x, y, z of each vertex in m.",
            ),
            Key::new(
                "faces",
                "[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]",
                "Of a mesh: for each triangle, the indices of its three vertices.",
            ),
            Key::new(
                "file",
                r#""hand.stl""#,
                "Of a mesh: its file, relative to the scene file, instead of vertices and faces.",
            ),
            Key::new("scale", "1e-3", "Of a mesh's file: length of its unit in m."),
            Key::new("offset", "[0.0, 0.0, 0.1]", "Of a mesh's file: position of its origin in m."),
            Key::new(
                "rotation",
                "[0.0, 0.0, 1.5708]",
                "Of a mesh's file: rotation about its origin, as axis times angle in rad, quaternion w, x, y, z, or matrix.",
            ),
            Key::new("up", r#""y""#, "Of a mesh's file: its axis that becomes z; default y for .glb, else z."),
        ],
    ),
    (
        "motion",
        &[
            Key::new("rate", "10e3", "Number of frames per second."),
            Key::new(
                "change",
                "0.19635",
                "Largest change of a phase from one frame to the next, in rad; default pi/16.",
            ),
            Key::new("change_rate", "2000.0", "Largest change of a phase in rad/s, instead of `change`."),
            Key::new("tau", "0.15e-3", "Time constant of the transducers' amplitudes in s."),
            Key::new("closed", "true", r#"Whether the last frame continues to the first; needs ahead = "all"."#),
            Key::new(
                "ahead",
                "4",
                r#"Number of following frames with which each frame is chosen together, 0 or more; or "all"."#,
            ),
            Key::new(
                "path",
                r#"[{"kind": "circle", "center": [0.0, 0.0, 0.15], "radius": 0.02, "frequency": 25.0}]"#,
                "Points that move at the same time, one table for each path.",
            ),
            Key::new(
                "file",
                r#""points.npy""#,
                "File of the points, instead of `path`: .npy (T, M, 3) in m, or CSV with the columns frame, point, x, y, z.",
            ),
        ],
    ),
    (
        "motion.path[]",
        &[
            Key::new(
                "kind",
                r#""circle""#,
                "circle, line, polyline, lissajous, still, svg or morph. The other keys are those of `midair.path`.",
            ),
            Key::new("center", "[0.0, 0.0, 0.15]", "Center of a circle or lissajous: x, y, z in m."),
            Key::new("radius", "0.02", "Radius of a circle in m."),
            Key::new("start", "[-0.03, 0.0, 0.15]", "First end of a line: x, y, z in m."),
            Key::new("end", "[0.03, 0.0, 0.15]", "Second end of a line: x, y, z in m."),
            Key::new(
                "corners",
                "[[-0.03, 0.0, 0.15], [0.03, 0.0, 0.15], [0.0, 0.03, 0.15]]",
                "Corners of a polyline: x, y, z of each in m.",
            ),
            Key::new("places", "[[0.0, 0.0, 0.15]]", "Positions of the points of a still: x, y, z of each in m."),
            Key::new("size", "[0.04, 0.02]", "Width and height of a lissajous in m; or longer side of an svg in m."),
            Key::new("ratio", "[3, 2]", "Numbers of periods of a lissajous along x and along y, both whole."),
            Key::new("file", r#""logo.svg""#, "File of an svg, relative to the scene file."),
            Key::new("z", "0.15", "Height z of the plane of an svg, in m."),
            Key::new(
                "from_points",
                "[[-0.02, 0.0, 0.15], [0.02, 0.0, 0.15]]",
                "Positions at the start of a morph: x, y, z of each point in m.",
            ),
            Key::new(
                "to_points",
                "[[0.0, -0.02, 0.15], [0.0, 0.02, 0.15]]",
                "Positions at the end of a morph: x, y, z of each point in m.",
            ),
            Key::new("speed", "4.0", "Speed in m/s; or give `frequency`."),
            Key::new("frequency", "25.0", "Number of rounds per second; or give `speed`."),
            Key::new("turns", "1.0", "Number of turns on a circle; default 1."),
            Key::new("start_angle", "0.0", "Angle in rad at which a circle starts; default 0."),
            Key::new("phase", "1.57", "Phase of the motion of a lissajous along x, in rad; default pi/2."),
            Key::new("normal", "[0.0, 0.0, 1.0]", "Normal of a circle's plane; default +z."),
            Key::new("points", "3", "Number of points on a circle, evenly spaced; default 1."),
            Key::new("there_and_back", "true", "Whether the point returns to the start of a line; default false."),
            Key::new("closed", "true", "Whether a polyline returns to its first corner; default false."),
            Key::new("duration", "0.5", "Duration of a still or morph in s; a morph may have a speed instead."),
            Key::new("pressure", "500.0", "Requested pressure of each point in Pa; by default the balanced level."),
            Key::new(
                "pressures",
                "[500.0, 300.0]",
                "Requested pressures in Pa, one for all points or one for each; by default the balanced level.",
            ),
            Key::new("am", r#"{"frequency": 200.0, "shape": "sqrt"}"#, "Amplitude modulation of the pressure."),
        ],
    ),
    (
        "motion.path[].am",
        &[
            Key::new("frequency", "200.0", "Frequency of the modulation in Hz."),
            Key::new("shape", r#""sqrt""#, "Shape of the modulation: sqrt, cosine or square; default sqrt."),
            Key::new("depth", "1.0", "Depth of the modulation, 0 to 1; default 1."),
            Key::new(
                "samples",
                "[1.0, 0.5, 0.0, 0.5]",
                "Samples of a modulation, 0 to 1, instead of frequency and shape.",
            ),
            Key::new("samples_rate", "800.0", "Samples per second; they repeat."),
        ],
    ),
    (
        "solver",
        &[
            Key::new("name", r#""greedy""#, "Name of the method; `midair solvers` lists the names."),
            Key::new(
                "balance",
                "true",
                "Whether to solve at the level that the array can reach and then to reduce the drives.",
            ),
            Key::new(
                "aim",
                r#""max""#,
                "target: the requested pressures; max: the highest pressures that the array can reach.",
            ),
        ],
    ),
    (
        "plane",
        &[
            Key::new("z", "0.15", "Height z in m of a plane normal to z."),
            Key::new("axis", r#""y""#, "Axis to which the plane is normal: x, y or z."),
            Key::new("at", "0.0", "Position of the plane on this axis in m."),
            Key::new("size", "0.1", "Side of the square in m."),
            Key::new("pixels", "200", "Number of pixels along a side; default 200."),
            Key::new("center", "[0.0, 0.0]", "Center of the square in m: (x, y), (x, z) or (y, z)."),
        ],
    ),
];

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
