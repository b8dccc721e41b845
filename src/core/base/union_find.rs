//! Disjoint sets of numbers, kept as trees (union-find).

/// Disjoint sets of the numbers below a count. The root of a set, which is one of its members, stands for the set.
#[derive(Debug, Clone)]
pub struct UnionFind {
    parent: Vec<u32>,
}

impl UnionFind {
    /// Each number in a set of its own.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// The root of a number's set. Halves the path to it for later calls.
    pub fn root(&mut self, mut k: usize) -> usize {
        while self.parent[k] as usize != k {
            self.parent[k] = self.parent[self.parent[k] as usize];
            k = self.parent[k] as usize;
        }
        k
    }

    /// Unites the sets of two numbers. The smaller root stays a root, so the root of a set is always its smallest
    /// number. Returns whether the sets were different.
    pub fn unite(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.hang(a.max(b), a.min(b));
        a != b
    }

    /// Joins the set with root `below` to the set with root `root`, which stays a root.
    pub fn hang(&mut self, root: usize, below: usize) {
        self.parent[root] = below as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_number_is_the_root_of_its_set() {
        let mut sets = UnionFind::new(8);
        assert!(sets.unite(5, 3) && sets.unite(7, 5) && sets.unite(4, 2));
        assert!(!sets.unite(3, 7));
        let roots: Vec<usize> = (0..8).map(|k| sets.root(k)).collect();
        assert_eq!(roots, [0, 1, 2, 3, 2, 3, 6, 3]);
        sets.hang(2, 3);
        assert_eq!([2, 4, 7].map(|k| sets.root(k)), [3; 3]);
    }
}
