//! The summary at the end of a run: findings by kind, the surface, the time of each step.

use std::collections::BTreeMap;

use tokosen::base::error::{Error, Finding, FindingKind, Severity};
use tokosen::break_lines::FittedBreakLine;
use tokosen::drain::Pit;
use tokosen::skeleton::SkeletonKind;
use tokosen::spline::HyperParameters;
use tokosen::streams::Stream;
use tokosen::surface::{Surface, largest_stream_change};
use tokosen::validate::{Chosen, Provenance, Reason};

use super::console::Console;
use super::hints;

/// Findings of one kind that are shown without `--verbose`.
const SHOWN: usize = 3;
/// So many findings of one kind are the rule on this map, and the first ones say nothing about the others. Then only
/// their number is shown.
const MANY: usize = 1000;

/// Prints the findings: the count of each kind and its first places.
pub fn findings(findings: &[Finding], console: &Console) {
    for (kind, list) in by_kind(findings) {
        print_kind(kind.title(), &list, console, Console::warn);
        if kind == FindingKind::HeightUnit && console.flags.leaves("--to-unit") {
            console.warn("    results are in metres; --to-unit ft or --to-unit us-ft writes them in feet");
        }
    }
}

/// Prints the findings and returns the error: lines that were left out may be its cause.
pub fn after_findings(error: Error, findings: &[Finding], console: &Console) -> Error {
    console.clear();
    self::findings(findings, console);
    error
}

/// Prints the findings as the result of the run, the worst first.
pub fn findings_by_severity(findings: &[Finding], console: &Console) {
    let mut kinds: Vec<(FindingKind, Vec<&Finding>)> = by_kind(findings).into_iter().collect();
    kinds.sort_by_key(|(kind, _)| std::cmp::Reverse(kind.severity()));
    for (kind, list) in kinds {
        let title = format!("{:<8} {:<20} {}", kind.severity().name(), kind.code(), kind.title());
        print_kind(&title, &list, console, Console::say);
    }
}

fn by_kind(findings: &[Finding]) -> BTreeMap<FindingKind, Vec<&Finding>> {
    let mut kinds: BTreeMap<FindingKind, Vec<&Finding>> = BTreeMap::new();
    for finding in findings {
        kinds.entry(finding.kind).or_default().push(finding);
    }
    kinds
}

fn print_kind(title: &str, list: &[&Finding], console: &Console, print: fn(&Console, &str)) {
    print(console, &format!("{title}: {}", list.len()));
    let shown = match list.len() {
        all if console.verbose => all,
        MANY.. => 0,
        _ => SHOWN,
    };
    for finding in list.iter().take(shown) {
        print(console, &format!("    {}", console.text_of(finding)));
        if let (true, Some(proposal)) = (console.verbose, &finding.proposal) {
            print(console, &format!("        proposed: {}", console.text_of_proposal(proposal)));
        }
    }
    if shown == 0 {
        print(console, "    --verbose lists them");
    } else if list.len() > shown {
        print(console, &format!("    and {} more; --verbose lists them", list.len() - shown));
    }
    if let Some(hint) = list.first().and_then(|finding| hints::for_kind_of(finding, console.takes_unit())) {
        print(console, &format!("    {hint}"));
    }
}

/// Prints the number of findings of each severity and the time of each step. `outside` is the number of those outside of the
/// frame polygon or the part.
pub fn close_severities(findings: &[Finding], outside: usize, console: &Console) {
    let count = |severity: Severity| findings.iter().filter(|f| f.kind.severity() == severity).count();
    let [errors, warnings, notes] = [Severity::Error, Severity::Warning, Severity::Note].map(count);
    let elsewhere = elsewhere(outside);
    console.say(&format!("findings   {errors} errors, {warnings} warnings, {notes} notes{elsewhere}"));
    times(console);
}

/// Prints how the surface was made and how good it is. What it consists of is a detail.
pub fn surface(surface: &Surface, findings: &[Finding], console: &Console) {
    console.note_surface(surface);
    let how = match &surface.chosen {
        None => "",
        Some(chosen) => match chosen.reason {
            Reason::Given => "; smoothness as given",
            Reason::Hidden => "; smoothness chosen automatically",
            Reason::FellBack => "; usual smoothness, there are too few levels to choose one",
        },
    };
    console.say(&format!("surface    {}{how}", kind(surface)));
    let lines = |kind| surface.skeleton_lines.iter().filter(|l| l.kind == kind).count();
    let inside = (0..surface.tin.len() as u32).filter(|&t| surface.tin.is_inside(t)).count();
    let skeleton = if surface.skeleton_lines.is_empty() {
        String::new()
    } else {
        format!(", {} ridge lines, {} canyon lines", lines(SkeletonKind::Ridge), lines(SkeletonKind::Canyon))
    };
    console.detail(&format!("           {} sub-domains, {inside} triangles{skeleton}", surface.regions.regions.len()));
    if let Some(chosen) = &surface.chosen {
        hyper_parameters(chosen, console);
    }
    let units = console.units();
    let water = || surface.regions.regions.iter().filter_map(|region| region.water);
    if let (Some(lowest), Some(highest)) = (water().reduce(f64::min), water().reduce(f64::max)) {
        let heights = if lowest < highest {
            format!("heights {} to {}", units.height_number(hundredths(lowest)), units.height(hundredths(highest)))
        } else {
            format!("height {}", units.height(hundredths(lowest)))
        };
        console.say(&format!("water      {} areas, {heights}", water().count()));
    }
    streams(&surface.streams, console);
    let change = largest_stream_change(surface);
    if change > surface.stream_tolerance {
        console.say(&format!(
            "           heights of streams change by up to {}, so that they fall",
            units.rough_height(change)
        ));
    }
    break_lines(&surface.break_lines, console);
    if let Some(chosen) = &surface.chosen {
        accuracy(chosen, findings, console);
    }
    if let Some(errors) = &surface.errors {
        let model = &errors.model;
        let provenance = match model.provenance {
            Provenance::Hidden { places } => format!("learnt at {places} places on hidden contours"),
            Provenance::Usual => "that of usual terrain: there are too few levels to hide some".into(),
        };
        let valid: Vec<f64> = errors
            .parts
            .iter()
            .flat_map(|part| &part.errors)
            .map(|e| f64::from(*e))
            .filter(|e| e.is_finite())
            .collect();
        let mean = (valid.iter().map(|e| e * e).sum::<f64>() / valid.len().max(1) as f64).sqrt();
        console.say(&format!(
            "errors     standard error {} (root mean square), {provenance}",
            console.units().rough_height(mean)
        ));
    }
}

/// Prints how much of the streams is used, and how much of it was changed.
pub fn streams(streams: &[Stream], console: &Console) {
    if streams.is_empty() {
        return;
    }
    let length = |which: &dyn Fn(&Stream) -> bool| {
        let lengths = streams.iter().filter(|stream| which(stream)).map(Stream::length);
        lengths.fold(0.0, |sum, length| sum + length)
    };
    let all = length(&|_| true);
    let share = |which: &dyn Fn(&Stream) -> bool| 100.0 * length(which) / all;
    let (turned, moved) = (share(&|stream| stream.turned), share(&|stream| stream.shift > 0.0));
    console.say(&format!(
        "streams    {} pieces, length {}; {turned:.0} % of it turned, {moved:.0} % moved",
        streams.len(),
        console.units().length(all)
    ));
}

/// Prints how much of the break lines is used.
fn break_lines(break_lines: &[FittedBreakLine], console: &Console) {
    if break_lines.is_empty() {
        return;
    }
    let length = break_lines.iter().map(FittedBreakLine::length).fold(0.0, |sum, length| sum + length);
    let surveyed: f64 = break_lines.iter().map(|line| line.length() * line.surveyed_share()).sum();
    console.say(&format!(
        "breaklines {} pieces, length {}; {:.0} % of it with heights of its own",
        break_lines.len(),
        console.units().length(length),
        100.0 * surveyed / length.max(f64::MIN_POSITIVE)
    ));
}

/// Prints how many pits are left, and why. `what` has them.
pub fn pits(pits: &[Pit], what: &str, console: &Console) {
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    pits.iter().for_each(|pit| *reasons.entry(pit.reason.name()).or_default() += 1);
    let reasons: Vec<String> = reasons.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    let why = if reasons.is_empty() { String::new() } else { format!(": {}", reasons.join(", ")) };
    console.say(&format!("pits       {} left in the {what}{why}", pits.len()));
}

/// The kind of a surface in words.
fn kind(surface: &Surface) -> &'static str {
    match (&surface.chosen, surface.skeleton_lines.is_empty()) {
        (Some(_), _) => "smooth",
        (None, false) => "triangles with ridge and canyon lines",
        (None, true) => "triangles",
    }
}

/// Prints the hyper-parameters of the smooth surface.
fn hyper_parameters(chosen: &Chosen, console: &Console) {
    let why = match chosen.reason {
        Reason::Given => "as given",
        Reason::Hidden if chosen.is_mended => "chosen by cross-validation on hidden levels, wrong elevations corrected",
        Reason::Hidden => "chosen by cross-validation on hidden levels",
        Reason::FellBack => "the default: there are too few levels to choose by hiding some",
    };
    let HyperParameters { tension, noise, crease_threshold, curvature_gain, .. } = chosen.hyper_parameters;
    let smoothed = match noise {
        noise if noise > 0.0 => format!("; noise {noise}: the jitter of the contours is smoothed first"),
        _ => String::new(),
    };
    let others = match chosen.reason {
        Reason::Hidden => format!(", crease threshold {crease_threshold:.2}, curvature gain {curvature_gain:.2}"),
        _ => String::new(),
    };
    console.detail(&format!("           tension {tension:.2}{others}, {why}{smoothed}"));
}

/// Whether a finding tells of a contour that is missing, or whose elevation is wrong and used all the same.
fn is_wrong_height(finding: &Finding) -> bool {
    match finding.kind {
        FindingKind::WrongLabel | FindingKind::MixedUnits | FindingKind::LevelJump | FindingKind::SkippedLevel => true,
        // Without a proposal, the contour was left out.
        FindingKind::ZeroElevation => finding.proposal.is_some(),
        _ => false,
    }
}

/// Prints the expected accuracy of the smooth surface. Hidden contours show none of the errors that findings tell of.
fn accuracy(chosen: &Chosen, findings: &[Finding], console: &Console) {
    let units = console.units();
    let (Some(hidden), Some(implied)) = (&chosen.hidden, &chosen.implied) else { return };
    console.say(&format!(
        "accuracy   expected error of heights: about {} (RMSE); 90 % of them are within {}",
        units.rough_height(implied.rmse),
        units.rough_height(implied.le90)
    ));
    let wrong = findings.iter().filter(|finding| is_wrong_height(finding)).count();
    if wrong > 0 {
        let say = if wrong == 1 { "finding says" } else { "findings say" };
        console.say(&format!("           more where an elevation is wrong or a contour is missing: {wrong} {say} so"));
    }
    console.detail(&format!(
        "           from {} places on hidden contours: RMSE {}, LE90 {} with contours {} apart; these are {} apart",
        hidden.count,
        units.rough_height(hidden.rmse),
        units.rough_height(hidden.le90),
        units.height(hidden.interval),
        units.height(implied.interval)
    ));
    console.detail(
        "           measured on the surface of this run: its nodes lie at the cells of its height map, so that another --cell, or \
         none, gives a slightly different figure",
    );
}

/// A height, rounded to the centimetre.
fn hundredths(metres: f64) -> f64 {
    (metres * 100.0).round() / 100.0
}

/// Prints the number of findings and the time. `outside` is the number of those outside of the part of the map that is
/// written.
pub fn close_part(findings: usize, outside: usize, console: &Console) {
    let elsewhere = elsewhere(outside);
    let count = if findings == 0 { "none".into() } else { findings.to_string() };
    console.say(&format!("findings   {count}{elsewhere}"));
    times(console);
}

/// The number of findings outside of a part, in words.
fn elsewhere(outside: usize) -> String {
    if outside == 0 { String::new() } else { format!(" ({outside} more outside of this part)") }
}

/// Prints the number of findings and the time.
pub fn close(findings: usize, console: &Console) {
    close_part(findings, 0, console);
}

fn times(console: &Console) {
    let total = console.elapsed().as_secs_f64();
    let steps: Vec<String> = console.times().iter().map(|(name, t)| format!("{name} {:.2}", t.as_secs_f64())).collect();
    if console.verbose {
        console.say(&format!("time       {total:.2} s ({})", steps.join(", ")));
    } else {
        console.say(&format!("time       {total:.1} s"));
    }
}
