//! Sums of |G| over the transducers: the lanes contain sixteen transducers, or points of up to 16 problems.
//!
//! ```text
//! for each run of 32 source groups, each point:
//!     lane l = |G| of source l of the first group, + of the second, and so on         # f32
//!     sum    = the lanes in the tree of Simd::reduce_add                              # added up in f64
//! an interleaved batch, or many points: the same sums, one lane after another, the tree's deepest terms first
//! ```
//!
//! With sixteen transducers in the lanes few lanes are padding, however few points there are: at M = 4 points the sums
//! take a quarter of the time that they take with the points in the lanes. Points that fill lane groups are put into
//! the lanes where the amplitudes of all elements are stored for the rows that follow.

use crate::kernels::prelude::*;
use crate::kernels::propagate::row::{ControlPoints, spread};
use crate::kernels::propagate::source::{Form, Radiation, SourceGroup, SourceLanes, SourceList, formed};

/// Number of source groups whose moduli are summed in f32 before the sum continues in f64; they stay in the nearest
/// cache meanwhile.
const RUN: usize = 32;

/// Number of points between two checks for a stop: some 100 us.
const POINTS_A_PULSE: usize = 1 << 10;

/// A run: consecutive groups of the sources.
pub(crate) struct Run<'a> {
    radiation: &'a Radiation,
    groups: &'a [SourceGroup],
    /// The indices of the transducers in these groups.
    pub(crate) members: Range<usize>,
}

impl<'a> Run<'a> {
    /// Divides all sources into runs of [`RUN`] groups.
    pub(crate) fn all(radiation: &'a Radiation, sources: &'a SourceList) -> impl Iterator<Item = Self> {
        let starts = (0..sources.len()).step_by(RUN * LANES);
        sources.groups.chunks(RUN).zip(starts).map(move |(groups, start)| {
            let members = start..sources.len().min(start + RUN * LANES);
            Self { radiation, groups, members }
        })
    }

    /// Returns the least square distance so far, `sum` + |G|, and the amplitude, which is |G| except for the sign.
    #[inline(always)]
    fn add<S: Elementwise, F: Form>(
        &self,
        s: S,
        form: F,
        from: &SourceLanes<S::V>,
        point: [S::V; 3],
        [closest, sum, _]: [S::V; 3],
    ) -> [S::V; 3] {
        let [square, _, amplitude] = spread(s, form, self.radiation, from, point);
        // D < 0 in the side lobes of a piston.
        let modulus = if F::PLAIN { amplitude } else { s.abs(amplitude) };
        [s.min(square, closest), s.add(sum, modulus), amplitude]
    }
}

/// Adds |G| of the transducers of a run, to one sum for each point. Returns whether a transducer of the run is nearer
/// to a point than the square root of `nearest` (in square wavelengths).
///
/// # Errors
/// A requested stop, which is checked once every few points.
pub(crate) fn add_moduli(
    set: InstructionSet,
    run: &Run<'_>,
    points: ControlPoints<'_>,
    nearest: f32,
    out: &mut [f64],
    control: &mut Control,
) -> Result<bool> {
    // Phases do not change |G|.
    dispatch!(set, s => formed!(s, run.radiation, true, form => add_form(s, form, run, points, nearest, out, control)))
}

#[inline(always)]
fn add_form<S: Simd>(
    s: S,
    form: impl Form,
    run: &Run<'_>,
    points: ControlPoints<'_>,
    nearest: f32,
    out: &mut [f64],
    control: &mut Control,
) -> Result<bool> {
    let [x, y, z] = points.coordinates;
    let mut near = 0;
    for (j, (((&x, &y), &z), out)) in x.iter().zip(y).zip(z).zip(out).enumerate() {
        if j.is_multiple_of(POINTS_A_PULSE) {
            control.pulse()?;
        }
        let mut sums = Sums { form, run, point: [x, y, z], closest: [0.0; LANES], moduli: [0.0; LANES] };
        s.apart(LANES, &mut sums);
        near |= s.less(s.load(&sums.closest), s.splat(nearest));
        *out += f64::from(s.reduce_add(s.load(&sums.moduli)));
    }
    Ok(near != 0)
}

/// Kernel of the sums of |G| at a point and of the least square distance, as partial results in the lanes.
struct Sums<'a, F> {
    form: F,
    run: &'a Run<'a>,
    point: [f32; 3],
    closest: Lanes,
    moduli: Lanes,
}

impl<F: Form> Apart for Sums<'_, F> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let [x, y, z] = self.point;
        let place = [s.splat(x), s.splat(y), s.splat(z)];
        let mut state = [s.splat(f32::INFINITY), s.splat(0.0), s.splat(0.0)];
        for group in self.run.groups {
            state = self.run.add(s, self.form, &group.all(s), place, state);
        }
        s.store(state[0], &mut self.closest);
        s.store(state[1], &mut self.moduli);
    }
}

/// Does the same as [`add_moduli`] with the bits of it, for points in the lanes: those of one problem, or of up to 16 problems
/// with one in each lane. It writes the sums to `out`, and the amplitudes of the run's rows, row after row, to `lines` if there
/// are any.
pub(crate) fn interleaved_moduli(
    set: InstructionSet,
    run: &Run<'_>,
    points: ControlPoints<'_>,
    nearest: f32,
    out: &mut [f32],
    lines: &mut [Line],
) -> bool {
    dispatch!(set, s => formed!(s, run.radiation, true, form => {
        if lines.is_empty() {
            in_lanes::<_, _, false>(s, form, run, points, nearest, out, lines)
        } else {
            in_lanes::<_, _, true>(s, form, run, points, nearest, out, lines)
        }
    }))
}

#[inline(always)]
fn in_lanes<S: Simd, F: Form, const KEEP: bool>(
    s: S,
    form: F,
    run: &Run<'_>,
    points: ControlPoints<'_>,
    nearest: f32,
    out: &mut [f32],
    lines: &mut [Line],
) -> bool {
    let [x, y, z] = points.coordinates.map(groups);
    let wide = x.len();
    let mut closest = s.splat(f32::INFINITY);
    for (g, (((x, y), z), out)) in x.iter().zip(y).zip(z).zip(groups_mut(out)).enumerate() {
        let place = [s.load(x), s.load(y), s.load(z)];
        // Sums over 1, 2, 4 and 8 lanes, stored until the sum over as many other lanes is ready.
        let mut waiting = [s.splat(0.0); 5];
        for k in 0..LANES {
            // The lanes are taken in the order of their reversed bits: 0, 8, 4, 12 and so on.
            let lane = k.reverse_bits() >> (usize::BITS - LANES.ilog2());
            let mut state = [closest, s.splat(0.0), s.splat(0.0)];
            for (n, group) in run.groups.iter().enumerate() {
                state = run.add(s, form, &group.one(s, lane), place, state);
                if KEEP && let Some(line) = lines.get_mut((n * LANES + lane) * wide + g) {
                    s.store(state[2], &mut line.0);
                }
            }
            let mut sum = state[1];
            closest = state[0];
            let met = k.trailing_ones() as usize;
            for other in &waiting[..met] {
                sum = s.add(*other, sum);
            }
            waiting[met] = sum;
        }
        s.store(waiting[4], out);
    }
    s.less(closest, s.splat(nearest)) != 0
}
