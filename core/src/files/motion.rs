//! Scene files with moving points: the table `[motion]` instead of `[[points]]`, besides array, medium and solver.

use crate::files::drawn;
use crate::files::item::{Fault, Item, Read, Table};
use crate::files::{Draw, Format, Node, Source, frames, path, place, read};
use crate::kernels::InstructionSet;
use crate::points::Path;
use crate::prelude::*;
use crate::scene::{Request, Scene};
use crate::session::{Moving, Pace, Trajectory, sight};

/// The contents of a document with `[motion]`.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Motion {
    /// The scene without the motion; its points are those of the first frame.
    pub scene: Scene,
    /// All paths of the document at the same time, or the path through the frames of its file.
    pub path: Path,
    /// The rate of frames and the bound of phases.
    pub pace: Pace,
    /// The number of later frames with which each frame is chosen together; `None` for all.
    pub ahead: Option<usize>,
    document: Document,
}

/// The text of a document and its name, for the places of errors.
#[derive(Clone, Debug)]
struct Document {
    text: String,
    format: Format,
    name: String,
}

impl Motion {
    /// Returns the frames, to be solved one after another.
    ///
    /// # Errors
    /// Frames that are chosen together with later ones, which only the Python package can solve; the errors of
    /// [`Moving::new`].
    pub fn moving(&self, set: InstructionSet) -> Result<Moving> {
        if self.ahead != Some(0) {
            let value = self.ahead.map_or_else(|| String::from("\"all\""), |frames| frames.to_string());
            let cure = "midair's Python package solves frames together: leave it out here";
            return Err(self.located(Error::conflict("ahead", value, cure)));
        }
        let frames = Trajectory::of(&self.path, self.pace.rate)?;
        Moving::new(self.scene.clone(), frames, self.pace, self.ahead, set)
    }

    /// Returns an error about a key of `[motion]`, such as `rate`, with its place in the document; `None` for an error about
    /// anything else.
    pub fn placed(&self, error: &Error) -> Option<Error> {
        let Document { text, format, .. } = &self.document;
        place::whole(text, *format, &format!("motion.{}", error.item)).map(|_| self.located(error.clone()))
    }

    fn located(&self, error: Error) -> Error {
        let Document { text, format, name } = &self.document;
        let path = format!("motion.{}", error.item);
        Fault::at(path.as_str(), error.about(path.as_str())).reported(text, *format, Source { name, folder: None })
    }
}

/// The tables with points that do not move.
const RESTING: [&str; 3] = ["points", "shape", "image"];

/// Reads the motion of a document; `None` if it has no `[motion]`.
pub(super) fn motion(
    text: &str,
    node: &Node,
    format: Format,
    source: Source<'_>,
    draw: &mut Draw<'_>,
) -> Read<Option<Motion>> {
    if node.get("motion").is_none() {
        return Ok(None);
    }
    let root = Item::root(node).table()?;
    if let Some(item) = RESTING.iter().find_map(|name| root.get(name)) {
        return Err(item.refused("points that move stand in [motion]: leave it out"));
    }
    let item = root.need("motion")?;
    let table = item.table()?;
    let (about, real) = (|error| item.reported(error), |key: &str| table.read(key, Item::real));
    let pace = Pace {
        rate: table.need("rate")?.real()?,
        change: real("change")?,
        change_rate: real("change_rate")?,
        tau: real("tau")?,
        closed: table.read("closed", Item::flag)?,
    };
    pace.bound().map_err(about)?;
    let ahead = table.read("ahead", read::value)?;
    let ahead = sight(ahead.as_ref(), pace.closed == Some(true)).map_err(about)?;
    let path = together(&item, &table, pace, source, draw)?;
    pace.fits(&path).map_err(about)?;
    let points = path.moments(0.0).map(|moment| moment.place).collect();
    let scene = read::at(&root, points, Request::default(), source, draw)?;
    let document = Document { text: text.into(), format, name: source.name.into() };
    Ok(Some(Motion { scene, path, pace, ahead, document }))
}

/// Returns the path through the frames of a file, or all paths at the same time.
fn together(item: &Item<'_>, table: &Table<'_>, pace: Pace, source: Source<'_>, draw: &mut Draw<'_>) -> Read<Path> {
    match (table.get("file"), table.get("path")) {
        (Some(file), None) => {
            let name = file.text()?;
            let (points, count) = frames::read(name, source).map_err(|error| Fault::at(file.path.as_str(), error))?;
            Path::through(points, count, pace.rate, pace.closed == Some(true), None)
                .map_err(|error| item.reported(error))
        }
        (None, Some(paths)) => {
            let mut all: Option<Path> = None;
            for item in drawn::tables_of(paths)? {
                let next = path::path(&item, draw)?;
                let joined = all.map_or(Ok(next.clone()), |before| before.beside(&next));
                all = Some(joined.map_err(|error| item.reported(error))?);
            }
            all.ok_or_else(|| item.refused("give [[motion.path]] tables, each with a kind"))
        }
        (Some(file), Some(_)) => Err(file.refused("[[motion.path]] is given, too: give one of them")),
        (None, None) => {
            let cure = "give [[motion.path]] tables, each with a kind, or a file";
            Err(Fault::at("motion", Error::missing("motion.path", "left out", cure)))
        }
    }
}
