//! Flow over simple ground, and over random ground against a slow second implementation.

use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::base::Grid;
use crate::crs::Crs;
use crate::raster::{Dem, GroundScale};

const METRES: GroundScale = GroundScale::Uniform(DVec2::ONE);
const N: f32 = f32::NAN;

fn dem(cols: usize, values: Vec<f32>) -> Dem {
    let rows = values.len() / cols;
    let grid = Grid { corner: DVec2::new(100.0, 900.0), cell: DVec2::ONE, cols, rows };
    Dem { grid, values, crs: None }
}

/// Heights at the centres of cells of 1 m; y is to the south.
fn ground(cols: usize, rows: usize, height: impl Fn(DVec2) -> f64) -> Dem {
    let place = |i: usize| DVec2::new((i % cols) as f64, (i / cols) as f64);
    dem(cols, (0..cols * rows).map(|i| height(place(i)) as f32).collect())
}

fn flow(dem: &Dem) -> FlowDirections {
    flow_directions(dem, &METRES, None).unwrap()
}

/// The accumulation in cells.
fn cells(directions: &FlowDirections) -> Dem {
    flow_accumulation(directions, Accumulated::Cells)
}

/// Values with `-` for no data.
fn text(dem: &Dem) -> String {
    let value = |v: &f32| if v.is_nan() { "-".into() } else { v.to_string() };
    dem.values
        .chunks(dem.grid.cols)
        .map(|row| row.iter().map(value).collect::<Vec<_>>().join(" "))
        .collect::<Vec<_>>()
        .join("\n")
}

/// The cells of a path downstream, from the cell itself to its outlet.
fn path(directions: &FlowDirections, cell: usize) -> Vec<usize> {
    let path: Vec<usize> = std::iter::successors(Some(cell), |&cell| directions.downstream(cell))
        .take(directions.grid().len() + 1)
        .collect();
    assert!(path.len() <= directions.grid().len(), "a cycle through cell {cell}");
    path
}

#[test]
fn wide_level_ground_drains_straight_to_the_nearest_edge() {
    let (cols, rows) = (21, 15);
    let found = flow(&ground(cols, rows, |_| 100.0));
    for cell in 0..cols * rows {
        let (col, row) = (cell % cols, cell / cols);
        let to_edge = col.min(row).min(cols - 1 - col).min(rows - 1 - row);
        let steps = path(&found, cell);
        let is_straight =
            steps.windows(2).all(|step| step[0] % cols == step[1] % cols || step[0] / cols == step[1] / cols);
        assert!(is_straight && steps.len() == to_edge + 1, "{cell}: {steps:?}");
    }
    // A lake between banks, with its outlet in the west: straight ahead, and else diagonally as far as needed.
    let is_bank = |p: DVec2| p.x == 0.0 || p.y == 0.0 || p.x == 20.0 || p.y == 14.0;
    let lake =
        flow(&ground(cols, rows, |p| if p == DVec2::new(0.0, 7.0) { 99.0 } else { 100.0 + f64::from(is_bank(p)) }));
    for (col, row) in (2..20).flat_map(|col| (1..14).map(move |row| (col, row))) {
        let steps = path(&lake, row * cols + col);
        let across = steps.windows(2).filter(|step| step[0] / cols != step[1] / cols).count();
        // Water falls into the outlet from the three cells beside it.
        let (along, aside) = (col - 1, row.abs_diff(7).saturating_sub(1));
        assert_eq!(steps.len() - 2, along.max(aside), "{col} {row}");
        assert!(across <= aside + 1, "{col} {row}: {steps:?}");
    }
}

#[test]
fn a_plane_drains_in_one_direction() {
    // Falls to the south-east; water leaves over the last column and row.
    let plane = ground(4, 3, |p| 100.0 - p.x - p.y);
    let found = flow(&plane);
    assert_eq!(text(&found.raster()), "2 2 2 0\n2 2 2 0\n0 0 0 0");
    assert_eq!(text(&cells(&found)), "1 1 1 1\n1 2 2 2\n1 2 3 3");
    let basins = catchments(&found);
    assert_eq!(basins.count(), 6);
    let parts = catchment_parts(&basins, &METRES);
    let last = parts.iter().find(|part| part.catchment == 6).unwrap();
    assert_eq!((parts.iter().map(|part| part.area).sum::<f64>(), last.outlet), (12.0, DVec2::new(103.5, 897.5)));
    // All eight directions of a plane.
    for (k, step) in [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)].into_iter().enumerate() {
        let plane = ground(5, 5, |p| -p.dot(DVec2::new(step.0.into(), step.1.into())));
        assert_eq!(flow(&plane).raster().values[12], f32::from(1_u8 << k), "{step:?}");
    }
}

#[test]
fn a_cone_drains_outwards_and_a_funnel_over_its_lowest_rim() {
    let cone = ground(7, 7, |p| -p.distance(DVec2::splat(3.0)));
    let found = flow(&cone);
    let values = found.raster().values;
    assert_eq!([values[3 * 7 + 4], values[4 * 7 + 4], values[4 * 7 + 3], values[2 * 7 + 2]], [1.0, 2.0, 4.0, 32.0]);
    assert_eq!(catchments(&found).count(), 24, "water leaves over the whole border");
    let mut funnel = ground(7, 7, |p| p.distance(DVec2::splat(3.0)));
    funnel.values[3] = 2.9;
    let found = flow(&funnel);
    let middle = path(&found, 3 * 7 + 3);
    assert_eq!(middle, [24, 17, 10, 3], "north, through the lowest rim");
    assert_eq!(cells(&found).values[3], 49.0);
}

#[test]
fn a_pit_drains_along_its_lowest_ground() {
    let pit = dem(5, [[9., 9., 9., 9., 9.], [9., 1., 5., 2., 8.], [9., 9., 9., 9., 9.]].concat());
    // The lowest rim is 8, at the east; the deep cell 1 drains along 5 and 2.
    assert_eq!(text(&flow(&pit).raster()), "2 4 8 4 8\n1 1 1 1 0\n128 64 32 64 32");
}

#[test]
fn level_ground_drains_the_shortest_way() {
    let flat = ground(7, 5, |_| 3.0);
    let found = flow(&flat);
    for cell in 0..35 {
        let (col, row) = (cell % 7, cell / 7);
        let to_border = [col, row, 6 - col, 4 - row].into_iter().min().unwrap();
        assert_eq!(path(&found, cell).len(), to_border + 1, "{col} {row}");
    }
    // Level ground inside a rim with one gap at the north, column 2.
    let mut tank = ground(6, 6, |p| if p.min_element() < 1.0 || p.max_element() > 4.0 { 5.0 } else { 1.0 });
    tank.values[2] = 4.0;
    let found = flow(&tank);
    // The tank, the gap and the rim, whose cells beside lower ground drain into the tank.
    assert_eq!(cells(&found).values[2], 36.0);
    assert_eq!(path(&found, 4 * 6 + 4).len(), 5);
}

#[test]
fn holes_without_data_are_outlets() {
    let mut bowl = ground(5, 5, |p| p.distance(DVec2::splat(2.0)));
    bowl.values[12] = N;
    let found = flow(&bowl);
    assert_eq!(text(&found.raster()), "2 2 4 8 8\n2 0 0 0 8\n1 0 - 0 16\n128 0 0 0 32\n128 128 64 32 32");
    assert!(cells(&found).values[12].is_nan() && catchments(&found).raster().unwrap().values[12].is_nan());
    assert_eq!(cells(&found).values.iter().filter(|v| v.is_nan()).count(), 1);
    let nothing = flow(&dem(2, vec![N; 4]));
    assert_eq!((catchments(&nothing).count(), text(&nothing.raster())), (0, "- -\n- -".into()));
    assert!(catchment_parts(&catchments(&nothing), &METRES).is_empty());
    let infinite = flow(&dem(3, vec![f32::INFINITY, f32::NEG_INFINITY, 1.0]));
    assert_eq!(text(&infinite.raster()), "- - 0");
}

#[test]
fn cells_of_one_column_or_row_are_all_outlets_or_drain_along_it() {
    assert_eq!(text(&flow(&dem(4, vec![4.0, 3.0, 5.0, 1.0])).raster()), "1 0 1 0");
    assert_eq!(text(&flow(&dem(1, vec![-0.0, 0.0, 5.0])).raster()), "0\n0\n64");
    assert_eq!(text(&flow(&dem(1, vec![7.0])).raster()), "0");
    let empty = Dem { grid: Grid { cols: 0, rows: 0, ..dem(1, vec![1.0]).grid }, values: vec![], crs: None };
    assert!(flow(&empty).raster().values.is_empty());
}

#[test]
fn distances_are_those_on_the_ground() {
    // The middle falls by 1 to the east and by 1.2 to the south. Cells that are high drain to the south less steeply.
    let heights = vec![9., 9., 9., 9., 5., 4., 9., 3.8, 9.];
    let mut steep = dem(3, heights);
    assert_eq!(flow(&steep).raster().values[4], 4.0);
    steep.grid.cell = DVec2::new(1.0, 2.0);
    assert_eq!(flow(&steep).raster().values[4], 1.0);
    // In degrees at 60 degrees north, a cell is half as wide as high: a fall to the east is steeper.
    steep.grid = Grid { corner: DVec2::new(10.0, 60.0), cell: DVec2::splat(1e-4), ..steep.grid };
    steep.crs = Some(Crs::from_epsg(4326));
    let scale = GroundScale::of(&steep);
    let found = flow_directions(&steep, &scale, None).unwrap();
    assert_eq!(found.raster().values[4], 1.0);
    let parts = catchment_parts(&catchments(&found), &scale);
    let total: f64 = parts.iter().map(|part| part.area).sum();
    let cell = |row: usize| (steep.grid.cell * scale.row(row)).element_product();
    assert!((total / (3.0 * (0..3).map(cell).sum::<f64>()) - 1.0).abs() < 1e-9);
}

#[test]
fn values_that_do_not_fit_the_grid_are_refused() {
    let wrong = Dem { values: vec![1.0; 5], ..dem(2, vec![1.0; 4]) };
    assert!(flow_directions(&wrong, &METRES, None).is_err());
}

/// Random ground: heights that are all different, and holes.
fn random_ground() -> impl Strategy<Value = Dem> {
    (2_usize..14, 2_usize..14).prop_flat_map(|(cols, rows)| {
        let heights = Just((0..cols * rows).map(|z| z as f32).collect::<Vec<_>>()).prop_shuffle();
        (heights, proptest::collection::vec(0..12_u8, cols * rows)).prop_map(move |(mut heights, holes)| {
            heights.iter_mut().zip(holes).filter(|(_, hole)| *hole == 0).for_each(|(height, _)| *height = N);
            dem(cols, heights)
        })
    })
}

/// The cells around a cell, by the distance of their columns and rows.
fn around(dem: &Dem, cell: usize) -> Vec<usize> {
    let cols = dem.grid.cols;
    let near = |other: &usize| {
        let apart = (cell % cols).abs_diff(other % cols).max((cell / cols).abs_diff(other / cols));
        apart == 1 && !dem.values[*other].is_nan()
    };
    (0..dem.values.len()).filter(near).collect()
}

/// The height to which water rises in each cell, by lowering all until nothing changes.
fn levels(dem: &Dem) -> Vec<f32> {
    let is_outlet = |cell: usize| around(dem, cell).len() < 8;
    let first = |cell: usize| if is_outlet(cell) { dem.values[cell] } else { f32::INFINITY };
    let mut levels: Vec<f32> = (0..dem.values.len()).map(first).collect();
    loop {
        let before = levels.clone();
        for cell in 0..levels.len() {
            let over = around(dem, cell).into_iter().map(|near| levels[near]).fold(f32::INFINITY, f32::min);
            levels[cell] = levels[cell].min(over.max(dem.values[cell]));
        }
        if before.iter().zip(&levels).all(|(a, b)| a.to_bits() == b.to_bits()) {
            return levels;
        }
    }
}

/// Columns become rows.
fn transposed(dem: &Dem) -> Dem {
    let Grid { cols, rows, .. } = dem.grid;
    let values = (0..cols * rows).map(|i| dem.values[i % rows * cols + i / rows]).collect();
    Dem { grid: Grid { cols: rows, rows: cols, ..dem.grid }, values, crs: None }
}

proptest! {
    #![proptest_config(crate::draws::draws())]

    #[test]
    fn random_ground_drains_as_by_the_slow_way(dem in random_ground()) {
        let found = flow(&dem);
        let levels = levels(&dem);
        let known: Vec<usize> = (0..dem.values.len()).filter(|&cell| !dem.values[cell].is_nan()).collect();
        let mut counts = vec![0.0_f32; dem.values.len()];
        let basins = catchments(&found);
        let numbers = basins.raster().unwrap().values;
        for &cell in &known {
            let path = path(&found, cell);
            path.iter().for_each(|passed| counts[*passed] += 1.0);
            let end = path[path.len() - 1];
            prop_assert!(around(&dem, end).len() < 8, "the end is at the border or beside a hole");
            prop_assert_eq!(numbers[cell], numbers[end]);
            if let [_, down, ..] = path[..] {
                prop_assert!(around(&dem, cell).contains(&down) && levels[down] <= levels[cell]);
            }
            if levels[cell] > dem.values[cell] {
                continue;
            }
            // Outside of pits, the descent is the steepest.
            let descent = |near: usize| {
                let (col, row) = (near % dem.grid.cols, near / dem.grid.cols);
                let straight = col == cell % dem.grid.cols || row == cell / dem.grid.cols;
                (dem.values[cell] - dem.values[near]) / if straight { 1.0 } else { std::f32::consts::SQRT_2 }
            };
            let lower = around(&dem, cell).into_iter().filter(|&near| levels[near] < levels[cell]);
            let steepest = lower.max_by(|a, b| descent(*a).total_cmp(&descent(*b)));
            // At the edge, water may leave instead.
            let leaves = around(&dem, cell).len() < 8 && found.downstream(cell).is_none();
            prop_assert!(leaves || found.downstream(cell) == steepest);
        }
        let accumulation = cells(&found);
        for (cell, &count) in counts.iter().enumerate() {
            let found = accumulation.values[cell];
            prop_assert!(found == count || found.is_nan() && dem.values[cell].is_nan(), "cell {}: {}", cell, found);
        }
        let ends = known.iter().filter(|&&cell| found.downstream(cell).is_none());
        prop_assert_eq!(ends.clone().map(|&end| accumulation.values[end]).sum::<f32>(), known.len() as f32);
        prop_assert_eq!(ends.count(), basins.count());
        let parts = catchment_parts(&basins, &METRES);
        prop_assert_eq!(parts.iter().map(|part| part.area).sum::<f64>(), known.len() as f64);
    }

    #[test]
    fn a_turned_map_drains_alike(dem in random_ground()) {
        let found = flow(&dem);
        let (cols, rows) = (dem.grid.cols, dem.grid.rows);
        let turned = flow(&transposed(&dem));
        let place = |cell: usize| cell % cols * rows + cell / cols;
        for cell in 0..dem.values.len() {
            prop_assert_eq!(found.downstream(cell).map(place), turned.downstream(place(cell)));
        }
        let mirrored = Dem { values: dem.values.chunks(cols).rev().flatten().copied().collect(), ..dem.clone() };
        let place = |cell: usize| (rows - 1 - cell / cols) * cols + cell % cols;
        let turned = flow(&mirrored);
        for cell in 0..dem.values.len() {
            prop_assert_eq!(found.downstream(cell).map(place), turned.downstream(place(cell)));
        }
    }
}
