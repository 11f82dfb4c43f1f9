//! Tables `[shape]`: converts lines, circles and polylines to points. The caller draws texts and drawings.

use crate::files::fault::Fault;
use crate::files::item::Item;
use crate::files::kind::{self, Kind};
use crate::files::node::Node;
use crate::points::{Curve, STEP};
use crate::prelude::*;
use crate::scene::Request;

const KINDS: [Kind; 5] = [
    ("line", &["start", "end"], &[]),
    ("circle", &["center", "radius"], &["normal"]),
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
pub fn read_shape(table: &Node) -> Result<Vec<[f64; 3]>, Error> {
    let item = Item { path: "shape".into(), node: table };
    let made = shape(&item).map_err(|fault| fault.bare("shape"))?;
    made.map(|(points, _)| points).ok_or_else(|| Error::invalid("kind", "text or svg", "give line, circle or polyline"))
}

/// Returns the points of a shape; `None` for texts and drawings.
pub(super) fn shape(item: &Item<'_>) -> Result<Option<Made>, Fault> {
    let (kind, table) = kind::of(item, &KINDS, &["step", "pressure", "weight"])?;
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
    let step = table.read("step", Item::real)?.unwrap_or(STEP);
    let points = curve.and_then(|curve| curve.points(step)).map_err(|error| item.reported(error))?;
    let all = |key: &str| table.read(key, |value| Ok(vec![value.least_zero()?; points.len()]));
    let request = Request { pressures: all("pressure")?, phases: None, weights: all("weight")? };
    Ok(Some((points, request)))
}
