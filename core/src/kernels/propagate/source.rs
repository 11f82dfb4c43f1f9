//! Sources: the transducers in the layout that the kernels read, sixteen to a group; and the form of an element of G.
//!
//! The form is the factors that an element has besides distance and gain. It is a type, chosen before a loop over points,
//! and the loop is compiled for each. So an element costs only the factors that it has: none for point sources in phase
//! without absorption, 12 instructions for a piston.

use crate::kernels::prelude::*;
use crate::kernels::propagate::directivity::{Ahead, Pattern};

/// One transducer. Lengths are in wavelengths, from the array's middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
    /// |c_i| times P0 over the reference pressure, per wavelength: c_i is the response, P0 the source pressure.
    pub(crate) amplitude: f32,
    /// The phase of the response c_i in turns.
    pub(crate) turns: f32,
}

/// Sixteen transducers, one in each lane.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct SourceGroup {
    position: [Lanes; 3],
    normal: [Lanes; 3],
    /// Whether every normal is +z.
    upright: bool,
    amplitude: Lanes,
    turns: Lanes,
    /// Whether all of `turns` are 0.
    in_phase: bool,
}

/// All transducers in groups of sixteen. Lanes after the last transducer have its position and amplitude 0.
#[derive(Clone, Debug)]
pub(crate) struct SourceList {
    pub(crate) groups: Vec<SourceGroup>,
    count: usize,
    /// Whether all transducers have a response c_i of phase 0.
    pub(crate) in_phase: bool,
}

impl SourceList {
    pub(crate) fn new(sources: &[Source]) -> Self {
        let groups = sources.chunks(LANES).map(SourceGroup::of).collect();
        Self { groups, count: sources.len(), in_phase: sources.iter().all(|source| source.turns == 0.0) }
    }

    /// Returns the number of transducers.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// Returns transducer `i` in all lanes.
    #[inline(always)]
    pub(crate) fn one<S: Elementwise>(&self, s: S, i: usize) -> SourceLanes<S::V> {
        self.groups[i / LANES].one(s, i % LANES)
    }

    /// Returns N transducers side by side: member k in the lanes from 16 k/N on. If there are fewer than N `members`,
    /// the last one also fills the remaining lanes.
    #[inline(always)]
    pub(crate) fn segments<S: Elementwise, const N: usize>(&self, s: S, members: &[usize]) -> SourceLanes<S::V> {
        let at = core::array::from_fn(|quarter| {
            let i = members[(quarter * N / 4).min(members.len() - 1)];
            Lane { group: &self.groups[i / LANES], lane: i % LANES }
        });
        SourceLanes {
            position: [
                quarters(s, &at, |group| &group.position[0]),
                quarters(s, &at, |group| &group.position[1]),
                quarters(s, &at, |group| &group.position[2]),
            ],
            normal: [
                quarters(s, &at, |group| &group.normal[0]),
                quarters(s, &at, |group| &group.normal[1]),
                quarters(s, &at, |group| &group.normal[2]),
            ],
            upright: at.iter().all(|one| one.group.upright),
            amplitude: quarters(s, &at, |group| &group.amplitude),
            turns: quarters(s, &at, |group| &group.turns),
            in_phase: at.iter().all(|one| one.group.in_phase),
        }
    }
}

/// One transducer of a group.
struct Lane<'a> {
    group: &'a SourceGroup,
    lane: usize,
}

/// Returns one number of each of four transducers, each number in four lanes.
#[inline(always)]
fn quarters<S: Elementwise>(s: S, at: &[Lane<'_>; 4], list: impl Fn(&SourceGroup) -> &Lanes) -> S::V {
    let [a, b, c, d] = at;
    s.quarters([list(a.group)[a.lane], list(b.group)[b.lane], list(c.group)[c.lane], list(d.group)[d.lane]])
}

impl SourceGroup {
    /// Creates a group of one to sixteen sources.
    fn of(sources: &[Source]) -> Self {
        let upright = sources.iter().all(|source| source.normal == [0.0, 0.0, 1.0]);
        let in_phase = sources.iter().all(|source| source.turns == 0.0);
        let mut group = Self { upright, in_phase, ..Self::default() };
        for lane in 0..LANES {
            let source = sources[lane.min(sources.len() - 1)];
            for axis in 0..3 {
                group.position[axis][lane] = source.position[axis];
                group.normal[axis][lane] = source.normal[axis];
            }
            group.amplitude[lane] = if lane < sources.len() { source.amplitude } else { 0.0 };
            group.turns[lane] = source.turns;
        }
        group
    }

    /// Returns the transducer of one lane in all lanes.
    #[inline(always)]
    pub(crate) fn one<S: Elementwise>(&self, s: S, lane: usize) -> SourceLanes<S::V> {
        let [[x, y, z], [nx, ny, nz]] = [&self.position, &self.normal];
        SourceLanes {
            position: [s.splat(x[lane]), s.splat(y[lane]), s.splat(z[lane])],
            normal: [s.splat(nx[lane]), s.splat(ny[lane]), s.splat(nz[lane])],
            upright: self.upright,
            amplitude: s.splat(self.amplitude[lane]),
            turns: s.splat(self.turns[lane]),
            in_phase: self.in_phase,
        }
    }

    /// Returns each transducer in its lane.
    #[inline(always)]
    pub(crate) fn all<S: Elementwise>(&self, s: S) -> SourceLanes<S::V> {
        let [[x, y, z], [nx, ny, nz]] = [&self.position, &self.normal];
        SourceLanes {
            position: [s.load(x), s.load(y), s.load(z)],
            normal: [s.load(nx), s.load(ny), s.load(nz)],
            upright: self.upright,
            amplitude: s.load(&self.amplitude),
            turns: s.load(&self.turns),
            in_phase: self.in_phase,
        }
    }
}

/// The numbers of one transducer in all lanes, or of sixteen transducers.
pub(crate) struct SourceLanes<V> {
    pub(crate) position: [V; 3],
    pub(crate) normal: [V; 3],
    pub(crate) upright: bool,
    pub(crate) amplitude: V,
    pub(crate) turns: V,
    pub(crate) in_phase: bool,
}

impl<V: Copy> SourceLanes<V> {
    /// Returns the component of a ray along the normal.
    #[inline(always)]
    pub(crate) fn along<S: Elementwise<V = V>>(&self, s: S, [dx, dy, dz]: [V; 3]) -> V {
        let [nx, ny, nz] = self.normal;
        if self.upright { dz } else { s.fma(nx, dx, s.fma(ny, dy, s.mul(nz, dz))) }
    }
}

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
        use crate::kernels::propagate::source::{AnyForm, Everywhere, Plain};
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
