//! The smooth surface: minimum curvature through the contours, on a working grid.
//!
//! It is a minimum-curvature surface (Briggs 1974, Geophysics 39; with tension: Smith and Wessel 1990, Geophysics 55).
//! It differs from the plain one in five ways:
//!
//! * Every node stays inside the band of its sub-domain, from the first step on.
//! * Tension draws its slopes to those of the reference surface, which has the paper's ridge and canyon lines, and not
//!   to level ground. Where contours are close, the straight way between them is the best guess. So shelves and bulges
//!   do not arise.
//! * Near the frame, where contours and ridge lines end, the tension falls to nothing (`border`).
//! * In wide places, such as valley floors, a slope ends at the contour where the distance between contours jumps
//!   (`wide`).
//! * It may bend sharply where it must, most of all along ridge and canyon lines (iteratively reweighted least squares,
//!   IRLS).
//!
//! The hyper-parameters, such as the tension, are chosen from the data ([`validate`](crate::validate)).
//!
//! The steps are in `solve`. First the surface is found on coarse lattices, then on finer ones (`stages`, `lattice`).
//! On each, conjugate gradients between bounds (`minimise`, `tile`, `stencil`) minimise the energy in `energy`. Its
//! weights follow the surface (`reweight`). Then heights shrink towards the centre of their band (`shrinkage`), ridges
//! and valleys get their curvature gain (`curvature_gain`), flats become even (`flats`), dense contours are met (`misses`), streams get its heights
//! and fall, and pits are breached (`pits`).

mod at_contour;
mod blur;
mod border;
mod cliffs;
mod conditions;
mod curvature_gain;
mod density;
mod energy;
mod far;
mod flats;
mod fold;
mod grid;
mod inside;
mod lattice;
mod minimise;
mod misses;
mod params;
mod pits;
mod residual;
mod reweight;
mod shelves;
mod shrinkage;
mod slack;
mod slopes;
mod soft_spots;
mod solve;
mod spots;
mod stages;
mod stencil;
mod steps;
mod tile;
mod unevenness;
mod wide;
mod working_grid;

pub(crate) use blur::{PASSES, blurred};
pub(crate) use cliffs::beside;
pub(crate) use conditions::{Conditions, Drainage};
pub(crate) use fold::Fold;
pub use grid::bytes_on;
pub(crate) use grid::{coarser_than_asked, finer_grid, part_of_grid, whole_grid, working_grid};
pub(crate) use lattice::{CrossingKind, Lattice};
pub(crate) use misses::Misses;
pub use params::{HyperParameters, SplineParams, Wanted};
pub(crate) use slopes::slopes;
pub(crate) use solve::spline;
pub(crate) use stages::STEP;
pub use working_grid::{WorkingGrid, WorkingGrids};
