//! One document of a height map: its grid square, its grid and the heights of its cells.
//!
//! A document lists its cells from its start point, which is given after the list. The list may end early. The cells
//! before and after it have no data, as in squares that are mostly sea.

use std::path::{Path, PathBuf};

use super::archive::item_of;
use super::datum::Datums;
use super::mesh::{Mesh, cells_per_degree};
use super::product::Product;
use super::tuples::TupleList;
use crate::meter::DocumentReader;
use crate::xml::{Step, Xml};
use tokosen_core::base::error::{Error, Result};

/// The name of the root element of every document.
const ROOT: &str = "Dataset";

/// The heights of one square.
pub(super) struct Tile {
    /// Name of the document, for messages.
    pub path: PathBuf,
    pub code: String,
    pub mesh: Mesh,
    pub product: Product,
    /// The publication date, as year-month-day.
    pub date: String,
    pub cols: usize,
    /// Index of the cell of the first height, counted row by row from the north-west.
    pub start: usize,
    /// Heights from that cell on, metres; NaN where there is none.
    pub heights: Vec<f32>,
}

/// The content of a height map that was read so far.
#[derive(Default)]
struct PartialTile {
    kind: String,
    code: String,
    date: String,
    corners: [String; 2],
    low: String,
    high: String,
    start: String,
    grid: Option<TileGrid>,
    heights: Vec<f32>,
}

/// What must be known before the heights are read.
#[derive(Clone, Copy)]
struct TileGrid {
    mesh: Mesh,
    product: Product,
    cols: usize,
    rows: usize,
}

/// Appends the height maps of a document.
pub(super) fn read(
    path: &Path,
    source: &mut DocumentReader<'_>,
    datums: &mut Datums,
    tiles: &mut Vec<Tile>,
) -> Result<()> {
    let mut xml = Xml::new(path, source)?;
    let mut partial: Option<PartialTile> = None;
    let mut text = String::new();
    loop {
        match xml.next()? {
            Step::Start => {
                check_root(&xml)?;
                text.clear();
                if xml.depth() == 2 && xml.name() == "DEM" {
                    partial = Some(PartialTile::default());
                }
                let Some(partial) = &mut partial else { continue };
                if let Some(name) = xml.attribute("srsName") {
                    datums.note(path, name)?;
                }
                if let Some(order) = xml.attribute("order").filter(|order| *order != "+x-y") {
                    let message =
                        format!("its cells are in the order {order:?}; only +x-y is known, row by row southwards");
                    return Err(xml.error(message));
                }
                if xml.name() == "tupleList" {
                    let grid = partial.grid(path)?;
                    partial.grid = Some(grid);
                    partial.heights = tuple_list(&mut xml, grid.cols * grid.rows)?;
                }
            }
            // Long texts are never needed here.
            Step::Text if partial.is_some() && text.len() < 1000 => text.push_str(xml.text()),
            Step::Text => {}
            Step::End if xml.depth() == 1 && xml.name() == "DEM" => {
                tiles.extend(partial.take().map(|partial| partial.tile(path)).transpose()?);
            }
            Step::End => {
                if let Some(field) = partial.as_mut().and_then(|partial| partial.field(xml.name())) {
                    text.trim().clone_into(field);
                }
                text.clear();
            }
            Step::Over => return Ok(()),
        }
    }
}

/// Refuses other kinds of XML.
pub(super) fn check_root(xml: &Xml<'_, '_>) -> Result<()> {
    if xml.depth() == 1 && xml.name() != ROOT {
        if !xml.name().chars().all(|c| c.is_alphanumeric() || "-_.:".contains(c)) {
            return Err(Error::file(xml.path(), "is not an XML document, despite its extension"));
        }
        let message = format!("its root element is {:?}, that of 基盤地図情報 is {ROOT:?}", xml.name());
        return Err(xml.error(message));
    }
    Ok(())
}

/// Reads the list whose start tag was just read.
fn tuple_list(xml: &mut Xml<'_, '_>, cells: usize) -> Result<Vec<f32>> {
    let path = xml.path();
    let wrong = |message: String| Error::file(path, message);
    let mut list = TupleList::new(cells);
    xml.raw_text(|bytes| list.read(bytes).map_err(wrong))?;
    loop {
        match xml.next()? {
            // The text continues after a comment.
            Step::Text => list.read(xml.text().as_bytes()).map_err(wrong)?,
            Step::End => break,
            Step::Start | Step::Over => return Err(xml.error("there is an element among the cells of the tuple list")),
        }
    }
    list.finish().map_err(wrong)?;
    Ok(list.heights)
}

impl PartialTile {
    fn field(&mut self, name: &str) -> Option<&mut String> {
        Some(match name {
            "type" => &mut self.kind,
            "mesh" => &mut self.code,
            "timePosition" if self.date.is_empty() => &mut self.date,
            "lowerCorner" => &mut self.corners[0],
            "upperCorner" => &mut self.corners[1],
            "low" => &mut self.low,
            "high" => &mut self.high,
            "startPoint" => &mut self.start,
            _ => return None,
        })
    }

    fn grid(&self, path: &Path) -> Result<TileGrid> {
        let wrong = |message: String| Error::file(path, message);
        let mesh = Mesh::of_code(&self.code)
            .ok_or_else(|| wrong(format!("the mesh code {:?} is not known; one has 4, 6 or 8 digits", self.code)))?;
        if self.low != "0 0" {
            return Err(wrong(format!("its grid begins at {:?} instead of 0 0", self.low)));
        }
        let size = pair::<u64>(&self.high).filter(|high| high.iter().all(|&high| high < 1 << 20));
        let [cols, rows] =
            size.ok_or_else(|| wrong(format!("its grid ends at {:?}, which is not a cell", self.high)))?;
        let [cols, rows] = [cols + 1, rows + 1];
        let item = path.to_str().and_then(|name| item_of(name.rsplit(['/', '\\', '!']).next().unwrap_or(name)));
        let product = cells_per_degree(&mesh, cols, rows).and_then(|n| Product::of(item.as_deref(), &self.kind, n));
        let product = product.ok_or_else(|| {
            wrong(format!("{cols} x {rows} cells in the mesh {} are none of the known products", self.code))
        })?;
        let tolerance = 0.5 / product.cells_per_degree() as f64;
        for (stated, expected) in self.corners.iter().zip(mesh.corners()) {
            let agrees = pair::<f64>(stated)
                .is_some_and(|found| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < tolerance));
            if !agrees {
                let [lat, lon] = expected;
                let message = format!(
                    "it states the corner {stated:?}, but that of its mesh {} is {lat:.9} {lon:.9}; one of the two is wrong",
                    self.code
                );
                return Err(wrong(message));
            }
        }
        // Both are below the limit that was checked above.
        Ok(TileGrid { mesh, product, cols: cols as usize, rows: rows as usize })
    }

    fn tile(self, path: &Path) -> Result<Tile> {
        let wrong = |message: String| Error::file(path, message);
        let Some(TileGrid { mesh, product, cols, rows }) = self.grid else {
            return Err(wrong("there is no tuple list in it".to_owned()));
        };
        let (cells, count) = (cols * rows, self.heights.len());
        let start = match pair::<usize>(&self.start) {
            Some([x, y]) if x < cols && y < rows => y * cols + x,
            None if self.start.is_empty() && count == cells => 0,
            _ => {
                let message = format!("its start point {:?} is not one of its {cols} x {rows} cells", self.start);
                return Err(wrong(message));
            }
        };
        if start + count > cells {
            let message = format!(
                "the tuple list has {count} cells; from its start point {:?} on the grid has {}",
                self.start,
                cells - start
            );
            return Err(wrong(message));
        }
        let (code, date, path) = (self.code, self.date, path.to_owned());
        Ok(Tile { path, code, mesh, product, date, cols, start, heights: self.heights })
    }
}

/// Two numbers with white space between.
fn pair<T: std::str::FromStr>(text: &str) -> Option<[T; 2]> {
    let mut numbers = text.split_ascii_whitespace().map(str::parse);
    match (numbers.next(), numbers.next(), numbers.next()) {
        (Some(Ok(a)), Some(Ok(b)), None) => Some([a, b]),
        _ => None,
    }
}
