//! Tables of a scene file that Python draws as points: `[shape]` and `[image]`, by `midair.drawing`.

use std::path::Path;

use midair::Request;
use midair::files::{self, Format, Source};
use pyo3::prelude::*;

use crate::error::{SceneError, refused};
use crate::read;

type Argument<'py> = Option<Bound<'py, PyAny>>;

/// The scene of a document.
pub(crate) fn scene(py: Python<'_>, bytes: &[u8], format: Format, source: Source<'_>) -> PyResult<midair::Scene> {
    // What is no refusal of the table, such as Ctrl-C, goes up as it is.
    let mut other = None;
    let mut draw = |name: &str, text: &str| {
        points(py, name, text, source.folder).map_err(|error| {
            let told = error.value(py).to_string();
            if !error.is_instance_of::<SceneError>(py) {
                other = Some(error);
            }
            told
        })
    };
    let scene = files::read_drawn(bytes, format, source, &mut draw);
    other.map_or_else(|| scene.map_err(refused), Err)
}

/// Points of a table, and what is asked of them.
fn points(py: Python<'_>, name: &str, text: &str, folder: Option<&Path>) -> PyResult<(Vec<[f64; 3]>, Request)> {
    let drawn = py.import("midair.drawing")?.call_method1("points", (name, text, folder))?;
    let (points, pressures, weights): (Bound<'_, PyAny>, Argument<'_>, Argument<'_>) = drawn.extract()?;
    let points = read::vectors("points", &points)?;
    let request = read::request(points.len(), pressures.as_ref(), weights.as_ref())?;
    Ok((points, request))
}
