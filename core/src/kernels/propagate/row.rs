//! Elements of G, eq. (5), in f32: one source and all control points, or 16 sources and one point.

use crate::kernels::lanes::Block;
use crate::kernels::phasor::{power_of_two, wave};
use crate::kernels::prelude::*;
use crate::kernels::propagate::source::{Form, Plain, Radiation, SourceLanes, SourceList, formed};

/// Least distance in wavelengths: shorter distances count as this one, so that no field is infinite.
pub(crate) const NEAREST: f32 = 0.01;

/// Points in wavelengths from the array's middle. The padding of each coordinate has any finite values.
#[derive(Clone, Copy)]
pub(crate) struct ControlPoints<'a> {
    pub(crate) coordinates: [&'a [f32]; 3],
    /// The number of points; the rest is padding.
    pub(crate) count: usize,
}

/// Real and imaginary parts of a row of G, to be written.
pub(crate) struct Row<'a> {
    pub(crate) re: &'a mut [f32],
    pub(crate) im: &'a mut [f32],
}

/// Returns the square distance, the distance (at least [`NEAREST`]) and the amplitude |c| D e^{-alpha r}/r of eq. (5);
/// distances are in wavelengths.
#[inline(always)]
pub(crate) fn spread<S: Elementwise, F: Form>(
    s: S,
    form: F,
    radiation: &Radiation,
    from: &SourceLanes<S::V>,
    point: [S::V; 3],
) -> [S::V; 3] {
    let (ray, square) = away(s, from, point);
    let (distance, inverse) = length(s, square);
    let mut amplitude = s.mul(from.amplitude, inverse);
    if !F::PLAIN
        && let Some(decay) = radiation.decay
    {
        amplitude = s.mul(amplitude, power_of_two(s, s.mul(distance, s.splat(decay))));
    }
    let directed = form.direct(
        s,
        amplitude,
        #[inline(always)]
        || from.along(s, ray),
        inverse,
    );
    [square, distance, directed]
}

/// Returns the element of the propagation matrix G for one source, or sixteen, and a point.
#[inline(always)]
pub(crate) fn element<S: Elementwise, F: Form>(
    s: S,
    form: F,
    radiation: &Radiation,
    from: &SourceLanes<S::V>,
    point: [S::V; 3],
) -> [S::V; 2] {
    let [_, distance, amplitude] = spread(s, form, radiation, from, point);
    wave(s, if F::PLAIN || from.in_phase { distance } else { s.add(distance, from.turns) }, amplitude)
}

/// Returns the vector from a source to a point, and the square of the distance.
#[inline(always)]
fn away<S: Elementwise>(s: S, from: &SourceLanes<S::V>, point: [S::V; 3]) -> ([S::V; 3], S::V) {
    let [x, y, z] = from.position;
    let [dx, dy, dz] = [s.sub(point[0], x), s.sub(point[1], y), s.sub(point[2], z)];
    ([dx, dy, dz], s.fma(dx, dx, s.fma(dy, dy, s.mul(dz, dz))))
}

/// Returns the distance, at least [`NEAREST`], and its inverse.
#[inline(always)]
fn length<S: Elementwise>(s: S, square: S::V) -> (S::V, S::V) {
    // The distance gives the phase: an error in its last bit is 2e-5 rad at .1 m.
    s.sqrt_rsqrt(s.max(square, s.splat(NEAREST * NEAREST)))
}

/// Returns the element of G whose amplitude is known, with the same bits as [`element`].
#[inline(always)]
pub(crate) fn known<S: Elementwise>(s: S, from: &SourceLanes<S::V>, point: [S::V; 3], amplitude: S::V) -> [S::V; 2] {
    let (distance, _) = length(s, away(s, from, point).1);
    wave(s, if from.in_phase { distance } else { s.add(distance, from.turns) }, amplitude)
}

/// Writes the elements of G for a group of sources at the points of `order`, as a tile of [`crate::kernels::tiles`].
/// Row k of the tile is point `order[k]`. Its blocks begin at `first` and are `stride` apart.
#[inline(always)]
pub(crate) fn write_tile<S: Simd>(
    s: S,
    radiation: &Radiation,
    (sources, group): (&SourceList, usize),
    control_points: ControlPoints<'_>,
    order: &[u32],
    (first, stride): (usize, usize),
    [re, im]: [&mut [Block]; 2],
) {
    formed!(s, radiation, sources.in_phase, form => {
        let out = [&mut *re, &mut *im];
        s.apart(LANES, &mut Tile { form, radiation, sources, group, control_points, order, first, stride, out });
    });
}

/// Kernel of [`write_tile`].
struct Tile<'a, F> {
    form: F,
    radiation: &'a Radiation,
    sources: &'a SourceList,
    group: usize,
    control_points: ControlPoints<'a>,
    order: &'a [u32],
    first: usize,
    stride: usize,
    out: [&'a mut [Block]; 2],
}

impl<F: Form> Apart for Tile<'_, F> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let from = self.sources.groups[self.group].all(s);
        let [x, y, z] = self.control_points.coordinates;
        let [re, im] = &mut self.out;
        for (k, &j) in self.order.iter().enumerate() {
            let place = [s.splat(x[j as usize]), s.splat(y[j as usize]), s.splat(z[j as usize])];
            let [real, imaginary] = element(s, self.form, self.radiation, &from, place);
            let block = self.first + k / BLOCK * self.stride;
            s.store(real, &mut re[block][k % BLOCK]);
            s.store(imaginary, &mut im[block][k % BLOCK]);
        }
    }
}

/// Writes the row of source `i` to the whole of `re` and `im`, with zeros in the padding.
#[inline(always)]
pub(crate) fn write_row<S: Simd>(
    s: S,
    radiation: &Radiation,
    sources: &SourceList,
    i: usize,
    control_points: ControlPoints<'_>,
    re: &mut [f32],
    im: &mut [f32],
) {
    // All forms but the plain one are separate functions, because this function is compiled into every kernel that
    // writes rows.
    let (used, out) = (control_points.count, [&mut *re, &mut *im]);
    if radiation.is_plain(sources.in_phase) {
        s.apart(used, &mut Written { form: Plain, radiation, sources, i, control_points, out });
    } else {
        s.vectorize(
            #[inline(always)]
            || {
                formed!(s, radiation, sources.in_phase, form => {
                    s.apart(used, &mut Written { form, radiation, sources, i, control_points, out });
                });
            },
        );
    }
    silence(s, re, control_points.count);
    silence(s, im, control_points.count);
}

/// Kernel of [`write_row`].
struct Written<'a, F> {
    form: F,
    radiation: &'a Radiation,
    sources: &'a SourceList,
    i: usize,
    control_points: ControlPoints<'a>,
    out: [&'a mut [f32]; 2],
}

impl<F: Form> Apart for Written<'_, F> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let from = &self.sources.one(s, self.i);
        let [x, y, z] = self.control_points.coordinates;
        let [re, im] = &mut self.out;
        let points = groups(x).iter().zip(groups(y)).zip(groups(z));
        for (((x, y), z), (re, im)) in points.zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
            let [real, imaginary] = element(s, self.form, self.radiation, from, [s.load(x), s.load(y), s.load(z)]);
            s.store(real, re);
            s.store(imaginary, im);
        }
    }
}

/// Does the same as [`write_row`] where the row's amplitudes are known.
#[inline(always)]
pub(crate) fn write_known_row<S: Simd>(
    s: S,
    sources: &SourceList,
    i: usize,
    control_points: ControlPoints<'_>,
    amplitudes: &[Line],
    re: &mut [f32],
    im: &mut [f32],
) {
    let out = [&mut *re, &mut *im];
    s.apart(control_points.count, &mut Known { sources, i, control_points, amplitudes, out });
    silence(s, re, control_points.count);
    silence(s, im, control_points.count);
}

/// Kernel of [`write_known_row`].
struct Known<'a> {
    sources: &'a SourceList,
    i: usize,
    control_points: ControlPoints<'a>,
    amplitudes: &'a [Line],
    out: [&'a mut [f32]; 2],
}

impl Apart for Known<'_> {
    #[inline(always)]
    fn run<S: Elementwise>(&mut self, s: S) {
        let from = &self.sources.one(s, self.i);
        let [x, y, z] = self.control_points.coordinates.map(groups);
        let [re, im] = &mut self.out;
        let points = x.iter().zip(y).zip(z).zip(self.amplitudes);
        for ((((x, y), z), amplitude), (re, im)) in points.zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
            let [real, imaginary] = known(s, from, [s.load(x), s.load(y), s.load(z)], s.load(&amplitude.0));
            s.store(real, re);
            s.store(imaginary, im);
        }
    }
}

/// Writes the row of one transducer, see [`write_row`].
pub(crate) fn row(
    set: InstructionSet,
    radiation: &Radiation,
    sources: &SourceList,
    i: usize,
    control_points: ControlPoints<'_>,
    out: &mut Row<'_>,
) {
    dispatch!(set, s => write_row(s, radiation, sources, i, control_points, out.re, out.im));
}

/// Writes zeros to the padding after `count` numbers.
#[inline(always)]
pub(crate) fn silence<S: Elementwise>(s: S, list: &mut [f32], count: usize) {
    const LANE: Lanes = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];
    if let Some(last) = groups_mut(list).last_mut()
        && !count.is_multiple_of(LANES)
    {
        if s.is_short() {
            last[count % LANES..].fill(0.0);
            return;
        }
        let used = s.splat((count % LANES) as f32);
        s.store(s.select_less(s.load(&LANE), used, s.load(last), s.splat(0.0)), last);
    }
}
