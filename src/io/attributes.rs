//! What the names of attributes say: whether they hold elevations or depths, in which unit, and whether they may mark
//! depression contours. The names themselves are in [`elevation_names`](super::elevation_names).

use super::elevation_names::{BANDS, DEPTHS, ELEVATIONS, MILLIMETRES, OPEN};
use super::unit_words::LengthWord;

/// Endings that mean metres. Names with feet are not used by themselves: the user must select such a field.
const METRE_ENDINGS: &[&str] = &["_m", "_metre", "_metres", "_meter", "_meters", "(m)", "[m]"];

/// Words in a name that mean feet. Written without a gap, they follow a known name: `elevft`.
const FEET_WORDS: &[&str] = &["feet", "foot", "usft", "ftus", "ft"];

/// Words for units of length in the names of attributes, in lower case and without gaps.
const UNIT_NAMES: &[&str] = &[
    "unitofmeasure",
    "uom",
    "units",
    "unit",
    "unite",
    "unité",
    "einheit",
    "unidades",
    "unidad",
    "unidade",
    "unita",
    "unità",
    "enhet",
    "enhed",
    "eenheid",
    "jednotka",
    "jednostka",
    "yksikkö",
    "yksikko",
    "birim",
    "satuan",
    "単位",
    "单位",
    "단위",
];

/// Words beside them that mean elevations.
const VERTICAL: &[&str] =
    &["vert", "vertical", "v", "value", "values", "measure", "cnt", "altimetric", "contourinterval"];

/// The attribute for units of the contours of the USGS. Shapefiles cut its name.
const USGS_UNITS: &str = "contourunits";

/// Attribute names that say whether a line is a depression contour, in lower case.
pub(super) const FLAGS: &[&str] =
    &["depression", "is_depression", "isdepression", "depress", "depressed", "isdepressed", "is_depr", "凹地"];

/// Attribute names whose text gives the kind of line, in lower case.
pub(super) const KINDS: &[&str] = &[
    "type",
    "kind",
    "class",
    "category",
    "contourtype",
    "contour_type",
    "contour_ty",
    "conttype",
    "linetype",
    "line_type",
    "featuretype",
    "feature_type",
    "ftype",
    "subtype",
    "description",
    "descriptio",
    "desc",
    "index",
    "種別",
    "種類",
    "線種",
    "区分",
    "分類",
];

/// Whether an attribute of this name is used as the elevation if the user names none.
pub(super) fn is_elevation_name(name: &str) -> bool {
    is_in(ELEVATIONS, name)
}

/// Whether an attribute of this name is used as the elevation if the user names none and nothing else gives elevations.
pub(super) fn is_open_name(name: &str) -> bool {
    is_in(OPEN, name)
}

/// Whether an attribute of this name holds depths, of any unit.
pub(super) fn is_depth_name(name: &str) -> bool {
    // A bare unit is no name of depths.
    is_in(DEPTHS, name) || (unit_of(DEPTHS, name).is_some() && unit_of(ELEVATIONS, name).is_none())
}

fn is_in(list: &[(&str, &str)], name: &str) -> bool {
    let name = name.trim().to_lowercase();
    let bare = METRE_ENDINGS.iter().find_map(|ending| name.strip_suffix(ending)).map_or(name.as_str(), str::trim_end);
    list.iter().any(|(known, _)| *known == bare)
}

/// The smaller unit that the name of an attribute with elevations or depths ends with, such as `height_cm`.
pub(super) fn small_unit_in_name(name: &str) -> Option<LengthWord> {
    let name = name.trim().to_lowercase();
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let (last, others) = words.split_last()?;
    let unit = match *last {
        "mm" => LengthWord::Millimetre,
        "cm" => LengthWord::Centimetre,
        "dm" => LengthWord::Decimetre,
        _ => return None,
    };
    let is_known = |word: &&str| [ELEVATIONS, DEPTHS].into_iter().flatten().any(|(known, _)| known == word);
    others.iter().any(is_known).then_some(unit)
}

/// For the name of an attribute in whole millimetres: the greatest number that can be metres.
pub(super) fn most_metres(name: &str) -> Option<f64> {
    let name = name.trim().to_lowercase();
    MILLIMETRES.iter().find(|(known, _)| *known == name).map(|(_, most)| *most)
}

/// The unit that a name suggests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NamedUnit {
    Metres,
    /// Feet of either kind.
    Feet,
}

/// The unit that an attribute's name suggests, such as `elev_ft` or `depth_ft`. `None` for names without a unit, and for
/// those that are about something else than elevations or depths as far as one knows.
pub(super) fn unit_in_name(name: &str) -> Option<NamedUnit> {
    [ELEVATIONS, DEPTHS].into_iter().find_map(|list| unit_of(list, name))
}

fn unit_of(list: &[(&str, &str)], name: &str) -> Option<NamedUnit> {
    let name = name.trim().to_lowercase();
    if METRE_ENDINGS.iter().any(|ending| name.ends_with(ending)) {
        return is_in(list, &name).then_some(NamedUnit::Metres);
    }
    let mut words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let last = *words.last()?;
    let ending = FEET_WORDS.iter().find_map(|word| last.strip_suffix(word))?;
    words.pop();
    words.extend((!ending.is_empty()).then_some(ending));
    let is_known = |word: &str| list.iter().any(|(known, _)| *known == word);
    (words.is_empty() || words.iter().any(|word| is_known(word)) || is_known(&words.join("_")))
        .then_some(NamedUnit::Feet)
}

/// What the name of an attribute says that gives the unit of elevations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum UnitColumn {
    /// The unit of all lengths of the feature: `units`, `uom`.
    General,
    /// The unit of elevations: `contourunits`, `elev_unit`.
    OfElevations,
    /// The unit of the attribute with the elevations: `propertyValue_uom` beside `propertyValue`.
    Own,
}

/// What the name of an attribute says about the unit of elevations in the attribute `source`; `None` if it is about
/// something else.
pub(super) fn unit_column(name: &str, source: &str) -> Option<UnitColumn> {
    let flat = |name: &str| name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect::<String>();
    let (name, source) = (flat(name), flat(source));
    if USGS_UNITS.starts_with(&name) && name.len() > USGS_UNITS.len() - 4 {
        return Some(UnitColumn::OfElevations);
    }
    let rests = UNIT_NAMES.iter().flat_map(|word| [name.strip_suffix(word), name.strip_prefix(word)]).flatten();
    let about = |rest: &str| match rest {
        "" => Some(UnitColumn::General),
        rest if rest == source => Some(UnitColumn::Own),
        rest if VERTICAL.contains(&rest) => Some(UnitColumn::OfElevations),
        rest => [ELEVATIONS, OPEN, DEPTHS]
            .into_iter()
            .flatten()
            .any(|(known, _)| flat(known) == rest)
            .then_some(UnitColumn::OfElevations),
    };
    rests.filter_map(about).max()
}

/// Whether an attribute has the codes of the USGS for units.
pub(super) fn has_usgs_codes(name: &str) -> bool {
    let name = name.trim().to_lowercase().replace('_', "");
    USGS_UNITS.starts_with(&name) && name.len() > USGS_UNITS.len() - 4
}

/// Whether an attribute of this name may give the unit of some elevations.
pub(super) fn may_give_unit(name: &str) -> bool {
    unit_column(name, "").is_some() || UNIT_NAMES.iter().any(|word| name.to_lowercase().ends_with(word))
}

/// The field with the upper level of an area, for the name of that with its lower level; in lower case.
pub(super) fn upper_of(lower: &str) -> impl Iterator<Item = String> {
    let lower = lower.trim().to_lowercase();
    BANDS.iter().flat_map(move |(low, high)| {
        let ends = lower.strip_suffix(low).map(|rest| format!("{rest}{high}"));
        let starts = lower.strip_prefix(low).map(|rest| format!("{high}{rest}"));
        [ends, starts].into_iter().flatten().collect::<Vec<String>>()
    })
}

/// Whether an attribute of this name may mark depressions.
pub(super) fn may_mark(name: &str) -> bool {
    let name = name.trim().to_lowercase();
    FLAGS.contains(&name.as_str()) || KINDS.contains(&name.as_str())
}

/// Whether an attribute of this name tells the kind of a break line.
pub(super) fn is_kind_name(name: &str) -> bool {
    name.trim().eq_ignore_ascii_case("kind")
}

/// Whether an attribute of this name holds the standard error of a spot height.
pub(super) fn is_sigma_name(name: &str) -> bool {
    name.trim().eq_ignore_ascii_case("sigma")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_feet_from_metres() {
        for name in [
            "elev_ft",
            "ELEV_FEET",
            "height_ft",
            "contour_ft",
            "Elevation (ft)",
            "elev [feet]",
            "elevft",
            "ELEVFEET",
            "ContourFt",
            "elev_us_ft",
            "elev_ftUS",
            "contour_elev_ft",
            "feet",
            "FT",
            "Hoehe_ft",
            "max_elev_ft",
        ] {
            assert_eq!(unit_in_name(name), Some(NamedUnit::Feet), "{name}");
            assert!(!is_elevation_name(name), "{name}");
        }
        for name in ["elev_m", "Height (m)", "ELEVATION_METERS"] {
            assert_eq!(unit_in_name(name), Some(NamedUnit::Metres), "{name}");
        }
        for name in ["elev", "z", "left", "shift_ft2", "length_ft", "perimeter_m", "draft", "aircraft", "", "width(ft)"]
        {
            assert_eq!(unit_in_name(name), None, "{name}");
        }
    }

    #[test]
    fn names_tell_depths_from_elevations() {
        for name in ["depth", "DEPTH_M", "depth_ft", "Depth (m)", "VALDCO", "水深", "tiefe"] {
            assert!(is_depth_name(name) && !is_elevation_name(name), "{name}");
        }
        assert_eq!(unit_in_name("depth_ft"), Some(NamedUnit::Feet));
        assert_eq!(unit_in_name("depth_m"), Some(NamedUnit::Metres));
        for name in ["elev", "elev_ft", "feet", "depth_class", "deep"] {
            assert!(!is_depth_name(name), "{name}");
        }
    }

    #[test]
    fn names_in_native_script_are_known() {
        for name in ["등고수치", "높이", "ВЫСОТА", "Отметка", "高程", "标高", "標高", "海拔", "Υψόμετρο"]
        {
            assert!(is_elevation_name(name), "{name}");
        }
    }

    #[test]
    fn names_tell_smaller_units() {
        assert_eq!(small_unit_in_name("elev_cm"), Some(LengthWord::Centimetre));
        assert_eq!(small_unit_in_name("Height (mm)"), Some(LengthWord::Millimetre));
        assert_eq!(small_unit_in_name("depth dm"), Some(LengthWord::Decimetre));
        assert!(["elev_m", "width_mm", "cm", "elev"].iter().all(|name| small_unit_in_name(name).is_none()));
    }

    #[test]
    fn names_of_units_and_what_they_are_about() {
        use UnitColumn::{General, OfElevations, Own};
        for (name, source, about) in [
            ("contourunits", "contourelevation", Some(OfElevations)),
            ("ContourUnits", "ContourElevation", Some(OfElevations)),
            ("CONTOURUNI", "CONTOURELE", Some(OfElevations)),
            ("UNITS", "ELEV", Some(General)),
            ("uom", "z", Some(General)),
            ("propertyValue_uom", "propertyValue", Some(Own)),
            ("ELEV_UNIT", "ELEV", Some(Own)),
            ("height_units", "elev", Some(OfElevations)),
            ("unit_elev", "elev", Some(Own)),
            ("vertical_units", "elev", Some(OfElevations)),
            ("Einheit", "Hoehe", Some(General)),
            ("area_units", "elev", None),
            ("community", "elev", None),
            ("unitary", "elev", None),
            ("contour", "elev", None),
            ("elev", "elev", None),
        ] {
            assert_eq!(unit_column(name, source), about, "{name}");
        }
        assert!(has_usgs_codes("contourunits") && has_usgs_codes("CONTOURUNI") && !has_usgs_codes("units"));
        assert!(may_give_unit("kind_uom") && !may_give_unit("elev"));
    }

    #[test]
    fn names_of_bands_belong_together() {
        for (lower, upper) in [
            ("ELEV_MIN", "elev_max"),
            ("ContourMin", "contourmax"),
            ("from", "to"),
            ("zmin", "zmax"),
            ("min_elev", "max_elev"),
        ] {
            assert!(upper_of(lower).any(|name| name == upper), "{lower}");
        }
        assert_eq!(upper_of("elev").count(), 0);
    }

    #[test]
    fn kinds_of_lines_may_mark_depressions() {
        assert!(may_mark("Type") && !may_mark("elev"));
    }
}
