//! Contours that are stored as polygons: outlines and holes at one elevation.
//!
//! Areas between two levels are no contours, although each of them may have one elevation. Two signs tell them: fields with
//! a lower and an upper level, and edges that polygons of different elevations share.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::{Item, item};
use crate::attributes::upper_of;
use crate::table::{Feature, Line, Table};
use tokosen_core::base::bits::bits;
use tokosen_core::base::error::{Error, Finding, FindingKind};

/// Polygons are areas between levels if they share more than this part of their edges with those of another elevation.
const SHARED: f64 = 0.1;

/// The polygons of a table, and which of them are contours.
#[derive(Default)]
pub(super) struct Outlines {
    /// Number of features with polygons.
    count: usize,
    /// Those that are no contours, by the type of the geometry.
    others: BTreeMap<&'static str, usize>,
    /// Whether there is no other line.
    are_all: bool,
    /// Why none of them is a contour.
    fault: Option<String>,
    /// The features whose polygons are contours.
    contours: BTreeSet<u64>,
}

impl Outlines {
    /// The polygons of a table, before it is known where the elevations are.
    pub fn find(table: &Table) -> Self {
        let others = table.outlines();
        let count = others.values().sum();
        let fault = if count > 0 { bands(table) } else { None };
        let are_all = !table.features.iter().flat_map(|feature| &feature.lines).any(|line| !line.is_ring);
        Self { count, others, are_all, fault, contours: BTreeSet::new() }
    }

    /// The lines by which the source of the elevations is chosen. These are polygons only where there is nothing else.
    pub fn first_items<'a>(&self, table: &'a Table) -> Vec<Item<'a>> {
        let wants_rings = self.are_all && self.fault.is_none();
        items_of(table, |_, line| wants_rings || !line.is_ring)
    }

    /// An error about the choice of a source. Where there are polygons alone, it says that they are no contours.
    pub fn without_elevations(&self, table: &Table, error: Error) -> Error {
        match error {
            Error::NoElevationField { .. } if self.are_all => {
                let (found, why) = (table.found_words(), self.why_not());
                Error::Data(format!("there is no line in it{found}{why}"))
            }
            error => error,
        }
    }

    /// All lines that are contours, with those of polygons after [`Outlines::judge`].
    pub fn items<'a>(&self, table: &'a Table) -> Vec<Item<'a>> {
        items_of(table, |feature, line| !line.is_ring || self.contours.contains(&feature.number))
    }

    /// Finds the polygons that are contours. `level` gives the elevation of a line.
    pub fn judge(&mut self, table: &Table, level: impl Fn(&Item<'_>) -> Option<f64>) {
        if self.count == 0 || self.fault.is_some() {
            return;
        }
        let mut levels = BTreeMap::new();
        for feature in &table.features {
            let rings = || feature.lines.iter().filter(|line| line.is_ring);
            let of = |line: &Line| level(&item(feature.number, &feature.values, line.z));
            // Where a feature has lines too, these are the contours.
            let is_level = feature.lines.iter().all(|line| line.is_ring && of(line).is_some());
            if let Some(first) = rings().next().and_then(of).filter(|_| is_level) {
                levels.insert(feature.number, first);
            }
        }
        if self.are_all && 2 * levels.len() <= self.count {
            self.fault = Some("most of its polygons have no elevation".to_owned());
            return;
        }
        if share_edges(table, &levels) {
            self.fault = Some("they are areas between levels: those of different elevations share edges".to_owned());
            return;
        }
        for feature in table.features.iter().filter(|feature| levels.contains_key(&feature.number)) {
            if let Some(count) = feature.outline.and_then(|kind| self.others.get_mut(kind)) {
                *count -= 1;
            }
        }
        self.contours = levels.into_keys().collect();
    }

    /// Whether the polygons of a feature are contours.
    pub fn has(&self, feature: u64) -> bool {
        self.contours.contains(&feature)
    }

    /// Why polygons are no contours, as the end of a sentence; empty if there are none.
    pub fn why_not(&self) -> String {
        match (&self.fault, self.count) {
            (_, 0) => String::new(),
            (Some(fault), _) => format!("; {fault}"),
            (None, _) => "; its polygons have no elevation".to_owned(),
        }
    }

    /// What was done with the polygons.
    pub fn findings(&self) -> Vec<Finding> {
        let used = self.contours.len();
        let mut findings = Vec::new();
        if used > 0 {
            let message = format!("{used} polygons were read as contours: each outline is at one elevation");
            findings.push(Finding::general(FindingKind::PolygonContour, message));
        }
        let why = self.fault.as_deref().unwrap_or("they have no elevation of their own, so they are no contours");
        for (kind, count) in self.others.iter().filter(|(_, count)| **count > 0) {
            let message = format!("{count} geometries of type {kind} left out: {why}");
            findings.push(Finding::general(FindingKind::SkippedFeature, message));
        }
        findings
    }
}

fn items_of<'a>(table: &'a Table, wanted: impl Fn(&Feature, &Line) -> bool) -> Vec<Item<'a>> {
    let mut items = Vec::new();
    for feature in &table.features {
        let lines = feature.lines.iter().filter(|line| wanted(feature, line));
        items.extend(lines.map(|line| item(feature.number, &feature.values, line.z)));
    }
    items
}

/// The reason why polygons are areas between two levels, if fields say so.
fn bands(table: &Table) -> Option<String> {
    let holds_numbers = |field: &&crate::table::Field| {
        field.example.as_ref().is_some_and(|example| example.trim_matches('"').trim().parse::<f64>().is_ok())
    };
    let fields = || table.fields.iter().filter(holds_numbers);
    let pair = |low: &crate::table::Field| {
        let upper: Vec<String> = upper_of(&low.name).collect();
        let high = fields().find(|field| upper.contains(&field.name.trim().to_lowercase()))?;
        Some((low.name.clone(), high.name.clone()))
    };
    let (low, high) = fields().find_map(pair)?;
    Some(format!("they are areas between two levels, which the fields {low:?} and {high:?} give; contours are lines"))
}

/// Whether polygons of different elevations share many of their edges.
fn share_edges(table: &Table, levels: &BTreeMap<u64, f64>) -> bool {
    let mut owners: HashMap<[[u64; 2]; 2], u64> = HashMap::new();
    let (mut edges, mut shared) = (0_usize, 0_usize);
    for feature in &table.features {
        let Some(level) = levels.get(&feature.number).map(|z| (z + 0.0).to_bits()) else { continue };
        for line in feature.lines.iter().filter(|line| line.is_ring) {
            for pair in line.points.windows(2) {
                let mut edge = [bits(pair[0]), bits(pair[1])];
                edge.sort_unstable();
                edges += 1;
                shared += usize::from(*owners.entry(edge).or_insert(level) != level);
            }
        }
    }
    shared as f64 > SHARED * edges as f64
}
