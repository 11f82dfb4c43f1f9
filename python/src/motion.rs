//! Scene files with moving points, read by the core.

use std::path::PathBuf;

use midair::files;

use crate::draw;
use crate::error::error_of;
use crate::files::{bytes_of, read};
use crate::path::Path;
use crate::prelude::*;
use crate::scene::Scene;

/// The contents of a scene file with `[motion]`.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Motion(files::Motion);

#[pymethods]
impl Motion {
    /// Reads a file; returns None if it has no `[motion]`.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Option<Self>> {
        let motion =
            read(&path, &bytes_of(py, &path)?, |bytes, format, source| draw::motion(py, bytes, format, source))?;
        let Some(motion) = motion else { return Ok(None) };
        Scene::of(motion.scene.clone())?.reported(py, &[])?;
        Ok(Some(Self(motion)))
    }

    /// The other keys of `[motion]`, as `midair.sequence` takes them.
    #[getter]
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let midair::Pace { rate, change, change_rate, tau, closed } = self.0.pace;
        let settings = PyDict::new(py);
        settings.set_item("rate", rate)?;
        settings.set_item("closed", closed)?;
        for (key, value) in [("change", change), ("change_rate", change_rate), ("tau", tau)] {
            settings.set_item(key, value)?;
        }
        match self.0.ahead {
            Some(frames) => settings.set_item("ahead", frames)?,
            None => settings.set_item("ahead", "all")?,
        }
        Ok(settings)
    }

    /// Returns the error about a key of `[motion]`, with its place in the file; None if the file does not have it.
    fn placed(&self, error: &Bound<'_, PyAny>) -> PyResult<Option<PyErr>> {
        Ok(self.0.placed(&error_of(error)?).map(refused))
    }
}

getters! {
    Motion:

    /// The scene; its points are those of the first frame.
    scene(self) -> PyResult<Scene> = Scene::of(self.0.scene.clone());

    /// All paths of the file at the same time, or the path through the frames of its file.
    path(self) -> Path = Path::from(self.0.path.clone());
}
