//! Positions of transducers in a separate CSV file: rows x, y, z in metres, optionally with a normal nx, ny, nz.

use alloc::vec::Vec;

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
    let (bytes, place) = source.beside("array.positions.file", name, "a CSV file of x, y, z in metres", MOST_BYTES)?;
    positions(&bytes, &place)
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
