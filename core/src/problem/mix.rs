//! Mix: a level between two amplitudes of a board, made by driving some transducers at the lower and some at the higher one.
//!
//! With the drives q_i, the field P_j = sum_i G_ji q_i and the amplitude a_i of each transducer:
//!
//! ```text
//! c_ij = G_ji q_i / P_j             what transducer i adds at point j, along P_j and relative to it
//! e_j  = sum_i a_i c_ij - level     the error; at quiet points the pressure there, relative to that of the loudest point
//! ```
//!
//! If there are many transducers for each point, the amplitudes are drawn at random. This leaves errors of about
//! `step / (2 sqrt(N))`: small enough, or nearly so. Otherwise the transducers choose one after another the amplitude with the
//! smaller sum of e^2, so later ones correct the errors of earlier ones ([`dither`]). More rounds follow until the errors are
//! small enough. Time O(N M) for each round.

use crate::kernels::dither;
use crate::linalg::Planar;
use crate::prelude::*;
use crate::problem::array_request::ArrayRequest;
use crate::propagation::field_of;
use crate::workspace::{Buffer, Workspace};

/// The most rounds of choices.
const ROUNDS: usize = 6;
/// In later rounds, the errors are checked after this many choices.
const CHUNK: usize = 64;

/// A mix aims at moduli that are lower than the level by this part. Errors are small enough if their root mean square is at
/// most this part of the level.
const NEAR: f32 = 5e-4;

/// A low estimate of the errors that remain after the choices, in units of (step between the amplitudes) times
/// (points per transducer). For 64 points and 996 transducers it is 0.01 of a step; the errors are 0.012 to 0.02 of a
/// step.
const LEFT: f32 = 0.15;

/// With at least this many transducers for each point, amplitudes are drawn at random first.
const RANDOM: usize = 32;

/// A point may exceed its target by this part because of rounding.
const SLACK: f32 = 5e-5;

/// Moduli that differ by less than this part count as one amplitude.
pub(crate) const ALIKE: f32 = 1e-5;

/// The root mean square of the additional pressure that a mix may cause at quiet points, relative to the loudest point.
const QUIET: f32 = 2e-3;

/// Lowers drives of this `amplitude` to `level` by a mix of two amplitudes, so that no point exceeds its target. Does so
/// only if pressures were requested and if a single amplitude of the board would be less accurate. `field` is the field of the
/// drives, computed here if it is `None`. Returns the field of the mix; `None` if no mix is good enough or after a stop, and
/// the drives then keep their one amplitude.
pub(crate) fn mix<'w>(
    request: &ArrayRequest,
    drive: &mut [Complex32],
    amplitude: f64,
    level: f64,
    field: Option<Planar<'w>>,
    work: &'w Workspace,
    control: &mut Control,
) -> Option<Planar<'w>> {
    let quantization = request.setup.quantization.as_deref().filter(|_| request.given);
    let pair = quantization?.between(level)?;
    // The caller's rounding may have moved some drives to another amplitude of the board; they get the `amplitude` again.
    let square = (amplitude * amplitude) as f32;
    for q in drive.iter_mut().filter(|q| (q.norm_sqr() - square).abs() > 2.0 * ALIKE * square && **q != Complex32::ZERO)
    {
        *q *= (amplitude / math::modulus(*q)) as f32;
    }
    let [level, below, above] = [level, pair[0], pair[1]].map(|each| (each / amplitude) as f32);
    let propagation = &request.propagation;
    let full = match field {
        Some(field) => field,
        None => field_of(propagation, drive, work, control).ok()?,
    };
    let mut points = Points::new(request, &full, work);
    points.read(&full, level, level);
    let (leak, lost) = (points.wrong()[1], level - below);
    let meets = |points: &Points, aim: f32, most: f32| {
        let [loud, quiet] = points.wrong();
        points.loudest() + aim <= (1.0 + SLACK) * level
            && loud <= most * most
            && quiet - leak <= QUIET * QUIET * level * level
    };
    let (count, chunks) = (request.active.len(), drive.len().div_ceil(CHUNK));
    // The errors that the choices will leave, for this number of points and transducers.
    let left = LEFT * (above - below) * count as f32 / drive.len() as f32;
    let near = (NEAR * level).max(1.5 * left);
    let mut aim = level * (1.0 - NEAR) - 2.0 * left;
    let mut parts = work.floats.take(drive.len());
    // With few points, random amplitudes are accurate enough or nearly so. With more points, random amplitudes are never
    // accurate enough: the choices of the transducers begin at once.
    let random = drive.len() >= RANDOM * count;
    let mut met = false;
    if random {
        let (mut rng, share) = (Rng::new(0), f64::from((aim - below) / (above - below)));
        parts.fill_with(|| if rng.uniform() < share { above } else { below });
        let mut mixed = work.complexes.take(drive.len());
        mixed.iter_mut().zip(&*drive).zip(&*parts).for_each(|((mixed, q), part)| *mixed = q * part);
        let field = field_of(propagation, &mixed, work, control).ok()?;
        points.read(&field, 1.0, aim);
        if meets(&points, aim, near) {
            drive.copy_from_slice(&mixed);
            return Some(field);
        }
    } else {
        parts.fill(aim);
        points.read(&full, aim, aim);
    }
    for visit in 0..ROUNDS * chunks {
        let chunk = visit % chunks;
        if chunk == 0 && visit > 0 {
            let louder = (points.loudest() + aim - level).max(0.0);
            points.lower(louder);
            aim -= louder;
        }
        let range = chunk * CHUNK..drive.len().min((chunk + 1) * CHUNK);
        let (set, rows) = (propagation.instruction_set(), propagation.rows());
        dither::choose(set, rows, (range, drive), points.planes(), &mut parts, [below, above], control).ok()?;
        met = (random || visit + 1 >= chunks) && meets(&points, aim, near);
        if met {
            break;
        }
    }
    points.lower(aim - level);
    if !met && !meets(&points, level, lost / 2.0) {
        return None;
    }
    drive.iter_mut().zip(&*parts).for_each(|(q, part)| *q *= *part);
    field_of(propagation, drive, work, control).ok()
}

/// The errors e of the points, see the module's head.
struct Points<'w> {
    /// Real and imaginary part. The imaginary part is 0 at a point with a target, where only the component along P counts.
    error: Planar<'w>,
    /// 1 / P at each point, 0 in the padding.
    inverse: Planar<'w>,
    /// 1 at points with a target, else 0.
    loud: Buffer<'w, f32>,
    /// 1 at quiet points, else 0.
    quiet: Buffer<'w, f32>,
    /// Scratch memory for a row of the propagation matrix G.
    row: Planar<'w>,
}

impl<'w> Points<'w> {
    /// Prepares the points of the `field` that the drives give at full amplitude.
    fn new(request: &ArrayRequest, field: &Planar, work: &'w Workspace) -> Self {
        let lanes = request.propagation.lanes();
        let [error, inverse, row] = [(); 3].map(|()| Planar::zeros(1, lanes, work));
        let [loud, quiet] = [(); 2].map(|()| work.floats.take(lanes));
        let mut points = Self { error, inverse, loud, quiet, row };
        let square = |j: usize| field.re[j] * field.re[j] + field.im[j] * field.im[j];
        let targeted = |j: usize| request.pascals[j] > 0.0;
        let loudest = request.active.iter().filter(|&&j| targeted(j)).fold(0.0, |most: f32, &j| most.max(square(j)));
        for &j in &request.active {
            if targeted(j) {
                points.loud[j] = 1.0;
                (points.inverse.re[j], points.inverse.im[j]) = (field.re[j] / square(j), -field.im[j] / square(j));
            } else {
                points.quiet[j] = 1.0;
                points.inverse.re[j] = 1.0 / math::sqrtf(loudest);
            }
        }
        points
    }

    /// Sets the errors to those of `field` times `part`, for points with a target that should have `level`.
    fn read(&mut self, field: &Planar, part: f32, level: f32) {
        for j in 0..field.re.len() {
            let [re, im] = [part * field.re[j], part * field.im[j]];
            self.error.re[j] = re * self.inverse.re[j] - im * self.inverse.im[j] - level * self.loud[j];
            self.error.im[j] = (re * self.inverse.im[j] + im * self.inverse.re[j]) * self.quiet[j];
        }
    }

    /// The arguments of [`dither`], which changes the errors.
    fn planes(&mut self) -> dither::Points<'_> {
        let Self { error, inverse, quiet, row, .. } = self;
        dither::Points {
            error: [&mut error.re, &mut error.im],
            inverse: [&inverse.re, &inverse.im],
            quiet,
            row: [&mut row.re, &mut row.im],
        }
    }

    /// Lowers the level that points with a target should have.
    fn lower(&mut self, by: f32) {
        self.error.re.iter_mut().zip(&*self.loud).for_each(|(error, loud)| *error += by * loud);
    }

    /// The largest error of a point with a target; a positive error is too loud.
    fn loudest(&self) -> f32 {
        let errors = self.error.re.iter().zip(&*self.loud).filter(|(_, loud)| **loud > 0.0);
        errors.fold(f32::NEG_INFINITY, |most, (error, _)| most.max(*error))
    }

    /// The mean square error of the points with a target, and that of the quiet points.
    fn wrong(&self) -> [f32; 2] {
        [&self.loud, &self.quiet].map(|kind| {
            let errors = self.error.re.iter().zip(&*self.error.im).zip(&**kind);
            let sum: f32 = errors.map(|((re, im), kind)| kind * (re * re + im * im)).sum();
            sum / kind.iter().sum::<f32>().max(1.0)
        })
    }
}
