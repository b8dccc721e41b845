//! A system as PROJJSON, which GeoParquet asks for, and back.
//!
//! The text is made of the system's WKT 1: its own, or that of the built-in table. Methods and parameters get the names and codes
//! of EPSG, by which programs know them; the table has those of projections in wide use. Reading takes the code alone: PROJJSON of
//! PROJ, GDAL and others names it.

use serde_json::{Map, Value, json};

use super::projection_methods::{METHODS, WEB_MERCATOR};
use super::system::{Crs, DEGREE};
use super::wkt::Node;

/// The version of the schema.
const SCHEMA: &str = "https://proj.org/schemas/v0.7/projjson.schema.json";

impl Crs {
    /// The system as PROJJSON. `None` if it has no WKT 1, or is of a kind or a projection that is not known here.
    pub fn projjson(&self) -> Option<Value> {
        // Texts of other programs leave axes and codes out. The table has them.
        let table = self.epsg.map(Self::from_epsg).filter(|crs| crs.wkt1().is_some());
        let own = Self { epsg: self.epsg, wkt: Some(table.as_ref().unwrap_or(self).wkt1()?.to_owned()) };
        let root = own.root()?;
        let horizontal = own.horizontal();
        let is_east_first = horizontal.is_east_first().unwrap_or(true) || horizontal.epsg.is_none();
        let axes = if is_east_first { Axes::EastNorth } else { Axes::NorthEast };
        let mut made = match (root.horizontal(), root.vertical()) {
            (part, Some(height)) => json!({
                "type": "CompoundCRS",
                "name": root.name()?,
                "components": [system(part, horizontal.epsg, axes)?, vertical(height)?],
            }),
            (part, None) => system(part, self.epsg, axes)?,
        };
        let object = made.as_object_mut()?;
        object.insert("$schema".into(), SCHEMA.into());
        if root.vertical().is_some() {
            object.extend(id(root.authority()).map(|id| ("id".to_owned(), id)));
        }
        Some(made)
    }

    /// The system that a PROJJSON names by its code, or by those of a horizontal and a vertical one.
    pub fn from_projjson(value: &Value) -> Option<Self> {
        let name = |value: &Value| {
            let id = &value["id"];
            let code = id["code"].as_u64().map(|code| code.to_string());
            let code = code.or_else(|| id["code"].as_str().map(str::to_owned))?;
            Some((id["authority"].as_str()?.to_owned(), code))
        };
        let found = match (name(value), value["components"].as_array().map(Vec::as_slice)) {
            (Some((authority, code)), _) => format!("{authority}:{code}"),
            (None, Some([horizontal, vertical])) => match (name(horizontal)?, name(vertical)) {
                ((first, plane), Some((second, height))) if first == second => format!("{first}:{plane}+{height}"),
                ((authority, plane), _) => format!("{authority}:{plane}"),
            },
            (None, _) if value["type"] == "BoundCRS" => return Self::from_projjson(&value["source_crs"]),
            (None, _) => return None,
        };
        Self::from_name(&found)
    }
}

/// The axes of a plane, in their order.
#[derive(Clone, Copy)]
enum Axes {
    EastNorth,
    NorthEast,
}

/// A horizontal system.
fn system(part: &Node, epsg: Option<u32>, axes: Axes) -> Option<Value> {
    let mut made = match part.keyword.as_str() {
        "GEOGCS" => geographic(part)?,
        "PROJCS" => projected(part, axes)?,
        _ => return None,
    };
    let named = id(part.authority()).or_else(|| epsg.map(|code| json!({ "authority": "EPSG", "code": code })));
    made.extend(named.map(|id| ("id".to_owned(), id)));
    Some(Value::Object(made))
}

fn id(authority: Option<(&str, u32)>) -> Option<Value> {
    authority.map(|(name, code)| json!({ "authority": name, "code": code }))
}

/// The entries of a geographic system.
fn geographic(node: &Node) -> Option<Map<String, Value>> {
    let datum = node.child(&["DATUM"])?;
    let spheroid = datum.child(&["SPHEROID"])?;
    let mut numbers = spheroid.numbers();
    let (a, rf) = (numbers.next()?, numbers.next()?);
    let mut ellipsoid = json!({ "name": spheroid.name()?, "semi_major_axis": a });
    match rf {
        0.0 => ellipsoid["semi_minor_axis"] = a.into(),
        _ => ellipsoid["inverse_flattening"] = rf.into(),
    }
    let mut frame = json!({ "type": "GeodeticReferenceFrame", "name": datum.name()?, "ellipsoid": ellipsoid });
    let meridian = node.child(&["PRIMEM"]);
    if let Some((node, degrees)) = meridian.and_then(|node| Some((node, node.numbers().next()?)))
        && degrees != 0.0
    {
        frame["prime_meridian"] = json!({ "name": node.name()?, "longitude": degrees });
    }
    let unit = angle_unit(node);
    let axis = |name: &str, abbreviation: &str, direction: &str| json!({ "name": name, "abbreviation": abbreviation, "direction": direction, "unit": unit });
    let axes = json!([axis("Geodetic latitude", "Lat", "north"), axis("Geodetic longitude", "Lon", "east"),]);
    let mut made = Map::new();
    made.insert("type".into(), "GeographicCRS".into());
    made.insert("name".into(), node.name()?.into());
    made.insert("datum".into(), frame);
    made.insert("coordinate_system".into(), json!({ "subtype": "ellipsoidal", "axis": axes }));
    Some(made)
}

fn angle_unit(node: &Node) -> Value {
    let name = node.child(&["UNIT"]).and_then(Node::name).unwrap_or("degree");
    unit("AngularUnit", "degree", (node.angle() - DEGREE).abs() < 1e-9, name, node.angle())
}

fn unit(kind: &str, usual: &str, is_usual: bool, name: &str, factor: f64) -> Value {
    if is_usual { usual.into() } else { json!({ "type": kind, "name": name, "conversion_factor": factor }) }
}

/// The entries of a projected system.
fn projected(node: &Node, order: Axes) -> Option<Map<String, Value>> {
    let base = node.child(&["GEOGCS"])?;
    let (unit_name, metres) = node.length_unit()?;
    let length = unit("LinearUnit", "metre", metres == 1.0, unit_name, metres);
    let mut base_crs = geographic(base)?;
    base_crs.extend(id(base.authority()).map(|id| ("id".to_owned(), id)));
    let is_web = node.child(&["EXTENSION"]).is_some();
    let given = plain(node.child(&["PROJECTION"])?.name()?);
    let method = match is_web {
        true => &WEB_MERCATOR,
        false => METHODS.iter().find(|(names, ..)| names.contains(&given.as_str()))?,
    };
    let (_, method_name, code, known) = method;
    let mut parameters = Vec::new();
    for given in node.nodes().filter(|node| node.keyword == "PARAMETER") {
        let (name, value) = (plain(given.name()?), given.numbers().next()?);
        let Some((names, name, code)) = known.iter().find(|(names, ..)| names.contains(&name.as_str())) else {
            // What has no effect has no place.
            if value == 0.0 || (name == "scalefactor" && value == 1.0) {
                continue;
            }
            return None;
        };
        let unit = match names.first() {
            Some(&"scalefactor") => "unity".into(),
            Some(&("falseeasting" | "falsenorthing")) => length.clone(),
            _ => angle_unit(base),
        };
        parameters
            .push(json!({ "name": name, "value": value, "unit": unit, "id": { "authority": "EPSG", "code": code } }));
    }
    let axis = |name: &str, abbreviation: &str, direction: &str| json!({ "name": name, "abbreviation": abbreviation, "direction": direction, "unit": length });
    let axes = match (*code, order) {
        (9808, _) => [axis("Westing", "Y", "west"), axis("Southing", "X", "south")],
        (_, Axes::EastNorth) => [axis("Easting", "E", "east"), axis("Northing", "N", "north")],
        (_, Axes::NorthEast) => [axis("Northing", "X", "north"), axis("Easting", "Y", "east")],
    };
    let mut made = Map::new();
    made.insert("type".into(), "ProjectedCRS".into());
    made.insert("name".into(), node.name()?.into());
    made.insert("base_crs".into(), Value::Object(base_crs));
    made.insert(
        "conversion".into(),
        json!({
            "name": format!("conversion of {}", node.name()?),
            "method": { "name": method_name, "id": { "authority": "EPSG", "code": code } },
            "parameters": parameters,
        }),
    );
    made.insert("coordinate_system".into(), json!({ "subtype": "Cartesian", "axis": axes }));
    Some(made)
}

/// A vertical system.
fn vertical(node: &Node) -> Option<Value> {
    let (name, metres) = node.length_unit().unwrap_or(("metre", 1.0));
    let unit = unit("LinearUnit", "metre", metres == 1.0, name, metres);
    let datum = node.child(&["VERT_DATUM"])?.name()?;
    let mut made = json!({
        "type": "VerticalCRS",
        "name": node.name()?,
        "datum": { "type": "VerticalReferenceFrame", "name": datum },
        "coordinate_system": {
            "subtype": "vertical",
            "axis": [{ "name": "Gravity-related height", "abbreviation": "H", "direction": "up", "unit": unit }],
        },
    });
    if let Some(id) = id(node.authority()) {
        made["id"] = id;
    }
    Some(made)
}

/// Lower case, letters and digits only.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn systems_in_use_have_a_text_that_names_them() {
        for code in [4326, 6668, 32616, 25832, 6677, 2229, 3857, 2056, 28992, 3035, 2154, 27700, 5070, 7423] {
            let crs = Crs::from_epsg(code);
            let made = crs.projjson().unwrap_or_else(|| panic!("EPSG:{code} has no text"));
            assert_eq!(Crs::from_projjson(&made).and_then(|crs| crs.epsg), Some(code), "{made}");
        }
        assert_eq!(Crs::from_wkt("nothing").projjson(), None);
        assert_eq!(Crs::from_epsg(99_999).projjson(), None);
    }

    #[test]
    fn nearly_all_systems_of_the_table_have_a_text() {
        let plane = |code: &u32| Crs::from_epsg(*code).root().is_some_and(|root| root.horizontal().is_projected());
        let codes: Vec<u32> = (1024..=u32::from(u16::MAX)).filter(plane).collect();
        let without: Vec<&u32> = codes.iter().filter(|code| Crs::from_epsg(**code).projjson().is_none()).collect();
        assert!(
            codes.len() > 4000 && without.len() * 50 < codes.len(),
            "{} of {}: {without:?}",
            without.len(),
            codes.len()
        );
    }

    #[test]
    fn a_projection_has_its_parameters() {
        let made = Crs::from_epsg(32616).projjson().expect("UTM is known");
        assert_eq!(made["conversion"]["method"]["id"]["code"], 9807);
        let parameters = made["conversion"]["parameters"].as_array().expect("a list");
        assert_eq!(parameters.len(), 5);
        assert!(parameters.iter().any(|p| p["id"]["code"] == 8802 && p["value"] == -87.0 && p["unit"] == "degree"));
        assert_eq!(made["coordinate_system"]["axis"][0]["direction"], "east");
        let feet = Crs::from_epsg(2229).projjson().expect("California is known");
        assert_eq!(feet["coordinate_system"]["axis"][0]["unit"]["name"], "US survey foot");
    }

    #[test]
    fn names_are_read() {
        let code = |value: Value| Crs::from_projjson(&value).and_then(|crs| crs.epsg);
        assert_eq!(code(json!({ "id": { "authority": "OGC", "code": "CRS84" } })), Some(4326));
        assert_eq!(
            code(json!({ "type": "BoundCRS", "source_crs": { "id": { "authority": "EPSG", "code": 6677 } } })),
            Some(6677)
        );
        assert_eq!(code(json!({ "name": "nowhere" })), None);
        assert_eq!(code(json!(7)), None);
    }
}
