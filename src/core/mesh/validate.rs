//! Checks what must hold for every mesh, however it was made.

use foldhash::{HashSet, HashSetExt};

use robust::{Coord, orient2d};

use super::Mesh;

impl Mesh {
    /// Checks indices, edges, areas and normals. Tests use it.
    ///
    /// An edge has at most two triangles, in opposite directions. In a solid it has exactly two. No triangle has zero
    /// area. The triangles and normals of a shell face upwards.
    ///
    /// # Errors
    /// A description of the first fault.
    pub fn validate(&self) -> Result<(), String> {
        if self.normals.len() != self.vertices.len() {
            return Err(format!("{} normals for {} vertices", self.normals.len(), self.vertices.len()));
        }
        let mut used = vec![false; self.vertices.len()];
        let mut edges = HashSet::with_capacity(3 * self.triangles.len());
        for (t, corners) in self.triangles.iter().enumerate() {
            for i in 0..3 {
                let (u, v) = (corners[i], corners[(i + 1) % 3]);
                let Some(mark) = used.get_mut(u as usize) else {
                    return Err(format!("triangle {t} has vertex {u} of {}", self.vertices.len()));
                };
                *mark = true;
                if !edges.insert((u, v)) {
                    return Err(format!("the edge from {u} to {v} occurs twice, the second time in triangle {t}"));
                }
            }
        }
        for (t, corners) in self.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| self.vertices[v as usize]);
            let turn = |p: [[f64; 2]; 3]| {
                let [a, b, c] = p.map(|[x, y]| Coord { x, y });
                orient2d(a, b, c)
            };
            let plan = turn([a, b, c].map(|v| [v.x, v.y]));
            let flat =
                plan == 0.0 && turn([a, b, c].map(|v| [v.y, v.z])) == 0.0 && turn([a, b, c].map(|v| [v.z, v.x])) == 0.0;
            if flat {
                return Err(format!("triangle {t} has no area"));
            }
            if self.base.is_none() && plan <= 0.0 {
                return Err(format!("triangle {t} does not face upwards"));
            }
        }
        if let Some(v) = used.iter().position(|used| !used) {
            return Err(format!("vertex {v} is in no triangle"));
        }
        if self.base.is_some()
            && self.triangles.iter().any(|t| (0..3).any(|i| !edges.contains(&(t[(i + 1) % 3], t[i]))))
        {
            return Err("the solid is open at an edge".into());
        }
        if let Some(v) = self.normals.iter().position(|n| (n.length() - 1.0).abs() > 1e-3) {
            return Err(format!("the normal of vertex {v} does not have length 1"));
        }
        // In single precision, the normal of a cliff may be horizontal.
        match self.normals.iter().position(|n| self.base.is_none() && n.z < 0.0) {
            Some(v) => Err(format!("the normal of vertex {v} does not point upwards")),
            None => Ok(()),
        }
    }
}
