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
#[path = "tests/mute.rs"]
mod tests;
