//! Elevations in feet: read as what they are, doubted where that is not certain, written where that is asked for.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::BTreeSet;
use std::fs;

use serde_json::{Value, json};
use tokosen::crs::Crs;
use tokosen::io::raster::read_standard_errors;

use crate::common;
use crate::running::{Running, tokosen};

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

/// NAD83 / Arizona East (ft), and the same with NAVD88 height (ft).
const PLANE_IN_FEET: u32 = 2222;
const WITH_HEIGHTS_IN_FEET: u32 = 8700;
/// NAD83 / UTM zone 12N, in metres.
const PLANE_IN_METRES: u32 = 26912;

/// Corner coordinates of the rings: a place in all of these systems.
const PLACE: [f64; 2] = [700_000.0, 1_200_000.0];

/// A square ring about the place, from corner to corner.
fn square(half: f64) -> Vec<[f64; 2]> {
    let [x, y] = PLACE;
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)]
        .map(|(i, j)| [x + half * i, y + half * j])
        .to_vec()
}

fn collection(crs: u32, features: &[Value]) -> Value {
    let name = json!({ "type": "name", "properties": { "name": format!("urn:ogc:def:crs:EPSG::{crs}") } });
    json!({ "type": "FeatureCollection", "crs": name, "features": features })
}

/// Rings at 40, 80 and 120, in an attribute of this name, and in z if that is asked for.
fn rings(crs: u32, name: &str, with_z: bool) -> Value {
    let ring = |k: u32| {
        let z = 40.0 * f64::from(k + 1);
        let points: Vec<Value> = square(1000.0 - 250.0 * f64::from(k))
            .iter()
            .map(|[x, y]| if with_z { json!([x, y, z]) } else { json!([x, y]) })
            .collect();
        json!({ "type": "Feature", "properties": { name: z }, "geometry": { "type": "LineString", "coordinates": points } })
    };
    collection(crs, &[ring(0), ring(1), ring(2)])
}

/// One point between the second and the third ring.
fn spot(crs: u32, z: f64) -> Value {
    let [x, y] = PLACE;
    let geometry = json!({ "type": "Point", "coordinates": [x + 600.0, y] });
    collection(crs, &[json!({ "type": "Feature", "properties": { "elev": z }, "geometry": geometry })])
}

impl Folder {
    fn put(&self, name: &str, content: &Value) -> &Self {
        fs::write(self.path(name), content.to_string()).unwrap();
        self
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }

    /// The values of an attribute in a GeoJSON, each once, as they are written.
    fn values(&self, name: &str, attribute: &str) -> BTreeSet<String> {
        let file = self.json(name);
        let features = file["features"].as_array().unwrap();
        features.iter().map(|feature| feature["properties"][attribute].to_string()).collect()
    }
}

fn set(values: &[&str]) -> BTreeSet<String> {
    values.iter().map(|value| (*value).to_owned()).collect()
}

#[test]
fn a_vertical_system_in_feet_is_believed() {
    let folder = Folder::new();
    folder.put("feet.geojson", &rings(WITH_HEIGHTS_IN_FEET, "elev", false));
    let said = folder.succeeds("densify feet.geojson -i 100 --keep-input -o out.geojson");
    assert!(said.contains("states heights in feet; the elevations were read as feet"), "{said}");
    assert!(
        said.contains("from 40 to 120 ft, vertical interval 40 ft") && said.contains("the input are feet"),
        "{said}"
    );
    assert_eq!(folder.values("out.geojson", "elev"), set(&["12.192", "24.384", "36.576"]));
    // Heights are in metres now, and the system must not say that they are feet.
    let name = &folder.json("out.geojson")["crs"]["properties"]["name"];
    assert_eq!(name, &json!(format!("urn:ogc:def:crs:EPSG::{PLANE_IN_FEET}")));

    // The user knows better.
    let said = folder.succeeds("densify feet.geojson -i 100 --keep-input -o out.geojson --unit m");
    assert!(said.contains("states heights in feet; the elevations are taken as metres all the same"), "{said}");
    assert!(folder.values("out.geojson", "elev").contains("40.0"));
    // It may be stated on the command line.
    folder.put("plane.geojson", &rings(PLANE_IN_FEET, "elev", false));
    folder.succeeds("densify plane.geojson --crs EPSG:8700 -i 100 --keep-input -o out.geojson");
    assert!(folder.values("out.geojson", "elev").contains("12.192"));
}

#[test]
fn likely_feet_are_doubted_and_the_flag_is_named() {
    let folder = Folder::new();
    let doubted = |arguments: &str, words: &str| {
        let said = folder.succeeds(arguments);
        assert!(said.contains(words) && said.contains("--unit ft"), "{arguments}: {said}");
        assert!(said.contains("from 40 to 120 m"), "{said}");
        let (well, said) = folder.run(&format!("{arguments} --strict"));
        assert!(!well && said.contains(words), "{said}");
        let said = folder.succeeds(&format!("{arguments} --unit ft"));
        assert!(!said.contains(words) && said.contains("from 40 to 120 ft"), "{said}");
        let said = folder.succeeds(&format!("{arguments} --unit m --strict"));
        assert!(!said.contains(words) && said.contains("from 40 to 120 m"), "{said}");
    };
    for (name, field) in [("a", "elev_ft"), ("b", "ELEV_FEET"), ("c", "height_ft"), ("d", "Contour (ft)")] {
        folder.put(&format!("{name}.geojson"), &rings(PLANE_IN_METRES, field, true));
        doubted(
            &format!("densify {name}.geojson -i 100 --keep-input -o out.geojson"),
            &format!("{field:?} seems to hold feet"),
        );
    }
    folder.put("flat.geojson", &rings(PLANE_IN_METRES, "elev_ft", false));
    doubted("densify flat.geojson -a elev_ft -i 100 --keep-input -o out.geojson", "\"elev_ft\" seems to hold feet");
    folder.put("plane.geojson", &rings(PLANE_IN_FEET, "elev", false));
    doubted("regions plane.geojson -o out.geojson", "the coordinates are feet, and nothing states the unit of heights");
    // Metres by their name on a plane in feet are no doubt.
    folder.put("metres.geojson", &rings(PLANE_IN_FEET, "elev_m", false));
    folder.succeeds("densify metres.geojson -i 100 --keep-input -o out.geojson --strict");
}

#[test]
fn check_tells_the_doubt_too() {
    let folder = Folder::new();
    folder.put("plane.geojson", &rings(PLANE_IN_FEET, "elev", false));
    let said = folder.succeeds("check plane.geojson");
    assert!(said.contains("unit-doubt") && said.contains("--unit ft"), "{said}");
}

#[test]
fn spot_heights_and_lakes_have_the_unit_of_their_own_system() {
    let folder = Folder::new();
    folder.put("feet.geojson", &rings(WITH_HEIGHTS_IN_FEET, "elev", false));
    folder.put("metres.geojson", &rings(PLANE_IN_FEET, "elev", false));
    folder.put("spot_in_feet.geojson", &spot(WITH_HEIGHTS_IN_FEET, 100.0));
    folder.put("spot.geojson", &spot(PLANE_IN_FEET, 100.0));
    let lake = |crs: u32, z: f64| {
        let geometry = json!({ "type": "Polygon", "coordinates": [square(200.0)] });
        collection(crs, &[json!({ "type": "Feature", "properties": { "elev": z }, "geometry": geometry })])
    };
    folder.put("lake_in_feet.geojson", &lake(WITH_HEIGHTS_IN_FEET, 130.0));
    folder.put("lake.geojson", &lake(PLANE_IN_FEET, 130.0));

    // The spot lies between the rings of 80 and 120.
    let outside = |arguments: &str| {
        let said = folder.succeeds(&format!("skeleton {arguments} -o out.geojson"));
        said.contains("spot heights outside the contours around them")
    };
    assert!(!outside("feet.geojson --points spot.geojson"));
    assert!(!outside("feet.geojson --points spot_in_feet.geojson"));
    assert!(!outside("metres.geojson --unit m --points spot.geojson"));
    assert!(outside("metres.geojson --points spot_in_feet.geojson"));
    let said = folder.succeeds("skeleton metres.geojson --points spot_in_feet.geojson -o out.geojson");
    assert!(said.contains("states heights in feet; the spot heights were read as feet"), "{said}");

    let said = folder.succeeds("densify feet.geojson -i 100 --keep-input --water lake.geojson -o out.geojson");
    assert!(said.contains("height 129.9869 ft"), "{said}");
    let said = folder.succeeds("densify feet.geojson -i 100 --keep-input --water lake_in_feet.geojson -o out.geojson");
    assert!(said.contains("height 129.9869 ft"), "{said}");
    let said =
        folder.succeeds("densify metres.geojson -i 100 --keep-input --unit m --water lake.geojson -o out.geojson");
    assert!(said.contains("height 130 m"), "{said}");
}

#[test]
fn a_shapefile_of_esris_programs_names_its_vertical_system() {
    let folder = Folder::new();
    folder.put("plane.geojson", &rings(PLANE_IN_FEET, "elev", false));
    folder.succeeds("densify plane.geojson --unit m -i 100 --keep-input -o esri.shp");
    let plane = Crs::from_epsg(PLANE_IN_FEET).wkt.unwrap();
    let vertical = "VERTCS[\"NAVD_1988_Foot_US\",VDATUM[\"North_American_Vertical_Datum_1988\"],\
                    PARAMETER[\"Vertical_Shift\",0.0],PARAMETER[\"Direction\",1.0],UNIT[\"Foot_US\",0.3048006096012192]]";
    fs::write(folder.path("esri.prj"), format!("{plane},{vertical}")).unwrap();
    let said = folder.succeeds("densify esri.shp -i 100 --keep-input -o out.geojson");
    assert!(said.contains("states heights in US survey feet; the elevations were read as US survey feet"), "{said}");
    assert!(folder.values("out.geojson", "elev").contains(&(40.0 * 1200.0 / 3937.0).to_string()));
}

/// All coordinates of the lines of a GeoJSON.
fn vertices(file: &Value) -> Vec<[f64; 3]> {
    let lines = file["features"].as_array().unwrap().iter().map(|feature| &feature["geometry"]["coordinates"]);
    let number = |p: &Value, k: usize| p[k].as_f64().unwrap_or(0.0);
    lines.flat_map(|line| line.as_array().unwrap()).map(|p| [0, 1, 2].map(|k| number(p, k))).collect()
}

#[test]
fn contours_every_ten_feet_are_written_in_feet() {
    let folder = Folder::new();
    folder.put("feet.geojson", &rings(WITH_HEIGHTS_IN_FEET, "elev", false));
    let said = folder.succeeds("densify feet.geojson -i 10 --to-unit ft -o out.geojson");
    assert!(said.contains("layer contours_10ft") && said.contains("heights in feet"), "{said}");
    let file = folder.json("out.geojson");
    let levels: BTreeSet<String> = (4..=12).map(|k| format!("{:?}", 10.0 * f64::from(k))).collect();
    assert!(folder.values("out.geojson", "elev").is_superset(&levels), "{:?}", folder.values("out.geojson", "elev"));
    // The vertical part of the system says feet, which is right again.
    assert_eq!(file["crs"]["properties"]["name"], json!("urn:ogc:def:crs:EPSG::8700"));
    let found: BTreeSet<[u64; 3]> = vertices(&file).iter().map(|p| p.map(f64::to_bits)).collect();
    for (k, half) in [1000.0, 750.0, 500.0].into_iter().enumerate() {
        for [x, y] in square(half) {
            assert!(found.contains(&[x, y, 40.0 * (k + 1) as f64].map(f64::to_bits)), "{x} {y} of ring {k}");
        }
    }
    for feature in file["features"].as_array().unwrap() {
        let level = feature["properties"]["elev"].as_f64().unwrap();
        assert_eq!(feature["properties"]["is_index"], json!(level % 50.0 == 0.0), "{level}");
    }
    let said = folder.succeeds("densify feet.geojson --levels 45,47.5 --to-unit us-ft -o out.geojson");
    assert!(said.contains("heights in US survey feet"), "{said}");
    assert!(folder.values("out.geojson", "elev").is_superset(&set(&["45.0", "47.5"])));
    assert_eq!(folder.json("out.geojson")["crs"]["properties"]["name"], json!("urn:ogc:def:crs:EPSG::2222"));
    let said = folder.succeeds("densify feet.geojson -i 20,10 --to-unit us-ft -o out.gpkg");
    assert!(said.contains("layer contours_20usft") && said.contains("layer contours_10usft"), "{said}");
}

#[test]
fn elevations_in_us_survey_feet_come_back_as_they_were() {
    let folder = Folder::new();
    folder.put("plane.geojson", &rings(PLANE_IN_METRES, "elev", false));
    folder.succeeds("densify plane.geojson --unit us-ft -i 40 --to-unit us-ft -o out.geojson");
    let elevations = folder.values("out.geojson", "elev");
    assert!(elevations.is_superset(&set(&["40.0", "80.0", "120.0"])), "{elevations:?}");
    assert!(elevations.iter().all(|z| z.parse::<f64>().unwrap() % 40.0 == 0.0), "{elevations:?}");
    // Without the option they are metres, and so are the levels.
    folder.succeeds("densify plane.geojson --unit us-ft -i 5 -o out.geojson");
    assert!(folder.values("out.geojson", "elev").contains("15.0"));
}

#[test]
fn a_map_in_feet_is_told_of_in_feet() {
    let folder = Folder::new();
    let mut map = rings(WITH_HEIGHTS_IN_FEET, "elev", false);
    // The second ring twice, and a gap of 0.01 ft in the third.
    let features = map["features"].as_array_mut().unwrap();
    features.push(features[1].clone());
    let points = features[2]["geometry"]["coordinates"].as_array_mut().unwrap();
    let last = points.last_mut().unwrap();
    last[0] = json!(last[0].as_f64().unwrap() + 0.01);
    folder.put("feet.geojson", &map);
    for command in ["check feet.geojson -v", "densify feet.geojson -i 10 --to-unit ft -v -o out.geojson"] {
        let said = folder.succeeds(command);
        assert!(said.contains("contour 80 ft (feature 3) is the same line as that of feature 1"), "{said}");
        assert!(said.contains("a gap of 0.01 ft in the contour 120 ft"), "{said}");
        assert!(said.contains("3 levels from 40 to 120 ft, vertical interval 40 ft"), "{said}");
        let metres = |word: &str| word == "m" || word == "m," || word == "m;";
        assert!(!said.split_whitespace().any(metres), "{said}");
    }
}

#[test]
fn the_other_verbs_write_feet_too() {
    let folder = Folder::new();
    folder.put("feet.geojson", &rings(WITH_HEIGHTS_IN_FEET, "elev", false));
    folder.succeeds("regions feet.geojson --to-unit ft -o out.geojson");
    assert!(folder.values("out.geojson", "band_lo").is_superset(&set(&["40.0", "80.0"])));
    folder.succeeds("skeleton feet.geojson --to-unit ft -o out.geojson");
    // Ridges lead from the last contour to the top.
    assert_eq!(folder.values("out.geojson", "lower_z"), set(&["120.0"]));
    let heights: Vec<f64> = vertices(&folder.json("out.geojson")).iter().map(|p| p[2]).collect();
    assert!(heights.contains(&120.0) && heights.iter().all(|z| (120.0..=160.0).contains(z)), "{heights:?}");
    let said = folder.succeeds("check feet.geojson --repair safe --to-unit ft -o fixed.geojson");
    assert!(said.contains("heights in feet"), "{said}");
    assert_eq!(folder.values("fixed.geojson", "elev"), set(&["40.0", "80.0", "120.0"]));
    for (arguments, words) in [
        ("check feet.geojson --to-unit ft", "--to-unit needs a file"),
        ("check feet.geojson --to-unit ft -o found.geojson", "--to-unit is for repaired contours"),
        (
            "dem feet.geojson --cell 10 --png-encoding gsi --to-unit ft -o dem.png",
            "--png-encoding gsi holds metres only",
        ),
        (
            "dem feet.geojson --cell 10 --png-encoding mapbox --to-unit us-ft -o dem.png",
            "--png-encoding mapbox holds metres only",
        ),
        (
            "dem feet.geojson --cell 10 --png-encoding terrarium -o dem.tif",
            "--png-encoding applies to height maps in .png",
        ),
    ] {
        let (well, said) = folder.run(arguments);
        assert!(!well && said.contains(words), "{arguments}: {said}");
    }
    // The level of the sea is in the unit of the output.
    let said = folder.succeeds("regions feet.geojson --sea 40 --frame bbox --to-unit ft -o out.geojson");
    assert!(!said.contains("no contour"), "{said}");
}

#[test]
fn height_maps_in_feet_say_so_and_are_read_as_what_they_are() {
    let folder = Folder::new();
    folder.put("feet.geojson", &rings(WITH_HEIGHTS_IN_FEET, "elev", false));
    folder.succeeds("dem feet.geojson --cell 10 --uncertainty -o metres.tif");
    for (unit, name) in [("ft", "ft"), ("us-ft", "US survey foot")] {
        let said = folder.succeeds(&format!("dem feet.geojson --cell 10 --uncertainty --to-unit {unit} -o feet.tif"));
        let symbol = if unit == "ft" { " ft)" } else { " US ft)" };
        assert!(said.contains(symbol), "{said}");
        let bytes = fs::read(folder.path("feet.tif")).unwrap();
        let stated = format!("role=\"unittype\">{name}<");
        let count = bytes.windows(stated.len()).filter(|window| *window == stated.as_bytes()).count();
        assert_eq!(count, 2, "both bands state {name}");
        let said = folder.succeeds("compare feet.tif metres.tif --json");
        let found: Value =
            serde_json::from_str(&said[said.find("\n{").map_or(0, |at| at + 1)..said.rfind('}').unwrap() + 1]).unwrap();
        assert!(found["overall"]["rmse"].as_f64().unwrap() < 1e-4, "{}", found["overall"]);
        assert_eq!(found["findings"][0]["kind"], json!("height-unit"), "{}", found["findings"]);
    }
    // Errors follow the unit.
    let errors = |name: &str| {
        let dem = read_standard_errors(&folder.path(name)).unwrap().unwrap();
        dem.values.iter().filter(|error| error.is_finite()).map(|error| f64::from(*error)).sum::<f64>()
    };
    let (feet, metres) = (errors("feet.tif"), errors("metres.tif"));
    assert!((feet - metres).abs() < 1e-5 * metres && metres > 0.0, "{feet} {metres}");

    let err_v = |name: &str| -> f64 {
        folder.values(name, "err_v").iter().map(|error| error.parse::<f64>().unwrap()).fold(0.0, f64::max)
    };
    folder.succeeds("densify feet.geojson --levels 24 --uncertainty -o metres.geojson");
    folder.succeeds(&format!(
        "densify feet.geojson --levels {} --uncertainty --to-unit ft -o feet.geojson.geojson",
        24.0 / 0.3048
    ));
    let ratio = err_v("feet.geojson.geojson") / err_v("metres.geojson");
    assert!((ratio * 0.3048 - 1.0).abs() < 0.01, "{ratio}");
}

#[test]
fn check_points_have_the_unit_of_their_system_or_of_the_contours() {
    let folder = Folder::new();
    folder.put("feet.geojson", &rings(WITH_HEIGHTS_IN_FEET, "elev", false));
    folder.succeeds("dem feet.geojson --cell 10 -o dem.tif");
    folder.put("own.geojson", &spot(WITH_HEIGHTS_IN_FEET, 100.0)).put("plain.geojson", &spot(PLANE_IN_FEET, 100.0));
    let bias = |arguments: &str| {
        let mut command = tokosen();
        let output = command.current_dir(folder.0.path()).args(arguments.split_whitespace()).output().unwrap();
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        found["a"]["points"]["bias"].as_f64().unwrap()
    };
    // The ground at the points is near 100 feet.
    assert!(bias("compare dem.tif dem.tif --points own.geojson --json").abs() < 4.0);
    assert!(bias("compare feet.geojson dem.tif --points plain.geojson --json").abs() < 4.0);
    assert!(bias("compare dem.tif dem.tif --points plain.geojson --json") < -60.0, "metres if nothing says else");
    assert!(bias("compare dem.tif dem.tif --points plain.geojson --unit ft --json").abs() < 4.0);
}
