//! Scenes with changed parts: `scene.replace(...)`, and keywords of `solve` beside a scene.

use midair::Request;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::Array;
use crate::error::{invalid, refused};
use crate::keywords::Keywords;
use crate::numbers::quoted;
use crate::plane::Plane;
use crate::read;
use crate::scene::{ARGUMENTS, Scene};

// In this file instead of scene.rs, to keep that file short.
#[pymethods]
impl Scene {
    /// Return a copy of the scene with other parts. Parts that are not given stay, also the solver of a scene file.
    ///
    /// Parameters
    /// ----------
    /// **changes
    ///     The new parts, with the names of the constructor's arguments, or `plane`. None removes pressures, weights or
    ///     the plane, and leaves anything else as it is.
    ///
    /// Returns
    /// -------
    /// midair.Scene
    ///     The new scene.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For a part of another name, for what `Scene` refuses, and for pressures and weights of another number of
    ///     points.
    ///
    /// Examples
    /// --------
    /// >>> import midair
    /// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]], 100.0)
    /// >>> scene.replace(pressures=200.0).pressures
    /// array([200.])
    #[pyo3(signature = (**changes))]
    fn replace(&self, py: Python<'_>, changes: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        changes.map_or_else(|| Ok(self.clone()), |changes| replaced(py, self, changes))
    }
}

/// Returns the scene with changes, which are named like the constructor's arguments.
fn replaced(py: Python<'_>, scene: &Scene, changes: &Bound<'_, PyDict>) -> PyResult<Scene> {
    let (own, keywords) = (&*scene.inner, Keywords::of(py, Some(changes))?);
    let array = match keywords.take("array")? {
        None => scene.array(),
        Some(array) => match array.cast::<Array>() {
            Ok(array) => array.get().clone(),
            Err(_) => return Err(invalid("array", &quoted(&array), "give a midair.Array")),
        },
    };
    let array = keywords.array(array)?;
    let medium = keywords.medium(Some(own.medium()), &array)?;
    let points = keywords.take("points")?;
    let points = points.map_or_else(|| Ok(own.points().to_vec()), |points| read::vectors("points", &points))?;
    let kept = |item: &str, own: &Option<Vec<f64>>| match own {
        Some(own) if own.len() != points.len() => {
            let cure = format!("give {item} for the {} points, or None", points.len());
            Err(invalid(item, &format!("kept from {} points", own.len()), &cure))
        }
        own => Ok(own.clone()),
    };
    let requested = own.request();
    let given = match keywords.take_or_none("pressures")? {
        None => Request {
            pressures: kept("pressures", &requested.pressures)?,
            phases: requested.phases.clone(),
            ..Request::default()
        },
        Some(value) if value.is_none() => Request::default(),
        Some(value) => read::pressures(&value, points.len())?,
    };
    let weights = match keywords.take_or_none("weights")? {
        None => kept("weights", &requested.weights)?,
        Some(value) if value.is_none() => None,
        Some(value) => Some(read::list("weights", &value, points.len())?),
    };
    let request = Request { weights, ..given };
    let mut extras = own.extras();
    if let Some(plane) = keywords.take_or_none("plane")? {
        extras.plane = match plane.cast::<Plane>() {
            Ok(plane) => Some(plane.get().inner),
            Err(_) if plane.is_none() => None,
            Err(_) => return Err(invalid("plane", &quoted(&plane), "give a midair.Plane or None")),
        };
    }
    keywords.write_extras(&mut extras, array.inner.len())?;
    if let Some(unknown) = keywords.unknown("part of a scene", &[&ARGUMENTS[..], &["plane"]].concat()) {
        return Err(refused(unknown));
    }
    Scene::made(&array, medium, points, request, extras)?.reported(py, &scene.doubts())
}
