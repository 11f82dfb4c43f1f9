//! Start: the drive or point phases from which a method begins. Any drive is checked here: one number a transducer.

use crate::error::one_each;
use crate::prelude::*;

/// Where an iterative method begins.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// A drive (N,), |q| <= 1.
    Drive(Vec<Complex32>),
    /// Phases (M,) in rad of the pressures at the points.
    Phases(Vec<f64>),
}

/// Checks that a drive has one finite value of modulus at most 1 for each transducer.
pub(crate) fn check_drive(drive: &[Complex32], transducers: usize) -> Result<(), Error> {
    one_each("drive", drive.len(), "values", transducers, "transducers")?;
    for (i, q) in drive.iter().enumerate() {
        let modulus = math::modulus(*q);
        if !modulus.is_finite() {
            return Err(Error::not_finite(format!("drive[{i}]"), q));
        }
        if modulus > 1.0 + 1e-6 {
            let cure = "a drive's modulus is at most 1; divide all by the largest, or each above 1 by its own";
            return Err(Error::invalid(format!("drive[{i}]"), q, cure));
        }
    }
    Ok(())
}
