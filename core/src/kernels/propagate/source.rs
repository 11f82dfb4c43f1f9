//! Sources: the transducers in the layout that the kernels read, sixteen to a group, one list for each property.

use crate::kernels::lanes::{LANES, Lanes};
use crate::kernels::simd::Elementwise;
use crate::prelude::*;

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
