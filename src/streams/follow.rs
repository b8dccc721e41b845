//! Heights of streams where contours are far: those of a surface, made to fall.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::line::Stream;
use crate::base::Sure;
use crate::base::bits::bits;

/// Gives vertices whose height is a guess the height that `guess` has there. Then heights fall along the network again:
/// the new height is the mean of the lowest one upstream and the highest one downstream, neither of which ever rises.
/// `streams` come in an order in which each one follows those that flow into it.
pub(crate) fn follow(streams: &mut [Stream], guess: impl Fn(DVec3) -> f64) {
    for stream in streams.iter_mut() {
        let Stream { points, sure, bands, .. } = stream;
        let guessed = points.iter_mut().zip(sure).zip(bands).filter(|((_, sure), _)| **sure == Sure::Guessed);
        for ((p, _), band) in guessed {
            let height = guess(*p);
            p.z = if height.is_nan() { p.z } else { band.strictly_inside(height) };
        }
    }
    let first = |stream: &Stream| bits(stream.points.first().map_or(DVec2::NAN, |p| p.truncate()));
    let last = |stream: &Stream| bits(stream.points.last().map_or(DVec2::NAN, |p| p.truncate()));
    let is_known = |sure: Sure| sure > Sure::Guessed;
    // What is known limits what is guessed: first from below, then from above.
    let mut below: HashMap<[u64; 2], f64> = HashMap::new();
    for stream in streams.iter_mut().rev() {
        let mut least = below.get(&last(stream)).copied().unwrap_or(f64::NEG_INFINITY);
        for (p, sure) in stream.points.iter_mut().zip(&stream.sure).rev() {
            if is_known(*sure) { least = least.max(p.z) } else { p.z = p.z.max(least) }
        }
        let at = below.entry(first(stream)).or_insert(f64::NEG_INFINITY);
        *at = at.max(least);
    }
    let mut above: HashMap<[u64; 2], f64> = HashMap::new();
    for stream in streams.iter_mut() {
        let mut most = above.get(&first(stream)).copied().unwrap_or(f64::INFINITY);
        for (p, sure) in stream.points.iter_mut().zip(&stream.sure) {
            if is_known(*sure) { most = most.min(p.z) } else { p.z = p.z.min(most) }
        }
        let at = above.entry(last(stream)).or_insert(f64::INFINITY);
        *at = at.min(most);
    }
    // The lowest height upstream, and the highest one downstream, of each vertex.
    let mut lowest: Vec<Vec<f64>> = Vec::with_capacity(streams.len());
    let mut ends: HashMap<[u64; 2], f64> = HashMap::new();
    for stream in streams.iter() {
        let mut least = ends.get(&first(stream)).copied().unwrap_or(f64::INFINITY);
        let of_stream = stream.points.iter().map(|p| {
            least = least.min(p.z);
            least
        });
        lowest.push(of_stream.collect());
        let at = ends.entry(last(stream)).or_insert(f64::INFINITY);
        *at = at.min(least);
    }
    let mut starts: HashMap<[u64; 2], f64> = HashMap::new();
    for (stream, lowest) in streams.iter_mut().zip(&lowest).rev() {
        let mut most = starts.get(&last(stream)).copied().unwrap_or(f64::NEG_INFINITY);
        for (p, least) in stream.points.iter_mut().zip(lowest).rev() {
            most = most.max(p.z);
            p.z = most.midpoint(*least);
        }
        stay_inside(stream);
        let at = starts.entry(first(stream)).or_insert(f64::NEG_INFINITY);
        *at = at.max(most);
    }
}

/// Keeps all heights that no contour gives strictly inside their bands. Along a stream bands never rise, so heights still
/// fall. Water may lie nearer to the edge of a band than other heights; its neighbours then may too.
fn stay_inside(stream: &mut Stream) {
    let Stream { points, sure, bands, .. } = stream;
    let is_free = |k: usize| sure[k] < Sure::Exact && bands[k].lo < bands[k].hi;
    let mut before = f64::INFINITY;
    for k in 0..points.len() {
        if is_free(k) {
            let inside = bands[k].strictly_inside(points[k].z);
            points[k].z = if inside > before && before > bands[k].lo { before } else { inside };
        }
        before = points[k].z;
    }
    let mut after = f64::NEG_INFINITY;
    for k in (0..points.len()).rev() {
        if is_free(k) && points[k].z < after && after < bands[k].hi {
            points[k].z = after;
        }
        after = points[k].z;
    }
}
