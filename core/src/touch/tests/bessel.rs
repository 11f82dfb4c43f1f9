use num_complex::Complex64;

use super::modified_bessel;
use crate::math::phasor;

/// Order, |z|, angle of z in rad, and the real and imaginary part of K, computed by SciPy's `kv`.
#[allow(clippy::unreadable_literal, reason = "as SciPy prints them")]
const EXACT: [(u32, f64, f64, f64, f64); 14] = [
    (0, 1e-05, 1.37, 11.628856980351426, -1.3699999998450643),
    (0, 0.3, 0.0, 1.3724600605442976, 0.0),
    (0, 2.0, 0.8, -0.04817064269700504, -0.20549537001259194),
    (0, 7.0, 1.37, 0.0374379071750703, -0.11055992288755709),
    (0, 11.9, 1.37, 0.03286906261329349, 0.007715401955869942),
    (0, 12.1, 1.37, 0.03215539061471298, 0.0011069886476919883),
    (0, 40.0, 1.37, -3.88137641784112e-05, -5.5727457737317536e-05),
    (1, 1e-05, 1.37, 19944.972080949432, -97990.80619792103),
    (1, 0.3, 0.0, 3.0559920334573247, 0.0),
    (1, 2.0, 0.8, -0.0885497819915331, -0.2328972161015125),
    (1, 7.0, 1.37, 0.030447995419591617, -0.11494202139327511),
    (1, 11.9, 1.37, 0.033484251667229493, 0.006445758081045983),
    (1, 12.1, 1.37, 0.032488628663336724, -0.00017273350017401158),
    (1, 40.0, 1.37, -3.959408679920196e-05, -5.539615749770194e-05),
];

#[test]
fn bessel_functions_agree_with_scipy() {
    for (order, size, angle, re, im) in EXACT {
        let (value, exact) = (modified_bessel(order, size * phasor(angle)), Complex64::new(re, im));
        assert!((value - exact).norm() < 1e-9 * exact.norm(), "K_{order} at {size} e^{angle}j: {value}");
    }
}
