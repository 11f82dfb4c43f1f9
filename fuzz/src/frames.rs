//! Frames of boards: any bytes are refused in one line or decode to a drive, which is encoded and decoded to the same.

use midair::{Board, Complex32};

use crate::{Draw, one_line};

/// Check what the bytes make.
pub fn check(bytes: &[u8]) {
    let (head, frame) = bytes.split_at(bytes.len().min(4));
    let mut draw = Draw::new(head);
    let names: Vec<&str> = Board::names().collect();
    let (name, transducers) = (draw.one(&names), draw.whole(1, 520));
    let Some(board) = one_line(Board::new(name, transducers)) else { return };
    let mut drive = vec![Complex32::ZERO; transducers];
    // Of the bytes as they are, and of so many as a frame has.
    let mut whole = frame.to_vec();
    whole.resize(board.frame_size(), 0);
    for given in [frame, &whole] {
        if one_line(board.decode(given, &mut drive)).is_some() {
            assert!(drive.iter().all(|q| q.norm() <= 1.0 + 1e-6), "{name}: {drive:?}");
            let (mut again, mut sent) = (drive.clone(), vec![0; board.frame_size()]);
            one_line(board.encode(&drive, &mut sent)).expect("a drive of the board");
            one_line(board.decode(&sent, &mut again)).expect("a frame of the board");
            let off = drive.iter().zip(&again).map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
            assert!(off < 1e-5, "{name}: off by {off}");
        }
    }
    for bytes in [board.off_frame(), board.silence()] {
        assert!(!bytes.is_empty());
    }
    one_line(board.decode(&board.off_frame(), &mut drive)).expect("the off frame");
    assert!(drive.iter().all(|q| *q == Complex32::ZERO), "{name} plays when it is off");
}
