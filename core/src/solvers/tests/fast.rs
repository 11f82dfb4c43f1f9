//! Tests of `fast`.

use super::*;

#[test]
fn every_transducer_has_its_turn() {
    for count in 1..=300 {
        let mut order: Vec<usize> = stride(count, count as u64).collect();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..count), "{count}");
    }
}

/// The amplitudes of a problem with a directivity are stored. The problem also moves and changes its number of points.
#[test]
fn a_problem_whose_amplitudes_are_kept_has_the_same_bits() {
    use crate::kernels::InstructionSet;
    use crate::{Array, Directivity, Medium, Model, Request, Transducer};
    let transducer = Transducer { directivity: Directivity::T4010A1, ..Transducer::default() };
    let array = Array::grid(13, 11, 10e-3).and_then(|array| array.with_transducer(transducer)).expect("an array");
    let points = |count: u32, at: f64| -> Vec<[f64; 3]> {
        (0..count).map(|k| [3e-3 * f64::from(k) - 0.04, at, 0.12 + 1e-3 * f64::from(k % 5)]).collect()
    };
    for set in InstructionSet::all() {
        let model = Model::new(&array, Medium::default(), set).expect("a model");
        let control = &mut Control::none();
        let solved = [true, false].map(|rows_follow| {
            let model = model.clone().for_rows(rows_follow);
            let mut problem =
                Problem::of_model(&model, &points(16, 0.0), &Request::default(), control).expect("points");
            let mut drives = Vec::new();
            for (count, at) in [(16, 0.0), (16, 0.01), (28, -0.01), (5, 0.02), (16, 0.03)] {
                problem = problem.renewed(Some(&points(count, at)), &Request::default()).expect("points");
                let solution = Fast::default().solve(&problem, &mut Workspace::new(), control).expect("a solution");
                drives.push(solution.drive.clone());
            }
            drives
        });
        assert_eq!(solved[0], solved[1], "{set}");
    }
}
