//! The choice of the contours that are drawn, and of their strength.
//!
//! Lines closer together than a few pixels merge into a grey tone. What counts is the spacing where the lines are, not
//! the mean over the map (see [`Density`]).
//!
//! * If too much of the input's lines is crowded, only every second, fifth, tenth ... level is drawn.
//! * Interpolated levels are thinned out until enough of them has room between all lines that are drawn. The step must
//!   divide the input's interval evenly. If no such step exists, the widest one is drawn where it has room; if that is hardly
//!   anywhere, none of them is drawn, and the legend says at which size they have room.
//! * What is crowded still, on steep slopes, fades out there. Index contours stay, as on printed maps.
//!
//! The legend says what is drawn.

use super::color::{INPUT, INTERPOLATED};
use super::density::Density;
use super::stroke::Style;
use tokosen_core::base::Grid;
use tokosen_core::contour::{ContourKind, ContourLine, Source};

/// Spacing at which the input's contours have room, pixels, and the share of their length that must have it.
const INPUT_ROOM: (f64, f64) = (3.2, 0.75);
/// Spacing at which interpolated contours have room among all lines that are drawn, and the share of the area with such
/// lines that must have it.
const INTERPOLATED_ROOM: (f64, f64) = (3.6, 0.3);
/// If that share is too small for every step of levels, the widest step is drawn all the same where it has room, if this share
/// of the area has it.
const SOME_ROOM: f64 = 0.03;
/// Lines fade out from the spacing at which they have room down to this share of it.
const GONE: f64 = 0.6;
/// The legend mentions that lines fade out if this share of them does.
const MENTIONED: f64 = 0.03;
/// From this spacing on, lines are drawn at full strength, pixels.
const EASY_SPACING: f64 = 12.0;
/// Interpolated levels are thinned out by this factor at most.
const MOST_PARTS: u32 = 50;
/// Levels closer than this are the same, metres.
const SAME_LEVEL: f64 = 1e-6;
/// Every so many drawn levels is an index contour, where the contours' own marks do not serve.
const INDEX_EVERY: u32 = 5;

/// Supplementary contours are thin and dashed, as on printed maps; those at a quarter of the interval have shorter dashes.
const SUPPLEMENTARY: Style = Style { color: INPUT, width: 0.8, alpha: 0.85, dashes: Some([7.0, 3.0]) };
const QUARTER: Style = Style { dashes: Some([2.5, 2.5]), ..SUPPLEMENTARY };

/// What is drawn of one source of contours.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Class {
    /// How the levels follow each other, if there is more than one.
    spacing: Option<Spacing>,
    /// Every n-th level is drawn; `None` if the lines are too dense and none is drawn.
    pub every: Option<u32>,
    pub style: Style,
    pub index_style: Style,
    /// Whether any of the drawn lines is an index contour.
    pub has_index: bool,
    /// Whether any of the drawn lines is only inferred.
    pub has_inferred: bool,
    /// The lines among which these need room.
    crowd: Density,
    /// The spacing at which they have it, pixels.
    room: f64,
    /// Whether some of them have none.
    pub fades: bool,
    /// How many times larger the picture must be so that lines have room; `None` if nobody asked.
    pub larger: Option<f64>,
}

/// What is drawn of the contours; `None` where there are none of the kind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan {
    /// The contours of the input, or those of a height map.
    pub input: Option<Class>,
    pub interpolated: Option<Class>,
    index: Index,
    /// Height between neighbouring index contours that are drawn, metres.
    pub index_interval: Option<f64>,
    /// Number of levels of index contours that are drawn.
    pub index_levels: usize,
    /// How supplementary contours are drawn, those that there are. They lie only where there is room.
    pub supplementary: Vec<(ContourKind, Style)>,
    /// Whether the contours are those of a height map.
    pub of_height_map: bool,
}

/// Whether a line is a supplementary contour.
fn is_supplementary(line: &ContourLine) -> bool {
    line.kind.is_some_and(ContourKind::is_supplementary)
}

/// The kind of line that a line is drawn as. Lines of a height map are drawn like those of the input.
pub(crate) fn drawn_as(line: &ContourLine) -> Source {
    match line.source {
        Source::Input | Source::HeightMap => Source::Input,
        Source::Interpolated => Source::Interpolated,
    }
}

/// Which contours are index contours in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Index {
    /// Those marked as such.
    Marked,
    /// Every fifth of these levels. Of a layer of finer contours, often all contours of the input are marked.
    Fifth(Spacing),
    /// None: there are too few levels.
    None,
}

/// Chooses the levels to draw on a map.
pub(crate) fn plan(contours: &[ContourLine], grid: &Grid) -> Plan {
    let is_drawn_as = |c: &ContourLine, source| drawn_as(c) == source && !is_supplementary(c);
    let of = |source| contours.iter().filter(move |c| is_drawn_as(c, source) && c.elevation.is_finite());
    let points = |line: &'_ &ContourLine| !line.points.is_empty();
    let density = |source| Density::of(grid, of(source).filter(points).map(|c| c.points.as_slice()));
    let (input_levels, new_levels) = (levels(of(Source::Input)), levels(of(Source::Interpolated)));
    let spacing = self::spacing(&input_levels);
    let mut drawn = Density::none(grid);
    let input = (!input_levels.is_empty()).then(|| {
        let all = density(Source::Input);
        let (room, share) = INPUT_ROOM;
        let fits = |every: &u32| {
            let kept = all.thinned(*every);
            kept.share_with_room(&kept, room) >= share
        };
        // A single level cannot be thinned out.
        let every = if spacing.is_some() { steps().find(fits) } else { Some(1) };
        drawn = every.map_or_else(|| Density::none(grid), |every| all.thinned(every));
        let strength = strength(drawn.spacing(), room);
        let style = Style { color: INPUT, width: 0.85 + 0.45 * strength, alpha: 0.85 + 0.1 * strength, dashes: None };
        let index_style = Style { width: style.width * 1.65, alpha: 0.95, ..style };
        Class::new(spacing, every, [style, index_style], drawn.clone(), &drawn, room)
    });
    let interpolated = (!new_levels.is_empty()).then(|| {
        let mut both: Vec<f64> = input_levels.iter().chain(&new_levels).copied().collect();
        sort_levels(&mut both);
        let all = self::spacing(&both);
        let even = |every: &u32| match (all, spacing) {
            (Some(all), Some(input)) => {
                let parts = input.interval / (all.interval * f64::from(*every));
                *every == 1 || (parts > 1.5 && (parts - parts.round()).abs() < 1e-6)
            }
            _ => *every == 1,
        };
        let new = density(Source::Interpolated);
        let (room, share) = INTERPOLATED_ROOM;
        let kept = |every: u32| new.thinned(every);
        let fits = |every: &u32| kept(*every).area_with_room(&drawn.and(&kept(*every)), room) >= share;
        let widest = (1..=MOST_PARTS).rfind(even);
        let has_some = |every: &u32| kept(*every).area_with_room(&drawn.and(&kept(*every)), room) >= SOME_ROOM;
        let every = (1..=MOST_PARTS).filter(even).find(fits).or(widest.filter(has_some));
        let larger = widest.map(|every| (room / drawn.and(&kept(every)).spacing()).ceil());
        let own = every.map_or_else(|| Density::none(grid), kept);
        let crowd = drawn.and(&own);
        let strength = strength(crowd.spacing(), room);
        let style =
            Style { color: INTERPOLATED, width: 0.65 + 0.3 * strength, alpha: 0.7 + 0.2 * strength, dashes: None };
        let index_style = Style { width: style.width * 1.6, alpha: (style.alpha + 0.15).min(1.0), ..style };
        Class { larger, ..Class::new(all, every, [style, index_style], crowd, &own, room) }
    });
    let of_height_map = contours.iter().any(|line| line.source == Source::HeightMap);
    let kinds = [(ContourKind::Supplementary, SUPPLEMENTARY), (ContourKind::SupplementaryQuarter, QUARTER)];
    let has = |kind: ContourKind| contours.iter().any(|line| line.kind == Some(kind));
    let supplementary = kinds.into_iter().filter(|(kind, _)| has(*kind)).collect();
    let (index, index_interval, index_levels) = (Index::Marked, None, 0);
    let plan = Plan { input, interpolated, index, index_interval, index_levels, supplementary, of_height_map };
    plan.with_index(contours)
}

impl Plan {
    /// Chooses the index contours, and notes what occurs among the lines that are drawn.
    fn with_index(mut self, contours: &[ContourLine]) -> Self {
        let leading = self.input.as_ref().filter(|class| class.every.is_some()).or(self.interpolated.as_ref());
        if let Some(Class { spacing: Some(spacing), every: Some(every), .. }) = leading {
            let source = if self.input.as_ref() == leading { Source::Input } else { Source::Interpolated };
            let step = Spacing { interval: spacing.interval * f64::from(*every), ..*spacing };
            let shown = || contours.iter().filter(|c| drawn_as(c) == source && self.draws(c));
            let all = levels(shown());
            let marked = levels(shown().filter(|c| c.index)).len();
            let fifth = all.iter().filter(|level| keeps(**level, Some(step), INDEX_EVERY)).count();
            self.index = match () {
                // One bold level among few says nothing.
                () if all.len() < 2 * INDEX_EVERY as usize && marked.min(fifth) < 2 => Index::None,
                () if marked * 2 <= all.len() => Index::Marked,
                () => Index::Fifth(step),
            };
        }
        let index_levels = levels(contours.iter().filter(|c| self.draws(c) && self.is_index(c)));
        self.index_interval = spacing(&index_levels).map(|spacing| spacing.interval);
        self.index_levels = index_levels.len();
        for line in contours {
            let (draws, index) = (self.draws(line), self.is_index(line));
            let class = match drawn_as(line) {
                Source::Interpolated => self.interpolated.as_mut(),
                _ => self.input.as_mut(),
            };
            if let Some(class) = class.filter(|_| draws) {
                class.has_index |= index;
                class.has_inferred |= is_inferred(line);
            }
        }
        self
    }

    /// What is drawn of a source.
    pub fn class(&self, source: Source) -> Option<&Class> {
        match source {
            Source::Input | Source::HeightMap => self.input.as_ref(),
            Source::Interpolated => self.interpolated.as_ref(),
        }
    }

    /// Whether a line is drawn.
    pub fn draws(&self, line: &ContourLine) -> bool {
        !is_supplementary(line) && self.class(line.source).is_some_and(|class| class.draws(line.elevation))
    }

    /// Whether a line is an index contour of the picture.
    pub fn is_index(&self, line: &ContourLine) -> bool {
        match self.index {
            Index::Marked => line.index,
            Index::None => false,
            Index::Fifth(spacing) => keeps(line.elevation, Some(spacing), INDEX_EVERY),
        }
    }
}

impl Class {
    fn new(
        spacing: Option<Spacing>,
        every: Option<u32>,
        [style, index_style]: [Style; 2],
        crowd: Density,
        own: &Density,
        room: f64,
    ) -> Self {
        let fades = own.share_with_room(&crowd, room) < 1.0 - MENTIONED;
        Self {
            spacing,
            every,
            style,
            index_style,
            has_index: false,
            has_inferred: false,
            crowd,
            room,
            fades,
            larger: None,
        }
    }

    /// The usual step between neighbouring levels, metres.
    pub fn interval(&self) -> Option<f64> {
        self.spacing.map(|spacing| spacing.interval)
    }

    /// Whether lines of this elevation are drawn.
    fn draws(&self, elevation: f64) -> bool {
        elevation.is_finite() && self.every.is_some_and(|every| keeps(elevation, self.spacing, every))
    }

    /// How strongly lines are drawn around a pixel, 0 to 1.
    pub fn strength_at(&self, col: usize, row: usize) -> f64 {
        let density = self.crowd.at(col, row);
        if density * self.room <= 1.0 {
            return 1.0;
        }
        let share = (1.0 / (density * self.room) - GONE) / (1.0 - GONE);
        share.clamp(0.0, 1.0)
    }
}

/// Whether a line is inferred: the contours say little about the height there.
pub(crate) fn is_inferred(line: &ContourLine) -> bool {
    line.expected.is_some_and(|expected| expected.inferred)
}

/// 0 at the narrowest spacing that is drawn, 1 from the spacing of full strength on.
fn strength(spacing: f64, narrowest: f64) -> f32 {
    ((spacing - narrowest) / (EASY_SPACING - narrowest)).clamp(0.0, 1.0) as f32
}

/// 1, 2, 5, 10, 20 ...
fn steps() -> impl Iterator<Item = u32> {
    (0..6).flat_map(|exponent| [1, 2, 5].map(|digit| digit * 10_u32.pow(exponent)))
}

/// The levels in increasing order, each once.
fn levels<'a>(lines: impl Iterator<Item = &'a ContourLine>) -> Vec<f64> {
    let mut all: Vec<f64> = lines.map(|line| line.elevation).filter(|level| level.is_finite()).collect();
    sort_levels(&mut all);
    all
}

fn sort_levels(levels: &mut Vec<f64>) {
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|next, kept| *next - *kept < SAME_LEVEL);
}

/// The commonest step between neighbouring levels; of equally common ones the smallest.
fn spacing(levels: &[f64]) -> Option<Spacing> {
    let gap = |w: &[f64]| w[1] - w[0];
    let mut gaps: Vec<f64> = levels.windows(2).map(gap).collect();
    gaps.sort_by(f64::total_cmp);
    let runs = gaps.chunk_by(|a, b| b - a < SAME_LEVEL);
    let longest = runs.clone().map(<[f64]>::len).max()?;
    let interval = runs.into_iter().find(|run| run.len() == longest)?[0];
    let base = levels.windows(2).find(|w| (gap(w) - interval).abs() < SAME_LEVEL)?[0].rem_euclid(interval);
    let base = if interval - base < SAME_LEVEL { 0.0 } else { base };
    Some(Spacing { interval, base })
}

/// Levels that are whole multiples of an interval above a base.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Spacing {
    interval: f64,
    base: f64,
}

/// Whether a level is among every `every`-th of the spaced levels.
fn keeps(elevation: f64, spacing: Option<Spacing>, every: u32) -> bool {
    match spacing {
        _ if every == 1 => true,
        Some(Spacing { interval, base }) => {
            let step = interval * f64::from(every);
            let count = (elevation - base) / step;
            (count - count.round()).abs() * step < interval * 1e-3
        }
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    const GRID: Grid = Grid { corner: DVec2::new(0.0, 400.0), cell: DVec2::ONE, cols: 400, rows: 400 };

    /// Level lines across the whole map, `apart` pixels and `step` metres apart.
    fn lines(apart: f64, step: f64, source: Source) -> Vec<ContourLine> {
        (0..=(400.0 / apart) as usize)
            .map(|i| {
                let y = i as f64 * apart;
                let points = vec![DVec2::new(0.0, y), DVec2::new(400.0, y)];
                let elevation = i as f64 * step;
                ContourLine {
                    elevation,
                    points,
                    source,
                    index: i % 5 == 0,
                    kind: None,
                    depression: false,
                    expected: None,
                }
            })
            .collect()
    }

    #[test]
    fn sparse_lines_are_all_drawn() {
        let mut all = lines(20.0, 20.0, Source::Input);
        all.extend(lines(10.0, 10.0, Source::Interpolated).into_iter().map(|l| ContourLine { index: false, ..l }));
        let plan = plan(&all, &GRID);
        let (input, new) = (plan.input.as_ref().unwrap(), plan.interpolated.as_ref().unwrap());
        assert_eq!((input.interval(), input.every, input.has_index, input.fades), (Some(20.0), Some(1), true, false));
        assert_eq!((new.interval(), new.every, new.has_index, new.fades), (Some(10.0), Some(1), false, false));
        assert_eq!((plan.index_interval, plan.index_levels), (Some(100.0), 5));
        assert_eq!(input.strength_at(200, 200), 1.0);
    }

    #[test]
    fn dense_lines_are_thinned_by_levels_and_at_last_left_out() {
        let drawn = |apart: f64| {
            let mut all = lines(20.0 * apart, 20.0, Source::Input);
            all.extend(lines(apart, 1.0, Source::Interpolated));
            plan(&all, &GRID).interpolated.unwrap()
        };
        assert_eq!([4.0, 2.5, 1.1, 0.6].map(|apart| drawn(apart).every), [Some(1), Some(2), Some(4), Some(10)]);
        let thinned = drawn(1.1);
        assert!(thinned.draws(32.0) && !thinned.draws(30.0));
        assert_eq!(drawn(0.2).every, None);
        let input = |apart: f64| plan(&lines(apart, 10.0, Source::Input), &GRID).input.unwrap();
        assert_eq!([4.0, 2.0, 0.7, 0.35].map(|apart| input(apart).every), [Some(1), Some(2), Some(5), Some(10)]);
    }

    #[test]
    fn lines_fade_where_they_are_crowded_and_nowhere_else() {
        // Most of the map has one line in five pixels. A strip along the right side has further ones, one in two.
        let mut all = lines(5.0, 10.0, Source::Input);
        all.extend(lines(2.0, 4.0, Source::Input).into_iter().map(|mut line| {
            line.points[0].x = 376.0;
            line
        }));
        let class = plan(&all, &GRID).input.unwrap();
        assert_eq!((class.fades, class.every), (true, Some(1)));
        assert_eq!((class.strength_at(100, 200), class.strength_at(395, 200)), (1.0, 0.0));
    }

    #[test]
    fn index_contours_are_fewer_than_the_others() {
        // Densified from 20 m to 4 m, all of the input's contours are marked.
        let mut all: Vec<ContourLine> =
            lines(40.0, 20.0, Source::Input).into_iter().map(|line| ContourLine { index: true, ..line }).collect();
        all.extend(lines(8.0, 4.0, Source::Interpolated).into_iter().map(|l| ContourLine { index: false, ..l }));
        let plan = plan(&all, &GRID);
        assert_eq!((plan.index_interval, plan.index_levels), (Some(100.0), 3));
        assert!(plan.is_index(&all[5]) && !plan.is_index(&all[4]));
        // Thinned out to one of five, marked lines are all that is drawn.
        let dense = self::plan(&lines(0.7, 10.0, Source::Input), &GRID);
        assert_eq!((dense.index_interval, dense.input.unwrap().every), (Some(250.0), Some(5)));
    }

    #[test]
    fn the_commonest_step_is_the_interval() {
        let levels = [0.0, 5.0, 10.0, 20.0, 30.0, 40.0];
        assert_eq!(spacing(&levels), Some(Spacing { interval: 10.0, base: 0.0 }));
        assert_eq!(spacing(&levels[..1]), None);
        assert_eq!(spacing(&[]), None);
        let shifted = spacing(&[-8.5, 1.5, 11.5, 21.5]);
        assert_eq!(shifted, Some(Spacing { interval: 10.0, base: 1.5 }));
        assert!(keeps(-18.5, shifted, 2) && !keeps(-8.5, shifted, 2) && keeps(1.5, shifted, 2));
    }
}
