//! Positions of transducers in a separate CSV file: rows x, y, z in metres, optionally with a normal nx, ny, nz.

use alloc::format;
use alloc::string::ToString;
use alloc::vec::Vec;
use std::fs::File;
use std::io::Read;

use crate::error::Error;
use crate::files::csv::{self, Columns};
use crate::files::source::{MOST_BYTES, Source};
use crate::scene::Array;

/// The transducers of a file: positions (N, 3) in m, and normals (N, 3) if the file has them.
pub(super) struct Positions {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) normals: Option<Vec<[f64; 3]>>,
}

/// The columns of a file of positions.
pub const COLUMNS: Columns<'_> = Columns {
    choices: &[&["x", "y", "z"], &["x", "y", "z", "nx", "ny", "nz"]],
    units: "in metres",
    example: "0.01,0.0,0.0",
};

/// Reads the file with this name from the document's folder.
pub(super) fn read(name: &str, source: Source<'_>) -> Result<Positions, Error> {
    let refused = |value: &str, cure: &str| Error::invalid("array.positions.file", value, cure);
    let quoted = format!("\"{name}\"");
    let Some(folder) = source.folder else {
        return Err(refused(&quoted, "this document has no folder to find files in: list the positions themselves"));
    };
    let path = folder.join(name);
    let trouble = |error: &std::io::Error| {
        let reason = error.to_string();
        let reason = reason.split(" (os error").next().unwrap_or_default();
        let cure = format!("it cannot be read ({reason}): give a CSV file, relative to the scene file's folder");
        refused(&format!("\"{}\"", path.display()), &cure)
    };
    if !std::fs::metadata(&path).map_err(|error| trouble(&error))?.is_file() {
        return Err(refused(&quoted, "it is no file: give a CSV file of x, y, z in metres"));
    }
    let mut bytes = Vec::new();
    let limit = MOST_BYTES as u64 + 1;
    File::open(&path).and_then(|file| file.take(limit).read_to_end(&mut bytes)).map_err(|error| trouble(&error))?;
    if bytes.len() > MOST_BYTES {
        return Err(refused(&quoted, "it is larger than 64 MB: give at most 1048576 rows"));
    }
    positions(&bytes, &path.display().to_string())
}

/// Reads an array from the text of a file; errors name the file as `name`.
///
/// # Errors
/// The errors of [`crate::files::read_table`] and of [`Array::new`].
pub fn read_array(bytes: &[u8], name: &str) -> Result<Array, Error> {
    let Positions { positions, normals } = positions(bytes, name)?;
    Array::new(positions, normals).map_err(|error| csv::fault(name, None, error))
}

fn positions(bytes: &[u8], name: &str) -> Result<Positions, Error> {
    let table = csv::read_table(bytes, name, COLUMNS)?;
    let vectors = |from: usize| table.rows.iter().map(|row| [row[from], row[from + 1], row[from + 2]]).collect();
    let turned = table.rows[0].len() == 6;
    Ok(Positions { positions: vectors(0), normals: turned.then(|| vectors(3)) })
}
