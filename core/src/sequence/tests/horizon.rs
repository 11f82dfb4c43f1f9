//! Tests of `Horizon` and `Tracks`: the same codes whatever is known, resumed or split; errors by frame; pressures below the targets.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use num_complex::{Complex32, Complex64};

use super::{Horizon, Table, Tracks};
use crate::control::Control;
use crate::device::quantization::Quantization;
use crate::kernels::InstructionSet;
use crate::propagation::Model;
use crate::scene::{Aim, Array, Medium};

const FRAMES: usize = 14;

fn tracks(board: Option<Quantization>) -> Tracks {
    let array = Array::grid(8, 8, 10e-3).expect("a grid").with_quantization(board);
    let model = Model::new(&array, Medium::default(), InstructionSet::best()).expect("a model");
    Tracks { model, change: PI / 16.0, aim: Aim::Target }
}

/// Two points that part at 2 m/s at 10 kHz.
fn points() -> Vec<[f64; 3]> {
    (0..FRAMES).flat_map(|t| [-1.0, 1.0].map(|side| [side * (0.01 + 2e-4 * t as f64), 0.0, 0.1])).collect()
}

/// Returns the codes of the frames that are left, up to `most`.
fn drained(horizon: &mut Horizon, read: &mut usize, most: usize) -> Vec<u16> {
    let (points, mut codes) = (points(), Vec::new());
    for _ in 0..most {
        while horizon.wanted() > 0 && *read < FRAMES {
            horizon.push(points[2 * *read..2 * *read + 2].to_vec(), vec![100.0, 50.0]);
            *read += 1;
        }
        codes.extend(horizon.advance(&mut Control::none()).expect("codes").unwrap_or_default());
    }
    codes
}

#[test]
fn all_in_sight_is_all_and_a_resumed_horizon_has_the_same_codes() {
    let (points, targets) = (points(), [100.0, 50.0].repeat(FRAMES));
    let table = Table { points: &points, targets: &targets, frames: FRAMES, first: 0 };
    let all = tracks(None).codes(table, false, None, &mut Control::none()).expect("codes");
    for ahead in [FRAMES, usize::MAX] {
        assert_eq!(drained(&mut Horizon::new(tracks(None), ahead), &mut 0, FRAMES + 2), all);
    }
    let (mut horizon, mut read) = (Horizon::new(tracks(None), 4), 0);
    let whole = drained(&mut Horizon::new(tracks(None), 4), &mut 0, FRAMES);
    let first = drained(&mut horizon, &mut read, 6);
    let (codes, decided) = horizon.state();
    let mut other = Horizon::new(tracks(None), 4);
    other.restore(6, codes.to_vec(), decided);
    assert_eq!([first, drained(&mut other, &mut 5, FRAMES)].concat(), whole);
    let steps = |a: u16, b: u16| a.abs_diff(b).min(256 - a.abs_diff(b));
    assert!(whole.iter().zip(&whole[64..]).all(|(&a, &b)| steps(a, b) <= 8));
}

#[test]
fn errors_name_the_frame_of_all_frames() {
    let tracks = tracks(None);
    let mut points = points();
    points[5] = tracks.model.array().positions()[7];
    let table = Table { points: &points, targets: &[1.0; 2 * FRAMES], frames: FRAMES, first: 30 };
    let error = tracks.codes(table, false, None, &mut Control::none()).expect_err("a point at a transducer");
    assert_eq!((error.index, error.item.as_str()), (Some(32), "points[32, 1]"), "{error}");
}

#[test]
fn no_pressure_is_above_its_target_and_silent_frames_are_silent() {
    let boards = [None, Some(Quantization::new(Some(32), Some(vec![0.25, 0.5, 1.0])).expect("a board"))];
    for board in boards {
        let (tracks, points) = (tracks(board), points());
        let mut targets = [30.0, 0.0].repeat(FRAMES);
        targets[8..12].fill(0.0);
        let table = Table { points: &points, targets: &targets, frames: FRAMES, first: 0 };
        let codes = tracks.codes(table, false, None, &mut Control::none()).expect("codes");
        let drives = tracks.drives(table, &codes, &mut Control::none()).expect("drives");
        let phases = tracks.phases();
        for (t, row) in drives.chunks(64).enumerate() {
            if (4..6).contains(&t) {
                assert!(row.iter().all(|&q| q == Complex32::ZERO));
                continue;
            }
            let propagation = tracks.model.propagation(&[points[2 * t]]).expect("a point");
            let full = |i: usize| Complex64::from_polar(1.0, TAU * f64::from(codes[64 * t + i]) / f64::from(phases));
            let loud = (0..64).map(|i| propagation.exact(0, i) * full(i)).sum::<Complex64>().norm();
            let most = (30.0 / loud).min(1.0);
            let table = tracks.model.array().quantization().and_then(Quantization::amplitudes);
            let part = table.map_or(most, |table| table.iter().copied().filter(|a| *a <= most).fold(0.0, f64::max));
            for (i, q) in row.iter().enumerate() {
                assert!((Complex64::new(q.re.into(), q.im.into()) - full(i) * part).norm() < 1e-6, "{t}, {i}");
            }
        }
    }
}
