//! Files of frames: the points (T, M, 3) of a motion as CSV, or as .npy of NumPy.

use crate::files::csv::{self, Columns};
use crate::files::npy::{self, Npy};
use crate::files::source::Source;
use crate::prelude::*;

/// Frames of points: points (T, M) in m, and M.
pub(super) type Frames = (Vec<[f64; 3]>, usize);

const COLUMNS: Columns<'_> = Columns {
    choices: &[&["frame", "point", "x", "y", "z"]],
    optional: &[],
    units: "with x, y, z in metres",
    example: "0,0,0.01,0.0,0.15",
    length: "m",
};

/// Largest size of a file in bytes.
const MOST: usize = 256 << 20;

/// Reads the file with this name from the document's folder.
pub(super) fn read(name: &str, source: Source<'_>) -> Result<Frames> {
    let kinds = ".npy of points (T, M, 3) in m, or CSV with the columns frame, point, x, y, z";
    let (bytes, place) = source.beside("motion.file", name, kinds, MOST)?;
    if name.to_ascii_lowercase().ends_with(".csv") {
        return table(&bytes, &place);
    }
    frames(&bytes, &format!("give {kinds}"))
        .map_err(|cure| Error::unreadable("motion.file", format!("\"{name}\""), cure))
}

/// Returns the frames of a table with one row for each point of each frame, in any order.
fn table(bytes: &[u8], name: &str) -> Result<Frames> {
    let table = csv::read_table(bytes, name, COLUMNS)?;
    let wrong = |row: usize, item: &str, value: &str, cure: &str| {
        Err(csv::fault(name, Some(table.lines[row]), csv::unreadable(item, value, cure.into())))
    };
    let mut sizes = [0; 2];
    for (row, cells) in table.rows.iter().enumerate() {
        for (k, size) in sizes.iter_mut().enumerate() {
            let number = cells[k];
            if number < 0.0 || number.fract() != 0.0 {
                return wrong(row, COLUMNS.choices[0][k], &number.to_string(), "count them 0, 1, 2, ...");
            }
            *size = (number as usize + 1).max(*size);
        }
    }
    let ([frames, count], rows) = (sizes, table.rows.len());
    let needed = frames.saturating_mul(count);
    if needed > rows {
        let cure = format!("{frames} frames of {count} points need {needed} rows");
        return Err(csv::fault(name, None, csv::unreadable("the table", &format!("{rows} rows long"), cure)));
    }
    let mut points = vec![None; needed];
    for (row, cells) in table.rows.iter().enumerate() {
        let [frame, point] = [cells[0], cells[1]].map(|number| number as usize);
        if points[frame * count + point].replace([cells[2], cells[3], cells[4]]).is_some() {
            return wrong(row, &format!("point {point} of frame {frame}"), "there twice", "give it once");
        }
    }
    Ok((points.into_iter().flatten().collect(), count))
}

/// Returns the frames in an .npy file; else the cure.
fn frames(bytes: &[u8], cure: &str) -> Result<Frames, alloc::string::String> {
    let Npy { shape, numbers } = npy::read(bytes).ok_or(cure)??;
    let &[_, count, 3] = &*shape else {
        let sizes = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        return Err(format!("its shape is ({sizes}): give points (T, M, 3)"));
    };
    Ok((numbers.as_chunks().0.to_vec(), count))
}
