//! Scene files of moving points: the table `[motion]` instead of `[[points]]`, besides array, medium and solver.

use alloc::format;
use alloc::vec::Vec;

use crate::error::Error;
use crate::files::drawn::{self, Draw, Drawing};
use crate::files::fault::Fault;
use crate::files::item::{Item, Table};
use crate::files::node::Node;
use crate::files::read;
use crate::files::source::Source;
use crate::scene::{Options, Request, Scene, Value};

/// The contents of a document with `[motion]`.
#[derive(Clone, Debug)]
#[allow(clippy::exhaustive_structs, reason = "the two parts of a document")]
pub struct Motion {
    /// The scene without the motion; its points are those of the first frame.
    pub scene: Scene,
    /// The keys of `[motion]` except `path` and `file`, as `midair.sequence` takes them: `rate`, `change`, `ahead`, ...
    pub settings: Options,
}

/// The tables with points that do not move.
const RESTING: [&str; 3] = ["points", "shape", "image"];

/// Reads the motion of a document; `None` if it has no `[motion]`.
pub(super) fn motion(document: &Node, source: Source<'_>, draw: &mut Draw<'_>) -> Result<Option<Motion>, Fault> {
    if document.get("motion").is_none() {
        return Ok(None);
    }
    let root = Item::root(document).table()?;
    if let Some(item) = RESTING.iter().find_map(|name| root.get(name)) {
        return Err(item.refused("points that move stand in [motion]: leave it out"));
    }
    let table = root.need("motion")?.table()?;
    let points = points(&table, draw)?;
    table.need("rate")?;
    let mut settings = Options::new();
    for (key, node) in table.entries.iter().filter(|(_, node)| *node != Node::Null) {
        let item = Item { path: format!("motion.{key}"), node };
        let value = match key.as_str() {
            "path" | "file" => continue,
            "closed" | "ahead" => read::value(&item)?,
            _ => Value::Real(item.real()?),
        };
        settings.insert(key.clone(), value);
    }
    let scene = read::at(&root, points, Request::default(), source, draw)?;
    Ok(Some(Motion { scene, settings }))
}

/// The points of the first frame, from the file or from all paths.
fn points(table: &Table<'_>, draw: &mut Draw<'_>) -> Result<Vec<[f64; 3]>, Fault> {
    match (table.get("file"), table.get("path")) {
        (Some(file), None) => match draw("motion.file", file.text()?) {
            Ok(Drawing::Points(points, _)) => Ok(points),
            Ok(Drawing::Mesh(..)) => Err(file.refused("it is drawn as a mesh: points are wanted")),
            Err(error) => Err(file.reported(error)),
        },
        (None, Some(path)) => {
            let drawn = drawn::each("motion.path", path, draw)?;
            Ok(drawn.into_iter().flat_map(|path| path.points).collect())
        }
        (Some(file), Some(_)) => Err(file.refused("[[motion.path]] is given, too: give one of them")),
        (None, None) => {
            let cure = "give [[motion.path]] tables, each with a kind, or a file";
            Err(Fault::at("motion", Error::missing("motion.path", "left out", cure)))
        }
    }
}
