//! The height map in a .asc file.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tokosen_fuzz::heights(data, "asc"));
