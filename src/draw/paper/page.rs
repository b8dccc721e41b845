//! The paper and the scale of a map.

use glam::DVec2;

use crate::scale::number;
use tokosen_core::base::error::{Error, Result};

/// Paper around everything, millimetres.
pub(super) const MARGIN: f64 = 12.0;
/// Room for coordinates around the map.
pub(super) const COORDINATES: f64 = 6.0;
/// Room above the map for the title and a note, and for the note alone.
pub(super) const HEAD: [f64; 2] = [13.0, 6.0];
/// Height of a row of the legend, and room above the legend.
pub(super) const LEGEND: [f64; 2] = [17.0, 5.0];
/// Paper that is less wide has two rows of legend.
pub(super) const NARROW: f64 = 290.0;
/// Room for the line about the source.
pub(super) const FOOT: f64 = 5.0;
/// Usual scales, times powers of ten.
const USUAL: [f64; 10] = [1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.5];
/// The longest side of paper, millimetres.
const LONGEST: f64 = 5000.0;
/// The shortest one.
const SHORTEST: f64 = 100.0;

/// A size of paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paper {
    /// Sides, millimetres; the longer one first, unless they are width and height as they are.
    sides: [f64; 2],
    /// Whether the sides are width and height as they are.
    is_fixed: bool,
}

impl Paper {
    /// The usual sizes.
    pub const A: [Self; 5] = [
        Self { sides: [297.0, 210.0], is_fixed: false },
        Self { sides: [420.0, 297.0], is_fixed: false },
        Self { sides: [594.0, 420.0], is_fixed: false },
        Self { sides: [841.0, 594.0], is_fixed: false },
        Self { sides: [1189.0, 841.0], is_fixed: false },
    ];

    /// The size of a name, `A4` to `A0`, or of `WIDTHxHEIGHT` in millimetres.
    ///
    /// # Errors
    /// It is neither, or no printer has it. The message is the end of a sentence.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let name = text.to_ascii_uppercase();
        if let Some(k) = name.strip_prefix('A').and_then(|k| k.parse::<usize>().ok()).filter(|k| *k < 5) {
            return Ok(Self::A[4 - k]);
        }
        let sides: Vec<f64> = name.split('X').filter_map(|side| side.trim().parse().ok()).collect();
        match sides.as_slice() {
            &[width, height] if [width, height].iter().all(|side| (SHORTEST..=LONGEST).contains(side)) => {
                Ok(Self { sides: [width, height], is_fixed: true })
            }
            [_, _] => Err(format!("sides must be from {SHORTEST} to {LONGEST} mm")),
            _ => Err("it must be A4, A3, A2, A1, A0, or width x height in millimetres, such as 700x500".into()),
        }
    }

    /// How it may lie: width and height.
    fn ways(self) -> Vec<DVec2> {
        let [long, short] = self.sides;
        let lying = DVec2::new(long, short);
        if self.is_fixed { vec![lying] } else { vec![lying, DVec2::new(short, long)] }
    }

    /// Its name.
    fn name(self) -> String {
        match Self::A.iter().position(|paper| *paper == self) {
            Some(k) => format!("A{}", 4 - k),
            None => format!("{} x {} mm", self.sides[0], self.sides[1]),
        }
    }
}

/// What a sheet looks like.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Page {
    /// The paper. If `None`: the smallest of A4 to A0 on which the map has its scale, or A3 if there is no scale.
    pub paper: Option<Paper>,
    /// The scale, 1 to this number. If `None`, the largest usual one at which the map fits.
    pub scale: Option<f64>,
    /// A title above the map.
    pub title: Option<String>,
    /// A line below everything, such as the source of the map.
    pub source: Option<String>,
}

/// Where the map lies on its paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    /// Width and height of the paper.
    pub paper: DVec2,
    /// Upper left and lower right corner of the map.
    pub frame: [DVec2; 2],
    /// Map units in a millimetre.
    pub unit: f64,
    /// The scale, if the metres in a map unit are known.
    pub scale: Option<f64>,
}

impl Page {
    /// Room around the map: to the left and above, to the right and below.
    fn around(&self, paper: DVec2) -> [DVec2; 2] {
        let head = HEAD[usize::from(self.title.is_none())];
        let rows = if paper.x < NARROW { 2.0 } else { 1.0 };
        let [row, gap] = LEGEND;
        let side = MARGIN + COORDINATES;
        [DVec2::new(side, side + head), DVec2::new(side, side + gap + rows * row + FOOT)]
    }

    /// Room for the map.
    fn room(&self, paper: DVec2) -> DVec2 {
        let [before, after] = self.around(paper);
        paper - before - after
    }

    /// Places a map of a size in map units. `metres` are those in a map unit.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the map does not fit, or if there can be no scale; the message says what fits.
    pub(super) fn place(&self, size: DVec2, metres: Option<f64>) -> Result<Placed> {
        let Some(metres) = metres else {
            let message = "the unit of x and y is not known, so the map has no scale: state it, or leave the scale out";
            if self.scale.is_some() {
                return Err(Error::Parameter(message.into()));
            }
            let paper = self.paper.unwrap_or(Paper::A[1]);
            let (paper, unit) = self.best(paper, size);
            return Ok(self.placed(paper, size, unit, None));
        };
        let ground = size * metres;
        let Some(scale) = self.scale else {
            let (paper, unit) = self.best(self.paper.unwrap_or(Paper::A[1]), ground);
            let scale = usual(unit * 1000.0);
            return Ok(self.placed(paper, size, scale / 1000.0 / metres, Some(scale)));
        };
        let need = ground * 1000.0 / scale;
        let fits = |paper: Paper| {
            let mut ways = paper.ways().into_iter();
            ways.find(|way| self.room(*way).cmpge(need - 1e-6).all())
        };
        let papers = self.paper.map_or_else(|| Paper::A.to_vec(), |paper| vec![paper]);
        if let Some(paper) = papers.iter().find_map(|paper| fits(*paper)) {
            return Ok(self.placed(paper, size, scale / 1000.0 / metres, Some(scale)));
        }
        let largest = papers.last().copied().unwrap_or(Paper::A[4]);
        let (_, unit) = self.best(largest, ground);
        Err(Error::Parameter(format!(
            "at 1:{} the map is {:.0} x {:.0} mm, too large for {}: take 1:{}, a larger paper, or a part of the map",
            number(scale),
            need.x,
            need.y,
            largest.name(),
            number(usual(unit * 1000.0))
        )))
    }

    /// How the paper lies best for a map of a size, and how much of the size is in a millimetre then.
    fn best(&self, paper: Paper, size: DVec2) -> (DVec2, f64) {
        let unit = |way: &DVec2| (size / self.room(*way).max(DVec2::ONE)).max_element();
        let ways = paper.ways().into_iter().map(|way| (way, unit(&way)));
        // Of two ways with the same scale, the paper lies as the map does.
        let is_across = |way: &DVec2| (way.x > way.y) != (size.x > size.y);
        let key = |(way, unit): &(DVec2, f64)| (usual(*unit), is_across(way));
        let order = |a: &(DVec2, f64), b: &(DVec2, f64)| {
            let ((a, across_a), (b, across_b)) = (key(a), key(b));
            a.total_cmp(&b).then(across_a.cmp(&across_b))
        };
        ways.min_by(order).unwrap_or((DVec2::ONE, 1.0))
    }

    /// The map at the top of its room, in the middle from left to right.
    fn placed(&self, paper: DVec2, size: DVec2, unit: f64, scale: Option<f64>) -> Placed {
        let [before, _] = self.around(paper);
        let (room, own) = (self.room(paper), size / unit);
        let from = before + DVec2::new(((room.x - own.x) / 2.0).max(0.0), 0.0);
        Placed { paper, frame: [from, from + own], unit, scale }
    }
}

/// The smallest usual number of a scale that is not below a number.
pub(super) fn usual(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    let all = USUAL.iter().map(|digit| digit * power).chain([10.0 * power]);
    all.into_iter().find(|usual| *usual >= least * (1.0 - 1e-9)).unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_have_a_usual_scale_and_lie_as_they_fit() {
        let page = Page { paper: Some(Paper::A[1]), ..Page::default() };
        let wide = page.place(DVec2::new(9000.0, 5000.0), Some(1.0)).unwrap();
        assert_eq!((wide.paper, wide.scale), (DVec2::new(420.0, 297.0), Some(25_000.0)));
        assert!(((wide.frame[1] - wide.frame[0]) - DVec2::new(360.0, 200.0)).length() < 1e-9, "{wide:?}");
        let tall = page.place(DVec2::new(3000.0, 6000.0), Some(1.0)).unwrap();
        assert_eq!((tall.paper, tall.scale), (DVec2::new(297.0, 420.0), Some(20_000.0)));
        // Both ways give 1:50 000.
        let nearly_square = page.place(DVec2::new(12_500.0, 9500.0), Some(1.0)).unwrap();
        assert_eq!((nearly_square.paper.x, nearly_square.scale), (420.0, Some(50_000.0)));
        // Feet.
        let feet = page.place(DVec2::new(9000.0, 5000.0), Some(0.3048)).unwrap();
        assert_eq!(feet.scale, Some(7500.0));
        assert_eq!(page.place(DVec2::ONE, None).unwrap().scale, None);
        assert_eq!([999.0, 1000.0, 1001.0, 7600.0].map(usual), [1000.0, 1000.0, 1250.0, 10_000.0]);
    }

    #[test]
    fn a_scale_chooses_its_paper_or_says_what_fits() {
        let at = |scale: f64, paper: Option<Paper>| {
            Page { paper, scale: Some(scale), ..Page::default() }.place(DVec2::new(1500.0, 1000.0), Some(1.0))
        };
        assert_eq!(at(10_000.0, None).unwrap().paper, DVec2::new(297.0, 210.0));
        assert_eq!(at(2500.0, None).unwrap().paper, DVec2::new(841.0, 594.0));
        let error = at(2500.0, Some(Paper::A[1])).unwrap_err().to_string();
        assert!(error.contains("600 x 400 mm, too large for A3: take 1:5000"), "{error}");
        let error = at(500.0, None).unwrap_err().to_string();
        assert!(error.contains("too large for A0: take 1:1500"), "{error}");
    }

    #[test]
    fn papers_have_names_or_sides() {
        assert_eq!(Paper::from_text("a3"), Ok(Paper::A[1]));
        assert_eq!(Paper::from_text("700x500").map(|p| p.ways()), Ok(vec![DVec2::new(700.0, 500.0)]));
        for wrong in ["A5", "B4", "700", "700x", "1x1", "ax3", "", "9000x500", "nanx500"] {
            assert!(Paper::from_text(wrong).is_err(), "{wrong}");
        }
    }
}
