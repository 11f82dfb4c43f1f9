//! Link: how a computer is connected to a kind of board.

/// The type of link over which the bytes reach a kind of board.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Link {
    /// One serial line for all boards. A byte takes ten bits.
    Serial {
        /// Bits per second.
        baud: u32,
        /// The byte that exchanges the two banks of a board; `None` if it has no banks.
        swap: Option<u8>,
        /// Whether opening the port may restart the board, as with an Arduino.
        restarts: bool,
    },
    /// One FIFO of an FTDI chip for each board.
    Fifo {
        /// The most frames per second that the link transmits.
        rate: f64,
        /// Whether two boards may use the two FIFOs of one chip.
        one_chip: bool,
    },
    /// AUTD3's protocol over UDP, for all boards.
    Udp {
        /// The most frames per second that the link transmits.
        rate: f64,
    },
}

impl Link {
    /// The name of the link: "serial", "fifo" or "udp".
    pub fn name(self) -> &'static str {
        match self {
            Self::Serial { .. } => "serial",
            Self::Fifo { .. } => "fifo",
            Self::Udp { .. } => "udp",
        }
    }

    /// The byte that exchanges the two banks of a board; `None` if it has no banks.
    pub fn swap(self) -> Option<u8> {
        if let Self::Serial { swap, .. } = self { swap } else { None }
    }

    /// Whether opening the port may restart the board.
    pub fn restarts(self) -> bool {
        matches!(self, Self::Serial { restarts: true, .. })
    }

    /// Whether two boards may use the two FIFOs of one chip.
    pub fn one_chip(self) -> bool {
        matches!(self, Self::Fifo { one_chip: true, .. })
    }

    /// Whether amplitudes can be modulated. Over a serial line this is done by exchanging two banks, one of which is off.
    pub fn modulates(self) -> bool {
        self.swap().is_some() || self.holds_sequence()
    }

    /// Whether the board can store a sequence and play it by itself.
    pub fn holds_sequence(self) -> bool {
        matches!(self, Self::Udp { .. })
    }
}
