//! What is wrong with a scene file is told in one line: its name, the place, the item, and a line as it would be correct.

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

const GRID: &str = "grid = { nx = 4, ny = 3, pitch = 10e-3 }";

/// Words of the libraries underneath, which say nothing to somebody with a scene file.
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

/// `WHOLE` with one part replaced.
fn with(part: &str, other: &str) -> String {
    assert!(WHOLE.contains(part), "{part}");
    WHOLE.replacen(part, other, 1)
}

/// Documents, what each is refused with, and the line that is shown for a correct one.
fn check(cases: &[(String, &str, &str)], format: Format) {
    let source = Source { name: "my scene", folder: None };
    let wrong = cases.iter().filter_map(|(text, told, example)| {
        let error = read_from(text.as_bytes(), format, source).expect_err(text).to_string();
        let shown = error.split_once("; for example ").map_or("", |(_, line)| line);
        let one_line = error.starts_with("my scene") && !error.contains('\n') && error.len() < 500;
        let own_words = !FOREIGN.iter().any(|word| error.contains(word));
        let good = one_line && own_words && error.contains(told) && shown == *example;
        (!good).then(|| format!("{error}\n  should say {told}\n  and show {example}"))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn toml_is_refused_by_line_column_item_and_cure() {
    check(
        &[
            // Keys.
            (
                with("density = 1.2", "densty = 1.2"),
                ", line 6, column 1: unknown key of medium \"densty\": did you mean density? known are frequency, sound_speed",
                "density = 1.2",
            ),
            (
                with("pitch", "pich"),
                ", line 9, column 26: unknown key of array.grid \"pich\": did you mean pitch?",
                "pitch = 10e-3",
            ),
            (
                with("weight = 2.0", "wait = 2.0"),
                ", line 20, column 1: unknown key of points[1] \"wait\": known are position",
                "",
            ),
            (with("[plane]", "[plain]"), "unknown key \"plain\": did you mean plane?", "[plane] and under it z = 0.15"),
            (
                with("source_pressure", "levels"),
                "unknown key of array \"levels\": it is called quantization; known",
                "quantization = { phases = 256 }",
            ),
            (
                with("pressure = 250.0", "pressures = 250.0"),
                "line 19, column 1: unknown key of points[1] \"pressures\": did you mean pressure?",
                "pressure = 500.0",
            ),
            (
                with("density = 1.2", "density = 1.2\ndensity = 1.3"),
                ", line 7, column 1: the key \"density\" is written twice: keep one",
                "density = 1.2",
            ),
            (
                with("[plane]", "[array]"),
                "the key \"array\" is written twice",
                "[array] and under it preset = \"autd3\"",
            ),
            (
                with("position = [0.01, 0, 0.15]\n", ""),
                ", line 17, column 1: points[1].position is left out: give one",
                "position = [0.0, 0.0, 0.15]",
            ),
            (with("name = \"greedy\"\n", ""), ", line 22, column 1: solver.name is left out", "name = \"greedy\""),
            (
                "[[points]]\nposition = [0, 0, 1]".into(),
                ", line 1, column 1: array is left out",
                "[array] and under it preset = \"autd3\"",
            ),
            (
                "[array]\npreset = \"paper20\"".into(),
                ": points is empty",
                "[[points]] and under it position = [0.0, 0.0, 0.15]",
            ),
            (with("nx = 4, ", ""), "line 9, column 8: array.grid.nx is left out", "nx = 20"),
            (
                with("pressure = 250.0\n", ""),
                "line 17, column 1: points[1].pressure is left out: 1 of 2 points have one",
                "pressure = 500.0",
            ),
            // Types and lengths.
            (
                with("pressure = 250.0", "pressure = \"loud\""),
                ", line 19, column 12: points[1].pressure is \"loud\": give a number",
                "pressure = 500.0",
            ),
            (
                with("pressure = 250.0", "pressure = true"),
                "points[1].pressure is true: give a number",
                "pressure = 500.0",
            ),
            (
                with("pressure = 250.0", "pressure = 2020-01-01"),
                "points[1].pressure is \"2020-01-01\": give a number",
                "pressure = 500.0",
            ),
            (
                with("pressure = 250.0", "pressure = {}"),
                "points[1].pressure is an empty table: give a number",
                "pressure = 500.0",
            ),
            (
                with("[0.01, 0, 0.15]", "[0.01, 0]"),
                ", line 18, column 12: points[1].position is [0.01, 0]: give 3 numbers",
                "position = [0.0, 0.0, 0.15]",
            ),
            (
                with("[0.01, 0, 0.15]", "[0.01, 0, 0.15, 1]"),
                "points[1].position is [0.01, 0, 0.15, 1]: give 3 numbers",
                "position = [0.0, 0.0, 0.15]",
            ),
            (
                with("[0.01, 0, 0.15]", "[0.01, \"0\", 0.15]"),
                "points[1].position is a list of 3 values: give 3 numbers",
                "position = [0.0, 0.0, 0.15]",
            ),
            (
                with("{ piston = 4.5e-3 }", "[1]"),
                "array.directivity is [1]: give a name such as",
                "directivity = { piston = 4.5e-3 }",
            ),
            (
                with("{ piston = 4.5e-3 }", "{ piston = 1e-3, cos = 1.0 }"),
                "array.directivity is a table of ",
                "directivity = { piston = 4.5e-3 }",
            ),
            (with("nx = 4", "nx = 4.5"), "array.grid.nx is 4.5: give a whole number", "nx = 20"),
            (with(GRID, "preset = 3"), "array.preset is 3: give a name in quotes", "preset = \"autd3\""),
            (
                with(GRID, "preset = \"autd3\"\ntiles = [1, 1, 1]"),
                ", line 10, column 9: array.tiles is [1, 1, 1]: give 2 numbers",
                "tiles = [2, 2]",
            ),
            (
                with(GRID, "positions = [0, 0, 0]"),
                "array.positions is [0, 0, 0]: give a list of lists of 3 numbers",
                "positions = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]",
            ),
            (
                with(GRID, "positions = [[0, 0, 0], [0, 0]]"),
                ", line 9, column 25: array.positions[1] is [0, 0]",
                "positions = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]",
            ),
            (
                with(GRID, "positions = { fil = \"a.csv\" }"),
                "unknown key of array.positions \"fil\": did you mean file?",
                "file = \"bowl.csv\"",
            ),
            (with(GRID, "positions = {}"), "array.positions.file is left out", "file = \"bowl.csv\""),
            (
                with(GRID, &format!("{GRID}\nmask = [true, 1]")),
                "array.mask[1] is 1: give true or false",
                "mask = [true, false]",
            ),
            (with("[array]", "[[array]]"), "array is [a table of ", "[array] and under it preset = \"autd3\""),
            (
                "[array]\npreset = \"autd3\"\n[points]\nposition = [0, 0, 1]".into(),
                "points is a table of position: give tables, each with a position",
                "[[points]] and under it position = [0.0, 0.0, 0.15]",
            ),
            (
                "points = [[0, 0, 1]]\n[array]\npreset = \"autd3\"".into(),
                ", line 1, column 11: points[0] is [0, 0, 1]: give a table",
                "[[points]] and under it position = [0.0, 0.0, 0.15]",
            ),
            ("array = 3\n[medium]".into(), "array is 3: give a table", "[array] and under it preset = \"autd3\""),
            // Names and options.
            (
                with("\"greedy\"", "\"gredy\""),
                ", line 23, column 8: unknown solver \"gredy\": did you mean greedy? known are uniform",
                "name = \"greedy\"",
            ),
            (
                with(GRID, "preset = \"autd4\""),
                ", line 9, column 10: unknown preset \"autd4\": did you mean autd3?",
                "preset = \"autd3\"",
            ),
            (
                with("{ piston = 4.5e-3 }", "\"pistn\""),
                ", line 11, column 15: unknown directivity \"pistn\": did you mean piston?",
                "directivity = { piston = 4.5e-3 }",
            ),
            (
                with("phases = 32", "phasse = 32"),
                ", line 24, column 1: unknown option of greedy \"phasse\": did you mean phases? known are phases",
                "phases = 16",
            ),
            (
                with("phases = 32", "limit = \"full\""),
                "unknown option of greedy \"limit\": gspat, evd, sdp, tikhonov, naive have it; known are phases",
                "limit = \"clamp\"",
            ),
            (
                with("phases = 32", "level = \"max\""),
                "line 24, column 1: unknown option of greedy \"level\"",
                "aim = \"max\"",
            ),
            (
                with("phases = 32", "phases = [1.5]"),
                "solver.phases is [1.5]: give a number, a word or a list of whole numbers",
                "phases = 16",
            ),
            (with("phases = 32", "phases = 1"), ", line 24, column 10: phases is 1: give 2 to 65536", "phases = 16"),
            (
                with("phases = 32", "phases = 100000000000000000000000000000000000000000000000000"),
                "a number too large",
                "phases = 256",
            ),
            (with("phases = 32", "phases = 18446744073709551615"), "phases is 18446744073709551615", "phases = 16"),
            (with("phases = 32", "phases = 100000000000000000000"), "phases is 100000000000000000000", "phases = 16"),
            (with("phases = 32", "phases = 2.5"), "phases is 2.5", "phases = 16"),
            (with("phases = 32", "amplitudes = 257"), "amplitudes is 257", "amplitudes = 1"),
            (with("phases = 32", "seed = -1"), "seed is -1", "seed = 0"),
            (with("\"rows\"", "[0, -1]"), "order is [0, -1]", "order = \"random\""),
            (with("\"rows\"", "\"diagonal\""), "line 25, column 9: order is \"diagonal\"", "order = \"random\""),
            (with("balance = true", "balance = 1"), "solver.balance is 1", "balance = true"),
            // Values, which the core refuses by its own items.
            (
                with("pressure = 250.0", "pressure = nan"),
                "line 19, column 12: points[1].pressure is NaN",
                "pressure = 500.0",
            ),
            (with("pressure = 250.0", "pressure = -1"), "points[1].pressure is -1", "pressure = 500.0"),
            (with("weight = 2.0", "weight = inf"), "line 20, column 10: points[1].weight is inf", "weight = 1.0"),
            (
                with("[0.01, 0, 0.15]", "[0.01, inf, 0.15]"),
                "line 18, column 12: points[1].position is [0.01, inf, 0.15]",
                "position = [0.0, 0.0, 0.15]",
            ),
            (
                with("density = 1.2", "temperature = 20"),
                "line 6, column 15: medium.temperature is 20",
                "temperature = 25.0",
            ),
            (with("frequency = 40e3", "frequency = 0"), "line 3, column 13: medium.frequency is 0", "frequency = 40e3"),
            (with("sound_speed = 340", "sound_speed = -340"), "medium.sound_speed is -340", "sound_speed = 340.0"),
            (with("absorption = 0.15", "absorption = -0.1"), "medium.absorption is -0.1", "absorption = 0.15"),
            (
                with("{ piston = 4.5e-3 }", "{ piston = 0 }"),
                "line 11, column 26: directivity.piston is 0.0",
                "directivity = { piston = 4.5e-3 }",
            ),
            (
                with(GRID, "preset = \"autd3\"\ngrid = { nx = 1, ny = 1, pitch = 1 }"),
                "line 8, column 1: array is described 2 times",
                "[array] and under it preset = \"autd3\"",
            ),
            (with(GRID, ""), "array is described 0 times", "[array] and under it preset = \"autd3\""),
            (
                with(GRID, &format!("{GRID}\ntiles = [1, 1]")),
                "array.tiles is given: tiles go with a preset",
                "tiles = [2, 2]",
            ),
            (with("nx = 4", "nx = 0"), "line 9, column 15: array.grid.nx is 0", "nx = 20"),
            (with("nx = 4", "nx = -3"), "array.grid.nx is -3: give at least 1", "nx = 20"),
            (
                with("nx = 4", "nx = 4000000"),
                "give at most 1048576 transducers",
                "grid = { nx = 20, ny = 20, pitch = 10e-3 }",
            ),
            (with("pitch = 10e-3", "pitch = 0"), "array.grid.pitch is 0", "pitch = 10e-3"),
            (with(GRID, "preset = \"autd3\"\ntiles = [0, 1]"), "array.tiles[0] is 0", "tiles = [2, 2]"),
            (with(GRID, "preset = \"paper20\"\ntiles = [2, 1]"), "array.tiles[0] is 2", "tiles = [2, 2]"),
            (
                with(GRID, "preset = \"autd3\"\ntiles = [1.5, 1]"),
                "array.tiles is [1.5, 1]: give two whole numbers",
                "tiles = [2, 2]",
            ),
            (
                with(GRID, "positions = []"),
                "array.positions is empty",
                "positions = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]",
            ),
            (
                with(GRID, "positions = [[0, 0, 0]]\nnormals = []"),
                "array.normals is 0 normals",
                "normals = [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]",
            ),
            (
                with(GRID, "positions = [[0, 0, 0]]\nnormals = [[0, 0, 0]]"),
                "line 10, column 12: array.normals[0] is [0.0, 0.0, 0.0]",
                "normals = [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]",
            ),
            (
                with(GRID, &format!("{GRID}\nresponse = [[1, 0]]")),
                "array.response is 1 values",
                "response = [[1.0, 0.0], [0.5, -0.2]]",
            ),
            (
                with(GRID, &format!("{GRID}\nquantization = {{ phases = 99999999999 }}")),
                "array.quantization.phases is 99999999999: give 2 to 65536",
                "phases = 256",
            ),
            (with("size = 0.1", "size = 0"), "plane.size is 0", "size = 0.1"),
            (with("size = 0.1", "pixels = 1"), "plane.pixels is 1", "pixels = 200"),
            (with("size = 0.1", "pixels = -1"), "plane.pixels is -1", "pixels = 200"),
            (
                with("pressure = 500", "pressure = 0").replace("pressure = 250.0", "pressure = 0"),
                "line 15, column 12: pressures is all 0: give at least one point (of weight above 0) a pressure above 0 Pa",
                "pressure = 500.0",
            ),
            // What is no TOML.
            ("[array".into(), ", line 1, column ", "[array] and under it preset = \"autd3\""),
            (with("pressure = 250.0", "pressure 250.0"), ", line 19, column ", "pressure = 500.0"),
            (
                with("name = \"greedy\"", "name = greedy"),
                ", line 23, column 8: no TOML here (string values must be quoted)",
                "name = \"greedy\"",
            ),
            (with("pressure = 250.0", "pressure = "), ", line 19, column ", "pressure = 500.0"),
            (
                with("[0.01, 0, 0.15]", "[0.01, 0, 0.15"),
                ", line 19, column 1: no TOML here (missing comma",
                "pressure = 500.0",
            ),
            (with("[0.01, 0, 0.15]", "0.01, 0, 0.15"), ", line 18, column ", "position = [0.0, 0.0, 0.15]"),
            (format!("position = {}", "[".repeat(100_000)), "nested too deep", "position = [0.0, 0.0, 0.15]"),
            (format!("{}\n", "a.".repeat(50_000)), "", "[array] and under it preset = \"autd3\""),
            (
                "{\"array\": {}}".into(),
                "line 1, column 1: no TOML, but JSON as it looks",
                "[array] and under it preset = \"autd3\"",
            ),
            ("position\r= 3".into(), "line 1", "position = [0.0, 0.0, 0.15]"),
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
                "\"pressure\": 500.0",
            ),
            (quiet("\"pressure\": [null]"), "points[0].pressure is [null]: give a number", "\"pressure\": 500.0"),
            (
                quiet("\"presure\": 3"),
                ", line 2, column 39: unknown key of points[0] \"presure\": did you mean pressure?",
                "\"pressure\": 500.0",
            ),
            (quiet("\"pressure\": NaN"), ", line 2, column 5", "\"pressure\": 500.0"),
            (quiet("\"pressure\": 1e999"), "no JSON here (a number that JSON does not know", "\"pressure\": 500.0"),
            (quiet("\"pressure\": 1,"), "no JSON here (a comma before a closing bracket)", "\"pressure\": 500.0"),
            (quiet("pressure: 1"), "no JSON here (a key without double quotes)", "\"position\": [0.0, 0.0, 0.15]"),
            (quiet("\"pressure\" 1"), "no JSON here (a colon is missing", "\"pressure\": 500.0"),
            (
                quiet("\"pressure\": 1 \"weight\": 1"),
                "no JSON here (a comma or a closing bracket is missing)",
                "\"pressure\": 500.0",
            ),
            (
                quiet("\"pressure\": 1, \"pressure\": 2"),
                "the key \"pressure\" is written twice: keep one of them",
                "\"pressure\": 500.0",
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
            (
                "{".into(),
                ", line 1, column 1: no JSON here (the text ends before its last bracket",
                "\"array\": {\"preset\": \"autd3\"}",
            ),
            ("[]".into(), "the document is []: give a table", ""),
            ("3".into(), "the document is 3: give a table", ""),
            (WHOLE.into(), ", line 2, column 2: no JSON", "\"array\": {\"preset\": \"autd3\"}"),
            ("[".repeat(100_000), "nested too deep", "\"array\": {\"preset\": \"autd3\"}"),
            (
                format!("{{{}\"a\": 1}}", (0..1000).map(|k| format!("\"k{k}\": 1,")).collect::<String>()),
                "more keys than a scene file knows",
                "\"array\": {\"preset\": \"autd3\"}",
            ),
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
