#![doc = include_str!("rustdoc_links.md")]
#![doc = include_str!("README.md")]

// The pages are Markdown files that also read well in the repository. There, links lead from file to file; here, the same
// links must lead from module to module. Markdown takes the first of two definitions of a link. So rustdoc_links.md, with
// the modules, comes before each page, and the page ends with the files.

/// Declares one module per page.
macro_rules! pages {
    ($($page:ident = $file:literal,)+) => {$(
        #[doc = include_str!("rustdoc_links.md")]
        #[doc = include_str!($file)]
        pub mod $page {}
    )+};
}

pages! {
    everyday = "everyday.md",
    denser_contours = "denser_contours.md",
    height_maps = "height_maps.md",
    height_map_contours = "height_map_contours.md",
    contours_for_a_map = "contours_for_a_map.md",
    bands = "bands.md",
    coordinates = "coordinates.md",
    height_systems = "height_systems.md",
    base_map = "base_map.md",
    checking = "checking.md",
    when_a_map_looks_wrong = "when_a_map_looks_wrong.md",
    uncertainty = "uncertainty.md",
    comparing = "comparing.md",
    countries = "countries.md",
    profiles_volumes = "profiles_volumes.md",
    map_tiles = "map_tiles.md",
    slope = "slope.md",
    flow = "flow.md",
    models = "models.md",
    subdomains = "subdomains.md",
    water = "water.md",
    streams = "streams.md",
    break_lines = "break_lines.md",
    pits = "pits.md",
    pictures = "pictures.md",
    qgis = "qgis.md",
    formats = "formats.md",
    options = "options.md",
    method = "method.md",
    accuracy = "accuracy.md",
    speed = "speed.md",
    limits = "limits.md",
    library = "library.md",
    python = "python.md",
    tuning = "tuning.md",
    development = "development.md",
}
