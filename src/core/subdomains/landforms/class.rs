//! The class of a sub-domain, from the levels along its exterior and interior boundaries (paper, section 3.2).

use std::fmt;

use super::Ring;
use crate::subdomains::{Region, Side};

/// The landform class of a sub-domain.
///
/// The classes peak, bottom, tableland, basin, ridge-peak and branching are the paper's, for sub-domains that closed
/// contours surround. Valley, slope and water are additions. An open sub-domain, which the frame cuts, takes the class
/// that the contours on its border give.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LandformClass {
    /// Above one contour, which encloses no other.
    Peak,
    /// Below one contour, which encloses no other.
    Bottom,
    /// One contour inside, which is higher than the one around: a step of a hill.
    Tableland,
    /// One contour inside, which is lower than the one around: a step down into a hollow.
    Basin,
    /// Above contours of one level: the rim of a crater, a ridge that runs off the map.
    RidgePeak,
    /// Below contours of one level: a ring of low ground around a hill, a valley floor that runs off the map.
    Valley,
    /// Between two contours of different level that both run off the map.
    Slope,
    /// A lake or the sea.
    Water,
    /// Several contours inside; [`Mixture`] counts them by kind.
    Branching,
}

impl LandformClass {
    /// All classes, in the order of their declaration.
    pub const ALL: [Self; 9] = [
        Self::Peak,
        Self::Bottom,
        Self::Tableland,
        Self::Basin,
        Self::RidgePeak,
        Self::Valley,
        Self::Slope,
        Self::Water,
        Self::Branching,
    ];

    /// Its name in lower case, such as "bottom of a basin".
    pub fn name(self) -> &'static str {
        match self {
            Self::Peak => "peak",
            Self::Bottom => "bottom of a basin",
            Self::Tableland => "tableland",
            Self::Basin => "basin",
            Self::RidgePeak => "ridge-peak",
            Self::Valley => "valley",
            Self::Slope => "slope",
            Self::Water => "water",
            Self::Branching => "branching",
        }
    }
}

/// How many of the branches of a branching sub-domain are of each kind; all 0 for other classes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Mixture {
    /// Boundaries higher than the exterior one.
    pub tablelands: u32,
    /// Boundaries of the exterior one's level, with higher ground between.
    pub ridge_peaks: u32,
    /// Boundaries of the exterior one's level, with lower ground between.
    pub valleys: u32,
    /// Boundaries lower than the exterior one.
    pub basins: u32,
}

impl fmt::Display for Mixture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            (LandformClass::Tableland, self.tablelands),
            (LandformClass::RidgePeak, self.ridge_peaks),
            (LandformClass::Valley, self.valleys),
            (LandformClass::Basin, self.basins),
        ];
        let mut separator = "";
        for (class, count) in counts.into_iter().filter(|(_, count)| *count > 0) {
            write!(f, "{separator}{} {count}", class.name())?;
            separator = ", ";
        }
        Ok(())
    }
}

/// The class of a sub-domain with these rings, the exterior one first.
///
/// An exterior boundary in several pieces has the level of its lowest piece. Its other pieces count as branches. Each
/// interior boundary is a branch with its highest level; rings without a contour do not count. Where the exterior
/// boundary is only frame, the levels inside decide: the ground lies above or below them.
pub(super) fn classify(region: &Region, rings: &[Ring]) -> (LandformClass, Mixture) {
    let Some((exterior, interior)) = rings.split_first() else { return (LandformClass::Slope, Mixture::default()) };
    if region.water.is_some() {
        return (LandformClass::Water, Mixture::default());
    }
    let mut exterior: Vec<f64> = exterior.levels().collect();
    exterior.sort_by(f64::total_cmp);
    let highest = |ring: &Ring| ring.levels().reduce(f64::max);
    let interior: Vec<f64> = interior.iter().filter_map(highest).collect();

    let is_above = |level: f64| region.side(level) != Some(Side::Below);
    let branch = |level: f64| match exterior.first() {
        Some(around) if level > *around => LandformClass::Tableland,
        Some(around) if level < *around => LandformClass::Basin,
        Some(_) if is_above(level) => LandformClass::RidgePeak,
        Some(_) => LandformClass::Valley,
        None if is_above(level) => LandformClass::Basin,
        None => LandformClass::Tableland,
    };
    let class = match (&exterior[..], &interior[..]) {
        ([], []) => LandformClass::Slope,
        (&[level], []) if is_above(level) => LandformClass::Peak,
        ([_], []) => LandformClass::Bottom,
        ([] | [_], &[level]) => branch(level),
        ([first, rest @ ..], []) if rest.iter().all(|level| level == first) => branch(*first),
        ([_, _], []) => LandformClass::Slope,
        _ => {
            return (
                LandformClass::Branching,
                mixture(exterior.iter().skip(1).chain(&interior).map(|level| branch(*level))),
            );
        }
    };
    (class, Mixture::default())
}

fn mixture(branches: impl Iterator<Item = LandformClass>) -> Mixture {
    let mut mixture = Mixture::default();
    for branch in branches {
        match branch {
            LandformClass::Tableland => mixture.tablelands += 1,
            LandformClass::RidgePeak => mixture.ridge_peaks += 1,
            LandformClass::Valley => mixture.valleys += 1,
            _ => mixture.basins += 1,
        }
    }
    mixture
}
