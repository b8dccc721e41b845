//! The roughness of contours: how their offsets from chords grow with the length of the chords (Hurst-like exponent).
//!
//! On a smooth line, the offset of the middle from the chord grows with the square of the length. On a line with
//! jitter, it hardly grows. The exponent depends neither on the scale of the line nor on the terrain. A spline is the
//! best guess for lines with the exponent 3/2 (integrated random walks). Rougher lines are better smoothed than
//! followed.
//!
//! The offsets of one length are summed up by their root mean square. A median would not do: of lines with few vertices,
//! half of the chords lie on straight pieces, and their offsets are 0.
//!
//! The half-lengths of the chords are a quarter and a half of the mean spacing. The surface between contours can
//! show detail of this size. Where contours are too few, chords are half as long. Single vertices far off a line are
//! digitising errors and are left out. The long ways there and back would make a smooth line rough.

use glam::DVec2;

use crate::base::parallel;
use crate::contour::without_outlying;
use crate::subdomains::MapExtent;
use crate::tuning::RoughnessTuning;

/// About the largest number of chords of one length. It limits time: of more contours, only some are used.
const MOST: f64 = 1e6;

/// Offsets from chords of length 1 that are rounding alone.
const STRAIGHT: f64 = 1e-6;
/// Least number of chords of each length. With fewer, chords of half the length are used. If these are too few
/// too, the exponent is unknown.
const MIN_CHORDS: usize = 200;

/// The Hurst-like exponent of the contours, about 0 to 2. `None` if there are too few chords, or if all are straight.
pub fn hurst_exponent(extent: &MapExtent<'_>, tuning: &RoughnessTuning) -> Option<f64> {
    let lines: Vec<Vec<DVec2>> = parallel::map_each(&extent.map.contours, |c| without_outlying(&c.points));
    exponent(&lines.iter().map(Vec::as_slice).collect::<Vec<_>>(), extent.spacing, tuning)
}

fn exponent(lines: &[&[DVec2]], spacing: f64, tuning: &RoughnessTuning) -> Option<f64> {
    let RoughnessTuning { chords, usual_exponent, .. } = *tuning;
    let offsets = |of_chords: f64| {
        let [near, far] = chords.map(|share| mean_offset(lines, share * of_chords * spacing, MIN_CHORDS));
        Some([near?, far?])
    };
    let exponent = |[near, far]: [f64; 2]| {
        let exponent = (far / near).log2() / (chords[1] / chords[0]).log2();
        exponent.is_finite().then_some(exponent)
    };
    // Few contours have more chords of half the length. These may lie on straight pieces between vertices. So they can show
    // that a line is rough, but not that it is smooth.
    let of_shorter = || exponent(offsets(0.5)?).map(|exponent| exponent.min(usual_exponent));
    offsets(1.0).map_or_else(of_shorter, exponent)
}

/// Root mean square offset of the middle of chords; `None` if there are fewer than `fewest`, or if all are straight.
fn mean_offset(lines: &[&[DVec2]], reach: f64, fewest: usize) -> Option<f64> {
    let length = |line: &[DVec2]| line.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
    let all: f64 = lines.iter().map(|line| length(line)).sum::<f64>() / reach;
    if !all.is_finite() {
        return None;
    }
    let every = (all / MOST).ceil().max(1.0) as usize;
    let (mut sum, mut count) = (0.0, 0);
    for line in lines.iter().step_by(every) {
        // Short lines are one bend only.
        if length(line) < 4.0 * reach {
            continue;
        }
        let mut last = [None, None];
        for_each_step(line, reach, MOST as usize, |p| {
            if let [Some(a), Some::<DVec2>(b)] = last {
                sum += b.distance_squared((a + p) / 2.0);
                count += 1;
            }
            last = [last[1], Some(p)];
        });
    }
    let mean = (sum / count as f64).sqrt();
    (count >= fewest && mean > STRAIGHT * reach).then_some(mean)
}

/// Calls `each` with places along a line that are `step` apart, at most `most` times.
fn for_each_step(line: &[DVec2], step: f64, most: usize, mut each: impl FnMut(DVec2)) {
    let (mut ahead, mut count) = (0.0, 0);
    for ends in line.windows(2) {
        let length = ends[0].distance(ends[1]);
        while ahead < length && count < most {
            each(ends[0].lerp(ends[1], ahead / length));
            ahead += step;
            count += 1;
        }
        ahead -= length;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Circles around each other. Their radii change at random by the given amount from vertex to vertex.
    fn rings(jitter: f64) -> Vec<Vec<DVec2>> {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24) - 0.5
        };
        let mut ring = |k: usize| {
            let corner = |j: usize| DVec2::from_angle(j as f64 * std::f64::consts::TAU / 600.0);
            (0..=600).map(|j| (10.0 * k as f64 + jitter * random()) * corner(j)).collect()
        };
        (5..10).map(&mut ring).collect()
    }

    #[test]
    fn smooth_lines_bend_with_the_square_and_rough_ones_do_not() {
        let tuning = RoughnessTuning::default();
        let of = |jitter: f64| {
            let rings = rings(jitter);
            exponent(&rings.iter().map(Vec::as_slice).collect::<Vec<_>>(), 10.0, &tuning)
        };
        assert!((of(0.0).unwrap_or(0.0) - 2.0).abs() < 0.1, "{:?}", of(0.0));
        assert!(of(1.0).unwrap_or(9.0) < 0.5, "{:?}", of(1.0));
        assert_eq!(exponent(&[], 1.0, &tuning), None);
        let of_few = |jitter: f64| {
            let rings = rings(jitter);
            let few: Vec<&[DVec2]> = rings.iter().map(|ring| &ring[..150]).collect();
            exponent(&few, 10.0, &tuning)
        };
        assert!(of_few(1.0).unwrap_or(9.0) < 0.5, "{:?}", of_few(1.0));
        assert_eq!(of_few(0.0), Some(tuning.usual_exponent));
        let straight = [DVec2::ZERO, DVec2::new(1e9, 0.0)];
        assert_eq!(exponent(&[&straight], 1.0, &tuning), None, "no bend at all");
    }
}
