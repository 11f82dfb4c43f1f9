//! Tables that a binding draws: text, drawings and pictures as points, an obstacle's file as a mesh.
//!
//! The core knows nothing of fonts, drawings, pictures and models.

use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

use crate::files::fault::Fault;
use crate::files::item::{Item, Table};
use crate::files::node::Node;
use crate::files::shape::shape;
use crate::files::write;
use crate::scene::Request;

/// The curve or picture that a table describes.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::exhaustive_enums, reason = "what the tables of a scene file stand for")]
pub enum Drawing {
    /// Of `shape` and `image`: points (M, 3) in m and their targets. Of `motion`: the points of the first frame.
    Points(Vec<[f64; 3]>, Request),
    /// Of `obstacles`: vertices (V, 3) in m and faces (F, 3).
    Mesh(Vec<[f64; 3]>, Vec<[u32; 3]>),
}

/// Draws a table by its name, `shape` (of text and drawings), `image`, `obstacles` or `motion.path`, and its keys as TOML; `motion.file` by the
/// file's name.
///
/// A refusal is one line, `radius is -0.03: give a number above 0`; for a key it gets the key's place.
pub type Draw<'a> = dyn FnMut(&str, &str) -> Result<Drawing, String> + 'a;

/// The tables, in the order in which their points follow those of the document.
const NAMES: [&str; 2] = ["shape", "image"];

/// The points of one table, and its path in the document.
pub(super) struct Drawn {
    pub(super) path: String,
    pub(super) points: Vec<[f64; 3]>,
    pub(super) request: Request,
}

/// Tables that draw nothing.
pub(super) fn undrawn(_name: &str, _text: &str) -> Result<Drawing, String> {
    Err("midair's Python package draws it: load the file there and save the scene, which lists what it stands for"
        .into())
}

/// Each such table of a document, and its obstacles.
pub(super) fn tables(document: &Node) -> impl Iterator<Item = &Node> {
    NAMES.iter().chain(&["obstacles"]).filter_map(|name| document.get(name)).flat_map(|node| match node {
        Node::List(list) => list.as_slice(),
        single => core::slice::from_ref(single),
    })
}

/// The points of each such table.
pub(super) fn drawn(root: &Table<'_>, draw: &mut Draw<'_>) -> Result<Vec<Drawn>, Fault> {
    let mut found = Vec::new();
    for name in NAMES {
        let Some(item) = root.get(name) else { continue };
        found.extend(each(name, item, draw)?);
    }
    Ok(found)
}

/// The points of a table, or of each of several.
pub(super) fn each(name: &str, item: Item<'_>, draw: &mut Draw<'_>) -> Result<Vec<Drawn>, Fault> {
    let items = match item.node {
        Node::Table(_) => vec![item],
        _ => item.each(|one| Ok(Item { path: one.path.clone(), node: one.node }), "give a table, or several")?,
    };
    let drawn = items.into_iter().map(|item| match one(name, &item, draw)? {
        Drawing::Points(points, request) => Ok(Drawn { path: item.path, points, request }),
        Drawing::Mesh(..) => Err(item.refused("it is drawn as a mesh: points are wanted")),
    });
    drawn.collect()
}

/// Vertices (V, 3) in m and faces (F, 3).
type Surface = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// The mesh of an obstacle's table.
pub(super) fn mesh(item: &Item<'_>, draw: &mut Draw<'_>) -> Result<Surface, Fault> {
    match one("obstacles", item, draw)? {
        Drawing::Mesh(vertices, faces) => Ok((vertices, faces)),
        Drawing::Points(..) => Err(item.refused("it is drawn as points: a mesh is wanted")),
    }
}

fn one(name: &str, item: &Item<'_>, draw: &mut Draw<'_>) -> Result<Drawing, Fault> {
    item.table()?;
    if name == "shape"
        && let Some((points, request)) = shape(item)?
    {
        return Ok(Drawing::Points(points, request));
    }
    let mut text = String::new();
    write::toml("", item.node, &mut text).ok_or_else(|| item.refused("give numbers, words and lists of them"))?;
    draw(name, &text).map_err(|refusal| item.reported(&refusal))
}
