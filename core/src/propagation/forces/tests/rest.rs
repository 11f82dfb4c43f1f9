//! Tests of `rest`: compares the resting places with the force there.

use super::*;
use crate::InstructionSet;
use crate::propagation::forces::gorkov::gorkov;
use crate::scene::{Array, Medium, distance, dot};

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Returns two facing arrays of 5 x 5 transducers, and a drive that makes nodes between them.
fn model() -> (Model, Vec<Complex32>) {
    let place = |i: usize| {
        let k = i % 25;
        [0.0105 * (k % 5) as f64 - 0.021, 0.0105 * (k / 5) as f64 - 0.021, if i < 25 { -0.03 } else { 0.03 }]
    };
    let normals = (0..50).map(|i| [0.0, 0.0, if i < 25 { 1.0 } else { -1.0 }]).collect();
    let array = Array::new((0..50).map(place).collect(), Some(normals)).expect("an array");
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("a model");
    let focus = |i: usize| {
        let phase = model.sources.exact(i, [0.0; 3]).arg() as f32;
        Complex32::cis(if i < 25 { -phase } else { core::f32::consts::PI - phase })
    };
    let drive = (0..50).map(focus).collect();
    (model, drive)
}

#[test]
fn a_bead_rests_where_the_net_force_is_0_and_is_pulled_back_up_to_the_edge() {
    let (model, drive) = model();
    let particle = Particle::default();
    let starts = [[0.0; 3], [4e-4, -3e-4, 7e-4], [0.0, 0.0, 0.0043]];
    let none = &mut Control::none();
    let rest = rest(&model, &drive, &starts, particle, GRAVITY, none).expect("places");
    assert_eq!(rest.held, [true; 3]);
    // From the second start the particle moves to the same node as from the first, from the third start to the next node.
    assert!(distance(rest.place[0], rest.place[1]) < 1e-8 && rest.place[2][2] > 3.5e-3);
    let weight = particle.weight(model.medium(), GRAVITY);
    let net = |place: [f64; 3]| {
        let force = gorkov(&model, &drive, &[place], particle, &mut Control::none()).expect("a force").force[0];
        [0, 1, 2].map(|axis| force[axis] + weight[axis])
    };
    for j in 0..3 {
        assert!(net(rest.place[j]).iter().all(|x| x.abs() < 1e-6 * weight[2].abs()));
        assert!(rest.stiffness[j][0] > 0.0 && rest.stiffness[j].is_sorted());
        for (k, axis) in rest.axes[j].iter().enumerate() {
            for (way, sign) in [-1.0, 1.0].into_iter().enumerate() {
                let at = |d: f64| [0, 1, 2].map(|i| rest.place[j][i] + sign * d * axis[i]);
                let back = |d: f64| -sign * dot(net(at(d)), *axis);
                let (edge, most) = (rest.basin[j][k][way], rest.restoring[j][k][way]);
                let fine = (1..=400).map(|n| back(edge * f64::from(n) / 400.0)).fold(0.0, f64::max);
                assert!((most / fine - 1.0).abs() < 5e-3, "{most} {fine}");
                // The force is 0 at the edge of the basin, unless the search ended there.
                if edge < 0.99 * model.medium().wavelength() {
                    assert!(back(edge).abs() < 0.02 * most && back(0.9 * edge) > 0.0);
                }
            }
        }
    }
}

#[test]
fn a_bead_without_a_trap_is_lost() {
    let array = Array::grid(4, 4, 10e-3).expect("an array");
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("a model");
    let drive = [Complex32::ONE; 16];
    let rest = rest(&model, &drive, &[[0.0, 0.0, 0.05]], Particle::default(), GRAVITY, &mut Control::none());
    let rest = rest.expect("an answer");
    assert!(!rest.held[0] && rest.stiffness[0][0].is_nan() && rest.place[0].iter().all(|x| x.is_finite()));
}
