//! From contours to lines, heights and a mesh.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tokosen_fuzz::pipeline::run(data));
