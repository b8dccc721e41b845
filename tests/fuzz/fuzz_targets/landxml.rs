//! Contours, spot heights, areas, break lines and triangles of a LandXML file.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    tokosen_fuzz::vectors(data, "xml");
    tokosen_fuzz::heights(data, "xml");
});
