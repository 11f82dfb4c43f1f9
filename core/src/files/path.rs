//! Tables of paths, `[[motion.path]]`: the kinds of paths, and the points that they move. The caller draws outlines.

use crate::files::drawn::{self, Draw, Drawing};
use crate::files::item::{Item, Kind, Read, Table, of_kind};
use crate::files::node::Node;
use crate::points::{Curve, Modulation, Path, Run};
use crate::prelude::*;

/// The table of a path in a document, which is also that of a path without a document.
const TABLE: &str = "motion.path[0]";

/// The kinds of paths. The functions of the same names in Python's `midair.path` have these arguments.
const KINDS: [Kind; 7] = [
    ("circle", &["center", "radius"], &["speed", "frequency", "turns", "start_angle", "normal", "points"]),
    ("line", &["start", "end"], &["speed", "frequency", "there_and_back"]),
    ("polyline", &["corners"], &["speed", "frequency", "closed"]),
    ("lissajous", &["center", "size", "ratio"], &["phase", "speed", "frequency"]),
    ("still", &["places", "duration"], &[]),
    ("svg", &["file", "size", "z"], &["speed", "frequency"]),
    ("morph", &["from_points", "to_points"], &["duration", "speed"]),
];

/// The keys of all kinds.
const COMMON: [&str; 3] = ["pressure", "pressures", "am"];

/// Returns the path that a table describes, without a document around it.
///
/// # Errors
/// An unknown kind or key, a wrong value. Errors name the keys alone.
///
/// ```
/// use midair::files::{Node, read_path};
///
/// let places = Node::List(vec![Node::Numbers(vec![0.0, 0.0, 0.15])]);
/// let keys = [("kind", Node::Text("still".into())), ("places", places), ("duration", Node::Real(0.1))];
/// let table = Node::Table(keys.map(|(key, value)| (key.into(), value)).into());
/// assert!(read_path(&table, &mut |_, _| Err(midair::Error::missing("", "no drawing", "")))?.closed());
/// # Ok::<(), midair::Error>(())
/// ```
pub fn read_path(table: &Node, draw: &mut Draw<'_>) -> Result<Path> {
    path(&Item { path: TABLE.into(), node: table }, draw).map_err(|fault| fault.bare(TABLE))
}

/// Returns a path with the modulation that a table `am` describes.
///
/// # Errors
/// A wrong modulation, or one that does not fit the path. Errors name the keys alone.
pub fn read_modulated(path: &Path, table: &Node) -> Result<Path> {
    let am = format!("{TABLE}.am");
    modulated(path, &Item { path: am.clone(), node: table }).map_err(|fault| fault.bare(&am))
}

/// Returns the path of a table.
pub(super) fn path(item: &Item<'_>, draw: &mut Draw<'_>) -> Read<Path> {
    let (kind, table) = of_kind(item, &KINDS, &COMMON)?;
    let path = moving(kind, item, &table, draw)?;
    table.get("am").map_or(Ok(path.clone()), |am| modulated(&path, &am))
}

/// Returns a path modulated by a table `am`: by a shape of some frequency, or by samples.
fn modulated(path: &Path, am: &Item<'_>) -> Read<Path> {
    let table = am.table()?;
    let depth = table.read("depth", Item::real)?.unwrap_or(1.0);
    let modulation = if let Some(samples) = table.read("samples", Item::reals)? {
        Modulation::of_samples(samples, table.need("samples_rate")?.real()?, depth)
    } else {
        let shape = table.read("shape", Item::text)?.unwrap_or("sqrt");
        Modulation::new(table.need("frequency")?.real()?, shape, depth)
    };
    modulation.and_then(|by| path.modulated(by)).map_err(|error| am.reported(error))
}

fn moving(kind: &str, item: &Item<'_>, table: &Table<'_>, draw: &mut Draw<'_>) -> Read<Path> {
    let real = |key: &str| table.read(key, Item::real);
    let flag = |key: &str| table.read(key, Item::flag).map(Option::unwrap_or_default);
    let pressures = |entry: Item<'_>| match entry.node {
        Node::Text(_) | Node::Bool(_) | Node::Table(_) => {
            Err(entry.refused("give a number in Pa, or one for each point"))
        }
        single if single.real().is_some() => Ok(Vec::from([entry.real()?])),
        _ => entry.reals(),
    };
    let pressures = table.get("pressure").or(table.get("pressures")).map(pressures).transpose()?;
    let pressures = pressures.as_deref();
    let run = Run {
        speed: real("speed")?,
        frequency: real("frequency")?,
        turns: real("turns")?.unwrap_or(1.0),
        points: table.read("points", Item::count)?.unwrap_or(1),
    };
    let about = |error: Error| item.reported(error);
    let curve = match kind {
        "circle" => {
            let normal = table.read("normal", Item::numbers)?.unwrap_or([0.0, 0.0, 1.0]);
            let (center, radius) = (table.need("center")?.numbers()?, table.need("radius")?.real()?);
            Curve::circle(center, radius, normal, real("start_angle")?.unwrap_or_default())
        }
        "line" => {
            let ends = (table.need("start")?.numbers()?, table.need("end")?.numbers()?);
            Curve::line(ends.0, ends.1, flag("there_and_back")?)
        }
        "polyline" => Curve::lines("corners", &table.need("corners")?.vectors()?, flag("closed")?),
        "lissajous" => {
            let (center, size) = (table.need("center")?.numbers()?, table.need("size")?.numbers()?);
            let phase = real("phase")?.unwrap_or(core::f64::consts::FRAC_PI_2);
            Curve::lissajous(center, size, table.need("ratio")?.numbers()?, phase)
        }
        "still" => {
            let places = table.need("places")?;
            let places = places.numbers().map(|one| Vec::from([one])).or_else(|_| places.vectors())?;
            return Path::still(&places, table.need("duration")?.real()?, pressures).map_err(about);
        }
        "morph" => {
            let (from, to) = (table.need("from_points")?.vectors()?, table.need("to_points")?.vectors()?);
            return Path::morph(&from, &to, real("duration")?, run.speed, pressures).map_err(about);
        }
        _ => match drawn::one("motion.path", item, draw)? {
            Drawing::Outline(corners, closed) => Curve::lines("outline", &corners, closed),
            _ => return Err(item.refused("it is drawn as points or a mesh: an outline is wanted")),
        },
    };
    curve.and_then(|curve| Path::along(curve, run, pressures)).map_err(about)
}
