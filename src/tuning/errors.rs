//! The standard error.

use super::tuned;

tuned! {
    /// The error model: how the standard error follows from residuals at hidden contours.
    ErrorTuning {
        /// Classes of distance between contours, of equal area, that each get an error of their own.
        ///
        /// Refit: shares.
        width_classes: usize = 8,
        /// Weight of the two-sigma figure against the one-sigma figure in the standard error, on a logarithmic scale.
        /// The figures are half of the 95 % quantile and the 68 % quantile. It applies where errors have light tails.
        ///
        /// Refit: shares.
        two_sigma_weight: f64 = 0.6,
        /// Largest ratio of the 95 % figure to the standard error, where errors have heavy tails.
        ///
        /// Refit: shares.
        max_tail: f64 = 2.7,
        /// The largest standard error, as a share of the band: that of a height about which only the band is known.
        ///
        /// Refit: shares.
        unknown: f64 = 0.35,
        /// Factor from errors at hidden contours to errors all over the ground; smooth surface.
        ///
        /// Refit: shares.
        hidden_to_all: f64 = 0.9,
        /// The same; surface of triangles.
        ///
        /// Refit: shares, with `--surface skeleton`.
        hidden_to_all_triangles: f64 = 0.95,
        /// Distances between contours, in spacings, where ground begins to count as level, and where it is fully level.
        /// On level ground the error is a share of the band, whatever the exponent of the contours is.
        ///
        /// Refit: shares of gentle ground.
        level_spacings: [f64; 2] = [2.0, 6.0],
        /// Power with which the error grows with the product of both distances to contours, in exponents of the
        /// contours.
        ///
        /// Refit: shares near contours and in the middle of a band.
        profile_power: f64 = 0.55,
        /// Where there is a single contour: width that stands for the distance from it, as a multiple of this distance.
        ///
        /// Refit: shares of tops and pits.
        lone_contour_width: f64 = 3.0,
        /// Limits of the error beyond the last contour, as a share of the climb.
        ///
        /// Refit: shares of tops and pits.
        climb_share_limits: [f64; 2] = [0.2, 0.8],
        /// That share where there are too few tops to estimate it.
        ///
        /// Refit: shares of tops and pits.
        usual_climb_share: f64 = 0.5,
        /// Least number of places beyond the last contour to estimate this share.
        ///
        /// Refit: shares of tops and pits.
        min_top_places: usize = 50,
        /// Where no levels can be hidden: standard error half-way between contours one spacing apart, as a share of the
        /// contour interval.
        ///
        /// Refit: shares, on maps with few levels.
        usual_error: f64 = 0.08,
        /// Where no levels can be hidden: power with which the standard error grows with the distance between contours.
        ///
        /// Refit: shares, on maps with few levels.
        usual_width_power: f64 = 0.7,
        /// Factor on the error where the smooth surface and the reference surface are the same.
        ///
        /// Refit: shares of the largest and the smallest errors.
        agreement_factor: f64 = 0.65,
        /// Growth of that factor per standard error between the two surfaces.
        ///
        /// Refit: shares of the largest and the smallest errors.
        disagreement_slope: f64 = 0.42,
        /// Largest distance between the two surfaces that counts, in standard errors.
        ///
        /// Refit: shares of the largest and the smallest errors.
        max_disagreement: f64 = 2.2,
        /// Contours count as cut from the heights of the nodes if more than this share of their crossings with edges is
        /// at vertices.
        ///
        /// Refit: shares, on contours that were cut from a raster.
        min_share_at_vertices: f64 = 0.9,
        /// Crossings per node at which such contours begin to fix the heights of the nodes.
        ///
        /// Refit: shares, on contours that were cut from a raster.
        fixing_crossings: f64 = 0.765,
        /// Power with which the error falls with the crossings per node.
        ///
        /// Refit: shares, on contours that were cut from a raster.
        fixing_power: f64 = 5.0,
        /// Least share of the error that remains there.
        ///
        /// Refit: shares, on contours that were cut from a raster.
        min_left: f64 = 0.15,
        /// Columns and rows on each side over which these crossings are averaged, nodes.
        ///
        /// Refit: shares, on contours that were cut from a raster.
        fixing_reach: usize = 2,
        /// Distance between contours, in spacings, above which new lines are marked as inferred.
        ///
        /// Refit: share of the marked lines that are off by more than a standard error.
        inferred_spacings: f64 = 6.0,
    }
}
