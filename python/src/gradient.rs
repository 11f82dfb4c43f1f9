//! The core of `midair.grad`: a quantity of the field at points, and its gradients.

use midair::{Bead, Quantity};

use crate::array::Array;
use crate::bead::read_bead;
use crate::give::fresh;
use crate::numbers::{NUMBER, Numbers, REAL, numbers, shaped};
use crate::prelude::*;
use crate::solution::{Solution, about, played};

type Argument<'py> = Option<Bound<'py, PyAny>>;

/// Returns model, drive and points of the first argument: a Scene, a Solution alone, or an Array in its own air.
fn subject<'py>(
    scene: &Bound<'py, PyAny>,
    drive: Argument<'py>,
    points: Argument<'py>,
) -> PyResult<(Model, Vec<Complex64>, Vec<[f64; 3]>)> {
    let (model, drive, origin, points) = if let Ok(array) = scene.cast::<Array>() {
        let array = array.get();
        let drive = drive.ok_or_else(|| invalid("drive", "None", "give one (N,)"))?;
        let model = array.ready(array.inner.medium(&[]).map_err(refused)?)?.model.clone();
        (model, drive, None, points)
    } else {
        let (scene, drive, points) = about(scene, drive, points)?;
        (scene.get().model(), drive, Some(scene), points)
    };
    let drive = match drive.cast::<Solution>() {
        Ok(_) => {
            let wide = |q: &midair::Complex32| Complex64::new(f64::from(q.re), f64::from(q.im));
            played(&drive)?.iter().map(wide).collect()
        }
        Err(_) => read::complexes("drive", &drive)?,
    };
    let points = match (points, origin) {
        (Some(points), _) => read::vectors("points", &points)?,
        (None, Some(scene)) => scene.get().inner.points().to_vec(),
        (None, None) => return Err(invalid("points", "None", "give them beside an Array: (M, 3) in m")),
    };
    Ok((model, drive, points))
}

/// Reads a cotangent in the core's order, point by point.
fn cotangent(quantity: Quantity, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f64>> {
    match quantity {
        Quantity::Pressure => {
            let cure = format!("give one number, or one for each of the {count} points");
            let values = numbers::<Complex64>("cotangent", value, NUMBER, &cure)?;
            Ok(values.repeated("cotangent", &cure, &[count])?.iter().flat_map(|w| [w.re, w.im]).collect())
        }
        _ if quantity.width() == 1 => read::list("cotangent", value, count),
        _ => {
            let cure = format!("give one real number, or three for each of the {count} points: ({count}, 3)");
            let fits = |shape: &[usize]| shape.is_empty() || *shape == [count, 3];
            let Numbers { values, shape } = shaped("cotangent", value, REAL, &cure, fits)?;
            Ok(if shape.is_empty() { values.repeat(3 * count) } else { values })
        }
    }
}

/// Returns the values (M,) or (M, 3) as a NumPy array.
fn array_of(py: Python<'_>, quantity: Quantity, value: Vec<f64>) -> PyResult<Bound<'_, PyAny>> {
    Ok(match quantity {
        Quantity::Pressure => {
            let pairs = value.as_chunks::<2>().0.iter().map(|&[re, im]| Complex64::new(re, im));
            pairs.collect::<Vec<_>>().into_pyarray(py).into_any()
        }
        _ if quantity.width() == 1 => value.into_pyarray(py).into_any(),
        _ => fresh(py, value.as_chunks().0)?.into_any(),
    })
}

/// Returns the values of a quantity and, with a cotangent, its gradients with respect to drive, points, positions, normals
/// and sound speed.
#[pyfunction]
#[pyo3(signature = (quantity, scene, drive, points, cotangent=None, bead=None))]
pub(crate) fn gradient<'py>(
    py: Python<'py>,
    quantity: &str,
    scene: &Bound<'py, PyAny>,
    drive: Argument<'py>,
    points: Argument<'py>,
    cotangent: Argument<'py>,
    bead: Argument<'py>,
) -> PyResult<Bound<'py, PyTuple>> {
    let (model, drive, points) = subject(scene, drive, points)?;
    let Bead { particle, .. } = bead.map_or_else(|| Ok(model.bead()), |bead| read_bead(&bead))?;
    let quantity = Quantity::named(quantity, particle).map_err(refused)?;
    if let Some(particle) = quantity.particle() {
        warn_all(py, particle.remark(model.medium()))?;
    }
    let Some(cotangent) = cotangent else {
        let value = attend(py, None, |mut control| quantity.value(&model, &drive, &points, &mut control))?;
        return PyTuple::new(py, [array_of(py, quantity, value)?]);
    };
    let cotangent = self::cotangent(quantity, &cotangent, points.len())?;
    let by =
        attend(py, None, |mut control| midair::gradient(&model, &drive, &points, quantity, &cotangent, &mut control))?;
    let parts = [
        array_of(py, quantity, by.value)?,
        by.drive.into_pyarray(py).into_any(),
        fresh(py, &by.points)?.into_any(),
        fresh(py, &by.positions)?.into_any(),
        fresh(py, &by.normals)?.into_any(),
        by.sound_speed.into_pyobject(py)?.into_any(),
    ];
    PyTuple::new(py, parts)
}
