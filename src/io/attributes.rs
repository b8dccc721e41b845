//! Known attribute names: those that hold elevations, the unit that they name, and those that may mark depression
//! contours.

/// Attribute names that hold elevations in metres, in lower case and without a unit. English names come first, then
/// those of mapping agencies in other languages.
const NAMES: &[&str] = &[
    "elev",
    "elevation",
    "elevatio",
    "elev_value",
    "elevvalue",
    "contourelevation",
    "contourele",
    "contour_elev",
    "z",
    "zvalue",
    "z_value",
    "zcoord",
    "height",
    "hgt",
    "level",
    "contour",
    "contours",
    "property_value",
    "propertyvalue",
    "alti",
    "alt",
    "altitude",
    "ele",
    "hoehe",
    "höhe",
    "hohe",
    "hoehenlinie",
    "hoejde",
    "højde",
    "hoyde",
    "høyde",
    "hojd",
    "höjd",
    "hojdvarde",
    "korkeus",
    "korkeusarvo",
    "cota",
    "quota",
    "cote",
    "kote",
    "kota",
    "altitud",
    "altitudine",
    "elevacion",
    "elevación",
    "elevacao",
    "elevação",
    "hoogte",
    "vyska",
    "výška",
    "wysokosc",
    "wysokość",
    "标高",
    "標高",
    "標高値",
    "等高線",
    "等高线",
    "高さ",
    "高程",
    "高度",
    "등고선",
    "등고수치",
    "высота",
];

/// Further names in native script: Slavic languages, Korean, Chinese, Japanese, Greek, Thai.
const NATIVE_NAMES: &[&str] = &[
    "отметка",
    "абс_отм",
    "висота",
    "відмітка",
    "кота",
    "등고선값",
    "높이",
    "표고",
    "고도",
    "해발고도",
    "高程值",
    "海拔",
    "海拔高度",
    "等高线高程",
    "等高線高程",
    "等高線標高",
    "υψόμετρο",
    "ความสูง",
];

/// Endings that mean metres. Names with feet are not used by themselves: the user must select such a field.
const METRE_ENDINGS: &[&str] = &["_m", "_metre", "_metres", "_meter", "_meters", "(m)", "[m]"];

/// Words in a name that mean feet. Written without a gap, they follow a known name: `elevft`.
const FEET_WORDS: &[&str] = &["feet", "foot", "usft", "ftus", "ft"];

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
    let name = name.trim().to_lowercase();
    let bare = METRE_ENDINGS.iter().find_map(|ending| name.strip_suffix(ending)).map_or(name.as_str(), str::trim_end);
    NAMES.contains(&bare) || NATIVE_NAMES.contains(&bare)
}

/// The unit that a name suggests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NamedUnit {
    Metres,
    /// Feet of either kind.
    Feet,
}

/// The unit that an attribute's name suggests, such as `elev_ft` or `ELEV_FEET`. `None` for names without a unit, and
/// for those that are about something else than elevations as far as one knows.
pub(super) fn unit_in_name(name: &str) -> Option<NamedUnit> {
    let name = name.trim().to_lowercase();
    if METRE_ENDINGS.iter().any(|ending| name.ends_with(ending)) {
        return is_elevation_name(&name).then_some(NamedUnit::Metres);
    }
    let mut words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let last = *words.last()?;
    let ending = FEET_WORDS.iter().find_map(|word| last.strip_suffix(word))?;
    words.pop();
    words.extend((!ending.is_empty()).then_some(ending));
    let is_known = |word: &&str| NAMES.contains(word);
    (words.is_empty() || words.iter().any(is_known) || NAMES.contains(&words.join("_").as_str()))
        .then_some(NamedUnit::Feet)
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
    fn names_in_native_script_are_known() {
        for name in ["등고수치", "높이", "ВЫСОТА", "Отметка", "高程", "标高", "標高", "海拔", "Υψόμετρο"]
        {
            assert!(is_elevation_name(name), "{name}");
        }
    }

    #[test]
    fn kinds_of_lines_may_mark_depressions() {
        assert!(may_mark("Type") && !may_mark("elev"));
    }
}
