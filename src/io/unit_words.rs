//! Units of length as files write them beside elevations: as words, as codes of the EPSG registry, and as the codes of the
//! contours of the USGS.

use tokosen_core::base::ElevationUnit;

/// A unit in which a file may state its elevations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum LengthWord {
    Metre,
    Foot,
    UsSurveyFoot,
    Millimetre,
    Centimetre,
    Decimetre,
    Kilometre,
    Yard,
    Fathom,
}

use LengthWord::{Centimetre, Decimetre, Fathom, Foot, Kilometre, Metre, Millimetre, UsSurveyFoot, Yard};

/// The words of each unit, in lower case; gaps are single spaces. Then its code in the EPSG registry.
const WORDS: &[(LengthWord, &[&str], f64)] = &[
    (
        Metre,
        &[
            "m",
            "meter",
            "meters",
            "metre",
            "metres",
            "mtr",
            "mtrs",
            "mts",
            "mt",
            "metro",
            "metros",
            "metri",
            "mètre",
            "mètres",
            "metr",
            "metry",
            "metrů",
            "metrów",
            "metriä",
            "méter",
            "méteres",
            "m.",
            "м",
            "метр",
            "метры",
            "метров",
            "米",
            "公尺",
            "ｍ",
            "メートル",
            "미터",
        ],
        9001.0,
    ),
    (
        Foot,
        &[
            "ft",
            "feet",
            "foot",
            "'",
            "ft i",
            "ift",
            "international feet",
            "international foot",
            "feet (international)",
            "foot (international)",
            "pied",
            "pieds",
            "pies",
            "フィート",
            "英尺",
            "피트",
        ],
        9002.0,
    ),
    (
        UsSurveyFoot,
        &[
            "us ft",
            "usft",
            "ftus",
            "ft us",
            "us feet",
            "us foot",
            "survey feet",
            "survey foot",
            "us survey feet",
            "us survey foot",
            "us survey ft",
            "foot us",
            "feet us",
            "foot (us survey)",
            "feet (us survey)",
            "sft",
        ],
        9003.0,
    ),
    (Millimetre, &["mm", "millimeter", "millimeters", "millimetre", "millimetres", "ミリメートル", "毫米"], 1025.0),
    (Centimetre, &["cm", "centimeter", "centimeters", "centimetre", "centimetres", "センチメートル", "厘米"], 1033.0),
    (Decimetre, &["dm", "decimeter", "decimeters", "decimetre", "decimetres", "分米"], f64::NAN),
    (Kilometre, &["km", "kilometer", "kilometers", "kilometre", "kilometres"], 9036.0),
    (Yard, &["yd", "yds", "yard", "yards"], 9096.0),
    (Fathom, &["fathom", "fathoms", "ftm", "fth", "fm", "fms"], 9014.0),
];

/// The codes of the domain of `ContourUnits` in the contours of the USGS.
const USGS: [(f64, LengthWord); 2] = [(1.0, Foot), (2.0, Metre)];

impl LengthWord {
    /// The unit of a word, of a name such as `urn:ogc:def:uom:EPSG::9002`, or of a code of the registry as text.
    pub fn of_text(text: &str) -> Option<Self> {
        let last = text.trim().rsplit(['/', ':', '#']).next().unwrap_or_default();
        let lower = last.to_lowercase().replace("u.s.", "us");
        let bare = lower.trim_matches(|c: char| c.is_whitespace() || "[]\".".contains(c));
        let words: Vec<&str> =
            bare.split(|c: char| c.is_whitespace() || "_-".contains(c)).filter(|w| !w.is_empty()).collect();
        let bare = words.join(" ");
        let bare = bare.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).unwrap_or(&bare);
        if let Ok(code) = bare.parse::<f64>() {
            return Self::of_code(code);
        }
        WORDS.iter().find(|(_, words, _)| words.contains(&bare)).map(|(unit, _, _)| *unit)
    }

    /// The unit of a code of the EPSG registry.
    pub fn of_code(code: f64) -> Option<Self> {
        WORDS.iter().find(|(_, _, own)| *own == code).map(|(unit, _, _)| *unit)
    }

    /// The unit of a code of the USGS.
    pub fn of_usgs_code(code: f64) -> Option<Self> {
        USGS.iter().find(|(own, _)| *own == code).map(|(_, unit)| *unit)
    }

    /// Its name in sentences, plural.
    pub fn name(self) -> &'static str {
        match self {
            Metre => ElevationUnit::Metre.name(),
            Foot => ElevationUnit::Foot.name(),
            UsSurveyFoot => ElevationUnit::UsSurveyFoot.name(),
            Millimetre => "millimetres",
            Centimetre => "centimetres",
            Decimetre => "decimetres",
            Kilometre => "kilometres",
            Yard => "yards",
            Fathom => "fathoms",
        }
    }

    /// The unit of elevations, if it is one that a whole map may be in.
    pub fn elevation_unit(self) -> Option<ElevationUnit> {
        match self {
            Metre => Some(ElevationUnit::Metre),
            Foot => Some(ElevationUnit::Foot),
            UsSurveyFoot => Some(ElevationUnit::UsSurveyFoot),
            _ => None,
        }
    }

    /// An elevation of this unit in metres. Numerator and denominator are exact.
    pub fn metres(self, elevation: f64) -> f64 {
        match self {
            Metre => elevation,
            Foot => ElevationUnit::Foot.metres(elevation),
            UsSurveyFoot => ElevationUnit::UsSurveyFoot.metres(elevation),
            Millimetre => elevation / 1000.0,
            Centimetre => elevation / 100.0,
            Decimetre => elevation / 10.0,
            Kilometre => elevation * 1000.0,
            Yard => elevation * 9144.0 / 10_000.0,
            Fathom => elevation * 18_288.0 / 10_000.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_names_and_codes_of_units() {
        let cases = [
            ("m", Some(Metre)),
            (" Meters ", Some(Metre)),
            ("urn:ogc:def:uom:EPSG::9001", Some(Metre)),
            ("http://www.opengis.net/def/uom/EPSG/0/9002", Some(Foot)),
            ("9003", Some(UsSurveyFoot)),
            ("Feet", Some(Foot)),
            ("FT.", Some(Foot)),
            ("[ft_i]", Some(Foot)),
            ("(ft)", Some(Foot)),
            ("U.S. Survey Feet", Some(UsSurveyFoot)),
            ("US_survey_foot", Some(UsSurveyFoot)),
            ("ft-us", Some(UsSurveyFoot)),
            ("mm", Some(Millimetre)),
            ("Centimetres", Some(Centimetre)),
            ("fathoms", Some(Fathom)),
            ("メートル", Some(Metre)),
            ("1", None),
            ("Qal", None),
            ("", None),
            ("degrees", None),
        ];
        for (text, unit) in cases {
            assert_eq!(LengthWord::of_text(text), unit, "{text}");
        }
        assert_eq!([1.0, 2.0, 3.0].map(LengthWord::of_usgs_code), [Some(Foot), Some(Metre), None]);
        assert_eq!(LengthWord::of_code(f64::NAN), None);
    }

    #[test]
    fn each_unit_becomes_metres() {
        assert_eq!(Foot.metres(8000.0), 2438.4);
        let cases = [(Millimetre, 102_500.0, 102.5), (Centimetre, 10_250.0, 102.5), (Decimetre, 1025.0, 102.5)];
        for (unit, z, metres) in cases {
            assert_eq!(unit.metres(z), metres, "{unit:?}");
        }
        assert_eq!((Kilometre.metres(1.2), Yard.metres(100.0), Fathom.metres(10.0)), (1200.0, 91.44, 18.288));
    }
}
