//! Measures the solver `uniform`.
#![no_std]
#![no_main]

use midair::solvers::Uniform;
use midair_firmware::measured::{end, run};

#[cortex_m_rt::entry]
fn main() -> ! {
    end(run(Uniform::default()))
}
