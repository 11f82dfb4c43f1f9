//! Sweep files: the keys of a document of many scenes, beside those of an array, a medium and a solver.

use crate::files::fault::Fault;
use crate::files::item::Item;
use crate::files::node::Node;

/// A table's path, and its keys with an example in JSON.
const TABLES: &[(&str, &[(&str, &str)])] = &[
    (
        "",
        &[
            ("seed", "0"),
            ("seeds", "100"),
            ("scenes", r#"["a.toml", "b.json"]"#),
            ("array", r#"{"preset": "autd3"}"#),
            ("medium", r#"{"temperature": 25.0}"#),
            ("points", r#"{"count": 8, "x": [-0.08, 0.08], "y": [-0.06, 0.06], "z": 0.15}"#),
            ("axes", r#"{"medium.temperature": [15.0, 25.0]}"#),
            ("solver", r#"[{"name": "greedy"}]"#),
        ],
    ),
    (
        "points",
        &[
            ("count", "8"),
            ("x", "[-0.08, 0.08]"),
            ("y", "[-0.06, 0.06]"),
            ("z", "[0.1, 0.15]"),
            ("positions", "[[0.0, 0.0, 0.15], [0.02, 0.0, 0.15]]"),
            ("pressures", "[500.0, 800.0]"),
            ("weights", "[1.0, 2.0]"),
            ("pressure", "[800.0, 1200.0]"),
            ("shift", "[0.02, 0.0, 0.0]"),
        ],
    ),
];

/// The keys of a table of sweep files: `points`, or the whole file by an empty name.
pub fn sweep_keys(table: &str) -> impl Iterator<Item = &'static str> {
    TABLES.iter().filter(move |(path, _)| *path == table).flat_map(|(_, keys)| keys.iter().map(|(key, _)| *key))
}

/// Refuses a key that no sweep has.
pub(super) fn check(document: &Node) -> Result<(), Fault> {
    let known = |table: &str| sweep_keys(table).collect::<alloc::vec::Vec<_>>();
    let root = Item::root(document).table_of(&known(""))?;
    for name in ["array", "medium", "points"] {
        let Some(item) = root.get(name) else { continue };
        match item.node {
            Node::List(_) => drop(item.each(|one| one.table().map(drop), "give a table, or several")?),
            Node::Table(_) if name == "points" => drop(item.table_of(&known(name))?),
            _ => drop(item.table()?),
        }
    }
    Ok(())
}
