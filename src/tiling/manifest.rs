//! The manifest of a plan: what its tasks are, and what they share. One JSON file that schedulers can read.

use std::path::Path;

use geo::{Coord, LineString, MultiPolygon, Polygon};
use serde::{Deserialize, Serialize};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::{ElevationUnit, Grid, Units};
use tokosen_core::contour::Target;
use tokosen_core::crs::Crs;
use tokosen_core::drain::Drain;
use tokosen_core::surface::{SurfaceKind, Whole};
use tokosen_io::read_small;

use super::divide::Block;
use super::findings::Stored;
use super::stored::Checksum;
use crate::terrain::{Ground, Planned};

/// The name of the file in the folder of a plan.
pub const NAME: &str = "manifest.json";
/// What tells the manifests of this program, of any layout, from other JSON.
const DESCRIPTION: &str =
    "plan of tokosen: 'tokosen work FOLDER --task ID' does a task, 'tokosen join FOLDER' joins the results";
/// The version of the layout of the folder. One of another version is refused.
const LAYOUT: u32 = 2;
/// The largest manifest that is read, bytes: about a million tasks.
const MAX_BYTES: u64 = 1 << 30;

/// A plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    description: String,
    layout: u32,
    /// The version of the program.
    pub version: String,
    /// The input in words.
    pub input: String,
    /// What all tasks share.
    pub(super) shared: Shared,
    /// The coordinate reference system of the input.
    pub(super) input_crs: Option<Crs>,
    /// The checksum of the file with all lines, if new contours are wanted.
    pub(super) lines: Option<String>,
    /// The findings about the input.
    pub(super) findings: Vec<Stored>,
    /// The tasks, in an order in which they may run.
    pub tasks: Vec<Task>,
}

/// What all tasks of a plan share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Shared {
    /// The unit of levels.
    pub unit: ElevationUnit,
    pub kind: SurfaceKind,
    pub resolution: f64,
    pub drain: Drain,
    /// The new contours, if they are wanted.
    pub levels: Option<Levels>,
    pub whole: Whole,
    pub ground: StoredGround,
    /// The cells of the height map, if one is wanted.
    pub cells: Option<Grid>,
    /// The level of the sea, if it is named, and those of coasts, metres.
    pub sea: Option<f64>,
    pub coast: Vec<f64>,
    /// How far a stream is moved to agree with the contours, and how far from a cliff contours end because of it, map units.
    pub stream_tolerance: Option<f64>,
    pub cliff_reach: f64,
    /// The units in which messages speak.
    pub units: Units,
    /// The system of the working plane.
    pub working_crs: Option<Crs>,
}

/// The new contours of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Levels {
    /// The levels of each layer.
    pub targets: Vec<Target>,
    /// One level in so many is an index contour; 0 for none.
    pub index_every: u32,
    /// Whether a layer at a coarser interval than that of the input has all contours of the input.
    pub keep_input: bool,
}

/// A task: one tile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Its name.
    pub id: String,
    /// The tasks that must be done before.
    pub needs: Vec<String>,
    /// The files that it reads besides the manifest, from the folder of the plan.
    pub inputs: Vec<String>,
    /// The files that it writes.
    pub outputs: Vec<String>,
    /// The checksum of its input.
    pub(super) checksum: String,
    /// Number of vertices of contours that it reads.
    pub vertices: usize,
    /// The tile: least x, least y, greatest x, greatest y, on the working plane.
    pub tile: [f64; 4],
    /// The window around it.
    pub(super) window: [f64; 4],
    /// Its cells in the height map, if one is wanted.
    pub(super) cells: Option<Block>,
}

/// The frame of the whole map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct StoredGround {
    kind: GroundKind,
    /// Polygons: rings, the first of which is the outer one, of places.
    area: Vec<Vec<Vec<[f64; 2]>>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum GroundKind {
    Hull,
    Box,
    Polygon,
    PolygonInHull,
    Outline,
}

impl From<&Ground> for StoredGround {
    fn from(ground: &Ground) -> Self {
        let kind = match ground {
            Ground::Hull(_) => GroundKind::Hull,
            Ground::Box(_) => GroundKind::Box,
            Ground::Polygon(_) => GroundKind::Polygon,
            Ground::PolygonInHull(_) => GroundKind::PolygonInHull,
            Ground::Outline(_) => GroundKind::Outline,
        };
        let ring = |ring: &LineString<f64>| ring.coords().map(|c| [c.x, c.y]).collect();
        let polygon =
            |polygon: &Polygon<f64>| std::iter::once(polygon.exterior()).chain(polygon.interiors()).map(ring).collect();
        Self { kind, area: ground.area().iter().map(polygon).collect() }
    }
}

impl StoredGround {
    fn ground(&self) -> Ground {
        let ring = |ring: &Vec<[f64; 2]>| ring.iter().map(|&[x, y]| Coord { x, y }).collect::<LineString<f64>>();
        let polygon = |rings: &Vec<Vec<[f64; 2]>>| {
            let mut rings = rings.iter().map(ring);
            Polygon::new(rings.next().unwrap_or_else(|| LineString::new(Vec::new())), rings.collect())
        };
        let area: MultiPolygon<f64> = self.area.iter().map(polygon).collect();
        match self.kind {
            GroundKind::Hull => Ground::Hull(area),
            GroundKind::Box => Ground::Box(area),
            GroundKind::Polygon => Ground::Polygon(area),
            GroundKind::PolygonInHull => Ground::PolygonInHull(area),
            GroundKind::Outline => Ground::Outline(area),
        }
    }
}

impl Shared {
    /// What the tiles take from the whole map.
    pub fn planned(&self) -> Planned {
        Planned {
            whole: self.whole.clone(),
            ground: self.ground.ground(),
            cells: self.cells,
            coast: self.coast.clone(),
            cliff_reach: self.cliff_reach,
            units: self.units,
        }
    }
}

/// The first lines of a manifest.
#[derive(Deserialize)]
struct Start {
    description: String,
    layout: u32,
}

impl Manifest {
    /// The system of the working plane, in metres; `None` if the map has none.
    pub fn working_crs(&self) -> Option<&Crs> {
        self.shared.working_crs.as_ref()
    }

    /// A manifest of this version of the program, without tasks.
    pub(super) fn new(input: String, shared: Shared, input_crs: Option<Crs>) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let (description, layout) = (DESCRIPTION.to_owned(), LAYOUT);
        Self {
            description,
            layout,
            version,
            input,
            shared,
            input_crs,
            lines: None,
            findings: Vec::new(),
            tasks: Vec::new(),
        }
    }

    /// The unit of levels, and of the heights that are written.
    pub fn unit(&self) -> ElevationUnit {
        self.shared.unit
    }

    /// The new contours, if they are wanted.
    pub fn levels(&self) -> Option<&Levels> {
        self.shared.levels.as_ref()
    }

    /// Reads a manifest.
    ///
    /// # Errors
    /// The file cannot be read, is no manifest, is broken, or is of another version.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let text = read_small(path, MAX_BYTES, "a manifest")?;
        let start = serde_json::from_slice::<Start>(&text).ok().filter(|start| start.description == DESCRIPTION);
        let Some(start) = start else {
            return Err(Error::file(path, "is no manifest that 'tokosen plan' made"));
        };
        if start.layout != LAYOUT {
            let message = format!(
                "has the layout {} of another version of this program, which reads layout {LAYOUT}; use that version, or make \
                 the plan again",
                start.layout
            );
            return Err(Error::file(path, message));
        }
        let manifest: Self = serde_json::from_slice(&text)
            .map_err(|e| Error::file_cause(path, "the manifest is broken; make the plan again", e))?;
        // The same plan on two versions of the program could give two terrains.
        if manifest.version != env!("CARGO_PKG_VERSION") {
            let message = format!(
                "was made by version {} of this program, and this is version {}; use that version, or make the plan again",
                manifest.version,
                env!("CARGO_PKG_VERSION")
            );
            return Err(Error::file(path, message));
        }
        Ok(manifest)
    }

    /// The text of the file.
    pub(super) fn text(&self) -> Result<String> {
        let text = serde_json::to_string_pretty(self);
        Ok(text.map_err(|e| Error::Data(format!("the manifest cannot be stored: {e}")))? + "\n")
    }

    /// What the results of a task are made from, as a number. Results of another plan have another number.
    pub(super) fn source(&self, task: &Task) -> Result<u64> {
        let text = serde_json::to_string(&(&self.version, &self.shared, task));
        Ok(Checksum::of(text.map_err(|e| Error::Data(format!("the manifest cannot be stored: {e}")))?.as_bytes()))
    }
}
