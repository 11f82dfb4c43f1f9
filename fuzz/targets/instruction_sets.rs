//! See `midair_fuzz::instruction_sets`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| midair_fuzz::instruction_sets::check(bytes));
