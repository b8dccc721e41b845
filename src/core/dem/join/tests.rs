//! Tests of joins with surfaces of which all is known.

use super::border::place;
use super::*;
use crate::base::Grid;

fn ground(p: DVec2) -> f64 {
    500.0 + 40.0 * (p.x / 90.0).sin() + 30.0 * (p.y / 70.0).cos() + 0.1 * p.x
}

/// Heights inside a circle about the middle of a grid, none elsewhere.
fn round_map() -> Dem {
    let grid = Grid { corner: DVec2::new(-300.0, 300.0), cell: DVec2::new(5.0, 4.0), cols: 120, rows: 150 };
    let height = |k: usize| {
        let p = place(&grid, k);
        if p.length() < 120.0 { ground(p) as f32 } else { f32::NAN }
    };
    Dem { grid, values: (0..grid.len()).map(height).collect(), crs: None }
}

fn base(dem: &Dem, error: impl Fn(DVec2) -> f64) -> Vec<f32> {
    let height = |k: usize| (ground(place(&dem.grid, k)) + error(place(&dem.grid, k))) as f32;
    (0..dem.grid.len()).map(height).collect()
}

/// The largest difference between cells beside each other, one of `inside` and one not.
fn largest_step(values: &[f32], inside: &Dem) -> f32 {
    let cols = inside.grid.cols;
    let pairs = (0..values.len()).flat_map(|k| [(k, k + 1), (k, k + cols)]);
    let beside = pairs.filter(|&(a, b)| b < values.len() && (b != a + 1 || b % cols != 0));
    let across = beside.filter(|&(a, b)| inside.values[a].is_nan() != inside.values[b].is_nan());
    across.map(|(a, b)| (values[a] - values[b]).abs()).fold(0.0, f32::max)
}

#[test]
fn there_is_no_step_at_the_border_and_the_heights_inside_stay() {
    let inside = round_map();
    let base = base(&inside, |p| 12.0 + 6.0 * (p.x / 150.0).sin() - 0.01 * p.y);
    let of_ground = largest_step(&self::base(&inside, |_| 0.0), &inside);

    let mut joined = inside.clone();
    let found = join(&mut joined, &base, 100.0 / inside.grid.cell);
    // The correction falls by less than a seventh in a cell.
    let step = largest_step(&joined.values, &inside);
    assert!(step < of_ground + 18.0 / 7.0, "{step} after {of_ground}");
    let mut beside = inside.clone();
    join(&mut beside, &base, DVec2::ZERO);
    assert!(largest_step(&beside.values, &inside) > of_ground + 9.0);

    let is_kept = |(a, b): (&f32, &f32)| b.is_nan() || a.to_bits() == b.to_bits();
    assert!(joined.values.iter().zip(&inside.values).all(is_kept));
    assert!(joined.values.iter().all(|height| height.is_finite()));
    assert_eq!(found.filled, inside.values.iter().filter(|height| height.is_nan()).count());
    assert!((-19.0..-5.0).contains(&found.median) && found.largest.abs() >= found.median.abs(), "{found:?}");
    assert!(!found.looks_like_feet);
    assert!(found.place.is_some_and(|p| (p.length() - 120.0).abs() < 10.0), "{found:?}");
}

#[test]
fn far_from_the_border_the_base_is_as_it_was() {
    let inside = round_map();
    let base = base(&inside, |_| 10.0);
    let mut joined = inside.clone();
    join(&mut joined, &base, 30.0 / inside.grid.cell);
    let far = |k: &usize| place(&inside.grid, *k).length() > 120.0 + 120.0;
    let worst = (0..base.len()).filter(far).map(|k| (joined.values[k] - base[k]).abs()).fold(0.0, f32::max);
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn cells_without_a_base_stay_without_a_height() {
    let inside = round_map();
    let mut base = base(&inside, |_| 3.0);
    let hole = |p: DVec2| p.x > 150.0;
    (0..base.len()).filter(|&k| hole(place(&inside.grid, k))).for_each(|k| base[k] = f32::NAN);
    let mut joined = inside.clone();
    let found = join(&mut joined, &base, 100.0 / inside.grid.cell);
    assert!((0..base.len()).all(|k| joined.values[k].is_nan() == hole(place(&inside.grid, k))));
    assert_eq!(found.filled, (0..base.len()).filter(|&k| inside.values[k].is_nan() && !base[k].is_nan()).count());
}

#[test]
fn a_base_without_heights_at_the_border_is_not_changed() {
    let inside = round_map();
    let mut base = base(&inside, |_| 3.0);
    (0..base.len()).filter(|&k| place(&inside.grid, k).x < 150.0).for_each(|k| base[k] = f32::NAN);
    let mut joined = inside.clone();
    let found = join(&mut joined, &base, 100.0 / inside.grid.cell);
    assert!(found.border == 0 && found.median.is_nan() && found.place.is_none(), "{found:?}");
    let is_base = |k: &usize| joined.values[*k].to_bits() == base[*k].to_bits();
    assert!((0..base.len()).filter(|k| !base[*k].is_nan()).all(|k| is_base(&k)) && found.filled > 0);
}

#[test]
fn a_base_in_feet_is_noticed() {
    let inside = round_map();
    let feet: Vec<f32> = base(&inside, |_| 2.0).iter().map(|height| height / 0.3048).collect();
    assert!(join(&mut inside.clone(), &feet, 100.0 / inside.grid.cell).looks_like_feet);
}
