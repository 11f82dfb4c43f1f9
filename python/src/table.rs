//! Tables of numbers in text, read by the core.

use midair::Complex32;
use midair::files::{Columns, POSITIONS, read_table};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::error::refused;
use crate::{give, read};

/// Line number of each row (R,), and the rows (R, C) in the order of the names.
type Read<'py> = (Bound<'py, PyArray1<usize>>, Bound<'py, PyArray2<f64>>);

/// Reads the table in a file's bytes; `name` is its name in errors. `names` are the columns, by default those of positions,
/// and `optional` further ones, which are NaN where they are missing.
#[pyfunction(name = "read_table")]
#[pyo3(signature = (text, name, names=None, optional=None, units="in metres", example=""))]
pub(crate) fn table<'py>(
    py: Python<'py>,
    text: &[u8],
    name: &str,
    names: Option<Vec<String>>,
    optional: Option<Vec<String>>,
    units: &str,
    example: &str,
) -> PyResult<Read<'py>> {
    let names: Option<Vec<&str>> = names.as_ref().map(|names| names.iter().map(String::as_str).collect());
    let optional = optional.unwrap_or_default();
    let optional: Vec<&str> = optional.iter().map(String::as_str).collect();
    let choices = names.as_deref().map(|names| [names]);
    let own = |choices| Columns { choices, optional: &optional, units, example };
    let columns = choices.as_ref().map_or(POSITIONS, |choices| own(choices));
    let table = read_table(text, name, columns).map_err(refused)?;
    let rows =
        PyArray2::from_vec2(py, &table.rows).map_err(|error| refused(midair::Error::invalid("text", error, "")))?;
    Ok((PyArray1::from_vec(py, table.lines), rows))
}

/// Returns the CSV of a drive (N,), with the positions (N, 3) of the transducers in m if given.
#[pyfunction]
#[pyo3(signature = (drive, positions=None))]
pub(crate) fn drive_to_csv(drive: &Bound<'_, PyAny>, positions: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
    let positions = positions.map(|positions| read::vectors("positions", positions)).transpose()?;
    Ok(midair::files::write_drive(positions.as_deref(), &read::drive("drive", drive)?))
}

/// Reads the drive (N,) in a CSV of `drive_to_csv`; `name` is the file's name in errors.
#[pyfunction]
pub(crate) fn drive_from_csv<'py>(
    py: Python<'py>,
    text: &[u8],
    name: &str,
) -> PyResult<Bound<'py, PyArray1<Complex32>>> {
    Ok(give::list(py, midair::files::read_drive(text, name).map_err(refused)?))
}
