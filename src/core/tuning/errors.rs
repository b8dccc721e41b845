//! The standard error.

use super::tuned;

tuned! {
    /// The error model: how the standard error follows from residuals at hidden contours.
    ErrorTuning {
        /// Classes of distance between contours, of equal area, that each get an error of their own.
        ///
        /// Tried 4 and 16: the share of errors within one standard error of two maps changes by +1.3 and -0.4 points.
        ///
        /// Refit: shares.
        width_classes: usize = 8,
        /// Largest ratio of the 95 % figure to the standard error, where errors have heavy tails.
        ///
        /// Tried 1.35 and 5.4: the share of errors within one standard error of four maps changes by +10.6 and -0.1
        /// points.
        ///
        /// Refit: shares.
        max_tail: f64 = 2.7,
        /// The largest standard error, as a share of the band: that of a height about which only the band is known.
        ///
        /// Tried 0.175 and 0.7: the share of errors within one standard error of three maps changes by +1.1 and -0.6
        /// points.
        ///
        /// Refit: shares.
        unknown: f64 = 0.35,
        /// Factor from errors at hidden contours to errors all over the ground; smooth surface.
        ///
        /// Tried 0.45 and 1.8: the share of errors within one standard error of four maps changes by -18.9 and +14.2
        /// points.
        ///
        /// Refit: shares.
        hidden_to_all: f64 = 0.9,
        /// The same; surface of triangles.
        ///
        /// Tried 0.475 and 1.9: no effect on the share of errors within one standard error of three maps. It acts on
        /// other surfaces only.
        ///
        /// Refit: shares, with `--surface skeleton`.
        hidden_to_all_triangles: f64 = 0.95,
        /// Distances between contours, in spacings, where ground begins to count as level, and where it is fully level.
        /// On level ground the error is a share of the band, whatever the exponent of the contours is.
        ///
        /// Tried one by one: the share of errors within one standard error of three maps changes by +0.9 and -0.4
        /// points with element 0 at 1 and 4; +0.4 and -0.3 points with element 1 at 3 and 12.
        ///
        /// Refit: shares of gentle ground.
        level_spacings: [f64; 2] = [2.0, 6.0],
        /// Power with which the error grows with the product of both distances to contours, in exponents of the
        /// contours.
        ///
        /// Tried 0.275 and 1.1: the share of errors within one standard error of four maps changes by +4.1 and -8.7
        /// points.
        ///
        /// Refit: shares near contours and in the middle of a band.
        profile_power: f64 = 0.55,
        /// Where there is a single contour: width that stands for the distance from it, as a multiple of this distance.
        ///
        /// Tried 1.5 and 6: the share of errors within one standard error of three maps changes by -0.4 and +0.4
        /// points.
        ///
        /// Refit: shares of tops and pits.
        lone_contour_width: f64 = 3.0,
        /// Limits of the error beyond the last contour, as a share of the climb.
        ///
        /// Tried one by one: the share of errors within one standard error of three maps changes by 0 and +0.1 points
        /// with element 0 at 0.1 and 0.4; 0 with element 1 at 0.4 and 1.6.
        ///
        /// Refit: shares of tops and pits.
        climb_share_limits: [f64; 2] = [0.2, 0.8],
        /// Factor on the error where the smooth surface and the reference surface are the same.
        ///
        /// Tried 0.325 and 1.3: the share of errors within one standard error of three maps changes by -2.1 and +0.1
        /// points.
        ///
        /// Refit: shares of the largest and the smallest errors.
        agreement_factor: f64 = 0.65,
        /// Growth of that factor per standard error between the two surfaces.
        ///
        /// Tried 0.21 and 0.84: the share of errors within one standard error of four maps changes by -1.6 and +3.2
        /// points.
        ///
        /// Refit: shares of the largest and the smallest errors.
        disagreement_slope: f64 = 0.42,
        /// Largest distance between the two surfaces that counts, in standard errors.
        ///
        /// Tried 1.1 and 4.4: the share of errors within one standard error of four maps changes by -1.5 and +0.9
        /// points.
        ///
        /// Refit: shares of the largest and the smallest errors.
        max_disagreement: f64 = 2.2,
        /// Contours count as cut from the heights of the nodes if more than this share of their crossings with edges is
        /// at vertices.
        ///
        /// Tried 0.45 and 1.8: the share of errors within one standard error of three maps changes by 0 and +0.4
        /// points.
        ///
        /// Refit: shares, on contours that were cut from a raster.
        min_share_at_vertices: f64 = 0.9,
        /// Crossings per node at which such contours begin to fix the heights of the nodes.
        ///
        /// Tried 0.3825 and 1.53: the share of errors within one standard error of four maps changes by -5.8 and +0.3
        /// points.
        ///
        /// Refit: shares, on contours that were cut from a raster.
        fixing_crossings: f64 = 0.765,
        /// Power with which the error falls with the crossings per node.
        ///
        /// Tried 2.5 and 10: the share of errors within one standard error of three maps changes by -0.6 and 0 points.
        ///
        /// Refit: shares, on contours that were cut from a raster.
        fixing_power: f64 = 5.0,
        /// Columns and rows on each side over which these crossings are averaged, nodes.
        ///
        /// Tried 1 and 4: the share of errors within one standard error of three maps changes by -0.3 and +0.1 points.
        ///
        /// Refit: shares, on contours that were cut from a raster.
        fixing_reach: usize = 2,
        /// Distance between contours, in spacings, above which new lines are marked as inferred.
        ///
        /// Tried 3 and 12: on two maps, 5 to 6 % and 2 % of the length of new lines is marked; with the default 2 %.
        ///
        /// Refit: share of the marked lines that are off by more than a standard error.
        inferred_spacings: f64 = 6.0,
    }
}
