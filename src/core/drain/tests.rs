//! Draining of simple ground, and of random ground against a slow check.

use geo::{MultiPolygon, polygon};
use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::base::Grid;

/// Cells from which no way leads to an outlet without going up.
fn undrained(heights: &[f32], ground: &Ground<'_>) -> Vec<usize> {
    let mut drains: Vec<bool> = (0..heights.len())
        .map(|cell| heights[cell].is_finite() && (ground.stays[cell] || ground.is_outlet(heights, cell)))
        .collect();
    loop {
        let more = |&cell: &usize| {
            !drains[cell] && ground.around(cell).any(|near| drains[near] && heights[near] <= heights[cell])
        };
        let found: Vec<usize> = (0..heights.len()).filter(|cell| heights[*cell].is_finite()).filter(more).collect();
        if found.is_empty() {
            break;
        }
        found.into_iter().for_each(|cell| drains[cell] = true);
    }
    (0..heights.len()).filter(|&cell| heights[cell].is_finite() && !drains[cell]).collect()
}

struct Flat {
    lo: Vec<f32>,
    hi: Vec<f32>,
    stays: Vec<bool>,
}

impl Flat {
    fn new(cells: usize, [lo, hi]: [f32; 2]) -> Self {
        Self { lo: vec![lo; cells], hi: vec![hi; cells], stays: vec![false; cells] }
    }

    fn ground(&self, cols: usize) -> Ground<'_> {
        Ground { cols, rows: self.lo.len() / cols, lo: &self.lo, hi: &self.hi, stays: &self.stays }
    }
}

/// A bowl of 9 x 9 cells with a rim of 10 m, in ground of 12 m that falls to 5 m at the border.
fn bowl() -> Vec<f32> {
    let at = |n: usize| match (n % 9).abs_diff(4).max((n / 9).abs_diff(4)) {
        0 => 6.0,
        1 => 7.0,
        2 => 10.0,
        3 => 9.0,
        _ => 5.0,
    };
    (0..81).map(at).collect()
}

#[test]
fn a_way_out_is_cut_within_bands_as_deep_as_allowed() {
    let flat = Flat::new(81, [0.0, 20.0]);
    let (before, mut cut) = (bowl(), bowl());
    drain(&mut cut, &flat.ground(9), 10.0, Bands::Kept);
    assert!(undrained(&cut, &flat.ground(9)).is_empty());
    assert!(cut.iter().zip(&before).all(|(after, before)| after <= before), "nothing is filled");
    assert!(cut.iter().zip(&before).filter(|(after, before)| after != before).count() <= 3);
    let mut filled = bowl();
    drain(&mut filled, &flat.ground(9), 1.0, Bands::Kept);
    assert!(undrained(&filled, &flat.ground(9)).is_empty());
    assert!(filled.iter().zip(&before).all(|(after, before)| after >= before), "nothing is cut");
    assert_eq!(filled[40], 10.0);
}

#[test]
fn a_hollow_rises_to_its_contour_and_drains_along_the_floor_of_the_band_around_it() {
    // The bowl lies inside a contour of 8 m, the ground around it between 8 and 16 m.
    let mut flat = Flat::new(81, [8.0, 16.0]);
    for n in 0_usize..81 {
        match (n % 9).abs_diff(4).max((n / 9).abs_diff(4)) {
            0 | 1 => (flat.lo[n], flat.hi[n]) = (0.0, 8.0),
            4 => flat.lo[n] = 0.0,
            _ => {}
        }
    }
    for bands in [Bands::Kept, Bands::Left] {
        let mut heights = bowl();
        drain(&mut heights, &flat.ground(9), 10.0, bands);
        assert!(undrained(&heights, &flat.ground(9)).is_empty());
        if bands == Bands::Kept {
            assert_eq!(heights[40], 8.0);
            let within = |n: usize| heights[n] >= flat.lo[n] && heights[n] <= flat.hi[n];
            assert!((0..81).all(within));
        }
    }
}

#[test]
fn a_hollow_in_a_hollow_stays_where_bands_are_kept() {
    let mut flat = Flat::new(81, [8.0, 16.0]);
    (flat.lo[40], flat.hi[40]) = (0.0, 6.5);
    let mut kept = bowl();
    drain(&mut kept, &flat.ground(9), 10.0, Bands::Kept);
    assert_eq!((kept[40], undrained(&kept, &flat.ground(9))), (6.5, vec![40]));
    let mut left = bowl();
    drain(&mut left, &flat.ground(9), 10.0, Bands::Left);
    assert!(undrained(&left, &flat.ground(9)).is_empty());
}

#[test]
fn water_stays_in_sinks_only() {
    let grid = Grid { corner: DVec2::new(-0.5, 0.5), cell: DVec2::ONE, cols: 9, rows: 9 };
    let heights = bowl();
    let placed = Placed { grid: &grid, to_map: &Some, from_map: &Some };
    let marked = |shape: SinkShape| {
        let mut given = vec![false; 81];
        let found = mark_sinks(&heights, &placed, &[Sink { shape, feature: 7.into() }], &mut given);
        (found[0], (0..81).filter(|&n| given[n]).collect::<Vec<_>>())
    };
    // On the slope of the bowl, and outside of it but near.
    for p in [DVec2::new(5.0, -4.0), DVec2::new(7.0, -4.0)] {
        assert_eq!(marked(SinkShape::Point(p)), (Found::Pit(DVec2::new(4.0, -4.0)), vec![40]));
    }
    assert_eq!(marked(SinkShape::Point(DVec2::new(50.0, 0.0))), (Found::Outside, vec![]));
    let area = |half: f64| {
        let [x, y] = [4.0, -4.0];
        let square: MultiPolygon<f64> =
            polygon![(x: x - half, y: y - half), (x: x + half, y: y - half), (x: x + half, y: y + half), (x: x - half, y: y + half)]
                .into();
        SinkShape::Area(square)
    };
    assert_eq!(marked(area(1.5)).1.len(), 9);
    assert_eq!(marked(area(0.1)).1, [40]);
    let (_, given) = marked(area(1.5));
    let mut flat = Flat::new(81, [0.0, 20.0]);
    given.iter().for_each(|&n| flat.stays[n] = true);
    let mut drained = heights.clone();
    drain(&mut drained, &flat.ground(9), 10.0, Bands::Left);
    assert_eq!(drained, heights);
    let kinds = Kinds { given: &flat.stays.clone(), hollow: &|_| false };
    let pits = cell_pits(&drained, &flat.ground(9), &kinds);
    let [pit] = pits[..] else { panic!("{pits:?}") };
    assert_eq!((pit.cell, pit.bottom, pit.spill, pit.cells, pit.reason), (40, 6.0, 10.0, 9, Reason::Given));
}

#[test]
fn pits_are_listed_with_the_reason_why_they_stay() {
    let flat = Flat::new(81, [0.0, 20.0]);
    let reason = |flat: &Flat, is_hollow: bool| {
        let kinds = Kinds { given: &[false; 81], hollow: &|_| is_hollow };
        let pits = cell_pits(&bowl(), &flat.ground(9), &kinds);
        pits.iter().map(|pit| (pit.cell, pit.reason)).collect::<Vec<_>>()
    };
    assert_eq!(reason(&flat, false), [(40, Reason::Uncut)]);
    assert_eq!(reason(&flat, true), [(40, Reason::Depression)]);
    assert_eq!(reason(&Flat { lo: vec![7.5; 81], ..Flat::new(81, [0.0, 20.0]) }, false), [(40, Reason::Band)]);
    let mut wet = Flat::new(81, [0.0, 20.0]);
    wet.stays[40] = true;
    assert_eq!(reason(&wet, false), [(40, Reason::Water)]);
}

proptest! {
    #[test]
    fn nothing_is_left_undrained(
        (cols, cells) in (1_usize..9).prop_flat_map(|cols| {
            let cell = (0_u8..12, 0_u8..40);
            (Just(cols), proptest::collection::vec(cell, cols..=cols * 9))
        }),
        depth in 1_u8..9,
    ) {
        let cells = &cells[..cells.len() / cols * cols];
        let before: Vec<f32> =
            cells.iter().map(|&(z, kind)| if kind == 0 { f32::NAN } else { f32::from(z) }).collect();
        // Bands of four metres; some cells are in water.
        let band = |&(z, _): &(u8, u8)| [f32::from(z / 4 * 4), f32::from(z / 4 * 4 + 4)];
        let flat = Flat {
            lo: cells.iter().map(|c| band(c)[0]).collect(),
            hi: cells.iter().map(|c| band(c)[1]).collect(),
            stays: cells.iter().map(|&(_, kind)| kind == 1).collect(),
        };
        let ground = flat.ground(cols);
        let mut left = before.clone();
        drain(&mut left, &ground, f32::from(depth), Bands::Left);
        prop_assert_eq!(undrained(&left, &ground), Vec::<usize>::new());
        let kinds = Kinds { given: &flat.stays, hollow: &|_| false };
        prop_assert!(cell_pits(&left, &ground, &kinds).iter().all(|pit| pit.reason == Reason::Given));
        let mut kept = before.clone();
        drain(&mut kept, &ground, f32::from(depth), Bands::Kept);
        for n in 0..before.len() {
            prop_assert_eq!(before[n].is_nan(), kept[n].is_nan());
            prop_assert_eq!(before[n].is_nan(), left[n].is_nan());
            if flat.stays[n] && !before[n].is_nan() {
                prop_assert_eq!([before[n]; 2], [kept[n], left[n]]);
            }
            prop_assert!(kept[n].is_nan() || (flat.lo[n] <= kept[n] && kept[n] <= flat.hi[n]));
        }
        // What stays is listed.
        let listed = cell_pits(&kept, &ground, &kinds);
        prop_assert_eq!(undrained(&kept, &ground).is_empty(), listed.iter().all(|pit| pit.reason == Reason::Given));
    }
}
