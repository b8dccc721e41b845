//! Trials with hidden levels, and the choice of hyper-parameters.

use super::tuned;

tuned! {
    /// Trials with hidden levels, and the choice of hyper-parameters from their errors.
    TrialTuning {
        /// Tension that suits most terrain. It is half of the choice, on a logarithmic scale, and all of it where too
        /// few levels can be hidden.
        ///
        /// Refit: RMSE.
        usual_tension: f64 = 3.5,
        /// Each of the three tensions that are tried is this many times the one before. The first is 1.
        ///
        /// Refit: RMSE.
        tension_factor: f64 = 5.0,
        /// How far beyond the tensions that are tried the best one may be taken to lie, in steps from one to the next.
        ///
        /// Refit: RMSE.
        max_extrapolation: f64 = 0.5,
        /// Noise of contours that are noisy.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        noise: f64 = 1.0,
        /// IRLS threshold across ridge and canyon lines that suits most terrain, as a share of the one elsewhere. A
        /// smaller one makes them sharper.
        ///
        /// Refit: RMSE.
        usual_crease_threshold: f64 = 0.1,
        /// Limits of that threshold.
        ///
        /// Refit: RMSE.
        crease_threshold_limits: [f64; 2] = [0.03, 0.3],
        /// RMSE at hidden contours where the usual threshold is the best one, as a share of the interval between the
        /// levels that are kept.
        ///
        /// Refit: RMSE.
        usual_hidden_error: f64 = 0.14,
        /// Share of the curvature gain at hidden contours that is applied. Surfaces from all levels need less of it
        /// than those from half of the levels.
        ///
        /// Refit: RMSE.
        gain_share: f64 = 0.3,
        /// Least number of places on hidden contours. With fewer, the usual values are used.
        ///
        /// Refit: RMSE and shares, on small maps.
        min_places: usize = 200,
        /// Largest number of nodes, and of vertices, of a map that is tried as a whole. Of larger maps, squares are
        /// tried.
        ///
        /// Refit: RMSE and time, on large maps.
        whole_map_size: f64 = 150e3,
        /// Number of squares of a large map.
        ///
        /// Refit: RMSE and time, on large maps.
        squares: usize = 4,
        /// Largest number of nodes of a square.
        ///
        /// Refit: RMSE and time, on large maps.
        square_nodes: f64 = 40e3,
        /// Largest number of vertices of a square, in the mean of all squares.
        ///
        /// Refit: RMSE and time, on large maps.
        square_vertices: f64 = 80e3,
        /// Limits of the distance between levels at a place that is the weight of its error, spacings.
        ///
        /// Refit: RMSE.
        spacing_limits: [f64; 2] = [0.05, 10.0],
        /// Shortest closed contour that counts in the choice, in widths of a trial's cell. A shorter one would fit into
        /// one cell.
        ///
        /// Refit: RMSE, on maps with many knolls.
        min_ring_cells: f64 = 4.0,
        /// Largest number of vertices of a contour per width of a trial's cell. The trial's grid does not show more
        /// detail.
        ///
        /// Refit: RMSE and time.
        vertices_per_cell: f64 = 4.0,
    }
}
