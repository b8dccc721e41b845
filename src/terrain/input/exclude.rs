//! Parts of the map that are left out: contours inside them are wrong or belong to something else.

use geo::{BoundingRect, MultiPolygon};
use glam::DVec2;

use super::Input;
use tokosen_core::base::error::{Finding, FindingKind, Result};
use tokosen_core::clean::{is_place, without_bad_points};
use tokosen_core::contour::{CutOut, Excluded, cut_out};
use tokosen_core::crs::Crs;
use tokosen_core::geometry::Border;

/// What a missing piece of ground causes. Inside a part that is left out, it is no fault.
const EXPECTED: [FindingKind; 5] =
    [FindingKind::Gap, FindingKind::OpenEnd, FindingKind::SkippedLevel, FindingKind::MayBeLake, FindingKind::MayBeSea];

impl Input {
    /// Leaves out the contours and spot heights inside polygons. `file` names their source in findings.
    ///
    /// # Errors
    /// As [`Input::add`].
    pub(super) fn exclude(&mut self, polygons: &[Excluded], crs: Option<&Crs>, file: &str) -> Result<()> {
        let to_working = self.reprojection.bring(crs)?;
        let areas = polygons.iter().map(|excluded| to_working.boundary(&excluded.polygon.clone().into()));
        let areas = areas.collect::<Result<Vec<MultiPolygon<f64>>>>()?;
        self.drop_bad_points();
        let found = cut_out(&mut self.map, &areas);
        for ((polygon, area), taken) in polygons.iter().zip(&areas).zip(&found).filter(|(_, taken)| !taken.is_empty()) {
            let CutOut { lines, length, spots } = taken;
            let message = format!(
                "inside the polygon of feature {} of {file}, {length:.1} map units of {lines} contours and {spots} spot \
                 heights were left out",
                polygon.feature
            );
            let place = area.bounding_rect().map(|rect| {
                let middle = rect.center();
                DVec2::new(middle.x, middle.y)
            });
            self.findings.push(Finding::new(FindingKind::Excluded, place, message));
        }
        let empty = found.iter().filter(|taken| taken.is_empty()).count();
        if empty == found.len() {
            let message = format!(
                "no contour and no spot height lies inside a polygon of {file}, so nothing was left out; check its \
                 coordinate reference system"
            );
            self.findings.push(Finding::general(FindingKind::NothingExcluded, message));
        } else if empty > 0 {
            let message =
                format!("{empty} of the {} polygons of {file} hold no contour and no spot height", found.len());
            self.findings.push(Finding::general(FindingKind::Excluded, message));
        }
        self.excluded.extend(areas);
        self.state_unit();
        Ok(())
    }

    /// Leaves out points without valid coordinates, which cleaning would leave out later: a line with such a point cannot
    /// be cut.
    fn drop_bad_points(&mut self) {
        let lines = std::mem::take(&mut self.map.contours);
        let is_sound = |points: &[DVec2]| points.iter().all(|p| is_place(*p));
        let (mut sound, bad): (Vec<_>, Vec<_>) = lines.into_iter().partition(|line| is_sound(&line.points));
        sound.extend(without_bad_points(bad).collect(&mut self.findings));
        self.map.contours = sound;
    }

    /// [`drop_expected`] for all findings.
    pub(in crate::terrain) fn drop_expected(&mut self) {
        drop_expected(&mut self.findings, &self.excluded);
    }
}

/// Leaves out the findings that only say that ground is missing where it was left out.
pub(in crate::terrain) fn drop_expected(findings: &mut Vec<Finding>, excluded: &[MultiPolygon<f64>]) {
    // Where parts overlap, a position can be inside of an even number of rings. So each part is asked for itself.
    let borders: Vec<Border> = excluded.iter().map(Border::new).collect();
    let is_in = |p: DVec2| borders.iter().any(|border| border.contains(p) || border.edge_at(p).is_some());
    let is_expected = |f: &Finding| EXPECTED.contains(&f.kind) && f.place.is_some_and(is_in);
    findings.retain(|finding| !is_expected(finding));
}
