//! `midair.Wall`, `midair.Sphere`, ...: obstacles described by a few numbers, one class for each kind in the core.

use midair::{Obstacle, Surface};

use crate::mesh::{Mesh, surface};
use crate::prelude::*;

/// A field of a body: a place or a number.
trait Part: Sized {
    fn read(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Self>;
    fn bits(&self) -> Vec<u64>;
}

impl Part for f64 {
    fn read(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        read::real(item, value)
    }

    fn bits(&self) -> Vec<u64> {
        vec![bits(*self)]
    }
}

impl Part for (f64, f64, f64) {
    fn read(item: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        read::place(item, value).map(Into::into)
    }

    fn bits(&self) -> Vec<u64> {
        [self.0, self.1, self.2].map(bits).to_vec()
    }
}

/// Declares the classes: each kind's name, and its fields in the order of the arguments. The kinds have the core's order.
macro_rules! bodies {
    ($( $(#[doc = $doc:literal])+ $name:ident { $( $(#[doc = $about:literal])+ $part:ident: $type:ty, )+ } )+) => {
        $(
            $(#[doc = $doc])+
            #[pyclass(frozen, eq, hash, module = "midair")]
            #[derive(Clone, PartialEq)]
            pub(crate) struct $name {
                $( $part: $type, )+
                kind: Surface,
            }

            hashed!($name: self => ($( self.$part.bits(), )+));

            #[pymethods]
            impl $name {
                #[staticmethod]
                #[pyo3(name = "_new", signature = ($($part,)+ kind="rigid"))]
                fn new($( $part: &Bound<'_, PyAny>, )+ kind: &str) -> PyResult<Self> {
                    let item = stringify!($name).to_lowercase();
                    let kind = surface(&format!("{item}.kind"), kind)?;
                    Ok(Self { $( $part: Part::read(&format!("{item}.{}", stringify!($part)), $part)?, )+ kind })
                }

                $(
                    $(#[doc = $about])+
                    #[getter]
                    fn $part(&self) -> $type {
                        self.$part
                    }
                )+

                /// "rigid" or "soft".
                #[getter]
                fn kind(&self) -> &'static str {
                    self.kind.name()
                }

                fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
                    restored::<Self>(py, ($( self.$part, )+ self.kind.name()))
                }

                #[staticmethod]
                fn _restore($( $part: $type, )+ kind: &str) -> PyResult<Self> {
                    Ok(Self { $( $part, )+ kind: surface("kind", kind)? })
                }

                fn __repr__(&self) -> String {
                    let parts = [$( format!("{}={:?}", stringify!($part), self.$part) ),+].join(", ");
                    format!("{}({parts}, kind=\"{}\")", stringify!($name), self.kind.name())
                }
            }
        )+

        /// Adds the classes to the module.
        pub(crate) fn add_bodies(module: &Bound<'_, PyModule>) -> PyResult<()> {
            $( module.add_class::<$name>()?; )+
            Ok(())
        }

        /// Names of the classes.
        pub(crate) const NAMES: &[&str] = &[$( stringify!($name) ),+];

        /// Returns the obstacle of a Python object, or None if the object is of another class.
        pub(crate) fn read_body(item: &Bound<'_, PyAny>) -> Option<Obstacle> {
            $( if let Ok(body) = item.cast::<$name>() {
                let $name { $( $part, )+ kind } = body.get();
                return Some(Obstacle::$name { $( $part: (*$part).into(), )+ kind: *kind });
            } )+
            None
        }

        /// Returns the Python object of an obstacle, or None if no class here is of its kind.
        pub(crate) fn shown_body<'py>(py: Python<'py>, obstacle: &Obstacle) -> PyResult<Option<Bound<'py, PyAny>>> {
            Ok(match obstacle {
                $( &Obstacle::$name { $( $part, )+ kind } => {
                    Some(Bound::new(py, $name { $( $part: $part.into(), )+ kind })?.into_any())
                } )+
                _ => None,
            })
        }
    };
}

bodies! {
    /// Infinite plane that reflects waves, for a scene's `obstacles`.
    ///
    /// Parameters
    /// ----------
    /// point : (3,) array_like
    ///     Any point of the wall in m.
    /// normal : (3,) array_like
    ///     Direction that the wall faces. Sound is on the array's side, whichever way the normal points; the normal
    ///     chooses the side only where the array lies in the wall.
    /// kind : {"rigid", "soft"}, optional
    ///     "rigid" is a solid: on it |p| doubles. "soft" gives the sound no resistance: on it p = 0.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For a wrong point, normal or kind; and for a normal of length 0, when a scene takes the wall.
    ///
    /// See Also
    /// --------
    /// midair.Plane : the plane of a picture.
    ///
    /// Examples
    /// --------
    /// >>> import midair
    /// >>> table = midair.Wall([0, 0, 0.2], [0, 0, -1])
    /// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]], obstacles=[table])
    /// >>> scene.obstacles
    /// [Wall(point=(0.0, 0.0, 0.2), normal=(0.0, 0.0, -1.0), kind="rigid")]
    Wall {
        /// Any point of the wall (x, y, z) in m.
        point: (f64, f64, f64),
        /// Direction that the wall faces (x, y, z), as given.
        normal: (f64, f64, f64),
    }
    /// Sphere that scatters waves; it must be the only one of a scene's `obstacles`.
    ///
    /// Parameters
    /// ----------
    /// center : (3,) array_like
    ///     Centre in m.
    /// radius : float
    ///     Radius in m, up to 12 wavelengths.
    /// kind : {"rigid", "soft"}, optional
    ///     "rigid" is a solid; "soft" gives the sound no resistance: on it p = 0.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For a wrong center, radius or kind; and for points inside the sphere, when a scene takes it.
    ///
    /// Notes
    /// -----
    /// The scattered wave is exact, by its series.
    ///
    /// Examples
    /// --------
    /// >>> import midair
    /// >>> ball = midair.Sphere([0, 0, 0.1], 0.02)
    /// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]], obstacles=[ball])
    /// >>> scene.obstacles
    /// [Sphere(center=(0.0, 0.0, 0.1), radius=0.02, kind="rigid")]
    Sphere {
        /// Centre (x, y, z) in m.
        center: (f64, f64, f64),
        /// Radius in m.
        radius: f64,
    }
}

/// Returns the classes by name, each with its fields and how many numbers a field has.
#[pyfunction]
pub(crate) fn bodies(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let classes = PyDict::new(py);
    for (name, body) in NAMES.iter().zip(Obstacle::BODIES) {
        let parts: Vec<_> = body.parts.iter().map(|(key, count)| (key.name, *count)).collect();
        classes.set_item(name, parts.into_py_dict(py)?)?;
    }
    Ok(classes)
}

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
