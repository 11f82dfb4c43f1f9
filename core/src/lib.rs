//! Drives for airborne ultrasound phased arrays, so that the sound pressure at given points is what you request.
//!
//! # The paper in one page
//! N transducers at distance r from M control points radiate (eq. 5, with directivity, absorption and response)
//!
//! ```text
//! p_j = sum_i G_ji q_i,   G_ji = P0/r D(theta) e^{-alpha r} e^{+jkr} c_i,   |q_i| <= 1
//! ```
//!
//! and a hand feels |p_j| alone. So the phases at the points are free, and the drive q is sought that minimises
//! (eq. 7) `sum_j w_j (t_j - |p_j|)^2` for targets t_j. Suzuki et al. (IEEE Trans. Haptics 14(4), 2021) do it
//! greedily: one transducer after another tries K amplitudes times L phases and keeps the best, while the field
//! at the points is kept up to date (eq. 9). That is linear in N and in M, needs no matrix and runs anywhere.
//! Two numbers judge it: accuracy `sum |p_j| / sum t_j` (eq. 12) and sigma, the spread of |p_j|/t_j (eq. 13).
//!
//! # One way through
//! points -> [`Scene`] (checked once) -> [`Propagation`] -> [`Problem`] -> [`Solve::solve`] -> [`Solution`] -> [`field()`].
//!
//! ```
//! use midair::{Array, Control, Medium, Problem, Request, Scene, Workspace, solvers::Greedy};
//!
//! // Two points 15 cm above the paper's 20 x 20 array, as strong as it can make both.
//! let array = Array::preset("paper20", [1, 1])?;
//! let points = vec![[-0.02, 0.0, 0.15], [0.02, 0.0, 0.15]];
//! let scene = Scene::new(array, Medium::default(), points, Request::default())?;
//! let problem = Problem::new(&scene)?;
//! let solution = midair::solve(&problem, &Greedy::default(), false, &mut Workspace::new(), &mut Control::none())?;
//! assert!(solution.drive.iter().all(|q| q.norm() < 1.0 + 1e-6));
//! assert!(solution.metrics().uniformity > 0.8);
//! # Ok::<(), midair::Error>(())
//! ```
//!
//! SI units, time factor e^{-jwt}, |p| is the peak amplitude; all conventions are in `docs/conventions.md`.
//!
//! # Features
//! `std` (default; without it the crate is `no_std` + alloc), `scene-file` (scenes as TOML or JSON text).
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;
// This name lets solvers in this crate be written exactly as in a crate of your own (docs/extending.md).
extern crate self as midair;

// Unsafe code is denied but in `kernels::simd`; `tests/suite/unsafe_code.rs` lists its files.
mod control;
mod device;
mod error;
#[cfg(feature = "scene-file")]
pub mod files;
pub mod flight;
mod kernels;
mod linalg;
mod math;
pub mod points;
mod prelude;
mod problem;
mod propagation;
mod rng;
mod scene;
pub mod sequence;
mod session;
pub mod solvers;
#[cfg(feature = "std")]
mod threads;
pub mod touch;
mod vec3;
mod workspace;

pub use control::{Control, Observe, Progress};
pub use device::board::Board;
pub use device::channels::Channels;
pub use device::format::{Code, Link};
pub use device::quantization::Quantization;
pub use error::{Error, ErrorCode, Notice, Result, frame_rate};
pub use kernels::InstructionSet;
pub use num_complex::{Complex32, Complex64};
pub use problem::{Beyond, Metrics, Precision, Problem, Reach, Setup, Solution, Status, bound};
pub use propagation::forces::gorkov::{Gorkov, gorkov};
pub use propagation::forces::gradient::{Gradient, gradient};
pub use propagation::forces::quantity::Quantity;
pub use propagation::forces::rest::{Rest, poised, rest};
pub use propagation::{Boundary, FieldMatrix, Model, Propagation, field};
pub use rng::Rng;
pub use scene::{
    Aim, Array, Axis, Bead, Body, Choice, Directivity, Extras, Key, Medium, Mesh, Obstacle, OptionValue, Options,
    Origin, Parameter, Part, PartKind, PartValue, Particle, Plane, Pose, Request, Scene, Signature, Start, Surface,
    Transducer, Value, presets, spell, spl, word,
};
pub use session::{
    Batch, FOLLOWER, Frames, Moving, MovingSolver, Pace, Played, Pull, Session, SolveRequest, Trajectory, meant, sight,
};
#[doc(hidden)]
pub use solvers::options::private as __private;
pub use solvers::options::{Configure, OptionInfo};
pub use solvers::{Solve, solve::solve};
pub use workspace::{Buffer, Pool, Workspace};

/// The chapters of `docs/` whose code is run as tests.
#[cfg(doctest)]
mod chapters {
    #[doc = include_str!("../../docs/extending.md")]
    mod extending {}
    #[doc = include_str!("../../docs/rust.md")]
    mod rust {}
}
