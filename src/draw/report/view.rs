//! A map on the page: a picture in its true proportions, in a frame with coordinates, and a scale bar.

use glam::DVec2;
use maud::{Markup, html};

use super::maps;
use crate::coordinates::{Notation, Tick, Ticks, ticks};
use crate::scale::{self, Bar};
use tokosen_core::base::{ElevationUnit, Grid};
use tokosen_core::raster::{RasterRows, metres_per_unit as metres_per_unit_of};

/// Size of the text, pixels.
const TEXT: f64 = 13.0;
/// Length of a tick.
const TICK: f64 = 5.0;
/// Space around the map for the coordinates.
const MARGIN: f64 = 26.0;
/// Further space below it for the scale bar.
const FOOT: f64 = 26.0;

/// How wide a map is on the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Width {
    /// As wide as the page.
    Page,
    /// Half of it, beside another one.
    Half,
}

/// A map's place in its picture, in pixels of the page.
pub(super) struct View {
    /// The cells that are shown.
    grid: Grid,
    /// Pixels of the page per map unit.
    scale: DVec2,
    ticks: Ticks,
    bar: Option<Bar>,
}

impl View {
    /// The cells of a height map that are shown, and the metres in a map unit.
    pub fn new(grid: &Grid, dem: &dyn RasterRows, metres_per_unit: DVec2, width: Width) -> Self {
        let extent = grid.cell * DVec2::new(grid.cols as f64, grid.rows as f64) * metres_per_unit;
        let longest = match width {
            Width::Page => 1000.0,
            Width::Half => 480.0,
        };
        let per_metre = longest / extent.max_element();
        let scale = metres_per_unit * per_metre;
        let place = |p: DVec2| Some(grid.corner + DVec2::new(p.x, -p.y) / scale);
        let ticks = ticks(extent * per_metre, Notation::of(dem.crs()), place);
        let metres = metres_per_unit_of(&dem.grid(), dem.crs()).map(|_| 1.0 / per_metre);
        Self {
            grid: *grid,
            scale,
            ticks,
            bar: scale::bar(extent.x * per_metre, metres, 1.0 / scale.x, ElevationUnit::Metre),
        }
    }

    fn size(&self) -> DVec2 {
        self.grid.cell * DVec2::new(self.grid.cols as f64, self.grid.rows as f64) * self.scale
    }

    /// A place in the picture.
    pub fn at(&self, p: DVec2) -> DVec2 {
        let d = p - self.grid.corner;
        DVec2::new(d.x, -d.y) * self.scale
    }

    /// A picture of the reduced cells, with marks over it. Its cells may reach beyond the map by less than one.
    pub fn picture(&self, data_uri: &str, marks: Markup) -> Markup {
        let size = self.size();
        let reduced = maps::reduction(&self.grid);
        let whole = |count: usize| (count.div_ceil(reduced) * reduced) as f64;
        let image = self.grid.cell * DVec2::new(whole(self.grid.cols), whole(self.grid.rows)) * self.scale;
        let view_box = format!("{} {} {} {}", -MARGIN, -MARGIN, size.x + 2.0 * MARGIN, size.y + 2.0 * MARGIN + FOOT);
        html! {
            svg.map viewBox=(view_box) role="img" {
                svg width=(size.x) height=(size.y) {
                    image href=(data_uri) width=(image.x) height=(image.y) preserveAspectRatio="none" {}
                    (marks)
                }
                (self.frame(size))
            }
        }
    }

    /// The frame, the coordinates around it, and the scale bar below it.
    fn frame(&self, size: DVec2) -> Markup {
        let Ticks { top, bottom, left, right } = &self.ticks;
        // Where a text would run into the corner, only its tick is drawn.
        let fits = |tick: &Tick, length: f64| {
            let half = tick.text.chars().count() as f64 * TEXT * 0.28;
            tick.at - half > -MARGIN && tick.at + half < length + MARGIN
        };
        html! {
            g.frame font-size=(TEXT) {
                rect width=(size.x) height=(size.y) fill="none" stroke="currentColor" {}
                @for (edge, y, out) in [(top, 0.0, -1.0), (bottom, size.y, 1.0)] {
                    @for tick in edge {
                        line x1=(tick.at) x2=(tick.at) y1=(y) y2=(y + out * TICK) stroke="currentColor" {}
                        @if fits(tick, size.x) {
                            text x=(tick.at) y=(y + out * 14.0 + 4.5) text-anchor="middle" { (tick.text) }
                        }
                    }
                }
                @for (edge, x, out) in [(left, 0.0, -1.0), (right, size.x, 1.0)] {
                    @for tick in edge {
                        line x1=(x) x2=(x + out * TICK) y1=(tick.at) y2=(tick.at) stroke="currentColor" {}
                        @if fits(tick, size.y) {
                            text text-anchor="middle" transform=(format!("translate({} {}) rotate(-90)", x + out * 14.0 + 4.5, tick.at)) { (tick.text) }
                        }
                    }
                }
                @if let Some(bar) = &self.bar {
                    g transform=(format!("translate(0 {})", size.y + MARGIN + 10.0)) {
                        path d=(format!("M0 -6V0H{0}V-6M{1} 0v-4", bar.pixels, bar.pixels / 2.0)) fill="none" stroke="currentColor" stroke-width="1.5" {}
                        text x=(bar.pixels + 8.0) y="1" { (bar.label) }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokosen_core::crs::Crs;
    use tokosen_core::raster::Dem;

    #[test]
    fn maps_have_a_scale_bar_and_coordinates_of_their_system() {
        let page = |epsg: Option<u32>, corner: DVec2, cell: f64| {
            let grid = Grid { corner, cell: DVec2::splat(cell), cols: 900, rows: 700 };
            let dem = Dem { grid, values: vec![], crs: epsg.map(Crs::from_epsg) };
            let metres = dem.metres_per_unit().unwrap_or(DVec2::ONE);
            View::new(&grid, &dem, metres, Width::Half).picture("data:,", html! {}).into_string()
        };
        let metric = page(Some(6690), DVec2::new(740_000.0, 4_030_000.0), 10.0);
        assert!(metric.contains(">745 000 E</text>") && metric.contains(">4 025 000 N</text>"), "{metric}");
        assert!(metric.contains(">2 km</text>"), "{metric}");
        let degrees = page(Some(6668), DVec2::new(138.0, 36.5), 0.001);
        assert!(degrees.contains(">138°30' E</text>") && degrees.contains(">36°00' N</text>"), "{degrees}");
        assert!(degrees.contains(" km</text>"), "{degrees}");
        let unknown = page(None, DVec2::new(0.0, 7000.0), 10.0);
        assert!(unknown.contains(">5000</text>") && unknown.contains(" map units</text>"), "{unknown}");
    }
}
