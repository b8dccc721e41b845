//! Streams that do not belong to the contours: of another place, or in another coordinate reference system.

use super::beside::Beside;
use super::descend::Detour;
use crate::base::error::{Finding, FindingKind};
use crate::subdomains::Course;
use crate::tuning::StreamTuning;

/// A reach that crosses fewer contours says nothing.
const FEWEST_CROSSINGS: usize = 3;
/// Fewer reaches say nothing about all streams.
const FEWEST_REACHES: usize = 10;

/// What the contours say about a reach.
pub(super) struct Compared<'a> {
    pub course: &'a Course,
    pub beside: Option<Beside>,
    pub detours: &'a [Detour],
}

impl Compared<'_> {
    /// Whether the contours contradict it. On rough ground, pieces that are shorter than the tolerance are cut from true streams
    /// too.
    fn is_contradicted(&self, tolerance: f64) -> bool {
        let is_long = |detour: &Detour| matches!(detour, Detour::Cut { length, .. } if *length > tolerance);
        self.beside.is_some() || self.detours.iter().any(is_long)
    }
}

/// The finding that most streams contradict the contours, if they do. Reaches count by the contours that they cross.
pub(super) fn elsewhere<'a>(
    reaches: impl IntoIterator<Item = Compared<'a>>,
    tolerance: f64,
    tuning: &StreamTuning,
) -> Option<Finding> {
    let (mut tested, mut crossings, mut contradicted) = (0, 0, 0);
    for reach in reaches {
        let count = reach.course.crossings.iter().filter(|crossing| crossing.level.is_some()).count();
        if count < FEWEST_CROSSINGS {
            continue;
        }
        tested += 1;
        crossings += count;
        contradicted += if reach.is_contradicted(tolerance) { count } else { 0 };
    }
    let share = contradicted as f64 / crossings.max(1) as f64;
    (tested >= FEWEST_REACHES && share > tuning.elsewhere).then(|| {
        let message = format!(
            "the streams are not those of these contours: {:.0} % of the {crossings} crossings of contours are on streams \
             that run beside their valleys or upwards across contours. Look at the coordinate reference system and the unit \
             of both files",
            100.0 * share
        );
        Finding::general(FindingKind::StreamsElsewhere, message)
    })
}
