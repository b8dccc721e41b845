//! Widths of sub-domains against those of their neighbours. They distinguish a missing contour from a wrong label.

use super::graph::Graph;
use super::grid::Label;
use crate::subdomains::Regions;
use crate::tin::{Tin, VertexKind};

/// Spread of the widths of neighbouring sub-domains, as a standard deviation of their logarithms.
const SPREAD: f64 = 0.5;
/// The strongest evidence that widths can give, as a difference of negative logarithms.
const MOST: f64 = 2.0;

/// Evidence that one contour is missing in a sub-domain, by sub-domain, as a difference of negative logarithms.
/// Positive where a missing contour is more plausible than none. Zero where the width shows nothing, and for
/// sub-domains that skip no level.
///
/// The model: with one contour missing, a sub-domain is about twice as wide as its neighbours.
pub fn for_missing(tin: &Tin, regions: &Regions, graph: &Graph) -> Vec<f64> {
    let count = regions.regions.len();
    let mut near: Vec<Vec<u32>> = vec![Vec::new(); count];
    let mut range: Vec<(i64, i64)> = vec![(i64::MAX, i64::MIN); count];
    for pair in &graph.pairs {
        let [a, b] = pair.sides;
        near[a as usize].push(b);
        near[b as usize].push(a);
        for (label, _) in &pair.labels {
            if let Label::On(x) = *label {
                for r in [a, b] {
                    let range = &mut range[r as usize];
                    *range = (range.0.min(x), range.1.max(x));
                }
            }
        }
    }
    let skips = |r: usize| range[r].1.saturating_sub(range[r].0) >= 2 && range[r].0 <= range[r].1;
    let mut wanted = vec![false; count];
    for r in (0..count).filter(|&r| skips(r)) {
        wanted[r] = true;
        near[r].iter().for_each(|&n| wanted[n as usize] = true);
    }
    if !wanted.contains(&true) {
        return vec![0.0; count];
    }
    let widths = widths(tin, regions, &wanted);
    let evidence = |r: usize| {
        if !skips(r) {
            return 0.0;
        }
        let mut beside: Vec<f64> = near[r].iter().filter_map(|&n| widths[n as usize]).collect();
        beside.sort_unstable_by(f64::total_cmp);
        match (widths[r], beside.get(beside.len() / 2)) {
            (Some(own), Some(&usual)) if own > 0.0 && usual > 0.0 => {
                let ratio = (own / usual).ln();
                let twice = std::f64::consts::LN_2;
                ((ratio.powi(2) - (ratio - twice).powi(2)) / (2.0 * SPREAD * SPREAD)).clamp(-MOST, MOST)
            }
            _ => 0.0,
        }
    };
    (0..count).map(evidence).collect()
}

/// The median distance between contours of different level across each of the wanted sub-domains, weighted by length.
fn widths(tin: &Tin, regions: &Regions, wanted: &[bool]) -> Vec<Option<f64>> {
    let mut across: Vec<(u32, f64, f64)> = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let region = regions.of_triangle[t as usize];
        if !wanted[region as usize] {
            continue;
        }
        for i in 0..3 {
            let Some(level) = tin.contour_level(t, i) else { continue };
            let apex = tin.triangles[t as usize][(i + 2) % 3] as usize;
            let length = tin.edge_length(t, i);
            if tin.kinds[apex] == VertexKind::Contour && tin.heights[apex] != level && length > 0.0 {
                let [a, b] = tin.edge(t, i).map(|v| tin.positions[v as usize]);
                let distance = ((b - a).perp_dot(tin.positions[apex] - a) / length).abs();
                across.push((region, distance, length));
            }
        }
    }
    across.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2)));
    let mut widths = vec![None; wanted.len()];
    for of_region in across.chunk_by(|a, b| a.0 == b.0) {
        let half = 0.5 * of_region.iter().map(|a| a.2).sum::<f64>();
        let mut passed = 0.0;
        let middle = of_region.iter().find(|a| {
            passed += a.2;
            passed >= half
        });
        widths[of_region[0].0 as usize] = middle.map(|a| a.1);
    }
    widths
}
