//! Triangles of the smooth surface.

use super::tuned;

tuned! {
    /// Which nodes become vertices of the triangles for new contours and meshes. Height maps do not depend on them.
    NodeTuning {
        /// Least distance of a vertex from an edge that the triangulation must hold, in steps between nodes. Nearer
        /// ones make slivers.
        ///
        /// Tried 0.3 and 1.2: on the sample, the distance of new contours from true ones changes by +0.6 % and -0.2 %.
        /// On contours that were cut from a raster it does not change.
        ///
        /// Refit: contours.
        clearance: f64 = 0.6,
        /// The same where the nodes are the cells that the contours were cut from. Their heights are known as well as
        /// the contours.
        ///
        /// Tried 0.05 and 0.2: on contours that were cut from a raster, the distance of new contours from true ones
        /// changes by less than 0.1 %.
        ///
        /// Refit: contours, on contours that were cut from a raster.
        clearance_of_source: f64 = 0.1,
        /// Vertices per spacing that are enough.
        ///
        /// Tried 6 and 24: on a map with small cells, the distance of new contours from true ones changes by +0.2 %
        /// and +0.1 %, the number of their vertices by -13 % and +5 %. On the sample nothing changes.
        ///
        /// Refit: contours and time.
        vertices_per_spacing: f64 = 12.0,
        /// A node is left out where flat triangles between its neighbours are off by at most this share of the contour
        /// interval.
        ///
        /// Tried 0.005 and 0.02: on two maps, the distance of new contours from true ones changes by -0.1 % and by
        /// +0.1 to +0.4 %, the number of their vertices by +2 to +14 % and by -2 to -5 %.
        ///
        /// Refit: contours and time.
        tolerance: f64 = 0.01,
    }
}
