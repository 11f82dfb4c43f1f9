//! Status: how a solve ended.

use crate::prelude::*;

/// How a solve ended. It is part of the result, never an error. C and JavaScript get its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// The method ran to its end.
    Done = 0,
    /// The method's steps ran out before its tolerance was met.
    OutOfSteps = 1,
    /// The caller requested a stop; the answer is the best so far.
    Stopped = 2,
    /// The method ran to its end, and the targets are missed by more than 1 %.
    Missed = 3,
}

impl Status {
    /// Every status, in the order of its numbers.
    pub const ALL: [Self; 4] = [Self::Done, Self::OutOfSteps, Self::Stopped, Self::Missed];

    /// The name of the status.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::OutOfSteps => "out_of_steps",
            Self::Stopped => "stopped",
            Self::Missed => "missed",
        }
    }

    /// Returns the status with this name.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self> {
        let status = Self::ALL.into_iter().find(|status| status.name() == name);
        status.ok_or_else(|| Error::unknown("status", name, Self::ALL.map(Self::name)))
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
