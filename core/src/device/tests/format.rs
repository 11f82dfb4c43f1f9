//! Compares codes with those computed in double precision only, for random drives and close to the middle between two steps.

use core::f64::consts::TAU;

use num_complex::Complex32;

use super::{Code, Levels, Steps};
use crate::math;
use crate::rng::Rng;

/// Computes [`Steps::code`] in double precision only.
fn exact(steps: Steps, drive: Complex32, correction: f64) -> Code {
    let (phases, amplitude) = (f64::from(steps.phases), math::modulus(drive).min(1.0));
    let level = math::floor(amplitude * f64::from(steps.most()) + 0.5) as u16;
    if level == 0 {
        return Code::default();
    }
    let turns = math::atan2(f64::from(drive.im), f64::from(drive.re)) / TAU - correction;
    let phase = math::floor(turns * phases + 0.5) as i32;
    Code { phase: phase.rem_euclid(i32::from(steps.phases)) as u16, level }
}

#[test]
fn codes_are_those_of_double_precision() {
    let mut rng = Rng::new(0);
    for (phases, levels) in [(256, Levels::Even(255)), (32, Levels::OnOff), (10, Levels::OnOff), (16, Levels::Even(3))]
    {
        let steps = Steps { phases, levels };
        for _ in 0..20_000 {
            let correction = if rng.uniform() < 0.5 { 0.0 } else { rng.uniform() };
            // Half of the phases are within 1e-5 steps of the middle between two steps.
            let phase = (rng.uniform() * f64::from(phases)).floor() + 0.5 + 2e-5 * (rng.uniform() - 0.5);
            let turns = if rng.uniform() < 0.5 { phase / f64::from(phases) + correction } else { rng.uniform() };
            let level = (rng.uniform() * f64::from(steps.most())).floor() + 0.5 + 2e-5 * (rng.uniform() - 0.5);
            let middle = level / f64::from(steps.most());
            let amplitude = if rng.uniform() < 0.5 { middle } else { rng.uniform() };
            let drive = math::phasor(TAU * turns) * amplitude.min(1.0);
            let drive = Complex32::new(drive.re as f32, drive.im as f32);
            assert_eq!(
                steps.code(drive, correction),
                exact(steps, drive, correction),
                "{steps:?} {drive} {correction}"
            );
        }
    }
}
