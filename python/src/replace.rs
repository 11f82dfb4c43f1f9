//! A scene with other parts: `scene.replace(...)`, and what `solve` takes beside a scene.

use midair::{Medium, Request};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::Array;
use crate::error::{invalid, refused, warn_all};
use crate::numbers::quoted;
use crate::obstacle::read_obstacles;
use crate::plane::Plane;
use crate::read;
use crate::scene::Scene;
use crate::setting::Keywords;
use crate::signature::read_signature;

/// What `Scene.replace` takes.
const PARTS: [&str; 14] = [
    "array",
    "points",
    "pressures",
    "weights",
    "frequency",
    "sound_speed",
    "temperature",
    "absorption",
    "density",
    "source_pressure",
    "directivity",
    "signature",
    "obstacles",
    "plane",
];

/// A scene with other parts, the solver of its file kept, and a warning of what is hardly meant of them.
pub(crate) fn remade(
    py: Python<'_>,
    own: &Scene,
    (array, medium): (&Array, Medium),
    points: Vec<[f64; 3]>,
    request: Request,
    (plane, signature, obstacles): (Option<midair::Plane>, Option<midair::Signature>, Vec<midair::Obstacle>),
) -> PyResult<Scene> {
    let scene = midair::Scene::new(array.inner.clone(), medium, points, request);
    let scene = scene.and_then(|scene| scene.with_signature(signature)?.with_obstacles(obstacles));
    let mut scene = scene.map_err(refused)?;
    scene.solver.clone_from(&own.inner.solver);
    scene.plane = plane;
    let (scene, told) = (Scene::with(array, scene)?, own.doubts());
    warn_all(py, scene.doubts().iter().filter(|doubt| !told.contains(doubt)))?;
    Ok(scene)
}

/// The scene with changes, named as its constructor names them.
pub(crate) fn replaced(py: Python<'_>, scene: &Scene, changes: &Bound<'_, PyDict>) -> PyResult<Scene> {
    let (own, keywords) = (&*scene.inner, Keywords::of(changes)?);
    let array = match keywords.take("array")? {
        None => scene.array(),
        Some(array) => match array.cast::<Array>() {
            Ok(array) => array.get().clone(),
            Err(_) => return Err(invalid("array", &quoted(&array), "give a midair.Array")),
        },
    };
    let array = keywords.transducer(array)?;
    let medium = keywords.medium(own.medium())?;
    let points = keywords.take("points")?;
    let points = points.map_or_else(|| Ok(own.points().to_vec()), |points| read::vectors("points", &points))?;
    let kept = |item: &str, own: &Option<Vec<f64>>| match own {
        Some(own) if own.len() != points.len() => {
            let cure = format!("give {item} for the {} points, or None", points.len());
            Err(invalid(item, &format!("kept from {} points", own.len()), &cure))
        }
        own => Ok(own.clone()),
    };
    let asked = own.request();
    let given = match keywords.take_or_none("pressures")? {
        None => Request {
            pressures: kept("pressures", &asked.pressures)?,
            phases: asked.phases.clone(),
            ..Request::default()
        },
        Some(value) if value.is_none() => Request::default(),
        Some(value) => read::pressures(&value, points.len())?,
    };
    let weights = match keywords.take_or_none("weights")? {
        None => kept("weights", &asked.weights)?,
        Some(value) if value.is_none() => None,
        Some(value) => Some(read::list("weights", &value, points.len())?),
    };
    let request = Request { weights, ..given };
    let plane = match keywords.take_or_none("plane")? {
        None => own.plane,
        Some(plane) if plane.is_none() => None,
        Some(plane) => match plane.cast::<Plane>() {
            Ok(plane) => Some(plane.get().inner),
            Err(_) => return Err(invalid("plane", &quoted(&plane), "give a midair.Plane or None")),
        },
    };
    let signature = match keywords.take_or_none("signature")? {
        None => own.signature().cloned(),
        Some(signature) if signature.is_none() => None,
        Some(signature) => Some(read_signature(&signature, array.inner.len())?),
    };
    let obstacles = keywords.take_or_none("obstacles")?;
    let obstacles = obstacles.map_or_else(|| Ok(own.obstacles().to_vec()), |given| read_obstacles(&given))?;
    if let Some(name) = keywords.left() {
        return Err(refused(midair::Error::unknown("part of a scene", name, PARTS)));
    }
    remade(py, scene, (&array, medium), points, request, (plane, signature, obstacles))
}
