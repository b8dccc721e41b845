//! How QGIS draws layers when it opens a GeoPackage: the table `layer_styles`.
//!
//! Index contours are thicker and have labels; contours of the input are darker than new ones; findings have a colour for each
//! severity; bands have the tint of pictures; floods are darker where they are deep. A style of the user for a layer of that name
//! is kept.

use std::fmt::Write;

use rusqlite::{Connection, OptionalExtension, params};

use super::target::LAST_CHANGE;
use crate::layer::{Geometry, Layer};
use tokosen_core::cartography::TINT;

/// The table as QGIS makes it.
const TABLE: &str = "
CREATE TABLE IF NOT EXISTS layer_styles (
  id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,
  f_table_catalog TEXT(256),
  f_table_schema TEXT(256),
  f_table_name TEXT(256),
  f_geometry_column TEXT(256),
  styleName TEXT(30),
  styleQML TEXT,
  styleSLD TEXT,
  useAsDefault BOOLEAN,
  description TEXT,
  owner TEXT(30),
  ui TEXT(30),
  update_time DATETIME DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now'))
);
";

/// Colours of the contours of the input and of new ones, and of findings by their severity.
const INPUT: &str = "84,48,22,255";
const INTERPOLATED: &str = "186,90,12,255";
const SEVERITIES: [(&str, &str); 3] =
    [("error", "215,25,28,255"), ("warning", "253,141,60,255"), ("note", "44,123,182,255")];

/// The colour of water.
const WATER: &str = "166,206,227,255";
/// The colours of the shallowest and the deepest water of a flood, and of water between.
const DEPTHS: &str = "0, '222,235,247', 0.5, '107,174,214', 1, '8,81,156'";

/// Adds the styles of the layers that have one.
pub(super) fn add(db: &Connection, layers: &[Layer<'_>]) -> rusqlite::Result<()> {
    for (layer, qml) in layers.iter().filter_map(|layer| Some((layer, style(layer)?))) {
        db.execute_batch(TABLE)?;
        db.execute(
            "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, f_geometry_column, styleName, styleQML,
             styleSLD, useAsDefault, description, owner, update_time)
             VALUES ('', '', ?1, 'geom', ?1, ?2, '', 1, 'made by tokosen', '', ?3)",
            params![layer.name, qml, LAST_CHANGE],
        )?;
    }
    Ok(())
}

/// Copies the style of a layer from the attached database `added`, if the target has none for that name. A table of another form
/// than that of QGIS stays as it is.
pub(super) fn copy(db: &Connection, layer: &str) -> rusqlite::Result<()> {
    let has = |of: &str| -> rusqlite::Result<bool> {
        let sql = format!("SELECT count(*) FROM {of}.sqlite_master WHERE type = 'table' AND name = 'layer_styles'");
        db.query_row(&sql, [], |row| row.get::<_, i64>(0)).map(|count| count > 0)
    };
    if !has("added")? {
        return Ok(());
    }
    let columns = "f_table_catalog, f_table_schema, f_table_name, f_geometry_column, styleName, styleQML, styleSLD, useAsDefault, \
                   description, owner, update_time";
    if has("main")? {
        let count = format!(
            "SELECT count(*) FROM pragma_table_info('layer_styles', 'main') WHERE instr('{columns}', name) > 0 AND name <> 'id'"
        );
        let known: i64 = db.query_row(&count, [], |row| row.get(0))?;
        let own = "SELECT 1 FROM main.layer_styles WHERE lower(f_table_name) = lower(?1)";
        let is_styled = || db.query_row(own, [layer], |_| Ok(())).optional().map(|found| found.is_some());
        if known < columns.split(", ").count() as i64 || is_styled()? {
            return Ok(());
        }
    } else {
        db.execute_batch(TABLE)?;
    }
    let sql = format!(
        "INSERT INTO main.layer_styles ({columns}) SELECT {columns} FROM added.layer_styles WHERE f_table_name = ?1"
    );
    db.execute(&sql, [layer]).map(|_| ())
}

/// The style of a layer, if layers with its attributes have one.
fn style(layer: &Layer<'_>) -> Option<String> {
    let has = |name: &str| layer.columns.iter().any(|column| column.name == name);
    match layer.geometry {
        Geometry::Lines if has("elev") && has("is_index") && has("source") => Some(contours(has("kind"))),
        Geometry::Points if has("severity") && has("message") => Some(findings()),
        Geometry::Areas if has("elev_mid") && has("kind") => Some(bands()),
        Geometry::Areas if has("depth_from") && has("depth_max") => Some(flood()),
        _ => None,
    }
}

/// The beginning of a style.
const HEAD: &str = "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n";

/// A symbol of one layer with these properties.
fn symbol(kind: &str, name: usize, class: &str, properties: &[(&str, &str)]) -> String {
    let mut text = format!("<symbol type=\"{kind}\" name=\"{name}\" alpha=\"1\" clip_to_extent=\"1\" force_rhr=\"0\">");
    let _ = write!(text, "<layer class=\"{class}\" enabled=\"1\" pass=\"0\" locked=\"0\"><Option type=\"Map\">");
    for (name, value) in properties {
        let _ = write!(text, "<Option type=\"QString\" name=\"{name}\" value=\"{value}\"/>");
    }
    text.push_str("</Option></layer></symbol>\n");
    text
}

fn contours(has_kinds: bool) -> String {
    let given = "&quot;source&quot; = 'input'";
    let mut rules = vec![
        ("index contour, input", format!("&quot;is_index&quot; AND {given}"), INPUT, "0.5", "solid"),
        ("index contour", format!("&quot;is_index&quot; AND NOT {given}"), INTERPOLATED, "0.45", "solid"),
        ("contour, input", format!("NOT &quot;is_index&quot; AND {given}"), INPUT, "0.25", "solid"),
        ("contour", format!("NOT &quot;is_index&quot; AND NOT {given}"), INTERPOLATED, "0.15", "solid"),
    ];
    if has_kinds {
        // All lines are those of one map: their kind counts, not where they come from.
        let of = |kind: &str| format!("&quot;kind&quot; = '{kind}'");
        rules = vec![
            ("index contour", of("index"), INPUT, "0.4", "solid"),
            ("intermediate contour", of("intermediate"), INPUT, "0.15", "solid"),
            ("supplementary contour", of("supplementary"), INPUT, "0.12", "dash"),
            ("supplementary contour, quarter", of("supplementary_quarter"), INPUT, "0.12", "dot"),
        ];
    }
    let mut text =
        format!("{HEAD}<qgis version=\"3.22\" styleCategories=\"Symbology|Labeling\" labelsEnabled=\"1\">\n");
    text.push_str("<renderer-v2 type=\"RuleRenderer\" symbollevels=\"0\" forceraster=\"0\" enableorderby=\"0\">\n<rules key=\"root\">\n");
    for (k, (label, filter, ..)) in rules.iter().enumerate() {
        let _ = writeln!(text, "<rule key=\"rule{k}\" symbol=\"{k}\" label=\"{label}\" filter=\"{filter}\"/>");
    }
    text.push_str("</rules>\n<symbols>\n");
    for (k, (_, _, color, width, style)) in rules.iter().enumerate() {
        let properties = [
            ("line_color", *color),
            ("line_width", *width),
            ("line_width_unit", "MM"),
            ("line_style", *style),
            ("capstyle", "round"),
            ("joinstyle", "round"),
        ];
        text.push_str(&symbol("line", k, "SimpleLine", &properties));
    }
    // The label lies on the line: placement 2, flag 1.
    text.push_str(
        "</symbols>\n</renderer-v2>\n<labeling type=\"rule-based\"><rules key=\"labels\">\
         <rule key=\"label0\" description=\"index contours\" filter=\"&quot;is_index&quot;\"><settings calloutType=\"simple\">\
         <text-style fieldName=\"elev\" isExpression=\"0\" fontSize=\"7\" fontSizeUnit=\"Point\" textColor=\"84,48,22,255\" textOpacity=\"1\">\
         <text-buffer bufferDraw=\"1\" bufferSize=\"0.7\" bufferSizeUnits=\"MM\" bufferColor=\"255,255,255,255\" bufferOpacity=\"0.9\"/>\
         </text-style><placement placement=\"2\" placementFlags=\"1\" repeatDistance=\"80\" repeatDistanceUnits=\"MM\" priority=\"5\"/>\
         <rendering drawLabels=\"1\" obstacle=\"1\"/></settings></rule></rules></labeling>\n</qgis>\n",
    );
    text
}

/// The tint by height; water is blue.
fn bands() -> String {
    let [height, low, high] =
        ["", "minimum", "maximum"].map(|of| format!("{of}(coalesce(elev_mid, elev_from, elev_to))"));
    let last = (TINT.len() - 1) as f64;
    let stop = |(k, [r, g, b]): (usize, &[u8; 3])| format!("{}, '{r},{g},{b}'", k as f64 / last);
    let stops = TINT.iter().enumerate().map(stop).collect::<Vec<_>>().join(", ");
    let tint = format!(
        "if(kind = 'ground', ramp_color(create_ramp(map({stops})), if({high} &gt; {low}, ({height} - {low}) / ({high} - {low}), 0)), '{WATER}')"
    );
    filled(&tint, INPUT)
}

/// A tint for each range of depths, from light to dark.
fn flood() -> String {
    filled(
        &format!(
            "with_variable('all', array_sort(array_distinct(array_agg(depth_from))), ramp_color(create_ramp(map({DEPTHS})), \
             array_find(@all, depth_from) / max(1, array_length(@all) - 1)))"
        ),
        "8,81,156,255",
    )
}

/// Areas filled with the colour that an expression gives.
fn filled(colour: &str, outline: &str) -> String {
    let properties = [("color", WATER), ("style", "solid"), ("outline_color", outline), ("outline_width", "0.1")];
    let fill = format!(
        "<data_defined_properties><Option type=\"Map\"><Option type=\"QString\" name=\"name\" value=\"\"/>\
         <Option type=\"Map\" name=\"properties\"><Option type=\"Map\" name=\"fillColor\"><Option type=\"bool\" name=\"active\" value=\"true\"/>\
         <Option type=\"QString\" name=\"expression\" value=\"{colour}\"/><Option type=\"int\" name=\"type\" value=\"3\"/></Option></Option>\
         <Option type=\"QString\" name=\"type\" value=\"collection\"/></Option></data_defined_properties></layer>"
    );
    format!(
        "{HEAD}<qgis version=\"3.22\" styleCategories=\"Symbology\">\n<renderer-v2 type=\"singleSymbol\" symbollevels=\"0\" forceraster=\"0\" \
         enableorderby=\"0\">\n<symbols>\n{}</symbols>\n</renderer-v2>\n</qgis>\n",
        symbol("fill", 0, "SimpleFill", &properties).replace("</layer>", &fill)
    )
}

fn findings() -> String {
    let mut text = format!("{HEAD}<qgis version=\"3.22\" styleCategories=\"Symbology|MapTips\">\n");
    text.push_str(
        "<renderer-v2 type=\"categorizedSymbol\" attr=\"severity\" symbollevels=\"0\" forceraster=\"0\" enableorderby=\"0\">\n<categories>\n",
    );
    for (k, (name, _)) in SEVERITIES.iter().enumerate() {
        let _ = writeln!(
            text,
            "<category symbol=\"{k}\" value=\"{name}\" label=\"{name}\" render=\"true\" type=\"string\"/>"
        );
    }
    text.push_str("</categories>\n<symbols>\n");
    for (k, (_, color)) in SEVERITIES.iter().enumerate() {
        let properties = [
            ("name", "circle"),
            ("color", *color),
            ("outline_color", "255,255,255,255"),
            ("outline_style", "solid"),
            ("size", "2.8"),
            ("size_unit", "MM"),
        ];
        text.push_str(&symbol("marker", k, "SimpleMarker", &properties));
    }
    text.push_str(
        "</symbols>\n</renderer-v2>\n<mapTip>&lt;b>[% \"code\" %]&lt;/b>&lt;br>[% \"message\" %]</mapTip>\n</qgis>\n",
    );
    text
}
