//! What lies beside the contours around a tile, as bytes: lakes, streams, break lines, cliffs, sinks, and parts that were left out.
//! A feature that meets the window is stored whole, so that the tile sees its ends and its direction.

use geo::{Coord, LineString, MultiPolygon, Polygon};
use glam::DVec2;
use tokosen_core::base::FeatureId;
use tokosen_core::base::error::Result;
use tokosen_core::break_lines::{Bend, BreakLine};
use tokosen_core::contour::{CliffLine, Lake};
use tokosen_core::drain::{Sink, SinkShape};
use tokosen_core::features::Features;
use tokosen_core::streams::{RiverArea, StreamLine};

use super::bytes::{In, Out};
use super::window::Window;
use crate::terrain::Beside;

/// Bytes of a feature and an empty list of points: each feature has at least so many.
const LEAST: usize = 24;

/// What lies beside the contours and meets a window.
pub fn in_window(beside: &Beside, window: &Window) -> Beside {
    fn some<T: Clone>(all: &[T], meets: impl Fn(&T) -> bool) -> Vec<T> {
        all.iter().filter(|one| meets(one)).cloned().collect()
    }
    let line = |points: &[DVec2]| window.meets_line(points.iter().copied());
    let area = |polygon: &Polygon<f64>| window.meets_box(polygon.exterior().coords().map(|c| DVec2::new(c.x, c.y)));
    let areas = |areas: &MultiPolygon<f64>| areas.iter().any(area);
    // Coasts are contours, and excluded parts are no features any more.
    let Features { cliffs, lakes, streams, river_areas, break_lines, sinks, coast: _, excluded: _ } = &beside.features;
    Beside {
        features: Features {
            cliffs: some(cliffs, |cliff| line(&cliff.points)),
            lakes: some(lakes, |lake| area(&lake.polygon)),
            streams: some(streams, |stream| line(&stream.points)),
            river_areas: some(river_areas, |river| area(&river.polygon)),
            break_lines: some(break_lines, |break_line| line(&break_line.points)),
            sinks: some(sinks, |sink| match &sink.shape {
                SinkShape::Point(p) => window.holds(*p),
                SinkShape::Area(area) => areas(area),
            }),
            coast: Vec::new(),
            excluded: Vec::new(),
        },
        excluded: some(&beside.excluded, areas),
        at_cliffs: beside.at_cliffs.clone(),
    }
}

/// Adds what lies beside contours.
pub fn encode(out: &mut Out, beside: &Beside) {
    let Features { cliffs, lakes, streams, river_areas, break_lines, sinks, coast: _, excluded: _ } = &beside.features;
    out.each(cliffs, |out, cliff| {
        out.feature(cliff.feature);
        out.points(&cliff.points);
    });
    out.each(lakes, |out, lake| {
        out.feature(lake.feature);
        // No lake has a height that is no number.
        out.number(lake.height.unwrap_or(f64::NAN));
        polygon(out, &lake.polygon);
    });
    out.each(streams, |out, stream| {
        out.feature(stream.feature);
        out.points(&stream.points);
    });
    out.each(river_areas, |out, river| {
        out.feature(river.feature);
        polygon(out, &river.polygon);
    });
    out.each(break_lines, |out, line| {
        out.feature(line.feature);
        out.count(line.bend as usize);
        out.points(&line.points);
        out.each(&line.heights, |out, height| out.number(*height));
    });
    out.each(sinks, |out, sink| {
        out.feature(sink.feature);
        match &sink.shape {
            SinkShape::Point(p) => out.points(&[*p]),
            SinkShape::Area(area) => {
                out.points(&[]);
                polygons(out, area);
            }
        }
    });
    out.each(&beside.excluded, polygons);
    let at_cliffs: Vec<FeatureId> = beside.at_cliffs.iter().copied().collect();
    out.each(&at_cliffs, |out, feature| out.feature(*feature));
}

/// Reads what [`encode`] wrote.
///
/// # Errors
/// The bytes end too early.
pub fn decode(bytes: &mut In<'_>) -> Result<Beside> {
    let cliffs = bytes.each(LEAST, |bytes| Ok(CliffLine { feature: bytes.feature()?, points: bytes.points()? }))?;
    let lakes = bytes.each(LEAST, |bytes| {
        let (feature, height) = (bytes.feature()?, bytes.number()?);
        Ok(Lake { polygon: read_polygon(bytes)?, height: Some(height).filter(|height| !height.is_nan()), feature })
    })?;
    let streams = bytes.each(LEAST, |bytes| Ok(StreamLine { feature: bytes.feature()?, points: bytes.points()? }))?;
    let river_areas =
        bytes.each(LEAST, |bytes| Ok(RiverArea { feature: bytes.feature()?, polygon: read_polygon(bytes)? }))?;
    let break_lines = bytes.each(LEAST, |bytes| {
        let (feature, bend) = (bytes.feature()?, bytes.whole()?);
        let bend = [Bend::Ridge, Bend::Valley].into_iter().find(|known| *known as u64 == bend).unwrap_or_default();
        Ok(BreakLine { points: bytes.points()?, heights: bytes.each(8, In::number)?, bend, feature })
    })?;
    let sinks = bytes.each(LEAST, |bytes| {
        let (feature, point) = (bytes.feature()?, bytes.points()?);
        let shape = match point.first() {
            Some(p) => SinkShape::Point(*p),
            None => SinkShape::Area(read_polygons(bytes)?),
        };
        Ok(Sink { shape, feature })
    })?;
    let (coast, excluded) = (Vec::new(), Vec::new());
    let features = Features { coast, excluded, cliffs, lakes, streams, river_areas, break_lines, sinks };
    let excluded = bytes.each(8, read_polygons)?;
    let at_cliffs = bytes.each(16, In::feature)?.into_iter().collect();
    Ok(Beside { features, excluded, at_cliffs })
}

fn polygon(out: &mut Out, polygon: &Polygon<f64>) {
    let rings: Vec<&LineString<f64>> = std::iter::once(polygon.exterior()).chain(polygon.interiors()).collect();
    out.each(&rings, |out, ring| {
        let points: Vec<DVec2> = ring.coords().map(|c| DVec2::new(c.x, c.y)).collect();
        out.points(&points);
    });
}

fn polygons(out: &mut Out, area: &MultiPolygon<f64>) {
    out.each(&area.0, polygon);
}

fn read_polygon(bytes: &mut In<'_>) -> Result<Polygon<f64>> {
    let ring = |bytes: &mut In<'_>| {
        let points = bytes.points()?;
        Ok(points.iter().map(|p| Coord { x: p.x, y: p.y }).collect::<LineString<f64>>())
    };
    let mut rings = bytes.each(8, ring)?.into_iter();
    let exterior = rings.next().unwrap_or_else(|| LineString::new(Vec::new()));
    Ok(Polygon::new(exterior, rings.collect()))
}

fn read_polygons(bytes: &mut In<'_>) -> Result<MultiPolygon<f64>> {
    Ok(MultiPolygon(bytes.each(8, read_polygon)?))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn square(x: f64) -> Polygon<f64> {
        geo::Rect::new(Coord { x, y: 0.0 }, Coord { x: x + 10.0, y: 10.0 }).to_polygon()
    }

    /// Something in every role, around x.
    fn beside(x: f64, number: u64) -> Beside {
        let feature = FeatureId::from(number).in_file(2);
        let points = vec![DVec2::new(x, 1.0), DVec2::new(x + 9.0, 2.5)];
        let sink = |shape| Sink { shape, feature };
        let features = Features {
            cliffs: vec![CliffLine { points: points.clone(), feature }],
            lakes: vec![
                Lake { polygon: square(x), height: Some(-1.25), feature },
                Lake { polygon: square(x), height: None, feature },
            ],
            streams: vec![StreamLine { points: points.clone(), feature }],
            river_areas: vec![RiverArea { polygon: square(x), feature }],
            break_lines: vec![BreakLine { points, heights: vec![4.0, 0.1], bend: Bend::Valley, feature }],
            sinks: vec![
                sink(SinkShape::Point(DVec2::new(x, 5.0))),
                sink(SinkShape::Area(MultiPolygon(vec![square(x), square(x + 0.5)]))),
            ],
            ..Features::default()
        };
        Beside { features, excluded: vec![square(x).into()], at_cliffs: [feature].into() }
    }

    #[test]
    fn what_meets_a_window_comes_back_and_the_rest_stays_out() {
        let [here, there] = [beside(0.0, 7), beside(1000.0, 8)];
        let mut both = here.clone();
        let Features { cliffs, lakes, streams, river_areas, break_lines, sinks, .. } = there.features;
        both.features.cliffs.extend(cliffs);
        both.features.lakes.extend(lakes);
        both.features.streams.extend(streams);
        both.features.river_areas.extend(river_areas);
        both.features.break_lines.extend(break_lines);
        both.features.sinks.extend(sinks);
        both.excluded.extend(there.excluded);
        let found = in_window(&both, &Window::new([DVec2::splat(-1.0), DVec2::splat(100.0)]));
        assert_eq!(found, here);
        let mut out = Out::default();
        encode(&mut out, &found);
        assert_eq!(decode(&mut In::new(&out.0, Path::new("x"))).unwrap(), here);
        for cut in 0..out.0.len() {
            assert!(decode(&mut In::new(&out.0[..cut], Path::new("x"))).is_err());
        }
    }
}
