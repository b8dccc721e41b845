//! The coordinates that positions on the plane had in the file.

use std::collections::{HashMap, HashSet};
use std::sync::OnceLock;

use foldhash::fast::FixedState;
use glam::DVec2;
use rayon::prelude::*;

use super::transform::Transform;
use crate::base::bits::bits;

/// Steps per metre of coordinates on the plane.
const STEPS: f64 = 1e6;

/// A position as a key: its bits.
pub(super) type Key = [u64; 2];

/// The nearest position in whole micrometres.
pub(super) fn on_steps(p: DVec2) -> DVec2 {
    (p * STEPS).round() / STEPS + DVec2::ZERO
}

/// Sorted by position. Equal coordinates at the same position are kept once.
pub(super) fn in_order(mut pairs: Vec<(Key, DVec2)>) -> Vec<(Key, DVec2)> {
    pairs.par_sort_unstable_by_key(|(k, p)| (*k, p.x.to_bits(), p.y.to_bits()));
    pairs.dedup_by(|a, b| a.0 == b.0 && a.1 == b.1);
    pairs
}

/// Coordinates of a file. The table by positions on the plane is made when an output first asks for it.
#[derive(Debug, Default)]
pub(super) struct Originals {
    places: Vec<DVec2>,
    /// The positions in whole micrometres that several of them would have. These keep all their digits.
    crowded: HashSet<Key>,
    by_place: OnceLock<HashMap<Key, DVec2, FixedState>>,
}

impl Originals {
    pub fn new(pairs: Vec<(Key, DVec2)>, crowded: HashSet<Key>) -> Self {
        let mut places: Vec<DVec2> = pairs.into_iter().map(|(_, p)| p).collect();
        places.shrink_to_fit();
        Self { places, crowded, by_place: OnceLock::new() }
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// The same with further coordinates. Where a position on the plane has some already, these stay.
    pub fn with(&self, more: impl Iterator<Item = DVec2>, way: Option<&Transform>) -> Self {
        let known = self.by_place(way);
        let mut new = HashSet::new();
        let more = more.filter(|p| {
            let Some(place) = way.map_or(Some(*p), |way| way.forward(*p)).map(on_steps) else { return false };
            let key = bits(place);
            place != *p && !self.crowded.contains(&key) && !known.contains_key(&key) && new.insert(key)
        });
        let places = self.places.iter().copied().chain(more).collect();
        Self { places, crowded: self.crowded.clone(), by_place: OnceLock::new() }
    }

    /// What was at a position on the plane, to which `way` leads.
    pub fn at(&self, p: DVec2, way: Option<&Transform>) -> Option<DVec2> {
        // Computed vertices are hardly ever on whole micrometres, so they need no search.
        if self.crowded.is_empty() && on_steps(p) != p {
            return None;
        }
        self.by_place(way).get(&bits(p)).copied()
    }

    fn by_place(&self, way: Option<&Transform>) -> &HashMap<Key, DVec2, FixedState> {
        let pair = |p: &DVec2| {
            let exact = way.map_or(Some(*p), |way| way.forward(*p))?;
            let key = bits(on_steps(exact));
            Some((if self.crowded.contains(&key) { bits(exact) } else { key }, *p))
        };
        self.by_place.get_or_init(|| self.places.iter().filter_map(pair).collect())
    }
}
