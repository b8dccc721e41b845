//! The arguments about contours for a map: supplementary contours, and the rules of a scale.

use std::path::Path;

use clap::Args;
use tokosen::base::Units;
use tokosen::cartography::{Ground, LABEL, MapCount, MapParams, MapPlan, MapRequest, OfInput, Steep, for_map};
use tokosen::contour::{ContourLayer, Target};
use tokosen::io::tiles::TileFormat;

use super::console::Console;
use super::failure::Failure;
use super::levels::LevelsArgs;
use super::picture::PictureArgs;

/// What a map of some scale shows.
#[derive(Debug, Clone, Args)]
pub struct ForMapArgs {
    /// Also write supplementary contours, only where the ground needs them: at half of the interval, or at half and a quarter of it:
    /// 5,2.5 for -i 10. They are where the contours beside them lie far apart, and around tops and hollows that no other
    /// contour shows. Each line gets the attribute kind: index, intermediate, supplementary or supplementary_quarter
    #[arg(long, value_name = "STEPS", value_delimiter = ',')]
    supplementary: Vec<f64>,
    /// Supplementary contours are drawn where the contours beside them are at least so far apart [metres; default: 15 mm at --scale,
    /// or 37.5 times the interval]
    #[arg(long, value_name = "DISTANCE", requires = "supplementary", hide_short_help = true)]
    supplementary_spacing: Option<f64>,
    /// Leave out intermediate contours on steep slopes, where lines would be closer than 0.25 mm at --scale
    #[arg(long, requires = "scale", hide_short_help = true)]
    thin: bool,
}

/// The help of `--scale` where lines are written for it.
pub const SCALE_HELP: &str = "Scale of the map: 25000 or 1:25000. All lines are simplified for it together, also those of the input, and rings below \
     1 mm are left out; without --interval, it chooses one by the steepness of the ground. A --preview in .pdf or .svg has this \
     scale too";

impl ForMapArgs {
    /// What is asked for, if anything is. `targets` are the layers' levels.
    pub fn plan(
        &self,
        output: &Path,
        levels: &LevelsArgs,
        targets: &[Target],
        picture: &PictureArgs,
    ) -> Result<Option<MapPlan>, Failure> {
        if TileFormat::of(output).is_some() {
            // A map on paper has its scale all the same.
            let asks =
                self.thin || !self.supplementary.is_empty() || picture.scale.is_some() && picture.preview.is_none();
            let message = "--supplementary, --scale and --thin are not for map tiles, which have an interval for each zoom (--zooms) and \
                           are simplified for it";
            return if asks { Err(Failure::Usage(message.into())) } else { Ok(None) };
        }
        if self.thin && levels.bands.bands.is_some() {
            let message = "--thin leaves out pieces of the lines that bound --bands: give one of them";
            return Err(Failure::Usage(message.into()));
        }
        let request = MapRequest {
            targets: targets.to_vec(),
            unit: levels.to_unit.unit(),
            index_every: levels.which.index,
            supplementary: self.supplementary.clone(),
            spacing: self.supplementary_spacing,
            scale: picture.scale,
            steep: if self.thin { Steep::Thin } else { Steep::Keep },
        };
        request.plan().map_err(|error| Failure::Usage(error.to_string()))
    }
}

/// Settles a plan, and says which interval was chosen. Its levels count from a base.
pub fn settle(plan: Option<MapPlan>, base: f64, slope: impl FnOnce() -> f64, console: &Console) -> Option<MapParams> {
    let plan = plan?;
    let mut mean = f64::NAN;
    let mut params = plan.settle(|| {
        mean = slope();
        mean
    });
    if plan.is_open() {
        params.kinds.interval.base = base;
        let unit = params.kinds.unit;
        let interval = Units::all(unit).height(unit.metres(params.kinds.interval.step));
        console.say(&format!("interval   {interval}: the mean slope is {:.0} degrees", mean.atan().to_degrees()));
    }
    Some(params)
}

/// The levels that are traced for these targets.
pub fn traced(params: Option<&MapParams>, targets: &[Target]) -> Vec<Target> {
    params.map_or_else(|| targets.to_vec(), |params| vec![params.kinds.levels()])
}

/// The levels that bands lie between: those of the interval, of which all lines are drawn.
pub fn bounds(params: Option<&MapParams>, targets: &[Target]) -> Vec<Target> {
    params.map_or_else(|| targets.to_vec(), |params| vec![params.kinds.interval.into()])
}

/// Makes the contours of the layer those of a map. It keeps the name that was planned for it.
pub fn apply(
    params: &MapParams,
    (layers, name): (&mut [ContourLayer], &str),
    input: OfInput,
    ground: &Ground,
    console: &Console,
) -> MapCount {
    let count = layers.first_mut().map(|layer| {
        let count = console.step("choosing", || for_map(layer, params, input, ground));
        layer.name = name.into();
        count
    });
    count.unwrap_or_default()
}

/// The height of labels at the scale, map units.
pub fn label_height(params: Option<&MapParams>, ground: &Ground) -> Option<f64> {
    Some(params?.scale?.metres(LABEL) / ground.metres.max_element())
}

/// Prints what became of the lines.
pub fn describe(params: Option<&MapParams>, count: &MapCount, console: &Console) {
    let Some(params) = params else { return };
    let share = |part: f64, whole: f64| if whole > 0.0 { 100.0 * part / whole } else { 0.0 };
    let found = &count.supplementary;
    if params.scale.is_some() {
        let steep = match params.steep {
            Steep::Thin => {
                format!("; {:.1} km of intermediate contours left out on steep slopes", count.steep / 1000.0)
            }
            Steep::Keep => String::new(),
        };
        console.say(&format!("           {} rings smaller than 1 mm on the map left out{steep}", count.small_rings));
    }
    if params.kinds.parts > 1 {
        let [half, quarter] = found.pieces;
        let quarter = if params.kinds.parts > 2 { format!(", {quarter} at a quarter of it") } else { String::new() };
        console.say(&format!(
            "           {half} supplementary contours at half of the interval{quarter}, where others are {} m apart: {:.0} % of the \
             length of all lines, {:.0} % of what they would be everywhere",
            (params.apart() * 10.0).round() / 10.0,
            share(found.drawn, found.total),
            share(found.drawn, found.all)
        ));
    }
}
