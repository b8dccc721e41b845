//! Reads 基盤地図情報, the base map of the Geospatial Information Authority of Japan (GSI). GSI provides it as XML: contours,
//! spot heights, water edges and height maps.
//!
//! Every function takes a `.xml` document, a `.zip` archive as downloaded (it may contain archives) or a folder of
//! them. All relevant documents are read as one map. Coordinates are longitude and latitude in JGD2000 (EPSG:4612) or
//! JGD2011 (EPSG:6668). The latter code also stands for JGD2024, which changed heights but not coordinates.
//!
//! | module | what it does |
//! |---|---|
//! | `archive` | the documents of a path |
//! | `datum` | coordinate reference systems |
//! | `mesh` | mesh codes |
//! | `dem`, `tuples` | a height map of one square |
//! | `mosaic` | joins the squares |
//! | `features` | contours, spot heights, water |

pub(super) mod archive;
mod datum;
mod dem;
mod features;
mod mesh;
mod mosaic;
mod product;
mod tuples;

use std::io::Read;
use std::path::Path;

pub(super) use features::read;
pub use product::Product;

use crate::landxml::is_landxml;
use crate::meter::DocumentReader;
use crate::xml::unreadable;
use crate::zipped;
use archive::{each_document, has_extension, item_of, nothing};
use datum::Datums;
use tokosen_core::base::error::{Report, Result};
use tokosen_core::crs::HeightSystem;
use tokosen_core::raster::Dem;

/// The content of a document is recognised from this many bytes.
const BEGINNING: u64 = 4096;

/// Whether a path is read as files of 基盤地図情報: a folder, a `.xml`, or a `.zip` that is not a zipped shapefile.
pub(super) fn is_source(path: &Path) -> bool {
    has_extension(path, "xml") && !is_landxml(path)
        || has_extension(path, "zip") && !zipped::is_shapefile(path)
        || path.is_dir()
}

/// A height map and its product.
#[derive(Debug, Clone, PartialEq)]
pub struct GsiDem {
    /// The heights, in degrees of longitude and latitude.
    pub dem: Dem,
    /// The product that the heights come from.
    pub product: Product,
    /// The height system, if the documents name one.
    pub height_system: Option<HeightSystem>,
}

/// Whether a path has documents of height maps and none of contours.
pub(super) fn is_height_map(path: &Path) -> Result<bool> {
    let (mut has_heights, mut has_contours) = (false, false);
    let wanted = |item: &str| item.starts_with("DEM") || item == "Cntr";
    let mut look = |name: &Path, source: &mut DocumentReader<'_>| {
        let document = name.to_string_lossy();
        let item = item_of(document.rsplit(['/', '\\', '!']).next().unwrap_or_default());
        match item.as_deref() {
            Some("Cntr") => has_contours = true,
            Some(item) if item.starts_with("DEM") => has_heights = true,
            // The name does not give the item; the first bytes do.
            _ => {
                let mut start = Vec::new();
                source.take(BEGINNING).read_to_end(&mut start).map_err(|e| unreadable(name, e))?;
                let has = |element: &[u8]| start.windows(element.len()).any(|w| w == element);
                has_heights |= has(b"<DEM");
                has_contours |= has(b"<Cntr");
            }
        }
        Ok(())
    };
    each_document(path, &wanted, &mut look)?;
    Ok(has_heights && !has_contours)
}

/// Reads all height maps of a path as one mosaic of squares. Cells are NaN if their square has no height there or is
/// missing.
///
/// Heights are kept, those of inland water too. If a square occurs twice, the newer one overwrites the older one, with
/// a finding.
///
/// # Errors
/// One of these is the case:
/// - A document cannot be read or contradicts itself.
/// - There is no height map, or there are several products.
/// - The box around all squares has more than 2^30 cells.
pub fn read_dem(path: &Path) -> Result<Report<GsiDem>> {
    let (mut datums, mut tiles, mut findings) = (Datums::default(), Vec::new(), Vec::new());
    let wanted = |item: &str| item.starts_with("DEM");
    let report = each_document(path, &wanted, &mut |path, source| dem::read(path, source, &mut datums, &mut tiles))?;
    if tiles.is_empty() {
        return Err(nothing(path, &report, "height map (DEM1A, DEM5A, DEM5B, DEM5C, DEM10A, DEM10B)"));
    }
    report.note_repeated(&mut findings);
    let (mut dem, product) = mosaic::mosaic(path, tiles, &mut findings)?;
    let height_system = datums.height_system(&mut findings);
    dem.crs = datums.crs(&mut findings);
    Ok(Report { value: GsiDem { dem, product, height_system }, findings })
}
