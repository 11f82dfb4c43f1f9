//! Source of a document: its format, its name in error messages, and the folder of the files that it names.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::one_line;
use crate::prelude::*;

/// The largest scene file that is read, in bytes.
pub const MOST_BYTES: usize = 64 << 20;

/// The formats of scene files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The format TOML (toml.io).
    Toml,
    /// The format JSON (RFC 8259).
    Json,
}

impl Format {
    /// Returns the format for a file name: `.json` is JSON, any other ending is TOML.
    pub fn of(name: &str) -> Self {
        if name.to_ascii_lowercase().ends_with(".json") { Self::Json } else { Self::Toml }
    }

    /// Returns the format of a document: by its name if that ends in `.json` or `.toml`, else by its text.
    pub fn of_document(name: &str, bytes: &[u8]) -> Self {
        let reported = [".json", ".toml"].iter().any(|ending| name.to_ascii_lowercase().ends_with(ending));
        if reported { Self::of(name) } else { Self::of_text(bytes) }
    }

    /// Returns the format of a text: JSON if it begins with a brace, which TOML never does.
    pub fn of_text(bytes: &[u8]) -> Self {
        let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
        if text.trim_ascii_start().starts_with(b"{") { Self::Json } else { Self::Toml }
    }
}

/// The byte order mark that some editors write at the beginning of a file.
pub(super) const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// The name and the folder of a document.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The name in error messages: the file name.
    pub name: &'a str,
    /// The folder for relative file names in the document. Without it, a document may not name files.
    pub folder: Option<&'a Path>,
}

impl Default for Source<'_> {
    fn default() -> Self {
        Self { name: "scene file", folder: None }
    }
}

impl Source<'_> {
    /// Returns the bytes of a file that the key `item` of the document names, at most `most`, and the name of the file in
    /// errors. `kinds` are the files that it may be.
    pub(super) fn beside(self, item: &str, name: &str, kinds: &str, most: usize) -> Result<(Vec<u8>, String)> {
        let quoted = format!("\"{name}\"");
        let refused = |value: &str, cure: &str| Error::invalid(item, value, cure);
        let Some(folder) = self.folder else {
            return Err(refused(&quoted, "this document has no folder to find files in: list the places themselves"));
        };
        let path = folder.join(name);
        let trouble = |error: &std::io::Error| {
            let reason = error.to_string();
            let reason = reason.split(" (os error").next().unwrap_or_default();
            let cure = format!("it cannot be read ({reason}): give {kinds}, relative to the scene file's folder");
            refused(&format!("\"{}\"", path.display()), &cure)
        };
        if !std::fs::metadata(&path).map_err(|error| trouble(&error))?.is_file() {
            return Err(refused(&quoted, &format!("it is no file: give {kinds}")));
        }
        let mut bytes = Vec::new();
        let limit = most as u64 + 1;
        File::open(&path).and_then(|file| file.take(limit).read_to_end(&mut bytes)).map_err(|error| trouble(&error))?;
        if bytes.len() > most {
            return Err(refused(&quoted, &format!("it is larger than {} MB: give a smaller one", most >> 20)));
        }
        Ok((bytes, path.display().to_string()))
    }

    /// Returns an error in the document, with its line and column if `at` gives the text and an offset.
    pub(super) fn fault(self, at: Option<(&str, usize)>, error: Error) -> Error {
        let place = one_line(self.name);
        let Some((text, offset)) = at else { return error.inside(place) };
        let (line, column) = line_and_column(text, offset);
        error.inside(format!("{place}, line {line}, column {column}"))
    }
}

/// Line and column of an offset, both counted from 1.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset.min(text.len())).unwrap_or(text);
    let line = before.rsplit('\n').next().unwrap_or_default();
    (before.matches('\n').count() + 1, line.chars().count() + 1)
}
