//! Measures the solver `naive`.
#![no_std]
#![no_main]

use midair::solvers::Naive;
use midair_firmware::measured::{end, run};

#[cortex_m_rt::entry]
fn main() -> ! {
    end(run(Naive::default()))
}
