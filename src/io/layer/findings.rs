//! The layer of findings.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::base::error::{Finding, Proposal};
use tokosen_core::crs::FromWorking;

/// The name of the layer.
pub const FINDINGS_LAYER: &str = "findings";

const COLUMNS: &[Column] = &[
    Column { name: "code", kind: Kind::Text(24) },
    Column { name: "severity", kind: Kind::Text(8) },
    Column { name: "elev", kind: Kind::Real },
    Column { name: "elevs", kind: Kind::LongText },
    Column { name: "features", kind: Kind::LongText },
    Column { name: "proposed", kind: Kind::Real },
    Column { name: "proposal", kind: Kind::LongText },
    Column { name: "message", kind: Kind::LongText },
];

/// The findings about inputs that contradict each other, as the layer `conflicts`. The attributes are those of
/// [`of_findings`].
pub fn of_conflicts<'a>(findings: &'a [Finding], back: &FromWorking) -> Layer<'a> {
    let conflicts = findings.iter().filter(|finding| finding.kind.is_conflict());
    Layer { name: "conflicts", ..layer(conflicts, back) }
}

/// The findings, as points.
///
/// The attributes are:
/// - `code`; `severity`: `error`, `warning` or `note`; `message`
/// - `elev`: the first elevation in question, metres; `elevs`: all of them
/// - `features`: numbers of the features in the file, separated by commas
/// - `proposed`: a proposed elevation that would fit; `proposal`: the proposed repair, in words, with its places in the
///   coordinates of the output
///
/// A finding without a place is a feature without geometry.
pub fn of_findings<'a>(findings: &'a [Finding], back: &FromWorking) -> Layer<'a> {
    layer(findings.iter(), back)
}

fn layer<'a>(findings: impl Iterator<Item = &'a Finding>, back: &FromWorking) -> Layer<'a> {
    let place = |p| back.place_in_words(p);
    let rows = findings.map(|finding| {
        let proposed = match finding.proposal {
            Some(Proposal::Relabel { to, .. }) => Cell::Real(to),
            _ => Cell::Null,
        };
        let elevation = finding.elevations.first();
        Row {
            shape: Shape::Point(finding.place),
            cells: vec![
                Cell::Text(finding.kind.code().into()),
                Cell::Text(finding.kind.severity().name().into()),
                elevation.map_or(Cell::Null, |&z| Cell::Real(z)),
                listed(&finding.elevations),
                listed(&finding.features),
                proposed,
                finding.proposal.as_ref().map_or(Cell::Null, |p| Cell::Text(p.in_words(place).into())),
                Cell::Text(finding.message.as_str().into()),
            ],
        }
    });
    Layer { name: FINDINGS_LAYER, geometry: Geometry::Points, columns: COLUMNS, rows: rows.collect() }
}

fn listed<T: ToString>(values: &[T]) -> Cell<'static> {
    if values.is_empty() {
        return Cell::Null;
    }
    Cell::Text(values.iter().map(T::to_string).collect::<Vec<_>>().join(",").into())
}
