//! Tables of a scene file that Python reads for the core: `[shape]` and `[image]` as points, an obstacle's file as a mesh.

use std::path::Path;

use midair::Request;
use midair::files::{self, Drawing, Format, Motion, Source};
use pyo3::prelude::*;

use crate::error::{SceneError, error_of, refused};
use crate::mesh::indices;
use crate::read;
use crate::toolbox;

type Argument<'py> = Option<Bound<'py, PyAny>>;

/// Reads the scene of a document.
pub(crate) fn scene(py: Python<'_>, bytes: &[u8], format: Format, source: Source<'_>) -> PyResult<midair::Scene> {
    let draw = |name: &str, text: &str| drawing(py, name, text, source.folder);
    drawn(py, draw, |draw| files::read_drawn(bytes, format, source, draw))
}

/// Reads scene and settings of a document with moving points; `start` returns the points of the first frame.
pub(crate) fn motion(
    bytes: &[u8],
    format: Format,
    source: Source<'_>,
    start: &Bound<'_, PyAny>,
) -> PyResult<Option<Motion>> {
    let py = start.py();
    let draw = |name: &str, text: &str| {
        if !name.starts_with("motion") {
            return drawing(py, name, text, source.folder);
        }
        let points = read::vectors("points", &start.call1((name, text))?)?;
        Ok(Drawing::Points(points, Request::default()))
    };
    drawn(py, draw, |draw| files::read_motion(bytes, format, source, draw))
}

/// Calls `read` with a function for the tables that Python reads. Exceptions other than SceneError, such as Ctrl-C, are
/// passed on.
fn drawn<T>(
    py: Python<'_>,
    drawing: impl Fn(&str, &str) -> PyResult<Drawing>,
    read: impl FnOnce(&mut files::Draw<'_>) -> Result<T, midair::Error>,
) -> PyResult<T> {
    let mut other = None;
    let found = read(&mut |name, text| {
        drawing(name, text).map_err(|exception| {
            let error = error_of(exception.value(py)).unwrap_or_else(|_| midair::Error::stopped());
            if !exception.is_instance_of::<SceneError>(py) {
                other = Some(exception);
            }
            error
        })
    });
    other.map_or_else(|| found.map_err(refused), Err)
}

/// Returns the points of a table, or the mesh of an obstacle's file.
fn drawing(py: Python<'_>, name: &str, text: &str, folder: Option<&Path>) -> PyResult<Drawing> {
    if name != "obstacles" {
        return points(py, name, text, folder).map(|(points, request)| Drawing::Points(points, request));
    }
    let read = toolbox::call(py, "mesh", (text, folder))?;
    let (vertices, faces): (Bound<'_, PyAny>, Bound<'_, PyAny>) = read.extract()?;
    Ok(Drawing::Mesh(read::vectors("vertices", &vertices)?, indices(&faces)?))
}

/// Returns the points of a table, and their targets and weights.
fn points(py: Python<'_>, name: &str, text: &str, folder: Option<&Path>) -> PyResult<(Vec<[f64; 3]>, Request)> {
    let drawn = toolbox::call(py, "points", (name, text, folder))?;
    let (points, pressures, weights): (Bound<'_, PyAny>, Argument<'_>, Argument<'_>) = drawn.extract()?;
    let points = read::vectors("points", &points)?;
    let request = read::request(points.len(), pressures.as_ref(), weights.as_ref())?;
    Ok((points, request))
}
