//! The map page: one HTML file that shows the sets of tiles beside it in a browser.
//!
//! The page has its libraries in it: MapLibre GL draws the map, and the library of PMTiles reads archives
//! (`vendor`, which `scripts/make/make_viewer_libraries.py` fetches). It asks nothing of other servers, and a policy in the page
//! makes the browser refuse it. What the page knows of its sets are their names; the rest is read from the tiles, so that a set
//! can be replaced without a new page.
//!
//! The scripts stand one behind the other, each with one concept: what the page says (`words.js`), the sets and what can be wrong
//! with them (`sets.js`), heights at places (`heights.js`), sources and layers (`map.js`), switches (`panel.js`).

use maud::html;
use serde_json::json;

use crate::page::Page;

const STYLES: [&str; 2] = [include_str!("vendor/maplibre-gl.css"), include_str!("viewer.css")];
const LIBRARIES: [&str; 2] = [include_str!("vendor/maplibre-gl.js"), include_str!("vendor/pmtiles.js")];
const LICENCES: &str = include_str!("vendor/LICENSES.txt");
const SCRIPTS: [&str; 6] = [
    include_str!("words.js"),
    include_str!("sets.js"),
    include_str!("heights.js"),
    include_str!("map.js"),
    include_str!("panel.js"),
    include_str!("main.js"),
];

/// What the browser may load: what is in the page, and what comes from the page's own server. MapLibre GL starts its worker from
/// a blob.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; worker-src blob:; \
                      connect-src 'self'; img-src 'self' data: blob:; base-uri 'none'; form-action 'none'";

/// A set of tiles beside the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ViewedSet {
    /// The name of its archive or folder.
    pub name: String,
    /// The extension of the tiles, if it is a folder.
    pub extension: Option<String>,
}

/// The page as HTML, with a title. Of each kind of sets, the page first shows the first one.
pub fn viewer_page(title: &str, sets: &[ViewedSet]) -> String {
    let sets: Vec<_> = sets.iter().map(|set| json!({ "name": set.name, "extension": set.extension })).collect();
    Page {
        title,
        policy: POLICY,
        styles: &STYLES,
        body: html! { div id="map" {} },
        licences: LICENCES,
        data: &json!({ "title": title, "sets": sets }),
        libraries: &LIBRARIES,
        scripts: &SCRIPTS,
    }
    .html()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_the_page_stay_whole() {
        for part in LIBRARIES.iter().chain(&SCRIPTS).chain(&STYLES).chain([&LICENCES]) {
            for end in ["</script", "</style", "<!--", "sourceMappingURL"] {
                assert!(!part.contains(end), "{end}");
            }
        }
    }

    #[test]
    fn both_languages_say_the_same_things() {
        let words = SCRIPTS[0];
        let keys = |name: &str| -> Vec<String> {
            let object = words.split(&format!("const {name} = {{\n")).nth(1).and_then(|rest| rest.split("\n};").next());
            let lines = object.unwrap().lines().filter(|line| line.starts_with("  ") && !line.starts_with("    "));
            lines.filter_map(|line| Some(line.trim().split_once(':')?.0.to_owned())).collect()
        };
        assert!(keys("ENGLISH").len() > 25);
        assert_eq!(keys("ENGLISH"), keys("JAPANESE"));
    }
}
