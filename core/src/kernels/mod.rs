//! Kernels: every loop worth vectorising, behind safe functions of slices.
//!
//! Numbers are f32, complex ones planar (re and im apart), slices padded to a multiple of [`LANES`]. Each loop
//! is written once over [`simd::Simd`], 16 lanes and a fixed order of sums, and compiled for every [`InstructionSet`].

pub(crate) mod cholesky;
pub(crate) mod closed_form;
pub(crate) mod greedy;
pub(crate) mod lanes;
pub(crate) mod matrix;
pub(crate) mod phasor;
pub(crate) mod propagate;
pub(crate) mod simd;
#[cfg(test)]
mod tests;
pub(crate) mod tiles;
pub(crate) mod vector;

pub(crate) use greedy::candidates::{Candidates, table};
pub(crate) use greedy::objective::{L1, L2};
pub(crate) use greedy::point_group::PointGroup;
pub(crate) use greedy::rotate::{keep, rotate};
pub(crate) use lanes::{LANES, padded};
pub(crate) use matrix::{add_waves, correlate_rows};
pub(crate) use propagate::directivity::Table;
pub(crate) use propagate::row::{ControlPoints, Radiation, Row, Source, add_moduli, row};
pub(crate) use propagate::rows::Rows;
pub use simd::instruction_set::InstructionSet;
pub(crate) use vector::{accumulate, correlate, dot, modulus, project, squares};
