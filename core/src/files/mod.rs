//! Scene files, TOML or JSON, read and written for every binding.

mod csv;
mod drawn;
mod drive;
mod fault;
mod item;
mod json;
mod kind;
mod motion;
mod node;
mod place;
mod positions;
mod read;
mod schema;
mod shape;
mod source;
mod step;
mod sweep;
mod syntax;
mod tables;
mod toml;
mod write;

pub use csv::{Columns, Table, read_table};
pub use drawn::{Draw, Drawing};
pub use drive::{read_drive, write_drive};
pub use motion::Motion;
pub use node::Node;
pub use positions::{COLUMNS as POSITIONS, read_array};
pub use schema::tables;
pub use source::{Format, MOST_BYTES, Source};
pub use sweep::sweep_tables;
pub use tables::Provenance;

use alloc::string::String;
use alloc::vec::Vec;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::files::source::BYTE_ORDER_MARK;
use crate::scene::Scene;

/// Reads a scene from a file's bytes.
///
/// # Errors
/// An empty, binary or oversized file, a fault of the format, an unknown key, solver, option or preset, and all
/// that [`Scene::new`] refuses.
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
pub fn read(bytes: &[u8], format: Format) -> Result<Scene, Error> {
    read_from(bytes, format, Source::default())
}

/// The same for a document that may name files, or has a name for its errors.
///
/// # Errors
/// As [`read`], and a file that cannot be read.
pub fn read_from(bytes: &[u8], format: Format, source: Source<'_>) -> Result<Scene, Error> {
    read_drawn(bytes, format, source, &mut drawn::undrawn)
}

/// The same of a document whose tables `[shape]` of text and drawings, whose `[image]`, and whose obstacles' files are drawn by the
/// caller.
///
/// # Errors
/// As [`read_from`], and what `draw` refuses.
pub fn read_drawn(bytes: &[u8], format: Format, source: Source<'_>, draw: &mut Draw<'_>) -> Result<Scene, Error> {
    let (text, document) = parse(bytes, format, source)?;
    read::scene(&document, source, draw).map_err(|fault| fault.reported(text, format, source))
}

/// Reads a document of points that move: `draw` makes of each `motion.path`, or of `motion.file`, the points of its first
/// frame, and keeps the path itself. A document without `[motion]` is none.
///
/// # Errors
/// As [`read_drawn`]; points that rest beside `[motion]`, a motion without rate, path or file.
///
/// ```
/// use midair::Request;
/// use midair::files::{Drawing, Format, Source, read_motion};
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
/// let mut draw = |_: &str, _: &str| Ok(Drawing::Points(vec![[0.02, 0.0, 0.15]], Request::default()));
/// let motion = read_motion(text.as_bytes(), Format::Toml, Source::default(), &mut draw)?.expect("a motion");
/// assert_eq!(motion.settings["rate"], midair::Value::Real(1e3));
/// # Ok::<(), midair::Error>(())
/// ```
pub fn read_motion(
    bytes: &[u8],
    format: Format,
    source: Source<'_>,
    draw: &mut Draw<'_>,
) -> Result<Option<Motion>, Error> {
    let (text, document) = parse(bytes, format, source)?;
    motion::motion(&document, source, draw).map_err(|fault| fault.reported(text, format, source))
}

/// Reads a document of a sweep: its values, whose keys are known.
///
/// # Errors
/// A fault of the format, an unknown key.
///
/// ```
/// use midair::files::{Format, Source, read_sweep};
///
/// let text = "seeds = 2\nseeds = 1\n[[solver]]\nname = \"greedy\"\n";
/// let twice = read_sweep(text.as_bytes(), Format::Toml, Source::default()).unwrap_err();
/// assert!(twice.to_string().starts_with("scene file, line 2, column 1: the key \"seeds\" is written twice"));
/// ```
pub fn read_sweep(bytes: &[u8], format: Format, source: Source<'_>) -> Result<Node, Error> {
    let (text, document) = parse(bytes, format, source)?;
    sweep::check(&document).map_err(|fault| fault.reported(text, format, source))?;
    Ok(document)
}

/// A refusal of a document's value, such as `points.z is -1: give more`, with its place; none where the document has no such
/// value.
#[must_use]
pub fn placed(bytes: &[u8], format: Format, source: Source<'_>, refusal: &str) -> Option<Error> {
    let (text, _) = parse(bytes, format, source).ok()?;
    let item = refusal.split(" is ").next()?;
    let at = place::whole(text, format, item)?;
    Some(source.fault(Some((text, at)), refusal))
}

/// The files that a document names, in its folder.
///
/// # Errors
/// A document that is none.
pub fn references(bytes: &[u8], format: Format, source: Source<'_>) -> Result<Vec<PathBuf>, Error> {
    let (_, document) = parse(bytes, format, source)?;
    let folder = source.folder.unwrap_or(Path::new(""));
    let positions = document.get("array").and_then(|array| array.get("positions"));
    let tables = positions.into_iter().chain(drawn::tables(&document));
    let named = tables.filter_map(|table| match table.get("file") {
        Some(Node::Text(name)) => Some(folder.join(name)),
        _ => None,
    });
    Ok(named.collect())
}

/// The text of a document and its tables.
fn parse<'a>(bytes: &'a [u8], format: Format, source: Source<'_>) -> Result<(&'a str, Node), Error> {
    let fault = |reason: &str| source.fault(None, reason);
    if bytes.len() > MOST_BYTES {
        return Err(fault("larger than 64 MB: give fewer points or transducers"));
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") || bytes.iter().take(4).any(|byte| *byte == 0) {
        return Err(fault("not text in UTF-8 but in UTF-16, or binary: save it as UTF-8"));
    }
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let text = core::str::from_utf8(bytes).map_err(|_| fault("not text: give TOML or JSON in UTF-8"))?;
    if text.trim().is_empty() {
        return Err(fault("empty: it needs at least [array] and [[points]]; `midair new` writes one to begin with"));
    }
    let document = match format {
        Format::Toml => toml::read(text),
        Format::Json => json::read(text),
    };
    Ok((text, document.map_err(|flaw| flaw.reported(text, format, source))?))
}

/// Writes a scene as text that [`read`] reads as the same scene.
///
/// # Errors
/// A signature of given factors; an option beyond 64 bits.
pub fn write(scene: &Scene, format: Format, provenance: &Provenance) -> Result<String, Error> {
    let document = tables::document(scene, provenance)?;
    let mut text = String::new();
    match format {
        // It has no list with a null in it.
        Format::Toml => write::toml("", &document, &mut text).unwrap_or_default(),
        Format::Json => write::json(&document, "\n", &mut text),
    }
    Ok(text)
}
