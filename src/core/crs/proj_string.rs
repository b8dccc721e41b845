//! Systems named by PROJ strings, such as `+proj=utm +zone=33 +datum=WGS84`: the entry of the built-in table with the same
//! parameters.

use std::collections::BTreeMap;

use super::definition::{Definition, label};
use super::system::{Crs, definition};

/// Parameters that say nothing about coordinates, or only what is meant without them.
const SILENT: [&str; 7] = ["no_defs", "type", "wktext", "title", "over", "units=m", "k=1"];
/// Largest relative difference between equal numbers.
const ROUNDING: f64 = 1e-9;
/// Codes that a message names.
const NAMED: usize = 4;

/// Whether a text is a PROJ string.
pub(super) fn is_proj(text: &str) -> bool {
    let text = text.trim_start();
    text.starts_with("+proj=") || text.starts_with("+init=") || text.starts_with("proj=")
}

/// The system of a PROJ string.
///
/// # Errors
/// A sentence if no entry of the table has these parameters, or if entries of several datums have them.
pub(super) fn from_proj(text: &str) -> Result<Crs, String> {
    let wanted = parameters(text);
    if let Some(code) = wanted.get("init").and_then(|init| init.to_lowercase().strip_prefix("epsg:")?.parse().ok()) {
        return Ok(Crs::from_epsg(code));
    }
    let equal = |code: &u32| {
        let is_first = |proj4: &str| proj4.starts_with(&format!("+proj={} ", wanted.get("proj").map_or("", |p| p)));
        definition(*code).is_some_and(|entry| is_first(entry.proj4) && are_equal(&parameters(entry.proj4), &wanted))
    };
    let found: Vec<Crs> = (1..=u32::from(u16::MAX)).filter(equal).map(Crs::from_epsg).collect();
    let datum = |crs: &Crs| Definition::of(crs).ok().and_then(|definition| definition.datum);
    let Some(first) = found.first() else {
        return Err("no entry of the built-in table has these parameters; give an EPSG code or a WKT".into());
    };
    if found.iter().any(|crs| datum(crs) != datum(first)) {
        let names: Vec<String> = found.iter().take(NAMED).map(label).collect();
        return Err(format!("several systems have these parameters; give the code of one: {}", names.join(", ")));
    }
    Ok(first.clone())
}

/// The parameters that decide about coordinates. Flags have an empty value.
fn parameters(text: &str) -> BTreeMap<String, String> {
    let words = text.split_whitespace().map(|word| word.trim_start_matches('+'));
    let split = |word: &str| match word.split_once('=') {
        Some((name, value)) => (name.to_owned(), value.to_owned()),
        None => (word.to_owned(), String::new()),
    };
    let mut found: BTreeMap<String, String> = words
        .filter(|word| !SILENT.contains(word) && !SILENT.contains(&word.split('=').next().unwrap_or_default()))
        .map(split)
        .collect();
    if let Some(scale) = found.remove("k_0") {
        found.insert("k".into(), scale);
    }
    if found.get("k").and_then(|k| k.parse().ok()) == Some(1.0_f64) {
        found.remove("k");
    }
    for name in ["x_0", "y_0", "lon_0", "lat_0"] {
        if found.get(name).and_then(|value| value.parse().ok()) == Some(0.0_f64) {
            found.remove(name);
        }
    }
    found
}

fn are_equal(a: &BTreeMap<String, String>, b: &BTreeMap<String, String>) -> bool {
    let is_equal = |a: &str, b: &str| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= ROUNDING * a.abs().max(b.abs()),
        _ => a.eq_ignore_ascii_case(b),
    };
    a.len() == b.len() && a.iter().all(|(name, value)| b.get(name).is_some_and(|other| is_equal(value, other)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_are_found_in_the_table() {
        let code = |text: &str| from_proj(text).map(|crs| crs.epsg);
        assert_eq!(code("+proj=longlat +datum=WGS84 +no_defs"), Ok(Some(4326)));
        assert_eq!(code("+proj=utm +zone=54 +datum=WGS84 +units=m +no_defs +type=crs"), Ok(Some(32654)));
        assert_eq!(code("+datum=WGS84 +zone=16 +proj=utm"), Ok(Some(32616)));
        assert_eq!(code("+init=epsg:6677"), Ok(Some(6677)));
        assert!(
            code("+proj=utm +zone=33 +ellps=GRS80 +towgs84=0,0,0,0,0,0,0 +units=m").is_err_and(|e| e.contains("EPSG:"))
        );
        assert!(code("+proj=ortho +lat_0=12.3 +lon_0=4.5").is_err_and(|e| e.contains("WKT")));
        assert!(is_proj("+proj=longlat") && !is_proj("EPSG:4326") && !is_proj("PROJCS[\"a\"]"));
    }
}
