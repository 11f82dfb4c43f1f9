//! Tests of `quantization`.

use super::*;

#[test]
fn what_lies_below_the_least_amplitude_is_left_to_the_supply() {
    let scale = |table: &[f64], largest| Quantization::new(None, Some(table.to_vec())).unwrap().scale(largest);
    assert_eq!(scale(&[0.0, 1.0], 0.25), 0.25);
    assert_eq!(scale(&[1.0], 1.0 - 1e-7), 1.0);
    assert_eq!(scale(&[0.0, 0.5, 1.0], 0.6), 1.0);
    assert_eq!(scale(&[0.0, 0.5, 1.0], 0.125), 0.25);
    assert_eq!(scale(&[0.0, 0.5, 1.0], 0.0), 1.0);
    assert_eq!(Quantization::new(Some(16), None).unwrap().scale(0.1), 1.0);
}

#[test]
fn full_drive_is_lowered_by_the_table_and_what_it_cannot_by_the_scale() {
    let lowered = |table: &[f64], factor| Quantization::new(None, Some(table.to_vec())).unwrap().lowered(factor);
    let table = [0.0, 0.15, 0.4, 0.76, 0.8, 1.0];
    assert_eq!(lowered(&table, 1.0), (1.0, 1.0));
    assert_eq!(lowered(&table, 0.42), (0.4, 1.0));
    assert_eq!(lowered(&table, 0.79), (0.76, 1.0));
    assert_eq!(lowered(&table, 0.8 / (1.0 + 4e-5)), (0.8, 1.0));
    // The next lower amplitude would lose more than a tenth, so the next higher one is used with a scale.
    assert_eq!(lowered(&table, 0.5), (0.76, 0.5 / 0.76));
    assert_eq!(lowered(&table, 0.95), (1.0, 0.95));
    assert_eq!(lowered(&table, 0.1), (0.15, 0.1 / 0.15));
    assert_eq!(lowered(&[1.0], 0.25), (1.0, 0.25));
    assert_eq!(lowered(&[0.0, 1.0], 0.01), (1.0, 0.01));
    assert_eq!(Quantization::new(Some(16), None).unwrap().lowered(0.1), (0.1, 1.0));
}

#[test]
fn the_highest_amplitude_that_is_not_above_is_one_of_the_table_or_0() {
    let board = Quantization::new(None, Some(vec![0.25, 0.5, 1.0])).expect("a board");
    for (factor, amplitude) in [(0.2, 0.0), (0.25 - 1e-10, 0.25), (0.49, 0.25), (0.5, 0.5), (1.0, 1.0)] {
        assert_eq!(board.at_most(factor), amplitude, "{factor}");
    }
    assert_eq!(Quantization::new(Some(8), None).expect("a board").at_most(0.3), 0.3);
}
