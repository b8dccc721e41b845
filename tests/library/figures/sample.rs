//! A sample as the tests of the figures ask about it: triangulated, with kinds of triangles and sub-domains by place.

use std::path::Path;

use glam::DVec2;
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::ContourMap;
use tokosen::io::{ReadOptions, read_contours};
use tokosen::skeleton::{Elimination, eliminate};
use tokosen::subdivision::{Subdivision, subdivide};
use tokosen::subdomains::{Frame, Side};
use tokosen::tin::{TriangleKind, triangle_kinds};

/// Where the drawings have their zero, map coordinates.
pub const ORIGIN: DVec2 = DVec2::new(14_000.0, -16_500.0);

/// All samples, by the name of their file.
pub const ALL: [&str; 12] = [
    "fig1a_one_to_one",
    "fig1b_one_convolution",
    "fig1c_many_convolutions",
    "fig1d_two_branches_one_convolution",
    "fig1e_three_branches",
    "fig1f_nested",
    "fig2_triangles",
    "fig3a_spur",
    "fig3b_three_arms",
    "fig5ab_two_branches_ridges_canyon",
    "fig5cd_three_branches_basin",
    "fig6_ridge",
];

/// A triangulated sample.
pub struct Sample {
    pub subdivision: Subdivision,
    pub kinds: Vec<TriangleKind>,
}

/// The contours of a sample, made sound.
pub fn map(name: &str) -> ContourMap {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(format!("{name}.geojson"));
    let map = read_contours(&path, &ReadOptions::default()).unwrap().value;
    let report = clean(map, &CleanParams::default()).unwrap();
    assert!(report.findings.is_empty(), "{name}: {:?}", report.findings);
    report.value
}

/// Reads and triangulates a sample.
pub fn sample(name: &str) -> Sample {
    let report = subdivide(map(name), &Frame::Hull, &()).unwrap();
    assert!(report.findings.is_empty(), "{name}: {:?}", report.findings);
    let kinds = triangle_kinds(&report.value.tin);
    Sample { subdivision: report.value, kinds }
}

/// How many triangles of each kind there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    pub terminal: usize,
    pub sleeve: usize,
    pub junction: usize,
}

impl Sample {
    /// The triangles inside the frame.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        (0..self.subdivision.tin.len() as u32).filter(|&t| self.subdivision.tin.is_inside(t))
    }

    /// The corners of a triangle in the drawing's coordinates.
    pub fn corners(&self, t: u32) -> [DVec2; 3] {
        self.subdivision.tin.corners(t).map(|p| p + self.subdivision.tin.origin - ORIGIN)
    }

    pub fn centre(&self, t: u32) -> DVec2 {
        self.corners(t).iter().sum::<DVec2>() / 3.0
    }

    /// The triangle at a place of the drawing.
    pub fn triangle_at(&self, place: DVec2) -> u32 {
        let holds = |&t: &u32| {
            let [a, b, c] = self.corners(t);
            [(a, b), (b, c), (c, a)].iter().all(|(u, v)| (*v - *u).perp_dot(place - *u) >= 0.0)
        };
        self.triangles().find(holds).unwrap_or_else(|| panic!("{place} lies outside"))
    }

    /// The sub-domain at a place of the drawing.
    pub fn region_at(&self, x: f64, y: f64) -> u32 {
        self.subdivision.regions.of_triangle[self.triangle_at(DVec2::new(x, y)) as usize]
    }

    /// The levels around a sub-domain, each with whether the ground lies above it.
    pub fn levels(&self, region: u32) -> Vec<(f64, bool)> {
        let levels = &self.subdivision.regions.regions[region as usize].levels;
        levels.iter().map(|&(level, side)| (level, side == Side::Above)).collect()
    }

    pub fn triangles_of(&self, region: u32) -> Vec<u32> {
        self.triangles().filter(|&t| self.subdivision.regions.of_triangle[t as usize] == region).collect()
    }

    pub fn counts(&self, region: u32) -> Counts {
        let own = self.triangles_of(region);
        let count = |kind| own.iter().filter(|&&t| self.kinds[t as usize] == kind).count();
        Counts {
            terminal: count(TriangleKind::Terminal),
            sleeve: count(TriangleKind::Sleeve),
            junction: count(TriangleKind::Junction),
        }
    }

    /// What is eliminated at a resolution w.
    pub fn elimination(&self, w: f64) -> Elimination {
        eliminate(&self.subdivision.tin, &self.kinds, &self.subdivision.regions, w)
    }

    /// The terminal triangles of a sub-domain whose branch is kept at w = 1.
    pub fn kept_tips(&self, region: u32) -> Vec<u32> {
        let elimination = self.elimination(1.0);
        let is_kept = |&t: &u32| self.kinds[t as usize] == TriangleKind::Terminal && !elimination.dropped[t as usize];
        self.triangles_of(region).into_iter().filter(is_kept).collect()
    }
}
