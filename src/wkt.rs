//! The few things that file headers and map legends need from a coordinate reference system's well-known text.
//!
//! This is no parser of the whole language: it walks over the bracketed elements of WKT 1 and WKT 2 and picks the
//! horizontal system, its name, its code and its unit. Whatever it cannot find is `None`.

use std::borrow::Cow;

/// What the coordinates of a horizontal system are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Plane coordinates.
    Projected,
    /// Longitude and latitude.
    Geographic,
}

const PROJECTED: [&str; 3] = ["PROJCS", "PROJCRS", "PROJECTEDCRS"];
const GEOGRAPHIC: [&str; 5] = ["GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS"];

/// An element `KEYWORD[...]`: how deep it lies, its keyword, and where its content starts.
struct Element<'a> {
    depth: usize,
    keyword: &'a str,
    start: usize,
    content: usize,
}

/// All elements in the order of the text. Brackets inside quotes are text.
fn elements(wkt: &str) -> Vec<Element<'_>> {
    let bytes = wkt.as_bytes();
    let (mut depth, mut quoted, mut found) = (0_usize, false, Vec::new());
    for (at, &byte) in bytes.iter().enumerate() {
        match byte {
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b'[' | b'(' => {
                let word = bytes[..at].iter().rev().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count();
                found.push(Element { depth, keyword: &wkt[at - word..at], start: at - word, content: at + 1 });
                depth += 1;
            }
            b']' | b')' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    found
}

/// The text of the element that starts at `start`, to its closing bracket.
fn balanced(wkt: &str, start: usize) -> &str {
    let (mut depth, mut quoted) = (0_usize, false);
    for (at, byte) in wkt.bytes().enumerate().skip(start) {
        match byte {
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b'[' | b'(' => depth += 1,
            b']' | b')' => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    return &wkt[start..=at];
                }
            }
            _ => {}
        }
    }
    &wkt[start..]
}

/// The horizontal system inside `wkt`: itself, or the part of a compound or bound system that is one.
///
/// A projected system holds a geographic one, so projected ones are looked for first.
pub(crate) fn horizontal(wkt: &str) -> Option<(Kind, &str)> {
    let all = elements(wkt);
    let find = |words: &[&str]| all.iter().find(|e| words.iter().any(|w| e.keyword.eq_ignore_ascii_case(w)));
    match find(&PROJECTED) {
        Some(element) => Some((Kind::Projected, balanced(wkt, element.start))),
        None => find(&GEOGRAPHIC).map(|element| (Kind::Geographic, balanced(wkt, element.start))),
    }
}

/// The first quoted text from `start` on.
fn quoted(wkt: &str, start: usize) -> Option<&str> {
    let mut parts = wkt.get(start..)?.split('"');
    parts.next()?;
    parts.next().map(str::trim).filter(|text| !text.is_empty())
}

/// The name of the horizontal system, such as `JGD2011 / UTM zone 53N`.
pub(crate) fn name(wkt: &str) -> Option<&str> {
    quoted(horizontal(wkt)?.1, 0)
}

/// The EPSG code that the horizontal system names for itself.
pub(crate) fn epsg(wkt: &str) -> Option<u32> {
    let (_, text) = horizontal(wkt)?;
    let own = elements(text).into_iter().rfind(|e| {
        e.depth == 1 && (e.keyword.eq_ignore_ascii_case("AUTHORITY") || e.keyword.eq_ignore_ascii_case("ID"))
    })?;
    let (authority, code) = balanced(text, own.start).get(own.content - own.start..)?.split_once(',')?;
    if !authority.trim().trim_matches('"').eq_ignore_ascii_case("EPSG") {
        return None;
    }
    let code = code.trim().trim_start_matches('"');
    code[..code.bytes().take_while(u8::is_ascii_digit).count()].parse().ok()
}

/// The text without `TOWGS84[...]` where the system has an EPSG code.
///
/// One of several datum shifts in the text makes programs take the system for another one than the code names.
pub(crate) fn without_shift(wkt: &str) -> Cow<'_, str> {
    if epsg(wkt).is_none() {
        return Cow::Borrowed(wkt);
    }
    let (mut text, mut done) = (String::with_capacity(wkt.len()), 0);
    for shift in elements(wkt).iter().filter(|e| e.keyword == "TOWGS84") {
        text.push_str(wkt.get(done..shift.start).unwrap_or_default().trim_end_matches(','));
        done = shift.start + balanced(wkt, shift.start).len();
    }
    text.push_str(&wkt[done..]);
    Cow::Owned(text)
}

/// The unit of the plane coordinates: its name and its length in metres. `None` for degrees.
pub(crate) fn linear_unit(wkt: &str) -> Option<(&str, f64)> {
    let (Kind::Projected, text) = horizontal(wkt)? else { return None };
    // WKT 1 has the unit as a child of the system; WKT 2 has it there too or in every axis.
    let unit = elements(text).into_iter().rfind(|e| {
        (e.depth == 1 && e.keyword.eq_ignore_ascii_case("UNIT")) || e.keyword.eq_ignore_ascii_case("LENGTHUNIT")
    })?;
    let name = quoted(text, unit.content)?;
    let number = text.get(unit.content..)?.split([',', ']', ')']).nth(1)?.trim();
    number.parse().ok().filter(|factor: &f64| factor.is_finite() && *factor > 0.0).map(|factor| (name, factor))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UTM: &str = crs_definitions::EPSG_6690.wkt;

    #[test]
    fn a_projected_system_is_told_from_the_geographic_one_inside_it() {
        let (kind, text) = horizontal(UTM).unwrap();
        assert_eq!(kind, Kind::Projected);
        assert_eq!(text, UTM);
        assert_eq!(name(UTM), Some("JGD2011 / UTM zone 53N"));
        assert_eq!(epsg(UTM), Some(6690));
        assert_eq!(linear_unit(UTM), Some(("metre", 1.0)));
        let degrees = crs_definitions::EPSG_4326.wkt;
        assert_eq!(horizontal(degrees).unwrap().0, Kind::Geographic);
        assert_eq!(epsg(degrees), Some(4326));
        assert_eq!(linear_unit(degrees), None);
    }

    #[test]
    fn a_compound_system_gives_its_horizontal_part() {
        let compound =
            format!("COMPD_CS[\"both [1]\",{UTM},VERT_CS[\"height\",UNIT[\"metre\",1]],AUTHORITY[\"EPSG\",\"99999\"]]");
        assert_eq!(horizontal(&compound).unwrap().1, UTM);
        assert_eq!(epsg(&compound), Some(6690));
    }

    #[test]
    fn wkt_2_is_read_as_well() {
        let text = "PROJCRS[\"plan\",BASEGEOGCRS[\"base\",ID[\"EPSG\",4326]],CONVERSION[\"c\"],CS[Cartesian,2],\
                    AXIS[\"e\",east,LENGTHUNIT[\"US survey foot\",0.304800609601219]],ID[\"EPSG\",2225]]";
        assert_eq!(epsg(text), Some(2225));
        assert_eq!(name(text), Some("plan"));
        assert_eq!(linear_unit(text), Some(("US survey foot", 0.304800609601219)));
    }

    #[test]
    fn the_shift_goes_where_a_code_tells_the_system() {
        let text = "PROJCS[\"p\",GEOGCS[\"g\",DATUM[\"d\",TOWGS84[1,2,3]]],AUTHORITY[\"EPSG\",\"31287\"]]";
        assert_eq!(without_shift(text), text.replace(",TOWGS84[1,2,3]", ""));
        let own = "PROJCS[\"p\",GEOGCS[\"g\",DATUM[\"d\",TOWGS84[1,2,3]]]]";
        assert_eq!(without_shift(own), own);
    }

    #[test]
    fn nonsense_gives_nothing() {
        for text in
            ["", "]", "[[[", "PROJCS", "PROJCS[", "PROJCS[\"", "ENGCRS[\"site\"]", "PROJCS[\"é[\",ID[EPSG", "é[é]"]
        {
            assert_eq!(epsg(text), None, "{text}");
            assert_eq!(linear_unit(text), None, "{text}");
        }
    }
}
