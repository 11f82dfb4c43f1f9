//! Sweep files: the keys of a document that describes many scenes.

use alloc::vec::Vec;

use crate::files::fault::Fault;
use crate::files::item::Item;
use crate::files::node::Node;
use crate::scene::Key;

const FILE: &[Key] = &[
    Key::new("seed", "0", "Of all that is random."),
    Key::new("seeds", "100", "How many trials, or a list of their seeds."),
    Key::new(
        "scenes",
        r#"["a.toml", "b.json"]"#,
        "Scene files beside the sweep file, in place of array, medium and points.",
    ),
    Key::new(
        "array",
        r#"{"preset": "autd3"}"#,
        "As in a scene file; several are an axis, as is a list of values of a key.",
    ),
    Key::new("medium", r#"{"temperature": 25.0}"#, "As in a scene file; a list of values of a key is an axis."),
    Key::new(
        "points",
        r#"{"count": 8, "x": [-0.08, 0.08], "y": 0.0, "z": 0.15}"#,
        "Random or fixed points, or as in a scene file.",
    ),
    Key::new(
        "axes",
        r#"{"medium.temperature": [15.0, 25.0]}"#,
        "Keys of array, medium or points with dots, and a list of their values.",
    ),
    Key::new("solver", r#"[{"name": "greedy"}]"#, "Methods; a list of values of an option is an axis."),
];

const POINTS: &[Key] = &[
    Key::new("count", "8", "How many random points; several numbers are an axis."),
    Key::new("x", "[-0.08, 0.08]", "m: a number, or the two ends of the range that it is drawn from."),
    Key::new("y", "[-0.06, 0.06]", "m: a number, or the two ends of the range that it is drawn from."),
    Key::new("z", "[0.1, 0.15]", "m: a number, or the two ends of the range that it is drawn from."),
    Key::new("positions", "[[0.0, 0.0, 0.15], [0.02, 0.0, 0.15]]", "Fixed points x, y, z in m."),
    Key::new("pressures", "[500.0, 800.0]", "Pa, one for each fixed point."),
    Key::new("weights", "[1.0, 2.0]", "One for each fixed point."),
    Key::new("pressure", "[800.0, 1200.0]", "Pa: a number, or the two ends of a range; left out, the balanced level."),
    Key::new("shift", "[0.02, 0.0, 0.0]", "dx, dy, dz in m, added to every point."),
];

/// The tables of a sweep file with other keys than a scene file, by path, and their keys.
#[must_use]
pub fn sweep_tables() -> [(&'static str, &'static [Key]); 2] {
    [("", FILE), ("points", POINTS)]
}

/// Checks that all keys of a sweep are known.
pub(super) fn check(document: &Node) -> Result<(), Fault> {
    let names = |keys: &[Key]| keys.iter().map(|key| key.name).collect::<Vec<_>>();
    let root = Item::root(document).table_of(&names(FILE))?;
    for name in ["array", "medium", "points"] {
        let Some(item) = root.get(name) else { continue };
        match item.node {
            Node::List(_) => drop(item.each(|one| one.table().map(drop), "give a table, or several")?),
            Node::Table(_) if name == "points" => drop(item.table_of(&names(POINTS))?),
            _ => drop(item.table()?),
        }
    }
    Ok(())
}
