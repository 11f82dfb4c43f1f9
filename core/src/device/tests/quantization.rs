//! Tests of `quantization`.

use super::*;
use alloc::vec;

#[test]
fn turns_are_those_of_the_arc_tangent() {
    for step in -1000..=1000 {
        let angle = core::f64::consts::PI * f64::from(step) / 1000.0;
        let (sin, cos) = angle.sin_cos();
        let exact = sin.atan2(cos) / core::f64::consts::TAU;
        // Half a turn is one either way.
        let miss = (turns(3.0 * cos, 3.0 * sin) - exact).abs();
        assert!(miss.min((miss - 1.0).abs()) < 4e-9, "{angle}");
    }
}

#[test]
fn a_table_gives_the_nearest_value_and_the_upper_of_two() {
    let table = [0.0, 0.25, 1.0];
    for (wanted, nearest) in
        [(0.0, 0.0), (0.1, 0.0), (0.125, 0.25), (0.3, 0.25), (0.62, 0.25), (0.625, 1.0), (1.1, 1.0)]
    {
        assert_eq!(nearest_of(&table, wanted), nearest, "{wanted}");
    }
    assert_eq!(nearest_of(&[1.0], 0.01), 1.0);
}

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
    // The one below is far off.
    assert_eq!(lowered(&table, 0.5), (0.76, 0.5 / 0.76));
    assert_eq!(lowered(&table, 0.95), (1.0, 0.95));
    assert_eq!(lowered(&table, 0.1), (0.15, 0.1 / 0.15));
    assert_eq!(lowered(&[1.0], 0.25), (1.0, 0.25));
    assert_eq!(lowered(&[0.0, 1.0], 0.01), (1.0, 0.01));
    assert_eq!(Quantization::new(Some(16), None).unwrap().lowered(0.1), (0.1, 1.0));
}

#[test]
fn what_lies_on_the_grid_stays_to_the_bit() {
    for (phases, table) in [
        (Some(10), None),
        (Some(256), Some(vec![0.0, 0.3, 1.0])),
        (None, Some(vec![0.5, 1.0])),
        (Some(65_536), Some(vec![1.0])),
    ] {
        let quantization = Quantization::new(phases, table).unwrap();
        for k in 0..1000 {
            let drive = quantization.nearest(Complex32::from_polar(1.0, 0.01 * k as f32));
            if quantization.phases().is_some() {
                assert_eq!(quantization.nearest(drive), drive);
            }
            assert!((quantization.nearest(drive) - drive).norm() < 1e-7);
        }
    }
}
