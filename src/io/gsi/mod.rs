//! 基盤地図情報, the base map that the Geospatial Information Authority of Japan (GSI) serves as XML: contours, spot
//! heights, water edges and height maps.
//!
//! Every function takes a `.xml` document, a `.zip` archive as it is served (archives in archives too) or a folder of
//! them, and reads all documents of use as one map. Coordinates come as longitude and latitude in JGD2000 (EPSG:4612) or in
//! JGD2011 (EPSG:6668); the latter code also stands for JGD2024, which changed no coordinates but heights.
//!
//! | module | what it does |
//! |---|---|
//! | `archive` | the documents of a path |
//! | `meter` | limits on what an archive unpacks to |
//! | `xml` | the events of a document |
//! | `datum` | coordinate reference systems |
//! | `mesh` | mesh codes |
//! | `dem`, `tuples` | a height map of one square |
//! | `mosaic` | squares side by side |
//! | `features` | contours, spot heights, water |

mod archive;
mod datum;
mod dem;
mod features;
mod mesh;
mod meter;
mod mosaic;
mod product;
mod tuples;
mod xml;

use std::io::Read;
use std::path::Path;

pub(super) use features::read;
pub use product::Product;

use crate::base::error::{Report, Result};
use crate::dem::Dem;
use archive::{each_document, has_extension, item_of, nothing};
use datum::Datums;
use meter::Source;
use xml::unreadable;

/// So many bytes of a document tell what it holds.
const BEGINNING: u64 = 4096;

/// Whether a path is read as files of 基盤地図情報: a folder, a `.zip` or a `.xml`.
pub(super) fn is_source(path: &Path) -> bool {
    ["xml", "zip"].iter().any(|extension| has_extension(path, extension)) || path.is_dir()
}

/// A height map with the product it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct GsiDem {
    /// The heights, in degrees of longitude and latitude.
    pub dem: Dem,
    /// What it was made from.
    pub product: Product,
}

/// Whether a path has documents of height maps and none of contours.
pub(super) fn is_height_map(path: &Path) -> Result<bool> {
    let (mut has_heights, mut has_contours) = (false, false);
    let wanted = |item: &str| item.starts_with("DEM") || item == "Cntr";
    let mut look = |name: &Path, source: &mut Source<'_>| {
        let document = name.to_string_lossy();
        let item = item_of(document.rsplit(['/', '\\', '!']).next().unwrap_or_default());
        match item.as_deref() {
            Some("Cntr") => has_contours = true,
            Some(item) if item.starts_with("DEM") => has_heights = true,
            // The name says nothing; the beginning does.
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

/// Reads all height maps of a path as one, squares side by side; NaN where a square has no height or is missing.
///
/// Cells with a height keep it, also those of inland water. Where a square is there twice, the newer one is laid on top,
/// with a finding.
///
/// # Errors
/// If a document cannot be read or contradicts itself, if there is no height map, if there are several products, or if
/// the box around all squares has more than 2^30 cells.
pub fn read_dem(path: &Path) -> Result<Report<GsiDem>> {
    let (mut datums, mut tiles, mut findings) = (Datums::default(), Vec::new(), Vec::new());
    let wanted = |item: &str| item.starts_with("DEM");
    let seen = each_document(path, &wanted, &mut |path, source| dem::read(path, source, &mut datums, &mut tiles))?;
    if tiles.is_empty() {
        return Err(nothing(path, &seen, "height map (DEM1A, DEM5A, DEM5B, DEM5C, DEM10A, DEM10B)"));
    }
    seen.note_repeated(&mut findings);
    let (mut dem, product) = mosaic::mosaic(path, tiles, &mut findings)?;
    dem.crs = datums.crs(&mut findings);
    Ok(Report { value: GsiDem { dem, product }, findings })
}
