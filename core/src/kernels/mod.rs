//! Kernels: every loop worth vectorising, behind safe functions of slices.
//!
//! Numbers are f32, complex ones planar (real and imaginary parts in separate slices), slices padded to a multiple of
//! [`LANES`]. Each loop is written once over [`simd::Simd`], with 16 lanes and a fixed order of sums, and compiled for
//! every [`InstructionSet`].

#[forbid(unsafe_code)]
pub(crate) mod around;
#[forbid(unsafe_code)]
pub(crate) mod backward;
#[forbid(unsafe_code)]
pub(crate) mod cholesky;
#[forbid(unsafe_code)]
pub(crate) mod closed_form;
#[forbid(unsafe_code)]
pub(crate) mod contraction;
#[forbid(unsafe_code)]
pub(crate) mod derivatives;
#[forbid(unsafe_code)]
pub(crate) mod dither;
#[forbid(unsafe_code)]
pub(crate) mod double;
#[forbid(unsafe_code)]
pub(crate) mod flight;
#[forbid(unsafe_code)]
pub(crate) mod greedy;
#[forbid(unsafe_code)]
pub(crate) mod grid;
#[forbid(unsafe_code)]
pub(crate) mod lanes;
#[forbid(unsafe_code)]
pub(crate) mod limit;
#[forbid(unsafe_code)]
pub(crate) mod matrix;
#[forbid(unsafe_code)]
pub(crate) mod panels;
#[forbid(unsafe_code)]
pub(crate) mod phasor;
#[forbid(unsafe_code)]
pub(crate) mod propagate;
#[forbid(unsafe_code)]
pub(crate) mod pulses;
pub(crate) mod simd;
#[forbid(unsafe_code)]
pub(crate) mod sparse;
#[forbid(unsafe_code)]
#[cfg(test)]
mod tests;
#[forbid(unsafe_code)]
pub(crate) mod tiles;
#[forbid(unsafe_code)]
pub(crate) mod track;
#[forbid(unsafe_code)]
pub(crate) mod vector;
#[forbid(unsafe_code)]
pub(crate) mod waves;

pub(crate) use greedy::candidates::{Candidates, PhaseRange, table};
pub(crate) use greedy::objective::{L1, L2};
pub(crate) use greedy::point_group::PointGroup;
pub(crate) use greedy::replacement::{keep, replace, rotate};
pub(crate) use lanes::{LANES, padded};
pub(crate) use matrix::{add_waves, correlate_rows};
pub(crate) use propagate::field::add_field;
pub(crate) use propagate::form::Radiation;
pub(crate) use propagate::moduli::{Run, add_moduli, interleaved_moduli};
pub(crate) use propagate::row::{ControlPoints, Row, row};
pub(crate) use propagate::rows::Rows;
pub(crate) use propagate::source::{Source, SourceList};
pub use simd::instruction_set::InstructionSet;
pub(crate) use vector::{accumulate, correlate, dot, modulus, squares};
