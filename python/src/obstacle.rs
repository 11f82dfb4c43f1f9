//! The argument `obstacles`: conversion from Python and back.

use std::sync::Arc;

use midair::Obstacle;
use pyo3::prelude::*;

use crate::bodies::{NAMES, read_body, shown_body};
use crate::error::invalid;
use crate::mesh::Mesh;
use crate::numbers::quoted;

/// Reads a list of obstacles; None is an empty list.
pub(crate) fn read_obstacles(value: &Bound<'_, PyAny>) -> PyResult<Vec<Obstacle>> {
    let cure = &format!("give a list of midair.{} and Mesh", NAMES.join(", "));
    if value.is_none() {
        return Ok(Vec::new());
    }
    let all = value.try_iter().map_err(|_| invalid("obstacles", &quoted(value), cure))?;
    let one = |(k, item): (usize, PyResult<Bound<'_, PyAny>>)| {
        let item = item?;
        if let Some(body) = read_body(&item) {
            return Ok(body);
        }
        match item.cast::<Mesh>() {
            Ok(mesh) => Ok(Obstacle::Mesh(Arc::clone(&mesh.get().inner))),
            Err(_) => Err(invalid(&format!("obstacles[{k}]"), &quoted(&item), cure)),
        }
    };
    all.enumerate().map(one).collect()
}

/// Returns obstacles as Python objects.
pub(crate) fn obstacle_objects<'py>(py: Python<'py>, obstacles: &[Obstacle]) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let one = |obstacle: &Obstacle| match (shown_body(py, obstacle)?, obstacle) {
        (Some(body), _) => Ok(body),
        (None, Obstacle::Mesh(mesh)) => Ok(Bound::new(py, Mesh { inner: Arc::clone(mesh) })?.into_any()),
        _ => Err(invalid("obstacles", "of an unknown kind", "install one version of midair")),
    };
    obstacles.iter().map(one).collect()
}
