//! The figures of Zhang, Konno and Tokuyama, "3D Terrain Reconstruction Based on Contours" (CAD/CG 2005), one test each, on
//! samples whose right answer is worked out by hand.
//!
//! What is expected follows from the drawings (see samples/README.md). A sub-domain with V vertices on its border and h
//! holes has V + 2h - 2 triangles. Every piece of its border belongs to one triangle; a terminal one has two of them, a
//! sleeve one, a junction none, so that 2T + S = V, and by subtraction T = J + 2 - 2h.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod bars;
mod sample;
mod shapes;
mod shells;
mod triangles;
