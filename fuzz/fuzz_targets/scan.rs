#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| robotc_fuzz::run("scan", bytes));
