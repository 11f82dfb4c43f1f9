//! `obstacles=` as Python gives and shows it.

use std::sync::Arc;

use midair::Obstacle;
use pyo3::prelude::*;

use crate::bodies::{Sphere, Wall};
use crate::error::invalid;
use crate::mesh::Mesh;
use crate::numbers::quoted;

/// Obstacles (K,), or none.
pub(crate) fn read_obstacles(value: &Bound<'_, PyAny>) -> PyResult<Vec<Obstacle>> {
    let cure = "give a list of midair.Wall, Sphere and Mesh";
    if value.is_none() {
        return Ok(Vec::new());
    }
    let all = value.try_iter().map_err(|_| invalid("obstacles", &quoted(value), cure))?;
    let one = |(k, item): (usize, PyResult<Bound<'_, PyAny>>)| {
        let item = item?;
        if let Ok(wall) = item.cast::<Wall>() {
            let Wall { point, normal, kind } = *wall.get();
            return Ok(Obstacle::Wall { point, normal, kind });
        }
        if let Ok(sphere) = item.cast::<Sphere>() {
            let Sphere { center, radius, kind } = *sphere.get();
            return Ok(Obstacle::Sphere { center, radius, kind });
        }
        match item.cast::<Mesh>() {
            Ok(mesh) => Ok(Obstacle::Mesh(Arc::clone(&mesh.get().inner))),
            Err(_) => Err(invalid(&format!("obstacles[{k}]"), &quoted(&item), cure)),
        }
    };
    all.enumerate().map(one).collect()
}

/// Obstacles as they were given.
pub(crate) fn shown_obstacles<'py>(py: Python<'py>, obstacles: &[Obstacle]) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let one = |obstacle: &Obstacle| match obstacle {
        &Obstacle::Wall { point, normal, kind } => Ok(Bound::new(py, Wall { point, normal, kind })?.into_any()),
        &Obstacle::Sphere { center, radius, kind } => Ok(Bound::new(py, Sphere { center, radius, kind })?.into_any()),
        Obstacle::Mesh(mesh) => Ok(Bound::new(py, Mesh { inner: Arc::clone(mesh) })?.into_any()),
        _ => Err(invalid("obstacles", "of an unknown kind", "install one version of midair")),
    };
    obstacles.iter().map(one).collect()
}
