//! What the verbs share. Before the work, paths are checked and outputs are opened. After it, findings and summary are
//! printed, and the files get their final names.

use std::path::{Path, PathBuf};

use geo::MultiPolygon;
use tokosen::base::ElevationUnit;
use tokosen::base::error::Finding;
use tokosen::contour::ContourMap;
use tokosen::io::PlannedOutput;
use tokosen::subdivision::Subdivision;
use tokosen::terrain::all_right;
use tokosen::{Input, Options, Terrain};

use super::console::Console;
use super::failure::Failure;
use super::features::WaterArgs;
use super::input::{InputArgs, Scope};
use super::picture::{Asked, Drawing, Picture};
use super::summary;
use super::surface::SurfaceArgs;

/// One run of a verb that reads contours.
pub struct Job<'a> {
    console: &'a Console,
    args: &'a InputArgs,
    picture: Option<Picture>,
}

impl<'a> Job<'a> {
    /// Checks the paths of all files, and opens the picture, if one is asked for. `inputs`: besides contours.
    pub fn start<'p>(
        args: &'a InputArgs,
        inputs: impl IntoIterator<Item = &'p Path>,
        outputs: impl IntoIterator<Item = impl Into<PlannedOutput<'p>>>,
        picture: Asked<'p>,
        console: &'a Console,
    ) -> Result<Self, Failure> {
        let files = args.map.files()?;
        let mut inputs: Vec<&Path> = inputs.into_iter().collect();
        inputs.extend(files.iter().map(PathBuf::as_path).chain(picture.font()));
        let mut outputs: Vec<PlannedOutput<'_>> = outputs.into_iter().map(Into::into).collect();
        outputs.extend(picture.file().map(PlannedOutput::from));
        console.check_paths(&inputs, &outputs)?;
        let picture = picture.open(&console.flags)?;
        let prepares = [(true, "reading"), (true, "cleaning"), (args.fit.is_some(), "fitting")];
        let steps = prepares.into_iter().chain([(args.sample.is_some(), "sampling"), (true, "triangulating")]);
        console.plan(steps.filter(|(is_done, _)| *is_done).map(|(_, step)| step));
        console.plan(picture.as_ref().map(|_| "drawing"));
        Ok(Self { console, args, picture })
    }

    /// Reads and prepares the contours.
    pub fn read(&self, scope: Scope<'_>) -> Result<Input, Failure> {
        self.args.read(scope, self.console)
    }

    /// Builds the surface between them.
    pub fn build(&self, input: &mut Input, surface: &SurfaceArgs, options: Options) -> Result<Terrain, Failure> {
        build(input, surface, &options, self.console)
    }

    /// Refuses findings that came after the surface, if `--strict` is set.
    pub fn check_strict(&self, findings: &[Finding]) -> Result<(), Failure> {
        match self.args.map.strict {
            true => {
                let checked = all_right(&self.args.map.name(), findings);
                Ok(checked.map_err(|error| summary::after_findings(error, findings, self.console))?)
            }
            false => Ok(()),
        }
    }

    /// Finds the sub-domains between them, and the part of the map that is asked for.
    ///
    /// `unit` is that of heights in the options.
    pub fn subdivide(
        &self,
        input: &mut Input,
        water: &WaterArgs,
        unit: ElevationUnit,
    ) -> Result<(Subdivision, Option<MultiPolygon<f64>>), Failure> {
        let subdivision = input.subdivide(water.sea_in_metres(unit), self.console);
        subdivision.map_err(|error| summary::after_findings(error, &input.findings, self.console).into())
    }

    /// Whether a picture is asked for.
    pub fn draws(&self) -> bool {
        self.picture.is_some()
    }

    /// Draws the picture, still under its temporary name, if one is asked for.
    pub fn draw(&mut self, drawing: &Drawing<'_>) -> Result<(), Failure> {
        self.picture.as_mut().map_or(Ok(()), |picture| picture.draw(drawing, self.console))
    }

    /// Prints the findings and the lines that describe the input.
    pub fn report(&self, findings: &[Finding], map: &ContourMap) {
        summary::findings(findings, self.console);
        self.args.map.describe(map, self.console);
    }

    /// Puts the picture in its place.
    pub fn commit_picture(self) -> Result<(), Failure> {
        if let Some(picture) = self.picture {
            picture.commit(self.console)?;
        }
        Ok(())
    }

    /// Puts the picture in its place, and prints the end of the summary. `outside` is the number of findings outside of the
    /// frame polygon or the part.
    pub fn close_part(self, findings: usize, outside: usize) -> Result<(), Failure> {
        let console = self.console;
        self.commit_picture()?;
        summary::close_part(findings, outside, console);
        Ok(())
    }
}

/// Builds the surface of an input. If that fails, prints the findings: lines that were left out may be the cause.
pub fn build(
    input: &mut Input,
    surface: &SurfaceArgs,
    options: &Options,
    console: &Console,
) -> Result<Terrain, Failure> {
    surface.add_to(input)?;
    console.plan(surface.steps(options));
    let built = Terrain::build_with(input, options, console);
    // A map that is still there was not used yet: the error is not about its lines.
    built.map_err(|error| match input.map.contours.is_empty() {
        true => summary::after_findings(error, &input.findings, console).into(),
        false => error.into(),
    })
}
