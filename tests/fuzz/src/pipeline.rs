//! All that is done with contours between reading and writing, on maps made of bytes.
//!
//! The first bytes choose kind of surface, frame, scale and what is done to the lines. Then come records of one byte of
//! kind and level and some points each: contours, spot heights, lakes, polygons of the frame. A point is two bytes on a
//! small grid, so that points coincide and lie on a line often, or two raw numbers.

use geo::{LineString, MultiPolygon, Polygon, Validation};
use glam::{DVec2, DVec3};
use tokosen::base::error::Result;
use tokosen::contour::{Contour, ContourMap, Lake};
use tokosen::resample::{FitParams, SampleParams};
use tokosen::subdivision::Water;
use tokosen::subdomains::Frame;
use tokosen::surface::{Given, SurfaceKind, SurfaceParams, Triangles};

use crate::guarantees::{Lines, hold};

/// Coordinates and elevations up to here have digits enough for lines that are a thousandth of a unit apart.
const EXACT: f64 = 1e7;
/// The same in units of the small grid: points that lie on one line there make slivers by rounding, and lines of different
/// levels through those cross by rounding.
const EXACT_UNITS: f64 = 1e8;

/// Readers let no polygon pass with coordinates beyond that.
const LARGEST: f64 = 1e50;

/// The smooth surface is asked for on maps up to so many units of the small grid. With one line far from the others its
/// working grid is large, as it must be, and nothing would be found in an hour.
const SMOOTH: f64 = 64.0;

/// Makes a map of bytes and asks all guarantees of it. Gives what the steps say about the map; None if the bytes make none.
/// Errors are fine, panics are not.
pub fn run(data: &[u8]) -> Option<Result<()>> {
    let case = Bytes { rest: data }.case()?;
    Some(hold(case.map, &case.lines, (&case.given, &case.params), "bytes"))
}

/// The most points of a map: what can go wrong does so on small ones, and those are quick.
const POINTS: usize = 120;

struct Case {
    map: ContourMap,
    lines: Lines,
    given: Given,
    params: SurfaceParams,
}

struct Bytes<'a> {
    rest: &'a [u8],
}

impl Bytes<'_> {
    fn next(&mut self) -> Option<u8> {
        let (&first, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(first)
    }

    fn number(&mut self) -> Option<f64> {
        let (first, rest) = self.rest.split_first_chunk::<8>()?;
        self.rest = rest;
        Some(f64::from_le_bytes(*first))
    }

    fn point(&mut self, scale: f64, origin: DVec2) -> Option<DVec2> {
        let x = self.next()?;
        if x == 255 {
            return Some(DVec2::new(self.number()?, self.number()?));
        }
        let y = self.next()?;
        // The upper bits move a point by next to nothing.
        let near = |v: u8| f64::from(v & 31) + 1e-9 * f64::from(v >> 6);
        Some(origin + scale * DVec2::new(near(x), near(y)))
    }

    fn case(&mut self) -> Option<Case> {
        let (how, place, what) = (self.next()?, self.next()?, self.next()?);
        let kinds = [SurfaceKind::Spline, SurfaceKind::Linear, SurfaceKind::Skeleton, SurfaceKind::Spline];
        let scale = [1.0, 10.0, 1e-3, 1e4][usize::from(place & 3)];
        let origin = [DVec2::ZERO, DVec2::new(36_480.25, -27_250.5), DVec2::splat(1e6), DVec2::new(-1e7, 0.1)];
        let origin = origin[usize::from(place >> 2 & 3)];
        let interval = [10.0, 0.1, 1.0, 50.0][usize::from(place >> 4 & 3)];
        let mut map = ContourMap::default();
        let (mut area, mut lakes) = (Vec::new(), Vec::new());
        let (mut is_exact, mut is_small) = (true, true);
        let mut left = POINTS;
        while let Some(tag) = self.next() {
            let elevation = match tag >> 4 {
                15 => self.number()?,
                k => interval * f64::from(k),
            };
            is_exact &= elevation.abs() <= EXACT;
            let mut points = Vec::new();
            for _ in 0..usize::from(self.next().unwrap_or(0)).min(left) {
                let Some(p) = self.point(scale, origin) else { break };
                is_exact &= p.abs().max_element() <= EXACT.min(EXACT_UNITS * scale);
                is_small &= p.distance(origin) <= SMOOTH * scale;
                points.push(p);
            }
            left -= points.len();
            if tag & 8 != 0 {
                points.extend(points.first().copied());
            }
            let feature = map.contours.len() as u64;
            match tag & 7 {
                0..=4 => map.contours.push(Contour { elevation, points, feature: feature.into() }),
                5 => map.spots.extend(points.iter().map(|p| DVec3::new(p.x, p.y, elevation))),
                6 => lakes.extend(polygon(&points).map(|polygon| {
                    let height = (tag & 8 != 0).then_some(elevation);
                    Lake { polygon, height, feature: feature.into() }
                })),
                _ => area.extend(polygon(&points)),
            }
        }
        let frame = match how >> 2 & 3 {
            1 => Frame::Box,
            2 if !area.is_empty() && MultiPolygon::new(area.clone()).is_valid() => {
                Frame::Polygon(MultiPolygon::new(area))
            }
            _ => Frame::Hull,
        };
        let sea = (how & 16 != 0).then_some(interval);
        let triangles = if how & 32 != 0 { Triangles::Reference } else { Triangles::Smooth };
        let params = SurfaceParams {
            kind: if is_small { kinds[usize::from(how & 3)] } else { SurfaceKind::Skeleton },
            frame,
            triangles,
            ..SurfaceParams::default()
        };
        let given = Given { water: Water { lakes, sea, ..Water::default() }, ..Given::default() };
        let sampling = SampleParams { most: 1_000, ..SampleParams::default() };
        let lines = Lines {
            fit: (what & 1 != 0).then_some(FitParams { tolerance: 0.5 * scale, sampling: None }),
            sample: (what & 2 != 0).then_some(sampling),
            snap: if what & 4 != 0 { 1.5 * scale } else { 0.0 },
            is_exact,
        };
        Some(Case { map, lines, given, params })
    }
}

/// The area within a ring that a reader would let pass.
fn polygon(points: &[DVec2]) -> Option<Polygon<f64>> {
    if points.iter().any(|p| p.abs().max_element() > LARGEST) {
        return None;
    }
    let ring: LineString<f64> = points.iter().map(|p| (p.x, p.y)).collect();
    let polygon = Polygon::new(ring, Vec::new());
    (points.len() >= 3 && polygon.is_valid()).then_some(polygon)
}
