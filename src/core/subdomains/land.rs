//! Which ground at a coast is land, and which is sea.
//!
//! A coast parts land from sea, contours above it are on land, and contours below it are in the sea. Where a map contradicts
//! this, some of its lines are wrong. Of all ways to choose land and sea, the one with the least length of wrong lines is
//! taken. So the longer coast decides, and a few contours in the sea do not make it land.

use std::collections::BTreeMap;

use super::Regions;
use crate::base::rows::Rows;
use crate::base::union_find::UnionFind;
use crate::tin::Tin;

/// What a sub-domain at the coast is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Land,
    Sea,
}

/// A contour above the coast counts for this share more than a coast: land wins a draw.
const DRAW: f64 = 1e-6;
/// The sea is level if the coast is a larger share of its border than this, and the rest contours below the coast.
const MOST: f64 = 0.75;
/// Rounds in which single sub-domains are changed. Nearly always the first one changes nothing.
const ROUNDS: usize = 8;

/// The border of a sub-domain, by what is on it. Lengths are in map units.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shore {
    /// Length of the coast.
    coast: f64,
    /// Length of contours above the coast.
    above: f64,
    /// Length of contours below the coast.
    below: f64,
    /// Whether a contour below the coast ends in it, or parts it from ground that reaches the frame.
    is_open_below: bool,
    /// Whether the level of the coast is on it.
    is_at_coast: bool,
}

impl Shore {
    /// Whether there are other contours than the coast.
    pub(super) fn has_others(&self) -> bool {
        self.above > 0.0 || self.below > 0.0
    }

    /// Whether sea with this border is level. Long contours below the coast, and those that lead out of the map, show the
    /// ground under the water.
    pub(super) fn is_level(&self) -> bool {
        self.below == 0.0 || (!self.is_open_below && self.coast > MOST * (self.coast + self.below))
    }

    /// Length of lines that are wrong if the sub-domain is of this kind.
    fn wrong(&self, kind: Kind) -> f64 {
        match kind {
            Kind::Land => self.below,
            Kind::Sea => (1.0 + DRAW) * self.above + DRAW * DRAW * self.coast,
        }
    }
}

/// The sub-domains at a coast.
pub(super) struct Shores {
    /// The border of each sub-domain.
    pub(super) shores: Vec<Shore>,
    /// What each sub-domain at the coast is; `None` away from it, and where no contour shows which is land.
    pub(super) kinds: Vec<Option<Kind>>,
    /// The first of the sub-domains that the coast connects with each one.
    pub(super) groups: Vec<usize>,
}

impl Shores {
    /// Finds land and sea beside the contours of a level.
    pub(super) fn new(regions: &Regions, tin: &Tin, level: f64) -> Self {
        let (shores, coasts) = borders(regions, tin, level);
        let mut sets = UnionFind::new(shores.len());
        coasts.iter().for_each(|&([a, b], _)| {
            sets.unite(a, b);
        });
        let groups: Vec<usize> = (0..shores.len()).map(|r| sets.root(r)).collect();
        let mut is_shown = vec![false; shores.len()];
        for (r, shore) in shores.iter().enumerate().filter(|(_, shore)| shore.is_at_coast) {
            is_shown[groups[r]] |= shore.has_others();
        }
        let chosen = least_wrong(&shores, &coasts);
        let kind = |r: usize| (shores[r].is_at_coast && is_shown[groups[r]]).then_some(chosen[r]);
        let kinds = (0..shores.len()).map(kind).collect();
        Self { shores, kinds, groups }
    }

    /// Whether a sub-domain is level sea.
    pub(super) fn is_level_sea(&self, r: usize) -> bool {
        self.kinds[r] == Some(Kind::Sea) && self.shores[r].is_level()
    }

    /// Whether a contour of the level `of` is wrong on the border of a sub-domain at the coast of a level.
    pub(super) fn is_astray(&self, r: usize, of: f64, level: f64) -> bool {
        self.kinds[r] == Some(Kind::Sea) && (of > level || (of < level && self.shores[r].is_level()))
    }
}

/// Coasts between two sub-domains, with their lengths.
type Coasts = Vec<([usize; 2], f64)>;

fn borders(regions: &Regions, tin: &Tin, level: f64) -> (Vec<Shore>, Coasts) {
    let mut shores = vec![Shore::default(); regions.regions.len()];
    let mut reaches_frame = vec![false; shores.len()];
    let mut coasts: BTreeMap<[usize; 2], f64> = BTreeMap::new();
    let mut below: Vec<[usize; 2]> = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let own = regions.of_triangle[t as usize] as usize;
        for i in 0..3 {
            let Some(n) = tin.inner_neighbour(t, i) else {
                reaches_frame[own] = true;
                continue;
            };
            let Some(of) = tin.contour_level(t, i) else { continue };
            let other = regions.of_triangle[n as usize] as usize;
            // A contour with the sub-domain on both sides is met from both.
            let length = if own == other { tin.edge_length(t, i) / 2.0 } else { tin.edge_length(t, i) };
            let shore = &mut shores[own];
            match of.total_cmp(&level) {
                std::cmp::Ordering::Greater => shore.above += length,
                std::cmp::Ordering::Equal => {
                    shore.coast += length;
                    if own < other {
                        *coasts.entry([own, other]).or_default() += length;
                    }
                }
                std::cmp::Ordering::Less => {
                    shore.below += length;
                    below.push([own, other]);
                }
            }
        }
    }
    for [own, other] in below {
        shores[own].is_open_below |= own == other || reaches_frame[other];
    }
    for (shore, region) in shores.iter_mut().zip(&regions.regions) {
        shore.is_at_coast = region.levels.iter().any(|(l, _)| *l == level);
        // Levels of a ragged outline have no length.
        let least = DRAW * shore.coast.max(f64::MIN_POSITIVE);
        match region.levels.last() {
            Some((highest, _)) if *highest > level => shore.above = shore.above.max(least),
            Some(_) if region.levels.len() > 1 => shore.below = shore.below.max(least),
            _ => {}
        }
    }
    (shores, coasts.into_iter().collect())
}

fn other(kind: Kind) -> Kind {
    match kind {
        Kind::Land => Kind::Sea,
        Kind::Sea => Kind::Land,
    }
}

/// The kinds with the least length of wrong lines: first along a tree of the longest coasts, where they are the best ones.
/// Coasts that close a circle are rare. For these, single sub-domains are changed as long as it helps.
fn least_wrong(shores: &[Shore], coasts: &Coasts) -> Vec<Kind> {
    let both = || coasts.iter().flat_map(|&([a, b], length)| [(a, (b, length)), (b, (a, length))]);
    let neighbours = Rows::new(shores.len(), both);
    let mut kinds = along_tree(shores, coasts);
    for _ in 0..ROUNDS {
        let mut has_changed = false;
        for r in 0..shores.len() {
            let wrong = |kind: Kind| {
                let same = neighbours.of(r).iter().filter(|(q, _)| kinds[*q] == kind);
                shores[r].wrong(kind) + same.map(|(_, length)| length).sum::<f64>()
            };
            let turned = other(kinds[r]);
            if wrong(turned) < (1.0 - DRAW * DRAW) * wrong(kinds[r]) {
                kinds[r] = turned;
                has_changed = true;
            }
        }
        if !has_changed {
            break;
        }
    }
    kinds
}

fn along_tree(shores: &[Shore], coasts: &Coasts) -> Vec<Kind> {
    let mut by_length: Vec<&([usize; 2], f64)> = coasts.iter().collect();
    by_length.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut sets = UnionFind::new(shores.len());
    by_length.retain(|([a, b], _)| sets.unite(*a, *b));
    let both = || by_length.iter().flat_map(|&&([a, b], length)| [(a, (b, length)), (b, (a, length))]);
    let tree = Rows::new(shores.len(), both);
    // Each sub-domain after the one before it, with that one and the coast between them.
    let mut order: Vec<(usize, Option<(usize, f64)>)> = Vec::with_capacity(shores.len());
    let mut is_met = vec![false; shores.len()];
    for root in 0..shores.len() {
        if std::mem::replace(&mut is_met[root], true) {
            continue;
        }
        let mut next = order.len();
        order.push((root, None));
        while let Some(&(r, _)) = order.get(next) {
            next += 1;
            for &(q, length) in tree.of(r) {
                if !std::mem::replace(&mut is_met[q], true) {
                    order.push((q, Some((r, length))));
                }
            }
        }
    }
    // The length of wrong lines in each sub-domain and those after it, for land and for sea.
    let mut wrong: Vec<[f64; 2]> = shores.iter().map(|s| [s.wrong(Kind::Land), s.wrong(Kind::Sea)]).collect();
    for &(r, before) in order.iter().rev() {
        let Some((q, length)) = before else { continue };
        let [land, sea] = wrong[r];
        wrong[q][0] += sea.min(land + length);
        wrong[q][1] += land.min(sea + length);
    }
    let mut kinds = vec![Kind::Land; shores.len()];
    for &(r, before) in &order {
        let [mut land, mut sea] = wrong[r];
        match before.map(|(q, length)| (kinds[q], length)) {
            Some((Kind::Land, length)) => land += length,
            Some((Kind::Sea, length)) => sea += length,
            None => {}
        }
        kinds[r] = if land <= sea { Kind::Land } else { Kind::Sea };
    }
    kinds
}
