//! Outcome of a call: a result code, and a line in the caller's buffer. Panics do not reach C.

use std::any::Any;
use std::cell::Cell;
use std::ffi::c_char;
use std::panic::{AssertUnwindSafe, catch_unwind};

use midair::{ErrorCode, Result};

/// The result of a call. Unless it is MIDAIR_RESULT_OK, the caller's buffers have not changed, except for the message.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Success. The message is empty or contains warnings, one per line.
    Ok = 0,
    /// An argument is invalid. The message names it, its value and the cure.
    Invalid = 1,
    /// More memory than the limit, or than the machine has.
    Memory = 2,
    /// An error of the library itself; please report it.
    Fault = 3,
}

/// The buffer in which a caller receives a message.
#[derive(Clone, Copy)]
pub(crate) struct Message {
    pub(crate) text: *mut c_char,
    pub(crate) size: usize,
}

impl Message {
    /// Whether the caller receives a message.
    pub(crate) fn is_wanted(self) -> bool {
        !self.text.is_null() && self.size > 0
    }

    /// Writes a text and NUL after it. If the buffer is too short, the text is cut after a whole character.
    fn write(self, text: &str) {
        if !self.is_wanted() {
            return;
        }
        let most = text.len().min(self.size - 1);
        let end = (0..=most).rev().find(|&end| text.is_char_boundary(end)).unwrap_or(0);
        let part = &text[..end];
        // SAFETY: the buffer is not NULL, and the caller guarantees that it has `size` bytes. `part` is at most one byte
        // shorter. Our text does not overlap with a buffer of the caller.
        unsafe {
            self.text.cast::<u8>().copy_from_nonoverlapping(part.as_ptr(), part.len());
            self.text.add(part.len()).write(0);
        }
    }
}

thread_local! {
    /// The code of this thread's last call; `None` if it did not fail.
    static LAST: Cell<Option<ErrorCode>> = const { Cell::new(None) };
}

/// The texts of all codes in their order, each with NUL after it.
static CODES: [[u8; 32]; ErrorCode::ALL.len()] = {
    let mut texts = [[0; 32]; ErrorCode::ALL.len()];
    let mut k = 0;
    while k < texts.len() {
        let text = ErrorCode::ALL[k].1.as_bytes();
        texts[k].split_at_mut(text.len()).0.copy_from_slice(text);
        k += 1;
    }
    texts
};

/// Returns the code of the error of this thread's last call that can fail, such as "too-near"; an empty text if it did not fail.
/// docs/errors.md lists all codes. They never change, unlike the words of messages. The text is valid as long as the library is
/// loaded.
#[unsafe(no_mangle)]
pub extern "C" fn midair_last_code() -> *const c_char {
    LAST.get().map_or(c"".as_ptr(), |code| CODES[code as usize].as_ptr().cast())
}

/// Runs the work of a function. Writes its warnings, its error or its panic to the message.
pub(crate) fn outcome<T: AsRef<str>>(message: Message, work: impl FnOnce() -> Result<T>) -> Outcome {
    // After a panic, no later call reads data that the panicking call may have left incomplete.
    let (code, outcome) = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(said)) => {
            message.write(said.as_ref());
            (None, Outcome::Ok)
        }
        Ok(Err(error)) => {
            message.write(&error.to_string());
            (Some(error.code), if error.code == ErrorCode::Memory { Outcome::Memory } else { Outcome::Invalid })
        }
        Err(panic) => {
            message.write(&format!("a fault of midair's own, please report it: {}", words(&*panic)));
            (Some(ErrorCode::Fault), Outcome::Fault)
        }
    };
    LAST.set(code);
    outcome
}

/// Returns the message of a panic.
fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no words")
}

#[cfg(test)]
#[path = "tests/outcome.rs"]
mod tests;
