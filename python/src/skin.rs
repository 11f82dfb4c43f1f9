//! The model of `midair.skin`: the spectrum of radiation pressure, the membrane, and the tactile channels.

use midair::InstructionSet;
use midair::touch::{self, Channel};
use numpy::{PyArrayDyn, PyReadonlyArray1, PyReadonlyArray3, PyReadonlyArrayDyn, PyReadwriteArray4};
use pyo3::types::PyComplex;

use crate::array::Array;
use crate::plane::Plane;
use crate::prelude::*;

const SKIN: [f64; 3] = touch::Membrane::SKIN;

/// Displacement (L, P) in m, and how far it exceeds the thresholds of the slow and of the fast channel, (P,) each.
type Moved<'py> = (Array2<'py, Complex32>, Array1<'py, f64>, Array1<'py, f64>);

/// An infinite membrane: wave speed in m/s, loss factor, and mass in kg/m^2. All arrays are in C order.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Membrane(touch::Membrane);

#[pymethods]
impl Membrane {
    #[new]
    #[pyo3(signature = (speed=SKIN[0], loss=SKIN[1], mass=SKIN[2]))]
    fn new(speed: f64, loss: f64, mass: f64) -> PyResult<Self> {
        touch::Membrane::new(speed, loss, mass).map(Self).map_err(refused)
    }

    /// T = m c^2 (1 + j eta), in N/m.
    #[getter]
    fn tension<'py>(&self, py: Python<'py>) -> Bound<'py, PyComplex> {
        let tension = self.0.tension();
        PyComplex::from_doubles(py, tension.re, tension.im)
    }

    /// Return s (L,) in 1/m for frequencies (L,) in Hz: waves decay as e^(-Re(s) r) with the phase Im(s) r.
    fn decay<'py>(&self, py: Python<'py>, frequencies: PyReadonlyArray1<'py, f64>) -> Array1<'py, Complex64> {
        frequencies.as_array().iter().map(|&each| self.0.decay(each)).collect::<Vec<_>>().into_pyarray(py)
    }

    /// Return the displacement in m/N at distances of any shape in m from a point force of a frequency in Hz.
    fn response<'py>(
        &self,
        py: Python<'py>,
        frequency: f64,
        distances: PyReadonlyArrayDyn<'py, f64>,
    ) -> PyResult<Bound<'py, PyArrayDyn<Complex64>>> {
        let (shape, distances) = (distances.shape().to_vec(), distances.as_slice()?);
        let responses: Vec<_> = py.detach(|| distances.iter().map(|&each| self.0.response(frequency, each)).collect());
        responses.into_pyarray(py).reshape(shape)
    }

    /// Return the motion under pressure lines (L, R, C) in Pa at frequencies (L,) in Hz, on squares of side `step` in m. The
    /// slow channel senses the gradient times `reach` in m.
    fn on_plane<'py>(
        &self,
        py: Python<'py>,
        frequencies: PyReadonlyArray1<'py, f64>,
        lines: PyReadonlyArray3<'py, Complex32>,
        step: f64,
        reach: f64,
    ) -> PyResult<Moved<'py>> {
        let (count, sides) = (lines.shape()[0], [lines.shape()[1], lines.shape()[2]]);
        let (frequencies, lines) = (frequencies.as_slice()?, lines.as_slice()?);
        let skin = attend(py, None, |mut control| {
            touch::Skin::on_plane(&self.0, frequencies, lines, sides, [step, reach], &mut control)
        })?;
        let displacement = skin.displacement.into_pyarray(py).reshape([count, sides[0] * sides[1]])?;
        Ok((displacement, skin.slow.into_pyarray(py), skin.fast.into_pyarray(py)))
    }
}

/// The spectrum up to `HIGHEST` of radiation pressure at places in frames that repeat.
#[pyclass(module = "midair._midair")]
pub(crate) struct Pushes(touch::Pushes, usize);

#[pymethods]
impl Pushes {
    /// Make an empty spectrum for `count` frames at `rate` frames per second.
    #[new]
    fn new(py: Python<'_>, count: usize, rate: f64, places: usize) -> PyResult<Self> {
        attend(py, None, |control| touch::Pushes::new(count, rate, places, &control)).map(|pushes| Self(pushes, places))
    }

    /// Add frames (K, P) in Pa, from frame `first` on.
    fn add(&mut self, py: Python<'_>, first: usize, values: PyReadonlyArray2<'_, f32>) -> PyResult<()> {
        let values = values.as_slice()?;
        attend(py, None, |mut control| self.0.add(first, values, &mut control))
    }

    /// Return frequencies (L,) in Hz, the mean (P,) in Pa and complex amplitudes (L, P) in Pa.
    #[allow(clippy::type_complexity, reason = "as Python unpacks it")]
    fn lines<'py>(&self, py: Python<'py>) -> PyResult<(Array1<'py, f64>, Array1<'py, f32>, Array2<'py, Complex32>)> {
        let frequencies = self.0.frequencies().to_vec();
        let shape = [frequencies.len(), self.1];
        let lines = self.0.lines().to_vec().into_pyarray(py).reshape(shape)?;
        Ok((frequencies.into_pyarray(py), self.0.mean().to_vec().into_pyarray(py), lines))
    }
}

fn channel(fast: bool) -> Channel {
    if fast { Channel::Fast } else { Channel::Slow }
}

/// Return the smallest vibration (L,) in m that the fast or the slow channel perceives at frequencies (L,) in Hz.
#[pyfunction]
pub(crate) fn threshold<'py>(py: Python<'py>, fast: bool, frequencies: PyReadonlyArray1<'py, f64>) -> Array1<'py, f64> {
    frequencies.as_array().iter().map(|&each| channel(fast).threshold(each)).collect::<Vec<_>>().into_pyarray(py)
}

/// Return how far vibrations exceed a channel's threshold (P,); `squares` (L, P) are |amplitude|^2 in m^2.
#[pyfunction]
pub(crate) fn excess<'py>(
    py: Python<'py>,
    fast: bool,
    frequencies: PyReadonlyArray1<'py, f64>,
    squares: PyReadonlyArray2<'py, f32>,
) -> PyResult<Array1<'py, f64>> {
    let places = squares.shape()[1];
    Ok(channel(fast).excess(frequencies.as_slice()?, squares.as_slice()?, places).into_pyarray(py))
}

/// Return the part (P,) that the channel of pressure passes of lines (L, P) at frequencies (L,) in Hz above 0.
#[pyfunction]
pub(crate) fn steady<'py>(
    py: Python<'py>,
    frequencies: PyReadonlyArray1<'py, f64>,
    lines: PyReadonlyArray2<'py, Complex32>,
) -> PyResult<Array1<'py, f64>> {
    Ok(touch::steady(frequencies.as_slice()?, lines.as_slice()?, lines.shape()[1]).into_pyarray(py))
}

/// Add |P|^2/2 of points to sums (K, B, 3, T), as the core's `demodulate`: `amplitudes` (V, U) in frames `order` (T,), a
/// frame's part `late` of the one before, `weights` and `bins` (K, V).
#[pyfunction]
pub(crate) fn demodulate<'py>(
    py: Python<'py>,
    amplitudes: PyReadonlyArray2<'py, Complex32>,
    order: PyReadonlyArray1<'py, usize>,
    late: f64,
    weights: PyReadonlyArray2<'py, f32>,
    bins: PyReadonlyArray2<'py, usize>,
    mut sums: PyReadwriteArray4<'py, f64>,
) -> PyResult<()> {
    let (amplitudes, order, sums) = (amplitudes.as_slice()?, order.as_slice()?, sums.as_slice_mut()?);
    let (weights, bins) = (weights.as_slice()?, bins.as_slice()?);
    attend(py, None, |mut control| touch::demodulate(amplitudes, order, late, weights, bins, sums, &mut control))
}

/// Return (L,) whether each spectral line (L, P) is above rounding errors at some place.
#[pyfunction]
pub(crate) fn live_lines<'py>(py: Python<'py>, lines: PyReadonlyArray2<'py, Complex32>) -> PyResult<Array1<'py, bool>> {
    Ok(touch::live_lines(lines.as_slice()?, lines.shape()[1]).into_pyarray(py))
}

/// Return the felt strength (P,) from both channels, (P,) each.
#[pyfunction]
pub(crate) fn strength<'py>(
    py: Python<'py>,
    slow: PyReadonlyArray1<'py, f64>,
    fast: PyReadonlyArray1<'py, f64>,
) -> Array1<'py, f64> {
    let pairs = slow.as_array().into_iter().copied().zip(fast.as_array().iter().copied()).collect::<Vec<_>>();
    pairs.into_iter().map(|(slow, fast)| touch::strength(slow, fast)).collect::<Vec<_>>().into_pyarray(py)
}

/// Return twice the distance in m from the place of index `middle` to the nearest of less than half its value.
#[pyfunction]
pub(crate) fn felt_width(
    values: PyReadonlyArray1<'_, f64>,
    places: PyReadonlyArray2<'_, f64>,
    middle: usize,
) -> PyResult<f64> {
    Ok(touch::felt_width(values.as_slice()?, places.as_slice()?.as_chunks().0, middle))
}

/// Return a felt strength in dB above the threshold; minus infinity for 0.
#[pyfunction]
pub(crate) fn decibels(strength: f64) -> f64 {
    touch::decibels(strength)
}

/// Return the plane of a hand through the middle of points (K, 3) in m, which faces the array.
#[pyfunction]
pub(crate) fn hand(points: &Bound<'_, PyAny>, array: &Array, margin: f64, pixels: usize) -> PyResult<Plane> {
    let points = read::vectors("points", points)?;
    Ok(Plane { inner: touch::hand(&points, &array.inner, margin, pixels).map_err(refused)? })
}

/// Systems (A + s B) x = b with a sparse symmetric A and a diagonal B, as the core's `Shifted`.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Shifted {
    inner: touch::Shifted,
}

#[pymethods]
impl Shifted {
    #[new]
    fn new(starts: Vec<usize>, rows: Vec<u32>, values: Vec<f64>, shares: Vec<f64>) -> PyResult<Self> {
        Ok(Self { inner: touch::Shifted::new(&starts, &rows, &values, &shares).map_err(refused)? })
    }

    /// The solutions (L V,) for shifts (L,) and loads (L V,), one after another.
    fn solve<'py>(
        &self,
        py: Python<'py>,
        shifts: &Bound<'py, PyAny>,
        loads: &Bound<'py, PyAny>,
    ) -> PyResult<Array1<'py, Complex32>> {
        let (shifts, loads, set) = (
            read::complexes("shifts", shifts)?,
            read::drive("loads", loads)?,
            InstructionSet::requested().map_err(refused)?,
        );
        let solutions = attend(py, None, |mut control| self.inner.solve(set, &shifts, &loads, &mut control))?;
        Ok(give::list(py, solutions))
    }
}
