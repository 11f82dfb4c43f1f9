//! Boards: converts drives to the bytes of a board.

use std::ffi::c_char;

use crate::memory::{Complex, drive as read_drive, fill, give, handle, text};
use crate::outcome::{Message, Outcome, outcome};
use crate::session::Session;

/// The boards of an array. They never change: any number of threads may use them at the same time.
pub struct Board {
    inner: midair::Board,
    silence: Vec<u8>,
}

impl From<midair::Board> for Board {
    fn from(inner: midair::Board) -> Self {
        Self { silence: inner.silence(), inner }
    }
}

/// The link that carries bytes to boards.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub enum LinkKind {
    /// A serial line.
    Serial = 0,
    /// FIFOs of FTDI chips, one for each board.
    Fifo = 1,
    /// AUTD3's protocol over UDP.
    Udp = 2,
}

/// How bytes reach the boards, and what the boards can do by themselves. Of the int32_t fields, all but swap are 1 for yes, 0
/// for no.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// The link that carries the bytes.
    pub kind: LinkKind,
    /// The number of lines. A frame consists of one part for each line, all of the same length, one after the other.
    pub lines: usize,
    /// Bits per second of a serial line, where a byte takes ten bits; 0 for other links.
    pub baud: u32,
    /// The most frames per second that the line can transmit.
    pub rate: f64,
    /// The byte that exchanges the two banks of a board; -1 if it has no banks.
    pub swap: i32,
    /// Whether opening the port may restart the board.
    pub restarts: i32,
    /// Whether two boards may use the two lines of one chip.
    pub one_chip: i32,
    /// Whether amplitudes can be modulated.
    pub modulates: i32,
    /// Whether the boards can play a sequence by themselves.
    pub holds_sequence: i32,
}

impl From<&midair::Board> for Link {
    fn from(board: &midair::Board) -> Self {
        let link = board.link();
        Self {
            kind: match link {
                midair::Link::Serial { .. } => LinkKind::Serial,
                midair::Link::Fifo { .. } => LinkKind::Fifo,
                _ => LinkKind::Udp,
            },
            lines: board.lines(),
            baud: board.baud().unwrap_or_default(),
            rate: board.rate(),
            swap: link.swap().map_or(-1, i32::from),
            restarts: link.restarts().into(),
            one_chip: link.one_chip().into(),
            modulates: link.modulates().into(),
            holds_sequence: link.holds_sequence().into(),
        }
    }
}

/// Makes as many boards of this kind, such as "sonicsurface" or "openmpd", as an array of this many transducers needs. Drives
/// must be in the order of the kind's preset; midair_board_of_session checks this.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_board_new(
    name: *const c_char,
    transducers: usize,
    board: *mut *mut Board,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    let message = Message { text: message, size: message_size };
    // SAFETY: the caller guarantees name and board.
    unsafe { give("board", board, message, || Ok((midair::Board::new(text("board", name)?, transducers)?.into(), ""))) }
}

/// Makes as many boards of this kind as a session's array needs. The array stands in the order of the boards, moved and turned,
/// or states its pins; otherwise the message names the order that fits. Transducers that its option "channels", its preset or
/// its scene wires together share a channel; transducers that its mask switches off have none. The session may be freed
/// afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_board_of_session(
    name: *const c_char,
    session: *mut Session,
    board: *mut *mut Board,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    let message = Message { text: message, size: message_size };
    // SAFETY: the caller guarantees name, session and board.
    unsafe {
        give("board", board, message, || {
            let name = text("board", name)?;
            Ok((Session::behind(session)?.state()?.board(name)?.into(), ""))
        })
    }
}

/// Returns the size of a frame in bytes, for all boards; 0 for NULL.
#[unsafe(no_mangle)]
pub extern "C" fn midair_board_frame_size(board: Option<&Board>) -> usize {
    board.map_or(0, |board| board.inner.frame_size())
}

/// Writes the frame that makes the boards play a drive of this many transducers; size is midair_board_frame_size(). The message
/// warns of a drive so weak that all of it is off.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_board_encode(
    board: Option<&Board>,
    drive: *const Complex,
    transducers: usize,
    frame: *mut u8,
    size: usize,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        let board = &handle("board", board)?.inner;
        let mut bytes = vec![0; board.frame_size()];
        // SAFETY: the caller guarantees the drive and the buffer.
        unsafe {
            let drive = read_drive(drive, transducers)?;
            board.encode(drive, &mut bytes)?;
            fill("frame", frame, size, &bytes)?;
            Ok(board.mutes(drive, &bytes).map_or_else(String::new, |notice| notice.to_string()))
        }
    })
}

/// Returns the number of bytes that switch the boards off; 0 for NULL.
#[unsafe(no_mangle)]
pub extern "C" fn midair_board_silence_size(board: Option<&Board>) -> usize {
    board.map_or(0, |board| board.silence.len())
}

/// Writes the bytes that switch the boards off from any state; size is midair_board_silence_size().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_board_silence(
    board: Option<&Board>,
    bytes: *mut u8,
    size: usize,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees the buffer.
        unsafe { fill("bytes", bytes, size, &handle("board", board)?.silence) }
    })
}

/// Writes to link how bytes reach the boards, and what the boards can do by themselves.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_board_link(
    board: Option<&Board>,
    link: *mut Link,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        // SAFETY: the caller guarantees the buffer.
        unsafe { fill("link", link, 1, &[(&handle("board", board)?.inner).into()]) }
    })
}

/// Frees a board. NULL is allowed.
#[unsafe(no_mangle)]
pub extern "C" fn midair_board_free(board: Option<Box<Board>>) {
    drop(board);
}
