//! The summary at the end of a run: findings by kind, the surface, the time of each step.

use std::collections::BTreeMap;

use tokosen::error::{Error, Finding, FindingKind};
use tokosen::skeleton::BreakKind;
use tokosen::surface::{Chosen, Reason, Surface};

use super::console::Console;

/// Findings of one kind that are shown without `--verbose`.
const SHOWN: usize = 3;

/// Tells the findings: a count by kind, the first places of each.
pub fn findings(findings: &[Finding], console: &Console) {
    let mut kinds: BTreeMap<FindingKind, Vec<&Finding>> = BTreeMap::new();
    for finding in findings {
        kinds.entry(finding.kind).or_default().push(finding);
    }
    for (kind, list) in kinds {
        console.warn(&format!("{}: {}", kind.title(), list.len()));
        let shown = if console.verbose { list.len() } else { SHOWN };
        for finding in list.iter().take(shown) {
            console.warn(&format!("    {}", console.told(finding)));
        }
        if list.len() > shown {
            console.warn(&format!("    and {} more; --verbose lists them", list.len() - shown));
        }
    }
}

/// Tells the findings when the work ends in an error: what was left out may be why.
pub fn or_tell<T>(result: Result<T, Error>, list: &[Finding], console: &Console) -> Result<T, Error> {
    result.inspect_err(|_| {
        console.clear();
        findings(list, console);
    })
}

/// Tells what the surface is made of.
pub fn surface(surface: &Surface, console: &Console) {
    let lines = |kind| surface.break_lines.iter().filter(|l| l.kind == kind).count();
    let inside = (0..surface.tin.len() as u32).filter(|&t| surface.tin.is_inside(t)).count();
    let skeleton = if surface.break_lines.is_empty() {
        String::new()
    } else {
        format!(", {} ridge lines, {} canyon lines", lines(BreakKind::Ridge), lines(BreakKind::Canyon))
    };
    console.say(&format!("surface    {} sub-domains, {inside} triangles{skeleton}", surface.regions.regions.len()));
    let water = || surface.regions.regions.iter().filter_map(|region| region.water);
    if let (Some(lowest), Some(highest)) = (water().reduce(f64::min), water().reduce(f64::max)) {
        let heights = if lowest < highest {
            format!("heights {lowest:.2} to {highest:.2}")
        } else {
            format!("height {lowest:.2}")
        };
        console.say(&format!("water      {} areas, {heights} m", water().count()));
    }
    if let Some(chosen) = &surface.chosen {
        self::chosen(chosen, console);
    }
}

/// Tells how the smooth surface was drawn, and how far it may be off.
fn chosen(chosen: &Chosen, console: &Console) {
    let why = match chosen.reason {
        Reason::Given => "as given",
        Reason::Hidden => "chosen by hiding every second level",
        Reason::FellBack => "the usual one: there are too few levels to hide some and choose by them",
    };
    let noise = match chosen.knobs.noise {
        noise if noise > 0.0 => format!("; noise {noise}: contours jitter and are smoothed before they are met"),
        _ => String::new(),
    };
    console.say(&format!("tension    {:.2}, {why}{noise}", chosen.knobs.tension));
    let (Some(hidden), Some(implied)) = (&chosen.hidden, &chosen.implied) else { return };
    console.say(&format!(
        "accuracy   RMSE {}, LE90 {} at {} places on hidden contours, drawn from an interval of {} m",
        metres(hidden.rmse),
        metres(hidden.le90),
        hidden.count,
        hidden.interval
    ));
    console.say(&format!(
        "           which implies about RMSE {}, LE90 {} with all contours, {} m apart",
        metres(implied.rmse),
        metres(implied.le90),
        implied.interval
    ));
}

/// A length with two digits that tell something.
fn metres(value: f64) -> String {
    let decimals = if value > 0.0 { (1.0 - value.log10().floor()).clamp(0.0, 6.0) as usize } else { 0 };
    format!("{value:.decimals$} m")
}

/// Tells how many findings there were and how long each step took.
pub fn close(findings: usize, console: &Console) {
    console.say(&format!("findings   {}", if findings == 0 { "none".into() } else { findings.to_string() }));
    let times = console.times();
    let total: f64 = times.iter().map(|(_, t)| t.as_secs_f64()).sum();
    let steps: Vec<String> = times.iter().map(|(name, t)| format!("{name} {:.2}", t.as_secs_f64())).collect();
    console.say(&format!("time       {total:.2} s ({})", steps.join(", ")));
}
