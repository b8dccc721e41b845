//! Contours, spot heights, areas and water of a table with well-known text or coordinates.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tokosen_fuzz::vectors(data, "csv"));
