//! The smooth surface: minimum curvature through the contours, on a working grid.
//!
//! The surface of least bending energy that passes through the contours, with three things added to the plain one:
//!
//! * Every node stays inside the band of its sub-domain while the surface is found, not only afterwards.
//! * Tension draws it to the slopes of the surface with ridge and canyon lines (the paper's), not to level ground: where
//!   contours are close, the straight way between them is the best guess, and shelves and bulges do not arise.
//! * It may bend sharply where it must, most of all along ridge and canyon lines.
//!
//! How much tension, and whether contours jitter and are to be smoothed, is seen from the data (`choose`, `roughness`).
//!
//! `stages` finds it from coarse to fine lattices (`lattice`), each by conjugate gradients between bounds
//! (`minimise`, `tile`, `stencil`) for the energy in `energy`, whose weights follow the surface (`reweight`).
//! Then heights are drawn away from the levels, and ridges and valleys get more relief, as far as hidden contours tell
//! (`expected`, `relief`), and last, ways out of pits are cut (`pits`).

mod blur;
mod conditions;
mod curvature_gain;
mod density;
mod energy;
mod grid;
mod lattice;
mod minimise;
mod params;
mod pits;
mod residual;
mod reweight;
mod shelves;
mod shrinkage;
mod slopes;
mod solve;
mod stages;
mod stencil;
mod tile;
mod unevenness;
mod working_grid;

pub(crate) use blur::blurred;
pub(crate) use conditions::Conditions;
pub(crate) use grid::{bytes_on, working_grid};
pub(crate) use lattice::Lattice;
pub use params::{HyperParameters, SplineParams, Wanted};
pub(crate) use slopes::slopes;
pub(crate) use solve::spline;
pub(crate) use stages::STEP;
pub use working_grid::WorkingGrid;
