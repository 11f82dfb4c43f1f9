//! Rows of G: one transducer against every point, eq. (5).

use super::level::{Level, dispatch};
use super::simd::Simd;
use super::table::Table;
use super::turns::{power_of_two, wave};
use super::{LANES, Lanes, groups, groups_mut};

/// A hundredth of a wavelength: nearer than that r is held there, so that no field is infinite.
pub(crate) const NEAREST: f32 = 0.01;

/// Points in wavelengths from the array's middle, each coordinate padded with anything finite.
#[derive(Clone, Copy)]
pub(crate) struct Spots<'a> {
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
    pub(crate) gain: f32,
    /// The phase of c_i in turns.
    pub(crate) turns: f32,
}

/// What all transducers share: absorption as a power of two per wavelength (<= 0) and the directivity's table.
#[derive(Clone, Debug)]
pub(crate) struct Law {
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

impl Law {
    fn form(&self, turns: f32) -> Form {
        if self.decay == 0.0 && self.table.is_none() && turns == 0.0 { Form::Plain } else { Form::Full }
    }
}

/// Square distance and, held at [`NEAREST`], distance and |c| D e^{-alpha r}/r; distances in wavelengths.
#[inline(always)]
fn spread<S: Simd>(s: S, form: Form, law: &Law, source: &Source, point: [&Lanes; 3]) -> [S::V; 3] {
    let [x, y, z] = source.position;
    let dx = s.sub(s.load(point[0]), s.splat(x));
    let dy = s.sub(s.load(point[1]), s.splat(y));
    let dz = s.sub(s.load(point[2]), s.splat(z));
    let square = s.fma(dx, dx, s.fma(dy, dy, s.mul(dz, dz)));
    let held = s.max(square, s.splat(NEAREST * NEAREST));
    // The distance is the phase: an error in its last place is one of 2e-5 rad at a metre's tenth.
    let (distance, inverse) = s.roots(held);
    let mut amplitude = s.mul(s.splat(source.gain), inverse);
    if form == Form::Full {
        if law.decay < 0.0 {
            amplitude = s.mul(amplitude, power_of_two(s, s.mul(distance, s.splat(law.decay))));
        }
        if let Some(table) = &law.table {
            let [nx, ny, nz] = source.normal;
            let along = s.fma(s.splat(nx), dx, s.fma(s.splat(ny), dy, s.mul(s.splat(nz), dz)));
            amplitude = s.mul(amplitude, table.directivity(s, s.mul(along, inverse)));
        }
    }
    [square, distance, amplitude]
}

/// Writes the row of `source` over its target's whole length, zeros in the padding.
#[inline(always)]
pub(crate) fn write_row<S: Simd>(
    s: S,
    law: &Law,
    source: &Source,
    spots: Spots<'_>,
    re: &mut [f32],
    im: &mut [f32],
) {
    match law.form(source.turns) {
        Form::Plain => write_form(s, Form::Plain, law, source, spots, [&mut *re, &mut *im]),
        Form::Full => write_form(s, Form::Full, law, source, spots, [&mut *re, &mut *im]),
    }
    silence(s, re, spots.count);
    silence(s, im, spots.count);
}

#[inline(always)]
fn write_form<S: Simd>(
    s: S,
    form: Form,
    law: &Law,
    source: &Source,
    spots: Spots<'_>,
    [re, im]: [&mut [f32]; 2],
) {
    let [x, y, z] = spots.coordinates;
    let points = groups(x).iter().zip(groups(y)).zip(groups(z));
    for (((x, y), z), (re, im)) in points.zip(groups_mut(re).iter_mut().zip(groups_mut(im))) {
        let [_, mut distance, amplitude] = spread(s, form, law, source, [x, y, z]);
        if form == Form::Full {
            distance = s.add(distance, s.splat(source.turns));
        }
        let [real, imaginary] = wave(s, distance, amplitude);
        s.store(real, re);
        s.store(imaginary, im);
    }
}

/// The row of one transducer, see [`write_row`].
pub(crate) fn row(level: Level, law: &Law, source: &Source, spots: Spots<'_>, out: &mut Row<'_>) {
    dispatch!(level, s => write_row(s, law, source, spots, out.re, out.im));
}

/// Adds the moduli |G| of several transducers up, one sum a point, and tells whether one of them is nearer to a
/// point than the square root of `nearest` (square wavelengths).
pub(crate) fn add_moduli(
    level: Level,
    law: &Law,
    sources: &[Source],
    spots: Spots<'_>,
    nearest: f32,
    out: &mut [f32],
) -> bool {
    dispatch!(level, s => match law.form(0.0) {
        Form::Plain => moduli_of_form(s, Form::Plain, law, sources, spots, nearest, out),
        Form::Full => moduli_of_form(s, Form::Full, law, sources, spots, nearest, out),
    })
}

#[inline(always)]
fn moduli_of_form<S: Simd>(
    s: S,
    form: Form,
    law: &Law,
    sources: &[Source],
    spots: Spots<'_>,
    nearest: f32,
    out: &mut [f32],
) -> bool {
    let [x, y, z] = spots.coordinates;
    let points = groups(x).iter().zip(groups(y)).zip(groups(z));
    let mut near = 0;
    for (((x, y), z), out) in points.zip(groups_mut(out)) {
        let mut closest = s.splat(f32::INFINITY);
        let mut sum = s.load(out);
        for source in sources {
            let [square, _, amplitude] = spread(s, form, law, source, [x, y, z]);
            closest = s.min(square, closest);
            // A piston's side lobes have D < 0.
            sum = s.add(sum, if form == Form::Plain { amplitude } else { s.abs(amplitude) });
        }
        near |= s.less(closest, s.splat(nearest));
        s.store(sum, out);
    }
    silence(s, out, spots.count);
    near != 0
}

/// Zeros in the padding.
#[inline(always)]
fn silence<S: Simd>(s: S, list: &mut [f32], count: usize) {
    const LANE: Lanes =
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];
    if let Some(last) = groups_mut(list).last_mut()
        && !count.is_multiple_of(LANES)
    {
        let used = s.splat((count % LANES) as f32);
        s.store(s.select_less(s.load(&LANE), used, s.load(last), s.splat(0.0)), last);
    }
}
