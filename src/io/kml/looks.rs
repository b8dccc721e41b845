//! How features look in KML.

use std::io::{Result as Written, Write};

use crate::layer::{Cell, Geometry, Layer, Row};

/// How a feature looks, and the folder that it is in. They are in the order of the folders.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Look {
    /// A contour.
    Contour { kind: ContourKind, is_new: bool },
    /// A label: a text without a symbol.
    Label,
    /// A line of some other kind.
    Line(String),
    /// An area of some kind.
    Area(String),
}

/// The kind of a contour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ContourKind {
    Index,
    Intermediate,
    Supplementary,
}

/// Colours as KML has them: opacity, blue, green, red. Contours must be seen on pictures of forests and of snow.
const GIVEN: &str = "ff0b4fb4";
const NEW: &str = "ff2d8ff0";
const RIDGE: &str = "ff2f5fd0";
const CANYON: &str = "ffd08030";
const OTHER: &str = "ff8030d0";

impl Look {
    pub fn of(layer: &Layer<'_>, row: &Row<'_>) -> Self {
        let cell = |name: &str| {
            let place = layer.columns.iter().position(|column| column.name == name)?;
            row.cells.get(place)
        };
        let kind = ["kind", "class"].into_iter().find_map(|name| match cell(name) {
            Some(Cell::Text(text)) if !text.is_empty() => Some(text.to_string()),
            _ => None,
        });
        match (layer.geometry, cell("is_index")) {
            (Geometry::Points, _) => Self::Label,
            (Geometry::Areas, _) => Self::Area(kind.unwrap_or_else(|| "area".to_owned())),
            (Geometry::Lines, Some(Cell::Bool(is_index))) => Self::Contour {
                kind: match kind {
                    _ if *is_index => ContourKind::Index,
                    Some(kind) if kind.starts_with("supplementary") => ContourKind::Supplementary,
                    _ => ContourKind::Intermediate,
                },
                is_new: !matches!(cell("source"), Some(Cell::Text(source)) if source == "input"),
            },
            (Geometry::Lines, _) => Self::Line(kind.unwrap_or_else(|| "line".to_owned())),
        }
    }

    /// The name of its style.
    pub fn id(&self) -> String {
        self.title().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect()
    }

    /// The name of its folder.
    pub fn title(&self) -> String {
        match self {
            Self::Contour { kind: ContourKind::Index, is_new: false } => "index contours of the input".to_owned(),
            Self::Contour { kind: ContourKind::Index, is_new: true } => "index contours".to_owned(),
            Self::Contour { kind: ContourKind::Intermediate, is_new: false } => "contours of the input".to_owned(),
            Self::Contour { kind: ContourKind::Intermediate, is_new: true } => "contours".to_owned(),
            Self::Contour { kind: ContourKind::Supplementary, is_new: false } => {
                "supplementary contours of the input".to_owned()
            }
            Self::Contour { kind: ContourKind::Supplementary, is_new: true } => "supplementary contours".to_owned(),
            Self::Label => "labels".to_owned(),
            Self::Line(kind) | Self::Area(kind) => escaped(kind),
        }
    }

    /// Writes its style.
    pub fn write(&self, out: &mut impl Write) -> Written<()> {
        let id = self.id();
        let line =
            |color: &str, width: f64| format!("<LineStyle><color>{color}</color><width>{width}</width></LineStyle>");
        let style = match self {
            Self::Contour { kind, is_new } => {
                let width = match kind {
                    ContourKind::Index => 2.5,
                    ContourKind::Intermediate => 1.2,
                    ContourKind::Supplementary => 0.7,
                };
                line(if *is_new { NEW } else { GIVEN }, width)
            }
            Self::Label => format!(
                "<IconStyle><scale>0</scale></IconStyle><LabelStyle><color>{GIVEN}</color><scale>0.8</scale></LabelStyle>"
            ),
            Self::Line(kind) if kind == "ridge" => line(RIDGE, 1.5),
            Self::Line(kind) if kind == "canyon" => line(CANYON, 1.5),
            Self::Line(_) => line(OTHER, 1.5),
            // The ground stays visible below an area.
            Self::Area(_) => format!("{}<PolyStyle><color>50{}</color></PolyStyle>", line(OTHER, 1.2), &OTHER[2..]),
        };
        writeln!(out, "<Style id=\"{id}\">{style}</Style>")
    }
}

/// Text that may stand in XML. Signs that XML cannot hold become spaces.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' => out.push(c),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
