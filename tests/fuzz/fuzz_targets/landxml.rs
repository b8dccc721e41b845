//! Contours, spot heights, areas and break lines of a LandXML file.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tokosen_fuzz::vectors(data, "xml"));
