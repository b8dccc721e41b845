//! Labels on contours: where along a line its elevation is written.
//!
//! A line gets about one label per [`LabelParams::spacing`] of its length. It is cut into as many equal parts, and in
//! each part the best place is taken. A place is possible where all of this holds:
//!
//! * The line is nearly straight under the text.
//! * The box around the text meets no other label, and lies inside of [`LabelParams::within`].
//! * No label of the same elevation is near.
//!
//! Among the possible places, the best one crosses few other lines, above all few that carry labels themselves. Then
//! count: a text that is nearly level, its top towards higher ground, a straight line, the middle of the part. This is
//! how maps are labelled by hand (Imhof, "Positioning names on maps", 1975).
//!
//! Long lines come first, so that short ones do not take their places. The work grows with the number of vertices, and
//! with the number of places tried, which is limited per part.

mod course;
mod neighbours;
mod of_layers;

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::base::ElevationUnit;
use crate::contour::ContourLine;
use crate::geometry::OrientedBox;
use course::Course;
use neighbours::Neighbours;
pub use of_layers::label_layers;

/// Largest distance between the line and its chord under the text, as a share of the text's height.
pub const STRAIGHT: f64 = 0.25;
/// Least length of the chord, as a share of the line's length under the text.
const STRETCHED: f64 = 0.95;
/// Places that are tried lie this share of the text's width apart.
const STEP: f64 = 0.3;
/// Most places that are tried in a part of a line. It limits the work.
const MOST_PLACES: usize = 160;
/// Labels of one elevation are at least this share of the spacing apart, on whatever lines.
const SAME_ELEVATION: f64 = 0.35;

/// Penalties of a place. They are compared with each other only.
mod penalty {
    /// For a text from bottom to top; none for a level one.
    pub const TILT: f64 = 1.2;
    /// For a text whose top is towards lower ground.
    pub const TOP_DOWNHILL: f64 = 0.5;
    /// For a line as bent as it may be.
    pub const BENT: f64 = 0.5;
    /// For a place at the end of the line's part.
    pub const OFF_MIDDLE: f64 = 0.5;
    /// For each other line with labels under the text.
    pub const CROSSES_LABELLED: f64 = 4.0;
    /// For each other line under the text.
    pub const CROSSES: f64 = 0.4;
}

/// The lines that get labels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LabelledLines {
    /// Index contours.
    #[default]
    Index,
    /// All contours.
    All,
}

impl LabelledLines {
    fn includes(self, line: &ContourLine) -> bool {
        self == Self::All || line.index
    }
}

/// Parameters of [`place_labels`].
#[derive(Debug, Clone, PartialEq)]
pub struct LabelParams {
    /// Height of the text, map units: of the font, from below its letters to above them.
    pub text_height: f64,
    /// Width of a character, map units.
    pub char_width: f64,
    /// Free space around a text, map units.
    pub clearance: f64,
    /// About this much of a line has one label, map units.
    pub spacing: f64,
    /// The lines that get labels. The others are only kept clear of, where that is possible.
    pub lines: LabelledLines,
    /// The unit in which the elevations are written.
    pub unit: ElevationUnit,
    /// Lower left and upper right corner of the area in which labels lie; anywhere if `None`.
    pub within: Option<[DVec2; 2]>,
}

impl LabelParams {
    /// For a text of this height, map units: index contours, metres, usual proportions.
    pub fn new(text_height: f64) -> Self {
        Self {
            text_height,
            char_width: 0.55 * text_height,
            clearance: 0.2 * text_height,
            spacing: 50.0 * text_height,
            lines: LabelledLines::Index,
            unit: ElevationUnit::Metre,
            within: None,
        }
    }

    fn is_usable(&self) -> bool {
        let sizes = [self.text_height, self.char_width, self.spacing];
        sizes.iter().all(|size| size.is_finite() && *size > 0.0) && self.clearance.is_finite() && self.clearance >= 0.0
    }
}

/// An elevation on a contour.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Index of the line in the given lines.
    pub line: usize,
    /// Elevation of the line, metres.
    pub elevation: f64,
    /// The elevation as it is written.
    pub text: String,
    /// Centre of the text: a point of the line, map units.
    pub position: DVec2,
    /// Direction of the text, degrees counter-clockwise from the x axis, above -90 and up to 90.
    pub angle: f64,
    /// Width and height of the text without the free space around it, map units.
    pub size: DVec2,
}

impl Label {
    /// The corners of the text, counter-clockwise from its lower left, grown by `margin` on all sides.
    pub fn corners(&self, margin: f64) -> [DVec2; 4] {
        let axis = DVec2::from_angle(self.angle.to_radians());
        let half = self.size / 2.0 + margin;
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| self.position + axis * (x * half.x) + axis.perp() * (y * half.y))
    }
}

/// The elevation of a label in a unit: without needless digits, at most three decimals.
pub fn label_text(elevation: f64, unit: ElevationUnit) -> String {
    let text = format!("{:.3}", unit.from_metres(elevation));
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.to_owned() }
}

/// Chooses the places of labels on contours, in the order of the lines and along each of them.
///
/// For every label:
///
/// * Its position is a point of its line. Its angle is that of the line's chord under the text.
/// * The line is off that chord by at most [`STRAIGHT`] times the height of the text.
/// * Its box, grown by the clearance, meets the box of no other label, grown in the same way.
/// * It is never upside down: its angle is above -90 and up to 90 degrees.
/// * It covers other lines only where each possible place on that part of its line does.
///
/// The result depends on the lines and the parameters alone. Lines with a coordinate or an elevation that is not finite
/// are passed over. There are no labels if a size is not a positive number.
pub fn place_labels(lines: &[ContourLine], params: &LabelParams) -> Vec<Label> {
    if !params.is_usable() {
        return Vec::new();
    }
    let is_finite = |line: &ContourLine| line.elevation.is_finite() && line.points.iter().all(|p| p.is_finite());
    let usable: Vec<bool> = lines.iter().map(is_finite).collect();
    let neighbours = Neighbours::new(lines, &usable, params.lines);
    let gets_labels = |&k: &usize| usable[k] && params.lines.includes(&lines[k]);
    let mut courses: Vec<(usize, Course<'_>)> =
        (0..lines.len()).filter(gets_labels).map(|k| (k, Course::new(&lines[k].points))).collect();
    // The sort is stable, so lines of equal length keep their order.
    courses.sort_by(|a, b| b.1.length().total_cmp(&a.1.length()));
    let mut placed = Placed::default();
    for (line, course) in courses {
        let text = label_text(lines[line].elevation, params.unit);
        let size = DVec2::new(text.chars().count() as f64 * params.char_width, params.text_height);
        let line = Line { number: line, elevation: lines[line].elevation, text, size, course };
        line.label(&neighbours, params, &mut placed);
    }
    let mut labels = placed.labels;
    labels.sort_by(|a, b| a.1.line.cmp(&b.1.line).then(a.0.total_cmp(&b.0)));
    labels.into_iter().map(|(_, label)| label).collect()
}

/// A line that gets labels.
struct Line<'a> {
    number: usize,
    elevation: f64,
    text: String,
    /// Width and height of the text.
    size: DVec2,
    course: Course<'a>,
}

/// A place that is possible as far as the line itself is concerned.
struct Place {
    /// Distance along the line.
    at: f64,
    position: DVec2,
    /// Unit vector along the text.
    axis: DVec2,
    penalty: f64,
}

impl Line<'_> {
    /// Places the labels of this line.
    fn label(&self, neighbours: &Neighbours<'_>, params: &LabelParams, placed: &mut Placed) {
        let length = self.course.length();
        let reach = self.reach();
        if length < 2.0 * reach {
            return;
        }
        let parts = (length / params.spacing).round().max(1.0);
        let part = length / parts;
        for k in 0..parts as usize {
            let [from, to] = [k as f64 * part, (k + 1) as f64 * part];
            let (from, to) = (from.max(reach), to.min(length - reach));
            let count = ((to - from) / (STEP * self.size.x)).ceil().clamp(1.0, MOST_PLACES as f64);
            let tried = (0..=count as usize).map(|i| from + (to - from) * (i as f64 / count));
            let mut places: Vec<Place> = tried.filter_map(|at| self.place(at, [from, to])).collect();
            places.sort_by(|a, b| a.penalty.total_cmp(&b.penalty));
            if let Some(best) = self.best(places, neighbours, params, placed) {
                placed.add(best.at, self.label_at(&best), params);
            }
        }
    }

    /// Length of the line on each side of a label that has to be straight.
    fn reach(&self) -> f64 {
        (self.size.x + self.size.y) / 2.0
    }

    /// The place at a distance along the line, within a part of it. `None` if the line is bent there.
    fn place(&self, at: f64, [from, to]: [f64; 2]) -> Option<Place> {
        let reach = self.reach();
        let [start, end] = [self.course.point(at - reach), self.course.point(at + reach)];
        let chord = end - start;
        if chord.length() < STRETCHED * 2.0 * reach {
            return None;
        }
        let along = chord.normalize();
        let off = self.course.farthest_off([at - reach, at + reach], start, along);
        if off > STRAIGHT * self.size.y {
            return None;
        }
        let axis = upright(along);
        // Higher ground lies on the right of the line, so the top of the text is there if the text runs against it.
        let is_downhill = axis.dot(along) > 0.0;
        let tilt = axis.y.abs().asin() / std::f64::consts::FRAC_PI_2;
        let middle = from.midpoint(to);
        let off_middle = if to > from { (at - middle).abs() / (to - middle) } else { 0.0 };
        let penalty = penalty::TILT * tilt
            + if is_downhill { penalty::TOP_DOWNHILL } else { 0.0 }
            + penalty::BENT * off / (STRAIGHT * self.size.y)
            + penalty::OFF_MIDDLE * off_middle;
        Some(Place { at, position: self.course.point(at), axis, penalty })
    }

    /// The best of the places, which come with the smallest penalty first.
    fn best(
        &self,
        places: Vec<Place>,
        neighbours: &Neighbours<'_>,
        params: &LabelParams,
        placed: &Placed,
    ) -> Option<Place> {
        let mut best: Option<Place> = None;
        for mut place in places {
            // What the lines around add is never below zero.
            if best.as_ref().is_some_and(|best| place.penalty >= best.penalty) {
                break;
            }
            let label = self.label_at(&place);
            let outline = label.outline(params.clearance);
            if !is_within(&label, params) || placed.forbids(&label, &outline, params) {
                continue;
            }
            let skipped = [place.at - 2.0 * self.reach(), place.at + 2.0 * self.reach()];
            let (labelled, others) = neighbours.under(&outline, self.number, |at| self.course.is_between(at, skipped));
            place.penalty += penalty::CROSSES_LABELLED * labelled as f64 + penalty::CROSSES * others as f64;
            if best.as_ref().is_none_or(|best| place.penalty < best.penalty) {
                best = Some(place);
            }
        }
        best
    }

    fn label_at(&self, place: &Place) -> Label {
        let angle = place.axis.to_angle().to_degrees();
        let (line, elevation, text, size) = (self.number, self.elevation, self.text.clone(), self.size);
        Label { line, elevation, text, position: place.position, angle, size }
    }
}

impl Label {
    fn outline(&self, clearance: f64) -> OrientedBox {
        let axis = DVec2::from_angle(self.angle.to_radians());
        OrientedBox::turned(self.position, axis, self.size / 2.0 + clearance)
    }
}

/// A direction or its opposite: the one that is not upside down for a text.
fn upright(direction: DVec2) -> DVec2 {
    // A vertical text runs upwards.
    if direction.x > 0.0 || (direction.x == 0.0 && direction.y > 0.0) { direction } else { -direction }
}

fn is_within(label: &Label, params: &LabelParams) -> bool {
    let is_inside =
        |[lo, hi]: [DVec2; 2]| label.corners(params.clearance).iter().all(|p| p.cmpge(lo).all() && p.cmple(hi).all());
    params.within.is_none_or(is_inside)
}

/// The labels so far, each with its distance along its line.
#[derive(Default)]
struct Placed {
    labels: Vec<(f64, Label)>,
    /// Upright boxes around them.
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
}

impl Placed {
    fn add(&mut self, at: f64, label: Label, params: &LabelParams) {
        let area = around(&label, params.clearance);
        self.tree.insert(GeomWithData::new(Rectangle::from_aabb(area), self.labels.len()));
        self.labels.push((at, label));
    }

    /// Whether a new label would meet one of these, or repeat one that is near.
    fn forbids(&self, label: &Label, outline: &OrientedBox, params: &LabelParams) -> bool {
        let apart = SAME_ELEVATION * params.spacing;
        let repeats =
            |other: &Label| other.elevation == label.elevation && other.position.distance(label.position) < apart;
        let [lo, hi] = [label.position - apart, label.position + apart];
        let near = AABB::from_corners(lo.to_array(), hi.to_array());
        let area = around(label, params.clearance);
        let find = |area| self.tree.locate_in_envelope_intersecting(area).map(|found| &self.labels[found.data].1);
        find(&area).any(|other| other.outline(params.clearance).meets(outline)) || find(&near).any(repeats)
    }
}

/// The upright box around a label.
fn around(label: &Label, clearance: f64) -> AABB<[f64; 2]> {
    let corners = label.corners(clearance).map(|p| p.to_array());
    AABB::from_points(&corners)
}

#[cfg(test)]
mod tests;
