//! Height systems: what heights are counted from.
//!
//! Systems of one country differ by centimetres to metres, and heights above the ellipsoid by tens of metres. Files name their
//! system by the vertical part of a compound coordinate reference system, or not at all.
//!
//! Codes and names are those of the EPSG Dataset, version 11.022.

use super::system::Crs;
use crate::base::ElevationUnit;
use crate::base::error::{Finding, FindingKind};
use ElevationUnit::{Foot, Metre, UsSurveyFoot};

/// What heights are counted from.
#[derive(Debug, Clone, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct HeightSystem {
    /// Its usual name, such as `NAVD88`; as a file has it if it is not in the table.
    pub name: String,
}

/// A height system with its codes and the beginnings of the names that files use, in small letters and digits alone.
struct Known {
    name: &'static str,
    codes: &'static [(u32, ElevationUnit)],
    names: &'static [&'static str],
}

/// Heights above the ellipsoid, as satellite receivers give them.
const ELLIPSOIDAL: &str = "ellipsoidal";

const fn known(name: &'static str, codes: &'static [(u32, ElevationUnit)], names: &'static [&'static str]) -> Known {
    Known { name, codes, names }
}

/// The table. Depths of a system are in it as the system itself.
const SYSTEMS: &[Known] = &[
    known("JGD2024", &[], &["jgd2024", "japanesegeodeticdatum2024"]),
    known("JGD2011", &[(6695, Metre)], &["jgd2011", "japanesegeodeticdatum2011"]),
    known("JGD2000", &[(6694, Metre)], &["jgd2000", "japanesegeodeticdatum2000"]),
    known("JSLD72", &[(6693, Metre)], &["jsld72", "japanesestandardlevellingdatum1972"]),
    known("JSLD69", &[(5723, Metre)], &["jsld69", "japanesestandardlevellingdatum1969"]),
    known(
        "NAVD88",
        &[(5703, Metre), (6360, UsSurveyFoot), (8228, Foot)],
        &["navd88", "navd1988", "northamericanverticaldatum1988", "northamericanverticaldatumof1988"],
    ),
    known(
        "NGVD29",
        &[(7968, Metre), (5702, UsSurveyFoot)],
        &["ngvd29", "ngvd1929", "nationalgeodeticverticaldatum1929", "nationalgeodeticverticaldatumof1929"],
    ),
    known("CGVD2013", &[(6647, Metre), (9245, Metre)], &["cgvd2013", "canadiangeodeticverticaldatumof2013"]),
    known("CGVD28", &[(5713, Metre)], &["cgvd28", "cgvd1928", "canadiangeodeticverticaldatumof1928"]),
    known("EVRF2019", &[(9389, Metre)], &["evrf2019", "europeanverticalreferenceframe2019"]),
    known("EVRF2007", &[(5621, Metre)], &["evrf2007", "europeanverticalreferenceframe2007"]),
    known("EVRF2000", &[(5730, Metre)], &["evrf2000", "europeanverticalreferenceframe2000"]),
    known("DHHN2016", &[(7837, Metre)], &["dhhn2016", "deutscheshaupthoehennetz2016"]),
    known("DHHN92", &[(5783, Metre)], &["dhhn92", "deutscheshaupthoehennetz1992"]),
    known("DHHN85", &[(5784, Metre)], &["dhhn85", "deutscheshaupthoehennetz1985"]),
    known("NAP", &[(5709, Metre)], &["napheight", "normaalamsterdamspeil"]),
    known("NGF-IGN69", &[(5720, Metre)], &["ngfign69", "nivellementgeneraldelafranceign69"]),
    known("LHN95", &[(5729, Metre)], &["lhn95", "landeshohennetz1995"]),
    known("LN02", &[(5728, Metre)], &["ln02", "landesnivellement1902"]),
    known("ODN", &[(5701, Metre)], &["odnheight", "ordnancedatumnewlyn", "newlyn"]),
    known("NN2000", &[(5941, Metre)], &["nn2000", "norwaynormalnull2000"]),
    known("NN1954", &[(5776, Metre)], &["nn54", "nn1954", "norwaynormalnull1954"]),
    known("RH2000", &[(5613, Metre)], &["rh2000", "riketshojdsystem2000"]),
    known("RH70", &[(5718, Metre)], &["rh70", "riketshojdsystem1970"]),
    known("N2000", &[(3900, Metre)], &["n2000"]),
    known("N60", &[(5717, Metre)], &["n60", "helsinki1960"]),
    known("DVR90", &[(5799, Metre)], &["dvr90", "danskvertikalreference1990"]),
    known("SVS2010", &[(8690, Metre)], &["svs2010", "slovenianverticalsystem2010"]),
    known("SVS2000", &[(5779, Metre)], &["svs2000", "slovenianverticalsystem2000"]),
    known("Baltic 1977", &[(5705, Metre)], &["baltic1977"]),
    known("AHD", &[(5711, Metre)], &["ahdheight", "australianheightdatum"]),
    known("AHD (Tasmania)", &[(5712, Metre)], &["ahdtasmania", "australianheightdatumtasmania"]),
    known("NZVD2016", &[(7839, Metre)], &["nzvd2016", "newzealandverticaldatum2016"]),
    known("NZVD2009", &[(4440, Metre)], &["nzvd2009", "newzealandverticaldatum2009"]),
    known("Auckland 1946", &[(5759, Metre)], &["auckland1946"]),
    known("Moturiki 1953", &[(5764, Metre)], &["moturiki1953"]),
    known("Napier 1962", &[(5765, Metre)], &["napier1962"]),
    known("Wellington 1953", &[(5770, Metre)], &["wellington1953"]),
    known("Lyttelton 1937", &[(5763, Metre)], &["lyttelton1937"]),
    known("Dunedin 1958", &[(5761, Metre)], &["dunedin1958"]),
    known("EGM2008", &[(3855, Metre)], &["egm2008"]),
    known("EGM96", &[(5773, Metre)], &["egm96"]),
    known(
        "mean sea level",
        &[(5714, Metre), (5715, Metre), (8050, Foot), (8051, Foot), (8052, UsSurveyFoot), (8053, UsSurveyFoot)],
        &["msl", "meansealevel"],
    ),
    // What depths of charts are counted from.
    known("chart datum", &[], &["chartdatum", "admiraltychartdatum", "最低水面", "基本水準面"]),
    known("lower low water, large tide", &[(5862, Metre)], &["llwlt", "lowerlowwaterlargetide"]),
    known("Indian spring low water", &[(5863, Metre)], &["islw", "indianspringlowwater"]),
    known("mean lower low water springs", &[(5864, Metre)], &["mllws", "meanlowerlowwaterspring"]),
    known("mean low water springs", &[(5865, Metre)], &["mlws", "meanlowwaterspring"]),
    known("mean low water", &[(5867, Metre)], &["mlwdepth", "mlwheight", "meanlowwater"]),
    known("low water", &[(5873, Metre)], &["lowwater"]),
    known("mean high water", &[(5868, Metre)], &["mhwdepth", "mhwheight", "meanhighwater"]),
    known("highest astronomical tide", &[(5872, Metre)], &["hatheight", "highestastronomicaltide"]),
    known("Caspian Sea", &[(5706, Metre), (5611, Metre)], &["caspian"]),
    known("Black Sea", &[(5336, Metre), (5735, Metre)], &["blacksea"]),
    known("lowest astronomical tide", &[(5861, Metre)], &["latdepth", "latheight", "lowestastronomicaltide"]),
    known("mean lower low water", &[(5866, Metre)], &["mllw", "meanlowerlowwater"]),
    known("local height in feet", &[(6130, Foot), (6131, Foot), (6132, Foot)], &["gcvd54", "lcvd61", "cbvd61"]),
    known(ELLIPSOIDAL, &[], &["ellipsoid"]),
];

/// The usual size of the difference between two systems.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UsualDifference {
    /// The size and where it applies, as the end of a sentence.
    pub text: &'static str,
    /// Who says so.
    pub source: &'static str,
}

/// Pairs of systems with the usual difference between them.
const DIFFERENCES: &[(&str, &str, UsualDifference)] = &[
    (
        "JGD2011",
        "JGD2024",
        UsualDifference {
            text: "JGD2024 minus JGD2011 is -0.67 to +0.57 m at triangulation points, -0.40 to +0.23 m at bench marks",
            source: "Geospatial Information Authority of Japan, https://www.gsi.go.jp/sokuchikijun/hyoko2024rev-QA.html, Q1-3",
        },
    ),
    (
        "JGD2000",
        "JGD2011",
        UsualDifference {
            text: "they are the same but in the prefectures of the earthquakes of 2008 and 2011 in the north-east of Honshu",
            source: "EPSG:6699",
        },
    ),
    (
        "NGVD29",
        "NAVD88",
        UsualDifference {
            text: "they differ by up to 0.5 m east of 89\u{b0} W, by up to 0.9 m west of it, and by 0.6 to 1.6 m in the far west of the United \
                   States",
            source: "EPSG:7969, EPSG:7970, EPSG:7971",
        },
    ),
    (
        "NN1954",
        "NN2000",
        UsualDifference {
            text: "they differ by -0.15 to +0.35 m",
            source: "Kartverket, https://kartverket.no/Posisjonstjenester/bruke-referanserammer/ta-i-bruk-nn2000/",
        },
    ),
    (
        "N60",
        "N2000",
        UsualDifference {
            text: "N2000 minus N60 is 0.13 to 0.43 m",
            source: "Finnish Environment Institute, https://www.vesi.fi/vesitieto/mika-on-merenpinta-josta-korkeudet-lasketaan/",
        },
    ),
    (
        "DHHN85",
        "DHHN92",
        UsualDifference {
            text: "DHHN92 minus DHHN85 is -0.05 to +0.04 m",
            source: "Bundesamt für Kartographie und Geodäsie, Das deutsche Höhenreferenzsystem",
        },
    ),
    ("NGF-IGN69", "EVRF2000", UsualDifference { text: "EVRF2000 minus NGF-IGN69 is -0.49 m", source: "EPSG:5419" }),
    ("NAP", "EVRF2000", UsualDifference { text: "EVRF2000 minus NAP is -0.005 m", source: "EPSG:5425" }),
    ("N60", "EVRF2000", UsualDifference { text: "EVRF2000 minus N60 is 0.21 m", source: "EPSG:5432" }),
    ("ODN", "EVRF2019", UsualDifference { text: "EVRF2019 minus ODN is -0.17 m at Dover", source: "EPSG:9562" }),
    ("NZVD2016", "Auckland 1946", UsualDifference { text: "they differ by 0.29 m on average", source: "EPSG:9312" }),
    ("NZVD2016", "Moturiki 1953", UsualDifference { text: "they differ by 0.31 m on average", source: "EPSG:9318" }),
    ("NZVD2016", "Napier 1962", UsualDifference { text: "they differ by 0.20 m on average", source: "EPSG:9319" }),
    ("NZVD2016", "Wellington 1953", UsualDifference { text: "they differ by 0.41 m on average", source: "EPSG:9324" }),
    ("NZVD2016", "Lyttelton 1937", UsualDifference { text: "they differ by 0.34 m on average", source: "EPSG:9317" }),
    ("NZVD2016", "Dunedin 1958", UsualDifference { text: "they differ by 0.33 m on average", source: "EPSG:9314" }),
    (
        "EGM96",
        "EGM2008",
        UsualDifference {
            text: "they differ by about 0.5 m (RMS)",
            source: "United States Naval Academy, https://www.usna.edu/Users/oceano/pguth/md_help/html/egm96.htm",
        },
    ),
];

/// The difference of all other systems from heights above the ellipsoid.
const OF_ELLIPSOID: UsualDifference = UsualDifference {
    text: "heights above the ellipsoid and above the sea differ by up to about 100 m",
    source: "United States Naval Academy, https://www.usna.edu/Users/oceano/pguth/md_help/html/egm96.htm",
};

impl HeightSystem {
    /// The system of an EPSG code; `None` if the code is not in the table.
    pub fn of_code(code: u32) -> Option<Self> {
        row_of(code).map(|(row, _)| Self { name: row.name.into() })
    }

    /// The system that a text names: the usual name if it is in the table, otherwise the text itself.
    pub fn named(text: &str) -> Self {
        let plain: String = text.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
        let begins = |row: &&Known| row.names.iter().any(|name| plain.starts_with(name));
        // The longest name is the nearest one: AHD (Tasmania) is not AHD.
        let length = |row: &&Known| row.names.iter().filter(|name| plain.starts_with(*name)).map(|n| n.len()).max();
        let row = SYSTEMS.iter().filter(begins).max_by_key(length);
        Self { name: row.map_or_else(|| text.trim().to_owned(), |row| row.name.into()) }
    }

    /// Heights above the ellipsoid.
    pub fn ellipsoidal() -> Self {
        Self { name: ELLIPSOIDAL.into() }
    }

    /// The usual size of the difference from another system, if somebody has published it.
    pub fn difference(&self, other: &Self) -> Option<UsualDifference> {
        let (a, b) = (self.name.as_str(), other.name.as_str());
        let is_pair = |(p, q, _): &&(&str, &str, UsualDifference)| (a == *p && b == *q) || (a == *q && b == *p);
        let ellipsoid = || (a != b && (a == ELLIPSOIDAL || b == ELLIPSOIDAL)).then_some(OF_ELLIPSOID);
        DIFFERENCES.iter().find(is_pair).map(|(.., found)| *found).or_else(ellipsoid)
    }
}

impl std::fmt::Display for HeightSystem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)
    }
}

/// The finding that two inputs are in different height systems. Each is given by its name and its system.
pub fn mixed_heights(
    (first, a): (&dyn std::fmt::Display, &HeightSystem),
    (second, b): (&dyn std::fmt::Display, &HeightSystem),
) -> Finding {
    let usual = a.difference(b).map_or_else(
        || "nothing is known here about the usual difference".to_owned(),
        |UsualDifference { text, source }| format!("{text} ({source})"),
    );
    let message =
        format!("the heights of {first} are in {a} and those of {second} in {b}; they are used as they are: {usual}");
    Finding::general(FindingKind::MixedHeights, message)
}

fn row_of(code: u32) -> Option<(&'static Known, ElevationUnit)> {
    SYSTEMS.iter().find_map(|row| row.codes.iter().find(|(own, _)| *own == code).map(|(_, unit)| (row, *unit)))
}

/// The unit of a vertical system; `None` if the code is not known here.
pub fn vertical_unit(code: u32) -> Option<ElevationUnit> {
    row_of(code).map(|(_, unit)| unit)
}

impl Crs {
    /// The system of heights that the vertical part of a compound system names, or the ellipsoid for a geographic system of
    /// three dimensions. `None` if it says nothing about heights.
    pub fn height_system(&self) -> Option<HeightSystem> {
        let root = self.root()?;
        let Some(vertical) = root.vertical() else {
            let horizontal = root.horizontal();
            let axes = horizontal.nodes().filter(|node| node.keyword == "AXIS").count();
            let is_up = horizontal.is_geographic() && axes == 3;
            return is_up.then(HeightSystem::ellipsoidal);
        };
        let code = vertical.authority().filter(|(authority, _)| authority.eq_ignore_ascii_case("EPSG"));
        let of_code = code.and_then(|(_, code)| HeightSystem::of_code(code));
        of_code.or_else(|| vertical.name().map(HeightSystem::named))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(crs: &Crs) -> Option<String> {
        crs.height_system().map(|system| system.name)
    }

    #[test]
    fn systems_are_found_by_code_and_by_name() {
        for (code, expected) in
            [("EPSG:2229+6360", "NAVD88"), ("EPSG:25832+7837", "DHHN2016"), ("EPSG:2193+7839", "NZVD2016")]
        {
            assert_eq!(Crs::from_name(code).as_ref().and_then(name).as_deref(), Some(expected), "{code}");
        }
        for (code, expected) in [(5972, "NN2000"), (7406, "NGVD29"), (8700, "NAVD88"), (7423, "EVRF2007")] {
            assert_eq!(name(&Crs::from_epsg(code)).as_deref(), Some(expected), "{code}");
        }
        for (text, expected) in [
            ("NAVD_1988_Foot_US", "NAVD88"),
            ("JGD2011 (vertical) height", "JGD2011"),
            ("AHD (Tasmania) height", "AHD (Tasmania)"),
            ("Australian Height Datum", "AHD"),
            ("Ellipsoid (Meters)", ELLIPSOIDAL),
            ("N2000 height", "N2000"),
            ("NN2000 height", "NN2000"),
            ("Our own datum", "Our own datum"),
        ] {
            assert_eq!(HeightSystem::named(text).name, expected);
        }
        for none in [Crs::from_epsg(6677), Crs::wgs84(), Crs::from_wkt("nonsense")] {
            assert_eq!(name(&none), None, "{none:?}");
        }
    }

    #[test]
    fn each_code_and_each_name_stands_once() {
        let mut codes: Vec<u32> = SYSTEMS.iter().flat_map(|row| row.codes).map(|(code, _)| *code).collect();
        let mut names: Vec<&str> = SYSTEMS.iter().flat_map(|row| row.names).copied().collect();
        let counts = (codes.len(), names.len());
        codes.sort_unstable();
        codes.dedup();
        names.sort_unstable();
        names.dedup();
        assert_eq!((codes.len(), names.len()), counts);
        for row in SYSTEMS {
            assert!(row.names.iter().all(|name| HeightSystem::named(name).name == row.name), "{}", row.name);
        }
        let is_known = |name: &str| SYSTEMS.iter().any(|row| row.name == name);
        assert!(DIFFERENCES.iter().all(|(a, b, _)| is_known(a) && is_known(b)));
    }

    #[test]
    fn differences_do_not_depend_on_the_order() {
        let [old, new] = ["JGD2011", "JGD2024"].map(HeightSystem::named);
        assert_eq!(old.difference(&new), new.difference(&old));
        assert!(old.difference(&new).is_some_and(|found| found.text.contains("-0.67")));
        assert_eq!(old.difference(&old), None);
        assert_eq!(old.difference(&HeightSystem::ellipsoidal()), Some(OF_ELLIPSOID));
        assert_eq!(old.difference(&HeightSystem::named("NAVD88")), None);
    }
}
