//! Tests of `track`: compared with all possible tracks.

use alloc::vec;
use alloc::vec::Vec;

use super::{Circle, Ends, Tracker};
use crate::control::Control;
use crate::kernels::InstructionSet;
use crate::math::phasor;
use crate::rng::Rng;

const FRAMES: usize = 6;

/// Returns the sum over the frames of Re(conj(S) q) for the `waves` S, in double precision; a track maximises it.
fn gain(waves: &[Vec<f32>; 2], levels: usize, codes: &[u16]) -> f64 {
    let one = |(frame, &code): (usize, &u16)| {
        let q = phasor(core::f64::consts::TAU * f64::from(code) / levels as f64);
        f64::from(waves[0][frame]) * q.re + f64::from(waves[1][frame]) * q.im
    };
    codes.iter().enumerate().map(one).sum()
}

fn apart(levels: usize, a: u16, b: u16) -> usize {
    let distance = usize::from(a.abs_diff(b));
    distance.min(levels - distance)
}

/// Calls `tell` with every track within reach that begins with `codes`.
fn all_tracks(levels: usize, reach: usize, codes: &mut Vec<u16>, tell: &mut dyn FnMut(&[u16])) {
    if codes.len() == FRAMES {
        return tell(codes);
    }
    for next in 0..levels as u16 {
        if codes.last().is_none_or(|&last| apart(levels, last, next) <= reach) {
            codes.push(next);
            all_tracks(levels, reach, codes, tell);
            codes.pop();
        }
    }
}

fn best(waves: &[Vec<f32>; 2], levels: usize, reach: usize, closed: bool, first: Option<u16>) -> f64 {
    let mut most = f64::NEG_INFINITY;
    all_tracks(levels, reach, &mut first.into_iter().collect(), &mut |codes| {
        if !closed || apart(levels, codes[0], codes[FRAMES - 1]) <= reach {
            most = most.max(gain(waves, levels, codes));
        }
    });
    most
}

#[test]
#[ignore = "slow"]
fn no_track_is_better_than_the_one_found() {
    let mut rng = Rng::new(3);
    let mut closed_best = 0;
    for (levels, reach) in [(8, 0), (8, 1), (8, 2), (8, 4), (5, 1), (5, 2), (2, 0), (2, 1), (3, 1)] {
        for _ in 0..8 {
            let waves = [(); 2].map(|()| (0..FRAMES).map(|_| (2.0 * rng.uniform() - 1.0) as f32).collect::<Vec<_>>());
            for set in InstructionSet::all() {
                let circle = Circle::new(levels, reach);
                let mut tracker = Tracker::new(&circle, FRAMES, set);
                for end in [Ends::Open, Ends::Closed, Ends::Held] {
                    let closed = end == Ends::Closed;
                    let start = (end == Ends::Held).then_some(levels as u16 / 2);
                    let mut codes = vec![start.unwrap_or(0); FRAMES];
                    let planes = [&waves[0][..], &waves[1][..]];
                    tracker.follow(planes, end, &mut codes, &mut Control::none()).expect("it is not stopped");
                    let ends = closed.then(|| (codes[FRAMES - 1], codes[0]));
                    let steps = codes.windows(2).map(|pair| (pair[0], pair[1])).chain(ends);
                    assert!(steps.into_iter().all(|(a, b)| apart(levels, a, b) <= reach), "{levels} {reach} {codes:?}");
                    let value = gain(&waves, levels, &codes);
                    assert!(start.is_none_or(|first| first == codes[0]));
                    let first = if closed { Some(codes[0]) } else { start };
                    let most = best(&waves, levels, reach, closed, first);
                    assert!((value - most).abs() < 1e-5, "{levels} {reach} {end:?}: {value} of {most}");
                    if closed && set == InstructionSet::SCALAR {
                        closed_best += usize::from(value > best(&waves, levels, reach, true, None) - 1e-5);
                    }
                }
            }
        }
    }
    // With six frames the middle of two laps is not always the best start.
    assert!(closed_best > 66, "{closed_best} of 72");
}

#[test]
fn a_track_without_a_wave_has_code_0() {
    let circle = Circle::new(256, 4);
    let mut tracker = Tracker::new(&circle, FRAMES, InstructionSet::best());
    let mut codes = vec![9; FRAMES];
    let nothing = [0.0; FRAMES];
    tracker.follow([&nothing, &nothing], Ends::Closed, &mut codes, &mut Control::none()).expect("it is not stopped");
    assert_eq!(codes, [0; FRAMES]);
    // With a wave only in the last frame, all frames have the phase for it.
    let mut pull = [0.0; FRAMES];
    pull[FRAMES - 1] = -1.0;
    tracker.follow([&pull, &nothing], Ends::Open, &mut codes, &mut Control::none()).expect("it is not stopped");
    assert_eq!(codes, [128; FRAMES]);
}
