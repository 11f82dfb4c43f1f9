//! Stack: measures its use by the pattern with which the start-up code has filled it.

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    static mut _stack_start: u32;
    static mut _stack_end: u32;
}

/// Returns the largest number of bytes that were in use.
pub fn most() -> usize {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let mut at = end;
    // SAFETY: all words between the two symbols of the linker are memory that only the stack uses. The read is
    // volatile, because the compiler does not know that the words were filled.
    while at < start && unsafe { at.read_volatile() } == STACK_PAINT_VALUE {
        // SAFETY: `at` is below `start`.
        at = unsafe { at.add(1) };
    }
    start as usize - at as usize
}
