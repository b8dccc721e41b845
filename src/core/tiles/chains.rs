//! Joins lines of one level that meet at their ends.
//!
//! Where a contour of the input ends inside the map, a new line goes on. In tiles both are one line, which is simplified as a
//! whole. A line that another one ends on is divided there first. Where three ends meet, lines stay three.

use std::collections::{HashMap, HashSet};

use glam::DVec2;

use super::network::LevelLine;
use crate::base::bits::bits;

/// An end of a line: its number, and whether it is the last vertex.
type End = (usize, bool);

/// Lines that were joined.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    pub level: u32,
    pub points: Vec<DVec2>,
    /// Whether it closes, and no other line ends where it does. It repeats its first point.
    pub is_ring: bool,
}

/// The lines, with those joined whose ends meet in pairs.
pub(super) fn chains(lines: Vec<LevelLine>) -> Vec<Chain> {
    let lines = divided(lines);
    let mut ends: HashMap<(u32, [u64; 2]), Vec<End>> = HashMap::new();
    for (i, line) in lines.iter().enumerate() {
        for (point, is_last) in [(line.points.first(), false), (line.points.last(), true)] {
            let Some(point) = point else { continue };
            ends.entry((line.level, bits(*point))).or_default().push((i, is_last));
        }
    }
    let mut partner: HashMap<End, End> = HashMap::new();
    for pair in ends.values().filter(|ends| ends.len() == 2) {
        partner.insert(pair[0], pair[1]);
        partner.insert(pair[1], pair[0]);
    }
    let mut lines: Vec<Option<LevelLine>> = lines.into_iter().map(Some).collect();
    let mut joined = Vec::with_capacity(lines.len());
    // Chains with a free end first, then those that close.
    let free = (0..lines.len()).flat_map(|i| [(i, false), (i, true)]).filter(|end| !partner.contains_key(end));
    let starts: Vec<End> = free.chain((0..lines.len()).map(|i| (i, false))).collect();
    for start in starts {
        let Some(level) = lines[start.0].as_ref().map(|line| line.level) else { continue };
        let mut points: Vec<DVec2> = Vec::new();
        let mut entry = start;
        let mut is_ring = false;
        while let Some(line) = lines[entry.0].take() {
            let mut part = line.points;
            if entry.1 {
                part.reverse();
            }
            points.extend(part.into_iter().skip(usize::from(!points.is_empty())));
            let Some(next) = partner.get(&(entry.0, !entry.1)) else { break };
            entry = *next;
            is_ring = entry == start;
        }
        is_ring &= points.len() >= 4;
        joined.push(Chain { level, points, is_ring });
    }
    joined
}

/// The lines, divided where an end of another line of their level is.
fn divided(lines: Vec<LevelLine>) -> Vec<LevelLine> {
    let open = lines.iter().filter(|line| !is_ring(&line.points));
    let ends = open.flat_map(|line| [line.points.first(), line.points.last()].map(|p| (line.level, p)));
    let ends: HashSet<(u32, [u64; 2])> = ends.filter_map(|(level, p)| Some((level, bits(*p?)))).collect();
    let mut parts = Vec::with_capacity(lines.len());
    for LevelLine { level, mut points } in lines {
        let is_end = |p: &DVec2| ends.contains(&(level, bits(*p)));
        if is_ring(&points) {
            match points.iter().position(is_end) {
                // It begins where the other line ends, and is no ring then.
                Some(first) => {
                    points.pop();
                    points.rotate_left(first);
                    points.push(points[0]);
                }
                None => {
                    parts.push(LevelLine { level, points });
                    continue;
                }
            }
        }
        let last = points.len().saturating_sub(1);
        let mut cuts: Vec<usize> = (1..last).filter(|k| is_end(&points[*k])).collect();
        while let Some(cut) = cuts.pop() {
            parts.push(LevelLine { level, points: points[cut..].to_vec() });
            points.truncate(cut + 1);
        }
        parts.push(LevelLine { level, points });
    }
    parts
}

/// Whether a line ends where it starts, around an area.
fn is_ring(points: &[DVec2]) -> bool {
    points.len() >= 4 && points.first() == points.last()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(level: u32, points: &[[f64; 2]]) -> LevelLine {
        LevelLine { level, points: points.iter().map(|p| DVec2::from(*p)).collect() }
    }

    #[test]
    fn ends_of_one_level_are_joined_in_either_direction() {
        let parts = vec![
            line(1, &[[0.0, 0.0], [1.0, 0.0]]),
            line(1, &[[2.0, 0.0], [1.0, 0.0]]),
            line(2, &[[2.0, 0.0], [2.0, 1.0]]),
            line(1, &[[2.0, 0.0], [3.0, 0.0]]),
        ];
        let mut found = chains(parts);
        found.sort_by_key(|line| line.level);
        assert_eq!(found.len(), 2);
        let along: Vec<f64> = found[0].points.iter().map(|p| p.x).collect();
        assert_eq!(along, [0.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn parts_of_a_ring_close_and_junctions_stay() {
        let halves = vec![
            line(1, &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]),
            line(1, &[[1.0, 1.0], [0.0, 1.0], [0.0, 0.0]]),
            line(1, &[[5.0, 5.0], [6.0, 5.0], [6.0, 6.0], [5.0, 5.0]]),
        ];
        let found = chains(halves);
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|line| line.is_ring && is_ring(&line.points)));
        let star = vec![
            line(1, &[[0.0, 0.0], [1.0, 0.0]]),
            line(1, &[[0.0, 0.0], [0.0, 1.0]]),
            line(1, &[[0.0, 0.0], [-1.0, 0.0]]),
        ];
        let found = chains(star.clone());
        assert!(found.iter().zip(&star).all(|(found, line)| found.points == line.points && !found.is_ring));
    }

    #[test]
    fn a_line_is_divided_where_another_one_of_its_level_ends() {
        let along = line(1, &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
        let ring = line(1, &[[9.0, 9.0], [8.0, 9.0], [8.0, 8.0], [9.0, 9.0]]);
        let found = chains(vec![along.clone(), ring.clone(), line(2, &[[1.0, 0.0], [8.0, 8.0]])]);
        assert_eq!(found.iter().filter(|line| line.points == along.points || line.is_ring).count(), 2);
        assert_eq!(found.len(), 3);
        let found = chains(vec![along, ring, line(1, &[[1.0, 0.0], [8.0, 8.0]])]);
        assert_eq!(found.len(), 4, "{found:?}");
        assert!(found.iter().all(|line| line.points.len() < 5));
        assert!(
            found.iter().any(|line| line.points[0] == DVec2::new(8.0, 8.0) && is_ring(&line.points) && !line.is_ring)
        );
    }
}
