//! Acoustic boundary condition of an obstacle: rigid or soft.

use crate::scene::value::words;

/// A place counts as on the surface of an obstacle if its distance from the surface is below this, in m.
pub(crate) const ON: f64 = 1e-9;

/// The acoustic boundary condition of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Surface {
    /// The air cannot move across the surface: dp/dn = 0. Solids in air are rigid.
    #[default]
    Rigid,
    /// The surface does not resist sound: p = 0 (pressure-release).
    Soft,
}

words!(Surface: "rigid" = Surface::Rigid, "soft" = Surface::Soft);

impl Surface {
    /// "rigid" or "soft".
    pub fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Soft => "soft",
        }
    }
}
