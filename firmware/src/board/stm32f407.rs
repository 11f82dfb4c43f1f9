//! USART 2 of an STM32F407, which sends at pin PA2, with the clock that runs after reset (RM0090, sections 7, 8 and
//! 30).

const CLOCK: u32 = 16_000_000;

const CLOCK_OF_PORTS: *mut u32 = 0x4002_3830 as *mut u32;
const CLOCK_OF_USARTS: *mut u32 = 0x4002_3840 as *mut u32;
const PORT_A_MODES: *mut u32 = 0x4002_0000 as *mut u32;
const PORT_A_FUNCTIONS: *mut u32 = 0x4002_0020 as *mut u32;
const STATE: *const u32 = 0x4000_4400 as *const u32;
const DATA: *mut u32 = 0x4000_4404 as *mut u32;
const DIVISOR: *mut u32 = 0x4000_4408 as *mut u32;
const CONTROL: *mut u32 = 0x4000_440c as *mut u32;

const PORT_A: u32 = 1;
const USART_2: u32 = 1 << 17;
/// Sets pin 2 to an alternate function.
const ALTERNATE: u32 = 0b10 << 4;
/// Selects alternate function 7 for pin 2: the USART.
const FUNCTION_7: u32 = 7 << 8;
const ON_AND_SEND: u32 = 1 << 13 | 1 << 3;
const EMPTY: u32 = 1 << 7;

/// The serial line to the array's board.
#[derive(Debug)]
pub struct Uart(());

impl Uart {
    /// Switches the USART on, at this baud rate.
    pub fn new(baud: u32) -> Self {
        let set = |register: *mut u32, mask: u32, bits: u32| {
            // SAFETY: these are registers of clocks, pin and USART, which no other code uses.
            unsafe { register.write_volatile(register.read_volatile() & !mask | bits) };
        };
        set(CLOCK_OF_PORTS, 0, PORT_A);
        set(CLOCK_OF_USARTS, 0, USART_2);
        set(PORT_A_MODES, 0b11 << 4, ALTERNATE);
        set(PORT_A_FUNCTIONS, 0b1111 << 8, FUNCTION_7);
        set(DIVISOR, u32::MAX, (CLOCK + baud / 2) / baud);
        set(CONTROL, u32::MAX, ON_AND_SEND);
        Self(())
    }

    /// Sends bytes, and waits until the USART takes each.
    pub fn send(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            // SAFETY: these are registers of the USART, which no other code uses.
            unsafe {
                while STATE.read_volatile() & EMPTY == 0 {}
                DATA.write_volatile(byte.into());
            }
        }
    }
}
