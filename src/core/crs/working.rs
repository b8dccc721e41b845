//! The metric system in which a map is worked on.
//!
//! Data in degrees are projected with a transverse Mercator projection whose meridian is near. In Japan that is the
//! plane rectangular zone, elsewhere the UTM zone. If the data reach too far from the zone's meridian, they get a
//! projection of their own. The datum stays that of the data, so no shift comes between them and their results. Data in
//! feet, or in another unit than metres, are treated like data in degrees, because slopes and bands need heights and
//! distances in one unit.

use glam::DVec2;

use super::definition::{Definition, Shift, label};
use super::system::{Crs, CrsKind, DEGREE};
use super::transform::Transform;
use crate::base::ElevationUnit;
use crate::base::error::{Error, Result};

/// Largest distance of data from a UTM zone's meridian, degrees of longitude: one degree beyond the border of the zone.
const UTM_REACH: f64 = 4.0;
/// The same for Japan's zones. The widest of them reach a degree and a half from their meridians.
const JAPAN_REACH: f64 = 2.0;

/// The system in which to work on data whose coordinates in `crs` are `points`.
///
/// For a projected system in metres it is that system, without a vertical part in another unit. For other systems it is:
/// - In Japan, on JGD2000, JGD2011, JGD2024 or WGS 84: the plane rectangular zone of JGD2011 (EPSG:6669 to 6687). On
///   the Tokyo datum it is that datum's zone (EPSG:30161 to 30179). The zone is that of the nearest of some
///   representative places. Near the border of two zones it may be the neighbour of the official zone. That changes
///   only the name and a ten-thousandth of scale.
/// - Elsewhere: the UTM zone of the middle of the data. It is a zone of ETRS89 (EPSG:258xx), NAD83 (269xx) or NAD27
///   (267xx) if the data are on these, otherwise of WGS 84 (EPSG:326xx, 327xx). European data on WGS 84 get the zone of
///   ETRS89. They were surveyed in ETRS89, and formats that know only WGS 84 hold it under that name. In their plane
///   system such data are then where they were.
/// - For a plane without a place on the Earth, in another unit than metres: the same plane in metres.
/// - In the remaining cases: a transverse Mercator projection about the middle of the data, on their own datum. These
///   are data that reach further than four degrees of longitude (two in Japan) from the zone's meridian, data beyond
///   the latitudes of UTM, and data on older datums without zones above.
///
/// # Errors
/// [`Error::Data`] if the system is not known well enough to transform its coordinates, or there is no point.
pub fn working_crs<I>(crs: &Crs, points: I) -> Result<Crs>
where
    I: Iterator<Item = DVec2> + Clone,
{
    let metres = crs.length_unit().map(|unit| unit.metres);
    match crs.kind() {
        Some(CrsKind::Projected) if metres.is_none_or(|m| m == 1.0) => {
            return Ok(crs.with_heights_in(ElevationUnit::Metre));
        }
        Some(_) => {}
        None => {
            if let Some(plane) = crs.local_in_metres() {
                return Ok(plane);
            }
            return Err(Error::Data(format!("{}: is not known to be projected or in degrees", label(crs))));
        }
    }
    let Some(degrees) = crs.geographic() else {
        return Err(Error::Data(format!("{}: its geographic system is not known", label(crs))));
    };
    let way = Transform::between(crs, &degrees)?;
    let (lo, hi) = extent(points.filter_map(|p| way.forward(p)));
    if !(lo.is_finite() && hi.is_finite()) {
        return Err(Error::Data(format!("none of the coordinates exists in {}", label(crs))));
    }
    let definition = Definition::of(&degrees)?;
    Ok(zone(&definition, lo, hi).unwrap_or_else(|| local(&degrees, lo.midpoint(hi))))
}

/// The corners of the box around positions in degrees. Positions on both sides of the 180th meridian are near each
/// other.
fn extent(points: impl Iterator<Item = DVec2> + Clone) -> (DVec2, DVec2) {
    let around = |points: &mut dyn Iterator<Item = DVec2>| {
        points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
    };
    let (lo, hi) = around(&mut points.clone());
    if hi.x - lo.x <= 180.0 {
        return (lo, hi);
    }
    let other = around(&mut points.map(|p| if p.x < 0.0 { DVec2::new(p.x + 360.0, p.y) } else { p }));
    if other.1.x - other.0.x < hi.x - lo.x { other } else { (lo, hi) }
}

/// The EPSG zone, if there is one for the datum and the position.
fn zone(degrees: &Definition, lo: DVec2, hi: DVec2) -> Option<Crs> {
    // Grads, and longitudes that do not count from Greenwich, have no zone here.
    if degrees.angle != Some(DEGREE) || !degrees.counts_from_greenwich() {
        return None;
    }
    let datum = degrees.datum.as_deref().unwrap_or("");
    let middle = lo.midpoint(hi);
    let middle = DVec2::new((middle.x + 180.0).rem_euclid(360.0) - 180.0, middle.y);
    let half = 0.5 * (hi.x - lo.x);
    let reaches = |meridian: f64, most: f64| {
        let off = (middle.x - meridian + 180.0).rem_euclid(360.0) - 180.0;
        off.abs() + half <= most
    };
    let null = degrees.shift() == Shift::None;
    let japan = match datum {
        "tokyo" => Some(30160),
        "jgd2000" | "jgd2011" | "wgs84" => Some(6668),
        other if other.starts_with("jgd") || other.starts_with("japanesegeodeticdatum") => Some(6668),
        _ => None,
    };
    if let (Some(first), Some(zone)) = (japan, japanese_zone(middle)) {
        let meridian = MERIDIANS[zone as usize - 1];
        return reaches(meridian, JAPAN_REACH).then(|| Crs::from_epsg(first + zone));
    }
    let zone = utm_zone(middle);
    let within = lo.y >= -80.0 && hi.y <= 84.0 && reaches(f64::from(zone) * 6.0 - 183.0, UTM_REACH);
    let north = middle.y >= 0.0;
    let code = match datum {
        "etrs89" if north && (28..=38).contains(&zone) => 25800 + zone,
        "wgs84" if in_europe(middle) => 25800 + zone,
        "northamericandatum1983" if north && (1..=23).contains(&zone) => 26900 + zone,
        "northamericandatum1927" if north && (1..=22).contains(&zone) => 26700 + zone,
        _ if null => (if north { 32600 } else { 32700 }) + zone,
        _ => return None,
    };
    within.then(|| Crs::from_epsg(code))
}

/// Whether a place lies in Europe or near it, without Africa and Iceland.
fn in_europe(place: DVec2) -> bool {
    let africa = place.y < 37.5 && (-2.0..11.7).contains(&place.x);
    (36.0..72.0).contains(&place.y) && (-11.0..32.0).contains(&place.x) && !africa
}

/// The UTM zone of a place, with the wider one on Norway's west coast.
fn utm_zone(place: DVec2) -> u32 {
    if (56.0..64.0).contains(&place.y) && (3.0..12.0).contains(&place.x) {
        return 32;
    }
    ((place.x + 180.0) / 6.0).floor().clamp(0.0, 59.0) as u32 + 1
}

/// A transverse Mercator projection in metres. Its origin is `middle`, and it is true to scale along the meridian
/// there.
fn local(degrees: &Crs, middle: DVec2) -> Crs {
    // Rounded, so that it stays the same when data are added at the edge.
    let [lon, lat] = [middle.x, middle.y].map(|angle| (angle * 10.0).round() / 10.0);
    let base = degrees.wkt1().or_else(|| degrees.wkt()).unwrap_or_default();
    let wkt = format!(
        "PROJCS[\"Local transverse Mercator at {lat}, {lon}\",{base},PROJECTION[\"Transverse_Mercator\"],\
         PARAMETER[\"latitude_of_origin\",{lat}],PARAMETER[\"central_meridian\",{lon}],PARAMETER[\"scale_factor\",1],\
         PARAMETER[\"false_easting\",0],PARAMETER[\"false_northing\",0],UNIT[\"metre\",1,AUTHORITY[\"EPSG\",\"9001\"]],\
         AXIS[\"Easting\",EAST],AXIS[\"Northing\",NORTH]]"
    );
    Crs { epsg: None, wkt: Some(wkt) }
}

/// Longitudes of the origins of Japan's plane rectangular zones (public notice 9 of 2002), degrees.
const MERIDIANS: [f64; 19] = [
    129.5,
    131.0,
    132.0 + 10.0 / 60.0,
    133.5,
    134.0 + 20.0 / 60.0,
    136.0,
    137.0 + 10.0 / 60.0,
    138.5,
    139.0 + 50.0 / 60.0,
    140.0 + 50.0 / 60.0,
    140.25,
    142.25,
    144.25,
    142.0,
    127.5,
    124.0,
    131.0,
    136.0,
    154.0,
];

/// Positions within this distance of one of the places below count as Japan, degrees of latitude.
const NEAR: f64 = 1.0;
/// Korea lies north and west of this latitude and longitude: north of the strait and west of Honshu.
const KOREA: (f64, f64) = (34.75, 130.3);

/// Places of each zone, longitude and latitude in degrees to a tenth: capitals of prefectures, and places far from
/// them.
const PLACES: [&[[f64; 2]]; 19] = [
    &[
        [129.9, 32.8],
        [129.7, 33.2],
        [128.8, 32.7],
        [129.3, 34.3],
        [129.7, 33.8],
        [129.5, 28.4],
        [129.0, 27.8],
        [129.7, 29.6],
    ],
    &[
        [130.4, 33.6],
        [130.3, 33.3],
        [130.7, 32.8],
        [131.6, 33.2],
        [131.4, 31.9],
        [130.6, 31.6],
        [130.8, 33.8],
        [130.6, 30.4],
    ],
    &[[131.0, 34.0], [131.5, 34.2], [132.5, 34.4], [133.1, 35.5], [132.1, 34.9], [133.3, 36.2], [133.4, 34.5]],
    &[[134.0, 34.3], [132.8, 33.8], [134.6, 34.1], [133.5, 33.6], [132.9, 32.9]],
    &[[133.9, 34.7], [134.2, 35.5], [135.2, 34.7], [133.4, 35.4], [134.8, 35.5]],
    &[
        [135.8, 35.0],
        [135.5, 34.7],
        [136.2, 36.1],
        [135.9, 35.0],
        [136.5, 34.7],
        [135.8, 34.7],
        [135.2, 34.2],
        [135.8, 33.6],
        [135.2, 35.5],
    ],
    &[[136.7, 36.6], [137.2, 36.7], [136.8, 35.4], [136.9, 35.2], [137.3, 36.1], [137.0, 37.4], [137.4, 34.8]],
    &[
        [139.0, 37.9],
        [138.2, 36.7],
        [138.6, 35.7],
        [138.4, 35.0],
        [138.0, 36.2],
        [138.2, 37.1],
        [137.7, 34.7],
        [138.4, 38.0],
        [137.8, 35.5],
        [138.9, 37.1],
        [139.0, 34.9],
    ],
    &[
        [139.7, 35.7],
        [140.5, 37.8],
        [139.9, 36.6],
        [140.5, 36.4],
        [139.6, 35.9],
        [140.1, 35.6],
        [139.1, 36.4],
        [139.6, 35.4],
        [139.9, 37.5],
        [140.9, 37.0],
        [139.5, 34.1],
        [139.8, 33.1],
        [140.3, 30.5],
        [139.3, 37.0],
        [140.9, 35.7],
    ],
    &[
        [140.7, 40.8],
        [140.1, 39.7],
        [140.3, 38.3],
        [141.2, 39.7],
        [140.9, 38.3],
        [141.1, 41.3],
        [141.9, 39.6],
        [139.8, 38.9],
    ],
    &[[140.7, 41.8], [141.0, 43.2], [140.1, 41.9], [140.0, 42.6], [140.8, 42.6], [139.5, 42.1]],
    &[
        [141.4, 43.1],
        [142.4, 43.8],
        [141.7, 45.4],
        [141.0, 42.4],
        [142.8, 42.2],
        [141.6, 42.6],
        [141.2, 45.2],
        [142.5, 44.4],
        [143.3, 44.3],
    ],
    &[
        [143.2, 42.9],
        [144.4, 43.0],
        [143.9, 43.8],
        [145.6, 43.3],
        [144.3, 44.0],
        [145.2, 44.1],
        [147.0, 44.6],
        [148.0, 45.2],
    ],
    &[[142.2, 27.1], [142.2, 26.6], [141.3, 24.8], [141.3, 25.4]],
    &[[127.7, 26.2], [128.2, 26.7], [126.8, 26.3], [127.9, 27.0]],
    &[[124.2, 24.4], [125.3, 24.8], [123.0, 24.5], [123.5, 25.7]],
    &[[131.2, 25.8], [131.2, 24.5]],
    &[[136.1, 20.4]],
    &[[154.0, 24.3]],
];

/// The plane rectangular zone, 1 to 19, whose places are nearest; `None` outside Japan.
fn japanese_zone(place: DVec2) -> Option<u32> {
    if place.y > KOREA.0 && place.x < KOREA.1 {
        return None;
    }
    let narrow = DVec2::new(place.y.to_radians().cos(), 1.0);
    let distance = |p: &[f64; 2]| ((DVec2::from(*p) - place) * narrow).length();
    let zones = PLACES.iter().zip(1u32..).flat_map(|(places, zone)| places.iter().map(move |p| (distance(p), zone)));
    zones.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(distance, _)| *distance <= NEAR).map(|(_, zone)| zone)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(code: u32, points: &[[f64; 2]]) -> Crs {
        working_crs(&Crs::from_epsg(code), points.iter().map(|p| DVec2::from(*p))).unwrap()
    }

    #[test]
    fn japans_towns_are_in_their_official_zones() {
        for (town, zone, place) in [
            ("Nagasaki", 1, [129.87, 32.75]),
            ("Naze", 1, [129.49, 28.38]),
            ("Tsushima", 1, [129.29, 34.2]),
            ("Fukuoka", 2, [130.4, 33.59]),
            ("Kagoshima", 2, [130.56, 31.6]),
            ("Kitakyushu", 2, [130.88, 33.88]),
            ("Hiroshima", 3, [132.46, 34.39]),
            ("Shimonoseki", 3, [130.95, 33.96]),
            ("Matsue", 3, [133.05, 35.47]),
            ("Kochi", 4, [133.53, 33.56]),
            ("Takamatsu", 4, [134.04, 34.34]),
            ("Kobe", 5, [135.19, 34.69]),
            ("Okayama", 5, [133.93, 34.66]),
            ("Osaka", 6, [135.5, 34.69]),
            ("Kyoto", 6, [135.77, 35.01]),
            ("Owase", 6, [136.2, 34.07]),
            ("Nagoya", 7, [136.9, 35.18]),
            ("Takayama", 7, [137.25, 36.14]),
            ("Nagano", 8, [138.18, 36.65]),
            ("Matsumoto", 8, [137.97, 36.24]),
            ("Hamamatsu", 8, [137.73, 34.71]),
            ("Fujisan", 8, [138.73, 35.36]),
            ("Tokyo", 9, [139.69, 35.69]),
            ("Tsukuba", 9, [140.09, 36.1]),
            ("Hachijojima", 9, [139.79, 33.11]),
            ("Fukushima", 9, [140.47, 37.75]),
            ("Morioka", 10, [141.15, 39.7]),
            ("Miyako", 10, [141.96, 39.64]),
            ("Sendai", 10, [140.87, 38.27]),
            ("Hakodate", 11, [140.73, 41.77]),
            ("Otaru", 11, [141.0, 43.19]),
            ("Sapporo", 12, [141.35, 43.06]),
            ("Wakkanai", 12, [141.67, 45.42]),
            ("Asahikawa", 12, [142.37, 43.77]),
            ("Kushiro", 13, [144.38, 42.98]),
            ("Obihiro", 13, [143.2, 42.92]),
            ("Chichijima", 14, [142.19, 27.09]),
            ("Iwo To", 14, [141.32, 24.78]),
            ("Naha", 15, [127.68, 26.21]),
            ("Ishigaki", 16, [124.16, 24.34]),
            ("Yonaguni", 16, [123.0, 24.47]),
            ("Minamidaito", 17, [131.23, 25.83]),
            ("Okinotorishima", 18, [136.07, 20.42]),
            ("Minamitorishima", 19, [153.98, 24.29]),
        ] {
            for code in [4326, 4612, 6668] {
                assert_eq!(at(code, &[place]).epsg, Some(6668 + zone), "{town}");
            }
            assert_eq!(at(4301, &[place]).epsg, Some(30160 + zone), "{town}");
        }
    }

    #[test]
    fn elsewhere_it_is_utm() {
        for (code, place, expected) in [
            (4326, [8.0, 58.15], 25832),
            (4326, [3.0, 36.7], 32631),
            (4258, [8.0, 58.15], 25832),
            (4258, [5.3, 60.4], 25832),
            (4326, [129.08, 35.18], 32652),
            (4326, [121.75, 24.75], 32651),
            (4326, [142.7, 46.95], 32654),
            (4326, [151.2, -33.9], 32756),
            (4269, [-74.0, 41.0], 26918),
            (4267, [-74.0, 41.0], 26718),
            (4326, [180.0, 10.0], 32601),
            (4326, [-180.0, 10.0], 32601),
            (4283, [151.2, -33.9], 32756),
        ] {
            assert_eq!(at(code, &[place]).epsg, Some(expected), "{code} {place:?}");
        }
        // Both sides of the 180th meridian are near each other.
        assert_eq!(at(4326, &[[179.9, -17.0], [-179.8, -17.1]]).epsg, Some(32701));
    }

    #[test]
    fn a_plane_in_metres_is_its_own_and_one_in_feet_is_not() {
        assert_eq!(at(25832, &[[4e5, 6e6]]).epsg, Some(25832));
        assert_eq!(at(2229, &[[6.5e6, 1.86e6]]).epsg, Some(26911));
        let error = working_crs(&Crs::from_wkt("LOCAL_CS[\"site\"]"), std::iter::empty()).unwrap_err();
        assert!(error.to_string().contains("site"), "{error}");
        assert!(working_crs(&Crs::wgs84(), std::iter::empty()).is_err());
    }

    #[test]
    fn wide_data_and_old_datums_get_a_projection_of_their_own() {
        for (code, points) in [
            (4326, &[[2.0, 46.0], [14.0, 47.0]][..]),
            (6668, &[[130.0, 33.0], [141.0, 39.0]]),
            (4326, &[[10.0, 84.5]]),
            (4004, &[[10.0, 50.0]]),
            (4301, &[[126.9, 37.5]]),
            (4275, &[[2.0, 46.0]]),
        ] {
            let crs = at(code, points);
            assert_eq!((crs.epsg, crs.kind()), (None, Some(CrsKind::Projected)), "{code}");
            assert_eq!(crs.length_unit().map(|unit| unit.metres), Some(1.0));
            let way = Transform::between(&Crs::from_epsg(code), &crs).unwrap();
            for p in points.iter().map(|p| DVec2::from(*p)) {
                let q = way.forward(p).unwrap();
                assert!(q.length() < 1.2e6, "{code} {q}");
                assert!(way.inverse(q).unwrap().distance(p) < 1e-11, "{code} {p}");
            }
        }
        // True to scale in the middle.
        let way = Transform::between(&Crs::from_epsg(4004), &at(4004, &[[10.0, 50.0]])).unwrap();
        assert!(way.forward(DVec2::new(10.0, 50.0)).unwrap().length() < 1e-6);
    }
}
