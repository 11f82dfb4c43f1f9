//! `midair.Bead`, the sphere for which traps are made, and the argument `bead`.

use midair::{Bead as Core, Particle};

use crate::prelude::*;

/// Small sphere that sound holds, and the gravity that acts on it.
///
/// Functions with an argument `bead` take one, or a dict of its parameters. The default is expanded polystyrene, 2 mm across.
///
/// Parameters
/// ----------
/// radius : float, optional
///     Radius in m.
/// density : float, optional
///     Density in kg/m^3; that of polystyrene foam is 29 (Marzo et al., Nature Communications 6, 8661, 2015).
/// sound_speed : float, optional
///     Sound speed in the sphere in m/s.
/// gravity : (3,) array_like, optional
///     Gravity in m/s^2.
///
/// Raises
/// ------
/// SceneError
///     For a number that is not above 0, and a gravity that is not finite.
///
/// Examples
/// --------
/// >>> import midair
/// >>> water = midair.Bead(radius=0.5e-3, density=998, sound_speed=1481)
/// >>> boards = midair.Array.preset("openmpd_pair", quantization={})
/// >>> scene = midair.Scene(boards, [[0, 0, 0]], signature="trap", bead=water)
/// >>> bool(midair.solve(scene).rest().held[0]), scene.bead == water
/// (True, True)
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone, PartialEq)]
pub(crate) struct Bead(pub(crate) Core);

hashed!(Bead: self => self.0.particle.numbers().map(|(_, value)| bits(value)).collect::<Vec<_>>());

#[pymethods]
impl Bead {
    #[staticmethod]
    #[pyo3(
        name = "_new",
        signature = (radius=None, density=None, sound_speed=None, gravity=None),
        text_signature = "(radius=1e-3, density=29, sound_speed=900, gravity=(0, 0, -9.81))"
    )]
    fn new(
        radius: Argument<'_, '_>,
        density: Argument<'_, '_>,
        sound_speed: Argument<'_, '_>,
        gravity: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let all = [("radius", radius), ("density", density), ("sound_speed", sound_speed), ("gravity", gravity)];
        of(all.into_iter().filter_map(|(name, value)| Some((name.into(), value?.clone())))).map(Self)
    }

    #[staticmethod]
    fn _restore(radius: f64, density: f64, sound_speed: f64, gravity: [f64; 3]) -> Self {
        Self(Core { particle: Particle { radius, density, sound_speed }, gravity })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let Core { particle: Particle { radius, density, sound_speed }, gravity } = self.0;
        restored::<Self>(py, (radius, density, sound_speed, gravity))
    }

    fn __repr__(&self) -> String {
        let numbers = self.0.particle.numbers().map(|(name, value)| format!("{name}={value:?}, "));
        let [x, y, z] = self.0.gravity;
        format!("Bead({}gravity=({x:?}, {y:?}, {z:?}))", numbers.collect::<String>())
    }
}

getters! {
    Bead:

    /// Radius in m.
    radius(self) -> f64 = self.0.particle.radius;

    /// Density in kg/m^3.
    density(self) -> f64 = self.0.particle.density;

    /// Sound speed in the sphere in m/s.
    sound_speed(self) -> f64 = self.0.particle.sound_speed;

    /// Gravity (x, y, z) in m/s^2.
    gravity(self) -> (f64, f64, f64) = self.0.gravity.into();
}

/// Reads a `midair.Bead`, or a dict of its parameters.
pub(crate) fn read_bead(value: &Bound<'_, PyAny>) -> PyResult<Core> {
    if let Ok(bead) = value.cast::<Bead>() {
        return Ok(bead.get().0);
    }
    match value.cast::<PyDict>() {
        Ok(entries) => of(entries.iter().map(|(name, value)| (name.to_string(), value))),
        Err(_) => Err(invalid("bead", &quoted(value), "give midair.Bead(radius=1e-3, density=29), or a dict of these")),
    }
}

/// Makes a bead from its parameters; missing ones have their defaults.
fn of<'py>(entries: impl Iterator<Item = (String, Bound<'py, PyAny>)>) -> PyResult<Core> {
    let (mut numbers, mut gravity) = (Vec::new(), None);
    for (name, value) in entries {
        let Some(key) = Core::KEYS.iter().find(|key| key.name == name) else {
            let known = Core::KEYS.iter().map(|key| key.name);
            return Err(refused(midair::Error::unknown("key of bead", name, known)));
        };
        let item = format!("bead.{name}");
        match Particle::key(key.name) {
            Some(key) => numbers.push((key.name, read::real(&item, &value)?)),
            None => gravity = Some(read::place(&item, &value)?),
        }
    }
    Core::default().with(&numbers, gravity).map_err(refused)
}
