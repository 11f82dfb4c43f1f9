//! See `midair_fuzz::sweep`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| midair_fuzz::sweep::check(bytes));
