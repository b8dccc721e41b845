//! Cuts the cells of a map into tiles.

/// Tiles begin at multiples of this many cells of the map's grid, and have at least so many on a side.
pub const STEP: usize = 16;

/// Some cells of a grid: the first column and row, and how many there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Block {
    /// First column.
    pub col: usize,
    /// First row, from the north.
    pub row: usize,
    /// Number of columns.
    pub cols: usize,
    /// Number of rows.
    pub rows: usize,
}

/// Halves a block, along its longer side, until each part is small enough or cannot be halved. The parts are in a fixed order.
pub fn divide(block: Block, is_small: &impl Fn(&Block) -> bool) -> Vec<Block> {
    let is_wide = block.cols >= block.rows;
    let long = if is_wide { block.cols } else { block.rows };
    // A block may begin anywhere; its cut is a multiple of the step from its first cell.
    let first = (long / 2).next_multiple_of(STEP);
    if is_small(&block) || first >= long {
        return vec![block];
    }
    let [one, other] = match is_wide {
        true => [Block { cols: first, ..block }, Block { col: block.col + first, cols: long - first, ..block }],
        false => [Block { rows: first, ..block }, Block { row: block.row + first, rows: long - first, ..block }],
    };
    let mut parts = divide(one, is_small);
    parts.extend(divide(other, is_small));
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_cover_the_block_once() {
        let block = Block { col: 0, row: 0, cols: 1000, rows: 333 };
        let parts = divide(block, &|part| part.cols * part.rows <= 5000);
        let mut seen = vec![0; 1000 * 333];
        for part in &parts {
            assert!(part.cols * part.rows <= 5000, "{part:?}");
            for row in part.row..part.row + part.rows {
                seen[row * 1000 + part.col..][..part.cols].iter_mut().for_each(|n| *n += 1);
            }
        }
        assert!(seen.into_iter().all(|n| n == 1));
        let smallest = divide(block, &|_| false);
        assert!(smallest.iter().all(|part| part.cols <= STEP && part.rows <= STEP), "it ends");
    }
}
