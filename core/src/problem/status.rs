//! Status: how a solve ended.

use alloc::format;
use core::fmt;

use crate::error::Error;

/// How a solve ended. It is part of the result, never an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// The method ran to its end.
    Done,
    /// The method's steps ran out before its tolerance was met.
    OutOfSteps,
    /// The caller requested a stop; the answer is the best so far.
    Stopped,
    /// The method ran to its end, and the targets are missed by more than 1 %.
    Missed,
}

impl Status {
    /// Returns the status with this name, as `Display` writes it.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self, Error> {
        let all = [Self::Done, Self::OutOfSteps, Self::Stopped, Self::Missed];
        let found = all.into_iter().find(|status| format!("{status}") == name);
        found.ok_or_else(|| Error::unknown("status", name, ["done", "out_of_steps", "stopped", "missed"]))
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Done => "done",
            Self::OutOfSteps => "out_of_steps",
            Self::Stopped => "stopped",
            Self::Missed => "missed",
        })
    }
}
