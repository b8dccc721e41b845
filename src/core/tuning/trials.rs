//! Trials with hidden levels, and the choice of hyper-parameters.

use super::tuned;

tuned! {
    /// Trials with hidden levels, and the choice of hyper-parameters from their errors.
    TrialTuning {
        /// Tension that suits most terrain. It is half of the choice, on a logarithmic scale, and all of it where too
        /// few levels can be hidden.
        ///
        /// Tried 1.75 and 7: the RMSE of four maps changes by +1.19 % and -0.15 %.
        ///
        /// Refit: RMSE.
        usual_tension: f64 = 3.5,
        /// Each of the three tensions that are tried is this many times the one before. The first is 1.
        ///
        /// Tried 2.5 and 10: the RMSE of two maps changes by -0.02 % and -0.21 %.
        ///
        /// Refit: RMSE.
        tension_factor: f64 = 5.0,
        /// Nodes per spacing of a trial. A surface on fewer nodes shows how well a tension suits the ground too, and takes
        /// less time.
        ///
        /// Tried 3 and 12: the error of new lines of four maps changes by +0.8 % and +0.7 %.
        ///
        /// Refit: RMSE and time.
        nodes_per_spacing: f64 = 6.0,
        /// Noise of contours that are noisy.
        ///
        /// [`SplineTuning::noisy_contour_weight`](super::SplineTuning::noisy_contour_weight) is divided by its square, and
        /// was tried instead.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        noise: f64 = 1.0,
        /// IRLS threshold across ridge and canyon lines that suits most terrain, as a share of the one elsewhere. A
        /// smaller one makes them sharper.
        ///
        /// Tried 0.05 and 0.2: the RMSE of four maps changes by +2.21 % and -0.93 %.
        ///
        /// Refit: RMSE.
        usual_crease_threshold: f64 = 0.1,
        /// RMSE at hidden contours where the usual threshold is the best one, as a share of the interval between the
        /// levels that are kept.
        ///
        /// Tried 0.07 and 0.28: the RMSE of four maps changes by +2.43 % and -0.86 %.
        ///
        /// Refit: RMSE.
        usual_hidden_error: f64 = 0.14,
        /// Share of the curvature gain at hidden contours that is applied. Surfaces from all levels need less of it
        /// than those from half of the levels.
        ///
        /// Tried 0.15 and 0.6: the RMSE of four maps changes by +0.08 % and +0.83 %.
        ///
        /// Refit: RMSE.
        gain_share: f64 = 0.3,
        /// Least number of places on hidden contours. With fewer, the usual values are used.
        ///
        /// Tried 100 and 400: no effect on the RMSE of two maps.
        ///
        /// Refit: RMSE and shares, on small maps.
        min_places: usize = 200,
        /// Largest number of nodes, and of vertices, of a map that is tried as a whole. Of larger maps, squares are
        /// tried.
        ///
        /// Tried 75000 and 300000: the RMSE of three maps changes by +0.25 % and 0 %.
        ///
        /// Refit: RMSE and time, on large maps.
        whole_map_size: f64 = 150e3,
        /// Number of squares of a large map.
        ///
        /// Tried 2 and 8: no effect on the RMSE of three maps. None is large enough for squares.
        ///
        /// Refit: RMSE and time, on large maps.
        squares: usize = 4,
        /// Largest number of nodes of a square.
        ///
        /// Tried 20000 and 80000: no effect on the RMSE of three maps. None is large enough for squares.
        ///
        /// Refit: RMSE and time, on large maps.
        square_nodes: f64 = 40e3,
        /// Largest number of vertices of a square, in the mean of all squares.
        ///
        /// Tried 40000 and 160000: no effect on the RMSE of three maps. None is large enough for squares.
        ///
        /// Refit: RMSE and time, on large maps.
        square_vertices: f64 = 80e3,
        /// Limits of the distance between levels at a place that is the weight of its error, spacings.
        ///
        /// Tried one by one: the RMSE of two maps changes by 0 with element 0 at 0.025 and 0.1; -0.14 % and +0.22 %
        /// with element 1 at 5 and 20.
        ///
        /// Refit: RMSE.
        spacing_limits: [f64; 2] = [0.05, 10.0],
        /// Shortest closed contour that counts in the choice, in widths of a trial's cell. A shorter one would fit into
        /// one cell.
        ///
        /// Tried 2 and 8: the RMSE of two maps changes by 0 % and -0.01 %.
        ///
        /// Refit: RMSE, on maps with many knolls.
        min_ring_cells: f64 = 4.0,
        /// Largest number of vertices of a contour per width of a trial's cell. The trial's grid does not show more
        /// detail.
        ///
        /// Tried 2 and 8: the RMSE of two maps changes by +0.01 % and 0 %.
        ///
        /// Refit: RMSE and time.
        vertices_per_cell: f64 = 4.0,
    }
}
