//! Streams.

use super::tuned;

tuned! {
    /// How streams are brought into agreement with contours.
    StreamTuning {
        /// How far a stream is moved at most, in spacings, if the caller does not say.
        ///
        /// Refit: RMSE near streams that were shifted.
        tolerance: f64 = 0.25,
        /// Ends of streams nearer to each other than this meet, in spacings.
        snap: f64 = 1e-3,
        /// Vertices of streams per spacing.
        ///
        /// Tried 1.5, 3 and 6: the RMSE near streams of four maps changes by less than 0.1 %.
        ///
        /// Refit: RMSE and time.
        vertices_per_spacing: f64 = 2.0,
        /// Heights of a stream are known between two crossings of contours that are at most this far from each other, in
        /// spacings.
        ///
        /// Refit: RMSE.
        sure_reach: f64 = 4.0,
        /// How far cells of height maps may be from the height of the stream through them, as a share of the contour
        /// interval. Cells that are nearer, and fall, stay.
        ///
        /// Refit: RMSE near streams (`scripts/score_true_streams.py`).
        cell_tolerance: f64 = 0.04,
        /// How far beside its valley a stream is looked for, in tolerances.
        beside_reach: f64 = 6.0,
        /// Length of the arms by which a crossing is seen to lie in a bend or on a slope, in tolerances.
        ///
        /// Tried 3: of streams planted beside their valleys on four maps, 64 % instead of 67 % are found by it.
        ///
        /// Refit: planted faults, and streams that are told of without one.
        slope_arm: f64 = 2.0,
        /// Where both arms run downstream by this share of their length, the contour bends.
        ///
        /// Tried 0.1: no more faults are found, and 0.9 % instead of 0.6 % of the other streams are told of.
        ///
        /// Refit: as above.
        least_valley: f64 = 0.05,
        /// Where one arm runs upstream by this share of its length, and the other one downstream, or both upstream, the
        /// crossing lies on a slope.
        ///
        /// Tried 0.15 and 0.3: 71 % and 63 % of the faults are found, and 1.4 % and 0.6 % of the other streams told of.
        ///
        /// Refit: as above.
        least_slope: f64 = 0.25,
        /// The ground may rise by this share of the contour interval along a stream, between contours. Where it rises more, the
        /// stream is cut.
        ///
        /// Of true streams on four maps, 0 to 2 % are told of.
        ///
        /// Refit: streams that are planted over ridges, and true streams that are told of.
        climb: f64 = 0.5,
        /// Above this share of contradicted length, the streams are of another place. Reaches count by the contours that they
        /// cross.
        ///
        /// On four maps and 30 drawn grounds it is 0 to 0.41 for the true streams. It is 0.52 to 1 for streams that are shifted by
        /// 2 % and 10 % of the map's width, turned or mirrored, on four maps and twelve grounds. One ground has 0.44 with a
        /// shift by 2 %.
        ///
        /// Refit: true streams, and streams of another place.
        elsewhere: f64 = 0.5,
        /// A bend of a contour whose arms run downstream at least this far has a tip, in tolerances.
        least_tip: f64 = 0.1,
        /// From this depth on, all tips count the same, in tolerances.
        deep_tip: f64 = 0.5,
        /// Cost of a shift by the tolerance, against a gain of 1 for a deep tip.
        shift_cost: f64 = 0.5,
        /// Cost of a change of the shift by the tolerance, from one crossing to the next.
        change_cost: f64 = 0.5,
    }
}
