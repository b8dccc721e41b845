//! A map on paper: the relief, the lines with their labels, the frame with its coordinates, and what stands around.

use glam::DVec2;

use super::fonts::Fonts;
use super::legend::{self, Content};
use super::lines::{Gap, Way};
use super::page::{COORDINATES, MARGIN, Page, Placed};
use super::shapes::{Look, Shape, Sheet, Text};
use super::shown::Shown;
use crate::coordinates::{Tick, Ticks};
use crate::preview::canvas::image_of;
use crate::preview::color::{BORDER, INK, INPUT};
use crate::preview::text::Align;
use crate::preview::{patches, plan, render, skeleton_lines, stroke};
use tokosen_core::base::Grid;
use tokosen_core::base::error::Result;
use tokosen_core::contour::{ContourLine, Source};
use tokosen_core::skeleton::SkeletonKind;
use tokosen_core::slice::{Label, LabelParams, place_labels};

/// Pixels of the relief in a millimetre, and most of them in all.
const FINENESS: (f64, f64) = (8.0, 16e6);
/// What counts as a pixel when it is judged whether lines have room, millimetres. Print is finer than a screen.
const PIXEL: f64 = 0.11;
/// The same for ridge and canyon lines.
const BREAK_PIXEL: f64 = 0.15;
/// Size of the text of labels, and height of its figures.
const LABEL: [f64; 2] = [2.2, 1.5];
/// Free space around a label.
const CLEARANCE: f64 = 0.5;
/// About this much of a line has one label.
const SPACING: f64 = 110.0;
/// With fewer levels of index contours than this, all contours of the input have labels.
const FEW_LEVELS: usize = 3;
/// Width of the light rim around labels.
const RIM: f64 = 0.3;
/// Size of the coordinates, and length of their ticks.
const COORDINATE: [f64; 2] = [2.3, 1.2];
/// Coordinates are as far apart as on a screen with pixels of this size.
pub(super) const TICK_PIXEL: f64 = 0.25;

/// Draws the sheet.
///
/// # Errors
/// As [`Page::place`]; if the relief cannot be drawn.
pub(crate) fn sheet(shown: &Shown<'_>, page: &Page, fonts: &Fonts) -> Result<Sheet> {
    let (lo, hi) = shown.extent;
    let input = &shown.preview;
    let placed = page.place(hi - lo, input.dem.metres_per_unit().map(|metres| metres.x))?;
    let inside = placed.frame[1] - placed.frame[0];
    let corner = DVec2::new(lo.x, hi.y);
    let way = Way::new(corner, placed);
    let cells = |millimetres: f64| {
        let count = (inside / millimetres).ceil().max(DVec2::ONE);
        Grid { corner, cell: DVec2::splat(placed.unit * millimetres), cols: count.x as usize, rows: count.y as usize }
    };
    let fineness = FINENESS.0.min((FINENESS.1 / inside.element_product()).sqrt());
    let fine = cells(1.0 / fineness);
    let dem = (shown.heights)(&fine);
    let tint = render::tint(&dem, input.levels);
    let mut relief = render::relief(&dem, tint.as_ref())?;
    if let Some(areas) = input.patches {
        patches::draw(&mut relief, &fine, areas);
        render::blank(&mut relief, &dem, input.outline);
    }
    let to = placed.frame[0] + DVec2::new(fine.cols as f64, fine.rows as f64) / fineness;
    let mut map = vec![Shape::Picture { from: placed.frame[0], to, image: image_of(&relief) }];

    let mut plan = plan::plan(input.contours, &cells(PIXEL));
    // Lines on paper do not fade.
    plan.input.iter_mut().chain(&mut plan.interpolated).for_each(|class| class.fades = false);
    let covered = dem.values.iter().filter(|z| z.is_finite()).count().max(1) as f64;
    let area = covered / (fineness * BREAK_PIXEL).powi(2);
    let size = (placed.unit * BREAK_PIXEL, area);
    let chosen = skeleton_lines::choose(input.skeleton_lines, input.frame, size, input.subject);
    let labels = labels(shown, &plan, &placed, fonts);
    let gaps: Vec<Gap> = labels.iter().map(|label| Gap::of(label, way)).collect();
    for (kind, style) in &plan.supplementary {
        let own = input.contours.iter().filter(|line| line.kind == Some(*kind));
        let lines = way.lines(own.map(|line| line.points.clone()), &gaps);
        map.push(Shape::Lines { lines, look: Look::of(*style, PIXEL) });
    }
    for source in [Source::Interpolated, Source::Input] {
        let Some(class) = plan.class(source) else { continue };
        for (is_index, style) in [(false, class.style), (true, class.index_style)] {
            for (inferred, style) in [(false, style), (true, stroke::dashed(style))] {
                let own = input.contours.iter().filter(|line| {
                    plan::drawn_as(line) == source
                        && plan.draws(line)
                        && plan.is_index(line) == is_index
                        && plan::is_inferred(line) == inferred
                });
                let lines = way.lines(own.map(|line| line.points.clone()), &gaps);
                map.push(Shape::Lines { lines, look: Look::of(style, PIXEL) });
            }
        }
    }
    for kind in [SkeletonKind::Canyon, SkeletonKind::Ridge] {
        let own = chosen.of(kind).map(|line| line.iter().map(|p| p.truncate()).collect());
        let style = stroke::skeleton_style(kind, chosen.width);
        map.push(Shape::Lines { lines: way.lines(own, &gaps), look: Look::of(style, BREAK_PIXEL) });
    }
    map.extend(labels.iter().map(|label| {
        Shape::Text(Text {
            text: label.text.clone(),
            at: way.to_sheet(label.position),
            size: LABEL[0],
            color: INPUT,
            align: Align::Center,
            turn: Some(-label.angle),
            rim: RIM,
        })
    }));
    let rings = input.outline.into_iter().flatten().flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors()));
    let rings = rings.map(|ring| ring.coords().map(|c| DVec2::new(c.x, c.y)).collect());
    let look = Look { color: BORDER, width: 0.5, dashes: None };
    map.push(Shape::Lines { lines: way.lines(rings, &[]), look });
    map.retain(|shape| !matches!(shape, Shape::Lines { lines, .. } if lines.is_empty()));

    let mut around =
        frame(&placed, &render::coordinates(input, inside / TICK_PIXEL, placed.unit * TICK_PIXEL, corner), fonts);
    let content = Content {
        page,
        placed: &placed,
        plan: &plan,
        chosen: &chosen,
        tint: tint.as_ref(),
        shown,
        note: render::notes(input, &plan),
    };
    around.extend(legend::shapes(&content, fonts));
    let Placed { paper, frame, scale, .. } = placed;
    Ok(Sheet { size: paper, frame, map, around, title: page.title.clone(), scale })
}

/// The labels of the contours that are drawn.
fn labels(shown: &Shown<'_>, plan: &plan::Plan, placed: &Placed, fonts: &Fonts) -> Vec<Label> {
    let has_input = plan.input.as_ref().is_some_and(|class| class.every.is_some());
    let is_labelled = |line: &ContourLine| match plan.index_levels < FEW_LEVELS {
        true => plan::drawn_as(line) == Source::Input || !has_input,
        false => plan.is_index(line),
    };
    let drawn: Vec<ContourLine> = shown
        .preview
        .contours
        .iter()
        .filter(|line| plan.draws(line))
        .map(|line| ContourLine { index: is_labelled(line), ..line.clone() })
        .collect();
    let (lo, hi) = shown.extent;
    let clearance = CLEARANCE * placed.unit;
    let params = LabelParams {
        char_width: fonts.width("0") * LABEL[0] * placed.unit,
        clearance,
        spacing: SPACING * placed.unit,
        unit: shown.preview.units.heights,
        within: Some([lo + clearance, hi - clearance]),
        ..LabelParams::new(LABEL[1] * placed.unit)
    };
    place_labels(&drawn, &params)
}

/// The frame of the map, with ticks and coordinates. The pixels of the ticks are [`TICK_PIXEL`] wide.
pub(super) fn frame(placed: &Placed, ticks: &Ticks, fonts: &Fonts) -> Vec<Shape> {
    let [from, to] = placed.frame;
    let corners = [from, DVec2::new(to.x, from.y), to, DVec2::new(from.x, to.y), from];
    let mut lines = vec![corners.to_vec()];
    let mut texts = Vec::new();
    let [size, tick] = COORDINATE;
    let width = |text: &str| fonts.width(text) * size;
    let text = |text: &str, at: DVec2, turn: Option<f64>| {
        let text = text.to_owned();
        Shape::Text(Text { text, at, size, color: INK, align: Align::Center, turn, rim: 0.0 })
    };
    for (edge, y, out) in [(&ticks.top, from.y, -1.0), (&ticks.bottom, to.y, 1.0)] {
        let mut free = MARGIN;
        for Tick { at, text: coordinate } in edge {
            let (x, half) = (from.x + at * TICK_PIXEL, width(coordinate) / 2.0);
            lines.push(vec![DVec2::new(x, y), DVec2::new(x, y + out * tick)]);
            if x - half >= free && x + half <= placed.paper.x - MARGIN {
                // The base line of figures above the map is just above the tick.
                let base = if out < 0.0 { y - tick - 0.6 } else { y + tick + 0.4 + 0.7 * size };
                texts.push(text(coordinate, DVec2::new(x, base), None));
                free = x + half + 3.0;
            }
        }
    }
    for (edge, x, out) in [(&ticks.left, from.x, -1.0), (&ticks.right, to.x, 1.0)] {
        let mut free = from.y;
        for Tick { at, text: coordinate } in edge {
            let (y, half) = (from.y + at * TICK_PIXEL, width(coordinate) / 2.0);
            lines.push(vec![DVec2::new(x, y), DVec2::new(x + out * tick, y)]);
            if y - half >= free && y + half <= to.y {
                // From bottom to top, as on printed sheets.
                texts.push(text(coordinate, DVec2::new(x + out * COORDINATES * 0.5, y), Some(-90.0)));
                free = y + half + 3.0;
            }
        }
    }
    let mut shapes = vec![Shape::Lines { lines, look: Look { color: INK, width: 0.25, dashes: None } }];
    shapes.extend(texts);
    shapes
}
