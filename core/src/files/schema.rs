//! The keys of a scene file, each with a value as it may be written, for errors that show a correct line.

use alloc::format;
use alloc::string::String;

use crate::files::source::Format;

/// A table's path, and its keys with an example in JSON.
type Table = (&'static str, &'static [(&'static str, &'static str)]);

const TABLES: &[Table] = &[
    (
        "",
        &[
            ("medium", r#"{"frequency": 40e3}"#),
            ("array", r#"{"preset": "autd3"}"#),
            ("points", r#"[{"position": [0.0, 0.0, 0.15]}]"#),
            ("shape", r#"[{"kind": "circle", "center": [0.0, 0.0, 0.15], "radius": 0.03}]"#),
            ("image", r#"[{"file": "logo.png", "size": 0.08, "z": 0.15, "pixels": 18}]"#),
            ("obstacles", r#"[{"point": [0.1, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]}]"#),
            ("signature", r#""trap""#),
            ("motion", r#"{"rate": 10e3}"#),
            ("solver", r#"{"name": "greedy"}"#),
            ("plane", r#"{"z": 0.15}"#),
            ("version", r#""1.0""#),
            ("status", r#""done""#),
        ],
    ),
    (
        "medium",
        &[
            ("frequency", "40e3"),
            ("sound_speed", "340.0"),
            ("temperature", "25.0"),
            ("absorption", "0.15"),
            ("density", "1.2"),
        ],
    ),
    (
        "array",
        &[
            ("grid", r#"{"nx": 20, "ny": 20, "pitch": 10e-3}"#),
            ("preset", r#""autd3""#),
            ("tiles", "[2, 2]"),
            ("positions", "[[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]"),
            ("normals", "[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]"),
            ("source_pressure", "4.386"),
            ("directivity", r#"{"piston": 4.5e-3}"#),
            ("response", "[[1.0, 0.0], [0.5, -0.2]]"),
            ("mask", "[true, false]"),
            ("quantization", r#"{"phases": 256}"#),
        ],
    ),
    ("array.grid", &[("nx", "20"), ("ny", "20"), ("pitch", "10e-3")]),
    ("array.positions", &[("file", r#""bowl.csv""#)]),
    ("array.quantization", &[("phases", "256"), ("amplitudes", "[0.0, 0.5, 1.0]")]),
    ("points[]", &[("position", "[0.0, 0.0, 0.15]"), ("pressure", "500.0"), ("phase", "1.57"), ("weight", "1.0")]),
    (
        "shape[]",
        &[
            ("kind", r#""circle""#),
            ("start", "[-0.03, 0.0, 0.15]"),
            ("end", "[0.03, 0.0, 0.15]"),
            ("center", "[0.0, 0.0, 0.15]"),
            ("radius", "0.03"),
            ("normal", "[0.0, 0.0, 1.0]"),
            ("points", "[[-0.03, 0.0, 0.15], [0.03, 0.0, 0.15], [0.0, 0.03, 0.15]]"),
            ("closed", "true"),
            ("string", r#""hi""#),
            ("height", "0.03"),
            ("font", r#""DejaVu Sans""#),
            ("file", r#""logo.svg""#),
            ("size", "0.08"),
            ("z", "0.15"),
            ("step", "0.002"),
            ("pressure", "500.0"),
            ("weight", "1.0"),
        ],
    ),
    (
        "image[]",
        &[
            ("file", r#""logo.png""#),
            ("size", "0.08"),
            ("z", "0.15"),
            ("pixels", "18"),
            ("pressure", "500.0"),
            ("quiet", "true"),
            ("weight", "1.0"),
        ],
    ),
    (
        "obstacles[]",
        &[
            ("kind", r#""rigid""#),
            ("point", "[0.1, 0.0, 0.0]"),
            ("normal", "[-1.0, 0.0, 0.0]"),
            ("center", "[0.0, 0.0, 0.1]"),
            ("radius", "0.02"),
            ("vertices", "[[0.0, 0.0, 0.1], [0.01, 0.0, 0.1], [0.0, 0.01, 0.1], [0.0, 0.0, 0.11]]"),
            ("faces", "[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]"),
            ("file", r#""hand.stl""#),
            ("scale", "1e-3"),
            ("offset", "[0.0, 0.0, 0.1]"),
        ],
    ),
    (
        "motion",
        &[
            ("rate", "10e3"),
            ("change", "0.19635"),
            ("change_rate", "2000.0"),
            ("tau", "0.15e-3"),
            ("closed", "true"),
            ("ahead", "4"),
            ("path", r#"[{"kind": "circle", "center": [0.0, 0.0, 0.15], "radius": 0.02, "frequency": 25.0}]"#),
            ("file", r#""points.npy""#),
        ],
    ),
    (
        "motion.path[]",
        &[
            ("kind", r#""circle""#),
            ("center", "[0.0, 0.0, 0.15]"),
            ("radius", "0.02"),
            ("start", "[-0.03, 0.0, 0.15]"),
            ("end", "[0.03, 0.0, 0.15]"),
            ("corners", "[[-0.03, 0.0, 0.15], [0.03, 0.0, 0.15], [0.0, 0.03, 0.15]]"),
            ("size", "[0.04, 0.02]"),
            ("ratio", "[3, 2]"),
            ("file", r#""logo.svg""#),
            ("z", "0.15"),
            ("from_points", "[[-0.02, 0.0, 0.15], [0.02, 0.0, 0.15]]"),
            ("to_points", "[[0.0, -0.02, 0.15], [0.0, 0.02, 0.15]]"),
            ("speed", "4.0"),
            ("frequency", "25.0"),
            ("turns", "1.0"),
            ("start_angle", "0.0"),
            ("phase", "1.57"),
            ("normal", "[0.0, 0.0, 1.0]"),
            ("points", "3"),
            ("there_and_back", "true"),
            ("closed", "true"),
            ("duration", "0.5"),
            ("pressure", "500.0"),
            ("pressures", "[500.0, 300.0]"),
            ("am", r#"{"frequency": 200.0, "shape": "sqrt"}"#),
        ],
    ),
    ("motion.path[].am", &[("frequency", "200.0"), ("shape", r#""sqrt""#), ("depth", "1.0")]),
    ("solver", &[("name", r#""greedy""#), ("balance", "true"), ("aim", r#""max""#)]),
    (
        "plane",
        &[
            ("z", "0.15"),
            ("axis", r#""y""#),
            ("at", "0.0"),
            ("size", "0.1"),
            ("pixels", "200"),
            ("center", "[0.0, 0.0]"),
        ],
    ),
];

/// Names that keys had before, or that hands write for them.
const FORMER: &[(&str, &str, &str)] = &[
    ("array", "levels", "quantization"),
    ("solver", "level", "aim"),
    ("plane", "resolution", "pixels"),
    ("shape[]", "centre", "center"),
    ("shape[]", "text", "string"),
    ("shape[]", "path", "file"),
    ("image[]", "path", "file"),
];

/// The key that was once called so.
pub(super) fn renamed(table: &str, key: &str) -> Option<&'static str> {
    FORMER.iter().find(|(at, former, _)| is(at, &pattern(table)) && *former == key).map(|(.., now)| *now)
}

/// The keys of a table: `medium`, `points[3]`.
pub(super) fn keys(table: &str) -> impl Iterator<Item = &'static str> + Clone {
    rows(&pattern(table)).iter().map(|(key, _)| *key)
}

/// A correct line for the key at a path, or for the nearest one around it.
pub(super) fn example(path: &str, format: Format) -> Option<String> {
    let path = pattern(path);
    let mut path = path.trim_end_matches("[]");
    loop {
        let (table, key) = path.rsplit_once('.').unwrap_or(("", path));
        if let Some((key, json)) = rows(table).iter().find(|(known, _)| *known == key) {
            return Some(line(table, key, json, format));
        }
        path = table.trim_end_matches("[]");
        if path.is_empty() {
            return None;
        }
    }
}

/// A correct line for a key of whatever table has it.
pub(super) fn example_of_key(key: &str, format: Format) -> Option<String> {
    let table = TABLES.iter().find(|(_, rows)| rows.iter().any(|(known, _)| *known == key))?.0;
    example(&if table.is_empty() { key.into() } else { format!("{table}.{key}") }, format)
}

/// A key and its value as the format writes them.
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

fn rows(pattern: &str) -> &'static [(&'static str, &'static str)] {
    TABLES.iter().find(|(path, _)| is(path, pattern)).map_or(&[], |(_, rows)| rows)
}

/// Whether tables of the schema are meant by a pattern: `shape[]` by a lone `shape`, too.
fn is(path: &str, pattern: &str) -> bool {
    path == pattern || path.strip_suffix("[]") == Some(pattern)
}

/// A path without its indices: `points[3].pressure` as `points[].pressure`.
fn pattern(path: &str) -> String {
    let mut within = false;
    path.chars()
        .filter(|&letter| {
            within = (within && letter != ']') || letter == '[';
            !within || letter == '['
        })
        .collect()
}
