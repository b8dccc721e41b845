//! Places along lines, and along sections across them, at which heights are asked for.

use glam::DVec2;

use crate::base::error::{Error, Result};

/// A line has so many places at most.
const MOST_PLACES: f64 = 5e6;

/// A place on a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Distance from the start of the line, along it, metres.
    pub distance: f64,
    /// The place, in the coordinates of the line.
    pub place: DVec2,
}

/// A section across a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Distance of its middle from the start of the line, along it, metres.
    pub at: f64,
    /// Its places, from left to right, seen along the line. Distances are from the middle; those on the left are below 0.
    pub stations: Vec<Station>,
}

/// Places along a line, at most `step` metres apart, with all vertices of the line among them. `scale` is the length of a map
/// unit, metres in x and y.
///
/// # Errors
/// [`Error::OutOfRange`] for a step that is not above 0. [`Error::Parameter`] for a step that gives too many places.
pub fn stations(line: &[DVec2], step: f64, scale: DVec2) -> Result<Vec<Station>> {
    check(step, "step of the profile")?;
    let lengths: Vec<f64> = line.windows(2).map(|ends| ((ends[1] - ends[0]) * scale).length()).collect();
    check_count(lengths.iter().sum::<f64>() / step)?;
    let mut stations: Vec<Station> = Vec::new();
    let mut from = 0.0;
    for (ends, length) in line.windows(2).zip(lengths) {
        // Round stations come back as they are, whatever the vertices are.
        let first = (from / step).floor() + 1.0;
        stations.push(Station { distance: from, place: ends[0] });
        let round = (0..).map(|k| (first + f64::from(k)) * step).take_while(|at| *at < from + length * (1.0 - 1e-9));
        stations.extend(round.map(|at| Station { distance: at, place: ends[0].lerp(ends[1], (at - from) / length) }));
        from += length;
    }
    stations.extend(line.last().map(|place| Station { distance: from, place: *place }));
    Ok(stations)
}

/// Sections across a line, `every` metres along it, each `width` metres wide, with places at most `step` metres apart.
///
/// # Errors
/// As [`stations`], also for `every` and `width`.
pub fn sections(line: &[DVec2], [every, width, step]: [f64; 3], scale: DVec2) -> Result<Vec<Section>> {
    check(every, "distance between sections")?;
    check(width, "width of sections")?;
    check(step, "step of the profile")?;
    let lengths: Vec<f64> = line.windows(2).map(|ends| ((ends[1] - ends[0]) * scale).length()).collect();
    check_count(lengths.iter().sum::<f64>() / every * (width / step + 1.0))?;
    let half = (width / 2.0 / step).ceil().max(1.0) as i32;
    let mut sections = Vec::new();
    let mut from = 0.0;
    for (ends, length) in line.windows(2).zip(lengths).filter(|(_, length)| *length > 0.0) {
        let along = (ends[1] - ends[0]) * scale / length;
        let to_the_right = DVec2::new(along.y, -along.x) / scale;
        let first = (from / every).ceil();
        let places = (0..).map(|k| (first + f64::from(k)) * every).take_while(|at| *at < from + length);
        for at in places {
            let middle = ends[0].lerp(ends[1], (at - from) / length);
            let station = |k: i32| {
                let distance = f64::from(k) * width / 2.0 / f64::from(half);
                Station { distance, place: middle + distance * to_the_right }
            };
            sections.push(Section { at, stations: (-half..=half).map(station).collect() });
        }
        from += length;
    }
    Ok(sections)
}

fn check(length: f64, name: &'static str) -> Result<()> {
    let is_right = length.is_finite() && length > 0.0;
    if is_right { Ok(()) } else { Err(Error::out_of_range(name, length, "more than 0")) }
}

fn check_count(places: f64) -> Result<()> {
    if places <= MOST_PLACES {
        return Ok(());
    }
    Err(Error::Parameter(format!(
        "the profile would have {places:.0} places, more than {MOST_PLACES:.0}: choose a larger step, or a shorter line"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: [DVec2; 3] = [DVec2::new(100.0, 0.0), DVec2::new(125.0, 0.0), DVec2::new(125.0, 20.0)];

    #[test]
    fn stations_are_round_and_keep_the_vertices() {
        let found = stations(&LINE, 10.0, DVec2::ONE).unwrap();
        let distances: Vec<f64> = found.iter().map(|station| station.distance).collect();
        assert_eq!(distances, [0.0, 10.0, 20.0, 25.0, 30.0, 40.0, 45.0]);
        assert_eq!(found[4].place, DVec2::new(125.0, 5.0));
        // Feet: a map unit is shorter.
        let feet = stations(&LINE, 10.0, DVec2::splat(0.3048)).unwrap();
        assert!((feet.last().unwrap().distance - 45.0 * 0.3048).abs() < 1e-9);
    }

    #[test]
    fn sections_lie_across_the_line() {
        let found = sections(&LINE, [20.0, 10.0, 2.5], DVec2::ONE).unwrap();
        let middles: Vec<f64> = found.iter().map(|section| section.at).collect();
        assert_eq!(middles, [0.0, 20.0, 40.0]);
        let offsets: Vec<f64> = found[0].stations.iter().map(|station| station.distance).collect();
        assert_eq!(offsets, [-5.0, -2.5, 0.0, 2.5, 5.0]);
        // Left of the way to the east is the north.
        assert_eq!(found[0].stations[0].place, DVec2::new(100.0, 5.0));
        assert_eq!(found[2].stations[4].place, DVec2::new(130.0, 15.0));
    }

    #[test]
    fn impossible_lengths_are_refused() {
        for step in [0.0, -1.0, f64::NAN] {
            assert!(matches!(stations(&LINE, step, DVec2::ONE), Err(Error::OutOfRange { .. })));
            assert!(sections(&LINE, [10.0, step, 1.0], DVec2::ONE).is_err());
        }
        assert!(matches!(stations(&LINE, 1e-9, DVec2::ONE), Err(Error::Parameter(_))));
        assert!(sections(&LINE, [1e-3, 1e3, 1e-3], DVec2::ONE).is_err());
    }
}
