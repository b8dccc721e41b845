//! The unit of a drawing: the variable `$INSUNITS` of its header.

use crate::table::Table;
use tokosen_core::base::ElevationUnit;
use tokosen_core::contour::UnitHint;
use tokosen_core::crs::LengthUnit;

/// The metre, by its code.
const METRE: i64 = 6;
/// No unit, by its code.
const UNITLESS: i64 = 0;

/// Codes of the units that are not metric.
const IMPERIAL: [i64; 10] = [1, 2, 3, 8, 9, 10, 21, 22, 23, 24];

/// A unit of the header: its code, its name, its name in the plural, its size in metres.
type DrawingUnit = (i64, &'static str, &'static str, f64);

/// The units that the format knows (AutoCAD's DXF reference, `$INSUNITS`).
const UNITS: &[DrawingUnit] = &[
    (1, "inch", "inches", 0.0254),
    (2, "foot", "feet", 0.3048),
    (3, "mile", "miles", 1609.344),
    (4, "millimetre", "millimetres", 1e-3),
    (5, "centimetre", "centimetres", 1e-2),
    (METRE, "metre", "metres", 1.0),
    (7, "kilometre", "kilometres", 1e3),
    (8, "microinch", "microinches", 2.54e-8),
    (9, "mil", "mils", 2.54e-5),
    (10, "yard", "yards", 0.9144),
    (11, "angstrom", "angstroms", 1e-10),
    (12, "nanometre", "nanometres", 1e-9),
    (13, "micron", "microns", 1e-6),
    (14, "decimetre", "decimetres", 0.1),
    (15, "decametre", "decametres", 10.0),
    (16, "hectometre", "hectometres", 100.0),
    (17, "gigametre", "gigametres", 1e9),
    (18, "astronomical unit", "astronomical units", 149_597_870_700.0),
    (19, "light year", "light years", 9_460_730_472_580_800.0),
    (20, "parsec", "parsecs", 3.085_677_581_491_367e16),
    (21, "US survey foot", "US survey feet", 1200.0 / 3937.0),
    (22, "US survey inch", "US survey inches", 100.0 / 3937.0),
    (23, "US survey yard", "US survey yards", 3600.0 / 3937.0),
    (24, "US survey mile", "US survey miles", 6_336_000.0 / 3937.0),
];

/// Notes in a table what the header says about the unit, by its code, and why there is no coordinate reference system.
pub(super) fn note(table: &mut Table, code: Option<i64>) {
    let mut problem = "a DXF does not name its coordinate reference system".to_owned();
    if let Some((code, name, plural, metres)) = code.and_then(unit) {
        table.plane_unit = Some(LengthUnit { name: name.to_owned(), metres });
        if code != METRE {
            problem.push_str(&format!("; its unit is said to be {plural}"));
        }
        if ElevationUnit::of_size(metres).is_some_and(ElevationUnit::is_foot) {
            let says = format!("the drawing says that its unit is {plural}");
            table.unit_hint = Some(UnitHint { says, is_feet: true });
        } else if code != METRE {
            problem.push_str(", and heights are taken as metres");
        }
    }
    table.crs_problem = Some(problem);
}

fn unit(code: i64) -> Option<DrawingUnit> {
    UNITS.iter().find(|unit| unit.0 == code).copied()
}

/// The code of a unit in the header, and whether it is one of the metric system. No unit is known if the format has none of
/// this size.
pub(crate) fn code_of(unit: Option<&LengthUnit>) -> (i64, bool) {
    // Coordinates of which nothing is known count as metres everywhere.
    let Some(unit) = unit else { return (METRE, true) };
    let is_it = |known: &&DrawingUnit| (known.3 - unit.metres).abs() <= 1e-7 * known.3;
    // The two feet differ by less than texts round, so the nearer one is taken.
    let nearest = UNITS.iter().filter(is_it).min_by(|a, b| {
        let off = |known: &DrawingUnit| (known.3 - unit.metres).abs();
        off(a).total_cmp(&off(b))
    });
    let Some(&(code, ..)) = nearest else { return (UNITLESS, true) };
    (code, !IMPERIAL.contains(&code))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_have_the_sizes_of_their_units() {
        let unit_of = |metres: f64| code_of(Some(&LengthUnit { name: "x".into(), metres }));
        for (metres, code, is_metric) in [
            (1.0, 6, true),
            (0.3048, 2, false),
            (1200.0 / 3937.0, 21, false),
            (0.304_800_609_601, 21, false),
            (0.3048000000001, 2, false),
            (0.9144, 10, false),
            (1e-3, 4, true),
            (1000.0, 7, true),
            // The link of Clarke, the German legal metre.
            (0.201_166_195_164, 0, true),
            (1.000_013_596_5, 0, true),
        ] {
            assert_eq!(unit_of(metres), (code, is_metric), "{metres}");
        }
        assert_eq!(code_of(None), (6, true));
        for (number, unit) in UNITS.iter().enumerate() {
            assert_eq!(unit.0, number as i64 + 1);
            assert_eq!(unit_of(unit.3).0, unit.0, "{}", unit.1);
        }
    }

    #[test]
    fn what_the_header_says_is_noted() {
        for (code, unit, is_feet) in [(2, Some(0.3048), true), (21, Some(1200.0 / 3937.0), true), (6, Some(1.0), false)]
        {
            let mut table = Table::default();
            note(&mut table, Some(code));
            assert_eq!(table.plane_unit.map(|unit| unit.metres), unit);
            assert_eq!(table.unit_hint.is_some(), is_feet);
        }
        for code in [None, Some(0), Some(99), Some(-1)] {
            let mut table = Table::default();
            note(&mut table, code);
            assert!(table.plane_unit.is_none() && table.unit_hint.is_none());
            assert_eq!(table.crs_problem.as_deref(), Some("a DXF does not name its coordinate reference system"));
        }
    }
}
