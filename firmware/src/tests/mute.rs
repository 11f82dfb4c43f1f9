//! Tests of the silence after the last message.

use alloc::vec;
use alloc::vec::Vec;

use midair::Complex32;
use midair::solvers::Fast;

use super::*;
use crate::player::{Player, array};

#[test]
fn silence_is_due_once_after_the_last_word_and_again_after_the_next() {
    for begin in [0_u32, u32::MAX - 300] {
        let at = |k: u32| begin.wrapping_add(k);
        let mut mute = Mute::new(250);
        // No frame plays yet.
        assert!(!mute.is_due(at(1_000_000)));
        mute.hear(at(0));
        mute.hear(at(200));
        assert!(!mute.is_due(at(449)));
        assert!(mute.is_due(at(450)));
        assert!(!mute.is_due(at(451)));
        assert!(!mute.is_due(at(1_000_000_000)));
        mute.hear(at(1_000_000_100));
        assert!(!mute.is_due(at(1_000_000_349)));
        assert!(mute.is_due(at(1_000_000_350)));
    }
}

#[test]
fn a_board_whose_line_breaks_is_off_after_a_quarter_of_a_second_and_plays_again() {
    let array = array("sonicsurface").unwrap();
    let board = array.board("sonicsurface").unwrap();
    let mut player = Player::new(&array, "sonicsurface", 1, Fast::default()).unwrap();
    let mut mute = Mute::new(250);
    // Points come every 40 ms, except for a second in the middle; the timer is checked every ms.
    let (mut emits, mut frame) = (false, 0);
    let mut played = vec![Complex32::ZERO; board.len()];
    let mut changes = Vec::new();
    for now in 0..3000 {
        let mut bytes = Vec::new();
        if now % 40 == 0 && !(1000..2000).contains(&now) {
            mute.hear(now);
            player.turn(frame).unwrap();
            player.solve().unwrap();
            bytes.extend_from_slice(player.encode().unwrap());
            frame += 1;
        } else if mute.is_due(now) {
            bytes = player.silence();
        }
        if let Some(last) = bytes.len().checked_sub(board.frame_size()).filter(|_| !bytes.is_empty()) {
            board.decode(&bytes[last..], &mut played).unwrap();
            let on = played.iter().any(|&q| q != Complex32::ZERO);
            changes.extend((on != emits).then_some((now, on)));
            emits = on;
        }
    }
    assert_eq!(changes, [(0, true), (960 + 250, false), (2000, true)]);
}
