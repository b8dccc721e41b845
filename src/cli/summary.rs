//! The summary at the end of a run: findings by kind, the surface, the time of each step.

use std::collections::BTreeMap;

use tokosen::error::{Error, Finding, FindingKind};
use tokosen::skeleton::BreakKind;
use tokosen::surface::Surface;

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
            console.warn(&format!("    {finding}"));
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
}

/// Tells how many findings there were and how long each step took.
pub fn close(findings: usize, console: &Console) {
    console.say(&format!("findings   {}", if findings == 0 { "none".into() } else { findings.to_string() }));
    let times = console.times();
    let total: f64 = times.iter().map(|(_, t)| t.as_secs_f64()).sum();
    let steps: Vec<String> = times.iter().map(|(name, t)| format!("{name} {:.2}", t.as_secs_f64())).collect();
    console.say(&format!("time       {total:.2} s ({})", steps.join(", ")));
}
