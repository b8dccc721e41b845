//! The height map in a .xyz file.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tokosen_fuzz::heights(data, "xyz"));
