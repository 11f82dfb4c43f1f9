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
            Key::new("medium", r#"{"frequency": 40e3}"#, "The air."),
            Key::new("array", r#"{"preset": "autd3"}"#, "The transducers: exactly one of grid, preset and positions."),
            Key::new("points", r#"[{"position": [0.0, 0.0, 0.15]}]"#, "Control points, one table each."),
            Key::new(
                "shape",
                r#"[{"kind": "circle", "center": [0.0, 0.0, 0.15], "radius": 0.03}]"#,
                "Points along a line, circle or polyline; along text and drawings by the Python package.",
            ),
            Key::new(
                "image",
                r#"[{"file": "logo.png", "size": 0.08, "z": 0.15, "pixels": 18}]"#,
                "Points of a picture; by the Python package.",
            ),
            Key::new(
                "obstacles",
                r#"[{"point": [0.1, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]}]"#,
                "What the waves meet: a wall, a ball or a mesh each.",
            ),
            Key::new(
                "signature",
                r#""trap""#,
                "Foci are turned into traps: trap, twin or vortex; or of each point one of them or focus.",
            ),
            Key::new("bead", r#"{"radius": 1e-3}"#, "What traps are made for; left out expanded polystyrene."),
            Key::new("motion", r#"{"rate": 10e3}"#, "Points that move, in place of points; of `midair motion` alone."),
            Key::new("solver", r#"{"name": "greedy"}"#, "The method where none is named, with its options."),
            Key::new("plane", r#"{"z": 0.15}"#, "Where pictures are taken; left out, it follows the points."),
            Key::new("version", r#""1.0""#, "Of midair, in results; read and ignored."),
            Key::new("status", r#""done""#, "How the solve ended, in results; read and ignored."),
        ],
    ),
    ("medium", Medium::KEYS),
    ("bead", Bead::KEYS),
    (
        "array",
        &[
            Key::new("grid", r#"{"nx": 20, "ny": 20, "pitch": 10e-3}"#, "A flat grid, centred in z = 0, x fastest."),
            Key::new("preset", r#""autd3""#, "An array by its name: `midair presets` lists them."),
            Key::new("tiles", "[2, 2]", "Boards along x and y, with a preset."),
            Key::new("positions", "[[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]", "m, a place each; or a CSV file of them."),
            Key::new(
                "normals",
                "[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]",
                "Directions, one each, with positions; left out +z.",
            ),
        ],
    ),
    ("array", Array::PART_KEYS),
    (
        "array.grid",
        &[
            Key::new("nx", "20", "Transducers along x."),
            Key::new("ny", "20", "Transducers along y."),
            Key::new("pitch", "10e-3", "m between neighbours."),
        ],
    ),
    (
        "array.positions",
        &[Key::new(
            "file",
            r#""bowl.csv""#,
            "CSV with a row x, y, z or x, y, z, nx, ny, nz in m, beside the scene file.",
        )],
    ),
    (
        "array.quantization",
        &[
            Key::new("phases", "256", "How many phases, evenly spaced, 2 to 65536."),
            Key::new("amplitudes", "[0.0, 0.5, 1.0]", "The amplitudes, 0 to 1."),
            Key::new("pulses", "[1.0, 1.0, 1.0, 1.0]", "Lengths of a period's ticks, of a board of pulses alone."),
        ],
    ),
    (
        "points[]",
        &[
            Key::new("position", "[0.0, 0.0, 0.15]", "x, y, z in m."),
            Key::new("pressure", "500.0", "Pa, peak; 0 is a quiet point. On every point or on none."),
            Key::new("phase", "1.57", "rad, for the methods that use phases; left out 0."),
            Key::new("weight", "1.0", "Multiplies the point's term; left out 1, 0 takes no part."),
        ],
    ),
    (
        "shape[]",
        &[
            Key::new("kind", r#""circle""#, "line, circle, polyline, text or svg."),
            Key::new("start", "[-0.03, 0.0, 0.15]", "Of a line: x, y, z in m."),
            Key::new("end", "[0.03, 0.0, 0.15]", "Of a line: x, y, z in m."),
            Key::new("center", "[0.0, 0.0, 0.15]", "Of a circle: x, y, z in m."),
            Key::new("radius", "0.03", "Of a circle, m."),
            Key::new("normal", "[0.0, 0.0, 1.0]", "Of a circle's plane; left out +z."),
            Key::new(
                "points",
                "[[-0.03, 0.0, 0.15], [0.03, 0.0, 0.15], [0.0, 0.03, 0.15]]",
                "Corners of a polyline, m.",
            ),
            Key::new("closed", "true", "Whether a polyline ends where it begins; left out false."),
            Key::new("string", r#""hi""#, "Of a text: what is written."),
            Key::new("height", "0.03", "Of a text: that of a capital H, m."),
            Key::new("font", r#""DejaVu Sans""#, "Of a text: the font's name; left out DejaVu Sans."),
            Key::new("file", r#""logo.svg""#, "Of an svg: its file, beside the scene file."),
            Key::new("size", "0.08", "Of an svg: the longer side, m."),
            Key::new("z", "0.15", "Of a text or svg: its plane, m."),
            Key::new("step", "0.002", "m between neighbours; left out 2.125e-3."),
            Key::new("pressure", "500.0", "Pa, of each point."),
            Key::new("weight", "1.0", "Of each point."),
        ],
    ),
    (
        "image[]",
        &[
            Key::new("file", r#""logo.png""#, "A picture, beside the scene file."),
            Key::new("size", "0.08", "The longer side, m."),
            Key::new("z", "0.15", "Its plane, m."),
            Key::new("pixels", "18", "Along the longer side; left out, half a wavelength at 40 kHz apart."),
            Key::new("pressure", "500.0", "Pa, of white; left out 1000."),
            Key::new("quiet", "true", "Whether dark pixels are quiet points; left out false."),
            Key::new("weight", "1.0", "Of each point."),
        ],
    ),
    ("obstacles[]", Obstacle::PARTS),
    (
        "obstacles[]",
        &[
            Key::new("kind", r#""rigid""#, "rigid or soft; left out rigid."),
            Key::new(
                "vertices",
                "[[0.0, 0.0, 0.1], [0.01, 0.0, 0.1], [0.0, 0.01, 0.1], [0.0, 0.0, 0.11]]",
                "Of a mesh: places in m.",
            ),
            Key::new(
                "faces",
                "[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]",
                "Of a mesh: three indices of vertices each.",
            ),
            Key::new("file", r#""hand.stl""#, "Of a mesh: its file, beside the scene file."),
            Key::new("scale", "1e-3", "Of a mesh's file: m for one of its units."),
            Key::new("offset", "[0.0, 0.0, 0.1]", "Of a mesh's file: where its origin goes, m."),
        ],
    ),
    (
        "motion",
        &[
            Key::new("rate", "10e3", "Frames a second."),
            Key::new("change", "0.19635", "Most that a phase may change, rad a frame; left out pi/16."),
            Key::new("change_rate", "2000.0", "The same in rad/s."),
            Key::new("tau", "0.15e-3", "Time constant of the transducers' envelopes, s."),
            Key::new("closed", "true", r#"Whether the last frame leads to the first; needs ahead = "all"."#),
            Key::new("ahead", "4", r#"Frames known ahead: 0, a number of them, or "all"."#),
            Key::new(
                "path",
                r#"[{"kind": "circle", "center": [0.0, 0.0, 0.15], "radius": 0.02, "frequency": 25.0}]"#,
                "Points that move at the same time, one table each.",
            ),
            Key::new(
                "file",
                r#""points.npy""#,
                "Frames instead: .npy (T, M, 3) in m, or CSV with the columns frame, point, x, y, z.",
            ),
        ],
    ),
    (
        "motion.path[]",
        &[
            Key::new(
                "kind",
                r#""circle""#,
                "circle, line, polyline, lissajous, still, svg or morph; the other keys are those of `midair.path`.",
            ),
            Key::new("center", "[0.0, 0.0, 0.15]", "Of a circle or lissajous, m."),
            Key::new("radius", "0.02", "Of a circle, m."),
            Key::new("start", "[-0.03, 0.0, 0.15]", "Of a line, m."),
            Key::new("end", "[0.03, 0.0, 0.15]", "Of a line, m."),
            Key::new("corners", "[[-0.03, 0.0, 0.15], [0.03, 0.0, 0.15], [0.0, 0.03, 0.15]]", "Of a polyline, m."),
            Key::new("places", "[[0.0, 0.0, 0.15]]", "Of a still, m."),
            Key::new("size", "[0.04, 0.02]", "Of a lissajous, two widths in m; of an svg, its longer side in m."),
            Key::new("ratio", "[3, 2]", "Of a lissajous: whole numbers of turns."),
            Key::new("file", r#""logo.svg""#, "Of an svg, beside the scene file."),
            Key::new("z", "0.15", "Of an svg, m."),
            Key::new("from_points", "[[-0.02, 0.0, 0.15], [0.02, 0.0, 0.15]]", "Of a morph, m."),
            Key::new("to_points", "[[0.0, -0.02, 0.15], [0.0, 0.02, 0.15]]", "Of a morph, m."),
            Key::new("speed", "4.0", "m/s; or frequency."),
            Key::new("frequency", "25.0", "Rounds a second; or speed."),
            Key::new("turns", "1.0", "Of a circle."),
            Key::new("start_angle", "0.0", "Of a circle, rad."),
            Key::new("phase", "1.57", "Of a lissajous, rad; left out pi/2."),
            Key::new("normal", "[0.0, 0.0, 1.0]", "Of a circle; left out +z."),
            Key::new("points", "3", "Of a circle: how many, evenly spaced."),
            Key::new("there_and_back", "true", "Of a line."),
            Key::new("closed", "true", "Of a polyline: back to its first corner."),
            Key::new("duration", "0.5", "Of a still or a morph, s; of a morph, or speed."),
            Key::new("pressure", "500.0", "Pa; left out, balanced."),
            Key::new("pressures", "[500.0, 300.0]", "Pa, one for all or one for each point; left out, balanced."),
            Key::new("am", r#"{"frequency": 200.0, "shape": "sqrt"}"#, "Amplitude modulation."),
        ],
    ),
    (
        "motion.path[].am",
        &[
            Key::new("frequency", "200.0", "Hz."),
            Key::new("shape", r#""sqrt""#, "sqrt, cosine or square; left out sqrt."),
            Key::new("depth", "1.0", "0 to 1; left out 1."),
        ],
    ),
    (
        "solver",
        &[
            Key::new("name", r#""greedy""#, "`midair solvers` lists them."),
            Key::new("balance", "true", "Solve at the level the array can reach and reduce the drives afterwards."),
            Key::new("aim", r#""max""#, "target: as loud as requested; max: as loud as the array can."),
        ],
    ),
    (
        "plane",
        &[
            Key::new("z", "0.15", "m: a plane normal to z."),
            Key::new("axis", r#""y""#, "x, y or z: the plane is normal to it."),
            Key::new("at", "0.0", "m: where it crosses that axis."),
            Key::new("size", "0.1", "Of the square, m."),
            Key::new("pixels", "200", "Along a side; left out 200."),
            Key::new("center", "[0.0, 0.0]", "Of the square, m: (x, y), (x, z) or (y, z)."),
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

/// All tables of a scene file: path and keys. A list of tables has a path such as `points[]`; a table may occur more than once,
/// with other keys.
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

/// Whether the path of a table in the schema fits a pattern. `shape[]` also fits a single `shape`, and `array` one of several.
fn is(path: &str, pattern: &str) -> bool {
    path.trim_end_matches("[]") == pattern.trim_end_matches("[]")
}

/// Removes the indices from a path: `points[3].pressure` becomes `points[].pressure`.
fn pattern(path: &str) -> String {
    let mut within = false;
    path.chars()
        .filter(|&letter| {
            within = (within && letter != ']') || letter == '[';
            !within || letter == '['
        })
        .collect()
}
