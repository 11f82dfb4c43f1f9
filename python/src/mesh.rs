//! `midair.Mesh`, and its boundary equations, which Python's linear algebra solves.

use midair::{Obstacle, OptionValue, Surface, Value};
use pyo3::types::PyBytes;

use crate::give::rows;
use crate::numbers::shaped;
use crate::prelude::*;
use crate::toolbox;

/// Body of any shape that scatters waves, for a scene's `obstacles`.
///
/// Parameters
/// ----------
/// vertices : (V, 3) array_like
///     Corners in m.
/// faces : (F, 3) array_like of int
///     Three indices of vertices each, counterclockwise as seen from outside; the surface is closed.
/// kind : {"rigid", "soft"}, optional
///     "rigid" is a solid; "soft" gives the sound no resistance: on it p = 0.
///
/// Raises
/// ------
/// SceneError
///     For wrong vertices and faces, and for a surface that is not closed.
///
/// Notes
/// -----
/// The sound on its surface is solved by boundary elements, once for each array. This needs the extra midair[mesh].
///
/// Examples
/// --------
/// >>> import midair
/// >>> corners = [[0, 0, 0.1], [0.02, 0, 0.1], [0, 0.02, 0.1], [0, 0, 0.12]]
/// >>> midair.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
/// <midair.Mesh of 4 faces, 20 x 20 x 20 mm, rigid>
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone)]
pub(crate) struct Mesh {
    pub(crate) inner: Arc<midair::Mesh>,
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.inner, &other.inner) || self.inner == other.inner
    }
}

hashed!(Mesh: self => (self.inner.faces(), bits(self.inner.volume())));

#[pymethods]
impl Mesh {
    #[staticmethod]
    #[pyo3(name = "_new", signature = (vertices, faces, kind="rigid"))]
    fn new(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>, kind: &str) -> PyResult<Self> {
        let kind = surface("mesh.kind", kind)?;
        Self::of(read::vectors("mesh.vertices", vertices)?, indices(faces)?, kind)
    }

    /// Read a file of a modeller: .stl, .obj, .ply, .off or .glb (the extra midair[mesh]).
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     File to read.
    /// scale : float, optional
    ///     Length of the file's unit in m: 1e-3 for millimetres.
    /// offset : (3,) array_like, optional
    ///     Vector in m that is added after scaling and rotating.
    /// rotation : (3,), (4,) or (3, 3) array_like, optional
    ///     Rotation about the file's origin: axis times angle in rad, quaternion w, x, y, z, or matrix.
    /// up : {"x", "y", "z"}, optional
    ///     Axis of the file that becomes z; by default "y" for .glb, as glTF defines it, else "z".
    /// kind : {"rigid", "soft"}, optional
    ///     Boundary condition, as for `Mesh`.
    ///
    /// Returns
    /// -------
    /// midair.Mesh
    ///     The body.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For a missing file, one that cannot be read or has no closed surface, and where trimesh is missing.
    #[staticmethod]
    #[pyo3(signature = (path, *, scale=None, offset=None, rotation=None, up=None, kind="rigid"))]
    fn from_file(
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        scale: Argument<'_, '_>,
        offset: Argument<'_, '_>,
        rotation: Argument<'_, '_>,
        up: Argument<'_, '_>,
        kind: &str,
    ) -> PyResult<Self> {
        let kind = surface("kind", kind)?;
        let scale = read::real_or("scale", scale, 1.0)?;
        let offset = offset.map_or(Ok([0.0; 3]), |offset| read::place("offset", offset))?;
        let read = toolbox::call(py, "mesh_file", (path, scale, offset, rotation, up))?;
        let (vertices, faces): (Bound<'_, PyAny>, Bound<'_, PyAny>) = read.extract()?;
        Self::of(read::vectors("mesh.vertices", &vertices)?, indices(&faces)?, kind)
    }

    /// Faces (F, 3), three indices of vertices each.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, u32>> {
        let flat = PyArray1::from_slice(py, self.inner.faces().as_flattened());
        flat.reshape([self.inner.faces().len(), 3])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        restored::<Self>(py, (self.vertices(py)?, self.faces(py)?, self.kind()))
    }

    #[staticmethod]
    fn _restore(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>, kind: &str) -> PyResult<Self> {
        Self::new(vertices, faces, kind)
    }

    fn __repr__(&self) -> String {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for vertex in self.inner.vertices() {
            (low, high) = ([0, 1, 2].map(|x| vertex[x].min(low[x])), [0, 1, 2].map(|x| vertex[x].max(high[x])));
        }
        let [x, y, z] = [0, 1, 2].map(|axis| 1e3 * (high[axis] - low[axis]));
        format!("<midair.Mesh of {} faces, {x:.0} x {y:.0} x {z:.0} mm, {}>", self.inner.faces().len(), self.kind())
    }
}

getters! {
    Mesh:

    /// Vertices (V, 3) in m.
    vertices(self, py) -> PyResult<Array2<'py, f64>> = rows(py, self.inner.vertices());

    /// "rigid" or "soft".
    kind(self) -> &'static str = self.inner.kind().name();

    /// Enclosed volume in m^3.
    volume(self) -> f64 = self.inner.volume();
}

impl Mesh {
    fn of(vertices: Vec<[f64; 3]>, faces: Vec<[u32; 3]>, kind: midair::Surface) -> PyResult<Self> {
        Ok(Self { inner: Arc::new(midair::Mesh::new(vertices, faces, kind).map_err(refused)?) })
    }
}

/// Reads the faces (F, 3) of a mesh.
pub(crate) fn indices(value: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; 3]>> {
    let (item, cure) = ("mesh.faces", "give whole numbers of shape (F, 3), indices of vertices");
    let numbers = shaped::<f64>(item, value, "iu", cure, |shape| matches!(shape, [_, 3]) || shape.contains(&0))?;
    // A negative index becomes the largest one, so that the core rejects it and names the face.
    let indices = |face: &[f64; 3]| face.map(|v| if v < 0.0 { u32::MAX } else { v as u32 });
    Ok(numbers.values.as_chunks().0.iter().map(indices).collect())
}

/// The boundary equations of a scene's meshes; their solution is the sound on the elements.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Boundary {
    inner: Arc<midair::Boundary>,
}

#[pymethods]
impl Boundary {
    /// Returns all parameters on which the sound depends, as bytes to be hashed.
    fn content<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.inner.content())
    }

    /// Returns the matrix of the equations (E, E).
    fn matrix<'py>(&self, py: Python<'py>, progress: Option<Py<PyAny>>) -> PyResult<Array2<'py, Complex32>> {
        let matrix = attend(py, progress, |mut control| self.inner.matrix(&mut control))?;
        PyArray1::from_vec(py, matrix).reshape([self.inner.elements(); 2])
    }

    /// Returns the right-hand sides of the equations (E, N): the incident wave of each transducer at each element.
    fn incident<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, Complex32>> {
        let incident = attend(py, None, |mut control| self.inner.incident(&mut control))?;
        PyArray1::from_vec(py, incident).reshape([self.inner.elements(), self.inner.transducers()])
    }

    /// Returns the sound inside of the bodies, which should be 0, relative to the incident sound there. `sound` is the
    /// solution (E, N).
    fn left_inside(&self, py: Python<'_>, sound: PyReadonlyArray2<'_, Complex32>) -> PyResult<f64> {
        let sound = sound.as_slice()?;
        attend(py, None, |mut control| self.inner.left_inside(sound, &mut control))
    }
}

getters! {
    Boundary:

    /// Number of elements E and of transducers N.
    shape(self) -> (usize, usize) = (self.inner.elements(), self.inner.transducers());
}

/// Returns a model with obstacles. If there are meshes among them, Python solves their boundary equations.
pub(crate) fn behind(py: Python<'_>, model: &Model, obstacles: &[Obstacle]) -> PyResult<Model> {
    if !obstacles.iter().any(|obstacle| matches!(obstacle, Obstacle::Mesh(_))) {
        let model = model.clone();
        return attend(py, None, |mut control| model.with_obstacles_watched(obstacles, &mut control));
    }
    let boundary = midair::Boundary::new(model.array(), model.medium(), obstacles.to_vec()).map_err(refused)?;
    let boundary = Arc::new(boundary);
    let handle = Bound::new(py, Boundary { inner: Arc::clone(&boundary) })?;
    let sound = toolbox::call(py, "sound", (handle,))?;
    let sound: PyReadonlyArray2<'_, Complex32> = sound.extract()?;
    model.clone().with_sound(boundary, sound.as_slice()?).map_err(refused)
}

/// Reads the boundary condition of a surface by its name.
pub(crate) fn surface(item: &str, kind: &str) -> PyResult<Surface> {
    Surface::read(item, &Value::Text(kind.into())).map_err(refused)
}
