//! The input of a terrain, from sources and keyword arguments.

use pyo3::prelude::*;
use tokosen::base::progress::Progress;
use tokosen::contour::SoftSpot;
use tokosen::crs::Crs;
use tokosen::dem::contour::ContourParams;
use tokosen::features::{Role, Serves};
use tokosen::io::VectorSource;
use tokosen::raster::Dem;
use tokosen::subdomains::Frame;
use tokosen::terrain::{extent_on, read_area_on};
use tokosen::{Input, InputOptions, Result};

use crate::error::{exception, parameter};
use crate::options::{Frame as GivenFrame, Given, HeightMap};
use crate::source::{Given as GivenSource, Source, crs, sources};
use crate::unit::{one_of, unit};

/// All that an input is made of, without Python's objects: it is read while others use Python.
pub struct Recipe {
    contours: Contours,
    options: InputOptions,
    points: Option<Points>,
    points_sigma: Option<f64>,
    /// The level of the contours that are the coast.
    coast_level: Option<f64>,
    /// Lines, polygons and points beside the contours.
    features: Vec<(Role, VectorSource)>,
    frame: FrameRecipe,
    extend: bool,
    base: Option<BaseRecipe>,
    extent: Option<([f64; 4], Option<Crs>)>,
    clip: Option<VectorSource>,
}

enum Contours {
    Vector(Vec<VectorSource>),
    Arrays(std::sync::Arc<crate::source::Lines>),
}

enum Points {
    Vector(VectorSource),
    Array(std::sync::Arc<[glam::DVec3]>, Option<Crs>),
}

enum FrameRecipe {
    Named(Frame),
    Area(VectorSource),
}

enum BaseRecipe {
    InMemory(Dem),
    File(std::path::PathBuf),
}

/// Where the ground of a height map ends, and the part of it that is wanted.
pub struct Ground {
    frame: Option<VectorSource>,
    extent: Option<([f64; 4], Option<Crs>)>,
    clip: Option<VectorSource>,
}

impl Ground {
    /// Takes what is needed out of Python's objects.
    pub fn new(py: Python<'_>, given: &Given) -> PyResult<Self> {
        check_part(py, given)?;
        let frame = match &given.frame {
            GivenFrame::Area(source) => Some(source.get().vector(py, "frame")?),
            GivenFrame::Named(name) if name == "auto" => None,
            GivenFrame::Named(other) => return Err(one_of(py, "frame", other, "polygons")),
        };
        let extent_crs = crs(py, given.extent_crs.as_deref())?;
        let clip = given.clip.as_ref().map(|source| source.get().vector(py, "clip")).transpose()?;
        Ok(Self { frame, extent: given.extent.map(|extent| (extent, extent_crs)), clip })
    }

    /// The height map with its ground inside the frame. The part that is wanted is set in `params`.
    pub fn of(&self, dem: Dem, params: &mut ContourParams) -> Result<Dem> {
        let dem = match &self.frame {
            Some(source) => {
                let frame = read_area_on(&dem, source, params.memory)?;
                dem.inside(&frame).map_err(|error| error.in_file(&source.path))?
            }
            None => dem,
        };
        params.part = match (&self.extent, &self.clip) {
            (Some((extent, crs)), _) => Some(extent_on(&dem, *extent, crs.as_ref())?),
            (None, Some(source)) => Some(read_area_on(&dem, source, params.memory)?),
            (None, None) => None,
        };
        Ok(dem)
    }
}

/// Refuses arguments about the part that contradict each other.
fn check_part(py: Python<'_>, given: &Given) -> PyResult<()> {
    match (given.extent.is_some(), given.extent_crs.is_some(), given.clip.is_some()) {
        (false, true, _) => Err(parameter(py, "extent_crs needs extent")),
        (true, _, true) => Err(parameter(py, "give either extent or clip")),
        _ => Ok(()),
    }
}

impl Recipe {
    /// Takes what is needed out of Python's objects.
    pub fn new(py: Python<'_>, contours: &[PyRef<'_, Source>], given: &Given) -> PyResult<Self> {
        let vector = |source: &Py<Source>, what: &str| source.get().vector(py, what);
        let one =
            |given: &Option<Py<Source>>, what: &str| given.as_ref().map(|source| vector(source, what)).transpose();
        if let Some(sigma) = given.points_sigma.filter(|sigma| !(sigma.is_finite() && *sigma >= 0.0)) {
            return Err(parameter(py, format!("points_sigma is {sigma}: it must be 0 or more")));
        }
        let needs = [
            (given.points_sigma.is_some() && given.points.is_none(), "points_sigma needs points"),
            (
                given.stream_tolerance.is_some() && given.in_role(Role::Streams).is_empty(),
                "stream_tolerance needs streams",
            ),
            (given.base_fade.is_some() && given.base.is_none(), "base_fade needs base"),
        ];
        if let Some((_, message)) = needs.into_iter().find(|(is_wrong, _)| *is_wrong) {
            return Err(parameter(py, message));
        }
        check_part(py, given)?;
        let named = crs(py, given.crs.as_deref())?;
        let contours = match contours {
            [one] => match one.given() {
                GivenSource::Lines(lines) => Contours::Arrays(lines.clone()),
                GivenSource::Vector(_) => Contours::Vector(sources(py, contours)?),
                GivenSource::Points(..) => return Err(parameter(py, "contours are lines, and these are points")),
            },
            _ => Contours::Vector(sources(py, contours)?),
        };
        let of_arrays = match &contours {
            Contours::Arrays(lines) => lines.crs.clone(),
            Contours::Vector(_) => None,
        };
        let options = InputOptions {
            elevation_field: given.elevation.clone(),
            layer: given.layer.clone(),
            unit: given.unit.as_deref().map(|name| unit(py, name)).transpose()?,
            plane_unit: given.plane_unit.as_deref().map(|name| unit(py, name)).transpose()?,
            depths: given.depths,
            crs: named.or(of_arrays),
            work_crs: crs(py, given.work_crs.as_deref())?,
            memory: tokosen::cli::available_memory(),
        };
        let points = match given.points.as_ref().map(|source| source.get().given()) {
            None => None,
            Some(GivenSource::Points(points, crs)) => Some(Points::Array(points.clone(), crs.clone())),
            Some(GivenSource::Vector(source)) => Some(Points::Vector(source.clone())),
            Some(GivenSource::Lines(_)) => return Err(parameter(py, "points are points, and these are lines")),
        };
        if let Some(level) = given.coast_level.filter(|level| !level.is_finite()) {
            return Err(parameter(py, format!("coast is {level}, which is no elevation")));
        }
        let mut features = Vec::new();
        for role in Role::all() {
            for source in given.in_role(role) {
                features.push((role, vector(source, role.name())?));
            }
        }
        let frame = match &given.frame {
            GivenFrame::Area(source) => FrameRecipe::Area(vector(source, "frame")?),
            GivenFrame::Named(_) if !given.extend => {
                return Err(parameter(py, "extend=False is for polygons: give them as frame"));
            }
            GivenFrame::Named(name) => match name.as_str() {
                "auto" => FrameRecipe::Named(Frame::Auto),
                "hull" => FrameRecipe::Named(Frame::Hull),
                "bbox" => FrameRecipe::Named(Frame::Box),
                other => return Err(one_of(py, "frame", other, "\"auto\", \"hull\", \"bbox\" or polygons")),
            },
        };
        let base = match &given.base {
            None => None,
            Some(HeightMap::InMemory(raster)) => Some(BaseRecipe::InMemory(raster.get().dem(py)?)),
            Some(HeightMap::File(path)) => Some(BaseRecipe::File(path.clone())),
        };
        let extent_crs = crs(py, given.extent_crs.as_deref())?;
        Ok(Self {
            contours,
            options,
            points,
            points_sigma: given.points_sigma,
            coast_level: given.coast_level,
            features,
            frame,
            extend: given.extend,
            base,
            extent: given.extent.map(|extent| (extent, extent_crs)),
            clip: one(&given.clip, "clip")?,
        })
    }

    /// Reads the contours, and what belongs to them. Everything is read in the order in which the program reads it, so that
    /// findings and results are the same.
    pub fn contours(&self, progress: &dyn Progress) -> Result<Input> {
        let mut input = match &self.contours {
            Contours::Vector(sources) => Input::read_all(sources, &self.options, progress)?,
            Contours::Arrays(lines) => {
                Input::from_arrays(&lines.coords, &lines.offsets, &lines.elevations, &self.options)?
            }
        };
        match &self.points {
            None => {}
            Some(Points::Vector(source)) => input.read_spots(source, self.points_sigma, progress)?,
            Some(Points::Array(points, crs)) => match self.points_sigma {
                Some(sigma) => {
                    let spots = points.iter().map(|place| SoftSpot { place: *place, sigma });
                    input.add_soft_spots(spots, crs.as_ref())?;
                }
                None => input.add_spots(points.iter().copied(), crs.as_ref())?,
            },
        }
        self.coast_level.iter().try_for_each(|level| input.set_coast_level(*level))?;
        self.read(&mut input, |serves| serves == Serves::Contours)?;
        self.frame(&mut input)?;
        self.part(&mut input)?;
        Ok(input)
    }

    /// Limits the results to the part that is asked for.
    fn part(&self, input: &mut Input) -> Result<()> {
        if let Some((extent, crs)) = &self.extent {
            input.set_extent(*extent, crs.as_ref())?;
        }
        self.clip.iter().try_for_each(|source| input.read_part(source))
    }

    /// Adds the base.
    pub fn base(&self, input: &mut Input, progress: &dyn Progress) -> Result<()> {
        match &self.base {
            None => Ok(()),
            Some(BaseRecipe::InMemory(dem)) => input.set_base(dem.clone(), std::path::Path::new("base")),
            Some(BaseRecipe::File(path)) => input.read_base(path, progress),
        }
    }

    /// Adds the frame.
    fn frame(&self, input: &mut Input) -> Result<()> {
        match &self.frame {
            FrameRecipe::Named(frame) => input.frame = frame.clone(),
            FrameRecipe::Area(source) => {
                input.read_boundary(source)?;
                if !self.extend {
                    input.frame = std::mem::take(&mut input.frame).in_hull();
                }
            }
        }
        Ok(())
    }

    /// Adds the features in the roles that serve what is wanted.
    fn read(&self, input: &mut Input, is_wanted: impl Fn(Serves) -> bool) -> Result<()> {
        let mut wanted = self.features.iter().filter(|(role, _)| is_wanted(role.serves()));
        wanted.try_for_each(|(role, source)| input.read_features(*role, source))
    }

    /// Adds what was given besides the contours and what belongs to them.
    pub fn surface(&self, input: &mut Input) -> Result<()> {
        self.read(input, |serves| serves > Serves::Contours)
    }

    /// The name of the contours in messages.
    pub fn name(&self) -> std::path::PathBuf {
        match &self.contours {
            Contours::Vector(sources) => sources.first().map(|source| source.path.clone()).unwrap_or_default(),
            Contours::Arrays(_) => "contours".into(),
        }
    }
}

/// An error as an exception.
pub fn failed<T>(py: Python<'_>, result: Result<T>) -> PyResult<T> {
    result.map_err(|error| exception(py, &error))
}
