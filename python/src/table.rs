//! Tables of numbers in text, read by the core.

use midair::Complex32;
use midair::files::{Columns, POSITIONS, read_table};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::error::refused;
use crate::{give, read};

/// The line of each row (R,), and the rows (R, C) in the order of the names.
type Read<'py> = (Bound<'py, PyArray1<usize>>, Bound<'py, PyArray2<f64>>);

/// The table of a file's text; name is what errors call it. Without names they are those of positions.
#[pyfunction(name = "read_table")]
#[pyo3(signature = (text, name, names=None, units="in metres", example=""))]
pub(crate) fn table<'py>(
    py: Python<'py>,
    text: &[u8],
    name: &str,
    names: Option<Vec<String>>,
    units: &str,
    example: &str,
) -> PyResult<Read<'py>> {
    let names: Option<Vec<&str>> = names.as_ref().map(|names| names.iter().map(String::as_str).collect());
    let choices = names.as_deref().map(|names| [names]);
    let columns = choices.as_ref().map_or(POSITIONS, |choices| Columns { choices, units, example });
    let table = read_table(text, name, columns).map_err(refused)?;
    let rows =
        PyArray2::from_vec2(py, &table.rows).map_err(|error| refused(midair::Error::invalid("text", error, "")))?;
    Ok((PyArray1::from_vec(py, table.lines), rows))
}

/// The CSV of a drive (N,) of transducers at positions (N, 3) in m, where they are known.
#[pyfunction]
#[pyo3(signature = (drive, positions=None))]
pub(crate) fn drive_to_csv(drive: &Bound<'_, PyAny>, positions: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
    let positions = positions.map(|positions| read::vectors("positions", positions)).transpose()?;
    Ok(midair::files::write_drive(positions.as_deref(), &read::drive("drive", drive)?))
}

/// The drive (N,) of such a CSV; name is what errors call the file.
#[pyfunction]
pub(crate) fn drive_from_csv<'py>(
    py: Python<'py>,
    text: &[u8],
    name: &str,
) -> PyResult<Bound<'py, PyArray1<Complex32>>> {
    Ok(give::list(py, midair::files::read_drive(text, name).map_err(refused)?))
}
