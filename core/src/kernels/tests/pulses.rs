//! Pulses in double precision: the drive of each pulse, and the nearest pulse compared with a search of all.

use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::{Complex32, Complex64};

use crate::kernels::pulses::Pulses;
use crate::rng::Rng;

/// Lengths of the ticks of an Ultraino MEGA64, in processor cycles.
const UNEVEN: [f64; 10] = [38.0, 42.0, 34.0, 35.0, 35.0, 36.0, 43.0, 43.0, 34.0, 56.0];

/// Returns the first harmonic of a pulse from edge s to edge s + w, by its integral over the period.
fn harmonic(ticks: &[f64], start: usize, width: usize) -> Complex64 {
    let (count, period) = (ticks.len(), ticks.iter().sum::<f64>());
    let edge = |k: usize| (k / count) as f64 + ticks[..k % count].iter().sum::<f64>() / period;
    let late = (0..count).map(|k| edge(k) - k as f64 / count as f64).sum::<f64>() / count as f64;
    let place = |k: usize| Complex64::from_polar(1.0, TAU * (edge(k) - late));
    // The integral of e^{j x} is e^{j x}/j. Half a period that begins at 0 has 2/(-j), which is scaled to 1.
    let integral = (place(start + width) - place(start)) / Complex64::I;
    integral * Complex64::new(0.0, -1.0) / 2.0
}

fn all(ticks: &[f64]) -> Vec<([usize; 2], Complex64)> {
    let pulses = (1..=ticks.len() / 2).flat_map(|width| (0..ticks.len()).map(move |start| [start, width]));
    let on = pulses.map(|[start, width]| ([start, width], harmonic(ticks, start, width)));
    on.chain([([0, 0], Complex64::ZERO)]).collect()
}

fn wide(q: Complex32) -> Complex64 {
    Complex64::new(q.re.into(), q.im.into())
}

/// Returns the root mean square of the errors of many drives, relative to that of the drives.
fn error(ticks: &[f64], mut draw: impl FnMut() -> Complex32) -> f64 {
    let (pulses, all) = (Pulses::new(ticks), all(ticks));
    let (mut wrong, mut whole) = (0.0, 0.0);
    for _ in 0..4000 {
        let q = draw();
        let [start, width] = pulses.nearest(q);
        let got = (wide(pulses.drive(start, width)) - wide(q)).norm();
        let least = all.iter().map(|(_, pulse)| (pulse - wide(q)).norm()).fold(f64::INFINITY, f64::min);
        assert!(got <= least + 2e-7, "{q}: {got} instead of {least}");
        wrong += got * got;
        whole += wide(q).norm_sqr();
    }
    (wrong / whole).sqrt()
}

#[test]
fn pulses_are_the_first_harmonics_of_square_waves() {
    for ticks in [&[1.0; 128][..], &[1.0; 4], &UNEVEN] {
        let pulses = Pulses::new(ticks);
        for ([start, width], exact) in all(ticks) {
            let q = pulses.drive(start, width);
            assert!((wide(q) - exact).norm() < 6e-8, "{start} {width}: {q} instead of {exact}");
            assert_eq!(pulses.nearest(q), [start, width], "{q}");
        }
    }
    // Half a period that begins with the first tick has the drive 1.
    assert!((Pulses::new(&[1.0; 128]).drive(0, 64) - Complex32::ONE).norm() < 1e-12);
}

#[test]
fn the_nearest_pulse_is_found() {
    let mut rng = Rng::new(0);
    let mut full = || Complex32::from_polar(1.0, (TAU * rng.uniform()) as f32);
    for (ticks, most) in [(&[1.0; 128][..], 0.0072), (&[1.0; 10], 0.097), (&UNEVEN, 0.11)] {
        let got = error(ticks, &mut full);
        assert!(got < most, "{got}");
    }
    let mut any = || Complex32::from_polar(rng.uniform().sqrt() as f32, (TAU * rng.uniform()) as f32);
    for (ticks, most) in [(&[1.0; 128][..], 0.0128), (&[1.0; 10], 0.161), (&UNEVEN, 0.18), (&[1.0; 4], 0.5)] {
        let got = error(ticks, &mut any);
        assert!(got < most, "{got}");
    }
}

#[test]
fn the_nearest_pulse_of_unequal_ticks_is_found() {
    let mut rng = Rng::new(1);
    for _ in 0..20 {
        let ticks: Vec<f64> = (0..12).map(|_| 0.2 + rng.uniform()).collect();
        let mut any = || Complex32::from_polar(rng.uniform().sqrt() as f32, (TAU * rng.uniform()) as f32);
        let got = error(&ticks, &mut any);
        assert!(got < 0.2, "{got}");
    }
}
