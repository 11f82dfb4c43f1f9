//! Tests the frames of boards: any bytes give an error of one line or a drive, which is encoded and decoded to the same drive.

use midair::{Board, Complex32};

use crate::{Draw, one_line};

/// Runs the test that the bytes describe.
pub fn check(bytes: &[u8]) {
    let (head, frame) = bytes.split_at(bytes.len().min(5));
    let mut draw = Draw::new(head);
    let names: Vec<&str> = Board::names().collect();
    let (name, whole) = (draw.one(&names), draw.flag());
    // Mostly few transducers, so that inputs are fast. Half of the frames have the right number of bytes.
    let most = draw.one(&[8, 16, 64, 520]);
    let transducers = draw.whole(1, most);
    let Some(board) = one_line(Board::new(name, transducers)) else { return };
    let mut drive = vec![Complex32::ZERO; transducers];
    if frame.is_empty() {
        check_off(&board, &mut drive);
    }
    let mut frame = frame.to_vec();
    if whole {
        frame.resize(board.frame_size(), 0);
    }
    if one_line(board.decode(&frame, &mut drive)).is_some() {
        assert!(drive.iter().all(|q| q.norm() <= 1.0 + 1e-6), "{name}: {drive:?}");
        let (mut again, mut sent) = (drive.clone(), vec![0; board.frame_size()]);
        one_line(board.encode(&drive, &mut sent)).expect("a drive of the board");
        one_line(board.decode(&sent, &mut again)).expect("a frame of the board");
        let off = drive.iter().zip(&again).map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
        // On the board homies a word begins and ends with fixed bytes. A phase whose code is one of these two bytes is
        // replaced by a neighbour, one step away.
        let step = if name == "homies" { std::f32::consts::TAU / 256.0 } else { 0.0 };
        assert!(off < step + 1e-5, "{name}: off by {off}");
        let mut once_more = vec![0; board.frame_size()];
        one_line(board.encode(&again, &mut once_more)).expect("a drive of the board");
        assert_eq!(sent, once_more, "{name}");
    }
}

/// Checks that the frame that switches a board off does so.
fn check_off(board: &Board, drive: &mut [Complex32]) {
    assert!(!board.silence().is_empty());
    one_line(board.decode(&board.off_frame(), drive)).expect("the off frame");
    assert!(drive.iter().all(|q| *q == Complex32::ZERO), "{} plays when it is off", board.name());
}
