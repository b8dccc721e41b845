//! Depths beside heights: attributes that are positive downwards.

use std::sync::{Mutex, PoisonError};

use super::features::{Cell, Column, Kind};

/// The attributes of heights, each with that of depths. What is above is less deep, so the ends of a range change places.
const NAMES: [(&str, &str); 4] =
    [("elev", "depth"), ("elev_from", "depth_to"), ("elev_to", "depth_from"), ("elev_mid", "depth_mid")];

/// Columns that were put together while the program runs. There are few different ones, and they stay until it ends.
static COLUMNS: Mutex<Vec<&'static [Column]>> = Mutex::new(Vec::new());

/// These columns, for a layer.
pub fn columns(wanted: &[(&str, Kind)]) -> &'static [Column] {
    let mut known = COLUMNS.lock().unwrap_or_else(PoisonError::into_inner);
    let is_it = |own: &&&'static [Column]| {
        own.len() == wanted.len() && own.iter().zip(wanted).all(|(a, (name, kind))| a.name == *name && a.kind == *kind)
    };
    if let Some(found) = known.iter().find(is_it) {
        return found;
    }
    let column = |(name, kind): &(&str, Kind)| Column { name: Box::leak((*name).into()), kind: *kind };
    let made: &'static [Column] = Box::leak(wanted.iter().map(column).collect());
    known.push(made);
    made
}

/// The columns with those of depths behind them, and the number of the height that each of these is the depth of.
pub(super) fn with_depths(of: &'static [Column]) -> (&'static [Column], Vec<usize>) {
    let number = |height: &str| of.iter().position(|column| column.name == height);
    let (names, heights): (Vec<_>, Vec<_>) =
        NAMES.iter().filter_map(|(height, depth)| Some(((*depth, Kind::Real), number(height)?))).unzip();
    let own = of.iter().map(|column| (column.name, column.kind));
    (columns(&own.chain(names).collect::<Vec<_>>()), heights)
}

/// The depth of a height in the same unit.
pub(super) fn depth<'a>(height: &Cell<'a>) -> Cell<'a> {
    match height {
        // Not the negative zero of 0.
        Cell::Real(height) => Cell::Real(0.0 - height),
        other => other.clone(),
    }
}
