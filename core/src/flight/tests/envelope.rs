//! Tests of envelopes against the differential equation, which is integrated in small steps.

use super::*;

const TAU: f64 = 3e-4;

/// Returns y of one transducer after its drives, by y' = (q - y)/tau in `fine` small steps a frame, each with the drive in its
/// middle.
fn integrated(envelope: &Envelope, drives: &[Complex32], mut y: Complex64, fine: usize) -> Complex64 {
    let wide = |q: Complex32| Complex64::new(f64::from(q.re), f64::from(q.im));
    let step = 1.0 / (envelope.rate * fine as f64);
    for k in 0..drives.len() - 1 {
        let (now, next) = (wide(drives[k]), wide(drives[k + 1]));
        for n in 0..fine {
            let share = if envelope.linear { (n as f64 + 0.5) / fine as f64 } else { 0.0 };
            let size = now.norm() + share * (next.norm() - now.norm());
            let from = if now.norm() > 0.0 { now.arg() } else { next.arg() };
            let q = Complex64::from_polar(size, from + share * (next * now.conj()).arg());
            y = q + (y - q) * (-step / envelope.tau).exp();
        }
    }
    y
}

/// Drives of one transducer, one of them 0.
fn drives() -> Vec<Complex32> {
    [(1.0, 0.3), (0.5, 2.9), (0.0, 0.0), (0.8, -2.9), (1.0, 0.3)]
        .map(|(r, phase)| Complex32::from_polar(r, phase))
        .into()
}

#[test]
fn frames_agree_with_the_differential_equation() {
    for linear in [false, true] {
        let envelope = Envelope { rate: 5e3, tau: TAU, linear };
        let drives = drives();
        let start = Complex64::new(0.2, -0.4);
        let mut state = [start];
        let mut ends = [Complex32::ZERO; 2];
        for k in 0..drives.len() - 1 {
            envelope.frame(&drives[k..=k], &drives[k + 1..k + 2], &mut state, 2, 0..2, &mut ends);
            // y in the middle of the first frame is also y at the end of a frame that takes half the time.
            if k == 0 {
                let half = Envelope { rate: 2.0 * envelope.rate, ..envelope };
                let halves = [drives[0], if linear { middle(drives[0], drives[1]) } else { drives[0] }];
                let exact = integrated(&half, &halves, start, 20_000);
                assert!((Complex64::new(f64::from(ends[1].re), f64::from(ends[1].im)) - exact).norm() < 1e-5);
            }
        }
        assert!((state[0] - integrated(&envelope, &drives, start, 20_000)).norm() < 1e-5, "{linear}");
    }
}

/// Returns the drive half way between two drives.
fn middle(a: Complex32, b: Complex32) -> Complex32 {
    Complex32::from_polar(0.5 * (a.norm() + b.norm()), a.arg() + 0.5 * (b * a.conj()).arg())
}

#[test]
fn a_repeated_sequence_ends_as_it_begins() {
    for tau in [0.0, TAU] {
        let envelope = Envelope { rate: 5e3, tau, linear: false };
        let drives = drives();
        let before = envelope.repeated(&drives[4 - envelope.memory(4)..4], &drives[..1]);
        let mut state = before.clone();
        for k in 0..4 {
            envelope.frame(&drives[k..=k], &drives[k + 1..k + 2], &mut state, 1, 0..0, &mut []);
        }
        assert!((state[0] - before[0]).norm() < 1e-12);
    }
}
