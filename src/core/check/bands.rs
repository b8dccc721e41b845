//! The most plausible band of every sub-domain, if some labels may be wrong and some contours missing.
//!
//! A sub-domain lies between level k and level k + 1. Where contours are missing, it spans several such bands. A
//! contour is explained if its level lies between the bands on its two sides. Everything else has a cost: a wrong
//! label, a missing contour, a gap. The cost is the negative logarithm of how often such faults occur. The graph of the
//! sub-domains is a tree, or nearly so: cycles are cut at their shortest border. So the cheapest explanation of the
//! whole map is found exactly, by dynamic programming from the leaves to the root and back.

use super::graph::{Graph, Pair};
use super::grid::Label;
use crate::base::union_find::UnionFind;

/// Cost of a contour with a wrong label: about one in a hundred.
const WRONG: f64 = 5.0;
/// Extra cost if no level lies between the bands on the two sides of the contour.
const NO_LEVEL: f64 = 2.0;
/// Cost of a missing level between two neighbouring contours, before their distance is considered.
const MISSING: f64 = 5.5;
/// The same where lines of the level end inside the map: the contour is there, but has a gap.
const GAP: f64 = 1.5;
/// Cost of a contour between two levels, within its band: an auxiliary contour.
const AUXILIARY: f64 = 1.0;
/// Most bands that a sub-domain can span. A larger difference does not come from missing contours.
const MOST_SPANNED: i64 = 12;
/// Number of levels on a sub-domain's border that are tried, the longest first.
const OWN_LEVELS: usize = 10;
/// Number of levels on a neighbour's border that are tried.
const NEAR_LEVELS: usize = 4;

/// The bands that a sub-domain lies in: from level `lo` to level `hi + 1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// Number of its lowest level.
    pub lo: i64,
    /// Number of its highest band; the same as `lo` where no level is missing.
    pub hi: i64,
}

impl Span {
    fn has(self, band: i64) -> bool {
        self.lo <= band && band <= self.hi
    }

    /// Whether a contour with this label can bound it.
    pub fn meets(self, label: Label) -> bool {
        match label {
            Label::On(x) => self.has(x - 1) || self.has(x),
            Label::Within(k) => self.has(k),
        }
    }

    /// The levels strictly inside.
    pub fn skipped(self) -> impl Iterator<Item = i64> {
        self.lo + 1..=self.hi
    }
}

/// Whether a contour with this label can lie between two sub-domains.
pub fn separates(label: Label, a: Span, b: Span) -> bool {
    match label {
        Label::On(x) => (a.has(x - 1) && b.has(x)) || (a.has(x) && b.has(x - 1)),
        Label::Within(k) => a.has(k) && b.has(k),
    }
}

/// The levels that a contour between two sub-domains can have.
pub fn levels_between(a: Span, b: Span) -> impl Iterator<Item = i64> {
    (a.lo.max(b.lo)..=a.hi.min(b.hi).saturating_add(1)).filter(move |&y| separates(Label::On(y), a, b))
}

/// The cheapest explanation of a map, and the costs of the others.
pub struct Explanation<'a> {
    /// The span of every sub-domain; none where there is no contour to decide.
    pub spans: Vec<Option<Span>>,
    graph: &'a Graph,
    tree: Tree,
    /// The spans that were tried for each sub-domain.
    states: Vec<Vec<Span>>,
    /// For each of them, the cost of the best explanation of the sub-domain and of all below it in the tree.
    costs: Vec<Vec<f64>>,
    /// For each state of the parent, the cost of the best explanation of the border to the parent and of all below it.
    below: Vec<Vec<f64>>,
}

/// Finds the cheapest explanation of a map.
///
/// `for_missing` gives, by sub-domain, the evidence of its width for a missing contour.
pub fn explain<'a>(graph: &'a Graph, for_missing: &[f64]) -> Explanation<'a> {
    let count = graph.ragged.len();
    let tree = Tree::new(graph, count);
    let own = own_levels(graph, count);
    let states: Vec<Vec<Span>> = (0..count).map(|r| states(r, graph, &own, &tree)).collect();
    let mut costs: Vec<Vec<f64>> =
        (0..count).map(|r| states[r].iter().map(|&s| alone(graph, for_missing[r], r, s)).collect()).collect();
    let mut below: Vec<Vec<f64>> = vec![Vec::new(); count];
    // For each state of the parent, the best state of the child.
    let mut choices: Vec<Vec<u32>> = vec![Vec::new(); count];
    for &r in tree.order.iter().rev() {
        let Some((parent, pair)) = tree.parent[r as usize] else { continue };
        for (k, &above) in states[parent as usize].iter().enumerate() {
            let mut best = (f64::INFINITY, 0);
            for (j, (&state, &cost)) in states[r as usize].iter().zip(&costs[r as usize]).enumerate() {
                if cost < best.0 {
                    let whole = cost + between(&graph.pairs[pair as usize], state, above);
                    if whole < best.0 {
                        best = (whole, j as u32);
                    }
                }
            }
            costs[parent as usize][k] += best.0;
            below[r as usize].push(best.0);
            choices[r as usize].push(best.1);
        }
    }
    let mut chosen = vec![0u32; count];
    for &r in &tree.order {
        chosen[r as usize] = match tree.parent[r as usize] {
            Some((parent, _)) => choices[r as usize][chosen[parent as usize] as usize],
            None => lowest(&costs[r as usize]),
        };
    }
    let span = |r: usize| if own[r].is_empty() { None } else { states[r].get(chosen[r] as usize).copied() };
    Explanation { spans: (0..count).map(span).collect(), graph, tree, states, costs, below }
}

impl Explanation<'_> {
    /// Extra cost of the cheapest explanation in which a contour with this label does lie between two sub-domains, for
    /// several labels and pairs of sub-domains. Infinite where there is nothing to compare.
    pub fn margins(&self, wanted: &[(Label, [u32; 2])]) -> Vec<f64> {
        let beyond = self.beyond(wanted.iter().filter_map(|&(_, sides)| Some(self.tree_edge(sides)?.0)));
        let margin = |&(label, sides): &(Label, [u32; 2])| {
            let Some((child, parent, pair)) = self.tree_edge(sides) else { return f64::INFINITY };
            let (mut all, mut right) = (f64::INFINITY, f64::INFINITY);
            for (&above, &rest) in self.states[parent as usize].iter().zip(&beyond[child as usize]) {
                for (&state, &cost) in self.states[child as usize].iter().zip(&self.costs[child as usize]) {
                    let whole = cost + rest + between(&self.graph.pairs[pair as usize], state, above);
                    all = all.min(whole);
                    if separates(label, state, above) {
                        right = right.min(whole);
                    }
                }
            }
            right - all
        };
        wanted.iter().map(margin).collect()
    }

    /// Child, parent and pair of two sub-domains, if both exist and are neighbours in the tree.
    fn tree_edge(&self, [a, b]: [u32; 2]) -> Option<(u32, u32, u32)> {
        [(a, b), (b, a)].into_iter().find_map(|(child, other)| {
            let (parent, pair) = (*self.tree.parent.get(child as usize)?)?;
            (parent == other).then_some((child, parent, pair))
        })
    }

    /// For these sub-domains and each state of the parent: the cost of the best explanation of everything else but the
    /// subtree.
    fn beyond(&self, wanted: impl Iterator<Item = u32>) -> Vec<Vec<f64>> {
        let mut is_wanted = vec![false; self.states.len()];
        for r in wanted {
            let mut at = Some(r);
            while let Some(r) = at.filter(|&r| !std::mem::replace(&mut is_wanted[r as usize], true)) {
                at = self.tree.parent[r as usize].map(|(parent, _)| parent);
            }
        }
        let mut beyond: Vec<Vec<f64>> = vec![Vec::new(); self.states.len()];
        for &r in self.tree.order.iter().filter(|&&r| is_wanted[r as usize]) {
            let Some((parent, _)) = self.tree.parent[r as usize] else { continue };
            let rest = |(k, &state): (usize, &Span)| {
                let own = self.costs[parent as usize][k] - self.below[r as usize][k];
                let Some((above, pair)) = self.tree.parent[parent as usize] else { return own };
                let further = self.states[above as usize].iter().zip(&beyond[parent as usize]);
                let pair = &self.graph.pairs[pair as usize];
                own + further.map(|(&s, &cost)| cost + between(pair, state, s)).fold(f64::INFINITY, f64::min)
            };
            beyond[r as usize] = self.states[parent as usize].iter().enumerate().map(rest).collect();
        }
        beyond
    }
}

fn lowest(costs: &[f64]) -> u32 {
    (0..costs.len() as u32).min_by(|&a, &b| costs[a as usize].total_cmp(&costs[b as usize])).unwrap_or(0)
}

/// The cost of a sub-domain's state by itself.
fn alone(graph: &Graph, for_missing: f64, r: usize, span: Span) -> f64 {
    let ends: &[(Label, f64)] = &graph.dangling[r];
    let has_ends = |level: i64| ends.iter().any(|(l, _)| *l == Label::On(level));
    let mut hint = for_missing;
    let mut missing = || MISSING - std::mem::take(&mut hint);
    let skipped: f64 = span.skipped().map(|level| if has_ends(level) { GAP } else { missing() }).sum();
    let unmet = ends.iter().chain(&graph.one_sided[r]).filter(|(label, _)| !span.meets(*label));
    skipped + unmet.map(|(_, share)| WRONG * share).sum::<f64>()
}

/// The cost of the contours between two sub-domains.
fn between(pair: &Pair, a: Span, b: Span) -> f64 {
    let cost = |label: Label| match (separates(label, a, b), label) {
        (true, Label::On(_)) => 0.0,
        (true, Label::Within(_)) => AUXILIARY,
        (false, _) if levels_between(a, b).next().is_some() => WRONG,
        (false, _) => WRONG + NO_LEVEL,
    };
    pair.labels.iter().map(|&(label, share)| share * cost(label)).sum()
}

/// By sub-domain: the levels on its border with their shares, largest first.
fn own_levels(graph: &Graph, count: usize) -> Vec<Vec<(Label, f64)>> {
    let mut own: Vec<Vec<(Label, f64)>> =
        (0..count).map(|r| [&graph.one_sided[r][..], &graph.dangling[r]].concat()).collect();
    for pair in &graph.pairs {
        for r in pair.sides {
            own[r as usize].extend_from_slice(&pair.labels);
        }
    }
    for labels in &mut own {
        labels.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        labels.dedup_by(|a, b| {
            let same = a.0 == b.0;
            b.1 += if same { a.1 } else { 0.0 };
            same
        });
        labels.sort_by(|a, b| b.1.total_cmp(&a.1));
    }
    own
}

/// The states worth trying: the bands that touch the levels on the border or near it, and spans between two of them.
fn states(r: usize, graph: &Graph, own: &[Vec<(Label, f64)>], tree: &Tree) -> Vec<Span> {
    let mut bands: Vec<i64> = Vec::new();
    let mut levels: Vec<i64> = Vec::new();
    for (label, _) in own[r].iter().take(OWN_LEVELS) {
        match *label {
            Label::On(x) => {
                bands.extend([x - 1, x]);
                levels.push(x);
            }
            Label::Within(k) => {
                bands.push(k);
                levels.extend([k, k + 1]);
            }
        }
    }
    for &pair in &tree.near[r] {
        let [a, b] = graph.pairs[pair as usize].sides;
        let other = if a as usize == r { b } else { a };
        for (label, _) in own[other as usize].iter().take(NEAR_LEVELS) {
            match *label {
                Label::On(x) => bands.extend(x - 2..=x + 1),
                Label::Within(k) => bands.extend(k - 1..=k + 1),
            }
        }
        // Levels repeat, because one neighbour in the tree stands for many.
        if bands.len() > 4 * OWN_LEVELS * NEAR_LEVELS {
            bands.sort_unstable();
            bands.dedup();
            if bands.len() > OWN_LEVELS * NEAR_LEVELS {
                break;
            }
        }
    }
    bands.sort_unstable();
    bands.dedup();
    levels.sort_unstable();
    levels.dedup();
    let wide = levels.iter().enumerate().flat_map(|(i, &lo)| {
        let higher = levels[i + 1..].iter().filter(move |&&hi| (2..=MOST_SPANNED).contains(&(hi - lo)));
        higher.map(move |&hi| Span { lo, hi: hi - 1 })
    });
    bands.iter().map(|&k| Span { lo: k, hi: k }).chain(wide).collect()
}

/// A spanning forest of the graph along its longest borders.
struct Tree {
    /// The sub-domain above and the pair that leads to it.
    parent: Vec<Option<(u32, u32)>>,
    /// Sub-domains, each after its parent.
    order: Vec<u32>,
    /// The pairs of a sub-domain that belong to the forest.
    near: Vec<Vec<u32>>,
}

impl Tree {
    fn new(graph: &Graph, count: usize) -> Self {
        let mut by_length: Vec<u32> = (0..graph.pairs.len() as u32).collect();
        let length = |p: u32| graph.pairs[p as usize].length;
        by_length.sort_by(|&a, &b| length(b).total_cmp(&length(a)).then(a.cmp(&b)));
        let mut trees = UnionFind::new(count);
        let mut near: Vec<Vec<u32>> = vec![Vec::new(); count];
        for p in by_length {
            let [a, b] = graph.pairs[p as usize].sides;
            if trees.unite(a as usize, b as usize) {
                near[a as usize].push(p);
                near[b as usize].push(p);
            }
        }
        let mut parent: Vec<Option<(u32, u32)>> = vec![None; count];
        let mut seen = vec![false; count];
        let mut order = Vec::with_capacity(count);
        for first in 0..count as u32 {
            if std::mem::replace(&mut seen[first as usize], true) {
                continue;
            }
            let mut next = order.len();
            order.push(first);
            while let Some(&r) = order.get(next) {
                next += 1;
                for &p in &near[r as usize] {
                    let [a, b] = graph.pairs[p as usize].sides;
                    let other = if a == r { b } else { a };
                    if !std::mem::replace(&mut seen[other as usize], true) {
                        parent[other as usize] = Some((r, p));
                        order.push(other);
                    }
                }
            }
        }
        Self { parent, order, near }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_between_spans() {
        let span = |lo, hi| Span { lo, hi };
        let between = |a, b| levels_between(a, b).collect::<Vec<_>>();
        assert_eq!(between(span(3, 3), span(4, 4)), [4]);
        assert_eq!(between(span(4, 4), span(3, 3)), [4]);
        assert_eq!(between(span(3, 3), span(3, 3)), [0; 0]);
        assert_eq!(between(span(3, 3), span(5, 5)), [0; 0]);
        assert_eq!(between(span(3, 5), span(4, 4)), [4, 5]);
        assert_eq!(between(span(3, 5), span(6, 6)), [6]);
    }
}
