//! Tables of positions in separate files: transducers x, y, z in metres with or without a normal nx, ny, nz, and points.

use crate::files::csv::{self, Columns};
use crate::files::source::{MOST_BYTES, Source};
use crate::prelude::*;
use crate::scene::Array;

/// The transducers of a file: positions (N, 3) in m, and normals (N, 3) if the file has them.
pub(super) struct Positions {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) normals: Option<Vec<[f64; 3]>>,
}

/// The columns of a file of positions.
pub const COLUMNS: Columns<'_> = Columns {
    choices: &[&["x", "y", "z"], &["x", "y", "z", "nx", "ny", "nz"]],
    optional: &[],
    units: "in metres",
    example: "0.01,0.0,0.0",
    length: "m",
};

/// The columns of a file of control points.
const POINTS: Columns<'_> = Columns {
    choices: &[&["x", "y", "z"]],
    optional: &["pressure", "phase", "weight"],
    units: "in metres, and if you like pressure, phase, weight",
    example: "0.01,0.0,0.15,500.0",
    length: "m",
};

/// Reads the places of a file of points in a unit, and the pressure, phase and weight of each, if they are there.
pub(super) fn points(name: &str, length: &str, source: Source<'_>) -> Result<Vec<Point>> {
    let (bytes, place) = source.beside("points.file", name, "a table of x, y, z in metres", MOST_BYTES)?;
    let table = csv::read_table(&bytes, &place, Columns { length, ..POINTS })?;
    let some = |x: f64| (!x.is_nan()).then_some(x);
    let each = table.rows.iter().map(|row| ([row[0], row[1], row[2]], [some(row[3]), some(row[4]), some(row[5])]));
    Ok(each.collect())
}

/// The position of a point; and its pressure, phase and weight, each if given.
pub(super) type Point = ([f64; 3], [Option<f64>; 3]);

/// Whether the ending of a name is that of a table that the core reads. A binding may read arrays of other formats.
pub(super) fn is_table(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    [".csv", ".txt", ".tsv", ".dat", ".npy"].iter().any(|ending| name.ends_with(ending)) || !name.contains('.')
}

/// Reads the file with this name from the document's folder; its numbers are in a unit.
pub(super) fn read(name: &str, length: &str, source: Source<'_>) -> Result<Positions> {
    let (bytes, place) = source.beside("array.positions.file", name, "a table of x, y, z in metres", MOST_BYTES)?;
    positions(&bytes, &place, length)
}

/// Reads an array from the text of a file; errors name the file as `name`.
///
/// # Errors
/// The errors of [`crate::files::read_table`] and of [`Array::new`].
pub fn read_array(bytes: &[u8], name: &str) -> Result<Array> {
    let Positions { positions, normals } = positions(bytes, name, "m")?;
    Array::new(positions, normals).map_err(|error| csv::fault(name, None, error))
}

fn positions(bytes: &[u8], name: &str, length: &str) -> Result<Positions> {
    let table = csv::read_table(bytes, name, Columns { length, ..COLUMNS })?;
    let vectors = |from: usize| table.rows.iter().map(|row| [row[from], row[from + 1], row[from + 2]]).collect();
    let turned = table.rows[0].len() == 6;
    Ok(Positions { positions: vectors(0), normals: turned.then(|| vectors(3)) })
}
