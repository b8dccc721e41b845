//! How far a map is repaired before the work: `--repair`.

use clap::ValueEnum;
use tokosen::base::error::{Error, Finding, FindingKind};
use tokosen::check::{LineParams, correct, examine, merged};
use tokosen::clean::clean;
use tokosen::contour::ContourMap;
use tokosen::subdivision::subdivide;
use tokosen::subdomains::Frame;

use super::console::Console;
use super::map::{Input, MapArgs};
use super::{Failure, summary};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Repair {
    /// Nothing is repaired; what needs it stops the work
    None,
    /// Only what cannot change the meaning
    Safe,
    /// Also elevations, gaps and stray vertices, as proposed
    All,
}

/// The findings that tell of a change to the lines.
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

/// How often a map is looked at again after its corrections: one can show the next.
const ROUNDS: usize = 3;

/// Whether a finding tells of a change to the lines.
pub fn is_repair(finding: &Finding) -> bool {
    REPAIRS.contains(&finding.kind)
}

/// With `--repair none`, any change to the lines ends the work.
pub fn refuse(args: &MapArgs, findings: &[Finding], console: &Console) -> Result<(), Failure> {
    let count = findings.iter().filter(|finding| is_repair(finding)).count();
    if args.repair() != Repair::None || count == 0 {
        return Ok(());
    }
    console.clear();
    summary::findings(findings, console);
    let message = format!(
        "{}: {count} places need repair before a surface can be made, and --repair none is set; --repair safe mends \
         them, 'tokosen check' tells of them",
        args.contours.display()
    );
    Err(Failure::Work(Error::Data(message)))
}

/// The map after cleaning. Where an elevation jumps along a line, or a vertex stands out of it, that is mended first, if all
/// repairs are asked for.
pub fn cleaned(
    mut map: ContourMap,
    args: &MapArgs,
    findings: &mut Vec<Finding>,
    console: &Console,
) -> Result<ContourMap, Failure> {
    let (clean_params, line_params) = (args.clean_params(), LineParams { snap: args.snap });
    let (told, cleaned) = console.step("cleaning", || {
        let mut judged = examine(&map, &line_params);
        if args.repair() == Repair::All && !judged.corrections.is_empty() {
            map = correct(std::mem::take(&mut map), &judged.corrections).collect(findings);
            judged = examine(&map, &line_params);
        }
        (judged.findings, clean(map, &clean_params))
    });
    let mut cleaning = Vec::new();
    match cleaned {
        Ok(report) => map = report.collect(&mut cleaning),
        Err(error) => {
            findings.extend(told);
            return Ok(summary::or_tell(Err(error), &args.contours, findings, console)?);
        }
    }
    findings.extend(merged(told, cleaning, args.snap.max(clean_params.separation)));
    Ok(map)
}

/// The map with the elevations and joins that the ground around proposes, if all repairs are asked for.
pub fn corrected(mut input: Input, args: &MapArgs, console: &Console) -> Result<Input, Failure> {
    if args.repair() != Repair::All {
        return Ok(input);
    }
    for _ in 0..ROUNDS {
        // A map that no surface can be made of is told by the step that makes it.
        let Ok(subdivision) = subdivide(input.map.clone(), &Frame::Hull, console) else { break };
        let corrections = subdivision.value.corrections;
        if corrections.is_empty() {
            break;
        }
        let map = correct(input.map, &corrections).collect(&mut input.findings);
        let cleaned = console.step("cleaning", || clean(map, &args.clean_params()));
        let cleaned = summary::or_tell(cleaned, &input.path, &input.findings, console)?;
        input.map = cleaned.collect(&mut input.findings);
    }
    Ok(input)
}
