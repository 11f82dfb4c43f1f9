//! Solvers: a file or folder for each method, one line for each in the registry.

// This module comes first, because the methods use its macro `options!`.
#[macro_use]
pub(crate) mod options;

pub(crate) mod amplitude_limit;
pub(crate) mod batching;
pub(crate) mod best;
pub(crate) mod bounded;
pub(crate) mod common;
pub(crate) mod descent;
pub(crate) mod evd;
pub(crate) mod even_field;
pub(crate) mod fast;
pub(crate) mod glide;
pub(crate) mod greedy;
pub(crate) mod gs;
pub(crate) mod gspat;
pub(crate) mod iterate;
pub(crate) mod last;
pub(crate) mod lm;
pub(crate) mod method;
pub(crate) mod naive;
pub(crate) mod prelude;
pub(crate) mod registry;
pub(crate) mod remark;
pub(crate) mod sdp;
pub(crate) mod solve;
pub(crate) mod tikhonov;
pub(crate) mod uniform;
pub(crate) mod wgs;

pub use amplitude_limit::AmplitudeLimit;
pub use best::Best;
pub use bounded::Bounded;
pub use common::refinement::refine;
pub use descent::Descent;
pub use evd::Evd;
pub use fast::Fast;
pub use glide::Glide;
pub use greedy::by_energy::{ActiveRequest, Energy, GreedyBy};
pub use greedy::{Greedy, Objective, Order};
pub use gs::Gs;
pub use gspat::Gspat;
pub use last::Last;
pub use lm::Lm;
pub use method::{Info, Method, Solve};
pub use naive::Naive;
pub use registry::{Configured, DEFAULT, Entry, SOLVERS, configure, find, unused};
pub use remark::{Remark, fallen, remarks};
pub use sdp::{Moduli, Sdp};
pub use tikhonov::Tikhonov;
pub use uniform::Uniform;
pub use wgs::Wgs;
