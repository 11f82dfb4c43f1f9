//! Rounds traps to a board's phases so that beads still rest at their points.
//!
//! Drives rounded one by one move beads by a part of a millimetre if phases are few. A change dq_i of a drive moves the
//! resting places s (3 M,) by
//!
//! ```text
//! ds = sum_i Re(dq_i h_i),   h_i = sum_k (ds/dRe c_k - j ds/dIm c_k) C_ki
//! ```
//!
//! where c = C q are the derivatives of the field at the points. Each stiffness K changes in the same way, and so does
//! the error v of each focus with its cost E ([`crate::solvers::even_field::traps::foci`]). Each drive in turn takes one of
//! the three phases around its own: the one with the least |s|^2 + E less the soft minimum of K. A pass begins with the
//! present places, stiffnesses and errors.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::device::quantization::Quantization;
use crate::kernels::{InstructionSet, padded};
use crate::prelude::*;
use crate::propagation::forces::stiffness::Stiffness;
use crate::propagation::jet::TERMS;
use crate::scene::dot;
use crate::solvers::even_field::traps::foci::{FixedFoci, Off};
use crate::solvers::even_field::traps::soft_minimum;

/// Number of passes. The first removes nine tenths of the rounding errors, the others the errors of its linear model.
const PASSES: usize = 3;

/// Root mean square distance in m of the beads from their points, per coordinate, that costs as much as the loss of all
/// stiffness.
const APART: f64 = 2.7e-4;

/// Sharpness of the soft minimum of the stiffnesses K.
const SHARPNESS: f64 = 48.0;

/// Rounds drives of modulus 1 to a grid, pass after pass. K is measured in parts of `unit`. Each drive stays within
/// `codes` codes of its value in each of the lists `others`. After a stop, the other drives are only rounded.
pub(super) fn bring(
    set: InstructionSet,
    (traps, fixed, unit): (&Stiffness, &FixedFoci, f64),
    quantization: &Quantization,
    (others, codes): (&[&[Complex32]], f32),
    (drive, stop): (&mut [Complex32], &mut dyn FnMut() -> bool),
) {
    let requested: Vec<Complex32> = drive.to_vec();
    let round = |drive: &mut [Complex32]| quantization.grid().round(set, 1.0, [1.0; 2], drive);
    round(drive);
    let Some(count) = quantization.phases() else { return };
    let [back, on] = [-1.0, 1.0].map(|sign: f64| {
        let turn = math::phasor(sign * TAU / f64::from(count));
        Complex32::new(turn.re as f32, turn.im as f32)
    });
    // The bound is half a code larger, so that rounding does not exclude the last code.
    let most = (f64::from(codes) + 0.5) * TAU / f64::from(count);
    let [cos, sin] = [math::cos(most.min(PI)), math::sin(most.min(FRAC_PI_2))].map(|x| x as f32);
    let near = |turn: Complex32| most >= PI || turn.re > cos.min(0.0) && (turn.im.abs() < sin || cos < 0.0);
    let allowed = |i: usize, to: Complex32| others.iter().all(|other| near(to * other[i].conj()));
    for _ in 0..PASSES {
        let field = traps.field(drive);
        let field = field.each_ref().map(|plane| &plane[..]);
        let (mut values, mut slopes) = slopes(traps, field);
        let places = values.len();
        values.extend(traps.at(field));
        let known = values.len();
        for Off { row, part, slope } in fixed.off(traps, field) {
            values.push(part);
            let mut pulls = [[0.0; TERMS]; 2];
            pulls.iter_mut().zip(slope).for_each(|(pull, slope)| pull[0] = slope as f32);
            slopes.push((row, pulls));
        }
        let share = 1.0 / (APART * APART * places as f64);
        for (i, q) in drive.iter_mut().enumerate().take_while(|_| !stop()) {
            if *q == Complex32::ZERO {
                continue;
            }
            let moves: Vec<[f64; 2]> = slopes.iter().map(|(j, slope)| traps.correlated(i, *j, slope)).collect();
            let own = *q;
            let moved = |to: Complex32| -> Vec<f64> {
                let [re, im] = [to.re - own.re, to.im - own.im].map(f64::from);
                values.iter().zip(&moves).map(|(value, [a, b])| value + re * a - im * b).collect()
            };
            let cost = |to: Complex32| {
                let values = moved(to);
                let (values, foci) = values.split_at(known);
                let (shifts, stiffness) = values.split_at(places);
                let soft = soft_minimum::negated(stiffness.iter().map(|k| k / unit), SHARPNESS);
                let lost = f64::from((to - requested[i]).norm_sqr()) / requested.len() as f64;
                share * shifts.iter().map(|s| s * s).sum::<f64>() + fixed.cost(foci.iter().copied()) + soft + lost
            };
            let around = [own, own * back, own * on].into_iter().filter(|&to| to == own || allowed(i, to));
            let nearest = around.map(|to| (cost(to), to)).min_by(|a, b| a.0.total_cmp(&b.0)).map_or(own, |(_, to)| to);
            values = moved(nearest);
            *q = nearest;
        }
        round(drive);
    }
}

/// The index j of a point, and the derivatives of a value by Re c and Im c there; the value depends on no other point.
type Slope = (usize, [[f32; TERMS]; 2]);

/// Returns the offsets of the resting beads from their points (3 M,) in m, and the derivatives of each offset, then of
/// each K.
fn slopes(traps: &Stiffness, field: [&[f32]; 2]) -> (Vec<f64>, Vec<Slope>) {
    let (net, yielding) = traps.balance(field);
    let mut planes = [(); 2].map(|()| vec![0.0; padded(traps.rows())]);
    let mut slope = |j: usize, weights: &[f64], forces: &[[f64; 3]]| {
        let [re, im] = &mut planes;
        traps.pull(field, weights, forces, [re, im]);
        (j, planes.each_ref().map(|plane| core::array::from_fn(|k| plane[j * TERMS + k])))
    };
    let (mut shifts, mut slopes) = (Vec::new(), Vec::new());
    let (mut weights, mut forces) = (vec![0.0; 3 * net.len()], vec![[0.0; 3]; net.len()]);
    for (j, (net, rows)) in net.iter().zip(&yielding).enumerate() {
        for row in rows {
            shifts.push(dot(*row, *net));
            forces[j] = *row;
            slopes.push(slope(j, &weights, &forces));
        }
        forces[j] = [0.0; 3];
    }
    for k in 0..weights.len() {
        weights[k] = 1.0;
        slopes.push(slope(k / 3, &weights, &forces));
        weights[k] = 0.0;
    }
    (shifts, slopes)
}
