//! Items grouped into rows, for instance by sub-domain, by level, or by band of a raster.

/// Rows of items in one array, the rows' starts in another ("compressed rows").
#[derive(Debug, Clone)]
pub struct Rows<T> {
    start: Vec<usize>,
    items: Vec<T>,
}

impl<T: Copy + Default> Rows<T> {
    /// Groups items into `count` rows by counting. `items` is called twice and gives pairs of row and item. Items of
    /// one row keep their order.
    pub fn new<I: Iterator<Item = (usize, T)>>(count: usize, items: impl Fn() -> I) -> Self {
        let mut start = vec![0; count + 1];
        for (row, _) in items() {
            start[row + 1] += 1;
        }
        for row in 0..count {
            start[row + 1] += start[row];
        }
        let mut next = start.clone();
        let mut sorted = vec![T::default(); start[count]];
        for (row, item) in items() {
            sorted[next[row]] = item;
            next[row] += 1;
        }
        Self { start, items: sorted }
    }

    /// The items of a row.
    pub fn of(&self, row: usize) -> &[T] {
        &self.items[self.start[row]..self.start[row + 1]]
    }

    /// The items of a row; none if there is no such row.
    pub fn get(&self, row: usize) -> &[T] {
        if row + 1 < self.start.len() { self.of(row) } else { &[] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_their_order_and_may_be_empty() {
        let items = [(2, 'a'), (0, 'b'), (2, 'c')];
        let rows = Rows::new(4, || items.iter().copied());
        assert_eq!(rows.of(0), ['b']);
        assert_eq!(rows.of(1), []);
        assert_eq!(rows.of(2), ['a', 'c']);
        assert_eq!(rows.get(2), ['a', 'c']);
        assert_eq!([rows.get(3), rows.get(4)], [[]; 2]);
    }
}
