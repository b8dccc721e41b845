//! The smooth surface.

use super::{GainTuning, GridTuning, ShrinkageTuning, tuned};

tuned! {
    /// The solution for the smooth surface, in the order of its steps.
    ///
    /// Arrays of three have a value for the finest lattice, one for the next coarser lattice, and one for all others.
    SplineTuning {
        /// The working grid.
        grid: GridTuning = GridTuning::default(),
        /// Rounds of averaging over the four neighbours that smooth the relative contour density, nodes.
        ///
        /// Refit: RMSE.
        density_rounds: usize = 3,
        /// Weight of a contour's vertex on an edge between nodes, against a second difference.
        ///
        /// Refit: RMSE, on contours that were cut from a raster; share of vertices that the surface meets.
        contour_weight_at_vertex: f64 = 1000.0,
        /// Weight of a contour's crossing with an edge away from its vertices, against a second difference.
        ///
        /// Refit: RMSE; share of vertices that the surface meets.
        contour_weight_on_chord: f64 = 500.0,
        /// Weight of a crossing where the noise of the contours is 1 and the grid has
        /// [`GridTuning::nodes_per_spacing`].
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        noisy_contour_weight: f64 = 0.1,
        /// Largest weight of a crossing on coarse lattices, unless it is larger on the finest one. What lies between
        /// their nodes is averaged.
        ///
        /// Refit: RMSE and time.
        coarse_contour_weight: f64 = 20.0,
        /// Weight of a second difference across a ridge or canyon line, against another one.
        ///
        /// Refit: RMSE.
        crease_weight: f32 = 0.7,
        /// IRLS threshold: a second difference counts with its square below it and with its size above it, in means of
        /// the absolute second differences.
        ///
        /// Refit: RMSE.
        irls_threshold: f64 = 2.0,
        /// Rounds of new weights after the first solution of a lattice.
        ///
        /// Refit: RMSE and time.
        reweighting_rounds: [usize; 3] = [0, 2, 1],
        /// Largest number of steps of conjugate gradients for the first solution.
        ///
        /// Refit: RMSE and time.
        steps: [usize; 3] = [40, 60, 200],
        /// The same where the finest lattice is much finer than the contours. It skips its first solution, because the
        /// coarser lattice is already close.
        ///
        /// Refit: RMSE and time, on height maps with small cells.
        steps_on_fine_grids: [usize; 3] = [0, 80, 200],
        /// Nodes per spacing above which a lattice is much finer than the contours.
        ///
        /// Refit: RMSE and time, on height maps with small cells.
        fine_grid_nodes_per_spacing: f64 = 12.0,
        /// Largest number of steps of conjugate gradients after each change of weights, and after breaching.
        ///
        /// Refit: RMSE and time.
        further_steps: [usize; 3] = [20, 40, 100],
        /// A solution is done when no height changes by more than this in a sweep, as a share of the contour interval.
        ///
        /// Refit: RMSE and time.
        convergence: f64 = 1e-3,
        /// Factor on the tension each time that the surface meets a bound of its band away from contours.
        ///
        /// Refit: RMSE.
        bound_tension_factor: f32 = 16.0,
        /// The largest such factor after all rounds.
        ///
        /// Refit: RMSE.
        max_bound_tension_factor: f32 = 1000.0,
        /// How far that factor spreads, nodes.
        ///
        /// Refit: RMSE.
        bound_tension_reach: usize = 10,
        /// Share of the reference surface where the smooth surface is level and the reference surface is not.
        ///
        /// Refit: RMSE; cells that are flat where the ground is not.
        shelf_share: f32 = 0.3,
        /// Rows and columns on each side over which that share is averaged, nodes.
        ///
        /// Refit: RMSE.
        shelf_reach: usize = 2,
        /// How far a surface of noisy contours may leave its band before it is moved to meet them, as a share of the
        /// contour interval.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        noise_slack: f64 = 0.5,
        /// How far a correction at a noisy contour reaches, nodes.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        residual_reach: f32 = 20.0,
        /// Weight of a crossing against a first difference of the correction.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        residual_weight: f64 = 100.0,
        /// Largest number of steps for the correction.
        ///
        /// Refit: RMSE and time, on contours of unsmoothed lidar.
        residual_steps: usize = 100,
        /// Shrinkage towards the centre of the band.
        shrinkage: ShrinkageTuning = ShrinkageTuning::default(),
        /// Curvature gain on ridges and in valleys.
        gain: GainTuning = GainTuning::default(),
    }
}
