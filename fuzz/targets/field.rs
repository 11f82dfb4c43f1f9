//! See `midair_fuzz::field`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| midair_fuzz::field::check(bytes));
