//! Tables of a scene file that Python reads for the core: shapes and images as points, meshes, and drawings as paths.

use std::path::Path;

use midair::files::{self, Drawing, Format, Source};

use crate::array::Array;
use crate::error::{SceneError, error_of};
use crate::mesh::indices;
use crate::prelude::*;
use crate::toolbox;

type Argument<'py> = Option<Bound<'py, PyAny>>;

/// Reads the scene of a document.
pub(crate) fn scene(py: Python<'_>, bytes: &[u8], format: Format, source: Source<'_>) -> PyResult<midair::Scene> {
    let draw = |name: &str, text: &str| drawing(py, name, text, source.folder);
    drawn(py, draw, |draw| files::read_drawn(bytes, format, source, draw))
}

/// Reads a document with moving points.
pub(crate) fn motion(
    py: Python<'_>,
    bytes: &[u8],
    format: Format,
    source: Source<'_>,
) -> PyResult<Option<files::Motion>> {
    let draw = |name: &str, text: &str| drawing(py, name, text, source.folder);
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
    let result = read(&mut |name, text| {
        drawing(name, text).map_err(|exception| {
            let error = error_of(exception.value(py)).unwrap_or_else(|_| midair::Error::stopped());
            if !exception.is_instance_of::<SceneError>(py) {
                other = Some(exception);
            }
            error
        })
    });
    other.map_or_else(|| result.map_err(refused), Err)
}

/// Returns the points of a table, the mesh of an obstacle's file, the outline of a path, or the array of a file.
fn drawing(py: Python<'_>, name: &str, text: &str, folder: Option<&Path>) -> PyResult<Drawing> {
    if name == "array.positions" {
        let array = toolbox::call(py, "array_of", (text, folder))?;
        return Ok(Drawing::Array(array.extract::<PyRef<'_, Array>>()?.inner.clone()));
    }
    if !matches!(name, "obstacles" | "motion.path") {
        return points(py, name, text, folder).map(|(points, request)| Drawing::Points(points, request));
    }
    let function = if name == "obstacles" { "mesh" } else { "outline" };
    let (vertices, rest): (Bound<'_, PyAny>, Bound<'_, PyAny>) =
        toolbox::call(py, function, (text, folder))?.extract()?;
    let vertices = read::vectors("vertices", &vertices)?;
    Ok(match function {
        "mesh" => Drawing::Mesh(vertices, indices(&rest)?),
        _ => Drawing::Outline(vertices, rest.extract()?),
    })
}

/// Returns the points of a table, and their targets and weights.
fn points(py: Python<'_>, name: &str, text: &str, folder: Option<&Path>) -> PyResult<(Vec<[f64; 3]>, Request)> {
    let drawn = toolbox::call(py, "points", (name, text, folder))?;
    let (points, pressures, weights): (Bound<'_, PyAny>, Argument<'_>, Argument<'_>) = drawn.extract()?;
    let points = read::vectors("points", &points)?;
    let request = read::request(points.len(), pressures.as_ref(), weights.as_ref())?;
    Ok((points, request))
}
