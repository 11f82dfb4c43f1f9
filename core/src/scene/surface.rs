//! Acoustic boundary condition of an obstacle: rigid or soft.

use crate::scene::value::words;

/// Metres that count as none beside an obstacle's surface.
pub(crate) const ON: f64 = 1e-9;

/// The acoustic boundary condition of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::exhaustive_enums, reason = "the two ideal surfaces")]
pub enum Surface {
    /// The air cannot move across it: dp/dn = 0. Solids in air.
    #[default]
    Rigid,
    /// A surface without resistance to sound: p = 0 (pressure-release).
    Soft,
}

words!(Surface: "rigid" = Surface::Rigid, "soft" = Surface::Soft);

impl Surface {
    /// "rigid" or "soft".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Soft => "soft",
        }
    }
}
