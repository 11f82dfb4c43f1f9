//! Mix: a level between two amplitudes of a board, made of both.
//!
//! ```text
//! c_ij = G_ij q_i / P_j             the part of a point's pressure that a transducer makes, of its component along P_j
//! e_j  = sum_i a_i c_ij - level     the error; at quiet points the pressure itself, relative to the loudest point's
//! ```
//! One transducer after another takes the amplitude that leaves the smaller sum of e^2: the next ones take back the errors of
//! those before (Floyd and Steinberg, Proc. SID 17(2), 1976). Later rounds choose anew. Time O(N M) a round.

use core::slice;

use num_complex::Complex32;

use crate::control::Control;
use crate::kernels::lanes::{LANES, Lanes, groups, groups_mut};
use crate::linalg::Planar;
use crate::math;
use crate::problem::Problem;
use crate::problem::array_request::ArrayRequest;
use crate::propagation::field_of;
use crate::workspace::{Buffer, Workspace};

/// Rounds of choices at most.
const ROUNDS: usize = 6;

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
    let mut points = Points::new(request, &field, level, work);
    let leak = points.wrong()[1];
    let [mut re, mut im] = [(); 2].map(|()| work.floats.take(propagation.lanes()));
    let mut parts = work.floats.take(drive.len());
    parts.fill(level);
    let mut aim = level;
    for round in 0..ROUNDS {
        for ((i, q), part) in drive.iter().enumerate().zip(&mut *parts) {
            if *q != Complex32::ZERO {
                if control.pulse().is_err() {
                    return false;
                }
                propagation.row(i, &mut re, &mut im);
                points.along(*q, &mut re, &mut im);
                *part = points.choose([&re, &im], *part, [below, above]);
            }
        }
        let louder = points.loudest() + aim - level;
        if round > 0 && louder <= SLACK * level {
            break;
        }
        points.lower(louder.max(0.0));
        aim -= louder.max(0.0);
    }
    points.lower(aim - level);
    let ([loud, quiet], lost) = (points.wrong(), level - below);
    let met =
        points.loudest() <= SLACK * level && loud <= lost * lost / 4.0 && quiet - leak <= QUIET * QUIET * level * level;
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
    /// The points of a `field` that every drive brings to the part `level` of it.
    fn new(request: &ArrayRequest, field: &Planar, level: f32, work: &'w Workspace) -> Self {
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
                let part = level * points.inverse.re[j];
                (points.error.re[j], points.error.im[j]) = (field.re[j] * part, field.im[j] * part);
            }
        }
        points
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
