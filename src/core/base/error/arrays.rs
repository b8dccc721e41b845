//! Faults in the arrays that describe lines: [`ArrayFault`].

/// Why coordinates, offsets and elevations do not describe lines.
///
/// Line `k` has the coordinates from `offsets[k]` up to but not including `offsets[k + 1]`, and the elevation
/// `elevations[k]`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ArrayFault {
    /// The number of offsets is not the number of elevations plus one.
    #[error("{offsets} offsets and {elevations} elevations: there must be one offset more than elevations")]
    Lengths {
        /// Number of offsets.
        offsets: usize,
        /// Number of elevations.
        elevations: usize,
    },
    /// The first offset is not 0.
    #[error("the first offset is {0}, it must be 0")]
    Start(usize),
    /// An offset is less than the one before it.
    #[error("offset number {0} is less than the one before it")]
    Descending(usize),
    /// The last offset is not the number of coordinates.
    #[error("the last offset is {last}, it must be the number of coordinates, {coordinates}")]
    End {
        /// The last offset.
        last: usize,
        /// Number of coordinates.
        coordinates: usize,
    },
}
