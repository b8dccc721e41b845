//! Subdivision (paper, section 3.3): the triangulated contours of a clean map with their sub-domains.

use glam::{DVec2, DVec3};

use super::constraints::{Constraints, Found};
use super::frame_heights::with_frame_heights;
use super::prepare::{Prepared, prepare};
use super::water::{DrySubdivision, Water, settle};
use crate::base::error::{Report, Result};
use crate::base::parallel;
use crate::base::progress::Progress;
use crate::check::{Correction, Ground, Judged, contradicted_marks, judge, possible_lakes, possible_sea};
use crate::contour::{ContourMap, Interval};
use crate::subdomains::{CarriedRegions, Frame, FrameRing, GapEdges, MapExtent, Regions, loose_frame_edges};
use crate::tin::{Tin, TinInput};

/// Number of triangles per parallel task.
const CHUNK: usize = 1 << 14;

/// The triangulated map: contours, spot heights and frame, without computed lines or points.
#[derive(Debug, Clone)]
pub struct Subdivision {
    /// The map, cut to the frame.
    pub map: ContourMap,
    /// Its constrained Delaunay triangulation. Corners of the frame have heights too.
    pub tin: Tin,
    /// The sub-domains of its triangles.
    pub regions: Regions,
    /// The frame's outline.
    pub frame: FrameRing,
    /// The input's vertical interval.
    pub interval: Interval,
    /// The mean spacing of the contours, map units, if it is known from a larger map.
    pub(crate) spacing: Option<f64>,
    /// Corrections for the faults found, for [`correct`](crate::check::correct). Where the frame is no polygon, their
    /// line numbers are those of the input map.
    pub corrections: Vec<Correction>,
    /// Lines that may be wrong, as [`Judged::doubted`].
    pub(crate) doubted: Vec<u32>,
    /// The edges that close openings between open ends.
    pub(crate) gaps: GapEdges,
    constraints: Constraints,
    /// The points and edges that were triangulated. Empty once it was taken.
    pub(crate) input: TinInput,
    /// Number of points of the map; computed points come after them.
    pub(crate) given: usize,
}

/// Triangulates a clean map (see [`clean`](fn@crate::clean::clean)) and finds its sub-domains.
///
/// # Errors
/// When the map has fewer than two levels, when a contour line crosses another, or when the points have no extent.
pub fn subdivide(map: ContourMap, wanted: &Frame, progress: &dyn Progress) -> Result<Report<Subdivision>> {
    subdivide_with_water(map, wanted, &Water::default(), progress)
}

/// Like [`subdivide`], with lakes and the sea.
///
/// A lake without a height gets that of its shore. A lake is cut back from contours of other levels that cross or touch
/// it. A lake that contradicts the contours around it is left out.
///
/// # Errors
/// As [`subdivide`], and [`Error::Parameter`](crate::base::error::Error::Parameter) when no contour lies at the level
/// of the sea.
pub fn subdivide_with_water(
    map: ContourMap,
    wanted: &Frame,
    water: &Water,
    progress: &dyn Progress,
) -> Result<Report<Subdivision>> {
    prepare(map, wanted, water)?.subdivide(water, progress)
}

impl Prepared {
    /// Triangulates the map and finds its sub-domains.
    ///
    /// # Errors
    /// When a contour line crosses another, or when the points have no extent.
    pub fn subdivide(self, water: &Water, progress: &dyn Progress) -> Result<Report<Subdivision>> {
        let Self { map, mut frame, interval, spacing, ends, mut constraints, mut findings } = self;
        progress.start("triangulating", 0);
        let mut found = constraints.triangulated(&map, &frame, &ends, &interval, &mut findings)?;
        if !water.lakes.is_empty() {
            let ground = with_frame_heights(found.tin, &found.regions, &|_| None);
            let dry = DrySubdivision {
                map: &map,
                extensions: &constraints.extensions,
                frame: &frame,
                tin: &ground,
                regions: &found.regions,
            };
            let (water_bodies, with_ends) = settle(&water.lakes, &dry, &mut findings)?;
            (constraints.water_bodies, frame) = (water_bodies, with_ends);
            found = constraints.triangulated(&map, &frame, &ends, &interval, &mut findings)?;
        }
        let Found { input, tin, regions: sub_domains, gaps, lines_in_sea, findings: of_regions } = found;
        findings.extend(of_regions);
        let ground = Ground {
            map: &map,
            tin: &tin,
            regions: &sub_domains,
            frame: &frame,
            ends: &ends,
            extensions: &constraints.extensions,
            gaps: &gaps,
        };
        let Judged { findings: of_labels, corrections, mut doubted } = judge(&ground);
        doubted.extend(lines_in_sea);
        doubted.sort_unstable();
        doubted.dedup();
        findings.extend(of_labels);
        findings.extend(contradicted_marks(&map, &tin, &sub_domains));
        findings.extend(possible_lakes(&map, &tin, &sub_domains));
        findings.extend(possible_sea(&map, &tin, &sub_domains));
        let tin = with_frame_heights(tin, &sub_domains, &|_| None);
        progress.finish();
        let given = input.len();
        let regions = sub_domains;
        let subdivision = Subdivision {
            map,
            tin,
            regions,
            frame,
            interval,
            spacing,
            corrections,
            doubted,
            gaps,
            constraints,
            input,
            given,
        };
        Ok(Report { value: subdivision, findings })
    }
}

impl Subdivision {
    /// The heights of the lakes that the surface has, metres, in the order of the lakes. A lake that was cut into parts comes as often.
    pub fn lake_heights(&self) -> impl Iterator<Item = f64> {
        self.constraints.water_bodies.used().map(|body| body.height)
    }

    /// The extent of the map, with the area of the triangles inside the frame.
    pub(crate) fn extent(&self) -> MapExtent<'_> {
        if let Some(spacing) = self.spacing {
            return MapExtent { map: &self.map, frame: &self.frame, interval: self.interval, spacing };
        }
        let tin = &self.tin;
        let doubled = |t: u32| {
            let [a, b, c] = tin.corners(t);
            (b - a).perp_dot(c - a)
        };
        // The sum has this order for any number of threads.
        let chunks = parallel::map(tin.len().div_ceil(CHUNK), |k| {
            let (first, end) = (k * CHUNK, tin.len().min((k + 1) * CHUNK));
            (first as u32..end as u32).filter(|&t| tin.is_inside(t)).map(doubled).sum::<f64>()
        });
        let area = chunks.into_iter().sum::<f64>() / 2.0;
        MapExtent::with_area(&self.map, &self.frame, self.interval, area)
    }

    /// Adds the border edges of sub-domains and of the frame that are not lines of the map. A finer triangulation must
    /// hold them.
    pub(crate) fn push_borders(&self, input: &mut TinInput) {
        for &[u, v] in self.gaps.closures.iter().chain(&self.gaps.barriers) {
            input.push_edge(self.tin.source[u as usize], self.tin.source[v as usize]);
        }
        for [u, v] in loose_frame_edges(&self.tin) {
            input.push_edge(self.tin.source[u as usize], self.tin.source[v as usize]);
        }
    }

    /// The spot heights that agree with the contours around them.
    pub(crate) fn used_spots(&self) -> impl Iterator<Item = DVec3> {
        self.map.spots.iter().zip(&self.constraints.spots).filter(|(_, used)| **used).map(|(spot, _)| *spot)
    }

    /// The same subdivision on a triangulation whose triangles lie in these of its own.
    pub(crate) fn split(self, tin: Tin, parents: &[u32]) -> Self {
        Self { regions: self.regions.of_parts(parents), tin, input: TinInput::default(), ..self }
    }

    /// The same subdivision on a finer triangulation, to which points and edges were added.
    ///
    /// `smooth` gives a height (metres) for a map position, or none. Corners of the frame take it where there is one.
    pub(crate) fn retriangulated(self, finer: Tin, smooth: &dyn Fn(DVec2) -> Option<f64>) -> Self {
        let (tin, regions) = CarriedRegions::new(&self.tin, self.regions).on(finer);
        let tin = with_frame_heights(tin, &regions, smooth);
        Self { tin, regions, input: TinInput::default(), ..self }
    }
}
