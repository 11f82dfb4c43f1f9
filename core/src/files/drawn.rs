//! Drawn: tables `[shape]` as points, and those that a binding converts: texts, drawings, pictures, meshes and arrays.
//!
//! The core has no code for fonts, drawings, pictures and 3D models.

use crate::files::item::{Item, Kind, Read, Table, of_kind};
use crate::files::{Node, write};
use crate::points::{Curve, MOST, STEP};
use crate::prelude::*;
use crate::scene::{Array, Request};

/// The result of drawing a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Drawing {
    /// The points (M, 3) in m and the targets of a table `shape` or `image`.
    Points(Vec<[f64; 3]>, Request),
    /// The mesh of a table of `obstacles`: vertices (V, 3) in m and faces (F, 3).
    Mesh(Vec<[f64; 3]>, Vec<[u32; 3]>),
    /// The corners (K, 3) in m of the outline that a point of a `motion.path` follows, and whether it is closed.
    Outline(Vec<[f64; 3]>, bool),
    /// The array in the file of `array.positions`, whose format the core does not read.
    Array(Array),
}

/// A function that draws a table. Its first argument is the table's name: `shape` (of texts and drawings), `image`,
/// `obstacles`, `motion.path` (of drawings) or `array.positions` (of formats other than tables). Its second argument contains the table's keys as TOML.
///
/// If the item of an error is a key of the table, the place of that key in the document is added.
pub type Draw<'a> = dyn FnMut(&str, &str) -> Result<Drawing> + 'a;

/// The tables with points. Their points follow those of `points` in this order.
const NAMES: [&str; 2] = ["shape", "image"];

/// The points of one table, and the table's path in the document.
pub(super) struct Drawn {
    pub(super) path: String,
    pub(super) points: Vec<[f64; 3]>,
    pub(super) request: Request,
}

/// The drawing function of callers that cannot draw: always an error.
pub(super) fn undrawn(_name: &str, _text: &str) -> Result<Drawing> {
    let cure = "load the file there and save the scene, which lists what it stands for";
    Err(Error::missing("", "midair's Python package draws it", cure))
}

/// The tables in a document that may need a drawing function: shapes, images and obstacles.
pub(super) fn tables(document: &Node) -> impl Iterator<Item = &Node> {
    NAMES.iter().chain(&["obstacles", "points"]).filter_map(|name| document.get(name)).flat_map(|node| match node {
        Node::List(list) => list.as_slice(),
        single => core::slice::from_ref(single),
    })
}

/// Draws all tables of shapes and images.
pub(super) fn drawn(root: &Table<'_>, draw: &mut Draw<'_>) -> Read<Vec<Drawn>> {
    let mut drawings = Vec::new();
    for name in NAMES {
        let Some(item) = root.get(name) else { continue };
        drawings.extend(each(name, item, draw)?);
    }
    Ok(drawings)
}

/// Returns a table, or each of a list of tables.
pub(super) fn tables_of(item: Item<'_>) -> Read<Vec<Item<'_>>> {
    match item.node {
        Node::Table(_) => Ok(vec![item]),
        _ => item.each(|one| Ok(Item { path: one.path.clone(), node: one.node }), "give a table, or several"),
    }
}

/// Draws a table, or each of a list of tables.
fn each(name: &str, item: Item<'_>, draw: &mut Draw<'_>) -> Read<Vec<Drawn>> {
    let drawn = tables_of(item)?.into_iter().map(|item| match one(name, &item, draw)? {
        Drawing::Points(points, request) => Ok(Drawn { path: item.path, points, request }),
        _ => Err(item.refused("it is drawn as a mesh or an outline: points are wanted")),
    });
    drawn.collect()
}

/// The vertices (V, 3) in m and faces (F, 3) of a mesh.
type Surface = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Draws the mesh of an obstacle's table.
pub(super) fn mesh(item: &Item<'_>, draw: &mut Draw<'_>) -> Read<Surface> {
    match one("obstacles", item, draw)? {
        Drawing::Mesh(vertices, faces) => Ok((vertices, faces)),
        _ => Err(item.refused("it is drawn as points or an outline: a mesh is wanted")),
    }
}

/// Draws a table.
pub(super) fn one(name: &str, item: &Item<'_>, draw: &mut Draw<'_>) -> Read<Drawing> {
    item.table()?;
    if name == "shape"
        && let Some((points, request)) = shape(item)?
    {
        return Ok(Drawing::Points(points, request));
    }
    let mut text = String::new();
    write::toml("", item.node, &mut text).ok_or_else(|| item.refused("give numbers, words and lists of them"))?;
    draw(name, &text).map_err(|error| item.reported(error))
}

const KINDS: [Kind; 5] = [
    ("line", &["start", "end"], &[]),
    ("circle", &["center", "radius"], &["normal", "count"]),
    ("polyline", &["points"], &["closed"]),
    ("text", &["string", "height", "z"], &["font"]),
    ("svg", &["file", "size", "z"], &[]),
];

/// The points of a shape and their targets.
type Made = (Vec<[f64; 3]>, Request);

/// Returns the points that a table of a line, circle or polyline describes, without a document around it.
///
/// # Errors
/// Another kind, an unknown key, a wrong value. Errors name the keys alone.
///
/// ```
/// use midair::files::{Node, read_shape};
///
/// let place = |z: f64| Node::Numbers(vec![0.0, 0.0, z]);
/// let line = [("kind", Node::Text("line".into())), ("start", place(0.1)), ("end", place(0.2)), ("step", Node::Real(0.01))];
/// let table = Node::Table(line.map(|(key, value)| (key.into(), value)).into());
/// assert_eq!(read_shape(&table)?.len(), 11);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn read_shape(table: &Node) -> Result<Vec<[f64; 3]>> {
    let item = Item { path: "shape".into(), node: table };
    let made = shape(&item).map_err(|fault| fault.bare("shape"))?;
    made.map(|(points, _)| points).ok_or_else(|| Error::invalid("kind", "text or svg", "give line, circle or polyline"))
}

/// Returns the points of a shape; `None` for texts and drawings.
pub(super) fn shape(item: &Item<'_>) -> Read<Option<Made>> {
    let (kind, table) = of_kind(item, &KINDS, &["step", "pressure", "weight"])?;
    let curve = match kind {
        "line" => Curve::line(table.need("start")?.numbers()?, table.need("end")?.numbers()?, false),
        "circle" => {
            let normal = table.read("normal", Item::numbers)?.unwrap_or([0.0, 0.0, 1.0]);
            Curve::circle(table.need("center")?.numbers()?, table.need("radius")?.real()?, normal, 0.0)
        }
        "polyline" => {
            let closed = table.read("closed", Item::flag)?.unwrap_or_default();
            Curve::lines("points", &table.need("points")?.vectors()?, closed)
        }
        _ => return Ok(None),
    };
    let curve = curve.map_err(|error| item.reported(error))?;
    let step = match (table.read("step", Item::real)?, table.read("count", Item::count)?) {
        (Some(_), Some(count)) => {
            return Err(item.reported(Error::conflict("count", count, "step is given, too: give one of them")));
        }
        (None, Some(count)) if count == 0 || count > MOST => {
            return Err(item.reported(Error::invalid("count", count, format!("give 1 to {MOST}"))));
        }
        (None, Some(count)) => curve.length() / count as f64,
        (step, None) => step.unwrap_or(STEP),
    };
    let points = curve.points(step).map_err(|error| item.reported(error))?;
    let all = |key: &str| table.read(key, |value| Ok(vec![value.least_zero()?; points.len()]));
    let request = Request { pressures: all("pressure")?, phases: None, weights: all("weight")? };
    Ok(Some((points, request)))
}
