//! Scene files in TOML or JSON, read and written for all bindings.

mod csv;
mod drawn;
mod drive;
mod frames;
mod item;
mod json;
mod motion;
mod node;
mod npy;
mod path;
mod place;
mod positions;
mod read;
mod schema;
mod source;
mod sweep;
mod syntax;
mod tables;
mod toml;
mod write;

pub use csv::{Columns, Table, length, read_table};
pub use drawn::{Draw, Drawing, read_shape};
pub use drive::{read_drive, write_drive};
pub use motion::Motion;
pub use node::Node;
pub use path::{read_modulated, read_path};
pub use positions::{COLUMNS as POSITIONS, read_array};
pub use schema::tables;
pub use source::{Format, MOST_BYTES, Source};
pub use sweep::sweep_tables;
pub use tables::Provenance;

use std::path::{Path, PathBuf};

use crate::files::source::BYTE_ORDER_MARK;
use crate::kernels::InstructionSet;
use crate::prelude::*;
use crate::scene::Scene;
use crate::session::Moving;

/// Reads a scene from a file's bytes.
///
/// # Errors
/// An empty, binary or too large file, a syntax error, an unknown key, solver, option or preset, and all errors of
/// [`Scene::new`].
///
/// ```
/// use midair::files::{Format, read};
///
/// let text = r#"
/// [array]
/// preset = "paper20"
///
/// [[points]]
/// position = [0.0, 0.0, 0.15]
/// "#;
/// assert_eq!(read(text.as_bytes(), Format::Toml)?.array().len(), 400);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn read(bytes: &[u8], format: Format) -> Result<Scene> {
    read_from(bytes, format, Source::default())
}

/// Does the same as [`read`] for a document that may name other files; `source` also names the document in errors.
///
/// # Errors
/// The errors of [`read`], and a file that cannot be read.
pub fn read_from(bytes: &[u8], format: Format, source: Source<'_>) -> Result<Scene> {
    read_drawn(bytes, format, source, &mut drawn::undrawn)
}

/// Does the same as [`read_from`]. `draw` draws the tables that need it: `[shape]` with texts and drawings, `[image]`, and the
/// files of obstacles.
///
/// # Errors
/// The errors of [`read_from`], and the errors of `draw`.
pub fn read_drawn(bytes: &[u8], format: Format, source: Source<'_>, draw: &mut Draw<'_>) -> Result<Scene> {
    let (text, document) = parse(bytes, format, source)?;
    read::scene(&document, source, draw).map_err(|fault| fault.reported(text, format, source))
}

/// Reads a document of moving points. `draw` draws what [`read_drawn`] needs, and outlines for paths along drawings. Returns
/// `None` for a document without `[motion]`.
///
/// # Errors
/// The errors of [`read_drawn`]; resting points beside `[motion]`, a motion without rate, path or file; wrong paths and files
/// of frames.
///
/// ```
/// use midair::files::{Format, Source, read_motion};
///
/// let text = r#"
/// [array]
/// preset = "paper20"
///
/// [motion]
/// rate = 1e3
///
/// [[motion.path]]
/// kind = "circle"
/// center = [0.0, 0.0, 0.15]
/// radius = 0.02
/// frequency = 5
/// "#;
/// let mut draw = |_: &str, _: &str| Err(midair::Error::missing("", "no drawing", ""));
/// let motion = read_motion(text.as_bytes(), Format::Toml, Source::default(), &mut draw)?.expect("a motion");
/// assert_eq!(motion.pace.rate, 1e3);
/// assert_eq!(motion.path.frames(1e3)?.points.len(), 200);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn read_motion(bytes: &[u8], format: Format, source: Source<'_>, draw: &mut Draw<'_>) -> Result<Option<Motion>> {
    let (text, document) = parse(bytes, format, source)?;
    motion::motion(text, &document, format, source, draw).map_err(|fault| fault.reported(text, format, source))
}

/// Reads a document of points at rest or in motion. Returns the scene to be solved, and the frames of a motion, whose first is
/// that of the scene.
///
/// # Errors
/// The errors of [`read_from`], [`read_motion`] and [`Motion::moving`].
pub fn open(bytes: &[u8], format: Format, source: Source<'_>, set: InstructionSet) -> Result<(Scene, Option<Moving>)> {
    let (text, document) = parse(bytes, format, source)?;
    let draw = &mut drawn::undrawn;
    let motion = motion::motion(text, &document, format, source, draw);
    match motion.map_err(|fault| fault.reported(text, format, source))? {
        None => {
            let scene = read::scene(&document, source, draw).map_err(|fault| fault.reported(text, format, source))?;
            Ok((scene, None))
        }
        Some(motion) => {
            let moving = motion.moving(set)?;
            Ok((moving.scene.clone(), Some(moving)))
        }
    }
}

/// Reads the document of a sweep as a tree of values, whose keys have been checked.
///
/// # Errors
/// A syntax error, an unknown key.
///
/// ```
/// use midair::files::{Format, Source, read_sweep};
///
/// let text = "seeds = 2\nseeds = 1\n[[solver]]\nname = \"greedy\"\n";
/// let twice = read_sweep(text.as_bytes(), Format::Toml, Source::default()).unwrap_err();
/// assert!(twice.to_string().starts_with("scene file, line 2, column 1: the key \"seeds\" is written twice"));
/// ```
pub fn read_sweep(bytes: &[u8], format: Format, source: Source<'_>) -> Result<Node> {
    let (text, document) = parse(bytes, format, source)?;
    sweep::check(&document).map_err(|fault| fault.reported(text, format, source))?;
    Ok(document)
}

/// Adds the name and place in a document to an error about a value, such as `points.z is -1: give more`. Returns `None` if the
/// document has no such value.
pub fn placed(bytes: &[u8], format: Format, source: Source<'_>, error: &Error) -> Option<Error> {
    let (text, _) = parse(bytes, format, source).ok()?;
    let at = place::whole(text, format, &error.item)?;
    Some(source.fault(Some((text, at)), error.clone()))
}

/// The paths of the files that a document names, in the folder of the document.
///
/// # Errors
/// A document that cannot be parsed.
pub fn references(bytes: &[u8], format: Format, source: Source<'_>) -> Result<Vec<PathBuf>> {
    let (_, document) = parse(bytes, format, source)?;
    let folder = source.folder.unwrap_or(Path::new(""));
    let mut arrays: Vec<&Node> = document.get("array").into_iter().collect();
    let mut next = 0;
    while let Some(&array) = arrays.get(next) {
        if let Some(Node::List(parts)) = array.get("part") {
            arrays.extend(parts);
        }
        next += 1;
    }
    let positions = arrays.into_iter().filter_map(|array| array.get("positions"));
    let tables = positions.chain(drawn::tables(&document));
    let named = tables.filter_map(|table| match table.get("file") {
        Some(Node::Text(name)) => Some(folder.join(name)),
        _ => None,
    });
    Ok(named.collect())
}

/// Checks the bytes of a document and parses them. Returns the text and the tree of values.
fn parse<'a>(bytes: &'a [u8], format: Format, source: Source<'_>) -> Result<(&'a str, Node)> {
    let fault = |value: &str, cure: &str| source.fault(None, Error::unreadable("", value, cure));
    refuse_if!(bytes.len() > MOST_BYTES, fault("larger than 64 MB", "give fewer points or transducers"));
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") || bytes.iter().take(4).any(|byte| *byte == 0) {
        return Err(fault("not text in UTF-8 but in UTF-16, or binary", "save it as UTF-8"));
    }
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let text = core::str::from_utf8(bytes).map_err(|_| fault("not text", "give TOML or JSON in UTF-8"))?;
    if text.trim().is_empty() {
        return Err(fault("empty", "it needs at least [array] and [[points]]; `midair new` writes one to begin with"));
    }
    let document = match format {
        Format::Toml => toml::read(text),
        Format::Json => json::read(text),
    };
    Ok((text, document.map_err(|flaw| flaw.reported(text, format, source))?))
}

/// Returns a scene as text, from which [`read`] reads the same scene.
///
/// # Errors
/// A signature of given factors, an option beyond 64 bits.
pub fn write(scene: &Scene, format: Format, provenance: &Provenance) -> Result<String> {
    let document = tables::document(scene, provenance)?;
    let mut text = String::new();
    match format {
        // This never fails, because only a null in a list is an error, and a scene contains no null.
        Format::Toml => write::toml("", &document, &mut text).unwrap_or_default(),
        Format::Json => write::json(&document, "\n", &mut text),
    }
    Ok(text)
}
