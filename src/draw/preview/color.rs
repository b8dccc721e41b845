//! Colours: the hypsometric tint, its relief shading, and the inks of the lines.

use glam::DVec3;
use tokosen_core::cartography::TINT;

/// A colour as sRGB bytes.
pub(crate) type Rgb = [u8; 3];

/// Paper around the map and where there is no data.
pub(crate) const PAPER: Rgb = [255, 255, 255];
/// Text, frame, scale bar.
pub(crate) const INK: Rgb = [52, 48, 44];
/// Contours of the input, and the elevations on contours.
pub(crate) const INPUT: Rgb = [84, 48, 22];
/// Interpolated contours.
pub(crate) const INTERPOLATED: Rgb = [186, 90, 12];
/// Ridge lines.
pub(crate) const RIDGE: Rgb = [140, 20, 120];
/// Canyon lines.
pub(crate) const CANYON: Rgb = [0, 100, 200];

/// The border of a part of the map.
pub(crate) const BORDER: Rgb = [176, 24, 40];

/// Shadows are cool and highlights warm, which keeps the tint readable in both.
const SHADOW: [f64; 3] = [56.0, 62.0, 92.0];
/// Share of the shadow where no light falls. Deeper shadows would hide the lines.
const DEEPEST: f64 = 0.5;
const HIGHLIGHT: [f64; 3] = [255.0, 253.0, 240.0];

/// The tint as a table, interpolated in Oklab so that equal steps of height look equally large.
#[derive(Debug, Clone)]
pub(crate) struct Tint {
    table: Vec<Rgb>,
    /// The lowest and the highest height, metres.
    pub range: (f64, f64),
    /// The levels between bands that have one colour each, metres, ascending. Without levels, the tint is smooth.
    levels: Vec<f64>,
}

impl Tint {
    pub fn over(range: (f64, f64), levels: &[f64]) -> Self {
        let levels = levels.iter().copied().filter(|level| range.0 < *level && *level < range.1).collect();
        let stops = TINT.map(to_oklab);
        let size = 512;
        let table = (0..size)
            .map(|i| {
                let at = f64::from(i) / f64::from(size - 1) * (stops.len() - 1) as f64;
                let first = (at as usize).min(stops.len() - 2);
                from_oklab(stops[first].lerp(stops[first + 1], at - first as f64))
            })
            .collect();
        Self { table, range, levels }
    }

    /// The colour of a height, metres: that half-way between the levels beside it, if there are bands.
    pub fn of(&self, height: f64) -> Rgb {
        let (low, high) = self.range;
        let band = self.levels.partition_point(|level| *level <= height);
        let shown = match self.levels.is_empty() {
            true => height,
            false => {
                let below = band.checked_sub(1).map_or(low, |below| self.levels[below]);
                below.midpoint(self.levels.get(band).copied().unwrap_or(high))
            }
        };
        self.at(if high > low { (shown - low) / (high - low) } else { 0.0 })
    }

    /// The colour at a share of the height range, 0 to 1.
    pub fn at(&self, share: f64) -> Rgb {
        let last = self.table.len() - 1;
        self.table[((share.clamp(0.0, 1.0) * last as f64).round() as usize).min(last)]
    }
}

/// Shades a colour: `light` is 1 on level ground, less in the shadow, more towards the light.
pub(crate) fn shaded(color: Rgb, light: f64) -> Rgb {
    let (target, share) = if light < 1.0 {
        (SHADOW, DEEPEST * (1.0 - light.max(0.0)))
    } else {
        (HIGHLIGHT, (0.9 * (light - 1.0)).min(0.45))
    };
    std::array::from_fn(|i| {
        let base = f64::from(color[i]);
        (base + (target[i] - base) * share).round().clamp(0.0, 255.0) as u8
    })
}

/// sRGB to Oklab (Ottosson 2020), by way of linear light and cone responses.
fn to_oklab(color: Rgb) -> DVec3 {
    let linear = DVec3::from_array(color.map(|byte| {
        let v = f64::from(byte) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    }));
    let cones = DVec3::new(
        linear.dot(DVec3::new(0.4122214708, 0.5363325363, 0.0514459929)),
        linear.dot(DVec3::new(0.2119034982, 0.6806995451, 0.1073969566)),
        linear.dot(DVec3::new(0.0883024619, 0.2817188376, 0.6299787005)),
    )
    .map(f64::cbrt);
    DVec3::new(
        cones.dot(DVec3::new(0.2104542553, 0.7936177850, -0.0040720468)),
        cones.dot(DVec3::new(1.9779984951, -2.4285922050, 0.4505937099)),
        cones.dot(DVec3::new(0.0259040371, 0.7827717662, -0.8086757660)),
    )
}

/// Oklab to the nearest sRGB bytes.
fn from_oklab(lab: DVec3) -> Rgb {
    let cones = DVec3::new(
        lab.dot(DVec3::new(1.0, 0.3963377774, 0.2158037573)),
        lab.dot(DVec3::new(1.0, -0.1055613458, -0.0638541728)),
        lab.dot(DVec3::new(1.0, -0.0894841775, -1.2914855480)),
    )
    .map(|v| v * v * v);
    let linear = DVec3::new(
        cones.dot(DVec3::new(4.0767416621, -3.3077115913, 0.2309699292)),
        cones.dot(DVec3::new(-1.2684380046, 2.6097574011, -0.3413193965)),
        cones.dot(DVec3::new(-0.0041960863, -0.7034186147, 1.7076147010)),
    );
    linear.to_array().map(|v| {
        let v = if v <= 0.0031308 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (v * 255.0).round().clamp(0.0, 255.0) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oklab_and_back_is_the_same_colour() {
        for color in [[0, 0, 0], [255, 255, 255], [255, 0, 0], [12, 200, 99]] {
            assert_eq!(from_oklab(to_oklab(color)), color);
        }
    }

    #[test]
    fn the_tint_passes_its_stops_and_grows_lighter() {
        let tint = Tint::over((100.0, 200.0), &[]);
        assert_eq!((tint.at(0.0), tint.of(100.0)), (TINT[0], TINT[0]));
        assert_eq!((tint.at(2.0), tint.of(200.0)), (TINT[6], TINT[6]));
        let bands = Tint::over((100.0, 200.0), &[50.0, 150.0, 180.0]);
        assert_eq!(
            [100.0, 149.0, 150.0, 179.0, 190.0].map(|z| bands.of(z)),
            [125., 125., 165., 165., 190.].map(|z| tint.of(z))
        );
        let lightness: Vec<f64> = (0..=100).map(|i| to_oklab(tint.at(f64::from(i) / 100.0)).x).collect();
        assert!(lightness.windows(2).all(|w| w[1] > w[0] - 0.004), "{lightness:?}");
    }

    /// Colours as people without one kind of cones see them (Machado, Oliveira and Fernandes 2009, severity 1).
    const VISION: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ];

    fn linear(color: Rgb) -> [f64; 3] {
        color.map(|byte| {
            let v = f64::from(byte) / 255.0;
            if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        })
    }

    fn seen(color: Rgb, vision: &[[f64; 3]; 3]) -> Rgb {
        let light = linear(color);
        vision.map(|row| {
            let v = (0..3).map(|i| row[i] * light[i]).sum::<f64>().clamp(0.0, 1.0);
            let v = if v <= 0.0031308 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
            (v * 255.0).round() as u8
        })
    }

    #[test]
    fn colour_blind_people_tell_the_lines_apart() {
        let inks = [INPUT, INTERPOLATED, RIDGE, CANYON];
        for vision in &VISION {
            for (i, a) in inks.iter().enumerate() {
                for b in &inks[..i] {
                    let apart = to_oklab(seen(*a, vision)).distance(to_oklab(seen(*b, vision)));
                    assert!(apart > 0.1, "{a:?} {b:?} {apart} {vision:?}");
                }
            }
        }
    }

    #[test]
    fn contours_of_the_input_stand_out_on_the_deepest_shadow() {
        // Contrast ratio of WCAG 2: at least 3 for figures and lines that have to be seen.
        let luminance = |c: Rgb| linear(c).iter().zip([0.2126, 0.7152, 0.0722]).map(|(v, w)| v * w).sum::<f64>() + 0.05;
        for stop in TINT {
            let ratio = luminance(shaded(stop, 0.15)) / luminance(INPUT);
            assert!(ratio > 3.0, "{stop:?} {ratio}");
            assert!(luminance(shaded(stop, 1.0)) / luminance(INTERPOLATED) > 2.0, "{stop:?}");
        }
    }

    #[test]
    fn level_ground_keeps_its_tint() {
        assert_eq!(shaded([10, 100, 200], 1.0), [10, 100, 200]);
        assert!(shaded([100, 100, 100], 0.3)[0] < 100 && shaded([100, 100, 100], 1.3)[0] > 100);
    }
}
