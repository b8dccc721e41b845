//! Vertices that stand out of a line that is smooth otherwise. Digitising or typing errors make them.

use crate::base::error::{Finding, FindingKind, Proposal};
use crate::base::parallel;
use crate::check::{Correction, Judged};
use crate::contour::{Contour, ContourMap, outlying_vertices};

pub(super) fn find(map: &ContourMap) -> Judged {
    let of_line = |(line, contour): (usize, &Contour)| {
        let name = format!("the contour {} m (feature {})", contour.elevation, contour.feature);
        let of_vertex = |vertex: usize| {
            let place = contour.points[vertex];
            let message = format!("{name} has a vertex off its course: the line runs there and nearly straight back");
            let finding = Finding::at(FindingKind::StrayVertex, place, message);
            let finding = finding.about(contour.feature, contour.elevation).proposing(Proposal::LeaveOut);
            (finding, Correction::LeaveOut { line: line as u32, vertex: vertex as u32 })
        };
        outlying_vertices(&contour.points).into_iter().map(of_vertex).collect::<Vec<_>>()
    };
    let (findings, corrections) =
        parallel::flat_map(map.contours.len(), |i| of_line((i, &map.contours[i]))).into_iter().unzip();
    Judged { findings, corrections, ..Judged::default() }
}
