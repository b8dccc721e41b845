//! Lines of a map in millimetres, interrupted where labels stand.

use glam::DVec2;

use tokosen_core::slice::Label;

use super::page::Placed;

/// Vertices closer than this to the last one are left out, millimetres.
const FINE: f64 = 0.02;
/// Lines are interrupted this far around a label, millimetres.
const GAP: f64 = 0.35;

/// From map units to the sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    /// Upper left corner of the map in map units.
    corner: DVec2,
    placed: Placed,
}

impl Way {
    pub fn new(corner: DVec2, placed: Placed) -> Self {
        Self { corner, placed }
    }

    /// A place of the map on the sheet.
    pub fn to_sheet(self, p: DVec2) -> DVec2 {
        self.placed.frame[0] + DVec2::new(p.x - self.corner.x, self.corner.y - p.y) / self.placed.unit
    }

    /// Lines on the sheet, as far as they meet the map, with gaps at labels.
    pub fn lines(self, lines: impl Iterator<Item = Vec<DVec2>>, gaps: &[Gap]) -> Vec<Vec<DVec2>> {
        let [from, to] = self.placed.frame;
        let mut out = Vec::new();
        for line in lines {
            let points: Vec<DVec2> = line.into_iter().map(|p| self.to_sheet(p)).collect();
            for run in points.split(|p| !p.is_finite()) {
                let run = coarse(run);
                let lo = run.iter().copied().fold(DVec2::INFINITY, DVec2::min);
                let hi = run.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
                if run.len() < 2 || !(hi.cmpge(from).all() && lo.cmple(to).all()) {
                    continue;
                }
                let near: Vec<&Gap> = gaps.iter().filter(|gap| gap.is_near(lo, hi)).collect();
                out.extend(interrupted(&run, &near));
            }
        }
        out
    }
}

/// The vertices that make a difference on paper.
fn coarse(line: &[DVec2]) -> Vec<DVec2> {
    let last = line.len().saturating_sub(1);
    let mut kept: Vec<DVec2> = Vec::new();
    for (k, p) in line.iter().enumerate() {
        if k == last || kept.last().is_none_or(|kept| kept.distance_squared(*p) >= FINE * FINE) {
            kept.push(*p);
        }
    }
    kept
}

/// Room for a label, into which no line goes: a turned rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap {
    middle: DVec2,
    /// The direction of its longer side.
    along: DVec2,
    /// Half its sides.
    half: DVec2,
}

impl Gap {
    pub fn of(label: &Label, way: Way) -> Self {
        let corners = label.corners(0.0).map(|p| way.to_sheet(p));
        let (side, other) = (corners[1] - corners[0], corners[2] - corners[1]);
        let half = DVec2::new(side.length(), other.length()) / 2.0 + GAP;
        Self { middle: way.to_sheet(label.position), along: side.normalize_or(DVec2::X), half }
    }

    fn is_near(&self, lo: DVec2, hi: DVec2) -> bool {
        let reach = self.half.length();
        (self.middle + reach).cmpge(lo).all() && (self.middle - reach).cmple(hi).all()
    }

    /// The part of a segment inside, as shares of its length.
    fn inside(&self, a: DVec2, b: DVec2) -> Option<[f64; 2]> {
        let own = |p: DVec2| {
            let d = p - self.middle;
            DVec2::new(d.dot(self.along), d.dot(self.along.perp()))
        };
        let (start, step) = (own(a), own(b) - own(a));
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for (start, step, half) in [(start.x, step.x, self.half.x), (start.y, step.y, self.half.y)] {
            if step == 0.0 {
                if start.abs() >= half {
                    return None;
                }
                continue;
            }
            let (p, q) = ((-half - start) / step, (half - start) / step);
            (first, last) = (first.max(p.min(q)), last.min(p.max(q)));
        }
        (first < last).then_some([first, last])
    }
}

/// The pieces of a line outside of gaps.
fn interrupted(line: &[DVec2], gaps: &[&Gap]) -> Vec<Vec<DVec2>> {
    if gaps.is_empty() {
        return vec![line.to_vec()];
    }
    let mut pieces: Vec<Vec<DVec2>> = Vec::new();
    let mut open: Vec<DVec2> = Vec::new();
    for pair in line.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let mut hidden: Vec<[f64; 2]> = gaps.iter().filter_map(|gap| gap.inside(a, b)).collect();
        hidden.sort_by(|p, q| p[0].total_cmp(&q[0]));
        let mut from = 0.0;
        for [first, last] in hidden.into_iter().chain([[1.0, 2.0]]) {
            if first > from {
                if open.is_empty() {
                    open.push(a.lerp(b, from));
                }
                open.push(a.lerp(b, first));
            }
            if first < 1.0 && !open.is_empty() {
                pieces.push(std::mem::take(&mut open));
            }
            from = f64::max(from, last);
        }
    }
    pieces.push(open);
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stop_at_labels_and_go_on_behind_them() {
        let gap = Gap { middle: DVec2::new(5.0, 0.0), along: DVec2::X, half: DVec2::new(2.0, 1.0) };
        let line: Vec<DVec2> = [0.0, 2.0, 4.0, 6.0, 10.0].map(|x| DVec2::new(x, 0.0)).to_vec();
        let xs = |pieces: Vec<Vec<DVec2>>| {
            pieces.into_iter().map(|piece| piece.into_iter().map(|p| p.x).collect()).collect::<Vec<Vec<f64>>>()
        };
        assert_eq!(xs(interrupted(&line, &[&gap])), [vec![0.0, 2.0, 3.0], vec![7.0, 10.0]]);
        assert_eq!(xs(interrupted(&line, &[])), [vec![0.0, 2.0, 4.0, 6.0, 10.0]]);
        let beside = Gap { middle: DVec2::new(5.0, 3.0), ..gap };
        assert_eq!(interrupted(&line, &[&beside]), std::slice::from_ref(&line));
        // Turned by a right angle, it hides less.
        let turned = Gap { along: DVec2::Y, ..gap };
        assert_eq!(xs(interrupted(&line, &[&turned])), [vec![0.0, 2.0, 4.0], vec![6.0, 10.0]]);
        let two = Gap { middle: DVec2::new(9.0, 0.0), ..gap };
        assert_eq!(xs(interrupted(&line, &[&gap, &two])), [vec![0.0, 2.0, 3.0]]);
    }
}
