//! Models as OBJ, read.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use crate::common::Folder;

/// A model as OBJ: vertices in map coordinates, and triangles.
pub struct Obj {
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Vec<[usize; 3]>,
}

impl Obj {
    /// The model in a file.
    pub fn read(folder: &Folder, name: &str) -> Self {
        let text = fs::read_to_string(folder.path(name)).unwrap();
        let numbers = |rest: &str| -> Vec<f64> { rest.split(' ').filter_map(|word| word.parse().ok()).collect() };
        let offset = text.lines().find_map(|line| line.strip_prefix("# offset ")).map(numbers).unwrap();
        let vertex = |rest| -> [f64; 3] { std::array::from_fn(|k| numbers(rest)[k] + offset[k]) };
        let corner = |word: &str| word.split('/').next().unwrap().parse::<usize>().unwrap() - 1;
        let triangle = |rest: &str| -> [usize; 3] {
            let corners: Vec<usize> = rest.split(' ').map(corner).collect();
            corners.try_into().unwrap()
        };
        Self {
            vertices: text.lines().filter_map(|line| line.strip_prefix("v ")).map(vertex).collect(),
            triangles: text.lines().filter_map(|line| line.strip_prefix("f ")).map(triangle).collect(),
        }
    }

    /// The corners of a triangle.
    fn corners(&self, t: usize) -> [[f64; 3]; 3] {
        self.triangles[t].map(|v| self.vertices[v])
    }

    /// Area on the map.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|t| doubled(self.corners(t)) / 2.0).sum()
    }

    /// The height at a place, by each triangle that covers it.
    pub fn heights_at(&self, [x, y]: [f64; 2]) -> Vec<f64> {
        let found = (0..self.triangles.len()).filter_map(|t| {
            let [a, b, c] = self.corners(t);
            let p = [x, y, 0.0];
            let weights = [[p, b, c], [a, p, c], [a, b, p]].map(|corners| doubled(corners) / doubled([a, b, c]));
            let height = weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2];
            weights.iter().all(|weight| *weight >= -1e-9).then_some(height)
        });
        found.collect()
    }
}

/// Twice the area of a triangle on the map.
fn doubled([a, b, c]: [[f64; 3]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
