//! `midair.Scene`.

use std::path::PathBuf;

use midair::files::{Format, Provenance};
use midair::{Medium, Notice};

use crate::array::Array;
use crate::bead;
use crate::bodies::obstacle_objects;
use crate::files;
use crate::give::rows;
use crate::keywords::Keywords;
use crate::plane::Plane;
use crate::prelude::*;
use crate::ready::Ready;
use crate::signature::{read_signature, signature_object};

/// Arguments of the constructor, without those of the air and the array's parts.
pub(crate) const ARGUMENTS: [&str; 7] = ["array", "points", "pressures", "weights", "signature", "bead", "obstacles"];

/// Request: an array, points in the air, and a pressure for each point.
///
/// Parameters
/// ----------
/// array : midair.Array
///     N transducers.
/// points : (M, 3) array_like
///     Points in m.
/// pressures : float or (M,) array_like, optional
///     Peak |p| in Pa; 0 means a quiet point. By default all points have the balanced level s, about what the array can
///     reach together: sum_j (s/p1_j)^2 = 1, p1_j = sum_i |G_ji|. Complex pressures are targets of phase, too, for the
///     methods that use phases.
/// weights : float or (M,) array_like, optional
///     Weights, which multiply the points' terms of eq. (7); a point of weight 0 has no effect.
/// signature : str, array_like or list, optional
///     Turns the foci into traps: "trap", "twin", "vortex", or complex factors (N,) or (M, N) of modulus 1. They
///     multiply the responses c while a scene is solved; pressures are then those of the foci, and `field` and `gorkov`
///     use the real responses. A list has a name, or None for a focus, for each point. Traps of pressure 0 are then as
///     stiff as the pressures of the foci allow.
/// bead : midair.Bead or mapping, optional
///     Sphere that traps are made for.
/// obstacles : list, optional
///     Bodies that reflect the waves: midair.Wall, Sphere, Mesh and the like.
/// {medium}
/// {parts}
///     In place of the array's.
///
/// Raises
/// ------
/// SceneError
///     For numbers of another shape or not finite, points too far away or without sound, and contradictions, such as a
///     sound speed beside a temperature.
/// TypeError
///     For an array of another type.
///
/// Warns
/// -----
/// SceneWarning
///     For values that are probably mistakes.
///
/// Notes
/// -----
/// A drive q makes p_j = sum_i G_ji q_i, G_ji = P0/r D(theta) e^(-alpha r) e^(jkr) c_i: eq. (5) of Suzuki et al., IEEE
/// Trans. Haptics 14, 914 (2021), with directivity, absorption and response.
///
/// Examples
/// --------
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[0, 0, 0.15]])
/// >>> round(float(abs(scene.propagation()).sum()), 5)
/// 2.36066
#[pyclass(frozen, eq, hash, module = "midair")]
#[derive(Clone)]
pub(crate) struct Scene {
    pub(crate) inner: Arc<midair::Scene>,
    /// Array and medium.
    pub(crate) ready: Arc<Ready>,
    /// Array and medium with obstacles and signature.
    model: midair::Model,
}

impl PartialEq for Scene {
    fn eq(&self, other: &Self) -> bool {
        self.inner == other.inner
    }
}

hashed!(Scene: self => (self.inner.points().len(), self.inner.points()[0].map(bits), bits(self.inner.medium().frequency)));

impl Scene {
    /// Makes a scene from one of the core.
    pub(crate) fn of(inner: midair::Scene) -> PyResult<Self> {
        let array = inner.array().clone().into();
        Self::with(&array, inner)
    }

    /// Makes a scene whose array may already be prepared for the medium.
    fn with(array: &Array, inner: midair::Scene) -> PyResult<Self> {
        let ready = array.ready(inner.medium())?;
        let model = Python::attach(|py| ready.model_with(py, inner.extras()))?;
        Ok(Self { ready, model, inner: Arc::new(inner) })
    }

    /// Makes a scene of all its parts.
    pub(crate) fn made(
        array: &Array,
        medium: Medium,
        points: Vec<[f64; 3]>,
        request: Request,
        extras: Extras,
    ) -> PyResult<Self> {
        let inner = midair::Scene::new(array.inner.clone(), medium, points, request);
        Self::with(array, inner.and_then(|inner| inner.with_extras(extras)).map_err(refused)?)
    }

    /// Reads a request from keywords. What they leave out is that of `base`.
    pub(crate) fn read(array: Array, base: Option<&Self>, keywords: &Keywords<'_>) -> PyResult<Self> {
        let base = base.map(|base| &*base.inner);
        let array = keywords.array(array)?;
        let medium = keywords.medium(base.map(midair::Scene::medium), &array)?;
        let points = match keywords.take_or_none("points")? {
            Some(points) if base.is_none() || !points.is_none() => read::vectors("points", &points)?,
            _ => base.map(|base| base.points().to_vec()).unwrap_or_default(),
        };
        let unchanged = |item: &str, list: Option<Vec<f64>>| match list {
            Some(list) if list.len() != points.len() => {
                let cure = format!("give {item} for the {} points, or None", points.len());
                Err(invalid(item, &format!("kept from {} points", list.len()), &cure))
            }
            list => Ok(list),
        };
        let Request { pressures, phases, weights } = base.map(|base| base.request().clone()).unwrap_or_default();
        // Without points, pressures have no length to compare with; the core reports the missing points.
        let given = |name: &str| Ok::<_, PyErr>(keywords.take_or_none(name)?.filter(|_| !points.is_empty()));
        let targets = match given("pressures")? {
            None => Request { pressures: unchanged("pressures", pressures)?, phases, ..Request::default() },
            Some(value) if value.is_none() => Request::default(),
            Some(value) => read::pressures(&value, points.len())?,
        };
        let weights = match given("weights")? {
            None => unchanged("weights", weights)?,
            Some(value) if value.is_none() => None,
            Some(value) => Some(read::list("weights", &value, points.len())?),
        };
        let request = Request { weights, ..targets };
        let mut extras = base.map(midair::Scene::extras).unwrap_or_default();
        if base.is_some()
            && let Some(plane) = keywords.take_or_none("plane")?
        {
            extras.plane = match plane.cast::<Plane>() {
                Ok(plane) => Some(plane.get().inner),
                Err(_) if plane.is_none() => None,
                Err(_) => return Err(invalid("plane", &quoted(&plane), "give a midair.Plane or None")),
            };
        }
        keywords.write_extras(&mut extras, array.inner.len())?;
        match base {
            None => keywords
                .unknown("argument of midair.Scene", &ARGUMENTS)
                .map(|error| PyTypeError::new_err(error.to_string())),
            Some(_) => keywords.unknown("part of a scene", &[&ARGUMENTS[..], &["plane"]].concat()).map(refused),
        }
        .map_or(Ok(()), Err)?;
        Self::made(&array, medium, points, request, extras)
    }

    /// Returns the scene after warnings about probable mistakes, without those that are already known.
    pub(crate) fn reported(self, py: Python<'_>, known: &[Notice]) -> PyResult<Self> {
        warn_all(py, self.doubts().iter().filter(|doubt| !known.contains(doubt)))?;
        Ok(self)
    }

    pub(crate) fn problem(&self, rows_follow: bool, control: &mut Control) -> Result<midair::Problem, midair::Error> {
        let model = self.model().for_rows(rows_follow);
        midair::Problem::of_model(&model, self.inner.points(), self.inner.request(), control)
    }

    /// Returns array and medium with obstacles and signature, for solving.
    pub(crate) fn model(&self) -> midair::Model {
        self.model.clone()
    }

    pub(crate) fn doubts(&self) -> Vec<Notice> {
        self.ready.doubts.iter().cloned().chain(self.inner.own_doubts()).collect()
    }
}

#[pymethods]
impl Scene {
    #[staticmethod]
    #[pyo3(
        name = "_new",
        signature = (array, points, pressures=None, **keys),
        text_signature = "(array, points, pressures=None, *, weights=None, signature=None, bead=None, obstacles=None, **keys)"
    )]
    fn new(
        py: Python<'_>,
        array: &Bound<'_, PyAny>,
        points: &Bound<'_, PyAny>,
        pressures: Argument<'_, '_>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let wrong = |_| unexpected(array, "a midair.Array", ": give midair.Scene(array, points)");
        let array = array.cast::<Array>().map_err(wrong)?;
        let keywords = Keywords::of(py, keys)?.with([("points", Some(points)), ("pressures", pressures)])?;
        Self::read(array.get().clone(), None, &keywords)?.reported(py, &[])
    }

    /// Read a scene file: JSON by its ending .json, TOML by .toml, else by its content.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     File to read.
    ///
    /// Returns
    /// -------
    /// midair.Scene
    ///     The scene.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For an error in it. The text states line and column, and shows a correct line.
    /// OSError
    ///     If it cannot be read, such as FileNotFoundError.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::of(files::load(py, &path)?)?.reported(py, &[])
    }

    /// Read a scene from text, TOML or JSON by its content.
    ///
    /// Parameters
    /// ----------
    /// text : str or bytes
    ///     The text.
    /// name : str, optional
    ///     Name of the text in errors.
    /// folder : str or path, optional
    ///     Folder of the files that the text names, which are rejected without one.
    ///
    /// Returns
    /// -------
    /// midair.Scene
    ///     The scene.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For an error in it. The text states line and column, and shows a correct line.
    #[staticmethod]
    #[pyo3(signature = (text, *, name="scene", folder=None))]
    fn parse(text: &Bound<'_, PyAny>, name: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        Self::of(files::parse(text, name, folder.as_deref())?)?.reported(text.py(), &[])
    }

    /// Write the scene as TOML or (by the ending .json) JSON, whole or not at all.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     File to write.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If it cannot be written.
    /// SceneError
    ///     For parts that no file can store, such as a signature of your own factors.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let text = files::written(&self.inner, Format::of(&path.to_string_lossy()), &Provenance::default())?;
        files::save(py, &path, &text)
    }

    /// Return the scene as JSON text; with a solution, as the record of its solve.
    ///
    /// Parameters
    /// ----------
    /// solution : midair.Solution, optional
    ///     A solution of the scene.
    ///
    /// Returns
    /// -------
    /// str
    ///     JSON.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For parts that no file can store, such as a signature of your own factors.
    #[pyo3(signature = (solution=None))]
    fn json(&self, solution: Argument<'_, '_>) -> PyResult<String> {
        let (mut scene, mut provenance) = (midair::Scene::clone(&self.inner), Provenance::default());
        if let Some(solution) = solution {
            let part = |name: &str| solution.getattr(name);
            scene.solver = Some(read::choice(part("solver")?.extract()?, part("options")?.cast()?)?);
            let version = Some(env!("CARGO_PKG_VERSION").into());
            provenance = Provenance { version, status: Some(part("status")?.extract()?) };
        }
        files::written(&scene, Format::Json, &provenance)
    }

    /// Return a copy of the scene with other parts. Parts that are not given stay, also the solver of a scene file.
    ///
    /// Parameters
    /// ----------
    /// **changes
    ///     The new parts, with the names of the constructor's arguments, or `plane`. None removes pressures,
    ///     weights, signature, obstacles or plane, and leaves anything else as it is.
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
        let keywords = Keywords::of(py, changes)?;
        let array = match keywords.take("array")? {
            None => self.array(),
            Some(array) => match array.cast::<Array>() {
                Ok(array) => array.get().clone(),
                Err(_) => return Err(invalid("array", &quoted(&array), "give a midair.Array")),
            },
        };
        Self::read(array, Some(self), &keywords)?.reported(py, &self.doubts())
    }

    /// The array.
    #[getter]
    pub(crate) fn array(&self) -> Array {
        Array::from(&self.ready)
    }

    /// Pressures (M,) in Pa as given, complex if they have phases, or None.
    #[getter]
    fn pressures<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        let request = self.inner.request();
        match request.complex_pressures() {
            Some(pressures) => Some(give::list(py, pressures).into_any()),
            None => request.pressures.clone().map(|pressures| give::list(py, pressures).into_any()),
        }
    }

    /// The solver of the scene file, (name, options), or None.
    #[getter]
    fn solver<'py>(&self, py: Python<'py>) -> PyResult<Option<(String, Bound<'py, PyDict>)>> {
        let Some(choice) = &self.inner.solver else { return Ok(None) };
        Ok(Some((choice.name.clone(), read::option_dict(py, &choice.table())?)))
    }

    /// Compute G: the pressure at point j of transducer i at full drive, eq. (5), times the signature.
    ///
    /// Returns
    /// -------
    /// (M, N) ndarray of complex64
    ///     The matrix in Pa.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For a point nearer than lambda/100 to a transducer.
    /// MemoryError
    ///     For more than MIDAIR_MEMORY allows.
    fn propagation<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, Complex32>> {
        let matrix = |mut control: Control<'_>| self.model().propagation(self.inner.points())?.matrix(&mut control);
        let matrix = attend(py, None, matrix)?;
        give::table(py, matrix, [self.inner.points().len(), self.inner.array().len()])
    }

    /// Compute the highest pressure at each point alone, and at all of them together.
    ///
    /// Returns
    /// -------
    /// midair.Reach
    ///     The pressures in Pa.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     For a point nearer than lambda/100 to a transducer.
    fn reach(&self, py: Python<'_>) -> PyResult<Reach> {
        let reach = |mut control: Control<'_>| self.problem(false, &mut control)?.reach(&mut control);
        let midair::Reach { alone, level, .. } = attend(py, None, reach)?;
        Ok(Reach { alone, level })
    }

    /// Returns a warning about places (K, 3) in m that are so far from the array that their unit is probably wrong, or
    /// None.
    fn _far(&self, name: Lossy, places: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
        let places = read::vectors(&name, places)?;
        let named = |k: usize| if places.len() == 1 { name.to_owned() } else { format!("{}[{k}]", &*name) };
        Ok(self.inner.doubt_places(&places, named).map(|doubt| doubt.to_string()))
    }

    #[staticmethod]
    fn _restore(text: &Bound<'_, PyAny>, array: &Bound<'_, Array>, signature: Argument<'_, '_>) -> PyResult<Self> {
        let (inner, array) = (files::parse(text, "scene", None)?, array.get());
        let signature = signature.map(|value| read_signature(value, array.inner.len())).transpose()?;
        let (points, request) = (inner.points().to_vec(), inner.request().clone());
        Self::made(array, inner.medium(), points, request, Extras { signature, ..inner.extras() })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        // Files do not have a signature's factors.
        let plain = midair::Scene::clone(&self.inner).with_signature(None).map_err(refused)?;
        let text = files::written(&plain, Format::Json, &Provenance::default())?;
        restored::<Self>(py, (text, self.array(), self.signature(py)?))
    }

    fn __repr__(&self) -> String {
        let (n, m) = (self.inner.array().len(), self.inner.points().len());
        format!("<midair.Scene of {n} transducers and {m} points at {} Hz>", self.inner.medium().frequency)
    }
}

getters! {
    Scene:

    /// Points (M, 3) in m.
    points(self, py) -> PyResult<Array2<'py, f64>> = rows(py, self.inner.points());

    /// Weights (M,) as given, or None.
    weights(self, py) -> Option<Array1<'py, f64>> =
        self.inner.request().weights.clone().map(|weights| give::list(py, weights));

    /// The numbers of the air by name, as the constructor takes them.
    medium(self, py) -> PyResult<Bound<'py, PyDict>> =
        self.inner.medium().numbers().collect::<Vec<_>>().into_py_dict(py);

    /// Wavelength in m.
    wavelength(self) -> f64 = self.inner.medium().wavelength();

    /// Whether pressures are in the paper's unit: eq. (5) in mm, which source_pressure = 1e-3 reproduces.
    in_paper_unit(self) -> bool = self.inner.array().in_paper_unit();

    /// The signature of traps: "trap", "twin", "vortex", complex factors (N,) or (M, N), a list (M,), or None.
    signature(self, py) -> PyResult<Option<Bound<'py, PyAny>>> =
        signature_object(py, self.inner.signature(), self.inner.array().len());

    /// The sphere that traps are made for.
    bead(self) -> bead::Bead = bead::Bead(self.inner.bead());

    /// Bodies that reflect the waves: a list of midair.Wall, Sphere, Mesh and the like.
    obstacles(self, py) -> PyResult<Vec<Bound<'py, PyAny>>> = obstacle_objects(py, self.inner.obstacles());

    /// The plane of the scene file for pictures, or None.
    plane(self) -> Option<Plane> = self.inner.plane.map(|inner| Plane { inner });
}

/// Capability of an array at a scene's points; from `Scene.reach`.
///
/// Examples
/// --------
/// >>> import midair
/// >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
/// >>> bool((scene.reach().level < scene.reach().alone).all())
/// True
#[pyclass(frozen, eq, module = "midair")]
#[derive(PartialEq)]
pub(crate) struct Reach {
    alone: Vec<f64>,
    level: Vec<f64>,
}

pickled!(Reach: alone: Vec<f64>, level: Vec<f64>);

#[pymethods]
impl Reach {
    fn __repr__(&self) -> String {
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let (alone, level) = (most(&self.alone), most(&self.level));
        format!("<midair.Reach: up to {alone:.4} Pa alone, {level:.4} Pa together>")
    }
}

getters! {
    Reach:

    /// The highest pressure at each point alone (M,) in Pa: the sum of |G|.
    alone(self, py) -> Array1<'py, f64> = give::list(py, self.alone.clone());

    /// The balanced level (M,) in Pa: the pressures that the array can make at all points together, in the ratios of the
    /// requested pressures. It assumes points at least a focal width apart.
    level(self, py) -> Array1<'py, f64> = give::list(py, self.level.clone());
}
