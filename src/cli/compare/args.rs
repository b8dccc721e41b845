//! The arguments of the verb.

use std::path::PathBuf;

use clap::Args;
use tokosen::io::VectorSource;

use crate::cli::height_map::GridArgs;
use crate::cli::input::InputArgs;
use crate::cli::picture::PictureArgs;
use crate::cli::source::source;
use crate::cli::surface::SurfaceArgs;
use crate::cli::vertical_shift::ShiftArgs;

/// Differences between two height maps or surfaces of contours
///
/// Differences are A − B, in metres: heights in feet become metres first. A and B are height maps or contours. The
/// surface of contours is evaluated at the cell centres of the other side. If two height maps have different grids, A
/// is interpolated at the cell centres of B.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
#[command(mut_arg("contours", |arg| arg.index(1).num_args(1).value_name("A").help(
    "What is compared: a height map (.tif, .asc, .exr, .png, .xyz, LandXML triangles) or contour lines (.gpkg, .geojson, .shp, .fgb, .parquet, .dxf, .kml, .gml, .csv and others), or a .xml, .zip or \
     folder of 基盤地図情報")))]
#[command(mut_arg("cell", |arg| arg.help("Cell size of the height map [units of the working CRS]; cells lie on multiples of it")))]
#[command(mut_arg("preview", |arg| arg.help(
    "Also draw the map of the differences with its figures on paper, with lines and text as vectors: .pdf or .svg")))]
#[command(mut_arg("points", |arg| arg.help(
    "Check points: points with an elevation, with which A and B are compared too")))]
pub struct CompareArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// The reference: a height map or contour lines
    #[arg(index = 2, value_name = "B", help_heading = "Input", value_parser = source())]
    pub b: VectorSource,
    /// Stated accuracy of the reference, as a standard deviation [m]; it decides which differences are significant
    /// [default: that of a product of 基盤地図情報]
    #[arg(long, value_name = "METRES", help_heading = "Input", hide_short_help = true)]
    pub sigma: Option<f64>,
    /// Contour interval at whose levels height maps are searched for terraces [m] [default: that of the contours,
    /// otherwise usual intervals are tried]
    #[arg(long, value_name = "METRES", help_heading = "Input", hide_short_help = true)]
    pub interval: Option<f64>,
    /// Also write the differences A − B: GeoTIFF (.tif), OpenEXR (.exr), 16-bit PNG (.png) and others
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub output: Option<PathBuf>,
    /// Print the figures as JSON instead of a table
    #[arg(long, help_heading = "Output")]
    pub json: bool,
    /// Also write a report with maps, charts and tables: .html
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub report: Option<PathBuf>,
    /// Also write a page that shows the terrain of A in 3-D with the differences as colours: .html
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub page: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Output")]
    pub picture: PictureArgs,
    #[command(flatten, next_help_heading = "Output")]
    pub grid: GridArgs,
    #[command(flatten, next_help_heading = "Input")]
    pub shift: ShiftArgs,
    #[command(flatten)]
    pub surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen compare contours.gpkg published_dem.tif --report compare.html
  tokosen compare mine.tif published_dem.tif --sigma 5 -o difference.tif
  tokosen compare contours.gpkg published_dem.tif --page differences.html
  tokosen compare contours.gpkg published_dem.tif --preview differences.pdf --scale 1:25000
  tokosen compare old.gpkg new.gpkg --cell 10 --json

Figures, in metres: bias, the mean of the differences d; RMSE; RMSE-b, the same after subtracting the bias; MAE, the
mean of |d|; median; NMAD, 1.4826 times the median of |d - median|; LE90 and LE95, which 90 % and 95 % of |d| do not
exceed.";
