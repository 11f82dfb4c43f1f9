//! Beads in flight, for `midair.fly` and `midair.path.fastest`: forces on a bead; simulates eight beads at once.

use midair::motion::{Flight, State};
use midair::{Medium, Particle};
use numpy::{PyArray1, PyArray2, PyReadonlyArrayDyn, PyReadwriteArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::ctrl_c::attend;
use crate::error::{invalid, warn_all};
use crate::give;
use crate::gorkov::GRAVITY;
use crate::instruction_set::instruction_set;
use crate::read;
use crate::scene::Scene;

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// A small sphere in the air of a scene, with the properties that `midair.gorkov` takes.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Bead {
    particle: Particle,
    medium: Medium,
    gravity: [f64; 3],
}

#[pymethods]
impl Bead {
    #[new]
    #[pyo3(signature = (scene, radius=None, density=None, sound_speed=None, gravity=None))]
    fn new<'py>(
        scene: &Bound<'py, Scene>,
        radius: Argument<'_, 'py>,
        density: Argument<'_, 'py>,
        sound_speed: Argument<'_, 'py>,
        gravity: Argument<'_, 'py>,
    ) -> PyResult<Self> {
        let default = Particle::default();
        let positive = |item: &str, value: Argument<'_, 'py>, own: f64| match read::real_or(item, value, own)? {
            value if value > 0.0 && value.is_finite() => Ok(value),
            value => Err(invalid(item, &value.to_string(), "give a number above 0")),
        };
        let particle = Particle {
            radius: positive("radius", radius, default.radius)?,
            density: positive("density", density, default.density)?,
            sound_speed: positive("sound_speed", sound_speed, default.sound_speed)?,
        };
        let gravity = gravity.map_or(Ok(GRAVITY), |gravity| read::place("gravity", gravity))?;
        let medium = scene.get().inner.medium();
        warn_all(scene.py(), particle.remark(medium))?;
        Ok(Self { particle, medium, gravity })
    }

    /// The factors (2,) of |p|^2 and -|grad p|^2 in Gor'kov's potential.
    #[getter]
    fn factors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        give::list(py, self.particle.factors(self.medium).to_vec())
    }

    /// Effective mass in kg: the bead's own mass and half the mass of the air that it displaces.
    #[getter]
    fn mass(&self) -> f64 {
        self.particle.mass(self.medium)
    }

    /// Returns the forces (K, 3) in N, without weight and buoyancy, that cause these velocities and accelerations (K, 3).
    fn needed<'py>(
        &self,
        py: Python<'py>,
        velocities: Bound<'py, PyAny>,
        accelerations: Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (velocities, accelerations) =
            (read::vectors("velocities", &velocities)?, read::vectors("accelerations", &accelerations)?);
        let each = velocities.iter().zip(&accelerations);
        let needed: Vec<_> = each.map(|(&v, &a)| self.particle.needed(self.medium, v, a)).collect();
        give::rows(py, &needed)
    }

    /// Returns arguments of `midair.rest` for a bead to which the trap must give a `force` (3,) in N in addition to its
    /// weight and buoyancy. The gravity in them is increased accordingly.
    fn under<'py>(&self, py: Python<'py>, force: [f64; 3]) -> PyResult<Bound<'py, PyDict>> {
        let Particle { radius, density, sound_speed } = self.particle;
        let heft = self.particle.weight(self.medium, [1.0; 3])[0];
        let keywords = [("radius", radius), ("density", density), ("sound_speed", sound_speed)].into_py_dict(py)?;
        let gravity = [0, 1, 2].map(|axis| self.gravity[axis] - force[axis] / heft);
        keywords.set_item("gravity", gravity)?;
        Ok(keywords)
    }

    /// Simulates eight beads from step `first` on (the core's `Flight::fly`); returns the last step. All arrays are in C
    /// order.
    ///
    /// state (6, 3, 8): place, velocity and accelerations, updated; reach (8,) in m; forces (K, 84, 3, 8): polynomial
    /// coefficients in N around centres (steps (K - 1) + 1, 3, 8) in m; places (K, 3, 8): output; step in s, unit in m.
    #[allow(clippy::too_many_arguments, reason = "as PyO3 gives them")]
    fn fly<'py>(
        &self,
        py: Python<'py>,
        mut state: PyReadwriteArrayDyn<'py, f64>,
        reach: [f64; 8],
        forces: PyReadonlyArrayDyn<'py, f64>,
        centres: PyReadonlyArrayDyn<'py, f64>,
        first: usize,
        mut places: PyReadwriteArrayDyn<'py, f64>,
        time: (f64, usize, f64),
    ) -> PyResult<usize> {
        let (step, steps, unit) = time;
        let flight = Flight { particle: self.particle, gravity: self.gravity, step, steps, unit };
        let set = instruction_set()?;
        let state: &mut State = eights_mut(&mut state)?
            .as_chunks_mut()
            .0
            .try_into()
            .map_err(|_| invalid("state", "of another shape", "give (6, 3, 8)"))?;
        let forces = eights(&forces)?.as_chunks().0.as_chunks().0;
        let centres = eights(&centres)?.as_chunks().0;
        let places = eights_mut(&mut places)?.as_chunks_mut().0;
        attend(py, None, |mut control| {
            flight.fly((set, self.medium), state, reach, forces, centres, first, places, &mut control)
        })
    }
}

fn eights<'a>(array: &'a PyReadonlyArrayDyn<'_, f64>) -> PyResult<&'a [[f64; 8]]> {
    Ok(array.as_slice()?.as_chunks().0)
}

fn eights_mut<'a>(array: &'a mut PyReadwriteArrayDyn<'_, f64>) -> PyResult<&'a mut [[f64; 8]]> {
    Ok(array.as_slice_mut()?.as_chunks_mut().0)
}
