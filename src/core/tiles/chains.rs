//! Joins lines of one level that meet at their ends.
//!
//! Where a contour of the input ends inside the map, a new line goes on. In tiles both are one line, which is simplified as a
//! whole. Where three ends meet, lines stay apart.

use std::collections::HashMap;

use glam::DVec2;

use super::network::LevelLine;
use crate::base::bits::bits;

/// An end of a line: its number, and whether it is the last vertex.
type End = (usize, bool);

/// The lines, with those joined whose ends meet in pairs.
pub(super) fn chains(lines: Vec<LevelLine>) -> Vec<LevelLine> {
    let mut ends: HashMap<(u32, [u64; 2]), Vec<End>> = HashMap::new();
    for (i, line) in lines.iter().enumerate().filter(|(_, line)| !is_ring(&line.points)) {
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
    if partner.is_empty() {
        return lines;
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
        while let Some(line) = lines[entry.0].take() {
            let mut part = line.points;
            if entry.1 {
                part.reverse();
            }
            points.extend(part.into_iter().skip(usize::from(!points.is_empty())));
            let Some(next) = partner.get(&(entry.0, !entry.1)) else { break };
            entry = *next;
        }
        joined.push(LevelLine { level, points });
    }
    joined
}

/// Whether a line ends where it starts, around an area.
pub(super) fn is_ring(points: &[DVec2]) -> bool {
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
        assert!(found.iter().all(|line| is_ring(&line.points)));
        let star = vec![
            line(1, &[[0.0, 0.0], [1.0, 0.0]]),
            line(1, &[[0.0, 0.0], [0.0, 1.0]]),
            line(1, &[[0.0, 0.0], [-1.0, 0.0]]),
        ];
        assert_eq!(chains(star.clone()), star);
    }
}
