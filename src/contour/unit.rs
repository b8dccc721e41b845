//! Units of elevations. Inside and on output they are metres.

use super::lake::Lake;
use super::map::{Contour, ContourMap};

/// A unit that a map's elevations may be in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ElevationUnit {
    /// Metres.
    #[default]
    Metre,
    /// International feet, 0.3048 m.
    Foot,
    /// US survey feet, 1200/3937 m.
    UsSurveyFoot,
}

impl ElevationUnit {
    /// An elevation of this unit in metres. Numerator and denominator are exact, so 40 feet are the number 12.192.
    pub fn metres(self, elevation: f64) -> f64 {
        match self {
            Self::Metre => elevation,
            Self::Foot => elevation * 3048.0 / 10_000.0,
            Self::UsSurveyFoot => elevation * 1200.0 / 3937.0,
        }
    }

    /// A map with elevations of this unit, in metres.
    pub fn map_in_metres(self, map: ContourMap) -> ContourMap {
        let line = |line: Contour| Contour { elevation: self.metres(line.elevation), ..line };
        let contours = map.contours.into_iter().map(line).collect();
        let spots = map.spots.into_iter().map(|p| p.truncate().extend(self.metres(p.z))).collect();
        ContourMap { contours, spots, ..map }
    }

    /// A lake with a height of this unit, in metres.
    pub fn lake_in_metres(self, lake: Lake) -> Lake {
        Lake { height: lake.height.map(|height| self.metres(height)), ..lake }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feet_are_round_numbers_of_metres() {
        assert_eq!(ElevationUnit::Foot.metres(40.0), 12.192);
        assert_eq!(ElevationUnit::Foot.metres(1240.0), 377.952);
        assert_eq!(ElevationUnit::UsSurveyFoot.metres(3937.0), 1200.0);
        assert_eq!(ElevationUnit::Metre.metres(0.1), 0.1);
    }
}
