//! Prelude of the solvers: the problem and its solution, what a method is, and the memory it uses.

pub(crate) use crate::device::quantization::Quantization;
pub(crate) use crate::kernels::{InstructionSet, LANES};
pub(crate) use crate::linalg::Planar;
pub(crate) use crate::prelude::*;
pub(crate) use crate::problem::{Problem, Solution, Status};
pub(crate) use crate::solvers::common::tiled::{Rows, Wave};
pub(crate) use crate::solvers::method::{Info, Method, Solve, check_iteration};
pub(crate) use crate::workspace::{Buffer, Workspace};

/// Declares what is true of a method and what is false: functions of [`Solve`].
macro_rules! facts {
    ($($name:ident = $value:literal),+) => {
        $(
            fn $name(&self) -> bool {
                $value
            }
        )+
    };
}
pub(crate) use facts;
