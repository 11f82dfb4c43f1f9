//! Forces on small spheres: traps, their stiffness and places of rest, and gradients of all quantities.

pub(crate) mod gorkov;
pub(crate) mod gradient;
mod momentum;
pub(crate) mod particle;
pub(crate) mod quantity;
pub(crate) mod response;
pub(crate) mod rest;
pub(crate) mod stiffness;
