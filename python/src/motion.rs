//! Scene files with moving points, read for the Python package, which makes their paths.

use std::path::PathBuf;

use midair::files::Motion;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::draw;
use crate::files::{bytes_of, read};
use crate::read::option_dict;
use crate::scene::Scene;

/// Returns the scene and the settings of a file with moving points, or None if it has no `[motion]`. `start` is called with
/// name and text of each table of a path, and returns the points of the first frame.
#[pyfunction]
pub(crate) fn read_motion<'py>(
    path: PathBuf,
    start: &Bound<'py, PyAny>,
) -> PyResult<Option<(Scene, Bound<'py, PyDict>)>> {
    let found = read(&path, &bytes_of(&path)?, |bytes, format, source| draw::motion(bytes, format, source, start))?;
    let Some(Motion { scene, settings }) = found else { return Ok(None) };
    Ok(Some((Scene::of(scene)?.reported(start.py(), &[])?, option_dict(start.py(), &settings)?)))
}
