//! Measures the solver `greedy`.
#![no_std]
#![no_main]

use midair::solvers::Greedy;
use midair_firmware::measured::{end, run};

#[cortex_m_rt::entry]
fn main() -> ! {
    end(run(Greedy::default()))
}
