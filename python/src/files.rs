//! Scene files and scenes as text: read up to a size limit; written completely or not at all.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use midair::Key;
use midair::files::{self, Format, MOST_BYTES, Provenance, Source};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyString};

use crate::draw;
use crate::error::{invalid, refused};
use crate::scene::Scene;
use crate::toolbox;

/// Converts an error of the file system to the OSError that Python's own functions would raise.
fn os_error(error: &std::io::Error, path: &Path) -> PyErr {
    let text = error.to_string();
    let text = text.split(" (os error").next().unwrap_or_default().to_owned();
    PyOSError::new_err((error.raw_os_error(), text, path.to_string_lossy().into_owned()))
}

pub(crate) fn bytes_of(path: &Path) -> PyResult<Vec<u8>> {
    let mut bytes = Vec::new();
    // Reads one byte more than allowed, to detect that a file is too large.
    File::open(path)
        .and_then(|file| file.take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes))
        .map_err(|error| os_error(&error, path))?;
    Ok(bytes)
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
    read(path, &bytes_of(path)?, |bytes, format, source| draw::scene(py, bytes, format, source))
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

/// Writes a file completely or not at all, like every result.
pub(crate) fn save(py: Python<'_>, path: &Path, text: &str) -> PyResult<()> {
    toolbox::call(py, "write", (path, text.as_bytes())).map(drop)
}

#[pymethods]
impl Scene {
    /// Read a scene file: JSON by its ending .json, TOML by .toml, else by its content.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     File to read.
    ///
    /// Returns
    /// -------
    /// midair.Scene
    ///     The scene.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For an error in it. The text states line and column, and shows a correct line.
    /// OSError
    ///     If it cannot be read, such as FileNotFoundError.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::of(load(py, &path)?)?.reported(py, &[])
    }

    /// Read a scene from text, TOML or JSON by its content.
    ///
    /// Parameters
    /// ----------
    /// text : str or bytes
    ///     The text.
    /// name : str, optional
    ///     Name of the text in errors.
    /// folder : str or path, optional
    ///     Folder of the files that the text names, which are rejected without one.
    ///
    /// Returns
    /// -------
    /// midair.Scene
    ///     The scene.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For an error in it. The text states line and column, and shows a correct line.
    #[staticmethod]
    #[pyo3(signature = (text, *, name="scene", folder=None))]
    fn parse(text: &Bound<'_, PyAny>, name: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        Self::of(parse(text, name, folder.as_deref())?)?.reported(text.py(), &[])
    }

    /// Write the scene as TOML or (by the ending .json) JSON, whole or not at all.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     File to write.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If it cannot be written.
    /// SceneError
    ///     For parts that no file can store, such as a signature of your own factors.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let text = files::write(&self.inner, Format::of(&path.to_string_lossy()), &Provenance::default());
        save(py, &path, &text.map_err(refused)?)
    }
}

/// Returns the files of a scene: the scene file itself, and those that it names. `text` is its content, for files that can
/// be read only once (pipes).
#[pyfunction]
#[pyo3(signature = (path, text=None))]
pub(crate) fn scene_files(path: PathBuf, text: Option<Vec<u8>>) -> PyResult<Vec<PathBuf>> {
    let bytes = text.map_or_else(|| bytes_of(&path), Ok)?;
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
