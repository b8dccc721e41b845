//! The tuned numbers of the surface and of its standard error, in one place.
//!
//! A tuned number has its value for one of two reasons. Results were best with it on maps with known heights, or it is
//! a good balance of accuracy and time. A slightly different value would do as well. Numbers with another reason stand
//! where they are used: closed forms, tolerances of rounding, sizes of blocks, limits of memory.
//!
//! Each number is documented with its meaning, its unit, the values that were tried with their effect, and the measure
//! that refits it:
//!
//! | refit | what is wanted | how it is measured |
//! |---|---|---|
//! | RMSE | the smallest error of height maps of known ground | `scripts/bench/sweep.py` |
//! | shares | 68 % of the true errors within one standard error, 95 % within two | `scripts/bench/sweep.py`, `scripts/bench/calibration.py` |
//! | time | the least time for an RMSE that hardly rises | `scripts/bench/sweep.py` and `scripts/bench/benchmark_speed.py` |
//! | contours | the smallest distance of new contours from true ones | `scripts/bench/score_contours.py` |
//!
//! The guide's page on tuning (`src/guide/tuning.md`) has the whole table of values that were tried. A *spacing* is the
//! mean spacing of neighbouring contours of the map. A *node* is one of the working grid.

mod break_lines;
mod cliffs;
mod errors;
mod grid;
mod join;
mod names;
mod nodes;
mod roughness;
mod shrinkage;
mod skeleton;
mod spline;
mod streams;
mod trials;
mod wide;

pub use break_lines::BreakLineTuning;
pub use cliffs::CliffTuning;
pub use errors::ErrorTuning;
pub use grid::GridTuning;
pub use join::JoinTuning;
pub use names::TuneError;
pub use nodes::NodeTuning;
pub use roughness::RoughnessTuning;
pub use shrinkage::{GainTuning, ShrinkageTuning};
pub use skeleton::SkeletonTuning;
pub use spline::SplineTuning;
pub use streams::StreamTuning;
pub use trials::TrialTuning;
pub use wide::WideTuning;

/// Declares a group of numbers, each with type and default value. The documentation of each number states its default.
macro_rules! tuned {
    ($(#[$about:meta])* $group:ident { $($(#[$meaning:meta])* $name:ident: $kind:ty = $value:expr,)+ }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $group {
            $($(#[$meaning])* #[doc = concat!("\n\nDefault: `", stringify!($value), "`.")] pub $name: $kind,)+
        }

        impl Default for $group {
            fn default() -> Self {
                Self { $($name: $value,)+ }
            }
        }
    };
}
use tuned;

tuned! {
    /// All tuned numbers.
    Tuning {
        /// Ridge and canyon lines.
        skeleton: SkeletonTuning = SkeletonTuning::default(),
        /// The smooth surface.
        spline: SplineTuning = SplineTuning::default(),
        /// How rough contours are.
        roughness: RoughnessTuning = RoughnessTuning::default(),
        /// Trials with hidden levels, and the choice of hyper-parameters.
        trials: TrialTuning = TrialTuning::default(),
        /// The standard error.
        errors: ErrorTuning = ErrorTuning::default(),
        /// Triangles of the smooth surface.
        nodes: NodeTuning = NodeTuning::default(),
        /// Streams.
        streams: StreamTuning = StreamTuning::default(),
        /// Cliffs.
        cliffs: CliffTuning = CliffTuning::default(),
        /// Break lines.
        break_lines: BreakLineTuning = BreakLineTuning::default(),
        /// Joins with a height map outside the frame.
        join: JoinTuning = JoinTuning::default(),
    }
}
