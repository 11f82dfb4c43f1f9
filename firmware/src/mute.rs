//! Mute: silences a board after some time without points, and lets it play again with the next ones.
//!
//! Boards play their last frame for ever. A microcontroller that gets points over a line that may break calls
//! [`Mute::is_due`] whenever it looks for points. If that is true, the microcontroller sends
//! [`crate::player::Player::silence`].

/// A timeout for a source of points, in ticks of a clock that counts up to u32::MAX and then from 0 again.
#[derive(Clone, Copy, Debug)]
pub struct Mute {
    patience: u32,
    received: u32,
    silent: bool,
}

impl Mute {
    /// Returns a timer for a silent board, which may play for `patience` ticks, fewer than 2^31, without a message.
    #[must_use]
    pub const fn new(patience: u32) -> Self {
        Self { patience, received: 0, silent: true }
    }

    /// Records that points arrived, or a message that the points stay the same.
    pub const fn hear(&mut self, now: u32) {
        (self.received, self.silent) = (now, false);
    }

    /// Returns whether to silence the board now: true once, until points arrive again. Call it at least every 2^31
    /// ticks.
    pub const fn is_due(&mut self, now: u32) -> bool {
        let due = !self.silent && now.wrapping_sub(self.received) >= self.patience;
        self.silent |= due;
        due
    }
}

#[cfg(test)]
mod tests {
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
}
