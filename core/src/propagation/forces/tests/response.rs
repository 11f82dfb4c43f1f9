//! Tests of `response` against the series of waves at the surface of the sphere, which has all orders.

use super::*;
use crate::control::Control;
use crate::math;
use crate::propagation::forces::momentum::Pushed;
use crate::propagation::forces::momentum::tests::crossing;
use crate::propagation::jet::Jet;
use crate::rng::Rng;
use crate::vec3::Vec3;

#[test]
fn in_crossing_waves_it_is_the_force_of_all_orders_to_the_stated_error() {
    let medium = Medium::default();
    let mut rng = Rng::new(5);
    for seed in 0..12 {
        let mut vector = || [(); 3].map(|()| rng.uniform() - 0.5);
        let waves: Vec<_> = (0..2 + seed % 4)
            .map(|_| {
                let [re, im, _] = vector();
                (Vec3(vector()).unit().0, Complex64::new(re, im))
            })
            .collect();
        let (field, count) = (crossing(medium, waves.clone()), waves.len() as f64);
        for (part, error) in [(0.01, 1e-6), (0.0625, 3e-4), (0.125, 4e-3)] {
            for (density, sound_speed) in [(29.0, 900.0), (1e6, 1e6), (4.0, 300.0), (0.5, 500.0)] {
                let particle = Particle { radius: part * medium.wavelength(), density, sound_speed };
                let whole =
                    Pushed::new(particle, medium).force([0.0; 3], &field, &mut Control::none()).expect("a force");
                let at = field([0.0; 3]).expect("a field");
                let (response, c) = (Response::new(particle, medium), coefficients(particle, medium));
                let force = response.force.each_ref().map(|form| form.value(at.each_ref().map(Jet::coefficients)));
                let far = Vec3(force).distance(whole);
                // The scale is the largest force of a standing wave of these amplitudes.
                let scale = c[0].norm() * medium.wavenumber() * count * 0.25;
                assert!(far < error * scale, "{part} {density}: {force:?} {whole:?}");
                // Derivatives by differences. Without the imaginary parts of C, the force is that of the potential.
                let (h, real) = (1e-6, Response::of(c.map(|c| c.re.into())));
                let beside = |axis: usize, side: f64| {
                    let mut place = [0.0; 3];
                    place[axis] = side * h;
                    field(place).expect("a field")
                };
                let slope = |form: &Form, axis: usize| {
                    let [before, after] =
                        [-1.0, 1.0].map(|side| form.value(beside(axis, side).each_ref().map(Jet::coefficients)));
                    (after - before) / (2.0 * h)
                };
                let near = |form: &Form, exact: f64, scale: f64| {
                    let value = form.value(at.each_ref().map(Jet::coefficients));
                    assert!((value - exact).abs() < 1e-6 * scale, "{value} {exact}");
                };
                for i in 0..3 {
                    near(&real.force[i], -slope(&response.potential, i), scale);
                    for a in 0..3 {
                        let exact = -0.5 * (slope(&response.force[i], a) + slope(&response.force[a], i));
                        near(&response.hessian[i][a], exact, scale * medium.wavenumber());
                    }
                }
            }
        }
    }
}

#[test]
fn a_small_sphere_has_gorkovs_potential() {
    let medium = Medium::default();
    for (density, sound_speed) in [(29.0, 900.0), (4.0, 300.0), (0.5, 500.0)] {
        let particle = Particle { radius: 1e-3 / medium.wavenumber(), density, sound_speed };
        let [c0, c1, c2] = coefficients(particle, medium);
        let (ratio, speeds) = (density / medium.density, medium.sound_speed / sound_speed);
        let (f1, f2) = (1.0 - speeds * speeds / ratio, 2.0 * (ratio - 1.0) / (2.0 * ratio + 1.0));
        let (volume, square) = (particle.volume(), medium.density * medium.sound_speed * medium.sound_speed);
        // H. Bruus, Lab on a Chip 12, 1014 (2012): U = V [f1 |p|^2/(4 rho c^2) - 3/8 f2 |grad p|^2/(rho omega^2)].
        let exact =
            [-volume * f1 / (2.0 * square), 0.75 * volume * f2 / (square * math::pow(medium.wavenumber(), 2.0))];
        assert!((c0.re / exact[0] - 1.0).abs() < 1e-5 && (c1.re / exact[1] - 1.0).abs() < 1e-5, "{c0} {c1} {exact:?}");
        assert!(c2.norm() * math::pow(medium.wavenumber(), 4.0) < 1e-5 * c0.norm());
    }
}
