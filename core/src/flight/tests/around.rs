//! Tests of the force's polynomials against `gorkov`, of the quadrature rule and of the Bessel functions.

use super::*;
use crate::InstructionSet;
use crate::propagation::forces::gorkov::gorkov;
use crate::rng::Rng;
use crate::scene::{Array, Medium, Particle};

#[test]
fn polynomials_around_places_are_the_force_by_every_set_and_whatever_the_number_of_them() {
    let array = Array::preset("openmpd_pair", [1, 1]).expect("an array");
    let particle = Particle::default();
    let mut rng = Rng::new(3);
    for set in InstructionSet::all() {
        let model = Model::new(&array, Medium::default(), set).expect("a model");
        let focus = |i: usize| Complex32::cis(-(model.sources.exact(i, [1e-3, 0.0, 2e-3]).arg() as f32));
        let sign = |i: usize| if i < 256 { 1.0 } else { -1.0 };
        let drive: Vec<Complex32> = (0..array.len()).map(|i| focus(i) * sign(i)).collect();
        let around = Around::new(&model, particle);
        let places: Vec<[f64; 3]> = (0..19).map(|k| [1e-3 + 1e-4 * f64::from(k), -5e-4, 2e-3]).collect();
        let polynomials = around.at(&places, &[&drive[..]; 19], &mut Control::none()).expect("forces");
        for (place, polynomial) in places.iter().zip(&polynomials) {
            let mut inside = || [(); 3].map(|()| 2.0 * rng.uniform() - 1.0);
            let ways: Vec<[f64; 3]> = (0..20).map(|_| inside()).filter(|way| dot(*way, *way) < 1.0).collect();
            let there: Vec<[f64; 3]> =
                ways.iter().map(|way| [0, 1, 2].map(|axis| place[axis] + around.unit * way[axis])).collect();
            let exact = gorkov(&model, &drive, &there, particle, &mut Control::none()).expect("a force").force;
            let most = exact.as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            for (way, exact) in ways.iter().zip(&exact) {
                let terms = monomials(*way);
                for axis in 0..3 {
                    let force: f64 = terms.iter().zip(polynomial).map(|(term, share)| term * share[axis]).sum();
                    assert!((force - exact[axis]).abs() < 1e-3 * most, "{set}: {force} {}", exact[axis]);
                }
            }
        }
    }
}

#[test]
fn the_rule_integrates_even_powers_over_the_sphere() {
    let rule = rule();
    assert_eq!(rule.len(), 50);
    for (power, exact) in [(0, 4.0), (2, 4.0 / 3.0), (10, 4.0 / 11.0)] {
        let sum: f64 = rule.iter().map(|node| node.weight * node.way[0].powi(power)).sum();
        assert!((sum - PI * exact).abs() < 1e-12);
    }
    let z = Complex64::new(1.0, 0.01);
    assert!((bessel(z)[0] - z.sin() / z).norm() < 1e-14);
    assert!((bessel(z)[1] - (z.sin() / z - z.cos()) / z).norm() < 1e-14);
}
