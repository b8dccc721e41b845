//! The geometry of one placemark.

use glam::DVec2;

use crate::table::{Feature, Spot, Table};

/// How the third number of a position is meant.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mode {
    Absolute,
    /// From the ground or the sea floor, or clamped to it.
    Other,
}

/// The geometry elements that are open, and what was read of them.
pub(super) struct Shapes {
    /// Whether z is taken in every mode.
    takes_any_z: bool,
    /// The altitude modes of the elements that are open.
    modes: Vec<Mode>,
    points: Vec<DVec2>,
    z: Vec<f64>,
    rings: Vec<Vec<DVec2>>,
    in_polygon: bool,
    has_other_z: bool,
    is_told: bool,
}

impl Shapes {
    pub fn new(takes_any_z: bool) -> Self {
        Self {
            takes_any_z,
            modes: Vec::new(),
            points: Vec::new(),
            z: Vec::new(),
            rings: Vec::new(),
            in_polygon: false,
            has_other_z: false,
            is_told: false,
        }
    }

    /// Whether some z was not taken.
    pub fn has_other_z(&self) -> bool {
        self.has_other_z
    }

    /// Whether a geometry that is left out was counted.
    pub fn is_told(&self) -> bool {
        self.is_told
    }

    /// An element begins.
    pub fn start(&mut self, name: &str, table: &mut Table) {
        match name {
            "Point" | "LineString" | "LinearRing" | "Polygon" => {
                self.modes.push(self.modes.last().copied().unwrap_or(Mode::Other));
                (self.points, self.z) = (Vec::new(), Vec::new());
                if name == "Polygon" {
                    self.in_polygon = true;
                    if !table.wants_polygons {
                        self.leave_out(name, table);
                    }
                }
            }
            "Track" | "MultiTrack" | "Model" => self.leave_out(name, table),
            _ => {}
        }
    }

    fn leave_out(&mut self, name: &str, table: &mut Table) {
        table.leave_out(name);
        self.is_told = true;
    }

    /// An element with this text ends.
    ///
    /// # Errors
    /// What is wrong with its coordinates.
    pub fn end(&mut self, name: &str, text: &str, feature: &mut Feature, table: &mut Table) -> Result<(), String> {
        match name {
            "altitudeMode" => {
                if let Some(mode) = self.modes.last_mut() {
                    *mode = if text.trim() == "absolute" { Mode::Absolute } else { Mode::Other };
                }
            }
            "coordinates" => (self.points, self.z) = positions(text)?,
            "Point" => {
                let (points, z) = self.take();
                let z = |i: usize| z.get(i).copied().filter(|z| !z.is_nan());
                feature.spots.extend(points.iter().enumerate().map(|(i, &place)| Spot { place, z: z(i) }));
            }
            "LineString" => {
                let (points, z) = self.take();
                feature.push_line(points, &z);
            }
            "LinearRing" => {
                let (points, z) = self.take();
                if !self.in_polygon {
                    feature.push_line(points, &z);
                } else if table.wants_polygons && !points.is_empty() {
                    feature.note_polygon_z(&z);
                    self.rings.push(points);
                }
            }
            "Polygon" => {
                self.modes.pop();
                self.in_polygon = false;
                let rings = std::mem::take(&mut self.rings);
                feature.polygons.extend((!rings.is_empty()).then_some(rings));
            }
            _ => {}
        }
        Ok(())
    }

    /// The positions of the element that ends, with z if it is an elevation.
    fn take(&mut self) -> (Vec<DVec2>, Vec<f64>) {
        let mode = self.modes.pop().unwrap_or(Mode::Other);
        let (points, z) = (std::mem::take(&mut self.points), std::mem::take(&mut self.z));
        if mode == Mode::Absolute || self.takes_any_z {
            return (points, z);
        }
        self.has_other_z |= z.iter().any(|&z| !z.is_nan() && z != 0.0);
        (points, Vec::new())
    }
}

/// Longitudes and latitudes of a text, and the third numbers if there are any.
fn positions(text: &str) -> Result<(Vec<DVec2>, Vec<f64>), String> {
    let (mut points, mut z) = (Vec::new(), Vec::new());
    for tuple in text.split_whitespace() {
        let number = |word: &str| {
            word.parse::<f64>()
                .map_err(|_| format!("its coordinates hold {tuple:.40}, which is not longitude,latitude"))
        };
        let words: Vec<&str> = tuple.split(',').collect();
        let [lon, lat, ref more @ ..] = words[..] else {
            return Err(format!("its coordinates hold {tuple:.40}, which is not longitude,latitude"));
        };
        let place = DVec2::new(number(lon)?, number(lat)?);
        if place.y.abs() > 90.0 {
            return Err(format!(
                "its coordinates hold {tuple:.40}; KML has the longitude first, and no latitude beyond 90"
            ));
        }
        points.push(place);
        z.push(match more {
            [] | [""] => f64::NAN,
            [height, ..] => number(height)?,
        });
    }
    if z.iter().all(|z| z.is_nan()) {
        z.clear();
    }
    Ok((points, z))
}
