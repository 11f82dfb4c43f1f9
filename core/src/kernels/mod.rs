//! Kernels: every loop worth vectorising, behind safe functions of slices.
//!
//! Numbers are f32, complex ones planar (real and imaginary parts in separate slices), slices padded to a multiple of
//! [`LANES`]. Each loop is written once over [`simd::Simd`], with 16 lanes and a fixed order of sums, and compiled for
//! every [`InstructionSet`].

pub(crate) mod around;
pub(crate) mod backward;
pub(crate) mod cholesky;
pub(crate) mod closed_form;
pub(crate) mod contraction;
pub(crate) mod derivatives;
pub(crate) mod dither;
pub(crate) mod double;
pub(crate) mod flight;
pub(crate) mod greedy;
pub(crate) mod grid;
pub(crate) mod lanes;
pub(crate) mod limit;
pub(crate) mod matrix;
pub(crate) mod panels;
pub(crate) mod phasor;
pub(crate) mod prelude;
pub(crate) mod propagate;
pub(crate) mod pulses;
pub(crate) mod simd;
pub(crate) mod sparse;
#[cfg(test)]
mod tests;
pub(crate) mod tiles;
pub(crate) mod track;
pub(crate) mod vector;
pub(crate) mod waves;

pub(crate) use greedy::candidates::{Candidates, L1, L2, PhaseRange, table};
pub(crate) use greedy::point_group::PointGroup;
pub(crate) use greedy::replacement::{keep, replace, rotate};
pub(crate) use lanes::{LANES, padded};
pub(crate) use matrix::{add_waves, correlate_rows};
pub(crate) use propagate::field::add_field;
pub(crate) use propagate::moduli::{Run, add_moduli, interleaved_moduli};
pub(crate) use propagate::row::{ControlPoints, Row, row};
pub(crate) use propagate::rows::Rows;
pub(crate) use propagate::source::{Radiation, Source, SourceList};
pub use simd::instruction_set::InstructionSet;
pub(crate) use vector::{accumulate, correlate, dot, modulus, squares};
