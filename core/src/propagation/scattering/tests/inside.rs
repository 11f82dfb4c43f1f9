//! Tests that bodies which cannot be solved are rejected.

use alloc::sync::Arc;

use crate::control::Control;
use crate::propagation::Boundary;
use crate::scene::{Array, Medium, Mesh, Obstacle, Surface};

/// Returns a box with one corner at `at` and these lengths along the axes.
fn brick(at: [f64; 3], lengths: [f64; 3]) -> Obstacle {
    let corners = (0..8).map(|k| [0, 1, 2].map(|axis| at[axis] + lengths[axis] * f64::from(k >> (2 - axis) & 1)));
    let faces = [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ];
    Obstacle::Mesh(Arc::new(Mesh::new(corners.collect(), faces.to_vec(), Surface::Rigid).expect("a box")))
}

fn enclosed(bodies: Vec<Obstacle>) -> Result<(), String> {
    let array = Array::grid(4, 4, 10e-3).expect("an array");
    let boundary = Boundary::new(&array, Medium::default(), bodies).expect("a boundary");
    boundary.enclosed(&mut Control::none()).map_err(|error| error.to_string())
}

const SIZE: [f64; 3] = [8e-3; 3];
const AT: [f64; 3] = [0.0, 0.0, 0.08];

#[test]
fn bodies_apart_and_bodies_that_touch_are_solved() {
    assert_eq!(enclosed(vec![brick(AT, SIZE)]), Ok(()));
    for by in [8e-3, 12e-3] {
        assert_eq!(enclosed(vec![brick(AT, SIZE), brick([by, 0.0, 0.08], SIZE)]), Ok(()));
        assert_eq!(enclosed(vec![brick(AT, SIZE), brick([by, 3e-3, 0.081], SIZE)]), Ok(()));
    }
}

#[test]
fn bodies_that_coincide_cross_or_contain_each_other_are_refused() {
    let reported = "obstacles is bodies that cross, contain each other or are there twice near (";
    for other in [brick(AT, SIZE), brick([4e-3, 0.0, 0.08], SIZE), brick([2e-3, 2e-3, 0.082], [3e-3; 3])] {
        let error = enclosed(vec![brick(AT, SIZE), other]).expect_err("no answer");
        assert!(error.starts_with(reported) && error.ends_with("a union of the modeller's"), "{error}");
    }
}

#[test]
fn a_plate_is_refused_where_it_is_thinner_than_its_elements_carry() {
    let plate = |thickness: f64| enclosed(vec![brick(AT, [12e-3, 12e-3, thickness])]);
    for thickness in [1e-3, 0.3e-3] {
        assert_eq!(plate(thickness), Ok(()), "{thickness}");
    }
    for thickness in [0.1e-3, 50e-6, 1e-6] {
        let error = plate(thickness).expect_err("too thin");
        assert!(error.starts_with("obstacles is a body thinner than 0.2"), "{error}");
    }
}
