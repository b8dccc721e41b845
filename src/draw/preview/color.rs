//! Colours: the hypsometric tint, its relief shading, and the inks of the lines.

use glam::DVec3;

/// A colour as sRGB bytes.
pub(super) type Rgb = [u8; 3];

/// Paper around the map and where there is no data.
pub(super) const PAPER: Rgb = [255, 255, 255];
/// Text, frame, scale bar.
pub(super) const INK: Rgb = [52, 48, 44];
/// Contours.
pub(super) const CONTOUR: Rgb = [74, 48, 26];
/// Ridge lines.
pub(super) const RIDGE: Rgb = [196, 46, 18];
/// Canyon lines.
pub(super) const CANYON: Rgb = [20, 84, 190];

/// The tint from the lowest to the highest ground: the higher the lighter and warmer, as mountains are seen from above
/// through the air. Evenly spaced.
const STOPS: [Rgb; 7] = [
    [122, 163, 134],
    [156, 187, 143],
    [193, 207, 156],
    [223, 217, 170],
    [233, 216, 180],
    [240, 226, 204],
    [250, 246, 238],
];

/// Shadows are cool and highlights warm, which keeps the tint readable in both.
const SHADOW: [f64; 3] = [50.0, 56.0, 82.0];
const HIGHLIGHT: [f64; 3] = [255.0, 253.0, 240.0];

/// The tint as a table, interpolated in Oklab so that equal steps of height look equally large.
pub(super) struct Tint {
    table: Vec<Rgb>,
}

impl Tint {
    pub fn new() -> Self {
        let stops = STOPS.map(to_oklab);
        let size = 512;
        let table = (0..size)
            .map(|i| {
                let at = f64::from(i) / f64::from(size - 1) * (stops.len() - 1) as f64;
                let first = (at as usize).min(stops.len() - 2);
                from_oklab(stops[first].lerp(stops[first + 1], at - first as f64))
            })
            .collect();
        Self { table }
    }

    /// The colour at a share of the height range, 0 to 1.
    pub fn at(&self, share: f64) -> Rgb {
        let last = self.table.len() - 1;
        self.table[((share.clamp(0.0, 1.0) * last as f64).round() as usize).min(last)]
    }
}

/// Shades a colour: `light` is 1 on level ground, less in the shadow, more towards the light.
pub(super) fn shaded(color: Rgb, light: f64) -> Rgb {
    let (target, share) = if light < 1.0 {
        (SHADOW, 0.66 * (1.0 - light.max(0.0)))
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
        let tint = Tint::new();
        assert_eq!(tint.at(0.0), STOPS[0]);
        assert_eq!(tint.at(2.0), STOPS[6]);
        let lightness: Vec<f64> = (0..=100).map(|i| to_oklab(tint.at(f64::from(i) / 100.0)).x).collect();
        assert!(lightness.windows(2).all(|w| w[1] > w[0] - 0.004), "{lightness:?}");
    }

    #[test]
    fn level_ground_keeps_its_tint() {
        assert_eq!(shaded([10, 100, 200], 1.0), [10, 100, 200]);
        assert!(shaded([100, 100, 100], 0.3)[0] < 100 && shaded([100, 100, 100], 1.3)[0] > 100);
    }
}
