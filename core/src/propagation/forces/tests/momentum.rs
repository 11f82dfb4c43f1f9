//! Tests of the force on a large sphere, against closed forms for plane waves.

use super::*;
use crate::propagation::jet::{EXPONENTS, TERMS, factorial};
use core::f64::consts::PI;

/// Returns the field of plane waves with these unit vectors and complex amplitudes, with its derivatives.
pub(crate) fn crossing(
    medium: Medium,
    waves: Vec<([f64; 3], Complex64)>,
) -> impl Fn([f64; 3]) -> Result<[Jet; 2], Error> {
    let k = medium.wavenumber();
    move |place| {
        let mut sum = [[0.0; TERMS]; 2];
        for (way, amplitude) in &waves {
            let p = amplitude * math::phasor(k * dot(place, *way));
            for term in 0..TERMS {
                let mut slope = p / factorial(term);
                for (axis, &times) in EXPONENTS[term].iter().enumerate() {
                    (0..times).for_each(|_| slope *= Complex64::I * k * way[axis]);
                }
                sum[0][term] += slope.re;
                sum[1][term] += slope.im;
            }
        }
        Ok(sum.each_ref().map(Jet::of))
    }
}

/// Returns the field of a plane wave along z plus one of amplitude `back` in the opposite direction.
fn waves(back: f64, medium: Medium) -> impl Fn([f64; 3]) -> Result<[Jet; 2], Error> {
    crossing(medium, vec![([0.0, 0.0, 1.0], Complex64::ONE), ([0.0, 0.0, -1.0], back.into())])
}

#[test]
fn a_small_sphere_has_kings_force_in_standing_and_running_waves() {
    let medium = Medium::default();
    let k = medium.wavenumber();
    let radius = 0.02 / k;
    let energy = 1.0 / (2.0 * medium.density * medium.sound_speed * medium.sound_speed);
    for density in [5.0, 29.0, 1e9] {
        let sphere = Pushed::new(Particle { radius, density, sound_speed: 1e9 }, medium);
        let ratio = medium.density / density;
        // L. V. King, Proc. R. Soc. A 147, 212 (1934), with the energy density E of one wave and r = `ratio`. A standing wave
        // of two waves: pi a^2 (ka) E (1 + 2/3 (1 - r))/(2 + r) 8 sin 2kh.
        let z = 0.1 / k;
        let standing = sphere.force([0.0, 0.0, z], waves(1.0, medium), &mut Control::none()).expect("a force");
        let exact = 4.0
            * PI
            * radius
            * radius
            * (k * radius)
            * energy
            * 2.0
            * math::sin(2.0 * k * z)
            * ((1.0 + 2.0 / 3.0 * (1.0 - ratio)) / (2.0 + ratio));
        assert!((standing[2] / exact - 1.0).abs() < 2e-3, "{} {exact}", standing[2]);
        // A single travelling wave: 4 pi a^2 (ka)^4 E (1 + 2/9 (1 - r)^2)/(2 + r)^2.
        let running = sphere.force([0.0; 3], waves(0.0, medium), &mut Control::none()).expect("a force");
        let exact = 4.0
            * PI
            * radius
            * radius
            * math::pow(k * radius, 4.0)
            * energy
            * (1.0 + 2.0 / 9.0 * (1.0 - ratio) * (1.0 - ratio))
            / ((2.0 + ratio) * (2.0 + ratio));
        assert!((running[2] / exact - 1.0).abs() < 2e-3, "{} {exact}", running[2]);
        // The force across the wave is only rounding, of sums as large as those of the standing wave.
        assert!(running[0].abs() + running[1].abs() < 1e-13 * standing[2], "{running:?} {standing:?}");
    }
}

#[test]
fn a_sphere_of_many_wavelengths_takes_what_its_section_meets() {
    let medium = Medium::default();
    let radius = 3.0 * medium.wavelength();
    let sphere = Pushed::new(Particle { radius, density: 1e9, sound_speed: 1e9 }, medium);
    let force = sphere.force([0.0; 3], waves(0.0, medium), &mut Control::none()).expect("a force")[2];
    // In geometrical acoustics a rigid sphere reflects each ray as a mirror does. On average this gives the force pi a^2 E.
    let section = PI * radius * radius / (2.0 * medium.density * medium.sound_speed * medium.sound_speed);
    assert!((force / section - 1.0).abs() < 0.1, "{}", force / section);
}
