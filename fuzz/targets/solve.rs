//! See `midair_fuzz::solve`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| midair_fuzz::solve::check(bytes));
