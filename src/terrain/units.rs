//! The unit of the elevations of a file: what the caller asks for, what the file states, what it lets suppose.

use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::contour::{StatedUnit, UnitHint};
use tokosen_core::crs::{Crs, LengthUnit};

/// The elevations of a file, and what is known about their unit.
pub(super) struct Elevations<'a> {
    /// What they are, as the subject of a sentence: `the elevations`.
    pub what: &'a str,
    /// The unit that the caller asks for.
    pub asked: Option<ElevationUnit>,
    /// The unit if nothing states one.
    pub otherwise: ElevationUnit,
    /// The coordinate reference system, with a vertical part if it states the unit.
    pub crs: Option<&'a Crs>,
    /// What the file states beside the elevations.
    pub stated: Option<&'a StatedUnit>,
    /// What the file lets suppose.
    pub hint: Option<&'a UnitHint>,
}

impl Elevations<'_> {
    /// Their unit. The caller's unit comes first, then what the file states beside the elevations, then the vertical part
    /// of the system. What contradicts the unit is a finding, and so is a unit other than metres that nobody asked for.
    pub fn unit(&self, findings: &mut Vec<Finding>) -> ElevationUnit {
        let own = self.crs.and_then(Crs::height_unit);
        let of_crs = own.as_ref().and_then(|own| ElevationUnit::of_size(own.metres));
        let (unit, finding) = match self.stated {
            Some(stated) => self.beside(stated, of_crs),
            None => {
                let unit = self.asked.or(of_crs).unwrap_or(self.otherwise);
                (unit, self.finding(own.as_ref(), of_crs, unit))
            }
        };
        findings.extend(finding.map(|(kind, text)| Finding::general(kind, text)));
        unit
    }

    /// The unit of elevations for which the file states one, and what is to be said about it.
    fn beside(
        &self,
        stated: &StatedUnit,
        of_crs: Option<ElevationUnit>,
    ) -> (ElevationUnit, Option<(FindingKind, String)>) {
        let (what, says) = (self.what, &stated.says);
        // Files say feet for either foot.
        let agrees = |other: ElevationUnit| {
            other == stated.unit || (stated.unit == ElevationUnit::Foot && other == ElevationUnit::UsSurveyFoot)
        };
        if let Some(asked) = self.asked {
            let text = format!("{says}; {what} are taken as {} all the same", asked.name());
            return (asked, (!agrees(asked)).then_some((FindingKind::UnitDoubt, text)));
        }
        let unit = of_crs.filter(|of_crs| agrees(*of_crs)).unwrap_or(stated.unit);
        let rival = match (of_crs.filter(|of_crs| !agrees(*of_crs)), self.hint.filter(|hint| hint.contradicts(unit))) {
            (Some(of_crs), _) => Some(format!("the coordinate reference system states heights in {}", of_crs.name())),
            (None, hint) => hint.map(|hint| hint.says.clone()),
        };
        let finding = match rival {
            Some(rival) => {
                let text = format!("{says}, but {rival}; {what} are taken as {}", unit.name());
                Some((FindingKind::UnitDoubt, text))
            }
            None => unit
                .is_foot()
                .then(|| (FindingKind::HeightUnit, format!("{says}; {what} were read as {}", unit.name()))),
        };
        (unit, finding)
    }

    fn finding(
        &self,
        own: Option<&LengthUnit>,
        stated: Option<ElevationUnit>,
        unit: ElevationUnit,
    ) -> Option<(FindingKind, String)> {
        let (what, name) = (self.what, unit.name());
        let taken = format!("{what} are taken as {name}");
        let hint = self.hint.filter(|hint| self.asked.is_none() && hint.contradicts(unit));
        let states = |stated: &str| format!("the coordinate reference system states heights in {stated}");
        Some(match (own, stated, hint) {
            (Some(own), None, _) if self.asked.is_none() => {
                (FindingKind::UnitDoubt, format!("{}, which is no unit known here; {taken}", states(&own.name)))
            }
            (_, Some(stated), None) if stated != unit => {
                (FindingKind::UnitDoubt, format!("{}; {taken} all the same", states(stated.name())))
            }
            (_, Some(stated), Some(hint)) => {
                (FindingKind::UnitDoubt, format!("{}, but {}; {taken}", states(stated.name()), hint.says))
            }
            (_, None, Some(hint)) => (FindingKind::UnitDoubt, format!("{}; {taken}", hint.says)),
            (_, Some(stated), None) if self.asked.is_none() && stated.is_foot() => {
                (FindingKind::HeightUnit, format!("{}; {what} were read as {name}", states(name)))
            }
            _ => return self.doubt_by_the_plane(unit).map(|text| (FindingKind::UnitDoubt, text)),
        })
    }

    /// The sentence about a plane in feet if nothing states the unit of elevations, and they are taken as metres.
    fn doubt_by_the_plane(&self, unit: ElevationUnit) -> Option<String> {
        let is_open = self.asked.is_none() && !unit.is_foot() && self.hint.is_none();
        let crs = self.crs.filter(|crs| is_open && crs.height_unit().is_none())?;
        let plane = crs.length_unit().and_then(|own| ElevationUnit::of_size(own.metres)).filter(|own| own.is_foot())?;
        let (what, plane) = (self.what, plane.name());
        Some(format!("the coordinates are {plane}, and nothing states the unit of heights; {what} are taken as metres"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokosen_core::base::ElevationUnit::{Foot, Metre, UsSurveyFoot};

    /// The unit, and the kinds of the findings with their sentences.
    fn unit(
        asked: Option<ElevationUnit>,
        crs: &Crs,
        hint: Option<bool>,
        otherwise: ElevationUnit,
    ) -> (ElevationUnit, Vec<(FindingKind, String)>) {
        let says = |is_feet| UnitHint { says: "the field \"x\" seems to hold another unit".into(), is_feet };
        let hint = hint.map(says);
        let mut findings = Vec::new();
        let elevations =
            Elevations { what: "the elevations", asked, otherwise, crs: Some(crs), stated: None, hint: hint.as_ref() };
        let unit = elevations.unit(&mut findings);
        (unit, findings.into_iter().map(|finding| (finding.kind, finding.message)).collect())
    }

    /// NAD83 / Arizona East (ft) + NAVD88 height (ft), the same without heights, UTM with heights in metres.
    const FEET: u32 = 8700;
    const PLANE_IN_FEET: u32 = 2222;
    const METRES: u32 = 5972;

    #[test]
    fn what_is_certain_is_used_and_told() {
        let (found, told) = unit(None, &Crs::from_epsg(FEET), None, Metre);
        let text = "the coordinate reference system states heights in feet; the elevations were read as feet";
        assert_eq!((found, told), (Foot, vec![(FindingKind::HeightUnit, text.to_owned())]));
        assert_eq!(unit(None, &Crs::from_epsg(METRES), None, Metre), (Metre, vec![]));
        assert_eq!(unit(None, &Crs::from_epsg(METRES), None, Foot), (Metre, vec![]));
        assert_eq!(unit(Some(Foot), &Crs::from_epsg(FEET), None, Metre), (Foot, vec![]));
        // A hint that agrees adds nothing.
        assert_eq!(unit(None, &Crs::from_epsg(FEET), Some(true), Metre).1.len(), 1);
    }

    #[test]
    fn what_is_likely_is_told_and_not_used() {
        let doubt = |asked, crs, hint, otherwise| {
            let (found, told) = unit(asked, &Crs::from_epsg(crs), hint, otherwise);
            assert!(told.len() == 1 && told[0].0 == FindingKind::UnitDoubt, "{told:?}");
            (found, told[0].1.clone())
        };
        let (found, text) = doubt(None, 32612, Some(true), Metre);
        assert_eq!(found, Metre);
        assert_eq!(text, "the field \"x\" seems to hold another unit; the elevations are taken as metres");
        let (found, text) = doubt(None, PLANE_IN_FEET, None, Metre);
        assert_eq!(found, Metre);
        assert!(text.starts_with("the coordinates are feet, and nothing states"), "{text}");
        // Two statements that contradict each other.
        let (found, text) = doubt(None, FEET, Some(false), Metre);
        assert_eq!(found, Foot);
        assert!(text.ends_with("seems to hold another unit; the elevations are taken as feet"), "{text}");
        assert_eq!(doubt(None, METRES, Some(true), Metre).0, Metre);
        let (found, text) = doubt(Some(UsSurveyFoot), FEET, None, Metre);
        assert_eq!(found, UsSurveyFoot);
        assert!(text.ends_with("heights in feet; the elevations are taken as US survey feet all the same"), "{text}");
    }

    #[test]
    fn a_unit_that_was_asked_for_leaves_no_doubt() {
        for asked in [Metre, Foot] {
            assert_eq!(unit(Some(asked), &Crs::from_epsg(PLANE_IN_FEET), Some(true), Metre), (asked, vec![]));
        }
        assert_eq!(unit(None, &Crs::from_epsg(PLANE_IN_FEET), Some(false), Metre), (Metre, vec![]));
        assert_eq!(unit(None, &Crs::from_epsg(PLANE_IN_FEET), None, Foot), (Foot, vec![]));
    }

    /// The unit with a statement of feet or metres, and the kinds of the findings with their sentences.
    fn beside(
        asked: Option<ElevationUnit>,
        crs: &Crs,
        stated: ElevationUnit,
        hint: Option<bool>,
    ) -> (ElevationUnit, Vec<(FindingKind, String)>) {
        let stated = StatedUnit { says: format!("the field \"u\" states {}", stated.name()), unit: stated };
        let hint = hint.map(|is_feet| UnitHint { says: "the field \"x\" seems to hold another unit".into(), is_feet });
        let mut findings = Vec::new();
        let elevations = Elevations {
            what: "the elevations",
            asked,
            otherwise: Metre,
            crs: Some(crs),
            stated: Some(&stated),
            hint: hint.as_ref(),
        };
        let unit = elevations.unit(&mut findings);
        (unit, findings.into_iter().map(|finding| (finding.kind, finding.message)).collect())
    }

    #[test]
    fn what_the_file_states_beside_elevations_is_used() {
        let utm = Crs::from_epsg(32612);
        let text = "the field \"u\" states feet; the elevations were read as feet".to_owned();
        assert_eq!(beside(None, &utm, Foot, None), (Foot, vec![(FindingKind::HeightUnit, text)]));
        assert_eq!(beside(None, &utm, Metre, None), (Metre, vec![]));
        assert_eq!(beside(None, &Crs::from_epsg(PLANE_IN_FEET), Metre, None), (Metre, vec![]));
        assert_eq!(beside(Some(UsSurveyFoot), &utm, Foot, None), (UsSurveyFoot, vec![]));
        // Contradictions: by the system, by the name of the field, by the caller.
        let doubts = |found: (ElevationUnit, Vec<(FindingKind, String)>)| {
            assert!(found.1.len() == 1 && found.1[0].0 == FindingKind::UnitDoubt, "{found:?}");
            found.0
        };
        assert_eq!(doubts(beside(None, &Crs::from_epsg(FEET), Metre, None)), Metre);
        assert_eq!(doubts(beside(None, &utm, Metre, Some(true))), Metre);
        assert_eq!(doubts(beside(Some(Metre), &utm, Foot, None)), Metre);
        assert_eq!(doubts(beside(Some(Foot), &utm, Metre, None)), Foot);
    }

    #[test]
    fn a_vertical_unit_that_is_not_known_is_told() {
        let plane = Crs::from_epsg(32612).wkt.expect("the table has it");
        let text = format!("COMPD_CS[\"both\",{plane},VERT_CS[\"depth\",UNIT[\"fathom\",1.8288]]]");
        let (found, told) = unit(None, &Crs::from_wkt(&text), None, Metre);
        assert_eq!(found, Metre);
        assert!(told[0].1.contains("heights in fathom, which is no unit known here"), "{told:?}");
    }
}
