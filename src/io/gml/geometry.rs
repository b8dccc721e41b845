//! The geometry of one feature: the elements of GML become points, lines and polygons.

use glam::DVec2;

use crate::table::{Feature, Spot, Table};

/// Elements that are a geometry, or begin one.
const GEOMETRIES: [&str; 19] = [
    "Point",
    "MultiPoint",
    "LineString",
    "MultiLineString",
    "Curve",
    "MultiCurve",
    "CompositeCurve",
    "OrientableCurve",
    "LinearRing",
    "Ring",
    "Polygon",
    "MultiPolygon",
    "Surface",
    "MultiSurface",
    "CompositeSurface",
    "PolyhedralSurface",
    "MultiGeometry",
    "Solid",
    "Box",
];
/// Elements whose pieces are one line.
const LINES: [&str; 5] = ["LineString", "Curve", "CompositeCurve", "LinearRing", "Ring"];
/// Elements that are a polygon.
const POLYGONS: [&str; 3] = ["Polygon", "PolygonPatch", "Rectangle"];
/// Pieces of curves that are not straight.
const CURVED: [&str; 14] = [
    "Arc",
    "ArcString",
    "ArcByBulge",
    "ArcStringByBulge",
    "ArcByCenterPoint",
    "Circle",
    "CircleByCenterPoint",
    "CubicSpline",
    "BSpline",
    "Bezier",
    "Clothoid",
    "OffsetCurve",
    "GeodesicString",
    "Geodesic",
];

/// Whether an element of this name is a geometry.
pub(super) fn is_geometry(name: &str) -> bool {
    GEOMETRIES.contains(&name)
}

/// Whether an element of this name holds positions.
pub(super) fn holds_positions(name: &str) -> bool {
    matches!(name, "pos" | "posList" | "coordinates" | "X" | "Y" | "Z")
}

/// In which direction a piece of a curve is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Direction {
    Kept,
    Reversed,
}

/// What is open of a feature's geometry.
#[derive(Default)]
pub(super) struct Geometry {
    /// How many elements that are lines are open, one in another.
    lines: usize,
    polygons: usize,
    /// Whether the current line has a piece that is not read.
    is_spoilt: bool,
    current: Vec<[f64; 3]>,
    /// Whether the next position begins a further piece of the line.
    begins_piece: bool,
    rings: Vec<Vec<DVec2>>,
    is_told: bool,
}

impl Geometry {
    /// Whether a geometry that is left out was counted.
    pub fn is_told(&self) -> bool {
        self.is_told
    }

    /// An element begins.
    pub fn start(&mut self, name: &str, direction: Direction, table: &mut Table) {
        if CURVED.contains(&name) || direction == Direction::Reversed {
            self.is_spoilt = true;
            self.is_told = true;
            table.leave_out(if CURVED.contains(&name) { name } else { "reversed OrientableCurve" });
        }
        if POLYGONS.contains(&name) {
            self.polygons += 1;
            if !table.wants_polygons {
                self.is_told = true;
                table.leave_out("Polygon");
            }
        }
        if LINES.contains(&name) {
            if self.lines == 0 {
                self.current.clear();
                self.is_spoilt = direction == Direction::Reversed;
            }
            self.lines += 1;
        } else if name == "Point" {
            self.current.clear();
        }
        self.begins_piece |= LINES.contains(&name) || name == "LineStringSegment";
    }

    /// An element with these positions ends.
    pub fn end(&mut self, name: &str, positions: Vec<[f64; 3]>, feature: &mut Feature, table: &Table) {
        match name {
            // GML 2 may write a position as one element per coordinate.
            "X" => self.current.extend(positions),
            "Y" | "Z" => {
                if let (Some(last), Some(value)) = (self.current.last_mut(), positions.first()) {
                    last[if name == "Y" { 1 } else { 2 }] = value[0];
                }
            }
            _ => {
                // Pieces of a line share the position where they meet.
                let is_known = |first: &[f64; 3]| {
                    self.current.last().is_some_and(|last| last.map(f64::to_bits) == first.map(f64::to_bits))
                };
                let shared = usize::from(self.begins_piece && positions.first().is_some_and(is_known));
                self.begins_piece &= positions.is_empty();
                self.current.extend(&positions[shared..]);
            }
        }
        if LINES.contains(&name) {
            self.lines = self.lines.saturating_sub(1);
            if self.lines == 0 {
                self.end_line(feature, table);
            }
        } else if name == "Point" {
            for [x, y, z] in self.current.drain(..) {
                feature.spots.push(Spot { place: DVec2::new(x, y), z: (!z.is_nan()).then_some(z) });
            }
        } else if POLYGONS.contains(&name) {
            self.polygons = self.polygons.saturating_sub(1);
            let rings = std::mem::take(&mut self.rings);
            feature.polygons.extend((!rings.is_empty()).then_some(rings));
        }
    }

    fn end_line(&mut self, feature: &mut Feature, table: &Table) {
        let current = std::mem::take(&mut self.current);
        if std::mem::take(&mut self.is_spoilt) || current.is_empty() {
            return;
        }
        let points: Vec<DVec2> = current.iter().map(|p| DVec2::new(p[0], p[1])).collect();
        let mut z: Vec<f64> = current.iter().map(|p| p[2]).collect();
        if z.iter().all(|z| z.is_nan()) {
            z.clear();
        }
        if self.polygons == 0 {
            feature.push_line(points, &z);
        } else if table.wants_polygons {
            feature.note_polygon_z(&z);
            self.rings.push(points);
        }
    }
}

/// The positions of an element's text in their own order. z is NaN if there is none.
///
/// # Errors
/// What is wrong with the text.
pub(super) fn positions(element: &str, text: &str, dimension: Option<usize>) -> Result<Vec<[f64; 3]>, String> {
    let number =
        |word: &str| word.parse::<f64>().map_err(|_| format!("its positions hold {word:.40}, which is not a number"));
    if matches!(element, "X" | "Y" | "Z") {
        return Ok(vec![[number(text.trim())?, f64::NAN, f64::NAN]]);
    }
    if element == "coordinates" {
        // One position a word, its numbers separated by commas.
        let of_tuple = |tuple: &str| {
            let numbers: Vec<f64> = tuple.split(',').map(number).collect::<Result<_, _>>()?;
            match numbers[..] {
                [x, y] => Ok([x, y, f64::NAN]),
                [x, y, z] => Ok([x, y, z]),
                _ => Err(format!("its coordinates hold {tuple:.40}, which has {} numbers", numbers.len())),
            }
        };
        return text.split_whitespace().map(of_tuple).collect();
    }
    let numbers: Vec<f64> = text.split_whitespace().map(number).collect::<Result<_, _>>()?;
    // A single position says itself how many numbers it has.
    let dimension = match (element, dimension) {
        ("pos", _) => numbers.len(),
        (_, Some(dimension)) => dimension,
        (_, None) if !numbers.len().is_multiple_of(2) && numbers.len().is_multiple_of(3) => 3,
        (_, None) => 2,
    };
    if !matches!(dimension, 2 | 3) || !numbers.len().is_multiple_of(dimension) {
        return Err(format!("its positions have {dimension} numbers each, but there are {} numbers", numbers.len()));
    }
    let of = |p: &[f64]| [p[0], p[1], p.get(2).copied().unwrap_or(f64::NAN)];
    Ok(numbers.chunks_exact(dimension).map(of).collect())
}
