//! Drives in CSV: a row with index, x, y, z, amplitude and phase for each transducer, in m and rad.

use core::iter;

use crate::files::csv::{self, Columns};
use crate::prelude::*;

/// The tolerance for an amplitude of 1 that was rounded when written.
const ROUNDING: f64 = 1e-6;

/// The columns that are read; positions and other columns are ignored.
const COLUMNS: Columns<'_> = Columns {
    choices: &[&["amplitude", "phase"], &["index", "amplitude", "phase"]],
    optional: &[],
    units: "with phases in rad",
    example: "0,1.0,0.0",
    length: "m",
};

/// Returns a drive (N,) as CSV. Without `positions` (N,) in m, the columns x, y and z are left out.
///
/// ```
/// use midair::{Complex32, files};
///
/// let text = files::write_drive(Some(&[[0.0, 1e-5, 0.2]]), &[Complex32::new(0.0, -1.0)]);
/// assert_eq!(text, "index,x,y,z,amplitude,phase\n0,0.0,1e-05,0.2,1.0,4.71238898038469\n");
/// ```
pub fn write_drive(positions: Option<&[[f64; 3]]>, drive: &[Complex32]) -> String {
    let places = if positions.is_some() { ",x,y,z" } else { "" };
    let mut text = format!("index{places},amplitude,phase\n");
    for (index, &q) in drive.iter().enumerate() {
        let place = positions.and_then(|positions| positions.get(index));
        let values = place.into_iter().flatten().copied().chain([math::modulus(q).min(1.0), math::phase(q)]);
        let cells: Vec<String> = iter::once(index.to_string()).chain(values.map(shortest)).collect();
        text += &cells.join(",");
        text.push('\n');
    }
    text
}

/// Reads a drive (N,) from CSV; errors name the file as `name`.
///
/// # Errors
/// The errors of [`crate::files::read_table`]; an index that is not the number of its row; an amplitude outside of 0 to 1.
pub fn read_drive(bytes: &[u8], name: &str) -> Result<Vec<Complex32>> {
    let table = csv::read_table(bytes, name, COLUMNS)?;
    let rows = table.lines.into_iter().zip(table.rows).enumerate();
    rows.map(|(index, (line, row))| {
        let refused = |item: &str, value: f64, cure: String| {
            Err(csv::fault(name, Some(line), csv::unreadable(item, &value.to_string(), cure)))
        };
        let [.., amplitude, phase] = row[..] else { return refused("row", 0.0, "give index,amplitude,phase".into()) };
        if row.len() == 3 && row[0] != index as f64 {
            return refused("index", row[0], format!("give {index}, a row for every transducer"));
        }
        if !(0.0..=1.0 + ROUNDING).contains(&amplitude) {
            return refused("amplitude", amplitude, "give 0 to 1".into());
        }
        let q = math::phasor(phase) * amplitude;
        Ok(Complex32::new(q.re as f32, q.im as f32))
    })
    .collect()
}

/// Returns the shortest decimal number that is read back as the same f64, written as in Python.
fn shortest(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 || (1e-4..1e16).contains(&size) {
        return format!("{x:?}");
    }
    let text = format!("{x:e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    let sign = if size < 1.0 { '-' } else { '+' };
    format!("{digits}e{sign}{:0>2}", power.trim_start_matches('-'))
}
