//! Preparation of the lines: they are examined, repaired, cleaned, fitted and sampled.

use geo::MultiPolygon;

use super::input::Input;
use super::options::Options;
use super::part::{Part, drop_outside};
use super::plausible;
use super::preparation::{Preparation, Repair};
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result, Severity};
use tokosen_core::base::memory;
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::check::{LineParams, correct, examine, first_causes, merged, placeholders};
use tokosen_core::clean::clean;
use tokosen_core::contour::{ContourMap, find_interval};
use tokosen_core::resample::{FitParams, fit, sample};
use tokosen_core::streams::{Stream, Streams};
use tokosen_core::subdivision::{Subdivision, Water, subdivide, subdivide_with_water};
use tokosen_core::subdomains::settled;
use tokosen_core::surface::{Given, SurfaceParams, settle_lines};

/// The findings that report a change of the lines.
const REPAIRS: &[FindingKind] = &[
    FindingKind::NonFinitePoint,
    FindingKind::RepeatedPoint,
    FindingKind::PointLine,
    FindingKind::DuplicateLine,
    FindingKind::Spike,
    FindingKind::OverlappingLines,
    FindingKind::SelfCross,
    FindingKind::LevelsCross,
    FindingKind::ClosedGap,
    FindingKind::SpotOnLine,
    FindingKind::Relabelled,
    FindingKind::JoinedGap,
    FindingKind::Straightened,
];

/// Bytes of memory per vertex of contours until they are triangulated, as measured (560 on three maps with 60,000 to
/// 1.06 million vertices).
const BYTES_PER_VERTEX: f64 = 600.0;
/// Bytes of memory per vertex of contours until they are clean, as measured (200 on a map of 1.33 million vertices). Of a part, only
/// the lines around it are triangulated.
const BYTES_PER_CLEAN_VERTEX: f64 = 220.0;

/// How often a map is examined again after corrections, because one correction can reveal another fault.
const ROUNDS: usize = 3;

/// Whether a finding reports a change of the lines.
pub fn is_repair(finding: &Finding) -> bool {
    REPAIRS.contains(&finding.kind)
}

impl Input {
    /// Examines, repairs and cleans the lines; fits and samples them if the parameters say so.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a parameter. [`Error::NeedsRepair`] if repair is needed but not allowed.
    /// [`Error::Strict`] if the preparation is strict and there is an error or a warning. As [`clean`](fn@clean),
    /// [`fit`](fn@fit) and [`sample`](fn@sample). The findings up to then stay in the input.
    pub fn prepare(&mut self, params: &Preparation, progress: &dyn Progress) -> Result<()> {
        self.clean(params, progress)?;
        let repairs = self.findings.iter().filter(|finding| is_repair(finding)).count();
        if params.repair == Repair::None && repairs > 0 {
            return Err(Error::NeedsRepair { input: self.name().into_owned(), places: repairs });
        }
        let near = params.near();
        if let Some(tolerance) = params.fit {
            let map = std::mem::take(&mut self.map);
            let fit_params = FitParams { tolerance, sampling: params.sampling() };
            let fitted = step(progress, "fitting", || fit(map, &fit_params, &near));
            let mut fitted = self.named(fitted)?.collect(&mut self.findings);
            self.map = std::mem::take(&mut fitted.map);
            self.fitted = Some(fitted);
        }
        if let Some(sampling) = params.sampling() {
            let map = std::mem::take(&mut self.map);
            let sampled = step(progress, "sampling", || sample(map, &sampling, &near));
            let mut sampled = self.named(sampled)?.collect(&mut self.findings);
            self.map = std::mem::take(&mut sampled.map);
            self.sampled = Some(sampled);
        }
        self.is_strict = params.strict;
        self.check_strict()?;
        self.is_prepared = true;
        Ok(())
    }

    /// Examines, repairs and cleans the lines.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a parameter, [`Error::OutOfMemory`] for a map that is too large, and as
    /// [`clean`](fn@clean). The findings up to then stay in the input.
    pub fn clean(&mut self, params: &Preparation, progress: &dyn Progress) -> Result<()> {
        params.check()?;
        self.check_memory(if self.part.is_some() { BYTES_PER_CLEAN_VERTEX } else { BYTES_PER_VERTEX })?;
        let cleaned = self.clean_lines(params, progress);
        self.state_unit();
        cleaned?;
        self.frame = settled(std::mem::take(&mut self.frame), &mut self.map, &mut self.findings);
        if params.repair == Repair::All {
            let corrected = self.correct_ground(params, progress);
            self.state_unit();
            corrected?;
        }
        self.explain_by_cliffs();
        Ok(())
    }

    /// Refuses a map whose vertices need more memory than there is.
    fn check_memory(&self, per_vertex: f64) -> Result<()> {
        let vertices = self.map.vertex_count();
        let remedy = "choose a part of the map, or close other programs";
        memory::check(per_vertex * vertices as f64, self.memory, format!("a map of {vertices} vertices"), remedy)
    }

    /// Leaves out what lies outside of the window around a part.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`] if the rest of the map is too large.
    pub(super) fn cut_to(&mut self, part: &Part) -> Result<()> {
        part.cut(&mut self.map);
        self.check_memory(BYTES_PER_VERTEX)
    }

    /// Leaves out lines and spot heights whose elevation stands for no data, however far the lines are repaired: they have no
    /// elevation. Then cleans the lines. With [`Repair::All`], sudden changes of elevation along a line and stray vertices are
    /// corrected first.
    fn clean_lines(&mut self, params: &Preparation, progress: &dyn Progress) -> Result<()> {
        let (near, line_params) = (params.near(), LineParams { snap: params.snap });
        let mut map = std::mem::take(&mut self.map);
        let known_levels: Vec<f64> = self.coast.iter().chain(&self.known_levels).copied().collect();
        self.findings.append(&mut placeholders(&map, &known_levels).leave_out(&mut map));
        let mut implausible = plausible::findings(&map);
        implausible.retain(|finding| !self.depths || finding.elevations.iter().any(|z| *z > 0.0));
        self.findings.append(&mut implausible);
        let (examined, cleaned) = step(progress, "cleaning", || {
            let mut judged = examine(&map, &line_params);
            if params.repair == Repair::All && !judged.corrections.is_empty() {
                map = correct(std::mem::take(&mut map), &judged.corrections).collect(&mut self.findings);
                judged = examine(&map, &line_params);
            }
            judged.findings.retain(|finding| finding.kind != FindingKind::ZeroElevation);
            (judged.findings, clean(map, &near))
        });
        match cleaned {
            Ok(Report { value, findings: cleaning }) => {
                self.map = value;
                self.findings.extend(merged(examined, cleaning, params.snap.max(near.separation)));
                Ok(())
            }
            Err(error) => {
                self.findings.extend(examined);
                self.named(Err(error))
            }
        }
    }

    /// Corrects elevations and joins lines, as the comparison of neighbouring lines proposes.
    fn correct_ground(&mut self, params: &Preparation, progress: &dyn Progress) -> Result<()> {
        for _ in 0..ROUNDS {
            // If no surface can be made of the map, the step that makes it reports the error.
            let Ok(subdivision) = subdivide(self.map.clone(), &self.frame, progress) else { break };
            let Subdivision { map, corrections, .. } = subdivision.value;
            if corrections.is_empty() {
                break;
            }
            // The numbers of lines in corrections are those of the map inside the frame.
            let map = correct(map, &corrections).collect(&mut self.findings);
            let cleaned = step(progress, "cleaning", || clean(map, &params.near()));
            self.map = self.named(cleaned)?.collect(&mut self.findings);
        }
        Ok(())
    }

    /// Compares neighbouring contours, and lakes, streams and break lines with them. Adds the faults to the findings, each
    /// once, and returns the map. Of the options, the level of the sea and the tolerance of streams count.
    ///
    /// With fewer than two levels nothing can be compared; that is a finding too. Findings outside of the frame polygon or of
    /// the part are counted and left out.
    ///
    /// # Errors
    /// As [`subdivide_with_water`]. The findings stay in the input.
    pub fn judge(&mut self, options: &Options, progress: &dyn Progress) -> Result<ContourMap> {
        let border = self.part.as_ref().or(self.frame.polygon()).cloned();
        self.take_part()?;
        let judged = self.judge_whole(options, progress);
        self.findings_outside += border.map_or(0, |area| drop_outside(&mut self.findings, &area));
        judged
    }

    fn judge_whole(&mut self, options: &Options, progress: &dyn Progress) -> Result<ContourMap> {
        let map = std::mem::take(&mut self.map);
        let flat = find_interval(&map.contours).is_none().then(|| map.clone());
        let (params, given) = (self.surface_params(options, None), self.given(options));
        params.check()?;
        match (subdivide_with_water(map, &params.frame, &given.water, progress), flat) {
            (Err(error @ (Error::NoContours { .. } | Error::TooFewLevels { .. })), Some(map)) => {
                self.findings.push(Finding::general(FindingKind::TooFewLevels, error.to_string()));
                Ok(map)
            }
            (subdivision, _) => {
                let subdivision = self.found(subdivision)?;
                let settled = settle_lines(&subdivision, &given, &params, progress);
                self.findings.extend(settled.findings);
                self.state_unit();
                Ok(subdivision.map)
            }
        }
    }

    /// Triangulates the map and finds its sub-domains, with the lakes of the input and the sea at the level `sea`.
    /// The map is moved out of the input. If a part of the map is asked for, the sub-domains are those of a window around it,
    /// and the part comes with them.
    ///
    /// # Errors
    /// As [`subdivide_with_water`]. [`Error::Strict`] if the preparation was strict and there is an error or a warning.
    /// The findings stay in the input.
    pub fn subdivide(
        &mut self,
        sea: Option<f64>,
        progress: &dyn Progress,
    ) -> Result<(Subdivision, Option<MultiPolygon<f64>>)> {
        let part = self.take_part()?;
        let map = std::mem::take(&mut self.map);
        let water = Water { lakes: std::mem::take(&mut self.features.lakes), sea, coast: self.coast.clone() };
        let subdivision = self.found(subdivide_with_water(map, &self.frame, &water, progress))?;
        self.check_strict()?;
        let covered = part.map(|part| part.of(&subdivision.frame.area)).transpose()?;
        self.findings_outside += covered.as_ref().map_or(0, |area| drop_outside(&mut self.findings, area));
        Ok((subdivision, covered))
    }

    /// Takes the part that is asked for, if it is one. The frame becomes the window around it, and lines elsewhere are left out.
    fn take_part(&mut self) -> Result<Option<Part>> {
        let Some(area) = self.part.take() else { return Ok(None) };
        let part = Part::new(area, &self.map)?;
        self.frame = part.frame(std::mem::take(&mut self.frame));
        self.cut_to(&part)?;
        Ok(Some(part))
    }

    /// Brings the streams of the input into agreement with a subdivision of its map. They are moved out of the input; what
    /// was done to them is added to the findings. `tolerance` is how far a stream is moved at most, map units.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tolerance below 0. [`Error::StreamsElsewhere`] if most streams contradict the contours.
    pub fn settle_streams(
        &mut self,
        subdivision: &Subdivision,
        tolerance: Option<f64>,
        progress: &dyn Progress,
    ) -> Result<Vec<Stream>> {
        let streams = Streams { lines: std::mem::take(&mut self.features.streams), areas: Vec::new() };
        let params = SurfaceParams { stream_tolerance: tolerance, ..SurfaceParams::default() };
        params.check()?;
        let given = Given { streams, ..Given::default() };
        let settled = settle_lines(subdivision, &given, &params, progress);
        if let Some(elsewhere) = settled.findings.iter().find(|finding| finding.kind == FindingKind::StreamsElsewhere) {
            return Err(Error::StreamsElsewhere(elsewhere.message.clone()));
        }
        self.findings.extend(settled.findings);
        self.state_unit();
        Ok(settled.streams)
    }

    /// Fails if the preparation was strict and there is an error or a warning about the input.
    pub(super) fn check_strict(&self) -> Result<()> {
        if self.is_strict { all_right(&self.name(), &self.findings) } else { Ok(()) }
    }

    /// The value of a report. Its findings are added to the others, each fault once.
    pub(super) fn found<T>(&mut self, result: Result<Report<T>>) -> Result<T> {
        let value = self.named(result)?.collect(&mut self.findings);
        self.findings = first_causes(std::mem::take(&mut self.findings));
        self.state_unit();
        self.drop_expected();
        self.explain_by_cliffs();
        Ok(value)
    }

    /// The result; its error names the file of the contours.
    fn named<T>(&self, result: Result<T>) -> Result<T> {
        result.map_err(|error| self.named_error(error))
    }

    /// An error that names the file of the contours.
    pub(super) fn named_error(&self, error: Error) -> Error {
        match self.files.as_slice() {
            [file] => error.in_file(file),
            _ => error,
        }
    }
}

/// Whether no finding is an error or a warning.
///
/// # Errors
/// [`Error::Strict`] with the number of errors and warnings.
pub fn all_right(input: &str, findings: &[Finding]) -> Result<()> {
    match findings.iter().filter(|finding| finding.kind.severity() > Severity::Note).count() {
        0 => Ok(()),
        findings => Err(Error::Strict { input: input.to_owned(), findings }),
    }
}
