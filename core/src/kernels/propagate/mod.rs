//! Rows of G.

pub(crate) mod directivity;
pub(crate) mod row;
pub(crate) mod rows;
