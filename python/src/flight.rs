//! Beads in flight, for `midair.fly` and `midair.path.fastest`: forces on a bead, the transducers' response, the simulation.

use std::sync::{Mutex, MutexGuard, PoisonError};

use midair::flight::{BeadStart, Course as Inner, Envelope};
use numpy::PyReadonlyArray1;

use crate::prelude::*;
use crate::scene::Scene;

/// Response of transducers with the time constant `tau` in s to drives at `rate` frames/s, which stay for their frame or, if
/// `linear`, move to the next one during it. See the core's `Envelope`.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Response {
    inner: Envelope,
}

/// Radiation (T, S, N), and radiation (N,) after the last frame.
type Played<'py> = (Array3<'py, Complex32>, Array1<'py, Complex64>);

#[pymethods]
impl Response {
    #[new]
    fn new(rate: f64, tau: f64, linear: bool) -> Self {
        Self { inner: Envelope { rate, tau, linear } }
    }

    /// Returns how many of the last frames of a lap affect what follows the lap.
    fn memory(&self, frames: usize) -> usize {
        self.inner.memory(frames)
    }

    /// Returns the radiation (N,) at the start of a sequence that repeats, from the drives (L, N) of its last `memory` frames
    /// and the first drive (N,).
    fn repeated<'py>(
        &self,
        py: Python<'py>,
        last: PyReadonlyArray2<'py, Complex32>,
        first: PyReadonlyArray1<'py, Complex32>,
    ) -> PyResult<Array1<'py, Complex64>> {
        Ok(give::list(py, self.inner.repeated(last.as_slice()?, first.as_slice()?)))
    }

    /// Returns the radiation (T, S, N) during frames with the drives `now` (T, N), before the drives `following` (T, N), at the
    /// starts of the parts `first` to `stop` of each frame, and the radiation after the last frame. `start` (N,) is the
    /// radiation before the first.
    fn inside<'py>(
        &self,
        py: Python<'py>,
        now: PyReadonlyArray2<'py, Complex32>,
        following: PyReadonlyArray2<'py, Complex32>,
        start: PyReadonlyArray1<'py, Complex64>,
        parts: usize,
        first: usize,
        stop: usize,
    ) -> PyResult<Played<'py>> {
        let (now, following, mut state) = (now.as_slice()?, following.as_slice()?, start.as_slice()?.to_vec());
        let (count, steps) = (state.len(), stop - first);
        let frames = now.len() / count;
        let mut all = vec![Complex32::ZERO; frames * steps * count];
        for (frame, (now, following)) in now.chunks(count).zip(following.chunks(count)).enumerate() {
            let out = &mut all[frame * steps * count..(frame + 1) * steps * count];
            self.inner.frame(now, following, &mut state, parts, first..stop, out);
        }
        Ok((PyArray1::from_vec(py, all).reshape([frames, steps, count])?, give::list(py, state)))
    }
}

/// Radiation and points of a sequence at knots in time; see the core's `Course`.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Course {
    inner: Mutex<Inner>,
}

impl Course {
    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Times (K,) in s, places (K, B, 3) of the beads and of their points in m, and times (B,) at which beads were lost.
type Tracks<'py> = (Array1<'py, f64>, Array3<'py, f64>, Array3<'py, f64>, Array1<'py, f64>);

#[pymethods]
impl Course {
    #[new]
    fn new(
        points: Bound<'_, PyAny>,
        wavelength: f64,
        response: &Response,
        closed: bool,
        start: PyReadonlyArray1<'_, Complex64>,
    ) -> PyResult<Self> {
        let (points, [_, count]) = read::batch_of_points("points", &points)?;
        let before = start.as_slice()?.to_vec();
        let inner = Inner::new(&points, count, wavelength, response.inner, closed, before).map_err(refused)?;
        Ok(Self { inner: Mutex::new(inner) })
    }

    /// Plays the next frames with the drives `now` (T, N), before the drives `following` (T, N).
    fn play<'py>(
        &self,
        py: Python<'py>,
        now: PyReadonlyArray2<'py, Complex32>,
        following: PyReadonlyArray2<'py, Complex32>,
    ) -> PyResult<()> {
        let count = now.as_array().ncols();
        let (now, following) = (now.as_slice()?, following.as_slice()?);
        attend(py, None, |mut control| {
            let mut frames = now.chunks(count).zip(following.chunks(count));
            frames.try_for_each(|(now, following)| self.inner().play(now, following, &mut control))
        })
    }

    /// Returns the number of knots of a flight of `duration` seconds.
    #[pyo3(signature = (duration))]
    fn knots(&self, duration: Option<f64>) -> PyResult<usize> {
        self.inner().knots(duration).map_err(refused)
    }

    /// Returns the velocities (B, 3) in m/s of some points (B,) at the start.
    fn speeds<'py>(&self, py: Python<'py>, points: Vec<usize>) -> PyResult<Array2<'py, f64>> {
        let inner = self.inner();
        give::rows(py, &points.iter().map(|&point| inner.moving(point)[0]).collect::<Vec<_>>())
    }

    /// Returns the places (B, 3) in m at which beads move with some points (B,) from the start on.
    fn resting<'py>(&self, scene: &Bound<'py, Scene>, points: Vec<usize>) -> PyResult<Array2<'py, f64>> {
        let (py, model, bead) = (scene.py(), scene.get().model(), scene.get().inner.bead());
        let places = attend(py, None, |mut control| self.inner().resting(&model, bead, &points, &mut control))?;
        give::rows(py, &places)
    }

    /// Simulates beads that start at places (B, 3) with velocities (B, 3), each in the trap of its point (B,).
    fn fly<'py>(
        &self,
        scene: &Bound<'py, Scene>,
        places: Bound<'py, PyAny>,
        speeds: Bound<'py, PyAny>,
        points: Vec<usize>,
        knots: usize,
    ) -> PyResult<Tracks<'py>> {
        let (py, model, bead) = (scene.py(), scene.get().model(), scene.get().inner.bead());
        warn_all(py, bead.particle.remark(model.medium()))?;
        let (places, speeds) = (read::vectors("beads", &places)?, read::vectors("speeds", &speeds)?);
        let each = places.iter().zip(&speeds).zip(&points);
        let beads: Vec<_> = each.map(|((&place, &speed), &point)| BeadStart { place, speed, point }).collect();
        let (times, flown) = attend(py, None, |mut control| {
            let inner = self.inner();
            let flown = inner.fly(&model, bead, &beads, knots, &mut control)?;
            Ok((inner.times(knots), flown))
        })?;
        let tracks =
            |places: Vec<[f64; 3]>| PyArray1::from_vec(py, places.into_flattened()).reshape([knots, points.len(), 3]);
        Ok((
            PyArray1::from_vec(py, times),
            tracks(flown.places)?,
            tracks(flown.points)?,
            PyArray1::from_vec(py, flown.lost),
        ))
    }
}

#[pymethods]
impl Scene {
    /// Returns the effective mass in kg of the bead.
    fn _mass(&self) -> f64 {
        self.inner.bead().particle.mass(self.inner.medium())
    }

    /// Returns the forces (K, 3) in N, without weight and buoyancy, that cause these velocities and accelerations (K, 3) of the
    /// bead.
    fn _needed<'py>(
        &self,
        velocities: &Bound<'py, PyAny>,
        accelerations: &Bound<'py, PyAny>,
    ) -> PyResult<Array2<'py, f64>> {
        let (particle, medium) = (self.inner.bead().particle, self.inner.medium());
        let pair = (read::vectors("velocities", velocities)?, read::vectors("accelerations", accelerations)?);
        let needed: Vec<_> = pair.0.iter().zip(&pair.1).map(|(&v, &a)| particle.needed(medium, v, a)).collect();
        give::rows(velocities.py(), &needed)
    }
}
