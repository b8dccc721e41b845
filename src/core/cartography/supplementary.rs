//! Supplementary contours: lines at half and at a quarter of the interval, where the ground between the other contours needs them.

use glam::DVec2;

use super::ground::Ground;
use super::nearest::{Edge, Nearest, Neighbour};
use super::pieces::{Drawn, drawn};
use super::rules;
use super::tops::{Ring, tops};
use crate::base::parallel;
use crate::contour::{ContourKind, ContourLayer, ContourLine, Source};

/// Supplementary contours keep at least this share of the distance at which they are needed from the others: 0.25 mm on a map where
/// it is 15 mm.
const CLOSEST: f64 = rules::CLOSEST / rules::APART;

/// What becomes of contours of the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OfInput {
    /// They stay whole, whatever their level.
    Whole,
    /// They are treated as new ones: those at the interval stay, supplementary ones where they are needed. Others are left out.
    AsNew,
}

/// What became of the supplementary contours.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SupplementaryCount {
    /// Number of lines and pieces of lines at half of the interval, and at a quarter of it.
    pub pieces: [usize; 2],
    /// Their length, metres.
    pub drawn: f64,
    /// Their length if they were drawn everywhere, metres.
    pub all: f64,
    /// Length of all lines that are written, metres.
    pub total: f64,
}

/// Keeps the supplementary contours of a layer only where the ground needs them. The layer has the contours at all its levels, as
/// whole lines, each with its kind.
///
/// A line at half of the interval is needed
///
/// * where the contours of the two levels beside it are at least `apart` metres from each other. The distance is
///   that from a vertex to the nearest one of each level. Across a top it is that between opposite places of the ring around;
/// * as a ring around a top or a hollow that no other contour shows.
///
/// For a line at a quarter of the interval, the contours beside it are those at half of it too. A piece goes on until these come
/// closer than four fifths of the distance. Gaps shorter than a third of it are closed, and pieces shorter than two thirds left
/// out. A ring of which 70 % are needed is drawn as a whole. Pieces end at vertices, so no vertex moves and nothing crosses.
///
/// Contours of the input stay whole if `input` says so. The time grows with the number of vertices, times its logarithm.
pub fn keep_supplementary(layer: &mut ContourLayer, apart: f64, input: OfInput, ground: &Ground) -> SupplementaryCount {
    let metres = ground.metres;
    let lines = std::mem::take(&mut layer.lines);
    let rank = |line: &ContourLine| match line.kind {
        Some(ContourKind::Supplementary) => 1,
        Some(ContourKind::SupplementaryQuarter) => 2,
        Some(ContourKind::Index | ContourKind::Intermediate) | None => 0,
    };
    let is_kept = |line: &ContourLine| input == OfInput::Whole && line.source == Source::Input;
    let of = |wanted: &dyn Fn(&ContourLine) -> bool| -> Vec<u32> {
        (0..).zip(&lines).filter(|(_, line)| wanted(line)).map(|(number, _)| number).collect()
    };
    let border = Edge::new(&ground.border, metres);
    let mut chosen: Vec<Drawn> = vec![Drawn::Whole; lines.len()];
    for own in [1, 2] {
        let asked = of(&|line| rank(line) == own && !is_kept(line));
        if asked.is_empty() {
            continue;
        }
        let around = of(&|line| rank(line) < own);
        let nearest = Nearest::new(&lines, &around, metres);
        let others = Nearest::new(&lines, &of(&|line| rank(line) <= own), metres);
        let tops = tops(&lines, &asked, &around, &nearest, (apart, metres));
        let found = parallel::map_each(&asked, |number| {
            let line = &lines[*number as usize];
            let close = others.close(line, CLOSEST * apart, metres);
            let top = match tops.get(number) {
                Some(Ring::New) if !close.contains(&true) => return Drawn::Whole,
                Some(Ring::New) | None => None,
                Some(Ring::Known { width }) => Some(*width),
            };
            let mut spacing = spacing(line, &nearest, &border, metres, top);
            // Lines must not run together either.
            close.iter().enumerate().filter(|(_, close)| **close).for_each(|(k, _)| spacing[k..=k + 1].fill(0.0));
            drawn(&along(&line.points, metres), &spacing, apart, line.is_closed())
        });
        asked.iter().zip(found).for_each(|(number, found)| chosen[*number as usize] = found);
    }
    let mut count = SupplementaryCount::default();
    for (line, chosen) in lines.into_iter().zip(chosen) {
        let of = rank(&line);
        let length = |line: &ContourLine| along(&line.points, metres)[line.points.len() - 1];
        count.all += if of > 0 { length(&line) } else { 0.0 };
        for piece in cut(line, chosen) {
            let length = length(&piece);
            count.total += length;
            if of > 0 {
                count.pieces[of - 1] += 1;
                count.drawn += length;
            }
            layer.lines.push(piece);
        }
    }
    count
}

/// How far apart the contours beside a line are at each of its vertices, metres. `top` is the width of the ring, if it is one
/// around a top or hollow that another ring shows already.
fn spacing(line: &ContourLine, nearest: &Nearest, border: &Edge, metres: DVec2, top: Option<f64>) -> Vec<f64> {
    let at = |point: &DVec2| {
        let place = *point * metres;
        let beside = nearest.beside(place, line.elevation);
        let [below, above] = beside.map(|side: Option<Neighbour>| side.map_or(f64::INFINITY, |side| side.distance));
        let edge = border.distance(place);
        // What lies beyond the border is taken to be as far as the contour on the other side, if that is known.
        let seen = |own: f64, other: f64| if own > edge { own.min(edge.max(other)) } else { own };
        let across = top.map(|width| width + 2.0 * if line.depression { above } else { below });
        let both = if below.min(above) > edge { 2.0 * edge } else { seen(below, above) + seen(above, below) };
        across.map_or(both, |across| both.min(across))
    };
    line.points.iter().map(at).collect()
}

/// The distance of each vertex from the first one along the line, metres.
pub(super) fn along(points: &[DVec2], metres: DVec2) -> Vec<f64> {
    let mut sum = 0.0;
    let further = points.windows(2).map(|pair| {
        sum += ((pair[1] - pair[0]) * metres).length();
        sum
    });
    std::iter::once(0.0).chain(further).collect()
}

/// The drawn pieces of a line.
pub(super) fn cut(line: ContourLine, drawn: Drawn) -> Vec<ContourLine> {
    let pieces = match drawn {
        Drawn::Whole => return vec![line],
        Drawn::Pieces(pieces) => pieces,
    };
    let count = line.points.len() - 1;
    let piece = |[from, to]: [usize; 2]| {
        let points = (from..=to).map(|k| line.points[if k > count { k - count } else { k }]).collect();
        ContourLine { points, depression: false, ..line }
    };
    pieces.into_iter().map(piece).collect()
}
