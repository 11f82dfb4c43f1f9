//! Source of a document: its format, its name in errors, and the folder of its files.

use alloc::format;
use alloc::string::ToString;
use std::path::Path;

use crate::error::{Error, one_line};

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
    /// The format by the name's ending: `.json` is JSON, any other ending TOML.
    #[must_use]
    pub fn of(name: &str) -> Self {
        if name.to_ascii_lowercase().ends_with(".json") { Self::Json } else { Self::Toml }
    }

    /// A document's own, by the endings `.json` and `.toml` of its name, else by the text itself.
    #[must_use]
    pub fn of_document(name: &str, bytes: &[u8]) -> Self {
        let reported = [".json", ".toml"].iter().any(|ending| name.to_ascii_lowercase().ends_with(ending));
        if reported { Self::of(name) } else { Self::of_text(bytes) }
    }

    /// The format by the text itself: no TOML begins with a brace, and a scene in JSON does.
    #[must_use]
    pub fn of_text(bytes: &[u8]) -> Self {
        let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
        if text.trim_ascii_start().starts_with(b"{") { Self::Json } else { Self::Toml }
    }
}

/// The byte order mark that some editors write first.
pub(super) const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// Where a document comes from.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::exhaustive_structs, reason = "a name and a place")]
pub struct Source<'a> {
    /// The name that errors use: its file's name.
    pub name: &'a str,
    /// The folder that files named in it are relative to; without one they are refused.
    pub folder: Option<&'a Path>,
}

impl Default for Source<'_> {
    fn default() -> Self {
        Self { name: "scene file", folder: None }
    }
}

impl Source<'_> {
    /// A fault of the document, at an offset of its text where that is known.
    pub(super) fn fault(self, at: Option<(&str, usize)>, reason: &str) -> Error {
        let mut place = self.name.to_string();
        if let Some((text, offset)) = at {
            let (line, column) = line_and_column(text, offset);
            place = format!("{place}, line {line}, column {column}");
        }
        Error::File { place: one_line(&place), reason: one_line(reason) }
    }
}

/// Line and column, counted from 1.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset.min(text.len())).unwrap_or(text);
    let line = before.rsplit('\n').next().unwrap_or_default();
    (before.matches('\n').count() + 1, line.chars().count() + 1)
}
