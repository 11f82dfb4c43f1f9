//! Link: the line to a kind of board, and the board's own behaviour.

/// The link over which bytes reach a kind of board.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Link {
    /// A serial line for all boards. A byte takes ten bits.
    Serial {
        /// Bits a second.
        baud: u32,
        /// The byte that exchanges the two banks of a board that has them.
        swap: Option<u8>,
        /// Whether opening the port may restart the board, as it does an Arduino.
        restarts: bool,
    },
    /// A FIFO of an FTDI chip for each board.
    Fifo {
        /// Frames a second.
        rate: f64,
        /// Whether the FIFOs of two boards may be the two of one chip.
        one_chip: bool,
    },
    /// AUTD3's protocol over UDP, for all boards.
    Udp {
        /// Frames a second.
        rate: f64,
    },
}

impl Link {
    /// "serial", "fifo" or "udp".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Serial { .. } => "serial",
            Self::Fifo { .. } => "fifo",
            Self::Udp { .. } => "udp",
        }
    }

    /// The byte that exchanges the two banks of a board that has them.
    #[must_use]
    pub fn swap(self) -> Option<u8> {
        if let Self::Serial { swap, .. } = self { swap } else { None }
    }

    /// Whether opening its port may restart the board.
    #[must_use]
    pub fn restarts(self) -> bool {
        matches!(self, Self::Serial { restarts: true, .. })
    }

    /// Whether the lines of two boards may be the two of one chip.
    #[must_use]
    pub fn one_chip(self) -> bool {
        matches!(self, Self::Fifo { one_chip: true, .. })
    }

    /// Whether amplitudes can be modulated: over a serial line by swaps of two banks, of which one is off.
    #[must_use]
    pub fn modulates(self) -> bool {
        self.swap().is_some() || self.holds_sequence()
    }

    /// Whether the board can play a sequence by itself.
    #[must_use]
    pub fn holds_sequence(self) -> bool {
        matches!(self, Self::Udp { .. })
    }
}
