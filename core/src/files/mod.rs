//! Scene files, TOML or JSON: read and written here for every door.

mod quantization;
mod tables;

use alloc::format;
use alloc::string::{String, ToString};

use crate::error::{Error, one_line};
use crate::scene::Scene;

/// The largest scene file read, in bytes.
pub const MOST_BYTES: usize = 64 << 20;

/// The two ways to write a scene down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::exhaustive_enums, reason = "the two formats of the schema")]
pub enum Format {
    /// TOML.
    Toml,
    /// JSON.
    Json,
}

impl Format {
    /// By the name's ending: `.json` is JSON, anything else TOML.
    #[must_use]
    pub fn of(name: &str) -> Self {
        if name.to_ascii_lowercase().ends_with(".json") { Self::Json } else { Self::Toml }
    }
}

/// How a scene was solved, written beside it so that a result can be replayed.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::exhaustive_structs, reason = "two remarks")]
pub struct Provenance {
    /// The version of midair.
    pub version: Option<String>,
    /// How the solve ended.
    pub status: Option<String>,
}

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
    let fault = |reason: &str| Error::File { line: None, reason: reason.to_string() };
    if bytes.len() > MOST_BYTES {
        return Err(Error::invalid("scene file", format!("{} bytes", bytes.len()), "give at most 64 MB"));
    }
    let text = core::str::from_utf8(bytes).map_err(|_| fault("not text: give TOML or JSON in UTF-8"))?;
    if text.trim().is_empty() {
        return Err(fault("empty: it needs at least [array] and [[points]]"));
    }
    let table: tables::SceneTable = match format {
        Format::Toml => toml::from_str(text).map_err(|error| {
            let line = error.span().map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1);
            Error::File { line, reason: one_line(error.message()) }
        })?,
        Format::Json => serde_json::from_str(text).map_err(|error| {
            let reason = error.to_string();
            let reason = reason.rsplit_once(" at line ").map_or(reason.as_str(), |(reason, _)| reason);
            Error::File { line: Some(error.line()), reason: one_line(reason) }
        })?,
    };
    table.scene()
}

/// Writes a scene as text that [`read`] reads as the same scene.
///
/// # Errors
/// A seed that TOML cannot hold (above 2^63 - 1).
pub fn write(scene: &Scene, format: Format, provenance: &Provenance) -> Result<String, Error> {
    let table = tables::SceneTable::of(scene, provenance)?;
    let fault = |reason: String| Error::File { line: None, reason };
    match format {
        Format::Toml => toml::to_string(&table).map_err(|error| fault(format!("{error}: write it as .json"))),
        Format::Json => serde_json::to_string_pretty(&table).map_err(|error| fault(error.to_string())),
    }
}
