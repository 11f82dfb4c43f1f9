//! Positions of transducers in a file of their own: CSV with a row x, y, z in metres, and nx, ny, nz where they are turned.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use std::fs::File;
use std::io::Read;

use crate::error::{Error, one_line};
use crate::files::source::{MOST_BYTES, Source};

/// Transducers of a file.
pub(super) struct Positions {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) normals: Option<Vec<[f64; 3]>>,
}

const COLUMNS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];
const ROW: &str = "for example 0.01,0.0,0.0";

/// Reads the file of that name in the document's folder.
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
    let name = path.display().to_string();
    match core::str::from_utf8(&bytes) {
        Ok(text) => parse(text.trim_start_matches('\u{feff}'), &name),
        Err(_) => Err(fault(&name, None, &format!("not text: give rows of x,y,z in metres, {ROW}"))),
    }
}

fn fault(name: &str, line: Option<usize>, reason: &str) -> Error {
    let place = line.map_or_else(|| name.to_string(), |line| format!("{name}, line {line}"));
    Error::File { place: one_line(&place), reason: one_line(reason) }
}

/// Rows of numbers between commas, semicolons or tabs; a first row of names says which columns are which.
fn parse(text: &str, name: &str) -> Result<Positions, Error> {
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    // Column of each of COLUMNS, once the first row has told.
    let mut columns: Option<Vec<usize>> = None;
    for (index, line) in text.lines().enumerate() {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        let refused = |reason: &str| fault(name, Some(index + 1), &format!("{reason}, {ROW}"));
        let cells = cells(line);
        let chosen = if let Some(chosen) = &columns {
            chosen
        } else {
            let header = cells[0].parse::<f64>().is_err();
            let chosen = if header { named(&cells) } else { counted(cells.len()) };
            let chosen = columns.insert(chosen.map_err(|reason| refused(&reason))?);
            if header {
                continue;
            }
            chosen
        };
        let mut row = [0.0; 6];
        for ((value, &column), axis) in row.iter_mut().zip(chosen).zip(COLUMNS) {
            let cell = cells.get(column).copied().unwrap_or_default();
            let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
            *value = number.ok_or_else(|| refused(&format!("{axis} is \"{cell}\": give a number")))?;
        }
        let [x, y, z, nx, ny, nz] = row;
        positions.push([x, y, z]);
        if chosen.len() == 6 {
            normals.push([nx, ny, nz]);
        }
    }
    if positions.is_empty() {
        return Err(fault(name, None, &format!("empty: give a row x,y,z in metres for each transducer, {ROW}")));
    }
    Ok(Positions { positions, normals: (!normals.is_empty()).then_some(normals) })
}

fn cells(line: &str) -> Vec<&str> {
    let separator = [';', '\t'].into_iter().find(|separator| line.contains(*separator)).unwrap_or(',');
    line.split(separator).map(|cell| cell.trim().trim_matches('"').trim()).collect()
}

/// The columns of a row of numbers alone.
fn counted(count: usize) -> Result<Vec<usize>, String> {
    match count {
        3 | 6 => Ok((0..count).collect()),
        _ => Err(format!("{count} columns: give x,y,z in metres, or x,y,z,nx,ny,nz")),
    }
}

/// The columns that a row of names tells.
fn named(names: &[&str]) -> Result<Vec<usize>, String> {
    let column = |axis: &str| names.iter().position(|name| name.eq_ignore_ascii_case(axis));
    let found: Vec<usize> = COLUMNS.iter().filter_map(|axis| column(axis)).collect();
    let turned = COLUMNS[3..].iter().any(|axis| column(axis).is_some());
    if COLUMNS[..3].iter().any(|axis| column(axis).is_none()) || (turned && found.len() != 6) {
        return Err(format!("columns are {}: name them x,y,z or x,y,z,nx,ny,nz, in metres", names.join(", ")));
    }
    Ok(found)
}
