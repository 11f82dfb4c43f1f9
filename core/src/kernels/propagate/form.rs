//! Form of an element: which factors it has beyond distance and gain.
//!
//! A form is a type, chosen before a loop over points, which is compiled for each. So an element pays for what it has:
//! point sources without absorption in phase for nothing, a piston for 12 instructions.

use crate::kernels::propagate::directivity::{Ahead, Pattern};
use crate::kernels::simd::Elementwise;

/// Properties that all transducers share: absorption as a power of two per wavelength (< 0) and the directivity.
#[derive(Clone, Debug)]
pub(crate) struct Radiation {
    pub(crate) decay: Option<f32>,
    pub(crate) pattern: Option<Pattern>,
}

impl Radiation {
    /// Whether its form is [`Plain`].
    #[inline(always)]
    pub(crate) fn is_plain(&self, in_phase: bool) -> bool {
        self.decay.is_none() && self.pattern.is_none() && in_phase
    }
}

/// See above.
pub(crate) trait Form: Copy {
    /// A form without absorption and without a phase of its own.
    const PLAIN: bool = false;

    /// `amplitude` times D, where the cosine is `along` (the ray's part along the normal) times `inverse`.
    fn direct<S: Elementwise>(self, s: S, amplitude: S::V, along: impl FnOnce() -> S::V, inverse: S::V) -> S::V;
}

/// Point sources without absorption, in phase.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

/// Point sources.
#[derive(Clone, Copy)]
pub(crate) struct Everywhere;

impl Form for Plain {
    const PLAIN: bool = true;

    #[inline(always)]
    fn direct<S: Elementwise>(self, _: S, amplitude: S::V, _: impl FnOnce() -> S::V, _: S::V) -> S::V {
        amplitude
    }
}

impl Form for Everywhere {
    #[inline(always)]
    fn direct<S: Elementwise>(self, _: S, amplitude: S::V, _: impl FnOnce() -> S::V, _: S::V) -> S::V {
        amplitude
    }
}

/// Transducers in a baffle.
impl<P: Ahead> Form for &P {
    #[inline(always)]
    fn direct<S: Elementwise>(self, s: S, amplitude: S::V, along: impl FnOnce() -> S::V, inverse: S::V) -> S::V {
        let along = along();
        let directed = s.mul(amplitude, self.directivity(s, along, inverse));
        // 90 degrees are ahead. (With the sides swapped the selection would take AVX-512 an instruction more.)
        s.select_less(s.splat(-f32::MIN_POSITIVE), along, directed, s.splat(0.0))
    }
}

/// Any form of radiation, found at each element: for sets whose code must be short.
#[derive(Clone, Copy)]
pub(crate) struct AnyForm<'a>(pub(crate) &'a Radiation);

impl Form for AnyForm<'_> {
    #[inline(always)]
    fn direct<S: Elementwise>(self, s: S, amplitude: S::V, along: impl FnOnce() -> S::V, inverse: S::V) -> S::V {
        match &self.0.pattern {
            None => amplitude,
            Some(pattern) => directed(s, pattern, amplitude, along(), inverse),
        }
    }
}

/// Like [`Form::direct`]: one function of the program.
#[inline(never)]
fn directed<S: Elementwise>(s: S, pattern: &Pattern, amplitude: S::V, along: S::V, inverse: S::V) -> S::V {
    macro_rules! by {
        ($pattern:expr) => {
            $pattern.direct(
                s,
                amplitude,
                #[inline(always)]
                || along,
                inverse,
            )
        };
    }
    match pattern {
        Pattern::Even6(pattern) => by!(pattern),
        Pattern::Even10(pattern) => by!(pattern),
        Pattern::Even14(pattern) => by!(pattern),
        Pattern::All6(pattern) => by!(pattern),
        Pattern::All10(pattern) => by!(pattern),
        Pattern::All14(pattern) => by!(pattern),
        Pattern::Chebyshev(pattern) => by!(pattern),
        Pattern::Pieces(pattern) => by!(pattern),
        Pattern::Exponent(pattern) => by!(pattern),
    }
}

/// Runs an expression with the form that a radiation has: `formed!(s, radiation, in_phase, form => body)`.
macro_rules! formed {
    ($s:expr, $radiation:expr, $in_phase:expr, $form:ident => $body:expr) => {{
        use crate::kernels::propagate::directivity::Pattern;
        use crate::kernels::propagate::form::{AnyForm, Everywhere, Plain};
        macro_rules! with {
            ($value:expr) => {{
                let $form = $value;
                $body
            }};
        }
        match &$radiation.pattern {
            None if $radiation.is_plain($in_phase) => with!(Plain),
            _ if $s.is_short() => with!(AnyForm($radiation)),
            None => with!(Everywhere),
            Some(Pattern::Even6(pattern)) => with!(pattern),
            Some(Pattern::Even10(pattern)) => with!(pattern),
            Some(Pattern::Even14(pattern)) => with!(pattern),
            Some(Pattern::All6(pattern)) => with!(pattern),
            Some(Pattern::All10(pattern)) => with!(pattern),
            Some(Pattern::All14(pattern)) => with!(pattern),
            Some(Pattern::Chebyshev(pattern)) => with!(pattern),
            Some(Pattern::Pieces(pattern)) => with!(pattern),
            Some(Pattern::Exponent(pattern)) => with!(pattern),
        }
    }};
}
pub(crate) use formed;
