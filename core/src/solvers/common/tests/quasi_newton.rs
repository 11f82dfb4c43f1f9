//! Quasi-Newton directions on a quadratic form.

use crate::solvers::common::quasi_newton::{QuasiNewton, dot};
use crate::workspace::Workspace;

/// The curvatures a_k of E = 1/2 sum_k a_k x_k^2.
const CURVATURES: [f32; 9] = [1.0, 2.0, 0.5, 100.0, 7.0, 0.1, 30.0, 1.0, 3.0];

#[test]
fn exact_line_searches_minimise_a_quadratic_form_in_as_many_steps_as_it_has_curvatures() {
    let work = Workspace::new();
    let mut newton = QuasiNewton::new(&work);
    let mut x = [1.0_f32; 9];
    let gradient = |x: &[f32; 9]| core::array::from_fn::<f32, 9, _>(|k| CURVATURES[k] * x[k]);
    for _ in 0..9 {
        let (before, mut direction) = (gradient(&x), gradient(&x));
        newton.descend(&mut direction);
        let curved: [f32; 9] = core::array::from_fn(|k| CURVATURES[k] * direction[k]);
        let part = (-dot(&direction, &before) / dot(&direction, &curved)) as f32;
        assert!(part > 0.0, "it descends");
        let step: [f32; 9] = core::array::from_fn(|k| part * direction[k]);
        x = core::array::from_fn(|k| x[k] + step[k]);
        let change: [f32; 9] = core::array::from_fn(|k| CURVATURES[k] * step[k]);
        newton.remember(&step, &change);
    }
    assert!(x.iter().all(|x| x.abs() < 1e-3), "{x:?}");
}

#[test]
fn a_step_without_curvature_is_not_stored() {
    let work = Workspace::new();
    let mut newton = QuasiNewton::new(&work);
    newton.remember(&[1.0, 0.0], &[0.0, 1.0]);
    newton.remember(&[1.0, 0.0], &[-1.0, 0.0]);
    assert!(newton.knows_nothing() && !newton.forget());
    let mut gradient = [3.0, -4.0];
    newton.descend(&mut gradient);
    assert_eq!(gradient, [-3.0, 4.0]);
}
