//! A drive in CSV: a row index, x, y, z, amplitude, phase for each transducer, in m and rad.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::iter;

use num_complex::Complex32;

use crate::error::Error;
use crate::files::csv::{self, Columns};
use crate::math;

/// An amplitude of 1 may have been rounded.
const ROUNDING: f64 = 1e-6;

/// Positions and other columns are not read.
const COLUMNS: Columns<'_> = Columns {
    choices: &[&["amplitude", "phase"], &["index", "amplitude", "phase"]],
    units: "with phases in rad",
    example: "0,1.0,0.0",
};

/// Writes a drive (N,); positions (N,) in m are left out where they are unknown.
///
/// ```
/// use midair::{Complex32, files};
///
/// let text = files::write_drive(Some(&[[0.0, 1e-5, 0.2]]), &[Complex32::new(0.0, -1.0)]);
/// assert_eq!(text, "index,x,y,z,amplitude,phase\n0,0.0,1e-05,0.2,1.0,4.71238898038469\n");
/// ```
#[must_use]
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

/// Reads a drive (N,); errors call the file `name`.
///
/// # Errors
/// Those of [`crate::files::read_table`]; an index that is not that of its row; an amplitude that is not 0 to 1.
pub fn read_drive(bytes: &[u8], name: &str) -> Result<Vec<Complex32>, Error> {
    let table = csv::read_table(bytes, name, COLUMNS)?;
    let rows = table.lines.into_iter().zip(table.rows).enumerate();
    rows.map(|(index, (line, row))| {
        let refused = |reason: &str| Err(csv::fault(name, Some(line), reason));
        let [.., amplitude, phase] = row[..] else { return refused("give index,amplitude,phase") };
        if row.len() == 3 && row[0] != index as f64 {
            return refused(&format!("index is {}: give {index}, a row for every transducer", row[0]));
        }
        if !(0.0..=1.0 + ROUNDING).contains(&amplitude) {
            return refused(&format!("amplitude is {amplitude}: give 0 to 1"));
        }
        let q = math::phasor(phase) * amplitude;
        Ok(Complex32::new(q.re as f32, q.im as f32))
    })
    .collect()
}

/// The shortest decimal that is read back to the same number, as Python writes it.
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
