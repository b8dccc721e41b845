//! Corrections that findings propose, and the map with these corrections.

use glam::DVec2;

use crate::base::error::{Finding, FindingKind, Report};
use crate::contour::{Contour, ContourMap};

/// A correction of a clean map.
#[derive(Debug, Clone, PartialEq)]
pub enum Correction {
    /// Give a line another elevation.
    Label {
        /// The line's number in the map.
        line: u32,
        /// The elevation that fits, metres.
        elevation: f64,
    },
    /// Join two ends with a straight piece.
    Join {
        /// Numbers of the two lines in the map; equal if a line is closed this way.
        lines: [u32; 2],
        /// The ends, map units.
        ends: [DVec2; 2],
    },
    /// Remove a vertex: the line goes straight past it.
    LeaveOut {
        /// The line's number in the map.
        line: u32,
        /// The vertex's number on the line. The first and last vertex of a closed line count as the first.
        vertex: u32,
    },
}

/// The result of checking a clean map.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Judged {
    /// The findings, in a fixed order.
    pub findings: Vec<Finding>,
    /// The corrections that the findings propose.
    pub corrections: Vec<Correction>,
    /// Numbers of the lines that contradict the ground around them, without a clear elevation for them; ascending.
    pub doubted: Vec<u32>,
}

/// Applies the corrections. The map needs cleaning afterwards: lines of one level may meet now, and the ends of new
/// pieces lie on the ends of the lines that they join.
///
/// The findings report every correction that was applied.
pub fn correct(mut map: ContourMap, corrections: &[Correction]) -> Report<ContourMap> {
    let mut findings = Vec::new();
    let mut pieces = Vec::new();
    let mut left_out = Vec::new();
    for correction in corrections {
        match *correction {
            Correction::Label { line, elevation } => {
                let Some(contour) = map.contours.get_mut(line as usize) else { continue };
                let (from, feature) = (contour.elevation, contour.feature);
                contour.elevation = elevation;
                let message = format!("the contour {from} m (feature {feature}) got the elevation {elevation} m");
                let place = contour.points.get(contour.points.len() / 2).copied();
                let finding = Finding::new(FindingKind::Relabelled, place, message);
                findings.push(finding.about(feature, from).about(feature, elevation));
            }
            Correction::Join { lines, ends: [a, b] } => {
                let line = |k: usize| map.contours.get(lines[k] as usize);
                let (Some(one), Some(other)) = (line(0), line(1)) else { continue };
                let (elevation, gap) = (one.elevation, a.distance(b));
                let message = format!(
                    "a gap of {gap:.3} map units in the contour {elevation} m (features {} and {}) was joined",
                    one.feature, other.feature
                );
                let finding = Finding::at(FindingKind::JoinedGap, a.midpoint(b), message);
                findings.push(finding.about(one.feature, elevation).about(other.feature, elevation));
                let feature = one.feature.min(other.feature);
                pieces.push(Contour { elevation, points: vec![a, b], feature });
            }
            Correction::LeaveOut { line, vertex } => {
                let Some(contour) = map.contours.get(line as usize) else { continue };
                let Some(&place) = contour.points.get(vertex as usize) else { continue };
                let (elevation, feature) = (contour.elevation, contour.feature);
                let message =
                    format!("a vertex of the contour {elevation} m (feature {feature}) off its course was left out");
                findings.push(Finding::at(FindingKind::Straightened, place, message).about(feature, elevation));
                left_out.push((line, vertex));
            }
        }
    }
    // From the last vertex to the first: the numbers of the others stay valid.
    left_out.sort_unstable();
    left_out.dedup();
    for (line, vertex) in left_out.into_iter().rev() {
        let points = &mut map.contours[line as usize].points;
        let is_end = vertex == 0 && points.len() > 2 && points.first() == points.last();
        points.remove(vertex as usize);
        if is_end {
            points.pop();
            points.extend(points.first().copied());
        }
    }
    map.contours.append(&mut pieces);
    Report { value: map, findings }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clean::{CleanParams, clean};

    #[test]
    fn vertices_are_left_out_of_lines_and_rings() {
        let ring = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 9.0), (0.0, 4.0), (0.0, 0.0)].map(DVec2::from);
        let line = Contour { elevation: 10.0, points: ring.to_vec(), feature: 1.into() };
        let map = ContourMap { contours: vec![line], ..ContourMap::default() };
        let leave_out = |vertex: u32| Correction::LeaveOut { line: 0, vertex };
        let Report { value, findings } = correct(map, &[leave_out(3), leave_out(0), leave_out(3)]);
        assert!(findings.iter().all(|f| f.kind == FindingKind::Straightened));
        assert_eq!(value.contours[0].points, [ring[1], ring[2], ring[4], ring[1]]);
    }

    #[test]
    fn a_label_and_a_gap_are_mended() {
        let line = |elevation: f64, points: &[(f64, f64)], feature: u64| Contour {
            elevation,
            points: points.iter().map(|&p| p.into()).collect(),
            feature: feature.into(),
        };
        let map = ContourMap {
            contours: vec![
                line(10.0, &[(0.0, 0.0), (4.0, 0.0)], 1),
                line(10.0, &[(6.0, 0.0), (9.0, 0.0)], 2),
                line(90.0, &[(0.0, 5.0), (9.0, 5.0)], 3),
            ],
            ..ContourMap::default()
        };
        let ends = [DVec2::new(4.0, 0.0), DVec2::new(6.0, 0.0)];
        let corrections = [Correction::Join { lines: [0, 1], ends }, Correction::Label { line: 2, elevation: 20.0 }];
        let Report { value, findings } = correct(map, &corrections);
        let kinds: Vec<FindingKind> = findings.iter().map(|f| f.kind).collect();
        assert_eq!(kinds, [FindingKind::JoinedGap, FindingKind::Relabelled]);
        assert_eq!(findings[1].elevations, [90.0, 20.0]);
        let clean = clean(value, &CleanParams::default()).unwrap().value.contours;
        assert_eq!(
            clean,
            [
                line(10.0, &[(0.0, 0.0), (4.0, 0.0), (6.0, 0.0), (9.0, 0.0)], 1),
                line(20.0, &[(0.0, 5.0), (9.0, 5.0)], 3)
            ]
        );
    }
}
