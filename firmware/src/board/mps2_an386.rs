//! UART 0 of the MPS2 with AN386, a CMSDK APB UART (Cortex-M System Design Kit, DDI 0479, section 4.3).

const BASE: usize = 0x4000_4000;
const DATA: *mut u32 = BASE as *mut u32;
const STATE: *const u32 = (BASE + 0x4) as *const u32;
const CONTROL: *mut u32 = (BASE + 0x8) as *mut u32;
const DIVISOR: *mut u32 = (BASE + 0x10) as *mut u32;

const FULL: u32 = 1;
const SEND: u32 = 1;
const CLOCK: u32 = 25_000_000;

/// The serial line to the array's board.
#[derive(Debug)]
pub struct Uart(());

impl Uart {
    /// Switches the UART on, at this baud rate.
    pub fn new(baud: u32) -> Self {
        // SAFETY: these are registers of the UART, which no other code uses.
        unsafe {
            DIVISOR.write_volatile(CLOCK / baud);
            CONTROL.write_volatile(SEND);
        }
        Self(())
    }

    /// Sends bytes, and waits until the UART takes each.
    pub fn send(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            // SAFETY: these are registers of the UART, which no other code uses.
            unsafe {
                while STATE.read_volatile() & FULL != 0 {}
                DATA.write_volatile(byte.into());
            }
        }
    }
}
