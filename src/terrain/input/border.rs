//! Polygons at whose border contours end.

use geo::MultiPolygon;

use super::Input;
use tokosen_core::base::error::Result;
use tokosen_core::crs::Crs;
use tokosen_core::geometry::{Border, OnEdge, OrientedBox, point_distance, with_vertices};

impl Input {
    /// Polygons on the working plane. A straight edge of theirs may be a curve there, whose place is known within a millimetre.
    /// Contours that were cut in the coordinates of the file end so near to it; the border then goes through their ends.
    pub(super) fn border_through_ends(&self, area: &MultiPolygon<f64>, crs: Option<&Crs>) -> Result<MultiPolygon<f64>> {
        let to_working = self.reprojection.bring(crs)?;
        let area = to_working.boundary(area)?;
        let Some(reach) = to_working.straight() else { return Ok(area) };
        let border = Border::new(&area);
        let open = self.map.contours.iter().filter(|line| !line.is_closed());
        let ends = open.flat_map(|line| [line.points.first(), line.points.last()]).flatten();
        let beside_an_edge = ends.filter_map(|&end| {
            let near = border.near_box(OrientedBox::around(&[end]).grown(reach));
            let (distance, edge, id) = near
                .map(|(id, edge)| (point_distance(end, &edge), edge, id))
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)))?;
            let is_at_corner = edge.a.distance(end).min(edge.b.distance(end)) <= reach;
            (distance > border.tolerance() && distance <= reach && !is_at_corner).then_some((id, end))
        });
        let vertices: Vec<OnEdge> = beside_an_edge.collect();
        Ok(with_vertices(&area, vertices))
    }
}
