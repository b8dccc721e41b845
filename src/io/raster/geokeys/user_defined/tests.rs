//! Systems described by keys.

use super::*;

/// Keys as GDAL writes them: a number that is whole is a short, any other goes to the doubles.
fn keys(entries: &[(u16, f64)], texts: &[(u16, &str)]) -> GeoKeys {
    let mut keys = GeoKeys::default();
    let mut list = Vec::new();
    for &(key, value) in entries {
        let is_code = matches!(key, 1024..=2054 | 2056 | 3072..=3076 | 2060);
        if is_code && key != PRIME_MERIDIAN_LONGITUDE {
            list.push([key, 0, 1, value as u16]);
        } else {
            list.push([key, super::super::DOUBLE_PARAMS, 1, keys.doubles.len() as u16]);
            keys.doubles.push(value);
        }
    }
    for &(key, text) in texts {
        list.push([key, super::super::ASCII_PARAMS, text.len() as u16 + 1, keys.ascii.len() as u16]);
        keys.ascii.push_str(&format!("{text}|"));
    }
    keys.push(&list);
    keys
}

const GRS_80: [(u16, f64); 4] = [(2048, 32767.0), (2054, 9102.0), (2056, 7019.0), (1024, 1.0)];
const OWN: [(u16, f64); 2] = [(3072, 32767.0), (3076, 9001.0)];

fn described(more: &[(u16, f64)]) -> Result<Crs, String> {
    let entries = [&GRS_80[..], &OWN, more].concat();
    keys(&entries, &[(3073, "Own \"grid\"")]).described().expect("keys of a system")
}

#[test]
fn projections_become_the_text_that_gdal_makes_of_them() {
    let lambert =
        [(3075, 8.0), (3078, 49.5), (3079, 51.25), (3084, 4.5), (3085, 50.75), (3086, 649328.0), (3087, 665262.0)];
    let crs = described(&lambert).expect("a system");
    assert_eq!(
        crs.wkt.as_deref(),
        Some(
            "PROJCS[\"Own \"\"grid\"\"\",GEOGCS[\"unknown\",DATUM[\"unknown\",SPHEROID[\"GRS 1980\",6378137,298.257222101,\
             AUTHORITY[\"EPSG\",\"7019\"]]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433,\
             AUTHORITY[\"EPSG\",\"9122\"]]],PROJECTION[\"Lambert_Conformal_Conic_2SP\"],PARAMETER[\"standard_parallel_1\",49.5],\
             PARAMETER[\"standard_parallel_2\",51.25],PARAMETER[\"latitude_of_origin\",50.75],PARAMETER[\"central_meridian\",4.5],\
             PARAMETER[\"false_easting\",649328],PARAMETER[\"false_northing\",665262],UNIT[\"metre\",1,\
             AUTHORITY[\"EPSG\",\"9001\"]]]"
        )
    );
    assert_eq!(crs.name().as_deref(), Some("Own \"grid\""));
    let holds = |more: &[(u16, f64)], parts: &[&str]| {
        let text = described(more).expect("a system").wkt.expect("a text");
        parts.iter().for_each(|part| assert!(text.contains(part), "{part} in {text}"));
    };
    let albers = [(3075, 11.0), (3078, 29.5), (3079, 45.5), (3080, -96.0), (3081, 23.0), (3082, 1.5), (3083, 0.0)];
    holds(&albers, &["Albers_Conic", "latitude_of_center\",23]", "longitude_of_center\",-96]", "false_easting\",1.5]"]);
    holds(&[(3075, 10.0), (3088, 10.0), (3089, 52.0), (3082, 4321000.0)], &["Lambert_Azimuthal", "of_center\",52]"]);
    holds(
        &[(3075, 1.0), (3080, 141.25), (3092, 0.9999)],
        &["Transverse_Mercator\"", "141.25]", "scale_factor\",0.9999]"],
    );
    holds(&[(3075, 7.0), (3078, 30.0)], &["Mercator_2SP", "standard_parallel_1\",30]"]);
    holds(&[(3075, 7.0), (3092, 0.997)], &["Mercator_1SP", "scale_factor\",0.997]"]);
    holds(&[(3075, 15.0), (3095, -45.0), (3081, 70.0)], &["Polar_Stereographic", "central_meridian\",-45]"]);
    holds(&[(3074, 16033.0)], &["central_meridian\",15]", "scale_factor\",0.9996]", "false_northing\",0]"]);
    holds(&[(3074, 16156.0)], &["central_meridian\",153]", "false_easting\",500000]", "false_northing\",10000000]"]);
}

#[test]
fn the_geographic_system_is_named_by_code_datum_or_ellipsoid() {
    let plane = [(1024, 1.0), (3072, 32767.0), (3075, 1.0), (3080, 9.0)];
    let of = |more: &[(u16, f64)], texts: &[(u16, &str)]| {
        keys(&[&plane[..], more].concat(), texts).described().expect("keys").map(|crs| crs.wkt.expect("a text"))
    };
    let text = of(&[(2048, 4326.0), (3076, 9003.0)], &[]).expect("a system");
    assert!(
        text.contains("GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\"") && text.contains("UNIT[\"US survey foot\",0.3048006"),
        "{text}"
    );
    let text = of(&[(2048, 32767.0), (2050, 6269.0)], &[]).expect("a system");
    assert!(text.contains("DATUM[\"North_American_Datum_1983\""), "{text}");
    let named = [(2049, "GCS Name = My degrees|Datum = My datum|Ellipsoid = My ellipsoid|Primem = Greenwich")];
    let axes = [(2048, 32767.0), (2057, 6377000.5), (2059, 300.25), (3077, 0.5), (3076, 32767.0)];
    let text = of(&axes, &named).expect("a system");
    let base =
        "GEOGCS[\"My degrees\",DATUM[\"My datum\",SPHEROID[\"My ellipsoid\",6377000.5,300.25]],PRIMEM[\"Greenwich\",0]";
    assert!(text.contains(base) && text.ends_with("UNIT[\"unknown\",0.5]]"), "{text}");
    let text = of(&[(2048, 32767.0), (2057, 6371000.0), (2058, 6371000.0), (2061, 2.5)], &[]).expect("a system");
    assert!(text.contains("6371000,0]") && text.contains("PRIMEM[\"unknown\",2.5]"), "{text}");
    // Angles in grads beside a geographic system in degrees.
    let text = of(&[(2048, 4326.0), (2054, 9105.0), (3081, 50.0)], &[]).expect("a system");
    assert!(text.contains("latitude_of_origin\",45") || text.contains("latitude_of_origin\",44.99999999"), "{text}");
    let degrees = keys(&[(1024, 2.0), (2048, 32767.0), (2056, 7004.0)], &[(2049, "Old island")]).described();
    let degrees = degrees.expect("keys").expect("a system");
    assert!(degrees.is_geographic() && degrees.name().as_deref() == Some("Old island"));
}

#[test]
fn what_is_not_described_is_said_and_not_guessed() {
    for (more, why) in [
        (&[(3075, 8.0), (3078, 49.0)][..], "without its standard_parallel_2"),
        (&[(3075, 23.0)], "the method 23"),
        (&[(3075, 8.0), (3078, f64::NAN), (3079, 50.0)], "without its standard_parallel_1"),
        (&[], "without its method"),
        (&[(3074, 10401.0)], "EPSG:10401"),
    ] {
        assert!(described(more).is_err_and(|message| message.contains(why)), "{why}");
    }
    let of = |entries: &[(u16, f64)]| keys(entries, &[]).described();
    let plane = [(1024, 1.0), (3072, 32767.0), (3075, 1.0)];
    for (more, why) in [
        (&[(2048, 32767.0)][..], "without its ellipsoid"),
        (&[(2048, 9.0)], "EPSG:9"),
        (&[(2048, 4326.0), (3076, 1.0)], "unit of length 1"),
        (&[(2048, 4326.0), (2054, 9108.0)], "unit of angle 9108"),
        (&[(2048, 32767.0), (2057, -5.0), (2059, 300.0)], "semi-major axis -5"),
    ] {
        let told = of(&[&plane[..], more].concat()).expect("keys");
        assert!(told.as_ref().is_err_and(|message| message.contains(why)), "{why}: {told:?}");
    }
    assert_eq!(of(&[(1024, 1.0), (3072, 6677.0)]), None);
    assert_eq!(of(&[]), None);
}

#[test]
fn a_text_from_keys_finds_its_code_and_can_be_transformed() {
    let zone = [(3075, 1.0), (3080, 139.833_333_333_333_34), (3081, 36.0), (3092, 0.9999)];
    let entries = [&[(1024, 1.0), (2048, 6668.0)], &OWN[..], &zone].concat();
    let named = keys(&entries, &[(3073, "JGD2011 / Japan Plane Rectangular CS IX")]).described();
    assert_eq!(named.expect("keys").expect("a system").epsg, Some(6677));
    let own = keys(&entries, &[]).described().expect("keys").expect("a system");
    let back = tokosen_core::crs::Transform::between(&own, &Crs::from_epsg(6677)).expect("a transformation");
    let place = glam::DVec2::new(-12_345.0, 6_789.0);
    assert!(back.forward(place).is_some_and(|p| p.distance(place) < 1e-6));
}
