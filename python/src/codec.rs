//! `Codec`: frames of bytes of a board, behind `midair.Board`.

use midair::{Board, Complex32, Complex64};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBytes, PyDict};

use crate::array::Array;
use crate::error::{invalid, refused};
use crate::getters::getters;
use crate::give;
use crate::quantization;
use crate::read;

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Drives (N,) to the bytes of a board's frame, and back.
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
        let mut board =
            array.map_or_else(|| Board::new(&kind, 1), |array| array.inner.board(&kind)).map_err(refused)?;
        if let Some(channels) = channels {
            let Ok(channels) = channels.extract() else {
                return Err(invalid("channels", &crate::numbers::quoted(channels), "give whole numbers (N,)"));
            };
            board = board.with_channels(channels).map_err(refused)?;
        }
        if let Some(corrections) = corrections {
            board = board.with_corrections(&read::reals("corrections", corrections)?).map_err(refused)?;
        }
        Ok(Self { board })
    }

    /// The kinds of boards by name, each as the codec of one transducer.
    #[staticmethod]
    fn kinds(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let kinds = PyDict::new(py);
        for name in Board::names() {
            kinds.set_item(name, Self { board: Board::new(name, 1).map_err(refused)? })?;
        }
        Ok(kinds)
    }

    /// The array of a kind until the caller gives one: its preset's, or a grid.
    #[staticmethod]
    #[pyo3(signature = (kind, tiles=None))]
    fn array(kind: &str, tiles: Argument<'_, '_>) -> PyResult<Array> {
        Ok(midair::Array::of_board(kind, read::tiles(tiles)?).map_err(refused)?.into())
    }

    /// The frame of a drive (N,).
    fn encode<'py>(&self, py: Python<'py>, drive: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyBytes>> {
        let drive = read::drive("drive", drive)?;
        let mut frame = vec![0; self.board.frame_size()];
        self.board.encode(&drive, &mut frame).map_err(refused)?;
        Ok(PyBytes::new(py, &frame))
    }

    /// The drive (N,) of a frame.
    fn decode<'py>(&self, py: Python<'py>, frame: &[u8]) -> PyResult<Bound<'py, PyArray1<Complex32>>> {
        let mut drive = vec![Complex32::ZERO; self.board.len()];
        self.board.decode(frame, &mut drive).map_err(refused)?;
        Ok(give::list(py, drive))
    }

    /// How bytes reach it and what it does behind that link, by name.
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

    /// The channel of each transducer (N,), or (C,) of each of the array's channels.
    #[getter]
    fn channels<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        give::list(
            py,
            self.board.channels().iter().map(|&channel| i64::try_from(channel).unwrap_or(i64::MAX)).collect(),
        )
    }
}

getters! {
    Codec:

    /// The frame that plays nothing.
    off_frame(self, py) -> Bound<'py, PyBytes> = PyBytes::new(py, &self.board.off_frame());

    /// The bytes that silence the boards from any state.
    silence(self, py) -> Bound<'py, PyBytes> = PyBytes::new(py, &self.board.silence());

    /// The board's name.
    name(self) -> &'static str = self.board.name();

    /// Its description in one line.
    summary(self) -> &'static str = self.board.summary();

    /// Where its bytes are read.
    source(self) -> &'static str = self.board.source();

    /// Number of boards.
    boards(self) -> usize = self.board.boards();

    /// Number of lines; a frame is as many parts of one length, one after the other.
    lines(self) -> usize = self.board.lines();

    /// The most boards that play together.
    most_boards(self) -> usize = self.board.most_boards();

    /// Hz that it emits.
    frequency(self) -> f64 = self.board.frequency();

    /// What each transducer (N,) radiates for a drive of 1, or None where that is 1.
    response(self, py) -> Option<Bound<'py, PyArray1<Complex64>>> =
        self.board.response().map(|list| give::list(py, list));

    /// Bits a second of its serial line, or None.
    baud(self) -> Option<u32> = self.board.baud();

    /// Frames a second that its line can carry.
    rate(self) -> f64 = self.board.rate();

    /// Frames a second up to which it emits as at rest.
    steady_rate(self) -> f64 = self.board.steady_rate();

    /// The board's grid, in the form of `Array.quantization`.
    quantization(self, py) -> PyResult<Option<Bound<'py, PyDict>>> =
        quantization::shown(py, Some(&self.board.quantization().map_err(refused)?));
}
