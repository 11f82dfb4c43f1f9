//! Sweep files: the keys of a document that describes many scenes.

use crate::files::item::{Item, Read};
use crate::files::node::Node;
use crate::files::schema::key_list;
use crate::prelude::*;
use crate::scene::Key;

const FILE: &[Key] = key_list! {
    /// Seed of all random numbers.
    seed, such as "0";
    /// Number of trials, or a list of their seeds.
    seeds, such as "100";
    /// Scene files, relative to the sweep file, instead of array, medium and points.
    scenes, such as r#"["a.toml", "b.json"]"#;
    /// As in a scene file. Several arrays are an axis of the sweep; so is a list of values of a key.
    array, such as r#"{"preset": "autd3"}"#;
    /// As in a scene file. A list of values of a key is an axis of the sweep.
    medium, such as r#"{"temperature": 25.0}"#;
    /// Random or fixed points, or points as in a scene file.
    points, such as r#"{"count": 8, "x": [-0.08, 0.08], "y": 0.0, "z": 0.15}"#;
    /// Further axes: keys of array, medium or points, written with dots, each with a list of values.
    axes, such as r#"{"medium.temperature": [15.0, 25.0]}"#;
    /// Methods with their options. A list of values of an option is an axis of the sweep.
    solver, such as r#"[{"name": "greedy"}]"#;
};

const POINTS: &[Key] = key_list! {
    /// Number of random points; several numbers are an axis of the sweep.
    count, such as "8";
    /// Coordinate x in m: a number, or the range [low, high] of random numbers.
    x, such as "[-0.08, 0.08]";
    /// Coordinate y in m: a number, or the range [low, high] of random numbers.
    y, such as "[-0.06, 0.06]";
    /// Coordinate z in m: a number, or the range [low, high] of random numbers.
    z, such as "[0.1, 0.15]";
    /// Position x, y, z of each fixed point in m.
    positions, such as "[[0.0, 0.0, 0.15], [0.02, 0.0, 0.15]]";
    /// Requested pressure of each fixed point in Pa.
    pressures, such as "[500.0, 800.0]";
    /// Weight of each fixed point.
    weights, such as "[1.0, 2.0]";
    /// Requested pressure in Pa: a number, or the range [low, high] of random numbers; by default the balanced level.
    pressure, such as "[800.0, 1200.0]";
    /// Displacement dx, dy, dz of all points in m.
    shift, such as "[0.02, 0.0, 0.0]";
};

/// The tables of a sweep file with other keys than a scene file, by path, and their keys.
pub fn sweep_tables() -> [(&'static str, &'static [Key]); 2] {
    [("", FILE), ("points", POINTS)]
}

/// Checks that all keys of a sweep are known.
pub(super) fn check(document: &Node) -> Read<()> {
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
