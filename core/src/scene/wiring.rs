//! Wiring: transducers that share a channel, and the boards of an array.

use crate::device::board::{self, Board};
use crate::device::channels::Channels;
use crate::device::format::Layout;
use crate::prelude::*;
use crate::scene::array::Array;

impl Array {
    /// Returns the array of a kind of board: its preset, or a grid if each owner wires this kind differently.
    ///
    /// # Errors
    /// An unknown name, tiles of 0, tiles for a kind that cannot be tiled.
    pub fn of_board(kind: &str, tiles: [usize; 2]) -> Result<Self> {
        let format = board::format(kind)?;
        match format.layout {
            Layout::Preset(name) | Layout::Example(name) => Self::preset(name, tiles),
            Layout::Grid(nx, ny, pitch) if tiles == [1, 1] => {
                Ok(Self::grid(nx, ny, pitch)?.with_quantization(Some(format.steps.quantization()?)))
            }
            Layout::Grid(..) => {
                let cure = "this kind of board is one piece: leave tiles out";
                Err(Error::invalid("array.tiles", format!("{tiles:?}"), cure))
            }
        }
    }

    /// Returns boards of this kind for the array, which stands in the order of the boards, or states its pins. Each transducer
    /// has its own channel, unless the array has channels. Masked and dead transducers are off. A channel is off if all its
    /// transducers are off. For an array without responses, the bytes correct the delays of the firmware.
    ///
    /// # Errors
    /// An unknown name, more transducers or channels than the boards have, another order or other places than those of the
    /// boards, pins together with channels.
    ///
    /// ```
    /// use midair::{Array, Complex32};
    ///
    /// let levitator = Array::preset("tinylev", [1, 1])?;
    /// let board = levitator.board("nano")?;
    /// assert_eq!((board.len(), board.channels()), (72, &[0, 1][..]));
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn board(&self, kind: &str) -> Result<Board> {
        let format = board::format(kind)?;
        let board = match (self.wiring(), self.pins()) {
            (Some(_), Some(_)) => {
                return Err(Error::conflict("array.pins", "given with array.channels", "leave one of them out"));
            }
            (Some(channels), None) => {
                if channels.count() == self.len() {
                    self.check_order(format, &channels.of().iter().map(|&k| format.channel(k)).collect::<Vec<_>>())?;
                } else if let Layout::Preset(_) = format.layout {
                    let cure =
                        format!("{kind} drives each transducer alone: leave them out, or give channels= of a Board");
                    return Err(Error::conflict("array.channels", "given", cure));
                }
                Board::wired(kind, channels)?
            }
            (None, Some(pins)) => {
                let board = Board::on(kind, pins.to_vec(), None)?;
                if let Layout::Preset(_) = format.layout {
                    self.check_order(format, pins)?;
                }
                board
            }
            (None, None) => {
                let board = Board::new(kind, self.len())?;
                self.check_order(format, board.channels())?;
                board
            }
        };
        board.correcting(self.response().is_none()).with_live(self.live())
    }

    /// Returns boards of this kind with the channel of each transducer (N,), or of each channel of the array (C,), whatever
    /// their places.
    ///
    /// # Errors
    /// An unknown name, more transducers or channels than the boards have, the errors of [`Board::with_channels`].
    pub fn board_on(&self, kind: &str, channels: Vec<usize>) -> Result<Board> {
        let (count, owners) =
            self.wiring().map_or((self.len(), "transducers"), |wired| (wired.count(), "channels of the array"));
        one_each("channels", channels.len(), "of them", count, owners)?;
        let board = Board::on(kind, channels, self.wiring())?;
        board.correcting(self.response().is_none()).with_live(self.live())
    }

    /// Returns a copy of this array with several transducers wired to one channel: `channels` (N,) gives the channel of each
    /// transducer, 0 to C - 1. Drives keep the shape (N,) and are equal within a channel. `None`, and 0 to N - 1 in order, give
    /// each transducer its own channel.
    ///
    /// # Errors
    /// The errors of [`Channels::new`].
    pub fn with_channels(mut self, channels: Option<Vec<usize>>) -> Result<Self> {
        self.channels = channels.map_or(Ok(None), |channels| Channels::new(channels, self.len()))?;
        Ok(self)
    }
}

getters! {
    Array:

    /// Whether each transducer emits (N,).
    live(self) -> Vec<bool> = (0..self.len()).map(|i| self.effect(i) != Complex64::ZERO).collect();

    /// The driven channel of each transducer (N,), or `None` where each has its own.
    pub channels(self) -> Option<&[usize]> = self.wiring().map(Channels::of);

    /// The wiring as [`Channels`].
    pub wiring(self) -> Option<&Channels> = self.channels.as_ref();
}
