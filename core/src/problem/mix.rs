//! Mix: a level between two amplitudes of a board, made of both.
//!
//! ```text
//! c_ij = G_ij q_i / P_j             the part of a point's pressure that a transducer makes, of its component along P_j
//! e_j  = sum_i a_i c_ij - level     the error; at quiet points the pressure itself, relative to the loudest point's
//! ```
//! Amplitudes are drawn at random first, which leaves errors of about `step / (2 sqrt(N))`. One transducer after another then
//! takes the amplitude that leaves the smaller sum of e^2: the next ones take back the errors of those before (Floyd and
//! Steinberg, Proc. SID 17(2), 1976), until the errors are small enough. Later rounds choose anew. Time O(N M) a round.

use core::ops::Range;
use core::slice;

use num_complex::Complex32;

use crate::control::Control;
use crate::error::Error;
use crate::kernels::lanes::{LANES, Lanes, groups, groups_mut};
use crate::linalg::Planar;
use crate::math;
use crate::problem::Problem;
use crate::problem::array_request::ArrayRequest;
use crate::propagation::{Propagation, field_of};
use crate::rng::Rng;
use crate::workspace::{Buffer, Workspace};

/// Rounds of choices at most, and after how many choices the errors are looked at.
const ROUNDS: usize = 6;
const CHUNK: usize = 64;

/// The aim is lower than the level by this part, and the root mean square of errors about it that is small enough.
const NEAR: f32 = 5e-4;

/// A point may be louder than its target by this part, which is rounding.
const SLACK: f32 = 5e-5;

/// Moduli that differ by a smaller part are one amplitude.
const ALIKE: f64 = 1e-5;

/// Root mean square of what quiet points may leak more, relative to the loudest point.
const QUIET: f32 = 2e-3;

/// Whether all drives but silent ones have one amplitude.
pub(crate) fn is_of_one_amplitude(drive: &[Complex32], amplitude: f64) -> bool {
    drive.iter().all(|&q| q == Complex32::ZERO || (math::modulus(q) - amplitude).abs() < ALIKE * amplitude)
}

impl Problem {
    /// Brings full drives down to `level`, as [`mix`].
    pub(crate) fn mix(&self, drive: &mut [Complex32], level: f64, work: &Workspace, control: &mut Control) -> bool {
        mix(&self.targets, drive, (1.0, level), work, control)
    }
}

/// Brings drives of the amplitude `own` down to `level`, and no targeted point above it, where pressures are requested and one
/// amplitude of the board loses more of them. Returns whether the mix meets them; if not, or after a stop, the drives stay as
/// they are.
pub(crate) fn mix(
    request: &ArrayRequest,
    drive: &mut [Complex32],
    (own, level): (f64, f64),
    work: &Workspace,
    control: &mut Control,
) -> bool {
    let quantization = request.setup.quantization.as_deref().filter(|_| request.given);
    let Some(pair) = quantization.and_then(|board| board.between(level)) else { return false };
    // Half way between two amplitudes, rounding took either.
    for q in drive.iter_mut().filter(|q| !is_of_one_amplitude(slice::from_ref(q), own)) {
        *q *= (own / math::modulus(*q)) as f32;
    }
    let [level, below, above] = [level, pair[0], pair[1]].map(|amplitude| (amplitude / own) as f32);
    let propagation = &request.propagation;
    let Ok(field) = field_of(propagation, drive, work, control) else { return false };
    let mut points = Points::new(request, &field, work);
    points.read(&field, level, level);
    let (leak, lost) = (points.wrong()[1], level - below);
    let mut parts = work.floats.take(drive.len());
    let (mut rng, share) = (Rng::new(0), f64::from((level - below) / (above - below)));
    parts.fill_with(|| if rng.uniform() < share { above } else { below });
    let mut drawn = work.complexes.take(drive.len());
    drawn.iter_mut().zip(&*drive).zip(&*parts).for_each(|((drawn, q), part)| *drawn = q * part);
    let Ok(field) = field_of(propagation, &drawn, work, control) else { return false };
    let mut aim = level * (1.0 - NEAR);
    points.read(&field, 1.0, aim);
    let meets = |points: &Points, aim: f32, most: f32| {
        let [loud, quiet] = points.wrong();
        points.loudest() + aim <= (1.0 + SLACK) * level
            && loud <= most * most
            && quiet - leak <= QUIET * QUIET * level * level
    };
    let mut met = meets(&points, aim, NEAR * level);
    for visit in 0..ROUNDS * drive.len().div_ceil(CHUNK) {
        if met {
            break;
        }
        let chunk = visit % drive.len().div_ceil(CHUNK);
        if chunk == 0 && visit > 0 {
            let louder = (points.loudest() + aim - level).max(0.0);
            points.lower(louder);
            aim -= louder;
        }
        let range = chunk * CHUNK..drive.len().min((chunk + 1) * CHUNK);
        if points.choose_all(propagation, (range, drive), &mut parts, [below, above], work, control).is_err() {
            return false;
        }
        met = meets(&points, aim, NEAR * level);
    }
    points.lower(aim - level);
    let met = met || meets(&points, level, lost / 2.0);
    if met {
        drive.iter_mut().zip(&*parts).for_each(|(q, part)| *q *= *part);
    }
    met
}

/// The errors e of the points, and how waves become parts c of pressures.
struct Points<'w> {
    /// Of re, of im: 0 at a point with a target, where no component across counts.
    error: Planar<'w>,
    /// 1 / P; 0 where there is no point.
    inverse: Planar<'w>,
    /// 1 at points with a target, else 0; and 1 at quiet ones.
    loud: Buffer<'w, f32>,
    quiet: Buffer<'w, f32>,
}

impl<'w> Points<'w> {
    /// The points of the `field` of full drives.
    fn new(request: &ArrayRequest, field: &Planar, work: &'w Workspace) -> Self {
        let lanes = request.propagation.lanes();
        let [error, inverse] = [(); 2].map(|()| Planar::zeros(1, lanes, work));
        let [loud, quiet] = [(); 2].map(|()| work.floats.take(lanes));
        let mut points = Self { error, inverse, loud, quiet };
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

    /// The errors of a `field` times `part`, where points with a target are to have `level`.
    fn read(&mut self, field: &Planar, part: f32, level: f32) {
        for j in 0..field.re.len() {
            let [re, im] = [part * field.re[j], part * field.im[j]];
            self.error.re[j] = re * self.inverse.re[j] - im * self.inverse.im[j] - level * self.loud[j];
            self.error.im[j] = (re * self.inverse.im[j] + im * self.inverse.re[j]) * self.quiet[j];
        }
    }

    /// Waves become parts of the points' pressures: c, of a transducer of drive q.
    fn along(&self, q: Complex32, re: &mut [f32], im: &mut [f32]) {
        let lists = self.inverse.re.iter().zip(&*self.inverse.im).zip(&*self.quiet);
        for ((re, im), ((&unit_re, &unit_im), quiet)) in re.iter_mut().zip(im).zip(lists) {
            let wave = [q.re * *re - q.im * *im, q.re * *im + q.im * *re];
            *re = wave[0] * unit_re - wave[1] * unit_im;
            *im = (wave[0] * unit_im + wave[1] * unit_re) * quiet;
        }
    }

    /// Chooses the parts of a range of drives, one after another.
    fn choose_all(
        &mut self,
        propagation: &Propagation,
        (range, drive): (Range<usize>, &[Complex32]),
        parts: &mut [f32],
        pair: [f32; 2],
        work: &Workspace,
        control: &mut Control,
    ) -> Result<(), Error> {
        let [mut re, mut im] = [(); 2].map(|()| work.floats.take(propagation.lanes()));
        for i in range.filter(|&i| drive[i] != Complex32::ZERO) {
            control.pulse()?;
            propagation.row(i, &mut re, &mut im);
            self.along(drive[i], &mut re, &mut im);
            parts[i] = self.choose([&re, &im], parts[i], pair);
        }
        Ok(())
    }

    /// The one of two parts that leaves the smaller error, in place of that before, counted in.
    fn choose(&mut self, wave: [&[f32]; 2], before: f32, [below, above]: [f32; 2]) -> f32 {
        let (mut with, mut square) = ([0.0; LANES], [0.0; LANES]);
        for (error, wave) in [(&self.error.re, wave[0]), (&self.error.im, wave[1])] {
            for (error, wave) in groups(error).iter().zip(groups(wave)) {
                for k in 0..LANES {
                    with[k] += error[k] * wave[k];
                    square[k] += wave[k] * wave[k];
                }
            }
        }
        let [with, square] = [with, square].map(|sums: Lanes| sums.iter().sum::<f32>());
        let cost = 2.0 * (with - before * square) + (below + above) * square;
        let chosen = if cost < 0.0 { above } else { below };
        for (error, wave) in [(&mut self.error.re, wave[0]), (&mut self.error.im, wave[1])] {
            for (error, wave) in groups_mut(error).iter_mut().zip(groups(wave)) {
                for k in 0..LANES {
                    error[k] += (chosen - before) * wave[k];
                }
            }
        }
        chosen
    }

    /// Lowers the level that points with a target are to have.
    fn lower(&mut self, by: f32) {
        self.error.re.iter_mut().zip(&*self.loud).for_each(|(error, loud)| *error += by * loud);
    }

    /// The largest error of a point with a target.
    fn loudest(&self) -> f32 {
        let errors = self.error.re.iter().zip(&*self.loud).filter(|(_, loud)| **loud > 0.0);
        errors.fold(f32::NEG_INFINITY, |most, (error, _)| most.max(*error))
    }

    /// Mean squares of the errors of the points with a target, and of the quiet ones.
    fn wrong(&self) -> [f32; 2] {
        [&self.loud, &self.quiet].map(|kind| {
            let errors = self.error.re.iter().zip(&*self.error.im).zip(&**kind);
            let sum: f32 = errors.map(|((re, im), kind)| kind * (re * re + im * im)).sum();
            sum / kind.iter().sum::<f32>().max(1.0)
        })
    }
}
