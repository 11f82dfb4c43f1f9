//! Tests of the skin: spectral lines of frames, the slope, thresholds, strength and width.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use num_complex::Complex32;

use super::{Pushes, Skin, live_lines, slopes};
use crate::control::Control;
use crate::touch::{Channel, Membrane, felt_width, steady, strength};

#[test]
fn frames_of_a_square_wave_have_its_harmonics() {
    // A square wave of 40 Hz between 0 and 1 has the amplitude 2/pi at 40 Hz, and a third of it at 120 Hz.
    for count in [2_usize, 60] {
        let mut pushes = Pushes::new(count, 40.0 * count as f64, 3, &Control::none()).expect("pushes");
        let frames: Vec<f32> = (0..3 * count).map(|k| if k / 3 < count / 2 { 1.0 } else { 0.0 }).collect();
        let (early, late) = frames.split_at(3 * (count / 2));
        pushes.add(0, early, &mut Control::none()).expect("added");
        pushes.add(count / 2, late, &mut Control::none()).expect("added");
        assert_eq!(pushes.frequencies().len(), 12);
        assert!((pushes.frequencies()[2] - 120.0).abs() < 1e-9 && (pushes.mean()[1] - 0.5).abs() < 1e-6);
        for (k, size) in [(0, 2.0 / PI), (1, 0.0), (2, 2.0 / PI / 3.0), (4, 2.0 / PI / 5.0)] {
            assert!((f64::from(pushes.lines()[3 * k].norm()) - size).abs() < 1e-5);
        }
    }
}

#[test]
fn a_line_is_the_amplitude_of_its_cosine() {
    let count = 64;
    let mut pushes = Pushes::new(count, 6400.0, 1, &Control::none()).expect("pushes");
    let frames: Vec<f32> = (0..count).map(|t| 3.0 + (TAU * t as f64 / 64.0 + 0.7).cos() as f32).collect();
    pushes.add(0, &frames, &mut Control::none()).expect("added");
    // Constant frames reduce the amplitude by sinc(1/64). Time 0 is the middle of the first frame.
    let sinc = (PI / 64.0).sin() / (PI / 64.0);
    let exact = Complex32::from_polar(sinc as f32, 0.7);
    assert!((pushes.lines()[0] - exact).norm() < 1e-5, "{}", pushes.lines()[0]);
    assert!(pushes.lines()[1].norm() < 1e-5);
}

#[test]
fn frames_that_repeat_above_500_hz_have_no_line() {
    let pushes = Pushes::new(2, 2000.0, 5, &Control::none()).expect("pushes");
    assert!(pushes.frequencies().is_empty());
    let membrane = Membrane::new(6.0, 0.4, 6.4).expect("a membrane");
    let skin = Skin::on_plane(&membrane, &[], &[], [1, 5], [1e-3, 2e-3], &mut Control::none()).expect("a skin");
    assert_eq!((skin.displacement.len(), skin.fast), (0, vec![0.0; 5]));
    for (count, rate, places) in [(0, 1.0, 1), (1, 0.0, 1), (1, f64::INFINITY, 1), (1, 1.0, 0), (1, 1.0, 1 << 60)] {
        assert!(Pushes::new(count, rate, places, &Control::none()).is_err());
    }
    assert!(
        Pushes::new(4, 10.0, 2, &Control::none()).expect("pushes").add(3, &[0.0; 4], &mut Control::none()).is_err()
    );
}

#[test]
fn a_quiet_line_moves_nothing() {
    let lines = [1.0, 0.5, 1e-7, 0.0, 0.0, 2e-6].map(|re| Complex32::new(re, 0.0));
    assert_eq!(live_lines(&lines, 2), [true, false, true]);
    assert_eq!(live_lines(&[Complex32::ZERO; 4], 2), [false, false]);
}

#[test]
fn the_slope_of_a_ramp_is_constant() {
    let ramp: Vec<Complex32> = (0..20).map(|k| Complex32::new(3.0 * (k % 5) as f32, 4.0 * (k / 5) as f32)).collect();
    for square in slopes(&ramp, 5, 0.5) {
        assert!((square - 100.0).abs() < 1e-3, "{square}");
    }
    assert_eq!(slopes(&[Complex32::ONE], 1, 0.5), [0.0]);
}

#[test]
fn motion_is_the_sum_of_the_lines() {
    let membrane = Membrane::new(6.0, 0.4, 6.4).expect("a membrane");
    let lines: Vec<Complex32> = (0..2 * 12).map(|k| Complex32::new((k % 5) as f32, (k % 7) as f32)).collect();
    let skin =
        Skin::on_plane(&membrane, &[100.0, 200.0], &lines, [3, 4], [1e-3, 2e-3], &mut Control::none()).expect("a skin");
    let times = 64;
    let moved: Vec<Vec<f32>> = (0..times).map(|t| skin.motion(0.01 * f64::from(t) / f64::from(times), 0..12)).collect();
    for (place, rms) in skin.rms().iter().enumerate() {
        let square: f32 = moved.iter().map(|each| each[place] * each[place]).sum::<f32>() / times as f32;
        assert!((square.sqrt() - rms).abs() < 1e-4 * rms);
    }
    let [a, b] = [skin.displacement[5], skin.displacement[17]];
    assert_eq!(skin.motion(0.0, 5..6), moved[0][5..6]);
    assert!((moved[0][5] - a.re - b.re).abs() < 1e-5 * a.norm());
}

#[test]
fn thresholds_strength_and_width() {
    let decibels = |metres: f64| 20.0 * (metres / 1e-6).log10();
    for (channel, frequency, level) in [
        (Channel::Fast, 250.0, -20.0),
        (Channel::Fast, 500.0, -10.0),
        (Channel::Slow, 1.0, 32.0),
        (Channel::Slow, 60.0, 12.0),
    ] {
        assert!((decibels(channel.threshold(frequency)) - level).abs() < 1e-9);
    }
    assert_eq!(Channel::Fast.threshold(0.5), f64::INFINITY);
    assert_eq!(Channel::Slow.threshold(500.1), f64::INFINITY);
    // Two lines of three and four times the threshold add as the root of the sum of squares: 5.
    let square = |times: f64, frequency: f64| (times * Channel::Fast.threshold(frequency)).powi(2) as f32;
    let excess = Channel::Fast.excess(&[100.0, 250.0], &[square(3.0, 100.0), square(4.0, 250.0)], 1);
    assert!((excess[0] - 5.0).abs() < 1e-5);
    let lines = [3.0, 0.0, 0.0, 4.0].map(|re| Complex32::new(0.0, re));
    let pressed = steady(&[5.0, 15.0], &lines, 2);
    assert!((pressed[0] - 3.0 / (10.0_f64 / 9.0).sqrt()).abs() < 1e-9 && (pressed[1] - 8.0_f64.sqrt()).abs() < 1e-9);
    assert_eq!(strength(2.0, 6.0), 7.0);
    let places: Vec<[f64; 3]> = (0..9).map(|k| [1e-3 * f64::from(k), 0.0, 0.1]).collect();
    let values = [0.0, 1.0, 4.0, 6.0, 8.0, 7.0, 4.0, 3.9, 0.0];
    assert!((felt_width(&values, &places, 4) - 6e-3).abs() < 1e-12);
    assert_eq!(felt_width(&[1.0; 9], &places, 4), f64::INFINITY);
}
