//! Spot heights that contradict the contours around them.

use std::collections::{HashMap, HashSet};

use crate::base::bits::bits;
use crate::base::error::{Finding, FindingKind};
use crate::contour::ContourMap;
use crate::subdomains::Regions;
use crate::tin::{Tin, VertexKind};

/// Spot heights that contradict the levels around them, with their number in the map.
pub(super) fn spots_outside_bands(map: &ContourMap, tin: &Tin, regions: &Regions) -> Vec<(usize, Finding)> {
    let number: HashMap<[u64; 2], usize> = map.spots.iter().enumerate().map(|(i, s)| (bits(s.truncate()), i)).collect();
    let mut seen = HashSet::new();
    let mut outside = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let Some(region) = regions.region(t) else { continue };
        for v in tin.triangles[t as usize].map(|v| v as usize) {
            if tin.kinds[v] != VertexKind::Spot {
                continue;
            }
            let p = tin.point(v as u32);
            if region.band.contains(p.z) || !seen.insert(v) {
                continue;
            }
            if let Some(&spot) = number.get(&bits(p.truncate())) {
                let (lo, hi) = (region.band.lo, region.band.hi);
                let message = match region.water {
                    Some(level) => format!("spot height {} m lies in water of {level} m; it is left out", p.z),
                    None => format!("spot height {} m lies between the levels {lo} m and {hi} m; it is left out", p.z),
                };
                let finding = Finding::at(FindingKind::SpotOutsideBand, p.truncate(), message);
                outside.push((spot, finding.of_elevations([p.z])));
            }
        }
    }
    outside.sort_by_key(|(spot, _)| *spot);
    outside
}
