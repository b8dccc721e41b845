//! Reads and writes vector files: GeoJSON, GeoPackage, FlatGeobuf, GeoParquet, DXF, shapefile and KML. The file's extension
//! selects the format. GML, GeoJSON text sequences, tables of well-known text, zipped shapefiles and files of 基盤地図情報 are read
//! only.
//!
//! Reading: file → table of features → elevations. Each format has a file that fills the table. One place decides which
//! attribute holds the elevation. Writing: lines → layers of features → file. Every format but KML, which is for viewers,
//! preserves the vertices bit for bit.
//!
//! Outputs are written through [`StagedOutput`]: a file appears complete or not at all.

mod abandoned;
mod area;
mod attributes;
mod coast;
mod companions;
mod content;
mod crs_finding;
mod depression;
mod dxf;
mod elevation;
mod elevation_names;
mod file_box;
mod flatgeobuf;
pub mod fonts;
mod format;
mod geojson;
mod geoparquet;
mod gml;
mod gpkg;
pub mod gsi;
mod in_memory;
mod kml;
mod landxml;
pub mod layer;
mod lines;
mod maker;
pub mod mesh;
mod meter;
mod ordinary;
mod paths;
mod places;
mod plates;
pub mod raster;
mod shapefile;
mod sinks;
mod staged;
mod table;
mod text;
mod text_points;
pub mod tiles;
mod unit_words;
mod vector_source;
mod water;
mod wkt;
mod xml;
mod zipped;

use std::path::{Path, PathBuf};

use geo::MultiPolygon;

use format::InputFormat;
use layer::{Layer, ReprojectedShapes};
use table::{Purpose, Request, Table};
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Error, Report, Result};
use tokosen_core::contour::{ContourLayer, ContourMap, SpotHeights, StatedUnit};
use tokosen_core::crs::{Crs, FromWorking, Reprojection};
use tokosen_core::features::{Features, Role};
use tokosen_core::subdomains::{Landform, Regions};
use tokosen_core::tin::Tin;

pub use content::{Content, content};
pub use file_box::FileBox;
pub use format::VectorFormat;
pub use in_memory::{Attribute, InMemory, MemoryLayer};
pub use maker::SAVED_RUN;
pub use ordinary::{open_to_read, read_small};
pub use paths::{PlannedOutput, check_paths, files_of_input};
pub use places::{Paths, Places, read_paths, read_places};
pub use plates::{PLATE_EXTENSIONS, sheet_files, write_plates};
pub use staged::{StagedOutput, discard_unfinished};
pub use vector_source::VectorSource;

/// The EPSG code of WGS 84.
const WGS84: u32 = 4326;

/// How to read a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// The name of the attribute that holds the elevation, in any letter case. `z` also selects the z coordinate if no
    /// attribute has that name. If `None`, the reader looks for known attribute names and then for the z coordinate.
    pub elevation_field: Option<String>,
    /// The layer of a GeoPackage that has several layers. For a DXF: one layer or several, separated by commas. For a GML:
    /// the type of the features. For zipped shapefiles: the name of one.
    pub layer: Option<String>,
    /// The box that features must meet, in the coordinates of the file. Of a GeoPackage, a FlatGeobuf and a GeoParquet, only what
    /// may meet it is read, if the file has an index. No features are left out if `None`.
    pub within: Option<FileBox>,
    /// Memory limit, bytes. A file that needs more is refused. No limit if `None`.
    pub memory: Option<u64>,
    /// Features in memory, which are read instead of the file. The path is then their name in messages.
    pub features: Option<InMemory>,
    /// The unit that the caller will take the elevations to be in. Then units that the file states beside them do not count.
    pub unit: Option<ElevationUnit>,
    /// Whether the named attribute, or else attributes with names of depths, hold depths. They are read as negative
    /// elevations.
    pub depths: bool,
}

/// Reads contour lines, and the spot heights that come with them.
///
/// A line of several parts becomes one contour per part, and so does each ring of a polygon that is at one elevation. Polygons
/// between two levels are no contours. Features that cannot be used are left out, each with a finding. A unit that an
/// attribute states for the elevations is in the map ([`ContourMap::stated_unit`]); where units differ, elevations are in
/// metres. A folder, a `.zip` and a `.xml` are read as files of 基盤地図情報 (see [`gsi`]). Their contours are cut at the
/// edges of grid squares; the ends meet there, and [`clean`](fn@tokosen_core::clean::clean) joins them. From a DXF, polylines,
/// lines and points are read, also in blocks. Arcs in polylines become chords that stay within 0.01 units.
///
/// # Errors
/// The file cannot be read, has no lines, or does not make clear where the elevations are. For a DXF also: all lines of
/// some layers lie at 0 and the caller names no layer.
pub fn read_contours(path: &Path, options: &ReadOptions) -> Result<Report<ContourMap>> {
    let table = read_table(path, options, Purpose::Contours)?;
    elevation::contour_map(path, table, options)
}

/// Reads points of known height, from a vector file or from text with columns (`.csv`, `.tsv`, `.txt`, `.xyz`). Text
/// names its columns in the first line: `x,y,z`, `lon,lat,elev` and the like; or it has three columns without names.
///
/// # Errors
/// The file cannot be read, has no points, or does not make clear where the heights are.
pub fn read_spot_heights(path: &Path, options: &ReadOptions) -> Result<Report<SpotHeights>> {
    let table = read_table(path, options, Purpose::Spots)?;
    elevation::spot_heights(path, table, options)
}

/// Reads the area inside the polygons of a boundary file. Also gives the coordinate reference system if the file names
/// one.
///
/// The polygons of all features together are one area. Polygons that overlap or share an edge are united; this may move
/// their vertices by a billionth of their size. All other polygons keep their vertices bit for bit. Lines and points in
/// the file are ignored. In a DXF each closed polyline is a polygon, and none is a hole in another.
///
/// # Errors
/// One of these is the case:
/// - The file cannot be read or has no polygon.
/// - A ring has fewer than four points (the last repeats the first), coordinates that are not finite, or no area.
/// - A ring crosses itself or another ring of its polygon.
pub fn read_area(path: &Path, options: &ReadOptions) -> Result<(MultiPolygon<f64>, Option<Crs>)> {
    let mut table = read_table(path, options, Purpose::Area)?;
    let crs = table.crs.take();
    Ok((area::area(path, table)?, crs))
}

/// What a file holds in a role.
#[derive(Debug, Clone, Default)]
pub struct FileFeatures {
    /// The features, in the lists of their role.
    pub features: Features,
    /// Their coordinate reference system, if the file names one.
    pub crs: Option<Crs>,
    /// The unit that an attribute states for their heights.
    pub unit: Option<StatedUnit>,
}

/// Reads the features of a file in a role. A line of several parts becomes one feature per part. What cannot be one is a
/// finding.
///
/// | role | shapes | heights |
/// |---|---|---|
/// | coast | lines; rings of polygons of land or sea | of a line: an attribute with a known elevation name, otherwise the z coordinate if all vertices share it and it is not 0 |
/// | exclude | polygons; those that overlap or share an edge are united and get the number of the first | do not count |
/// | cliffs | lines | do not count |
/// | water | polygons | of a polygon: an attribute with a known elevation name, otherwise the z coordinate if all vertices share it |
/// | streams | lines, and polygons of river areas; of a GeoPackage with both and without a named layer, the lines | do not count |
/// | break lines | lines; an attribute `kind` says how the ground bends: `ridge`, `valley`, or `edge` for either way | z coordinates, if z is not 0 everywhere in the file |
/// | sinks | points; polygons; those that overlap or share an edge are united and get the number of the first | do not count |
///
/// Files of 基盤地図情報 give their water areas (`WA`) without the rivers, and the pieces of one lake are united. If they have
/// no water areas, they give the closed shores of lakes (`WL`).
///
/// # Errors
/// The file cannot be read, has no feature of such a shape, or does not make clear where the heights are. For polygons: as
/// [`read_area`].
pub fn read_features(role: Role, path: &Path, options: &ReadOptions) -> Result<Report<FileFeatures>> {
    let mut table = read_table(path, options, Purpose::Features(role))?;
    let crs = table.crs.take();
    let mut features = Features::default();
    let mut unit = None;
    let mut findings = Vec::new();
    match role {
        Role::Coast => (features.coast, unit) = coast::coast(path, table, options)?.collect(&mut findings),
        Role::Exclude => features.excluded = area::excluded(path, table)?,
        Role::Cliffs => features.cliffs = lines::cliffs(path, table)?.collect(&mut findings),
        Role::Water => {
            findings.append(&mut table.findings);
            (features.lakes, unit) = water::lakes(path, table, options)?.collect(&mut findings);
        }
        Role::Streams => {
            (features.streams, features.river_areas) = lines::waterways(path, table)?.collect(&mut findings);
        }
        Role::BreakLines => features.break_lines = lines::break_lines(path, table)?.collect(&mut findings),
        Role::Sinks => features.sinks = sinks::sinks(path, table)?.collect(&mut findings),
    }
    Ok(Report { value: FileFeatures { features, crs, unit }, findings })
}

fn read_table(path: &Path, options: &ReadOptions, purpose: Purpose) -> Result<Table> {
    let mut table = read_whole_table(path, options, purpose)?;
    if let Some(within) = options.within {
        table.features.retain(|feature| within.meets(feature.sides()));
        // A feature without geometry meets no box.
        table.left_out.remove(table::NO_GEOMETRY);
        if table.features.is_empty() {
            let message = "no feature meets the box after |bbox=, which has the coordinates of the file";
            return Err(Error::file(path, message));
        }
    }
    Ok(table)
}

fn read_whole_table(path: &Path, options: &ReadOptions, purpose: Purpose) -> Result<Table> {
    let request = Request {
        elevation_field: options.elevation_field.as_deref(),
        layer: options.layer.as_deref(),
        purpose,
        within: options.within,
        memory: options.memory,
    };
    if let Some(features) = &options.features {
        return features.read(path, &request);
    }
    if gsi::is_source(path) {
        return gsi::read(path, &request);
    }
    if request.purpose == Purpose::Spots && text_points::is_source(path) {
        return text_points::read(path, &request);
    }
    let format = InputFormat::from_path(path)?;
    companions::check_input(path)?;
    let meta = std::fs::metadata(path).map_err(|e| Error::io("read", path, e))?;
    if meta.len() == 0 {
        return Err(Error::empty(path));
    }
    let has_layers = matches!(
        format,
        InputFormat::Written(VectorFormat::GeoPackage | VectorFormat::FlatGeobuf | VectorFormat::Dxf)
            | InputFormat::Gml
            | InputFormat::ZippedShapefile
    );
    if !has_layers {
        let stem = path.file_stem().and_then(|s| s.to_str());
        if let Some(layer) = request.layer.filter(|&layer| Some(layer) != stem) {
            return Err(Error::file(path, format!("there is no layer {layer:?}: files of this format have no layers")));
        }
    }
    match format {
        InputFormat::Written(VectorFormat::GeoJson) => geojson::read(path, &request),
        InputFormat::Written(VectorFormat::GeoPackage) => gpkg::read(path, &request),
        InputFormat::Written(VectorFormat::FlatGeobuf) => flatgeobuf::read(path, &request),
        InputFormat::Written(VectorFormat::GeoParquet) => geoparquet::read(path, &request),
        InputFormat::Written(VectorFormat::Dxf) => dxf::read(path, &request),
        InputFormat::Written(VectorFormat::Shapefile) => shapefile::read(path, &request),
        InputFormat::GeoJsonSequence => geojson::read_sequence(path, &request),
        InputFormat::Written(VectorFormat::Kml) => kml::read(path, &request),
        InputFormat::Gml => gml::read(path, &request),
        InputFormat::LandXml => landxml::read(path, &request),
        InputFormat::Text => text_points::read(path, &request),
        InputFormat::ZippedShapefile => zipped::read_shapefile(path, &request),
    }
}

/// Writes contour lines, in the format of the target's extension.
///
/// Lines are three-dimensional, z is the elevation. The attributes are `elev`, `source` (`input` or `interpolated`),
/// `is_index`, `depression` and `closed`. A DXF has no attributes except the layer's name, such as
/// `CONTOUR-INPUT-INDEX` or `CONTOUR-INTERPOLATED`, and does not name the coordinate reference system.
///
/// A GeoPackage and a KML hold all layers in one file. The other formats hold one layer per file; in a DXF, labels are texts in the
/// file of their contours. A single layer gets exactly
/// the target's name. Several layers are written beside each other as `STEM_SUFFIX.EXT`; the suffix is the layer's name
/// without a leading `contours_`. The returned paths are the final ones.
///
/// # Errors
/// One of these is the case:
/// - The extension is not known.
/// - A layer name is not valid, or two layers share one.
/// - A line has fewer than two points or a coordinate that is NaN.
/// - The data exceed a limit of the format.
/// - The disk is full.
pub fn write_contours(out: &StagedOutput, layers: &[ContourLayer], crs: Option<&Crs>) -> Result<Vec<PathBuf>> {
    let layers: Vec<Layer<'_>> = layers.iter().map(layer::of_contours).collect();
    write_layers(out, &layers, crs)
}

/// Writes the landforms of sub-domains as areas, in one layer `regions`, in the format of the target's extension.
///
/// The attributes are `id`, `class`, `is_open`, `band_lo`, `band_hi`, `n_ib`, `mixture`, `parent`, `depth` and `area`.
/// The vertices are those of the triangulation, bit for bit.
///
/// # Errors
/// As [`write_contours`].
pub fn write_landforms(
    out: &StagedOutput,
    forms: &[Landform],
    tin: &Tin,
    regions: &Regions,
    crs: Option<&Crs>,
) -> Result<Vec<PathBuf>> {
    write_layers(out, &[layer::of_landforms(forms, tin, regions)], crs)
}

/// Writes layers of features, in the format of the target's extension. A KML is in longitudes and latitudes on WGS 84.
///
/// Lines are three-dimensional, areas are not. Layers of one GeoPackage may differ in geometry and attributes. The
/// files are named as in [`write_contours`].
///
/// # Errors
/// As [`write_contours`], and if a feature breaks a rule of its type (see the types in [`layer`]).
pub fn write_layers(out: &StagedOutput, layers: &[Layer<'_>], crs: Option<&Crs>) -> Result<Vec<PathBuf>> {
    let names: Vec<&str> = layers.iter().map(|layer| layer.name).collect();
    let files = contour_files(out.target(), &names)?;
    layers.iter().try_for_each(layer::check)?;
    let format = VectorFormat::from_path(out.target())?;
    let is_plain = matches!(format, VectorFormat::FlatGeobuf | VectorFormat::Shapefile);
    if is_plain && layers.iter().any(|layer| layer.geometry == layer::Geometry::Points) {
        return Err(Error::file(out.target(), "points are written as .gpkg, .geojson or .parquet"));
    }
    if format == VectorFormat::Kml {
        return write_layers_back(out, layers, &Reprojection::unmoved(crs.cloned()).from_working(None)?);
    }
    if format == VectorFormat::GeoPackage {
        let target = if gpkg::is_there(out.target())? { Some(out.target()) } else { None };
        gpkg::write(&out.path(), layers, crs, target).map_err(|e| out.with_final_name(e))?;
        return Ok(files);
    }
    if format == VectorFormat::Dxf {
        let is_bare = |layer: &Layer<'_>| {
            layer.geometry == layer::Geometry::Points && layer.columns.iter().all(|column| column.name != "text")
        };
        if layers.iter().any(is_bare) {
            return Err(Error::file(out.target(), "points are written as .gpkg, .geojson or .parquet"));
        }
        // Points are texts beside the lines of the layer before.
        for (group, file) in layers.chunk_by(|_, next| next.geometry == layer::Geometry::Points).zip(&files) {
            let path = out.sibling(file.file_name().unwrap_or_default());
            dxf::write(&path, group, crs).map_err(|e| out.with_final_name(e))?;
        }
        return Ok(files);
    }
    for (layer, file) in layers.iter().zip(&files) {
        let path = out.sibling(file.file_name().unwrap_or_default());
        let written = match format {
            VectorFormat::GeoJson => geojson::write(&path, layer, crs),
            VectorFormat::GeoPackage => gpkg::write(&path, std::slice::from_ref(layer), crs, None),
            VectorFormat::FlatGeobuf => flatgeobuf::write(&path, layer, crs),
            VectorFormat::GeoParquet => geoparquet::write(&path, layer, crs),
            VectorFormat::Dxf => dxf::write(&path, std::slice::from_ref(layer), crs),
            VectorFormat::Shapefile => shapefile::write(&path, layer, crs),
            VectorFormat::Kml => kml::write(&path, std::slice::from_ref(layer), ElevationUnit::Metre),
        };
        written.map_err(|e| out.with_final_name(e))?;
    }
    Ok(files)
}

/// Writes layers of features in the coordinates and the unit of heights that `back` converts to. Vertices of the input
/// get their input coordinates back, bit for bit. Of the attributes, only heights and their errors change: lengths and
/// areas stay those of the working plane.
///
/// A KML is in longitudes and latitudes on WGS 84, whatever the system is that `back` converts to.
///
/// # Errors
/// As [`write_layers`], and if a vertex has no coordinates in that system.
pub fn write_layers_back(out: &StagedOutput, layers: &[Layer<'_>], back: &FromWorking) -> Result<Vec<PathBuf>> {
    if VectorFormat::from_path(out.target())? == VectorFormat::Kml {
        let back = back.to(&Crs::from_epsg(WGS84))?;
        return with_layers_back(layers, &back, |layers| write_kml(out, layers, back.unit()));
    }
    with_layers_back(layers, back, |layers| write_layers(out, layers, back.crs()))
}

/// Writes layers on WGS 84 with heights in `unit`.
fn write_kml(out: &StagedOutput, layers: &[Layer<'_>], unit: ElevationUnit) -> Result<Vec<PathBuf>> {
    layers.iter().try_for_each(layer::check)?;
    kml::write(&out.path(), layers, unit).map_err(|e| out.with_final_name(e))?;
    Ok(vec![out.target().to_owned()])
}

/// Calls `take` with layers of features in the coordinates and the unit of heights that `back` converts to, as
/// [`write_layers_back`] writes them.
///
/// # Errors
/// If a vertex has no coordinates in that system, and as `take`.
pub fn with_layers_back<T>(
    layers: &[Layer<'_>],
    back: &FromWorking,
    take: impl FnOnce(&[Layer<'_>]) -> Result<T>,
) -> Result<T> {
    if back.is_identity() && !back.unit().is_foot() && !back.has_depths() {
        return take(layers);
    }
    let mut reprojected = ReprojectedShapes::new(layers, back)?;
    take(&reprojected.layers(layers))
}

/// The files that [`write_contours`] and [`write_layers`] write for layers of these names. The caller can check them
/// before the computation.
///
/// # Errors
/// The extension is not known, a layer name is not valid, or two layers share one.
pub fn contour_files(target: &Path, layers: &[&str]) -> Result<Vec<PathBuf>> {
    layer::check_names(layers)?;
    let mut layers = layers.to_vec();
    match VectorFormat::from_path(target)? {
        VectorFormat::GeoPackage | VectorFormat::Kml => return Ok(vec![target.to_owned()]),
        VectorFormat::Dxf => layers.retain(|name| !name.starts_with(layer::LABELS_LAYER)),
        VectorFormat::GeoJson | VectorFormat::FlatGeobuf | VectorFormat::GeoParquet | VectorFormat::Shapefile => {}
    }
    Ok(layers.iter().map(|name| target.with_file_name(layer::file_name(target, name, layers.len()))).collect())
}
