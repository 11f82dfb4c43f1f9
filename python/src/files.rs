//! Scene files and scenes as text: read up to a size limit; written completely or not at all.

use std::path::{Path, PathBuf};

use midair::Key;
use midair::files::{self, Columns, Format, MOST_BYTES, POSITIONS, Provenance, Source};
use pyo3::types::PyBytes;

use crate::draw;
use crate::error::error_of;
use crate::prelude::*;
use crate::toolbox;
use crate::{node, read as reading};

/// Returns a file's bytes, by Python's own functions: Ctrl-C ends them, also while a pipe has no writer.
pub(crate) fn bytes_of(py: Python<'_>, path: &Path) -> PyResult<Vec<u8>> {
    let file = py.import("builtins")?.call_method1("open", (path, "rb"))?;
    // Reads one byte more than allowed, to detect that a file is too large.
    let bytes = file.call_method1("read", (MOST_BYTES + 1,));
    file.call_method0("close")?;
    bytes?.extract()
}

/// Calls `reading` with a file's bytes, their format and their origin.
pub(crate) fn read<T>(
    path: &Path,
    bytes: &[u8],
    reading: impl Fn(&[u8], Format, Source<'_>) -> PyResult<T>,
) -> PyResult<T> {
    let name = path.to_string_lossy();
    reading(bytes, Format::of_document(&name, bytes), Source { name: &name, folder: path.parent() })
}

/// Reads the scene of a file.
pub(crate) fn load(py: Python<'_>, path: &Path) -> PyResult<midair::Scene> {
    read(path, &bytes_of(py, path)?, |bytes, format, source| draw::scene(py, bytes, format, source))
}

/// Reads the scene of a text, given as str or bytes.
pub(crate) fn parse(text: &Bound<'_, PyAny>, name: &str, folder: Option<&Path>) -> PyResult<midair::Scene> {
    let bytes = match (text.cast::<PyBytes>(), text.cast::<PyString>()) {
        (Ok(bytes), _) => bytes.as_bytes().to_vec(),
        (_, Ok(text)) => {
            text.to_str().map_err(|_| invalid("text", "no Unicode", "give TOML or JSON"))?.as_bytes().to_vec()
        }
        _ => return Err(invalid("text", &crate::numbers::quoted(text), "give TOML or JSON as str or bytes")),
    };
    draw::scene(text.py(), &bytes, Format::of_text(&bytes), Source { name, folder })
}

/// Returns a scene as text.
pub(crate) fn written(scene: &midair::Scene, format: Format, provenance: &Provenance) -> PyResult<String> {
    files::write(scene, format, provenance).map_err(refused)
}

/// Writes a file completely or not at all, like every result.
pub(crate) fn save(py: Python<'_>, path: &Path, text: &str) -> PyResult<()> {
    toolbox::call(py, "write", (path, text.as_bytes())).map(drop)
}

/// Returns the files of a scene: the scene file itself, and those that it names. `text` is its content, for files that can
/// be read only once (pipes).
#[pyfunction]
#[pyo3(signature = (path, text=None))]
pub(crate) fn scene_files(py: Python<'_>, path: PathBuf, text: Option<Vec<u8>>) -> PyResult<Vec<PathBuf>> {
    let bytes = text.map_or_else(|| bytes_of(py, &path), Ok)?;
    let named = read(&path, &bytes, |bytes, format, source| files::references(bytes, format, source).map_err(refused))?;
    Ok([path].into_iter().chain(named).collect())
}

/// Returns every table of a scene file with its keys, in order: an example as JSON and the meaning of each key.
#[pyfunction]
pub(crate) fn scene_keys(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    keys(py, files::tables())
}

/// Returns the tables that only sweep files have, in the same form.
#[pyfunction]
pub(crate) fn sweep_keys(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    keys(py, files::sweep_tables())
}

fn keys(py: Python<'_>, all: impl IntoIterator<Item = (&'static str, &'static [Key])>) -> PyResult<Bound<'_, PyDict>> {
    let tables = PyDict::new(py);
    for (path, keys) in all {
        let table = tables.call_method1("setdefault", (path, PyDict::new(py)))?;
        for key in keys {
            table.set_item(key.name, (key.example, key.about))?;
        }
    }
    Ok(tables)
}

/// Returns the tables in a sweep file's text; `name` is its name in errors.
#[pyfunction]
pub(crate) fn read_sweep<'py>(py: Python<'py>, text: &[u8], name: Lossy) -> PyResult<Bound<'py, PyAny>> {
    let tables = files::read_sweep(text, Format::of_document(&name, text), Source { name: &name, folder: None });
    node::object(py, &tables.map_err(refused)?)
}

/// Returns the SceneError about a value in a text with its line; None if the text has no such value.
///
/// Parameters
/// ----------
/// error : midair.SceneError
///
/// Returns
/// -------
/// midair.SceneError or None
#[pyfunction]
pub(crate) fn placed(text: &[u8], name: Lossy, error: &Bound<'_, PyAny>) -> PyResult<Option<Py<PyAny>>> {
    let source = Source { name: &name, folder: None };
    let fault = files::placed(text, Format::of_document(&name, text), source, &error_of(error)?);
    Ok(fault.map(|fault| refused(fault).into_value(error.py()).into_any()))
}

/// Line number of each row (R,), and the rows (R, C) in the order of the names.
type Read<'py> = (Array1<'py, usize>, Array2<'py, f64>);

/// Reads the table in a file's bytes; `name` is its name in errors. `names` are the columns, by default those of positions,
/// and `optional` further ones, which are NaN where they are missing. `length` is the unit of x, y and z without one.
#[pyfunction(name = "read_table")]
#[pyo3(signature = (text, name, names=None, optional=None, units="in metres", example="", length="m"))]
pub(crate) fn table<'py>(
    py: Python<'py>,
    text: &[u8],
    name: &str,
    names: Option<Vec<String>>,
    optional: Option<Vec<String>>,
    units: &str,
    example: &str,
    length: &str,
) -> PyResult<Read<'py>> {
    let names: Option<Vec<&str>> = names.as_ref().map(|names| names.iter().map(String::as_str).collect());
    let optional = optional.unwrap_or_default();
    let optional: Vec<&str> = optional.iter().map(String::as_str).collect();
    let choices = names.as_deref().map(|names| [names]);
    let own = |choices| Columns { choices, optional: &optional, units, example, length };
    let columns = choices.as_ref().map_or(Columns { length, ..POSITIONS }, |choices| own(choices));
    let table = files::read_table(text, name, columns).map_err(refused)?;
    let rows =
        PyArray2::from_vec2(py, &table.rows).map_err(|error| refused(midair::Error::invalid("text", error, "")))?;
    Ok((PyArray1::from_vec(py, table.lines), rows))
}

/// Returns the CSV of a drive (N,), with the positions (N, 3) of the transducers in m if given.
#[pyfunction]
#[pyo3(signature = (drive, positions=None))]
pub(crate) fn drive_to_csv(drive: &Bound<'_, PyAny>, positions: Argument<'_, '_>) -> PyResult<String> {
    let positions = positions.map(|positions| reading::vectors("positions", positions)).transpose()?;
    Ok(files::write_drive(positions.as_deref(), &reading::drive("drive", drive)?))
}

/// Reads the drive (N,) in a CSV of `drive_to_csv`; `name` is the file's name in errors.
#[pyfunction]
pub(crate) fn drive_from_csv<'py>(py: Python<'py>, text: &[u8], name: Lossy) -> PyResult<Array1<'py, Complex32>> {
    Ok(give::list(py, files::read_drive(text, &name).map_err(refused)?))
}
