//! Rows of the propagation matrix G from positions, eq. (5).

pub(crate) mod directivity;
pub(crate) mod field;
pub(crate) mod moduli;
pub(crate) mod octets;
pub(crate) mod row;
pub(crate) mod rows;
pub(crate) mod source;
