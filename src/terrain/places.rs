//! Places in the coordinates of a height map: outlets, and where the water of a flood comes from.

use glam::DVec2;

use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::crs::Crs;
#[cfg(feature = "io")]
use tokosen_core::crs::{Transform, converted};
use tokosen_core::dem::derive::{
    Catchments, FloodFrom, FlowDirections, Outlet, catchments_above, cells_at_edge, snapped_outlet,
};
use tokosen_core::raster::{Dem, GroundScale};
#[cfg(feature = "io")]
use tokosen_io::{Places, ReadOptions, VectorSource, read_places};

/// How far outlets may move if nothing else is said, in sides of cells.
const SNAP_CELLS: f64 = 3.0;

/// A place, and what messages call it.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Its coordinates.
    pub at: DVec2,
    /// Its name.
    pub name: String,
}

impl Place {
    /// A place that is called by its coordinates in some system.
    pub fn at(at: DVec2, crs: Option<&Crs>) -> Self {
        let decimals = if crs.is_some_and(Crs::is_geographic) { 6 } else { 1 };
        Self { at, name: format!("{:.decimals$} {:.decimals$}", at.x, at.y) }
    }
}

/// The points of a file in some coordinate reference system. They stay as they are if their system or the other one is not
/// known. `memory` is the memory that reading may take, bytes; no limit if `None`.
///
/// # Errors
/// As [`read_places`]; if the systems cannot be converted to each other; if a point has no place in the system.
#[cfg(feature = "io")]
pub fn read_places_in(crs: Option<&Crs>, source: &VectorSource, memory: Option<u64>) -> Result<Report<Vec<Place>>> {
    let path = &source.path;
    let read = read_places(path, &ReadOptions { memory, ..source.reading() })?;
    let Places { places, crs: own } = read.value;
    let transform = Transform::between_known(own.as_ref(), crs).map_err(|error| error.in_file(path))?;
    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let place = |(place, feature): (DVec2, u64)| match converted(transform.as_ref(), place) {
        Some(at) => Ok(Place { at, name: format!("feature {feature} of {file}") }),
        None => {
            let DVec2 { x, y } = place;
            let message = format!("feature {feature}: {x} {y} has no place in the coordinates of the height map");
            Err(Error::file(path, message))
        }
    };
    Ok(Report { value: places.into_iter().map(place).collect::<Result<_>>()?, findings: read.findings })
}

/// Outlets on a height map.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlets {
    /// The outlets.
    pub outlets: Vec<Outlet>,
    /// What messages call each of them.
    pub names: Vec<String>,
    /// How far they could move, metres.
    pub distance: f64,
}

impl Outlets {
    /// The outlets for places: each moves to the cell with the largest upstream area within `snap` metres; if it is `None`,
    /// within three sides of a cell. Places outside of the height map are findings. `areas` are those of
    /// [`flow_accumulation`](tokosen_core::dem::derive::flow_accumulation), square metres.
    ///
    /// # Errors
    /// [`Error::Data`] if no place lies on the height map. [`Error::OutOfRange`] if the distance is negative.
    pub fn find(places: &[Place], areas: &Dem, scale: &GroundScale, snap: Option<f64>) -> Result<Report<Self>> {
        let side = (areas.grid.cell * scale.row(areas.grid.rows / 2)).max_element();
        let distance = snap.unwrap_or(SNAP_CELLS * side);
        if !(distance >= 0.0 && distance.is_finite()) {
            return Err(Error::OutOfRange { name: "outlet_snap", value: distance, unit: " m", must: "0 or more" });
        }
        let mut found = Self { outlets: Vec::new(), names: Vec::new(), distance };
        let mut findings = Vec::new();
        for Place { at, name } in places {
            match snapped_outlet(areas, scale, *at, distance) {
                Some(outlet) => {
                    found.outlets.push(outlet);
                    found.names.push(name.clone());
                }
                None => {
                    let message = format!("the outlet {name} lies outside the height map; it has no catchment");
                    findings.push(Finding::at(FindingKind::OutletOutside, *at, message));
                }
            }
        }
        if found.outlets.is_empty() {
            let first = places.first().map_or("", |place| &place.name);
            return Err(Error::Data(format!(
                "no outlet lies on the height map; the first one is {first}. Coordinates are those of the height map's \
                 system, x before y"
            )));
        }
        Ok(Report { value: found, findings })
    }

    /// The catchments above the outlets. One that reaches the edge of the height map is a finding.
    pub fn catchments(&self, directions: &FlowDirections) -> Report<Catchments> {
        let found = catchments_above(directions, &self.outlets);
        let mut findings = Vec::new();
        for ((outlet, name), cells) in self.outlets.iter().zip(&self.names).zip(cells_at_edge(directions, &found)) {
            if cells > 0 {
                let message = format!(
                    "the catchment above the outlet {name} reaches the edge of the height map in {cells} cells; in truth \
                     it may be larger"
                );
                findings.push(Finding::at(FindingKind::CatchmentCut, outlet.place, message));
            }
        }
        Report { value: found, findings }
    }
}

/// Where the water of a flood up to a level (metres) comes from: from the edge of the height map, or from places.
///
/// A place that lies outside the height map, or whose ground is not below the level, is left out with a finding.
///
/// # Errors
/// [`Error::Data`] if there are places, and the flood can come from none of them.
pub fn flood_source(places: &[Place], dem: &Dem, level: f64) -> Result<Report<FloodFrom>> {
    let mut findings = Vec::new();
    if places.is_empty() {
        return Ok(Report { value: FloodFrom::Edge, findings });
    }
    let size = DVec2::new(dem.grid.cols as f64, dem.grid.rows as f64);
    let cell = |Place { at, name }: &Place| {
        let place = dem.grid.place(*at).round();
        let is_on = place.cmpge(DVec2::ZERO).all() && place.cmplt(size).all();
        let cell = is_on.then(|| place.y as usize * dem.grid.cols + place.x as usize);
        let known =
            cell.and_then(|cell| Some((cell, f64::from(*dem.values.get(cell)?)))).filter(|(_, z)| z.is_finite());
        match known {
            Some((cell, height)) if height < level => Ok(cell),
            Some((_, height)) => Err(format!(
                "the flood cannot come from {name}: the ground there is {height:.2} m high, not below the level of \
                 {level} m"
            )),
            None => Err(format!("the flood cannot come from {name}: it lies outside the height map")),
        }
    };
    let mut cells = Vec::new();
    for place in places {
        match cell(place) {
            Ok(cell) => cells.push(cell),
            Err(message) => findings.push(Finding::at(FindingKind::FloodSourceDry, place.at, message)),
        }
    }
    match findings.first() {
        Some(first) if cells.is_empty() => Err(Error::Data(first.message.clone())),
        _ => Ok(Report { value: FloodFrom::Cells(cells), findings }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokosen_core::base::Grid;
    use tokosen_core::dem::derive::{Accumulated, flow_accumulation, flow_directions};

    /// A plane of 8 x 5 cells of 10 m that falls to the west.
    fn plane() -> Dem {
        let grid = Grid { corner: DVec2::new(0.0, 50.0), cell: DVec2::splat(10.0), cols: 8, rows: 5 };
        Dem { grid, values: (0..40).map(|i| (i % 8) as f32).collect(), crs: None }
    }

    #[test]
    fn outlets_beside_the_map_are_findings_and_cut_catchments_too() {
        let (dem, scale) = (plane(), GroundScale::Uniform(DVec2::ONE));
        let directions = flow_directions(&dem, &scale, None).unwrap();
        let areas = flow_accumulation(&directions, Accumulated::SquareMetres(&scale));
        let place = |x, y| Place::at(DVec2::new(x, y), None);
        let found = Outlets::find(&[place(35.0, 25.0), place(500.0, 25.0)], &areas, &scale, Some(0.0)).unwrap();
        assert_eq!(found.findings.iter().map(|f| f.kind).collect::<Vec<_>>(), [FindingKind::OutletOutside]);
        assert_eq!((found.value.outlets.len(), found.value.outlets[0].area), (1, 500.0));
        let above = found.value.catchments(&directions);
        assert_eq!(above.findings.iter().map(|f| f.kind).collect::<Vec<_>>(), [FindingKind::CatchmentCut]);
        // West of the place, as far as three cells.
        let moved = Outlets::find(&[place(35.0, 25.0)], &areas, &scale, None).unwrap().value;
        assert_eq!((moved.outlets[0].area, moved.outlets[0].moved, moved.distance), (800.0, 30.0, 30.0));
        assert!(matches!(Outlets::find(&[place(-90.0, 0.0)], &areas, &scale, None), Err(Error::Data(_))));
        assert!(Outlets::find(&[place(35.0, 25.0)], &areas, &scale, Some(-1.0)).is_err());
    }

    #[test]
    fn floods_come_from_ground_below_the_level_only() {
        let dem = plane();
        let place = |x, y| Place::at(DVec2::new(x, y), None);
        assert_eq!(flood_source(&[], &dem, 1.0).unwrap().value, FloodFrom::Edge);
        assert_eq!(flood_source(&[place(35.0, 25.0)], &dem, 3.5).unwrap().value, FloodFrom::Cells(vec![19]));
        // One place on dry ground, and one outside, do not stop the others.
        let mixed = flood_source(&[place(75.0, 25.0), place(35.0, 25.0), place(350.0, 0.0)], &dem, 3.5).unwrap();
        assert_eq!(mixed.value, FloodFrom::Cells(vec![19]));
        let told: Vec<&str> = mixed.findings.iter().map(|finding| finding.message.as_str()).collect();
        assert!(told.len() == 2 && told[0].contains("not below") && told[1].contains("outside"), "{told:?}");
        for (x, level, word) in [(35.0, 3.0, "not below"), (350.0, 3.5, "outside")] {
            let error = flood_source(&[place(x, 25.0)], &dem, level).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }
}
