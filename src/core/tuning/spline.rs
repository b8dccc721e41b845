//! The smooth surface.

use super::{GainTuning, GridTuning, ShrinkageTuning, WideTuning, tuned};

tuned! {
    /// The solution for the smooth surface, in the order of its steps.
    ///
    /// Arrays of three have a value for the finest lattice, one for the next coarser lattice, and one for all others.
    SplineTuning {
        /// The working grid.
        grid: GridTuning = GridTuning::default(),
        /// Rounds of averaging over the four neighbours that smooth the relative contour density, nodes.
        ///
        /// Tried 1 and 6: the RMSE of two maps changes by +0.42 % and -0.45 %.
        ///
        /// Refit: RMSE.
        density_rounds: usize = 3,
        /// Wide places.
        wide: WideTuning = WideTuning::default(),
        /// Weight of a contour's vertex on an edge between nodes, against a second difference.
        ///
        /// Tried 500 and 2000: the RMSE of two maps changes by +0.36 % and -0.54 %.
        ///
        /// Refit: RMSE, on contours that were cut from a raster; share of vertices that the surface meets.
        contour_weight_at_vertex: f64 = 1000.0,
        /// Weight of a contour's crossing with an edge away from its vertices, against a second difference.
        ///
        /// Tried 250 and 1000: the RMSE of two maps changes by +0.03 % and -0.05 %.
        ///
        /// Refit: RMSE; share of vertices that the surface meets.
        contour_weight_on_chord: f64 = 500.0,
        /// Weight of a crossing where the noise of the contours is 1 and the grid has six nodes per spacing.
        ///
        /// Tried 0.3 and 1 on three maps with noisy contours that lie on no raster: the RMSE changes by +1.6 % and +0.6 %.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        noisy_contour_weight: f64 = 4.0,
        /// Heights of a line between two contours count if it runs over at least so many nodes from one to the other. Where
        /// contours are denser, they say more than the line.
        ///
        /// Refit: RMSE near streams.
        least_line_nodes: f64 = 3.0,
        /// Standard error half-way between two contours where hidden levels do not tell it, in intervals. It weighs spot
        /// heights with a standard error.
        ///
        /// Refit: RMSE.
        usual_half_way_error: f64 = 0.15,
        /// The least variance of the surface half-way between contours, where a spot height has a standard error, as a share
        /// of the mean. Even slopes are never fully known.
        least_spot_variance: f64 = 0.1,
        /// Weight of a second difference across a ridge or canyon line, against another one.
        ///
        /// Tried 0.35 and 1.4: the RMSE of four maps changes by +3.75 % and -1.91 %.
        ///
        /// Refit: RMSE.
        crease_weight: f32 = 0.7,
        /// IRLS threshold: a second difference counts with its square below it and with its size above it, in means of
        /// the absolute second differences.
        ///
        /// Tried 1 and 4: the RMSE of four maps changes by +0.44 % and -1.02 %.
        ///
        /// Refit: RMSE.
        irls_threshold: f64 = 2.0,
        /// Rounds of new weights after the first solution of a lattice.
        ///
        /// Tried one by one: the RMSE of two to four maps changes by +0.12 % with element 0 at 1; -0.07 % and +0.88 %
        /// with element 1 at 1 and 4; +3.73 % and +0.62 % with element 2 at 0 and 2.
        ///
        /// Refit: RMSE and time.
        reweighting_rounds: [usize; 3] = [0, 2, 1],
        /// Largest number of steps of conjugate gradients for the first solution.
        ///
        /// Tried one by one: the RMSE of two to four maps changes by +0.17 % and +0.34 % with element 0 at 20 and 80;
        /// 0 % and -0.11 % with element 1 at 30 and 120; 0 with element 2 at 100 and 400.
        ///
        /// Refit: RMSE and time.
        steps: [usize; 3] = [40, 60, 200],
        /// The same where the finest lattice is much finer than the contours. It skips its first solution, because the
        /// coarser lattice is already close.
        ///
        /// Tried one by one: the RMSE of two to four maps changes by 0 with element 0 at 1; +0.29 % and -0.42 % with
        /// element 1 at 40 and 160; +0.87 % and -0.53 % with element 2 at 100 and 400.
        ///
        /// Refit: RMSE and time, on height maps with small cells.
        steps_on_fine_grids: [usize; 3] = [0, 80, 200],
        /// Nodes per spacing above which a lattice is much finer than the contours.
        ///
        /// Tried 6 and 24: the RMSE of two maps changes by -0.01 % and 0 %.
        ///
        /// Refit: RMSE and time, on height maps with small cells.
        fine_grid_nodes_per_spacing: f64 = 12.0,
        /// Largest number of steps of conjugate gradients after each change of weights, and after breaching.
        ///
        /// Tried one by one: the RMSE of two maps changes by +0.03 % and +0.13 % with element 0 at 10 and 40; +0.32 %
        /// and -0.08 % with element 1 at 20 and 80; -0.94 % and +0.94 % with element 2 at 50 and 200.
        ///
        /// Refit: RMSE and time.
        further_steps: [usize; 3] = [20, 40, 100],
        /// A solution is done when no height changes by more than this in a sweep, as a share of the contour interval.
        ///
        /// Tried 0.0005 and 0.002: no effect on the RMSE of two maps.
        ///
        /// Refit: RMSE and time.
        convergence: f64 = 1e-3,
        /// Factor on the tension each time that the surface meets a bound of its band away from contours.
        ///
        /// Tried 8 and 32: the RMSE of two maps changes by -0.06 % and +0.11 %.
        ///
        /// Refit: RMSE.
        bound_tension_factor: f32 = 16.0,
        /// How far that factor spreads, nodes.
        ///
        /// Tried 5 and 20: the RMSE of two maps changes by 0 % and +0.02 %.
        ///
        /// Refit: RMSE.
        bound_tension_reach: usize = 10,
        /// Most rounds that make level ground even. Without them, ridge and canyon lines and the edges of large triangles show on it.
        ///
        /// Tried 0, on contours that lie on no raster: the RMSE of four maps changes by -0.02 %, and hillshades have hairlines.
        ///
        /// Refit: hillshades; RMSE.
        flat_rounds: usize = 40,
        /// Relative contour densities up to which ground counts as level in full, and from which it does not.
        ///
        /// Tried 0.1 to 0.3 and 0.25 to 0.75: the RMSE of four maps changes by +0.03 % and +0.2 %.
        ///
        /// Refit: hillshades; RMSE.
        flat_densities: [f32; 2] = [0.05, 0.2],
        /// Share of the reference surface where the smooth surface is level and the reference surface is not.
        ///
        /// Tried 0.15 and 0.6: the RMSE of four maps changes by -0.03 % and +0.56 %.
        ///
        /// Refit: RMSE; cells that are flat where the ground is not.
        shelf_share: f32 = 0.3,
        /// Rows and columns on each side over which that share is averaged, nodes.
        ///
        /// Tried 1 and 4: the RMSE of two maps changes by +0.05 % and -0.02 %.
        ///
        /// Refit: RMSE.
        shelf_reach: usize = 2,
        /// How far a surface of noisy contours may leave its band before it is moved to meet them, as a share of the
        /// contour interval.
        ///
        /// Tried 0.25 and 1: the RMSE of three maps changes by -0.17 % and +0.25 %.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        noise_slack: f64 = 0.5,
        /// How far from a noisy contour the surface may leave its band, spacings.
        ///
        /// Tried 0.1 and 0.4: the RMSE of nine maps changes by -0.04 % and +0.04 %.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        noise_slack_reach: f64 = 0.2,
        /// How far a correction at a noisy contour reaches, nodes.
        ///
        /// Tried 10 and 40: the RMSE of three maps changes by -0.02 % and +0.03 %.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        residual_reach: f32 = 20.0,
        /// Weight of a crossing against a first difference of the correction.
        ///
        /// Tried 50 and 200: the RMSE of three maps changes by +0.08 % and -0.07 %.
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar.
        residual_weight: f64 = 100.0,
        /// Largest number of steps for the correction.
        ///
        /// Tried 50 and 200: the RMSE of three maps changes by -0.02 % and 0 %.
        ///
        /// Refit: RMSE and time, on contours of unsmoothed lidar.
        residual_steps: usize = 100,
        /// Shrinkage towards the centre of the band.
        shrinkage: ShrinkageTuning = ShrinkageTuning::default(),
        /// Curvature gain on ridges and in valleys.
        gain: GainTuning = GainTuning::default(),
    }
}
