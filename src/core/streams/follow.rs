//! Heights of streams between contours: those of a surface, made to fall.

use std::collections::HashMap;

use glam::DVec3;

use super::fall::fall;
use super::line::Stream;
use super::pool::pool;
use crate::base::Sure;
use crate::base::bits::bits;
use crate::tin::NONE;

/// Gives vertices on no contour the height that `guess` has there. Then heights fall along the network again, with as little
/// change as possible (`pool`). Where streams part, some may still rise; `fall` levels these. `streams` come in an order in
/// which each one follows those that flow into it.
pub(crate) fn follow(streams: &mut [Stream], guess: impl Fn(DVec3) -> f64) {
    for stream in streams.iter_mut() {
        let Stream { points, sure, bands, .. } = stream;
        let guessed = points.iter_mut().zip(sure).zip(bands).filter(|((_, sure), _)| **sure < Sure::Exact);
        for ((p, _), band) in guessed {
            let height = guess(*p);
            p.z = if height.is_nan() { p.z } else { band.strictly_inside(height) };
        }
    }
    // What is known limits what is guessed: first from below, then from above.
    let mut below: HashMap<Option<[u64; 2]>, f64> = HashMap::new();
    for stream in streams.iter_mut().rev() {
        let mut least = below.get(&last(stream)).copied().unwrap_or(f64::NEG_INFINITY);
        for (p, sure) in stream.points.iter_mut().zip(&stream.sure).rev() {
            if *sure == Sure::Exact { least = least.max(p.z) } else { p.z = p.z.max(least) }
        }
        let at = below.entry(first(stream)).or_insert(f64::NEG_INFINITY);
        *at = at.max(least);
    }
    let mut above: HashMap<Option<[u64; 2]>, f64> = HashMap::new();
    for stream in streams.iter_mut() {
        let mut most = above.get(&first(stream)).copied().unwrap_or(f64::INFINITY);
        for (p, sure) in stream.points.iter_mut().zip(&stream.sure) {
            if *sure == Sure::Exact { most = most.min(p.z) } else { p.z = p.z.min(most) }
        }
        let at = above.entry(last(stream)).or_insert(f64::INFINITY);
        *at = at.min(most);
    }
    pool_guesses(streams);
    let ends: Vec<_> = streams.iter().map(Stream::ends).collect();
    let mut heights: Vec<Vec<f64>> = streams.iter().map(|s| s.points.iter().map(|p| p.z).collect()).collect();
    fall(&ends, &mut heights);
    for (stream, heights) in streams.iter_mut().zip(heights) {
        stream.points.iter_mut().zip(heights).for_each(|(p, z)| p.z = z);
        stay_inside(stream);
    }
}

/// The start of a stream, and its end.
fn first(stream: &Stream) -> Option<[u64; 2]> {
    stream.ends().map(|[first, _]| first)
}

fn last(stream: &Stream) -> Option<[u64; 2]> {
    stream.ends().map(|[_, last]| last)
}

/// Makes guesses fall along the network as a tree: where streams part, along the first of them.
fn pool_guesses(streams: &mut [Stream]) {
    let (mut heights, mut below): (Vec<f64>, Vec<u32>) = (Vec::new(), Vec::new());
    let mut ends: HashMap<[u64; 2], u32> = HashMap::new();
    // The node of each vertex. Streams that meet share one.
    let mut nodes: Vec<u32> = Vec::new();
    for stream in streams.iter() {
        let mut before: Option<u32> = None;
        for (k, (p, sure)) in stream.points.iter().zip(&stream.sure).enumerate() {
            let mut new = || {
                heights.push(p.z);
                below.push(NONE);
                heights.len() as u32 - 1
            };
            let is_end = k == 0 || k + 1 == stream.points.len();
            let node = if is_end { *ends.entry(bits(p.truncate())).or_insert_with(new) } else { new() };
            if *sure == Sure::Exact {
                heights[node as usize] = p.z;
            }
            if let Some(before) = before.filter(|before| *before != node && below[*before as usize] == NONE) {
                below[before as usize] = node;
            }
            before = Some(node);
            nodes.push(node);
        }
    }
    pool(&mut heights, &below);
    let vertices = streams.iter_mut().flat_map(|stream| stream.points.iter_mut().zip(&stream.sure));
    for ((p, sure), node) in vertices.zip(nodes) {
        if *sure < Sure::Exact {
            p.z = heights[node as usize];
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subdomains::Band;

    /// Streams from one corner to the next; heights that a contour gives are exact.
    fn streams(lines: &[&[(f64, f64, Option<f64>)]]) -> Vec<Stream> {
        let stream = |line: &&[(f64, f64, Option<f64>)]| {
            let points = line.iter().map(|&(x, y, z)| DVec3::new(x, y, z.unwrap_or(50.0))).collect();
            let sure = line.iter().map(|(.., z)| if z.is_some() { Sure::Exact } else { Sure::Guessed }).collect();
            Stream { sure, ..Stream::between(points, Band { lo: 0.0, hi: 100.0 }) }
        };
        lines.iter().map(stream).collect()
    }

    fn heights(stream: &Stream) -> Vec<f64> {
        stream.points.iter().map(|p| p.z).collect()
    }

    #[test]
    fn streams_follow_the_surface_between_contours_and_fall_through_confluences() {
        // Two streams flow into a third one, at (2, 0).
        let mut found = streams(&[
            &[(0.0, 0.0, Some(90.0)), (1.0, 0.0, None), (2.0, 0.0, None)],
            &[(2.0, 2.0, None), (2.0, 1.0, None), (2.0, 0.0, None)],
            &[(2.0, 0.0, None), (3.0, 0.0, None), (4.0, 0.0, Some(20.0))],
        ]);
        // The surface has a dam of 70 m at (3, 0), and is above the first contour at (1, 0).
        let surface = |p: DVec3| match p.truncate().to_array() {
            [1.0, 0.0] => 95.0,
            [2.0, 0.0] => 40.0,
            [3.0, 0.0] => 70.0,
            [2.0, y] => 40.0 + 30.0 * y,
            _ => f64::NAN,
        };
        follow(&mut found, surface);
        assert_eq!(heights(&found[0]), [90.0, 90.0, 55.0]);
        // At the confluence and at the dam, water stands at their mean height. The source is strictly inside its band.
        assert_eq!(heights(&found[1]), [99.9, 70.0, 55.0]);
        assert_eq!(heights(&found[2]), [55.0, 55.0, 20.0]);
        // Also between contours that are near.
        let mut found = streams(&[&[(0.0, 0.0, Some(90.0)), (1.0, 0.0, None), (4.0, 0.0, Some(20.0))]]);
        found[0].sure[1] = Sure::Between;
        follow(&mut found, |_| 40.0);
        assert_eq!(heights(&found[0]), [90.0, 40.0, 20.0]);
    }
}
