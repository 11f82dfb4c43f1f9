//! `midair.Solver`.

use std::time::Instant;

use midair::{Complex32, Control, Progress, Request, Session};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::pulse::Pulse;
use crate::setting::Setting;
use crate::solve::{Metrics, Solution, begin};
use crate::{invalid, read, refused};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// One array, one method, many requests: it owns its memory, so that from its second call on nothing is allocated
/// if `out` is given.
///
/// scene gives array and medium: a Scene, or an Array with a Scene's keywords (frequency, sound_speed, ...). points
/// is the largest number of points it will be asked for.
///
/// >>> import midair, numpy
/// >>> solver = midair.Solver(midair.Array.preset("paper20"), "fast", points=2)
/// >>> drive = numpy.empty(400, numpy.complex64)
/// >>> for x in (0.00, 0.01, 0.02):
/// ...     answer = solver([[x, 0, 0.15], [-x, 0.01, 0.15]], out=drive)
/// >>> answer.status
/// 'done'
#[pyclass(module = "midair")]
pub(crate) struct Solver {
    session: Session,
    choice: midair::Choice,
    points: usize,
    transducers: usize,
    request: Request,
    elapsed: f64,
}

impl Solver {
    fn last(&self) -> PyResult<&midair::Solution> {
        self.session.solution().ok_or_else(|| {
            invalid(
                "solution",
                "none yet",
                "call the solver with out= first; without out= the answer is returned",
            )
        })
    }
}

/// Copies numbers into a list that is kept: one for every point, or one for all.
fn copy(item: &str, value: Argument<'_, '_>, count: usize, kept: &mut Option<Vec<f64>>) -> PyResult<()> {
    let Some(value) = value else {
        *kept = None;
        return Ok(());
    };
    if let (Ok(array), Some(list)) = (value.extract::<PyReadonlyArray1<'_, f64>>(), kept.as_mut())
        && array.len() == count
        && let Ok(slice) = array.as_slice()
    {
        list.clear();
        list.extend_from_slice(slice);
        return Ok(());
    }
    *kept = Some(read::list(item, value, count)?);
    Ok(())
}

#[pymethods]
impl Solver {
    #[new]
    #[pyo3(signature = (scene, solver=None, *, points, **options))]
    fn new(
        scene: &Bound<'_, PyAny>,
        solver: Argument<'_, '_>,
        points: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let points = read::count("points", points)?;
        if points == 0 {
            return Err(invalid("points", "0", "give a whole number, 1 or above"));
        }
        let Setting { model, choice, configured, balance } = Setting::read(scene, solver, options)?;
        let transducers = model.array().len();
        let mut session = Session::new(model, configured);
        (session.balance, session.aim) = (balance, choice.level);
        Ok(Self { session, choice, points, transducers, request: Request::default(), elapsed: 0.0 })
    }

    /// Finds a drive for points (M, 3) in m, as `solve` would. Without out the answer is a new Solution. With out, a
    /// complex64 array (N,), the drive is written there and the solver itself is returned: its drive, pressures,
    /// metrics and status are those of the last call.
    #[pyo3(signature = (points, pressures=None, *, weights=None, start=None, out=None))]
    fn __call__<'py>(
        mut slf: PyRefMut<'py, Self>,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        pressures: Argument<'_, 'py>,
        weights: Argument<'_, 'py>,
        start: Argument<'_, 'py>,
        out: Argument<'_, 'py>,
    ) -> PyResult<Py<PyAny>> {
        let clock = Instant::now();
        let this = &mut *slf;
        let info = this.session.configured().info;
        if start.is_some() && !info.uses_start {
            return Err(refused(midair::solvers::unused("start", info.name, |info| info.uses_start)));
        }
        // What is already a float64 array is read in place.
        let array = points.extract::<PyReadonlyArray2<'py, f64>>().ok();
        let in_place =
            array.as_ref().filter(|array| array.shape()[1] == 3).and_then(|array| array.as_slice().ok());
        let copied;
        let places = if let Some(slice) = in_place {
            slice.as_chunks().0
        } else {
            copied = read::vectors("points", points)?;
            &copied
        };
        if places.len() > this.points {
            let cure =
                format!("this solver was made for {}: make one with points={}", this.points, places.len());
            return Err(invalid("points", &format!("{} of them", places.len()), &cure));
        }
        copy("pressures", pressures, places.len(), &mut this.request.pressures)?;
        copy("weights", weights, places.len(), &mut this.request.weights)?;
        let out = out
            .map(|out| {
                let array =
                    out.cast::<PyArray1<Complex32>>().ok().filter(|array| array.len() == this.transducers);
                let array = array.and_then(|array| array.try_readwrite().ok());
                let cure = format!("give a writable complex64 array of shape ({},)", this.transducers);
                array.ok_or_else(|| invalid("out", &read::quoted(out), &cure))
            })
            .transpose()?;
        let start = start.map(begin).transpose()?;
        let mut pulse = Pulse::new(None);
        let (session, request) = (&mut this.session, &this.request);
        let solved = py.detach(|| {
            let mut observer = |progress: Progress<'_>| pulse.beat(&progress);
            session.solve(places, request, start, &mut Control::watched(&mut observer)).map(|_| ())
        });
        pulse.raised()?;
        solved.map_err(refused)?;
        this.elapsed = clock.elapsed().as_secs_f64();
        if let Some(mut out) = out {
            let drive = &this.last()?.drive;
            for (out, q) in out.as_array_mut().iter_mut().zip(drive) {
                *out = *q;
            }
            return Ok(slf.into_pyobject(py)?.into_any().unbind());
        }
        let elapsed = this.elapsed;
        let inner = this.session.take().ok_or_else(|| invalid("solution", "none", "report this"))?;
        let solution = Solution::new(inner, this.choice.clone(), None, elapsed);
        Ok(Bound::new(py, solution)?.into_any().unbind())
    }

    /// Drives q (N,) of the last call with out, complex64.
    #[getter]
    fn drive<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<Complex32>>> {
        Ok(self.last()?.drive.to_pyarray(py))
    }

    /// Complex pressures (M,) of the last call with out in Pa (peak), complex64.
    #[getter]
    fn pressures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<Complex32>>> {
        Ok(self.last()?.pressures.to_pyarray(py))
    }

    /// How good the last call with out was.
    #[getter]
    fn metrics(&self) -> PyResult<Metrics> {
        Ok(self.last()?.metrics().into())
    }

    /// How the last call with out ended.
    #[getter]
    fn status(&self) -> PyResult<String> {
        Ok(self.last()?.status.to_string())
    }

    /// What supply or modulation have to multiply the drives by; 1 unless the device has no such amplitude.
    #[getter]
    fn scale(&self) -> PyResult<f64> {
        Ok(self.last()?.scale)
    }

    /// Steps of the last call with out.
    #[getter]
    fn steps(&self) -> PyResult<usize> {
        Ok(self.last()?.steps)
    }

    /// Seconds of the last call.
    #[getter]
    fn elapsed(&self) -> f64 {
        self.elapsed
    }

    /// The method's name.
    #[getter]
    fn solver(&self) -> &str {
        &self.choice.name
    }

    /// Every option in full, and whether the targets are balanced.
    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        read::option_dict(py, &self.choice.table())
    }

    fn __repr__(&self) -> String {
        let (name, points) = (&self.choice.name, self.points);
        format!("<midair.Solver by {name}: {} transducers, up to {points} points>", self.transducers)
    }
}
