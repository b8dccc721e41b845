//! A document of 基盤地図情報: contours, spot heights, water or a height map.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    tokosen_fuzz::vectors(data, "xml");
    tokosen_fuzz::heights(data, "xml");
});
