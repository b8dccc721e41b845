//! Streams that do not belong to the contours: of another place, or in another coordinate reference system.

use super::beside::Beside;
use super::descend::Detour;
use crate::base::error::{Finding, FindingKind};
use crate::subdomains::Course;
use crate::tin::NONE;
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
    /// The share of it that the contours contradict. On rough ground, short pieces are cut from true streams too.
    fn contradicted(&self) -> f64 {
        if self.beside.is_some() {
            return 1.0;
        }
        let cut = self.detours.iter().map(|detour| if let Detour::Cut { length, .. } = detour { *length } else { 0.0 });
        let inside = self.course.stretches.iter().filter(|stretch| stretch.region != NONE);
        cut.sum::<f64>() / inside.map(|stretch| stretch.to - stretch.from).sum::<f64>()
    }
}

/// The finding that most streams contradict the contours, if they do. Reaches count by the contours that they cross.
pub(super) fn elsewhere<'a>(reaches: impl IntoIterator<Item = Compared<'a>>, tuning: &StreamTuning) -> Option<Finding> {
    let (mut tested, mut crossings, mut contradicted) = (0, 0, 0.0);
    for reach in reaches {
        let count = reach.course.crossings.iter().filter(|crossing| crossing.level.is_some()).count();
        if count < FEWEST_CROSSINGS {
            continue;
        }
        tested += 1;
        crossings += count;
        contradicted += reach.contradicted() * count as f64;
    }
    let share = contradicted / crossings.max(1) as f64;
    (tested >= FEWEST_REACHES && share > tuning.elsewhere).then(|| {
        let message = format!(
            "the streams are not those of these contours: about {:.0} % of their length runs beside the \
             valleys or upwards across contours. Look at the coordinate reference system and the unit \
             of both files",
            100.0 * share
        );
        Finding::general(FindingKind::StreamsElsewhere, message)
    })
}
