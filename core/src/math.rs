//! Elementary functions with the same bits on every platform.
//!
//! The `sin` or `exp` of two platforms may differ in the last bit, and one such bit can decide between two equally good choices
//! of the greedy search. Therefore the pure-Rust `libm` is used, with and without `std`. Square roots are exact by IEEE 754,
//! and come from the hardware if `std` is available.

use num_complex::{Complex32, Complex64};

pub(crate) use libm::{
    acos, atan2, atan2f, cbrt, ceil, cos, exp, floor, floorf, hypot, j0, j1, log, log10, pow, rint, round, sin,
};

/// Square root in double precision.
#[inline(always)]
pub(crate) fn sqrt(x: f64) -> f64 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrt(x);
}

/// e^{j phase} for a phase in rad.
pub(crate) fn phasor(phase: f64) -> Complex64 {
    Complex64::new(cos(phase), sin(phase))
}

/// The modulus |z|, computed in double precision, where the squares of f32 are exact and cannot overflow or underflow.
#[inline(always)]
pub(crate) fn modulus(z: Complex32) -> f64 {
    let (re, im) = (f64::from(z.re), f64::from(z.im));
    sqrt(re * re + im * im)
}

/// The phase of z in rad in [0, 2 pi); 0 where z = 0.
pub(crate) fn phase(z: Complex32) -> f64 {
    use core::f64::consts::TAU;
    if z == Complex32::ZERO {
        return 0.0;
    }
    let angle = atan2(f64::from(z.im), f64::from(z.re));
    let positive = if angle < 0.0 { angle + TAU } else { angle };
    // A tiny negative angle rounds up to 2 pi.
    if positive < TAU { positive.abs() } else { 0.0 }
}

/// z/|z| for z = re + j im; 1 if z is 0.
pub(crate) fn unit(re: f32, im: f32) -> (f32, f32) {
    /// If the square of a number is below LEAST, digits are lost: such a number is multiplied by UP first.
    const LEAST: f32 = 1e-30;
    const UP: f32 = (1_u64 << 60) as f32;
    let square = re * re + im * im;
    if square < LEAST && (re != 0.0 || im != 0.0) {
        return unit(UP * re, UP * im);
    }
    let modulus = sqrtf(square);
    if modulus > 0.0 { (re / modulus, im / modulus) } else { (1.0, 0.0) }
}

/// Square root in single precision; with `std` the compiler can vectorise it.
#[inline(always)]
pub(crate) fn sqrtf(x: f32) -> f32 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrtf(x);
}
