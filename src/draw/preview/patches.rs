//! Areas filled in the colour of their class, through which the relief still shows.

use glam::DVec2;
use tiny_skia::{FillRule, Path, PathBuilder, Pixmap, Transform};

use super::canvas::paint;
use super::color::{INK, Rgb};
use super::stroke::{Style, stroke, to_pixels};
use tokosen_core::base::Grid;

/// Opacity of the fill, 0 to 1.
const ALPHA: f32 = 0.6;
/// The line around each area.
const OUTLINE: Style = Style { color: INK, width: 0.6, alpha: 0.5, dashes: None };
/// Vertices closer than this to the last one are left out, pixels.
const FINE: f64 = 0.3;
/// Coordinates are clamped to this distance from the map's corner, pixels, because the rasteriser loses digits beyond
/// it.
const FAR: f64 = 1e5;

/// A class of areas, as the legend names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PatchClass {
    /// Its name in the legend.
    pub name: String,
    /// Its colour, sRGB.
    pub color: [u8; 3],
}

/// An area.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Its class, by its place in [`Patches::classes`].
    pub class: usize,
    /// Its outlines in map units; what an odd number of them encloses is filled.
    pub rings: Vec<Vec<DVec2>>,
}

/// Areas by class.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Patches {
    /// The classes; the legend lists those that occur.
    pub classes: Vec<PatchClass>,
    /// The areas. Those of a class that is not listed, and those with a point that is not finite, are passed over.
    pub areas: Vec<Patch>,
}

impl Patches {
    /// The names of the classes that occur, and their colours as they look on white paper.
    pub(crate) fn present(&self) -> Vec<(Rgb, String)> {
        let on_paper = |c: u8| (f32::from(c) * ALPHA + 255.0 * (1.0 - ALPHA)).round() as u8;
        let occurs = |class: usize| self.areas.iter().any(|area| area.class == class);
        let classes = self.classes.iter().enumerate().filter(|(class, _)| occurs(*class));
        classes.map(|(_, class)| (class.color.map(on_paper), class.name.clone())).collect()
    }
}

/// Fills and outlines the areas.
pub(crate) fn draw(map: &mut Pixmap, grid: &Grid, patches: &Patches) {
    let mut drawn = Vec::new();
    for area in &patches.areas {
        let Some(class) = patches.classes.get(area.class) else { continue };
        let Some(path) = path(grid, &area.rings) else { continue };
        map.fill_path(&path, &paint(class.color, ALPHA), FillRule::EvenOdd, Transform::identity(), None);
        drawn.push(path);
    }
    drawn.into_iter().for_each(|path| stroke(map, Some(path), OUTLINE, None));
}

/// The rings as one path in pixels, none if they lie outside of the map.
fn path(grid: &Grid, rings: &[Vec<DVec2>]) -> Option<Path> {
    if !rings.iter().flatten().all(|p| p.is_finite()) {
        return None;
    }
    let size = DVec2::new(grid.cols as f64, grid.rows as f64);
    let mut path = PathBuilder::new();
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for ring in rings {
        let mut last: Option<DVec2> = None;
        for &point in ring {
            let at = to_pixels(grid, point).clamp(DVec2::splat(-FAR), DVec2::splat(FAR));
            (low, high) = (low.min(at), high.max(at));
            match last {
                None => path.move_to(at.x as f32, at.y as f32),
                Some(last) if last.distance_squared(at) < FINE * FINE => continue,
                Some(_) => path.line_to(at.x as f32, at.y as f32),
            }
            last = Some(at);
        }
        path.close();
    }
    let is_seen = low.cmplt(size).all() && high.cmpgt(DVec2::ZERO).all();
    path.finish().filter(|_| is_seen)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_filled_with_their_holes_left_out() {
        let grid = Grid { corner: DVec2::new(0.0, 100.0), cell: DVec2::ONE, cols: 100, rows: 100 };
        let square =
            |h: f64| [(-h, -h), (h, -h), (h, h), (-h, h), (-h, -h)].map(|(x, y)| DVec2::new(50.0 + x, 50.0 + y));
        let patch = |rings: Vec<Vec<DVec2>>| Patch { class: 1, rings };
        let classes = ["a", "b"].map(|name| PatchClass { name: name.into(), color: [0, 0, 255] }).to_vec();
        let mut areas = vec![patch(vec![square(40.0).to_vec(), square(20.0).to_vec()])];
        areas.push(patch(vec![vec![DVec2::NAN, DVec2::ZERO, DVec2::ONE]]));
        areas.push(patch(vec![square(1e300).map(|p| p + 1e301).to_vec()]));
        areas.push(Patch { class: 7, rings: vec![square(49.0).to_vec()] });
        let patches = Patches { classes, areas };
        let mut map = Pixmap::new(100, 100).unwrap();
        map.fill(tiny_skia::Color::WHITE);
        draw(&mut map, &grid, &patches);
        let red = |x: u32, y: u32| map.pixel(x, y).unwrap().red();
        assert_eq!((red(50, 50), red(3, 50)), (255, 255));
        assert!(red(20, 50).abs_diff(102) <= 1, "{}", red(20, 50));
        assert_eq!(patches.present(), [([102, 102, 255], "b".to_owned())]);
    }
}
