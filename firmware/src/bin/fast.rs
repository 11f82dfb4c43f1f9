//! Measures the solver `fast`.
#![no_std]
#![no_main]

use midair::solvers::Fast;
use midair_firmware::measured::{end, run};

#[cortex_m_rt::entry]
fn main() -> ! {
    end(run(Fast::default()))
}
