//! Form of an element of G: the factors that it has besides distance and gain.
//!
//! A form is a type, chosen before a loop over points, and the loop is compiled for each. So an element costs only the
//! factors that it has: none for point sources in phase without absorption, 12 instructions for a piston.

use crate::kernels::propagate::directivity::{Ahead, Pattern};
use crate::kernels::simd::Elementwise;

/// Properties that all transducers share: absorption as a power of two per wavelength (< 0), and the directivity.
#[derive(Clone, Debug)]
pub(crate) struct Radiation {
    pub(crate) decay: Option<f32>,
    pub(crate) pattern: Option<Pattern>,
}

impl Radiation {
    /// Returns whether the form of these transducers is [`Plain`].
    #[inline(always)]
    pub(crate) fn is_plain(&self, in_phase: bool) -> bool {
        self.decay.is_none() && self.pattern.is_none() && in_phase
    }
}

/// The factors of an element of G besides distance and gain.
pub(crate) trait Form: Copy {
    /// Whether the form has no absorption and no phase of its own.
    const PLAIN: bool = false;

    /// Returns `amplitude` times D, where cos(theta) is `along` (the ray's part along the normal) times `inverse`.
    fn direct<S: Elementwise>(self, s: S, amplitude: S::V, along: impl FnOnce() -> S::V, inverse: S::V) -> S::V;
}

/// Form of point sources in phase, without absorption.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

/// Form of point sources.
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

/// Form of transducers in a baffle: nothing is radiated backwards.
impl<P: Ahead> Form for &P {
    #[inline(always)]
    fn direct<S: Elementwise>(self, s: S, amplitude: S::V, along: impl FnOnce() -> S::V, inverse: S::V) -> S::V {
        let along = along();
        let directed = s.mul(amplitude, self.directivity(s, along, inverse));
        // An angle of 90 degrees counts as in front. (With the sides swapped the selection would take one more
        // instruction in AVX-512.)
        s.select_less(s.splat(-f32::MIN_POSITIVE), along, directed, s.splat(0.0))
    }
}

/// The form of some radiation, found anew at each element: for instruction sets whose code must be short.
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

/// Does the same as [`Form::direct`], as one function that is not inlined.
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

/// Evaluates an expression with the form of a radiation: `formed!(s, radiation, in_phase, form => body)`.
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
