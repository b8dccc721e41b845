//! Archives with a shapefile or a KML: contours, spot heights, areas and water.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    tokosen_fuzz::vectors(data, "zip");
    tokosen_fuzz::vectors(data, "kmz");
});
