//! The arguments about contours for a map: supplementary contours.

use std::path::Path;

use clap::Args;
use tokosen::base::ElevationUnit;
use tokosen::cartography::{Ground, Kinds, MapCount, MapParams, OfInput, for_map};
use tokosen::contour::{ContourLayer, Interval, Target};
use tokosen::io::tiles::TileFormat;

use super::console::Console;
use super::failure::Failure;

/// What a map of some scale shows.
#[derive(Debug, Clone, Args)]
pub struct ForMapArgs {
    /// Also write supplementary contours, only where the ground needs them: at half of the interval, or at half and a quarter of it:
    /// 5,2.5 for -i 10. They are where the contours beside them lie far apart, and around tops and hollows that no other
    /// contour shows. Each line gets the attribute kind: index, intermediate, supplementary or supplementary_quarter
    #[arg(long, value_name = "STEPS", value_delimiter = ',')]
    supplementary: Vec<f64>,
    /// Supplementary contours are drawn where the contours beside them are at least so far apart [metres; default: 37.5 times the
    /// interval, 15 mm on a map of 1:25 000 with contours every 10 m]
    #[arg(long, value_name = "DISTANCE", requires = "supplementary", hide_short_help = true)]
    supplementary_spacing: Option<f64>,
}

impl ForMapArgs {
    /// What is asked for, if anything is. `targets` are the layers' levels in `unit`; one contour in `index_every` is an index
    /// contour.
    pub fn params(
        &self,
        output: &Path,
        targets: &[Target],
        unit: ElevationUnit,
        index_every: u32,
    ) -> Result<Option<MapParams>, Failure> {
        if self.supplementary.is_empty() {
            return Ok(None);
        }
        let usage = |message: String| Err(Failure::Usage(message));
        let &[Target::Interval { step, base }] = targets else {
            return usage("--supplementary needs one --interval".into());
        };
        if TileFormat::of(output).is_some() {
            return usage("--supplementary: map tiles have one interval for each zoom (--zooms)".into());
        }
        if let Some(bad) = self.supplementary_spacing.filter(|d| !(d.is_finite() && *d > 0.0)) {
            return usage(format!("--supplementary-spacing is {bad}, it must be more than 0"));
        }
        let kinds = Kinds { interval: Interval { step, base }, unit, index_every, parts: 1 };
        let kinds = match kinds.with_steps(&self.supplementary) {
            Ok(kinds) => kinds,
            Err(error) => return usage(format!("--supplementary: {error}")),
        };
        Ok(Some(MapParams { kinds, apart: self.supplementary_spacing }))
    }
}

/// The levels that are traced for a layer with these targets.
pub fn traced(params: Option<&MapParams>, targets: &[Target]) -> Vec<Target> {
    params.map_or_else(|| targets.to_vec(), |params| vec![params.kinds.levels()])
}

/// Makes the contours of a layer those of a map, if that is asked for.
pub fn apply(
    params: &MapParams,
    layers: &mut [ContourLayer],
    input: OfInput,
    ground: impl FnOnce() -> Ground,
    console: &Console,
) -> Option<MapCount> {
    let layer = layers.first_mut()?;
    Some(console.step("choosing", || for_map(layer, params, input, &ground())))
}

/// Prints what became of the supplementary contours.
pub fn describe(params: Option<&MapParams>, count: Option<&MapCount>, console: &Console) {
    let (Some(params), Some(count)) = (params, count) else { return };
    let share = |part: f64, whole: f64| if whole > 0.0 { 100.0 * part / whole } else { 0.0 };
    let [half, quarter] = count.supplementary.pieces;
    let quarter = if params.kinds.parts > 2 { format!(", {quarter} at a quarter of it") } else { String::new() };
    let found = &count.supplementary;
    console.say(&format!(
        "           {half} supplementary contours at half of the interval{quarter}, where the others are {} apart: {:.0} % of the \
         length of all lines, {:.0} % of what they would be everywhere",
        rounded(params.apart()),
        share(found.drawn, found.total),
        share(found.drawn, found.all)
    ));
}

/// A distance in metres with sensible digits.
fn rounded(metres: f64) -> String {
    format!("{} m", (metres * 10.0).round() / 10.0)
}
