//! Systems that a GeoTIFF describes by keys: a projection with its parameters, and a geographic system by its datum or its
//! ellipsoid. They become well-known text.
//!
//! Keys of the GeoTIFF standard (OGC 19-008r4, annex B and C). Programs use the keys for the natural origin, the false origin
//! and the centre in each other's place; GDAL accepts all of them, and so does this reader. An origin that is missing is 0
//! and a scale that is missing is 1. A parallel that is missing, or a unit, a datum or a projection that is not known, is
//! an error: a guess would move the map.

use super::{
    CITATION, GEOGRAPHIC_CITATION, GEOGRAPHIC_TYPE, GeoKeys, MODEL_GEOGRAPHIC, MODEL_PROJECTED, MODEL_TYPE,
    PROJECTED_CITATION, PROJECTED_TYPE, USER_DEFINED,
};
use tokosen_core::crs::{Crs, number_of_part, part_of_table};

const DATUM: u16 = 2050;
const PRIME_MERIDIAN: u16 = 2051;
const ANGULAR_UNIT: u16 = 2054;
const ANGULAR_UNIT_SIZE: u16 = 2055;
const ELLIPSOID: u16 = 2056;
const SEMI_MAJOR: u16 = 2057;
const SEMI_MINOR: u16 = 2058;
const INVERSE_FLATTENING: u16 = 2059;
const PRIME_MERIDIAN_LONGITUDE: u16 = 2061;
const SHIFT_TO_WGS_84: u16 = 2062;
const PROJECTION: u16 = 3074;
const METHOD: u16 = 3075;
const LINEAR_UNIT: u16 = 3076;
const LINEAR_UNIT_SIZE: u16 = 3077;

/// The name of a projection method in well-known text, and its parameters: name, quantity and value.
type Method = (&'static str, Vec<(&'static str, Quantity, f64)>);

/// EPSG codes of the degree, by two conventions.
const DEGREES: [u16; 2] = [9102, 9122];
/// Codes of units of angle that are one number. Others have degrees, minutes and seconds in one number.
const PLAIN_ANGLES: [u16; 5] = [9101, 9103, 9104, 9105, 9106];
const METRE: u16 = 9001;
const GREENWICH: u16 = 8901;
/// Radians per degree, and the text of the unit as the built-in table has it.
const DEGREE: f64 = std::f64::consts::PI / 180.0;
const DEGREE_TEXT: &str = "UNIT[\"degree\",0.0174532925199433,AUTHORITY[\"EPSG\",\"9122\"]]";
/// Numbers of this relative difference are one number that programs round differently.
const SAME: f64 = 1e-9;

/// What the value of a parameter is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Quantity {
    Angle,
    Length,
    Ratio,
}

/// A parameter of a projection: its name in well-known text, what it is, the keys that may hold it in the order of
/// preference, and its value if none does.
type Parameter = (&'static str, Quantity, &'static [u16], Option<f64>);

use Quantity::{Angle, Length, Ratio};

const LATITUDE: Parameter = ("latitude_of_origin", Angle, &[3081, 3085, 3089], Some(0.0));
const MERIDIAN: Parameter = ("central_meridian", Angle, &[3080, 3084, 3088], Some(0.0));
const FALSE_LATITUDE: Parameter = ("latitude_of_origin", Angle, &[3085, 3081, 3089], Some(0.0));
const FALSE_MERIDIAN: Parameter = ("central_meridian", Angle, &[3084, 3080, 3088], Some(0.0));
const POLAR_MERIDIAN: Parameter = ("central_meridian", Angle, &[3095, 3080, 3084, 3088], Some(0.0));
const CENTRE_LATITUDE: Parameter = ("latitude_of_center", Angle, &[3089, 3081, 3085], Some(0.0));
const CENTRE_LONGITUDE: Parameter = ("longitude_of_center", Angle, &[3088, 3080, 3084], Some(0.0));
const CONE_LATITUDE: Parameter = ("latitude_of_center", Angle, &[3081, 3085, 3089], Some(0.0));
const CONE_LONGITUDE: Parameter = ("longitude_of_center", Angle, &[3080, 3084, 3088], Some(0.0));
const PARALLEL_1: Parameter = ("standard_parallel_1", Angle, &[3078], None);
const PARALLEL_2: Parameter = ("standard_parallel_2", Angle, &[3079], None);
const SCALE: Parameter = ("scale_factor", Ratio, &[3092, 3093], Some(1.0));
const EASTING: Parameter = ("false_easting", Length, &[3082, 3086, 3090], Some(0.0));
const NORTHING: Parameter = ("false_northing", Length, &[3083, 3087, 3091], Some(0.0));
const FALSE_EASTING: Parameter = ("false_easting", Length, &[3086, 3082, 3090], Some(0.0));
const FALSE_NORTHING: Parameter = ("false_northing", Length, &[3087, 3083, 3091], Some(0.0));

/// The projections: code of the method, name in well-known text, parameters. Of two with one code, the first whose
/// parameters are all there is taken.
const METHODS: &[(u16, &str, &[Parameter])] = &[
    (1, "Transverse_Mercator", &[LATITUDE, MERIDIAN, SCALE, EASTING, NORTHING]),
    (7, "Mercator_2SP", &[PARALLEL_1, MERIDIAN, EASTING, NORTHING]),
    (7, "Mercator_1SP", &[LATITUDE, MERIDIAN, SCALE, EASTING, NORTHING]),
    (
        8,
        "Lambert_Conformal_Conic_2SP",
        &[PARALLEL_1, PARALLEL_2, FALSE_LATITUDE, FALSE_MERIDIAN, FALSE_EASTING, FALSE_NORTHING],
    ),
    (9, "Lambert_Conformal_Conic_1SP", &[LATITUDE, MERIDIAN, SCALE, EASTING, NORTHING]),
    (10, "Lambert_Azimuthal_Equal_Area", &[CENTRE_LATITUDE, CENTRE_LONGITUDE, EASTING, NORTHING]),
    (11, "Albers_Conic_Equal_Area", &[PARALLEL_1, PARALLEL_2, CONE_LATITUDE, CONE_LONGITUDE, EASTING, NORTHING]),
    (12, "Azimuthal_Equidistant", &[CENTRE_LATITUDE, CENTRE_LONGITUDE, EASTING, NORTHING]),
    (13, "Equidistant_Conic", &[PARALLEL_1, PARALLEL_2, CONE_LATITUDE, CONE_LONGITUDE, EASTING, NORTHING]),
    (14, "Stereographic", &[LATITUDE, MERIDIAN, SCALE, EASTING, NORTHING]),
    (15, "Polar_Stereographic", &[LATITUDE, POLAR_MERIDIAN, SCALE, EASTING, NORTHING]),
    (16, "Oblique_Stereographic", &[LATITUDE, MERIDIAN, SCALE, EASTING, NORTHING]),
    (18, "Cassini_Soldner", &[LATITUDE, MERIDIAN, EASTING, NORTHING]),
    (22, "Polyconic", &[LATITUDE, MERIDIAN, EASTING, NORTHING]),
    (24, "Sinusoidal", &[CENTRE_LONGITUDE, EASTING, NORTHING]),
    (27, "Transverse_Mercator_South_Orientated", &[LATITUDE, MERIDIAN, SCALE, EASTING, NORTHING]),
];

/// A part of a system: its text and the size of its unit, radians or metres.
struct Unit {
    text: String,
    size: f64,
}

impl GeoKeys {
    /// The system that the keys describe by its parameters. `None` if they describe none.
    ///
    /// # Errors
    /// The reason why the description does not give a system: the rest of a sentence that begins with "the GeoTIFF keys".
    pub fn described(&self) -> Option<Result<Crs, String>> {
        let is_own = |key: u16| self.number(key) == Some(USER_DEFINED);
        let (plane, degrees) = (is_own(PROJECTED_TYPE), is_own(GEOGRAPHIC_TYPE));
        let described = match self.number(MODEL_TYPE) {
            Some(MODEL_PROJECTED) if plane => self.projected(),
            Some(MODEL_GEOGRAPHIC) if degrees => self.geographic().map(|(text, _)| text),
            _ => return None,
        };
        Some(described.map(|text| Crs::from_wkt(&text)))
    }

    /// The first number of a key.
    fn double(&self, key: u16) -> Option<f64> {
        self.doubles(key).and_then(|numbers| numbers.first()).copied().filter(|number| number.is_finite())
    }

    /// The code of a key, unless it is unset or user-defined.
    fn code(&self, key: u16) -> Option<u16> {
        self.number(key).filter(|&code| code != 0 && code != USER_DEFINED)
    }

    /// The text of a projected system.
    fn projected(&self) -> Result<String, String> {
        let (base, base_angle) = self.geographic()?;
        let length = self.unit("length", LINEAR_UNIT, LINEAR_UNIT_SIZE, METRE)?;
        let (method, parameters) = match self.code(PROJECTION) {
            Some(code) => of_utm(code, length.size)?,
            None => self.method()?,
        };
        let own_angle = self.angle()?;
        let mut list = String::new();
        for (name, quantity, value) in parameters {
            // Angles stand in the unit of the keys; in the text, in that of the geographic system.
            let is_other = quantity == Angle && (own_angle.size / base_angle - 1.0).abs() > SAME;
            let value = if is_other { value * own_angle.size / base_angle } else { value };
            list.push_str(&format!(",PARAMETER[\"{name}\",{value}]"));
        }
        let name = [PROJECTED_CITATION, CITATION].iter().find_map(|&key| self.text(key));
        let name = name.map(|name| name.trim_start_matches("PCS Name = ")).filter(|name| !name.trim().is_empty());
        let name = quoted(name.unwrap_or("unknown"));
        Ok(format!("PROJCS[{name},{base},PROJECTION[\"{method}\"]{list},{}]", length.text))
    }

    /// The method of the projection and its parameters.
    fn method(&self) -> Result<Method, String> {
        let code = self.code(METHOD).ok_or("describe a projection without its method")?;
        let mut problem = format!("describe a projection by the method {code}, which is not known here");
        for (_, method, parameters) in METHODS.iter().filter(|(known, ..)| *known == code) {
            let value = |&(name, quantity, keys, default): &Parameter| {
                let given = keys.iter().find_map(|&key| self.double(key)).or(default);
                given.map(|value| (name, quantity, value)).ok_or(name)
            };
            match parameters.iter().map(value).collect() {
                Ok(values) => return Ok((method, values)),
                Err(name) => problem = format!("describe the projection {method} without its {name}"),
            }
        }
        Err(problem)
    }

    /// The text of a geographic system, and the radians of its unit.
    fn geographic(&self) -> Result<(String, f64), String> {
        if let Some(code) = self.code(GEOGRAPHIC_TYPE) {
            let known = part_of_table("GEOGCS", code.into());
            let text =
                known.ok_or_else(|| format!("name the geographic system EPSG:{code}, which is not known here"))?;
            let unit = Crs::from_wkt(text).angle_unit();
            return Ok((text.to_owned(), unit.unwrap_or(DEGREE)));
        }
        let angle = self.angle()?;
        let citation = self.text(GEOGRAPHIC_CITATION).unwrap_or_default();
        let cited = |key: &str| {
            citation.split('|').find_map(|part| part.trim().strip_prefix(key)).map(str::trim).filter(|t| !t.is_empty())
        };
        let name =
            cited("GCS Name = ").or((!citation.contains(['|', '=']) && !citation.is_empty()).then_some(citation));
        let datum = match self.code(DATUM).map(|code| (code, part_of_table("DATUM", code.into()))) {
            Some((_, Some(text))) => text.to_owned(),
            other => {
                let name = match other {
                    Some((code, _)) => format!("EPSG:{code}"),
                    None => cited("Datum = ").unwrap_or("unknown").to_owned(),
                };
                format!("DATUM[{},{}{}]", quoted(&name), self.ellipsoid(cited("Ellipsoid = "))?, self.shift())
            }
        };
        let name = quoted(name.unwrap_or("unknown"));
        Ok((format!("GEOGCS[{name},{datum},{},{}]", self.meridian(&angle)?, angle.text), angle.size))
    }

    /// The text of the ellipsoid. The axes of the keys count more than those of its code.
    fn ellipsoid(&self, cited: Option<&str>) -> Result<String, String> {
        let known = self.code(ELLIPSOID).and_then(|code| part_of_table("SPHEROID", code.into()));
        let flattening = match (self.double(SEMI_MAJOR), self.double(INVERSE_FLATTENING), self.double(SEMI_MINOR)) {
            (Some(a), Some(inverse), _) => Some((a, inverse)),
            (Some(a), None, Some(b)) if a > b => Some((a, a / (a - b))),
            (Some(a), None, Some(b)) if a == b => Some((a, 0.0)),
            _ => None,
        };
        match (flattening, known) {
            (Some((a, inverse)), _) if !(a > 0.0 && (inverse == 0.0 || inverse > 1.0)) => {
                Err(format!("describe an ellipsoid with the semi-major axis {a} and the inverse flattening {inverse}"))
            }
            (Some(own), Some(text)) if has_axes(text, own) => Ok(text.to_owned()),
            (Some((a, inverse)), _) => Ok(format!("SPHEROID[{},{a},{inverse}]", quoted(cited.unwrap_or("unknown")))),
            (None, Some(text)) => Ok(text.to_owned()),
            (None, None) => Err("describe a geographic system without its ellipsoid".into()),
        }
    }

    /// The shift to WGS 84, as the end of a datum's text. Empty if there is none.
    fn shift(&self) -> String {
        match self.doubles(SHIFT_TO_WGS_84) {
            Some(numbers @ ([_, _, _] | [_, _, _, _, _, _, _])) if numbers.iter().all(|n| n.is_finite()) => {
                let mut list: Vec<String> = numbers.iter().map(f64::to_string).collect();
                list.resize(7, "0".to_owned());
                format!(",TOWGS84[{}]", list.join(","))
            }
            _ => String::new(),
        }
    }

    fn meridian(&self, angle: &Unit) -> Result<String, String> {
        match (self.code(PRIME_MERIDIAN), self.double(PRIME_MERIDIAN_LONGITUDE)) {
            (None, None) | (Some(GREENWICH), _) => Ok("PRIMEM[\"Greenwich\",0]".to_owned()),
            // Well-known text has degrees here, whatever the unit of the system.
            (None, Some(longitude)) => {
                let is_degree = (angle.size / DEGREE - 1.0).abs() < SAME;
                let degrees = if is_degree { longitude } else { longitude * angle.size / DEGREE };
                Ok(format!("PRIMEM[\"{}\",{degrees}]", if degrees == 0.0 { "Greenwich" } else { "unknown" }))
            }
            (Some(code), _) => {
                let known = part_of_table("PRIMEM", code.into());
                known
                    .map(str::to_owned)
                    .ok_or_else(|| format!("name the prime meridian {code}, which is not known here"))
            }
        }
    }

    /// The unit of angles.
    fn angle(&self) -> Result<Unit, String> {
        match self.code(ANGULAR_UNIT) {
            Some(code) if DEGREES.contains(&code) => Ok(Unit { text: DEGREE_TEXT.into(), size: DEGREE }),
            None if self.number(ANGULAR_UNIT).is_none() => Ok(Unit { text: DEGREE_TEXT.into(), size: DEGREE }),
            Some(code) if !PLAIN_ANGLES.contains(&code) => {
                Err(format!("name the unit of angle {code}, which is not known here"))
            }
            _ => self.unit("angle", ANGULAR_UNIT, ANGULAR_UNIT_SIZE, 0),
        }
    }

    /// A unit, by its code or by its size. `default` is the code if the keys have neither.
    fn unit(&self, what: &str, key: u16, size: u16, default: u16) -> Result<Unit, String> {
        match (self.number(key), self.double(size)) {
            (Some(USER_DEFINED), Some(size)) if size > 0.0 => {
                Ok(Unit { text: format!("UNIT[\"unknown\",{size}]"), size })
            }
            (Some(USER_DEFINED), _) => Err(format!("describe a unit of {what} without its size")),
            (code, _) => {
                let code = code.filter(|&code| code != 0).unwrap_or(default);
                let known = part_of_table("UNIT", code.into());
                let found = known.and_then(|text| Some(Unit { text: text.to_owned(), size: number_of_part(text)? }));
                found.ok_or_else(|| format!("name the unit of {what} {code}, which is not known here"))
            }
        }
    }
}

/// Method and parameters of a zone of UTM by the EPSG code of its projection, lengths in a unit of this many metres.
fn of_utm(code: u16, metres: f64) -> Result<Method, String> {
    let (zone, northing) = match code {
        16001..=16060 => (code - 16000, 0.0),
        16101..=16160 => (code - 16100, 10_000_000.0),
        _ => return Err(format!("name the projection EPSG:{code}, which is not known here")),
    };
    let values = [0.0, f64::from(zone) * 6.0 - 183.0, 0.9996, 500_000.0 / metres, northing / metres];
    let parameters = [LATITUDE, MERIDIAN, SCALE, EASTING, NORTHING];
    let named = parameters.iter().zip(values).map(|(&(name, quantity, ..), value)| (name, quantity, value));
    Ok(("Transverse_Mercator", named.collect()))
}

/// Whether the text of an ellipsoid has these axes: semi-major axis and inverse flattening.
fn has_axes(text: &str, (a, inverse): (f64, f64)) -> bool {
    let numbers: Vec<f64> = text.split(',').skip(1).take(2).filter_map(|word| word.trim().parse().ok()).collect();
    let is_same = |x: f64, y: f64| (x - y).abs() <= SAME * x.abs().max(1.0);
    matches!(numbers[..], [x, y] if is_same(x, a) && is_same(y, inverse))
}

/// A name as well-known text has it.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.trim().replace('"', "\"\""))
}

#[cfg(test)]
mod tests;
