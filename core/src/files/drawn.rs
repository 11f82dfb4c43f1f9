//! Tables that a door draws as points: `[shape]` and `[image]`, whose fonts, drawings and pictures the core knows nothing of.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec;
use alloc::vec::Vec;

use crate::error::Error;
use crate::files::fault::Fault;
use crate::files::item::{Item, Table};
use crate::files::node::Node;
use crate::files::schema;
use crate::scene::Request;

/// Draws a table by its name, `shape` or `image`, and its keys as TOML: points (M, 3) in m and what is asked of them.
///
/// A refusal is one line, `radius is -0.03: give a number above 0`; that of a key is told with its place.
pub type Draw<'a> = dyn FnMut(&str, &str) -> Result<(Vec<[f64; 3]>, Request), String> + 'a;

/// The tables, in the order in which their points follow those of the document.
const NAMES: [&str; 2] = ["shape", "image"];

/// The points of one table, and its path in the document.
pub(super) struct Drawn {
    pub(super) path: String,
    pub(super) points: Vec<[f64; 3]>,
    pub(super) request: Request,
}

/// What draws nothing.
pub(super) fn undrawn(_name: &str, _text: &str) -> Result<(Vec<[f64; 3]>, Request), String> {
    Err("midair's Python package draws it: load the file there and save the scene, which lists its points".into())
}

/// Each such table of a document.
pub(super) fn tables(document: &Node) -> impl Iterator<Item = &Node> {
    NAMES.iter().filter_map(|name| document.get(name)).flat_map(|node| match node {
        Node::List(list) => list.as_slice(),
        lone => core::slice::from_ref(lone),
    })
}

/// The points of each such table.
pub(super) fn drawn(root: &Table<'_>, draw: &mut Draw<'_>) -> Result<Vec<Drawn>, Fault> {
    let mut found = Vec::new();
    for name in NAMES {
        let Some(item) = root.get(name) else { continue };
        let items = match item.node {
            Node::Table(_) => vec![item],
            _ => item.each(|one| Ok(Item { path: one.path.clone(), node: one.node }), "give a table, or several")?,
        };
        for item in items {
            item.table()?;
            let text = toml::to_string(item.node).map_err(|_| item.refused("give numbers, words and lists of them"))?;
            let (points, request) = draw(name, &text).map_err(|refusal| refused(&item, &refusal))?;
            found.push(Drawn { path: item.path, points, request });
        }
    }
    Ok(found)
}

/// A refusal of a key, told as one of the document's.
fn refused(item: &Item<'_>, refusal: &str) -> Fault {
    let parts = refusal.split_once(" is ").and_then(|(key, rest)| Some((key, rest.split_once(": ")?)));
    match parts.filter(|(key, _)| schema::keys(&item.path).any(|known| known == *key)) {
        Some((key, (value, cure))) => {
            let path = format!("{}.{key}", item.path);
            Fault::at(path.as_str(), Error::invalid(path.as_str(), value, cure))
        }
        None => Fault::at(item.path.as_str(), Error::invalid(item.path.as_str(), item.node, refusal.to_string())),
    }
}
