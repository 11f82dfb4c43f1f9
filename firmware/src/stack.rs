//! Stack: how much of it was used, by the paint that the start-up code left there.

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    static mut _stack_start: u32;
    static mut _stack_end: u32;
}

/// The most bytes that were in use.
#[must_use]
pub fn most() -> usize {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let mut at = end;
    // SAFETY: all words between the two symbols of the linker are memory that only the stack uses; volatile, for the
    // compiler does not know of the paint.
    while at < start && unsafe { at.read_volatile() } == STACK_PAINT_VALUE {
        // SAFETY: below the start.
        at = unsafe { at.add(1) };
    }
    start as usize - at as usize
}
