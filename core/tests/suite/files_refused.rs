//! Tests of errors in scene files: each is one line with file, place, item, and a correct line as an example.

use midair::files::{Format, MOST_BYTES, Source, read, read_from};

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

/// Words of messages from the parsing libraries, which do not help a user with a scene file.
const FOREIGN: [&str; 14] = [
    "serde",
    "expected",
    "invalid type",
    "invalid value",
    "invalid length",
    "missing field",
    "unknown field",
    "unknown variant",
    "untagged",
    "duplicate",
    "deserializ",
    "recurs",
    "EOF",
    "$__",
];

/// Returns `WHOLE` with one part replaced.
fn with(part: &str, other: &str) -> String {
    assert!(WHOLE.contains(part), "{part}");
    WHOLE.replacen(part, other, 1)
}

/// Checks the cases: a document, its error, and the example of a correct line.
fn check(cases: &[(String, impl AsRef<str>, impl AsRef<str>)], format: Format) {
    let source = Source { name: "my scene", folder: None };
    let wrong = cases.iter().filter_map(|(text, reported, example)| {
        let (reported, example) = (reported.as_ref(), example.as_ref());
        let error = read_from(text.as_bytes(), format, source).expect_err(text).to_string();
        let shown = error.split_once("; for example ").map_or("", |(_, line)| line);
        let one_line = error.starts_with("my scene") && !error.contains('\n') && error.len() < 500;
        let own_words = !FOREIGN.iter().any(|word| error.contains(word));
        let good = one_line && own_words && error.contains(reported) && shown == example;
        (!good).then(|| format!("{error}\n  should say {reported}\n  and show {example}"))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_slip_of_the_pen_is_refused_by_line_column_item_and_cure() {
    let table = include_str!("files_refused.txt").replace("\\n", "\r");
    let cases = table.lines().skip(1).map(|line| {
        let fields: Vec<String> = line.split(" | ").map(|field| field.replace('\r', "\n")).collect();
        let [part, other, code, reported, example] = &fields[..] else { panic!("{line}") };
        let text = with(part, other);
        let error = read(text.as_bytes(), Format::Toml).expect_err(&text);
        assert_eq!(error.code.name(), code, "{error}");
        (text, reported.clone(), if example == "-" { String::new() } else { example.clone() })
    });
    let cases: Vec<_> = cases.collect();
    assert!(cases.len() > 70);
    check(&cases, Format::Toml);
}

#[test]
fn what_is_no_scene_in_toml_is_refused_by_line_column_item_and_cure() {
    let array = "[array] and under it preset = \"autd3\"";
    let points = "[[points]] and under it position = [0.0, 0.0, 0.15]";
    let position = "position = [0.0, 0.0, 0.15]";
    let quiet = with("pressure = 500", "pressure = 0").replace("pressure = 250.0", "pressure = 0");
    check(
        &[
            ("[[points]]\nposition = [0, 0, 1]".into(), ", line 1, column 1: array is left out", array),
            ("[array]\npreset = \"paper20\"".into(), ": points is empty", points),
            (
                "[array]\npreset = \"autd3\"\n[points]\nposition = [0, 0, 1]".into(),
                "points is a table of position",
                points,
            ),
            (
                "points = [[0, 0, 1]]\n[array]\npreset = \"autd3\"".into(),
                ", line 1, column 11: points[0] is [0, 0, 1]",
                points,
            ),
            ("array = 3\n[medium]".into(), "array is 3: give a table", array),
            (quiet, "line 15, column 12: pressures is all 0: give at least one point", "pressure = 500.0"),
            ("[array".into(), ", line 1, column ", array),
            (format!("position = {}", "[".repeat(100_000)), "nested too deep", position),
            (format!("{}\n", "a.".repeat(50_000)), "", array),
            ("{\"array\": {}}".into(), "line 1, column 1: no TOML, but JSON as it looks", array),
            ("position\r= 3".into(), "line 1", position),
        ],
        Format::Toml,
    );
}

#[test]
fn json_is_refused_by_line_column_item_and_cure() {
    let scene = |array: &str, point: &str| format!("{{\"array\": {{{array}}},\n \"points\": [{{{point}}}]}}");
    let preset = "\"preset\": \"paper20\"";
    let position = "\"position\": [0, 0, 0.1]";
    let quiet = |more: &str| scene(preset, &format!("{position}, {more}"));
    let many: String = (0..1000).map(|k| ["\"k", &k.to_string(), "\": 1,"].concat()).collect();
    let array = "\"array\": {\"preset\": \"autd3\"}";
    let pressure = "\"pressure\": 500.0";
    check(
        &[
            (
                "{\"array\": {\"preset\": \"paper20\"},\n \"point\": []}".into(),
                ", line 2, column 2: unknown key \"point\": did you mean points?",
                "\"points\": [{\"position\": [0.0, 0.0, 0.15]}]",
            ),
            (
                quiet("\"pressure\": \"loud\""),
                ", line 2, column 51: points[0].pressure is \"loud\": give a number",
                pressure,
            ),
            (quiet("\"pressure\": [null]"), "points[0].pressure is [null]: give a number", pressure),
            (
                quiet("\"presure\": 3"),
                ", line 2, column 39: unknown key of points[0] \"presure\": did you mean pressure?",
                pressure,
            ),
            (quiet("\"pressure\": NaN"), ", line 2, column 51: no JSON here (a value is missing", pressure),
            (
                quiet("\"pressure\": 1e999"),
                ", line 2, column 51: a number too large for any computer: give fewer digits",
                pressure,
            ),
            (
                quiet("\"pressure\": 1."),
                ", line 2, column 51: no JSON here (a number that JSON does not know",
                pressure,
            ),
            (quiet("\"pressure\": 1,"), "no JSON here (a comma before a closing bracket)", pressure),
            (quiet("pressure: 1"), "no JSON here (a key without double quotes)", "\"position\": [0.0, 0.0, 0.15]"),
            (quiet("\"pressure\" 1"), "no JSON here (a colon is missing", pressure),
            (
                quiet("\"pressure\": 1 \"weight\": 1"),
                "no JSON here (a comma or a closing bracket is missing)",
                pressure,
            ),
            (
                quiet("\"pressure\": 1, \"pressure\": 2"),
                "the key \"pressure\" is written twice: keep one of them",
                pressure,
            ),
            (
                scene("\"grid\": {\"nx\": 3, \"ny\": 1e30, \"pitch\": 1}", position),
                ", line 1, column 36: array.grid.ny is 1e30: give a whole number",
                "\"ny\": 20",
            ),
            (
                scene("\"grid\": {\"nx\": 99999999999999999999, \"ny\": 1, \"pitch\": 1}", position),
                "array.grid.nx is 1e20: give a whole number",
                "\"nx\": 20",
            ),
            (
                scene("\"positions\": {\"file\": \"a.csv\"}", position),
                "array.positions.file is \"a.csv\": this document has no folder",
                "\"file\": \"bowl.csv\"",
            ),
            ("{".into(), ", line 1, column 1: no JSON here (the text ends before its last bracket", array),
            ("[]".into(), "the document is []: give a table", ""),
            ("3".into(), "the document is 3: give a table", ""),
            (WHOLE.into(), ", line 2, column 2: no JSON", array),
            ("[".repeat(100_000), "nested too deep", array),
            (format!("{}1", "{\"a\": ".repeat(100_000)), "nested too deep", array),
            (
                "{\"array\": {\"preset\": \"paper20\"},\n \"array\": {}}".into(),
                ", line 2, column 2: the key \"array\" is written twice",
                "\"preset\": \"autd3\"",
            ),
            (
                scene(preset, position) + "\n]",
                ", line 3, column 1: no JSON here (text after the end of the table)",
                "\"position\": [0.0, 0.0, 0.15]",
            ),
            (format!("{{{many}\"a\": 1}}"), "more keys than a scene file knows", array),
            (quiet("\"a\nb\": 1"), "a line break or tab within quotes", "\"position\": [0.0, 0.0, 0.15]"),
            (quiet("\"a\\nb\": 1"), "unknown key of points[0] \"a b\"", ""),
        ],
        Format::Json,
    );
}

#[test]
fn what_is_no_text_or_too_much_of_it_is_refused() {
    let refused = |bytes: &[u8]| read(bytes, Format::Toml).unwrap_err().to_string();
    assert!(refused(&[0x80, 0x81, 0x00, 0x80]).contains("UTF-16, or binary"));
    assert!(refused(b"a = \"\x80\"").contains("not text"));
    let json = read(b"{\"a\": \"\xff\"}", Format::Json).unwrap_err().to_string();
    assert!(json.contains("not text: give TOML or JSON in UTF-8"), "{json}");
    for endian in [u16::to_le_bytes, u16::to_be_bytes] {
        let wide = |text: &str| text.encode_utf16().flat_map(endian).collect::<Vec<u8>>();
        for text in [format!("\u{feff}{WHOLE}"), WHOLE.to_owned()] {
            assert!(refused(&wide(&text)).contains("in UTF-16, or binary: save it as UTF-8"), "{text}");
        }
    }
    for empty in ["", " \n\t\n", "\u{feff}"] {
        assert!(refused(empty.as_bytes()).contains("empty: it needs at least [array] and [[points]]"));
    }
    let large = read(&vec![b' '; MOST_BYTES + 1], Format::Json).unwrap_err().to_string();
    assert!(large.contains("64 MB"), "{large}");
}

#[test]
fn byte_order_marks_and_line_ends_change_nothing() {
    let scene = read(WHOLE.as_bytes(), Format::Toml).expect("a scene");
    for text in [format!("\u{feff}{WHOLE}"), WHOLE.replace('\n', "\r\n")] {
        assert_eq!(Format::of_text(text.as_bytes()), Format::Toml);
        assert_eq!(read(text.as_bytes(), Format::Toml).expect("a scene"), scene);
    }
    let json = "\u{feff} {\"array\": {\"preset\": \"paper20\"},\r\n \"points\": [{\"position\": [0, 0, 0.1], \"weight\": null}]}";
    assert_eq!(Format::of_text(json.as_bytes()), Format::Json);
    assert_eq!(read(json.as_bytes(), Format::Json).expect("a scene").request().weights, None);
}
