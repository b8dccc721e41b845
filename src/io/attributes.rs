//! Known attribute names: those that hold elevations, and those that may mark depression contours.

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

/// Endings that mean metres. Names in feet are not recognised: the user must select such a field explicitly.
const METRE_ENDINGS: &[&str] = &["_m", "_metre", "_metres", "_meter", "_meters", "(m)", "[m]"];

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
    NAMES.contains(&bare)
}

/// Whether an attribute of this name may mark depressions.
pub(super) fn may_mark(name: &str) -> bool {
    let name = name.trim().to_lowercase();
    FLAGS.contains(&name.as_str()) || KINDS.contains(&name.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_of_lines_may_mark_depressions() {
        assert!(may_mark("Type") && !may_mark("elev"));
    }
}
