//! Streams that lie above a grid: its heights are raised to them.

use glam::DVec2;

use super::ways::{Sample, for_each_place, move_to, reading};
use crate::base::Grid;
use crate::streams::Stream;

/// A grid knows the place of a stream to half a cell.
const SURE_TO: f64 = 0.5;

/// Raises heights along streams to those of the streams, as far as this is `allowed`.
pub(crate) fn raise_to(
    streams: &[Stream],
    grid: &Grid,
    heights: &mut [f32],
    allowed: impl Fn(usize, f32) -> Option<f32>,
) {
    streams.iter().for_each(|stream| raise_along(stream, grid, heights, &allowed));
}

/// Raises what is lower than a stream: the cells that it runs through, where it is nearest to their centre, and the readings
/// between cells. They are raised to the height that the stream has [`SURE_TO`] cells further downstream. On steep ground
/// its height at the very place would be too much.
fn raise_along(stream: &Stream, grid: &Grid, heights: &mut [f32], allowed: &impl Fn(usize, f32) -> Option<f32>) {
    let mut readings: Vec<(DVec2, f32)> = Vec::new();
    for_each_place(stream, grid, |place, z| readings.push((place, z)));
    let mut walked = 0.0;
    let mut at = vec![0.0; readings.len()];
    for k in 1..readings.len() {
        walked += readings[k - 1].0.distance(readings[k].0);
        at[k] = walked;
    }
    let raise = |heights: &mut [f32], n: usize, z: f32| {
        if heights[n] < z {
            heights[n] = allowed(n, z).map_or(heights[n], |raised| raised.max(heights[n]));
        }
    };
    // The cell that the stream runs through, with its distance from the centre and the height for it.
    let mut through: Option<(usize, f64, f32)> = None;
    let mut ahead = 0;
    for (&(place, _), s) in readings.iter().zip(&at) {
        while ahead + 1 < readings.len() && at[ahead] < s + SURE_TO {
            ahead += 1;
        }
        let z = readings[ahead].1;
        let distance = place.distance_squared(place.round());
        let sample = Sample::new(grid, place, z);
        match (sample.nearest(), &mut through) {
            (Some(n), Some((cell, least, height))) if *cell == n => {
                if distance < *least {
                    (*least, *height) = (distance, z);
                }
            }
            (n, through) => {
                if let Some((cell, _, height)) = std::mem::replace(through, n.map(|n| (n, distance, z))) {
                    raise(heights, cell, height);
                }
            }
        }
        if let Some(corners) = sample.corners(grid).filter(|corners| reading(heights, corners) < z) {
            move_to(z, heights, &corners, allowed);
        }
    }
    if let Some((cell, _, height)) = through {
        raise(heights, cell, height);
    }
}
