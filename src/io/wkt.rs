//! Geometries as well-known text, such as `LINESTRING Z (0 0 5, 1 0 5)`, in a column of a table.
//!
//! The text is read in one pass and without recursion: a keyword says what the groups of numbers after it are. The forms of
//! OGC and ISO are read, and `SRID=…;` before the text as PostGIS writes it.

use glam::DVec2;

use super::table::{Feature, NO_GEOMETRY, Spot, Table};

/// The largest depth of brackets. A polygon in a collection in a collection needs five.
const MAX_DEPTH: usize = 16;

/// What the positions of a geometry are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Points,
    Lines,
    /// Polygons that end where this depth of brackets ends.
    Polygons(usize),
    Collection,
    /// Curves and surfaces that are not read.
    Other,
}

/// The number before a text, if there is one, and the text.
pub(super) fn srid(text: &str) -> (Option<u32>, &str) {
    let text = text.trim();
    let part = text.split_once(';').filter(|(part, _)| part.len() > 5 && part[..5].eq_ignore_ascii_case("SRID="));
    part.map_or((None, text), |(part, rest)| (part[5..].trim().parse().ok().filter(|&code| code > 0), rest))
}

/// The kind of a keyword in capitals at this depth of brackets, and the name for what is left out.
fn kind_of(word: &str, depth: usize) -> Option<(Kind, &'static str)> {
    let bare = word.strip_suffix("ZM").or(word.strip_suffix('Z')).or(word.strip_suffix('M')).unwrap_or(word);
    Some(match bare {
        "POINT" | "MULTIPOINT" => (Kind::Points, "Point"),
        // Arcs in a curve have a keyword of their own.
        "LINESTRING" | "MULTILINESTRING" | "MULTICURVE" => (Kind::Lines, "LineString"),
        "POLYGON" => (Kind::Polygons(depth), "Polygon"),
        "MULTIPOLYGON" => (Kind::Polygons(depth + 1), "Polygon"),
        "GEOMETRYCOLLECTION" => (Kind::Collection, "GeometryCollection"),
        "CIRCULARSTRING" => (Kind::Other, "CircularString"),
        "COMPOUNDCURVE" => (Kind::Other, "CompoundCurve"),
        "CURVEPOLYGON" | "MULTISURFACE" => (Kind::Other, "CurvePolygon"),
        "TRIANGLE" => (Kind::Other, "Triangle"),
        "TIN" => (Kind::Other, "TIN"),
        "POLYHEDRALSURFACE" => (Kind::Other, "PolyhedralSurface"),
        _ => return None,
    })
}

/// A geometry that is read.
struct Reading<'a> {
    feature: &'a mut Feature,
    table: &'a mut Table,
    kind: (Kind, &'static str),
    /// Whether the third number is a measure, not a height.
    measured: bool,
    numbers: Vec<f64>,
    points: Vec<DVec2>,
    z: Vec<f64>,
    rings: Vec<Vec<DVec2>>,
    is_empty: bool,
}

/// Adds the geometry of a text to a feature.
///
/// # Errors
/// What is wrong with the text: the end of a sentence about it.
pub(super) fn add(text: &str, feature: &mut Feature, table: &mut Table) -> Result<(), String> {
    let mut reading = Reading {
        feature,
        table,
        kind: (Kind::Collection, ""),
        measured: false,
        numbers: Vec::new(),
        points: Vec::new(),
        z: Vec::new(),
        rings: Vec::new(),
        is_empty: true,
    };
    let (mut depth, mut rest) = (0_usize, srid(text).1.trim());
    while let Some(first) = rest.chars().next() {
        let after = &rest[first.len_utf8()..];
        match first {
            '(' => {
                depth += 1;
                if depth > MAX_DEPTH {
                    return Err("is nested too deep".into());
                }
                rest = after;
            }
            ')' => {
                depth = depth.checked_sub(1).ok_or("has a bracket too many")?;
                reading.end_group(depth)?;
                rest = after;
            }
            ',' => {
                reading.end_position()?;
                rest = after;
            }
            c if c.is_whitespace() => rest = after,
            c if c.is_ascii_alphabetic() && !is_number_word(rest) => {
                let length = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
                reading.word(&rest[..length].to_ascii_uppercase(), depth)?;
                rest = &rest[length..];
            }
            _ => {
                let length = rest.find(|c: char| c.is_whitespace() || "(),".contains(c)).unwrap_or(rest.len());
                let number = rest[..length]
                    .parse()
                    .map_err(|_| format!("holds {:?}, which is not a number", &rest[..length]))?;
                if reading.numbers.len() >= 4 {
                    return Err("has a position of more than four numbers".into());
                }
                reading.numbers.push(number);
                rest = &rest[length..];
            }
        }
    }
    if depth > 0 {
        return Err("is cut off".into());
    }
    if !reading.numbers.is_empty() || reading.kind.1.is_empty() {
        return Err("is not well-known text".into());
    }
    if reading.is_empty {
        table.leave_out(NO_GEOMETRY);
    }
    Ok(())
}

/// Whether letters begin a number: `nan`, `inf`.
fn is_number_word(rest: &str) -> bool {
    rest.get(..3).is_some_and(|start| start.eq_ignore_ascii_case("nan") || start.eq_ignore_ascii_case("inf"))
}

impl Reading<'_> {
    fn word(&mut self, word: &str, depth: usize) -> Result<(), String> {
        match word {
            "EMPTY" | "Z" | "ZM" => {}
            "M" => self.measured = true,
            _ => {
                let kind = kind_of(word, depth).ok_or_else(|| format!("holds the word {word:?}"))?;
                self.measured = word.ends_with('M') && !word.ends_with("ZM");
                self.kind = kind;
                let is_left_out = match kind.0 {
                    Kind::Polygons(_) => !self.table.wants_polygons,
                    Kind::Other => true,
                    _ => false,
                };
                if is_left_out {
                    self.table.leave_out(kind.1);
                    self.is_empty = false;
                }
            }
        }
        Ok(())
    }

    fn end_position(&mut self) -> Result<(), String> {
        match self.numbers[..] {
            [] => return Ok(()),
            [_] => return Err("has a position of one number".into()),
            [x, y] => self.push(x, y, f64::NAN),
            [x, y, _] if self.measured => self.push(x, y, f64::NAN),
            [x, y, z, ..] => self.push(x, y, z),
        }
        self.numbers.clear();
        Ok(())
    }

    fn push(&mut self, x: f64, y: f64, z: f64) {
        self.points.push(DVec2::new(x, y));
        self.z.push(z);
    }

    /// Ends a group of positions, or of groups, at the depth of brackets around it.
    fn end_group(&mut self, depth: usize) -> Result<(), String> {
        self.end_position()?;
        let (points, mut z) = (std::mem::take(&mut self.points), std::mem::take(&mut self.z));
        self.is_empty &= points.is_empty();
        if z.iter().all(|z| z.is_nan()) {
            z.clear();
        }
        match self.kind.0 {
            Kind::Points => {
                let z = |i: usize| z.get(i).copied().filter(|z| !z.is_nan());
                let spots = points.iter().enumerate().map(|(i, &place)| Spot { place, z: z(i) });
                self.feature.spots.extend(spots);
            }
            Kind::Lines => self.feature.push_line(points, &z),
            Kind::Polygons(end) if self.table.wants_polygons => {
                if !points.is_empty() {
                    self.feature.note_polygon_z(&z);
                    self.rings.push(points);
                }
                if depth == end && !self.rings.is_empty() {
                    self.feature.polygons.push(std::mem::take(&mut self.rings));
                }
            }
            Kind::Polygons(_) | Kind::Other => {}
            Kind::Collection if points.is_empty() => {}
            Kind::Collection => return Err("has positions without a type of geometry".into()),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokosen_core::features::Role;

    use crate::table::{Purpose, Request};

    fn read(text: &str, purpose: Purpose) -> Result<(Feature, Vec<String>), String> {
        let mut table =
            Table::new(&Request { elevation_field: None, layer: None, purpose, within: None, memory: None });
        let mut feature = Feature::default();
        add(text, &mut feature, &mut table)?;
        Ok((feature, table.left_out.into_keys().collect()))
    }

    fn lines(text: &str) -> Vec<(Vec<DVec2>, Option<[f64; 2]>)> {
        let (feature, _) = read(text, Purpose::Contours).expect("a geometry");
        feature.lines.into_iter().map(|line| (line.points, line.z)).collect()
    }

    #[test]
    fn lines_in_every_form() {
        let points = vec![DVec2::new(1.0, 2.0), DVec2::new(-3.5, 1e3)];
        let flat = vec![(points.clone(), None)];
        let high = vec![(points.clone(), Some([7.0, 7.0]))];
        assert_eq!(lines("LINESTRING (1 2, -3.5 1e3)"), flat);
        assert_eq!(lines("SRID=25832;MultiLineString((1 2,-3.5 1e3))"), flat);
        assert_eq!(lines("LINESTRING M (1 2 9, -3.5 1e3 8)"), flat);
        assert_eq!(lines("LINESTRING Z (1 2 7,-3.5 1e3 7)"), high);
        assert_eq!(lines("linestringzm(1 2 7 0,-3.5 1e3 7 1)"), high);
        assert_eq!(lines("LINESTRING(1 2 7,-3.5 1e3 7)"), high);
        assert_eq!(lines("GEOMETRYCOLLECTION (POINT (9 9), LINESTRING (1 2, -3.5 1e3))"), flat);
        assert_eq!(lines("MULTILINESTRING ((1 2, -3.5 1e3), EMPTY, (1 2, -3.5 1e3))").len(), 2);
        assert_eq!(srid(" srid=4326; POINT(1 2)").0, Some(4326));
    }

    #[test]
    fn points_polygons_and_what_is_left_out() {
        let (feature, _) = read("MULTIPOINT ((1 2), (3 4))", Purpose::Spots).expect("points");
        assert_eq!(feature.spots.len(), 2);
        let text = "MULTIPOLYGON (((0 0, 9 0, 9 9, 0 0), (5 1, 8 1, 8 2, 5 1)), ((20 0, 29 0, 29 9, 20 0)))";
        let (feature, _) = read(text, Purpose::Area).expect("polygons");
        assert_eq!(feature.polygons.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1]);
        let (feature, _) =
            read("POLYGON Z ((0 0 5, 9 0 5, 9 9 5, 0 0 5))", Purpose::Features(Role::Water)).expect("a polygon");
        assert_eq!((feature.polygons.len(), feature.polygon_z), (1, Some([5.0, 5.0])));
        let (feature, left_out) = read(text, Purpose::Contours).expect("polygons");
        assert!(feature.polygons.is_empty() && left_out == ["Polygon"]);
        let (feature, left_out) = read("CIRCULARSTRING (0 0, 1 1, 2 0)", Purpose::Contours).expect("a curve");
        assert!(feature.lines.is_empty() && left_out == ["CircularString"]);
        assert_eq!(read("LINESTRING EMPTY", Purpose::Contours).expect("nothing").1, ["no geometry"]);
    }

    #[test]
    fn what_is_no_geometry_is_refused() {
        let deep = format!("GEOMETRYCOLLECTION {}", "(".repeat(100_000));
        for text in [
            "",
            "12",
            "(1 2)",
            "LINESTRING (1 2",
            "LINESTRING (1 2))",
            "LINESTRING (1, 2)",
            "LINE (1 2)",
            "LINESTRING (1 2 3 4 5)",
            "LINESTRING (1 2x, 3 4)",
            "é",
            &deep,
        ] {
            assert!(read(text, Purpose::Contours).is_err(), "{text:.40}");
        }
    }
}
