//! Tests of `sources`.

use super::*;

#[test]
fn padding_is_a_point_also_when_the_points_change() {
    let array = Array::preset("paper20", [1, 1]).expect("a preset");
    let prepared = Sources::new(&array, Medium::default());
    let (near, other) = ([[0.0, 0.01, 0.15]; 3], [[0.02, 0.0, 0.1]; 3]);
    let mut frame = prepared.frame(&near);
    assert!(frame.iter().all(|axis| axis.len() == 16 && axis.iter().all(|x| *x == axis[0])));
    prepared.write_frame(&other, &mut frame);
    assert_eq!(frame, prepared.frame(&other));
    assert!(prepared.frame(&[]).iter().all(Vec::is_empty));
}
