//! Elements of G, eq. (5), in f32: one source against every control point, or 16 sources at a point.

use crate::kernels::lanes::{BLOCK, Block};
use crate::kernels::lanes::{LANES, Lanes, groups, groups_mut};
use crate::kernels::phasor::{power_of_two, wave};
use crate::kernels::propagate::directivity::Table;
use crate::kernels::simd::Simd;
use crate::kernels::simd::instruction_set::{InstructionSet, dispatch};

/// A hundredth of a wavelength: nearer than that r is held there, so that no field is infinite.
pub(crate) const NEAREST: f32 = 0.01;

/// Points in wavelengths from the array's middle, each coordinate padded with anything finite.
#[derive(Clone, Copy)]
pub(crate) struct ControlPoints<'a> {
    /// x, y and z.
    pub(crate) coordinates: [&'a [f32]; 3],
    /// How many of them are points; the rest is padding.
    pub(crate) count: usize,
}

/// One transducer in the same frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
    /// |c_i| times P0 over the reference, per wavelength.
    pub(crate) amplitude: f32,
    /// The phase of c_i in turns.
    pub(crate) turns: f32,
}

/// What all transducers share: absorption as a power of two per wavelength (<= 0) and the directivity's table.
#[derive(Clone, Debug)]
pub(crate) struct Radiation {
    pub(crate) decay: f32,
    pub(crate) table: Option<Table>,
}

/// Where a row is written.
pub(crate) struct Row<'a> {
    pub(crate) re: &'a mut [f32],
    pub(crate) im: &'a mut [f32],
}

/// What a row is made of beyond distances: known before the loop over points, so that the loop has no branches.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    /// A point source without absorption, in phase.
    Plain,
    /// Anything else.
    Full,
}

impl Radiation {
    fn form(&self, turns: f32) -> Form {
        if self.decay == 0.0 && self.table.is_none() && turns == 0.0 { Form::Plain } else { Form::Full }
    }
}

/// A transducer in all lanes, or sixteen of them.
struct SourceLanes<V> {
    position: [V; 3],
    normal: [V; 3],
    amplitude: V,
    turns: V,
}

impl<V: Copy> SourceLanes<V> {
    #[inline(always)]
    fn one<S: Simd<V = V>>(s: S, source: &Source) -> Self {
        let [[x, y, z], [nx, ny, nz]] = [source.position, source.normal];
        Self {
            position: [s.splat(x), s.splat(y), s.splat(z)],
            normal: [s.splat(nx), s.splat(ny), s.splat(nz)],
            amplitude: s.splat(source.amplitude),
            turns: s.splat(source.turns),
        }
    }

    /// At least one and at most sixteen; the other lanes are silent where the last one is.
    #[inline(always)]
    fn sixteen<S: Simd<V = V>>(s: S, sources: &[Source]) -> Self {
        let mut lanes = [[0.0; LANES]; 8];
        for l in 0..LANES {
            let source = sources[l.min(sources.len() - 1)];
            let [[x, y, z], [nx, ny, nz]] = [source.position, source.normal];
            let amplitude = if l < sources.len() { source.amplitude } else { 0.0 };
            for (lanes, x) in lanes.iter_mut().zip([x, y, z, nx, ny, nz, amplitude, source.turns]) {
                lanes[l] = x;
            }
        }
        let [x, y, z, nx, ny, nz, amplitude, turns] = &lanes;
        Self {
            position: [s.load(x), s.load(y), s.load(z)],
            normal: [s.load(nx), s.load(ny), s.load(nz)],
            amplitude: s.load(amplitude),
            turns: s.load(turns),
        }
    }
}

/// Square distance and, held at [`NEAREST`], distance and |c| D e^{-alpha r}/r; distances in wavelengths.
#[inline(always)]
fn spread<S: Simd>(s: S, form: Form, radiation: &Radiation, from: &SourceLanes<S::V>, point: [S::V; 3]) -> [S::V; 3] {
    let [x, y, z] = from.position;
    let (dx, dy, dz) = (s.sub(point[0], x), s.sub(point[1], y), s.sub(point[2], z));
    let square = s.fma(dx, dx, s.fma(dy, dy, s.mul(dz, dz)));
    let held = s.max(square, s.splat(NEAREST * NEAREST));
    // The distance is the phase: an error in its last place is one of 2e-5 rad at a metre's tenth.
    let (distance, inverse) = s.sqrt_rsqrt(held);
    let mut amplitude = s.mul(from.amplitude, inverse);
    if form == Form::Full {
        if radiation.decay < 0.0 {
            amplitude = s.mul(amplitude, power_of_two(s, s.mul(distance, s.splat(radiation.decay))));
        }
        if let Some(table) = &radiation.table {
            let [nx, ny, nz] = from.normal;
            let along = s.fma(nx, dx, s.fma(ny, dy, s.mul(nz, dz)));
            amplitude = s.mul(amplitude, table.directivity(s, s.mul(along, inverse)));
        }
    }
    [square, distance, amplitude]
}

/// Element of G: one source, or sixteen, at a point.
#[inline(always)]
fn element<S: Simd>(s: S, form: Form, radiation: &Radiation, from: &SourceLanes<S::V>, point: [S::V; 3]) -> [S::V; 2] {
    let [_, mut distance, amplitude] = spread(s, form, radiation, from, point);
    if form == Form::Full {
        distance = s.add(distance, from.turns);
    }
    wave(s, distance, amplitude)
}

/// Writes sixteen `sources`, or fewer, against the points of `order`: row k of [`crate::kernels::tiles`] in the blocks from `first`
/// on, `stride` apart.
#[inline(always)]
pub(crate) fn write_tile<S: Simd>(
    s: S,
    radiation: &Radiation,
    sources: &[Source],
    control_points: ControlPoints<'_>,
    order: &[u32],
    (first, stride): (usize, usize),
    [re, im]: [&mut [Block]; 2],
) {
    let from = SourceLanes::sixteen(s, sources);
    let plain = sources.iter().all(|source| radiation.form(source.turns) == Form::Plain);
    for (k, &j) in order.iter().enumerate() {
        let [x, y, z] = control_points.coordinates;
        let place = [s.splat(x[j as usize]), s.splat(y[j as usize]), s.splat(z[j as usize])];
        let [real, imaginary] = if plain {
            element(s, Form::Plain, radiation, &from, place)
        } else {
            element(s, Form::Full, radiation, &from, place)
        };
        let block = first + k / BLOCK * stride;
        s.store(real, &mut re[block][k % BLOCK]);
        s.store(imaginary, &mut im[block][k % BLOCK]);
    }
}

/// Writes the row of `source` over its target's whole length, zeros in the padding.
#[inline(always)]
pub(crate) fn write_row<S: Simd>(
    s: S,
    radiation: &Radiation,
    source: &Source,
    control_points: ControlPoints<'_>,
    re: &mut [f32],
    im: &mut [f32],
) {
    match radiation.form(source.turns) {
        Form::Plain => write_form(s, Form::Plain, radiation, source, control_points, [&mut *re, &mut *im]),
        Form::Full => write_form(s, Form::Full, radiation, source, control_points, [&mut *re, &mut *im]),
    }
    silence(s, re, control_points.count);
    silence(s, im, control_points.count);
}

#[inline(always)]
fn write_form<S: Simd>(
    s: S,
    form: Form,
    radiation: &Radiation,
    source: &Source,
    control_points: ControlPoints<'_>,
    [re, im]: [&mut [f32]; 2],
) {
    let from = SourceLanes::one(s, source);
    let [x, y, z] = control_points.coordinates;
    let points = groups(x).iter().zip(groups(y)).zip(groups(z));
    for (((x, y), z), (re, im)) in points.zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
        let [real, imaginary] = element(s, form, radiation, &from, [s.load(x), s.load(y), s.load(z)]);
        s.store(real, re);
        s.store(imaginary, im);
    }
}

/// The row of one transducer, see [`write_row`].
pub(crate) fn row(
    set: InstructionSet,
    radiation: &Radiation,
    source: &Source,
    control_points: ControlPoints<'_>,
    out: &mut Row<'_>,
) {
    dispatch!(set, s => write_row(s, radiation, source, control_points, out.re, out.im));
}

/// Adds the moduli |G| of several transducers up, one sum a point, and tells whether one of them is nearer to a
/// point than the square root of `nearest` (square wavelengths).
pub(crate) fn add_moduli(
    set: InstructionSet,
    radiation: &Radiation,
    sources: &[Source],
    control_points: ControlPoints<'_>,
    nearest: f32,
    out: &mut [f32],
) -> bool {
    dispatch!(set, s => match radiation.form(0.0) {
        Form::Plain => moduli_of_form(s, Form::Plain, radiation, sources, control_points, nearest, out),
        Form::Full => moduli_of_form(s, Form::Full, radiation, sources, control_points, nearest, out),
    })
}

#[inline(always)]
fn moduli_of_form<S: Simd>(
    s: S,
    form: Form,
    radiation: &Radiation,
    sources: &[Source],
    control_points: ControlPoints<'_>,
    nearest: f32,
    out: &mut [f32],
) -> bool {
    let [x, y, z] = control_points.coordinates;
    let points = groups(x).iter().zip(groups(y)).zip(groups(z));
    let mut near = 0;
    for (((x, y), z), out) in points.zip(groups_mut(out)) {
        let mut closest = s.splat(f32::INFINITY);
        let mut sum = s.load(out);
        let place = [s.load(x), s.load(y), s.load(z)];
        for source in sources {
            let [square, _, amplitude] = spread(s, form, radiation, &SourceLanes::one(s, source), place);
            closest = s.min(square, closest);
            // A piston's side lobes have D < 0.
            sum = s.add(sum, if form == Form::Plain { amplitude } else { s.abs(amplitude) });
        }
        near |= s.less(closest, s.splat(nearest));
        s.store(sum, out);
    }
    silence(s, out, control_points.count);
    near != 0
}

/// Zeros in the padding.
#[inline(always)]
fn silence<S: Simd>(s: S, list: &mut [f32], count: usize) {
    const LANE: Lanes = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];
    if let Some(last) = groups_mut(list).last_mut()
        && !count.is_multiple_of(LANES)
    {
        let used = s.splat((count % LANES) as f32);
        s.store(s.select_less(s.load(&LANE), used, s.load(last), s.splat(0.0)), last);
    }
}
