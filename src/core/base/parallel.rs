//! Loops on all cores. Their results do not depend on the number of threads.
//!
//! An iterator of rayon is compiled anew for each closure, and each is some thousand lines of intermediate code. Here, only a
//! short loop is compiled for each closure. Loops over blocks, one for each type of item, call it.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

/// Blocks for each thread: so many that all threads end at nearly the same time.
const BLOCKS: usize = 32;

/// The results of `f` for 0 to `count` − 1, in this order.
pub(crate) fn map<R: Send>(count: usize, f: impl Fn(usize) -> R + Sync) -> Vec<R> {
    gather(count, &|block| block.map(&f).collect())
}

/// The results of `f` for each item, in the order of the items.
pub fn map_each<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    gather(items.len(), &|block| items[block].iter().map(&f).collect())
}

/// What `f` gives for 0 to `count` − 1, in this order. It may give several results, one, or none (an `Option`).
pub fn flat_map<I>(count: usize, f: impl Fn(usize) -> I + Sync) -> Vec<I::Item>
where
    I: IntoIterator<Item: Send>,
{
    gather(count, &|block| block.flat_map(&f).collect())
}

/// What `f` gives for each item, in the order of the items. It may give several results, one, or none (an `Option`).
pub(crate) fn flat_map_each<'a, T: Sync, I>(items: &'a [T], f: impl Fn(&'a T) -> I + Sync) -> Vec<I::Item>
where
    I: IntoIterator<Item: Send>,
{
    gather(items.len(), &|block| items[block].iter().flat_map(&f).collect())
}

/// The results of `f` for 0 to `count` − 1, in this order. They are written in place. So a large height map needs no memory
/// for a second one.
pub(crate) fn values<R: Copy + Default + Send>(count: usize, f: impl Fn(usize) -> R + Sync) -> Vec<R> {
    let mut values = vec![R::default(); count];
    update(&mut values, |i, value| *value = f(i));
    values
}

/// The results of `f` for each item, in the order of the items. They are written in place, as those of [`values`].
pub(crate) fn values_each<T: Sync, R: Copy + Default + Send>(items: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    values(items.len(), |i| f(&items[i]))
}

/// The results of `f` for the column and the row of each cell of a grid, row by row. Divisions of an index by the number of
/// columns would take as long as a short `f`.
pub(crate) fn cells<R: Copy + Default + Send>(
    cols: usize,
    rows: usize,
    f: impl Fn(usize, usize) -> R + Sync,
) -> Vec<R> {
    let mut values = vec![R::default(); cols * rows];
    chunks(&mut values, cols, |row, cells| {
        for (col, value) in cells.iter_mut().enumerate() {
            *value = f(col, row);
        }
    });
    values
}

/// Calls `f` with the index of each item and the item.
pub(crate) fn update<T: Send>(items: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    let length = block_length(items.len());
    chunks(items, length, |k, block| {
        for (i, item) in block.iter_mut().enumerate() {
            f(k * length + i, item);
        }
    });
}

/// Calls `f` with chunks of `length` items, such as the rows of a raster. The last chunk may be shorter.
pub fn chunks<T: Send>(items: &mut [T], length: usize, f: impl Fn(usize, &mut [T]) + Sync) {
    each_chunk(items, length, &f);
}

/// The number of those from 0 to `count` − 1 that `is_member` accepts.
pub(crate) fn count(count: usize, is_member: impl Fn(usize) -> bool + Sync) -> usize {
    blocks(count, &|block| block.filter(|i| is_member(*i)).count()).into_iter().sum()
}

/// The results of all blocks, one after the other.
fn gather<R: Send>(count: usize, of_block: &(dyn Fn(Range<usize>) -> Vec<R> + Sync)) -> Vec<R> {
    let parts = blocks(count, of_block);
    let mut all = Vec::with_capacity(parts.iter().map(Vec::len).sum());
    parts.into_iter().for_each(|part| all.extend(part));
    all
}

/// The results of `of_block`, one for each block of indices.
fn blocks<R: Send + Default>(count: usize, of_block: &(dyn Fn(Range<usize>) -> R + Sync)) -> Vec<R> {
    let length = block_length(count);
    let slots: Vec<Mutex<R>> = (0..count.div_ceil(length)).map(|_| Mutex::default()).collect();
    each(slots.len(), &|k| {
        let made = of_block(k * length..count.min((k + 1) * length));
        *slots[k].lock().unwrap_or_else(PoisonError::into_inner) = made;
    });
    slots.into_iter().map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
}

/// [`chunks`], compiled for each type of item only.
fn each_chunk<T: Send>(items: &mut [T], length: usize, f: &(dyn Fn(usize, &mut [T]) + Sync)) {
    items.par_chunks_mut(length.max(1)).enumerate().for_each(|(k, chunk)| f(k, chunk));
}

/// Calls `f` with 0 to `count` − 1.
fn each(count: usize, f: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(f);
}

/// The length of the blocks that `count` items are divided into.
fn block_length(count: usize) -> usize {
    count.div_ceil(BLOCKS * rayon::current_num_threads()).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_loops_keep_the_order_for_any_number_of_threads() {
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            for n in [0, 1, 2, 95, 96, 97, 1000] {
                let numbers: Vec<usize> = (0..n).collect();
                pool.install(|| {
                    assert_eq!(map(n, |i| i), numbers);
                    assert_eq!(values(n, |i| i), numbers);
                    assert_eq!(
                        cells(3, n, |col, row| [col, row]),
                        (0..3 * n).map(|i| [i % 3, i / 3]).collect::<Vec<_>>()
                    );
                    assert_eq!(map_each(&numbers, |i| i + 1), (1..=n).collect::<Vec<_>>());
                    assert_eq!(values_each(&numbers, |i| i + 1), (1..=n).collect::<Vec<_>>());
                    let odd: Vec<usize> = numbers.iter().copied().filter(|i| i % 2 == 1).collect();
                    assert_eq!(flat_map(n, |i| (i % 2 == 1).then_some(i)), odd);
                    assert_eq!(flat_map_each(&numbers, |i| (i % 2 == 1).then_some(*i)), odd);
                    assert_eq!(count(n, |i| i % 2 == 1), odd.len());
                    let mut changed = numbers.clone();
                    update(&mut changed, |i, value| *value += i);
                    chunks(&mut changed, 7, |k, chunk| chunk.iter_mut().for_each(|value| *value += k));
                    assert_eq!(changed, (0..n).map(|i| 2 * i + i / 7).collect::<Vec<_>>());
                });
            }
        }
    }
}
