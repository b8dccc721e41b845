//! The argument about the intervals of map tiles: `--zooms`.

use clap::Args;

#[derive(Debug, Clone, Args)]
pub struct ZoomArgs {
    /// Intervals of map tiles by zoom, each until the next; the last one is the highest zoom: 10:100,12:20,14:5 [metres, or
    /// the unit of --to-unit; default: those whose lines are two pixels apart on a slope of 45 degrees]
    #[arg(
        long,
        value_name = "ZOOM:STEP",
        value_delimiter = ',',
        value_parser = zoom,
        conflicts_with = "levels",
        hide_short_help = true
    )]
    pub zooms: Vec<(u8, f64)>,
}

/// A zoom and its interval.
fn zoom(text: &str) -> Result<(u8, f64), String> {
    let wrong = || format!("{text:?} is not a zoom and an interval, such as 12:20");
    let (zoom, interval) = text.split_once(':').ok_or_else(wrong)?;
    let interval: f64 = interval.parse().map_err(|_| wrong())?;
    let zoom = zoom.parse().map_err(|_| wrong())?;
    if interval.is_finite() && interval > 0.0 { Ok((zoom, interval)) } else { Err(wrong()) }
}
