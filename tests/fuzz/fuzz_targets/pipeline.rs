//! From contours to lines, heights and a mesh.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = tokosen_fuzz::pipeline::run(data);
});
