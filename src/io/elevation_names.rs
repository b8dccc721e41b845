//! The names of attributes that hold elevations or depths, in lower case and without a unit, each with where it is found.
//!
//! A new name goes into [`ELEVATIONS`] if it can mean nothing but the height of the ground. If another such attribute
//! contradicts it, the choice is an error. A name that may also be a kind or a number of something goes into [`OPEN`]: it
//! is used where neither a name of the first list nor z gives elevations.

/// A name, and where it is found.
type Named = (&'static str, &'static str);

/// Names that hold elevations.
pub(super) const ELEVATIONS: &[Named] = &[
    // English and what programs write.
    ("elev", "GDAL (gdal_contour -a elev), QGIS"),
    ("elevation", "LINZ Topo50, USGS, NRCan CanVec, states of Australia"),
    ("elevatio", "shapefiles cut to eight letters"),
    ("elevations", "programs for surveying"),
    ("elev_value", "programs for surveying"),
    ("elevvalue", "programs for surveying"),
    ("elv", "maps of counties and towns, survey programs"),
    ("contourelevation", "USGS Elev_Contour (US Topo)"),
    ("contourele", "the same in a shapefile"),
    ("contourel", "the same cut to nine letters"),
    ("contour_el", "maps of counties and towns"),
    ("contour_elev", "maps of counties and towns"),
    ("z", "any"),
    ("zvalue", "programs for surveying"),
    ("z_value", "programs for surveying"),
    ("zcoord", "programs for surveying"),
    ("height", "NGI South Africa, ArcGIS"),
    ("hgt", "MGCP and other military maps"),
    ("level", "ArcGIS, SAGA"),
    ("contour", "ArcGIS (Contour tool)"),
    ("contours", "maps of counties and towns"),
    ("property_value", "Ordnance Survey OpenData"),
    ("propertyvalue", "Ordnance Survey Terrain 5 and 50"),
    ("prop_value", "Ordnance Survey Terrain 50 in a shapefile"),
    ("alti", "GSI Fundamental Geospatial Data"),
    ("alt", "IGN Argentina, programs for GPS"),
    ("altitude", "IGN France BD TOPO, Victoria, Quebec"),
    ("ele", "OpenStreetMap, GPX"),
    // Germanic languages.
    ("hoehe", "ATKIS and the Basis-DLM, swisstopo"),
    ("höhe", "German"),
    ("hohe", "German without umlauts"),
    ("hoehenlinie", "German"),
    ("hoehenwert", "German"),
    ("hoejde", "Danish"),
    ("højde", "Danish"),
    ("hoyde", "Kartverket N50 in a shapefile"),
    ("høyde", "Kartverket N50, N1000"),
    ("hojd", "Swedish"),
    ("höjd", "Swedish"),
    ("hojdvarde", "Lantmäteriet"),
    ("höjdvärde", "Lantmäteriet"),
    ("hoogte", "Dutch"),
    ("haed", "Icelandic (IS 50V)"),
    ("hæð", "Icelandic"),
    // Finland and the Baltic states.
    ("korkeus", "Finnish"),
    (KORKEUSARVO, "Maanmittauslaitos, topographic database as GML: millimetres"),
    ("korarv", "Maanmittauslaitos, topographic database as shapefiles: metres"),
    ("korgus", "Maa-amet ETAK, Estonia"),
    ("kõrgus", "Estonian"),
    ("augstums", "Latvian"),
    ("aukstis", "Lithuanian"),
    ("aukštis", "Lithuanian"),
    // Romance languages.
    ("cota", "IGN Spain, DGT Portugal, IBGE Brazil"),
    ("quota", "regional maps of Italy"),
    ("quote", "regional maps of Italy"),
    ("cv_liv_q", "geotopographic databases of the regions of Italy"),
    ("cote", "French, Romanian"),
    ("altitud", "IGN Peru and others"),
    ("altitudine", "Italian, Romanian"),
    ("altimetria", "Portuguese"),
    ("elevacion", "INEGI Mexico, IGM Chile"),
    ("elevación", "Spanish"),
    ("elevacao", "Portuguese"),
    ("elevação", "Portuguese"),
    // Slavic languages, Hungarian, Greek.
    ("kote", "Danish; Slovenian and Croatian maps"),
    ("kota", "Slovak, Croatian, Serbian maps"),
    ("kót", "Hungarian"),
    ("vyska", "ČÚZK ZABAGED, Slovakia"),
    ("výška", "Czech, Slovak"),
    ("wysokosc", "GUGiK BDOT10k"),
    ("wysokość", "Polish"),
    ("visina", "Slovenian, Croatian, Serbian"),
    ("magassag", "Hungarian"),
    ("magasság", "Hungarian"),
    ("высота", "Russian"),
    ("отметка", "Russian"),
    ("абс_отм", "Russian"),
    ("кота", "Bulgarian, Macedonian, Serbian"),
    ("висота", "Ukrainian"),
    ("відмітка", "Ukrainian"),
    ("υψομετρο", "Greek"),
    ("υψόμετρο", "Greek"),
    // Turkey, Indonesia, Malaysia, Vietnam.
    ("kot", "Turkish"),
    ("yukseklik", "Turkish"),
    ("yükseklik", "Turkish"),
    ("valknt", "BIG, topographic maps of Indonesia (KONTUR)"),
    ("elevas", "BIG, spot heights"),
    ("elevasi", "Indonesian"),
    ("tinggi", "Indonesian, Malay"),
    ("ketinggian", "Indonesian, Malay"),
    ("docao", "Vietnamese"),
    ("độ cao", "Vietnamese"),
    // East Asia.
    ("标高", "Chinese"),
    ("標高", "Japanese, Taiwan"),
    ("標高値", "Japanese"),
    ("等高線", "Japanese"),
    ("等高线", "Chinese"),
    ("等高線標高", "Japanese"),
    ("高さ", "Japanese"),
    ("高程", "Chinese"),
    ("高程值", "Chinese"),
    ("高度", "Chinese"),
    ("등고선", "Korean"),
    ("등고수치", "NGII Korea, contours (N3L_F0010000)"),
    ("수치", "NGII Korea, spot heights (N3P_F0020000)"),
    ("표고", "Korean"),
    ("고도", "Korean"),
    ("높이", "Korean"),
    ("등고선값", "Korean"),
    ("해발고도", "Korean"),
    ("海拔", "Chinese"),
    ("海拔高度", "Chinese"),
    ("等高线高程", "Chinese"),
    ("等高線高程", "Taiwan"),
    ("ความสูง", "Thai"),
];

/// Names that hold elevations, and in other files kinds or numbers.
pub(super) const OPEN: &[Named] = &[
    ("nivel", "Spanish, Portuguese: level"),
    ("nível", "Portuguese: level"),
    ("niveau", "French, German: level"),
    ("curva", "Spanish, Portuguese: contour"),
    ("curva_nive", "the same in a shapefile"),
    ("curvanivel", "Spanish: contour"),
    ("curvas", "Spanish, Portuguese: contours"),
    ("courbe", "French: contour"),
    ("kontur", "Indonesian: contour"),
    ("altura", "Spanish, Portuguese: height, also that of buildings"),
    ("hauteur", "French: height, also that of buildings"),
    ("altezza", "Italian: height, also that of buildings"),
    ("cont", "NGII Korea, contours: 등고수치"),
    ("zv2", "VMap: highest z value"),
    ("zvh", "MGCP: highest z value"),
    ("isohypse", "French, German: contour"),
    ("izohips", "Turkish: contour"),
    ("szint", "Hungarian: level"),
    ("objectval", "swisstopo"),
    ("cntvalue", "New Mexico Bureau of Geology"),
];

/// Names that hold depths: lower ground has the larger number.
pub(super) const DEPTHS: &[Named] = &[
    ("depth", "English"),
    ("depths", "English"),
    ("depthvalue", "English"),
    ("depth_value", "English"),
    ("contour_depth", "lakes of the Minnesota DNR and others"),
    ("bathymetry", "English"),
    ("bathy", "English"),
    ("sounding", "English"),
    ("soundings", "English"),
    ("valdco", "IHO S-57, depth contours (DEPCNT)"),
    ("valsou", "IHO S-57, soundings"),
    ("valueofdepthcontour", "IHO S-101"),
    ("tiefe", "German"),
    ("profondeur", "French"),
    ("profundidad", "Spanish"),
    ("profundida", "the same in a shapefile"),
    ("profundidade", "Portuguese"),
    ("profondita", "Italian"),
    ("profondità", "Italian"),
    ("dybde", "Danish, Norwegian (Kartverket)"),
    ("djup", "Swedish"),
    ("dypi", "Icelandic"),
    ("syvyys", "Finnish"),
    (SYVYYSARVO, "Maanmittauslaitos, topographic database as GML: millimetres"),
    ("diepte", "Dutch"),
    ("glebokosc", "Polish"),
    ("głębokość", "Polish"),
    ("hloubka", "Czech"),
    ("dubina", "Croatian, Serbian"),
    ("derinlik", "Turkish"),
    ("kedalaman", "Indonesian, Malay"),
    ("глубина", "Russian"),
    ("水深", "Japanese, Chinese"),
    ("水深値", "Japanese"),
    ("等深線", "Japanese"),
    ("等深线", "Chinese"),
    ("深度", "Japanese, Chinese"),
    ("수심", "Korean"),
];

const KORKEUSARVO: &str = "korkeusarvo";
const SYVYYSARVO: &str = "syvyysarvo";

/// Names whose source writes whole millimetres, each with the greatest number of metres that its ground can have. Larger
/// numbers are therefore millimetres. Other programs turn them into metres and keep the name.
pub(super) const MILLIMETRES: &[(&str, f64)] = &[(KORKEUSARVO, 1500.0), (SYVYYSARVO, 500.0)];

/// Words in the names of two fields that give an area the levels below and above it: QGIS writes `ELEV_MIN` and `ELEV_MAX`,
/// ArcGIS `ContourMin` and `ContourMax`.
pub(super) const BANDS: &[(&str, &str)] = &[
    ("min", "max"),
    ("minimum", "maximum"),
    ("lower", "upper"),
    ("low", "high"),
    ("from", "to"),
    ("von", "bis"),
    ("lo", "hi"),
];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn each_name_stands_once_and_has_a_source() {
        let all = || ELEVATIONS.iter().chain(OPEN).chain(DEPTHS);
        let names: BTreeSet<&str> = all().map(|(name, _)| *name).collect();
        assert_eq!(names.len(), all().count());
        assert!(all().all(|(name, source)| *name == name.to_lowercase() && !source.is_empty()));
        assert!(MILLIMETRES.iter().all(|(name, _)| names.contains(name)));
    }
}
