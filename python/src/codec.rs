//! `Codec`: converts drives to the bytes of a board's frame; the core of `midair.Board`.

use midair::Board;
use pyo3::types::PyBytes;

use crate::array::Array;
use crate::prelude::*;
use crate::quantization;

/// Converts drives (N,) to the bytes of a board's frame, and back.
#[pyclass(frozen, module = "midair._midair")]
pub(crate) struct Codec {
    board: Board,
}

#[pymethods]
impl Codec {
    #[new]
    #[pyo3(signature = (name, array=None, *, channels=None, corrections=None))]
    fn new(
        name: &Bound<'_, PyAny>,
        array: Option<&Array>,
        channels: Argument<'_, '_>,
        corrections: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let kind = read::name(name)?;
        let channels = channels.map(|list| {
            let cure = "give whole numbers (N,)";
            list.extract::<Vec<usize>>().map_err(|_| invalid("channels", &crate::numbers::quoted(list), cure))
        });
        let channels = channels.transpose()?;
        let board = match (array, channels) {
            (None, _) => Board::new(&kind, 1),
            (Some(array), None) => array.inner.board(&kind),
            (Some(array), Some(channels)) => array.inner.board_on(&kind, channels),
        }
        .map_err(refused)?
        // The array of a `midair.Board` has the response of its boards.
        .correcting(false);
        if let Some(corrections) = corrections {
            let corrections = read::reals("corrections", corrections)?;
            return Ok(Self { board: board.with_corrections(&corrections).map_err(refused)? });
        }
        Ok(Self { board })
    }

    /// Returns the kinds of boards by name, each as a codec for one transducer.
    #[staticmethod]
    fn kinds(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let kinds = PyDict::new(py);
        for name in Board::names() {
            kinds.set_item(name, Self { board: Board::new(name, 1).map_err(refused)? })?;
        }
        Ok(kinds)
    }

    /// Returns the default array of a kind of board: that of its preset, or a grid.
    #[staticmethod]
    #[pyo3(signature = (kind, tiles=None))]
    fn array(kind: &str, tiles: Argument<'_, '_>) -> PyResult<Array> {
        Ok(midair::Array::of_board(kind, read::tiles(tiles)?).map_err(refused)?.into())
    }

    /// Returns the frame of a drive (N,).
    fn encode<'py>(&self, py: Python<'py>, drive: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyBytes>> {
        let drive = read::drive("drive", drive)?;
        let mut frame = vec![0; self.board.frame_size()];
        self.board.encode(&drive, &mut frame).map_err(refused)?;
        Ok(PyBytes::new(py, &frame))
    }

    /// Warns if a frame of a drive (N,) above 0 switches all transducers off.
    fn warn_of_silence(&self, py: Python<'_>, drive: &Bound<'_, PyAny>, frame: &[u8]) -> PyResult<()> {
        warn_all(py, self.board.mutes(&read::drive("drive", drive)?, frame))
    }

    /// Returns the drive (N,) of a frame.
    fn decode<'py>(&self, py: Python<'py>, frame: &[u8]) -> PyResult<Array1<'py, Complex32>> {
        let mut drive = vec![Complex32::ZERO; self.board.len()];
        self.board.decode(frame, &mut drive).map_err(refused)?;
        Ok(give::list(py, drive))
    }

    /// Properties of the link to the board and of the board itself, by name.
    #[getter]
    fn link<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let link = self.board.link();
        let facts = [
            ("restarts", link.restarts()),
            ("one_chip", link.one_chip()),
            ("modulates", link.modulates()),
            ("holds_sequence", link.holds_sequence()),
        ]
        .into_py_dict(py)?;
        facts.set_item("kind", link.name())?;
        facts.set_item("swap", link.swap().map(|byte| format!("{byte:02x}")))?;
        Ok(facts)
    }

    /// Channel of each transducer (N,), or of each of the array's channels (C,).
    #[getter]
    fn channels<'py>(&self, py: Python<'py>) -> Array1<'py, i64> {
        give::list(
            py,
            self.board.channels().iter().map(|&channel| i64::try_from(channel).unwrap_or(i64::MAX)).collect(),
        )
    }
}

getters! {
    Codec:

    /// Frame that turns all transducers off.
    off_frame(self, py) -> Bound<'py, PyBytes> = PyBytes::new(py, &self.board.off_frame());

    /// Bytes that silence the boards from any state.
    silence(self, py) -> Bound<'py, PyBytes> = PyBytes::new(py, &self.board.silence());

    /// The board's name.
    name(self) -> &'static str = self.board.name();

    /// Description in one line.
    summary(self) -> &'static str = self.board.summary();

    /// Source of the byte format.
    source(self) -> &'static str = self.board.source();

    /// Number of boards.
    boards(self) -> usize = self.board.boards();

    /// Number of lines. A frame has one part of equal length for each line, one after the other.
    lines(self) -> usize = self.board.lines();

    /// Largest number of boards that play together.
    most_boards(self) -> usize = self.board.most_boards();

    /// Frequency in Hz.
    frequency(self) -> f64 = self.board.frequency();

    /// Complex factor (N,) of each transducer's radiation, or None if all are 1.
    response(self, py) -> Option<Array1<'py, Complex64>> = self.board.response().map(|list| give::list(py, list));

    /// Bits per second of the board's serial line, or None for another link.
    baud(self) -> Option<u32> = self.board.baud();

    /// Frames per second that the board's line can carry.
    rate(self) -> f64 = self.board.rate();

    /// Highest number of frames per second at which the board emits as much as with a constant frame.
    steady_rate(self) -> f64 = self.board.steady_rate();

    /// Phases and amplitudes of the board, in the form of `Array.quantization`.
    quantization(self, py) -> PyResult<Bound<'py, PyDict>> =
        quantization::object(py, &self.board.quantization().map_err(refused)?);
}
