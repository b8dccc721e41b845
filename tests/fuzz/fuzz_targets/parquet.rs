//! Contours, spot heights, areas and water of a .parquet file.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tokosen_fuzz::vectors(data, "parquet"));
