//! Clock: the processor's SysTick, a counter of 24 bits that counts down.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

const TOP: u32 = 0x00ff_ffff;

/// A running clock.
pub struct Clock(SYST);

impl Clock {
    /// The number of units of [`Clock::now`] in a tick.
    pub const PARTS: u32 = 1 << 8;

    /// Starts the clock.
    pub fn new(mut register: SYST) -> Self {
        register.set_clock_source(SystClkSource::Core);
        register.set_reload(TOP);
        register.clear_current();
        register.enable_counter();
        Self(register)
    }

    /// Returns the time in 1/256 of a tick. So the 24 bits of the counter become 32 bits, and the time overflows as a u32 does.
    pub fn now(&self) -> u32 {
        let _ = &self.0;
        (TOP - SYST::get_current()) * Self::PARTS
    }

    /// Returns the ticks that `work` took, up to 2^24, and its result.
    pub fn ticks<R>(&self, work: impl FnOnce() -> R) -> (u32, R) {
        let _ = &self.0;
        let start = SYST::get_current();
        let result = work();
        (start.wrapping_sub(SYST::get_current()) & TOP, result)
    }
}
