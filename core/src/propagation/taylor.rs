//! Taylor: eq. (5) of a transducer as a polynomial around a point, exact up to degree 3.

use num_complex::Complex64;

use crate::math;
use crate::propagation::jet::Jet;
use crate::propagation::sources::Sources;
use crate::scene::distance;

/// Adds `q` times eq. (5) of transducer i around a point, its response left out, to a pressure.
pub(crate) fn add_wave(sources: &Sources, (i, point): (usize, [f64; 3]), q: Complex64, [re, im]: &mut [Jet; 2]) {
    if q != Complex64::ZERO {
        let [own_re, own_im] = jet(sources, i, point);
        re.add(&own_re, q.re);
        re.add(&own_im, -q.im);
        im.add(&own_im, q.re);
        im.add(&own_re, q.im);
    }
}

/// Eq. (5) of transducer i around a point, its response left out, in Pa: real and imaginary part.
fn jet(sources: &Sources, i: usize, point: [f64; 3]) -> [Jet; 2] {
    let transducer = sources.array.transducer();
    let (from, normal) = (sources.array.positions()[i], sources.array.normals()[i]);
    let ray = [0, 1, 2].map(|axis| point[axis] - from[axis]);
    let r = distance(from, point);
    // r = sqrt(r^2), r^2 a polynomial.
    let square = Jet::quadratic(r * r, ray.map(|x| 2.0 * x), 1.0).powers();
    let root = Jet::series([r, 0.5 / r, -0.125 / (r * r * r), 0.0625 / (r * r * r * r * r)], &square).powers();
    // e^{(jk - alpha) r}/r: the coefficients of e^{u (r + h)} are those of e^{u r} times u^n/n!, those of 1/(r + h) are
    // (-1/r)^n/r.
    let u = Complex64::new(-sources.medium.absorption, sources.medium.wavenumber());
    let wave = math::exp(u.re * r) * transducer.source_pressure / r;
    let wave = Complex64::new(wave * math::cos(u.im * r), wave * math::sin(u.im * r));
    let [a, b] = [u, Complex64::new(-1.0 / r, 0.0)];
    let second = a * a / 2.0 + a * b + b * b;
    let third = a * a * a / 6.0 + a * a * b / 2.0 + a * b * b + b * b * b;
    let series = [wave, wave * (a + b), wave * second, wave * third];
    let parts = [series.map(|c| c.re), series.map(|c| c.im)].map(|part| Jet::series(part, &root));
    // cos(theta) = ray . normal/r.
    let inverse = Jet::series([1.0 / r, -1.0 / (r * r), 1.0 / (r * r * r), -1.0 / (r * r * r * r)], &root);
    let height = (0..3).map(|axis| ray[axis] * normal[axis]).sum::<f64>();
    let cosine = Jet::quadratic(height, normal, 0.0).times(&inverse);
    let slopes = transducer.directivity.taylor(cosine.value(), sources.medium.wavenumber());
    if slopes == [1.0, 0.0, 0.0, 0.0] {
        return parts;
    }
    let directivity = Jet::series(slopes, &cosine.powers());
    parts.map(|part| part.times(&directivity))
}
