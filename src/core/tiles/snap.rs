//! Moves the vertices of all lines to whole numbers, one after the other, so that no line touches another one.
//!
//! Rounding each vertex alone would make lines cross where they lie close together. Here, a vertex moves only if its two new
//! segments touch no other line, and if no vertex lies in the ground that the line sweeps over. So every step leads from lines
//! that are apart to lines that are apart. If the nearest point of the grid is not free, a vertex takes another one, or leaves
//! its line. Where lines lie closer than the grid can show, the grid gets finer, for all tiles of the zoom; vertices that have
//! a place keep it. Only what the finest grid cannot show is left out. Lines of one level may touch where nothing else helps.

use std::collections::HashMap;

use super::moving::{FEW, MANY, Moving, Obstacles};
use super::network::Network;
use super::room::make_room;

/// The finest grid: steps per unit.
const FINEST: u32 = 16;
/// How often vertices are tried again on one grid, because others around them have moved.
const ROUNDS: usize = 6;

/// Moves all vertices to the grid. Returns the number of gaps that had to be made.
pub(super) fn snap(network: &mut Network) -> usize {
    let mut moving = Moving::new(network);
    let mut waiting: Vec<u32> = (0..moving.count()).collect();
    waiting.retain(|v| !moving.settle(*v, 1.0, FEW, Obstacles::All));
    let mut fineness = 1;
    loop {
        let step = 1.0 / f64::from(fineness);
        for obstacles in [Obstacles::All, Obstacles::OtherLevels] {
            for _ in 0..ROUNDS {
                let before = waiting.len();
                waiting.retain(|v| !moving.settle(*v, step, MANY, obstacles));
                if waiting.len() == before {
                    break;
                }
            }
        }
        if fineness > 1 && !waiting.is_empty() {
            let mut moved = HashMap::new();
            waiting.retain(|v| {
                make_room(&mut moving, *v, step, &mut moved);
                !moving.settle(*v, step, MANY, Obstacles::All)
            });
        }
        if waiting.is_empty() || fineness == FINEST {
            break;
        }
        fineness *= 2;
    }
    network.fineness = fineness;
    let mut has_place = vec![true; moving.count() as usize];
    waiting.iter().for_each(|v| has_place[*v as usize] = false);
    let (lines, places, gaps) = moving.into_lines(&has_place);
    (network.lines, network.places) = (lines, places);
    gaps
}
