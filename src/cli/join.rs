//! `tokosen join`: joins the results of the tasks of a plan.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::Input;
use tokosen::base::ElevationUnit;
use tokosen::io::raster::{RasterParams, write_rows};
use tokosen::io::{PlannedOutput, StagedOutput, write_layers_back};
use tokosen::raster::RasterRows;
use tokosen::tiling::{Folder, Mosaic, joined_lines};

use super::console::Console;
use super::densify::describe;
use super::extensions::{check_vector, open_raster};
use super::failure::Failure;
use super::height_map::CogArgs;
use super::levels::output_layers;
use super::plane::ToCrsArgs;
use super::summary;

/// Join the results of the tasks of a plan
///
/// Lines go on across the borders of tiles, contours of the input come back vertex for vertex, and the height map is one raster. The
/// attributes of the lines are those of 'tokosen densify'.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct JoinArgs {
    /// Folder of the plan
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Contour lines to write: .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Height map to write: .tif, .exr, .png, .asc or .xyz
    #[arg(long, value_name = "FILE")]
    dem: Option<PathBuf>,
    #[command(flatten)]
    cog: CogArgs,
    #[command(flatten)]
    to_crs: ToCrsArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen join plan -o dense.gpkg --dem dem.tif
  tokosen join plan --dem dem.tif --cog";

/// Runs the verb.
pub fn run(args: &JoinArgs, console: &Console) -> Result<(), Failure> {
    let folder = Folder::open(&args.folder)?;
    if args.output.is_none() && args.dem.is_none() {
        let message = "name what to write: -o FILE for the lines, --dem FILE for the height map, or both";
        return Err(Failure::Usage(message.into()));
    }
    folder.check_wanted(args.output.is_some(), args.dem.is_some())?;
    let unit = folder.manifest.unit();
    let names: Vec<String> =
        folder.manifest.levels().iter().flat_map(|l| &l.targets).map(|target| target.layer_name(unit)).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    args.check(&names, console)?;
    console.plan(["joining lines", "writing"]);
    let lines = args.output.as_deref().map(StagedOutput::create).transpose()?;
    let dem = args.dem.as_deref().map(open_raster).transpose()?;
    let joined = joined_lines(&folder, console)?;
    let mut about = Input::default();
    about.reprojection.clone_from(&joined.reprojection);
    console.set_input(&about);
    let back = args.to_crs.way(args.output.as_deref(), &joined.reprojection, unit)?;
    let written = match &lines {
        Some(staged) => console.step("writing", || {
            write_layers_back(staged, &output_layers(&joined.layers, None, &names, &back), &back)
        })?,
        None => Vec::new(),
    };
    let heights = dem.as_ref().map(|staged| args.write_heights(&folder, staged, unit, console)).transpose()?;
    summary::findings(&joined.findings, console);
    console.say(&format!(
        "plan       {}: {} tiles of {}",
        args.folder.display(),
        folder.manifest.tasks.len(),
        folder.manifest.input
    ));
    if let Some(staged) = lines {
        staged.commit()?;
        console.say(&format!(
            "seams      lines go on at {} places; largest distance between two ends there {:.3}{}",
            joined.seams,
            joined.furthest,
            folder.manifest.working_crs().map_or("", |_| " m")
        ));
        for (k, layer) in joined.layers.iter().enumerate() {
            describe(written.get(k).or(written.first()), layer, &back, console);
        }
    }
    if let (Some(staged), Some([cols, rows])) = (dem, heights) {
        let path = staged.commit()?;
        console.say(&format!("written    {} ({cols} x {rows} cells)", path.display()));
    }
    summary::close(joined.findings.len(), console);
    Ok(())
}

impl JoinArgs {
    /// Checks the paths of the outputs.
    fn check(&self, names: &[&str], console: &Console) -> Result<(), Failure> {
        if let Some(path) = &self.output {
            check_vector(
                path,
                "contour lines are written as .geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz",
            )?;
            self.to_crs.check(path)?;
        }
        self.cog.check(self.dem.as_deref())?;
        if self.to_crs.to_crs.is_some() && self.output.is_none() {
            return Err(Failure::Usage("--to-crs applies to lines (-o); the height map is in the working CRS".into()));
        }
        let lines = self.output.iter().map(|path| PlannedOutput { path, layers: names });
        let outputs: Vec<PlannedOutput<'_>> = lines.chain(self.dem.as_deref().map(PlannedOutput::from)).collect();
        let manifest: &Path = &self.folder.join("manifest.json");
        Ok(console.check_paths(&[manifest], &outputs)?)
    }

    /// Writes the height map, still under its temporary name. Returns the number of columns and rows.
    fn write_heights(
        &self,
        folder: &Folder,
        staged: &StagedOutput,
        unit: ElevationUnit,
        console: &Console,
    ) -> Result<[usize; 2], Failure> {
        let params = RasterParams { tiff: self.cog.layout(), unit, ..RasterParams::default() };
        let mosaic = Mosaic::open(folder)?;
        let written = console.step("writing", || write_rows(&staged.path(), &mosaic, &params));
        written.map_err(|e| staged.with_final_name(e))?;
        let grid = mosaic.grid();
        Ok([grid.cols, grid.rows])
    }
}
