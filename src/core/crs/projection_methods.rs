//! Methods of projection by their names in WKT 1, with the names and codes of EPSG for them and for their parameters.

/// A method of projection: its names in WKT 1 in plain form, its name and code at EPSG, and its parameters.
pub(super) type Method = (&'static [&'static str], &'static str, u32, &'static [Parameter]);
/// A parameter: its names in WKT 1 in plain form, its name and code at EPSG.
pub(super) type Parameter = (&'static [&'static str], &'static str, u32);

const LATITUDE: Parameter =
    (&["latitudeoforigin", "latitudeofcenter", "latitudeoforigincenter"], "Latitude of natural origin", 8801);
const LONGITUDE: Parameter =
    (&["centralmeridian", "longitudeofcenter", "longitudeoforigin"], "Longitude of natural origin", 8802);
const SCALE: Parameter = (&["scalefactor"], "Scale factor at natural origin", 8805);
const EAST: Parameter = (&["falseeasting"], "False easting", 8806);
const NORTH: Parameter = (&["falsenorthing"], "False northing", 8807);
const FALSE_LATITUDE: Parameter = (LATITUDE.0, "Latitude of false origin", 8821);
const FALSE_LONGITUDE: Parameter = (LONGITUDE.0, "Longitude of false origin", 8822);
const FIRST: Parameter = (&["standardparallel1"], "Latitude of 1st standard parallel", 8823);
const SECOND: Parameter = (&["standardparallel2"], "Latitude of 2nd standard parallel", 8824);
const FALSE_EAST: Parameter = (EAST.0, "Easting at false origin", 8826);
const FALSE_NORTH: Parameter = (NORTH.0, "Northing at false origin", 8827);
const CENTRE_LATITUDE: Parameter = (LATITUDE.0, "Latitude of projection centre", 8811);
const CENTRE_LONGITUDE: Parameter = (LONGITUDE.0, "Longitude of projection centre", 8812);
const AZIMUTH: Parameter = (&["azimuth"], "Azimuth at projection centre", 8813);
const GRID_ANGLE: Parameter = (&["rectifiedgridangle"], "Angle from Rectified to Skew Grid", 8814);
const CENTRE_SCALE: Parameter = (SCALE.0, "Scale factor at projection centre", 8815);
const CENTRE_EAST: Parameter = (EAST.0, "Easting at projection centre", 8816);
const CENTRE_NORTH: Parameter = (NORTH.0, "Northing at projection centre", 8817);

const NATURAL: &[Parameter] = &[LATITUDE, LONGITUDE, SCALE, EAST, NORTH];
const TWO_PARALLELS: &[Parameter] = &[FALSE_LATITUDE, FALSE_LONGITUDE, FIRST, SECOND, FALSE_EAST, FALSE_NORTH];

pub(super) const METHODS: &[Method] = &[
    (&["transversemercator", "gausskruger"], "Transverse Mercator", 9807, NATURAL),
    (&["transversemercatorsouthorientated"], "Transverse Mercator (South Orientated)", 9808, NATURAL),
    (&["mercator1sp"], "Mercator (variant A)", 9804, NATURAL),
    (&["mercator2sp"], "Mercator (variant B)", 9805, &[FIRST, LONGITUDE, EAST, NORTH]),
    (&["lambertconformalconic1sp"], "Lambert Conic Conformal (1SP)", 9801, NATURAL),
    (&["lambertconformalconic2sp"], "Lambert Conic Conformal (2SP)", 9802, TWO_PARALLELS),
    (&["lambertconformalconic2spbelgium"], "Lambert Conic Conformal (2SP Belgium)", 9803, TWO_PARALLELS),
    (&["albersconicequalarea", "albers"], "Albers Equal Area", 9822, TWO_PARALLELS),
    (&["lambertazimuthalequalarea"], "Lambert Azimuthal Equal Area", 9820, &[LATITUDE, LONGITUDE, EAST, NORTH]),
    (&["obliquestereographic", "doublestereographic"], "Oblique Stereographic", 9809, NATURAL),
    (&["cassinisoldner", "cassini"], "Cassini-Soldner", 9806, &[LATITUDE, LONGITUDE, EAST, NORTH]),
    (&["polyconic"], "American Polyconic", 9818, &[LATITUDE, LONGITUDE, EAST, NORTH]),
    (
        &["hotineobliquemercator"],
        "Hotine Oblique Mercator (variant A)",
        9812,
        &[CENTRE_LATITUDE, CENTRE_LONGITUDE, AZIMUTH, GRID_ANGLE, CENTRE_SCALE, EAST, NORTH],
    ),
    (
        &["hotineobliquemercatorazimuthcenter"],
        "Hotine Oblique Mercator (variant B)",
        9815,
        &[CENTRE_LATITUDE, CENTRE_LONGITUDE, AZIMUTH, GRID_ANGLE, CENTRE_SCALE, CENTRE_EAST, CENTRE_NORTH],
    ),
];

/// Web Mercator is written in WKT 1 as a Mercator of an ellipsoid, with an extension.
pub(super) const WEB_MERCATOR: Method =
    (&[], "Popular Visualisation Pseudo Mercator", 1024, &[LATITUDE, LONGITUDE, EAST, NORTH]);
