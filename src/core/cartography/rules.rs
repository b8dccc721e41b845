//! The rules of maps, by scale: one table, with the source of each number.
//!
//! Sizes are millimetres on the map, so they are the same at all scales. Only the interval depends on scale and ground.
//!
//! | rule | value | source |
//! |---|---|---|
//! | interval | [`INTERVALS`] | the maps that it names; the choice by slope is our own |
//! | index contours | every fifth | GSI, USGS, Ordnance Survey: "every fifth contour is printed more thickly" |
//! | supplementary contours | half and a quarter of the interval | GSI: 5 m and 2.5 m between contours every 10 m; swisstopo: half |
//! | where they are drawn | [`APART`] | our own choice; national maps say "where the ground is gently sloping or intricate" |
//! | smallest distance of lines | [`CLOSEST`] | "The smallest recommended distance between contours on paper maps is 0.25 mm", Advances in Cartography and GIScience, section 2.4.2 |
//! | left out on steep slopes | intermediate contours | Ordnance Survey, Landranger: "if the slope is too steep for the four thinner lines, some or all are missed out" |
//! | simplification | [`SIMPLIFIED`] | our own choice: less than a printed line is wide |
//! | smallest ring | [`SMALLEST_RING`] | our own choice |
//! | height of labels | [`LABEL`] | our own choice: five points |

/// Supplementary contours are drawn where the contours beside them are so far apart, millimetres.
pub const APART: f64 = 15.0;
/// Lines are not closer than this, millimetres.
pub const CLOSEST: f64 = 0.25;
/// Largest distance between a line and its simplified course, millimetres.
pub const SIMPLIFIED: f64 = 0.1;
/// Rings that are smaller in both directions are left out, millimetres.
pub const SMALLEST_RING: f64 = 1.0;
/// Height of labels, millimetres.
pub const LABEL: f64 = 1.8;
/// Shortest piece of an intermediate contour beside steep slopes, millimetres.
pub(super) const SHORTEST: f64 = 5.0;
/// The interval is the smallest one at which lines are so far apart on the mean slope, millimetres.
const ROOM: f64 = 1.0;

/// Scales and their intervals, metres, for gentle and for steeper ground.
///
/// - 1:10 000: Ordnance Survey Land-Form PROFILE, 5 m, and 10 m in mountains; 2.5 m for plains from the table of intervals in Advances in
///   Cartography and GIScience (section 2.4.2).
/// - 1:25 000: Ordnance Survey Explorer, 5 m and 10 m; GSI, 10 m; swisstopo, 10 m and 20 m in the Alps.
/// - 1:50 000: Ordnance Survey Landranger, 10 m; GSI and swisstopo, 20 m.
/// - 1:100 000: swisstopo, 50 m; 20 m for gentle ground from the same table.
pub const INTERVALS: [(f64, &[f64]); 4] = [
    (10_000.0, &[2.5, 5.0, 10.0]),
    (25_000.0, &[5.0, 10.0, 20.0]),
    (50_000.0, &[10.0, 20.0]),
    (100_000.0, &[20.0, 50.0]),
];
/// The intervals of a scale are those of the nearest one in the table, up to this factor.
const NEAR: f64 = 1.6;

/// The rules of a scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapScale(f64);

impl MapScale {
    /// The scale 1 : `number`; none if that is not at least 1.
    pub fn new(number: f64) -> Option<Self> {
        (number.is_finite() && number >= 1.0).then_some(Self(number))
    }

    /// The number of the scale.
    pub fn number(self) -> f64 {
        self.0
    }

    /// Metres on the ground of so many millimetres on the map.
    pub fn metres(self, millimetres: f64) -> f64 {
        millimetres * self.0 / 1000.0
    }

    /// The interval for ground of a mean slope, given as the rise in metres for each metre. None if the table has no intervals for
    /// this scale.
    pub fn interval(self, slope: f64) -> Option<f64> {
        let off = |scale: f64| (scale / self.0).ln().abs();
        let (_, intervals) = INTERVALS
            .into_iter()
            .filter(|(scale, _)| off(*scale) <= NEAR.ln())
            .min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
        let has_room = |interval: &&f64| **interval >= slope * self.metres(ROOM);
        intervals.iter().find(has_room).or(intervals.last()).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_depends_on_scale_and_slope() {
        let of = |scale: f64, degrees: f64| MapScale::new(scale).unwrap().interval(degrees.to_radians().tan());
        assert_eq!([3.0, 15.0, 40.0].map(|slope| of(25_000.0, slope)), [Some(5.0), Some(10.0), Some(20.0)]);
        assert_eq!(of(24_000.0, 3.0), Some(5.0));
        assert_eq!([3.0, 40.0].map(|slope| of(50_000.0, slope)), [Some(10.0), Some(20.0)]);
        assert_eq!([1_000.0, 1_000_000.0].map(|scale| of(scale, 5.0)), [None, None]);
        assert_eq!(MapScale::new(25_000.0).unwrap().metres(15.0), 375.0);
        assert_eq!([0.0, -5.0, f64::NAN].map(MapScale::new), [None; 3]);
    }
}
