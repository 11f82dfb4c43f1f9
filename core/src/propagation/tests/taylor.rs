//! Tests of `taylor`: compares the kernel with Taylor polynomials that are multiplied for one transducer at a time.

use super::*;
use crate::math;
use crate::rng::Rng;
use crate::scene::{Array, Directivity, Medium, Transducer, distance};

/// The polynomial `value` + `slope` . x + `curvature` |x|^2.
fn quadratic(value: f64, slope: [f64; 3], curvature: f64) -> Jet {
    let mut sum = Jet::linear(slope);
    sum.add(&Jet::monomial(0), value);
    sum.add(&Jet::square(), curvature);
    sum
}

/// The first to fourth power of (polynomial - its value at the point).
fn powers(of: &Jet) -> [Jet; 4] {
    let mut first = *of;
    first.add(&quadratic(of.value(), [0.0; 3], 0.0), -1.0);
    let second = first.times(&first);
    [first, second, second.times(&first), second.times(&second)]
}

/// The composition of a function with a polynomial. `coefficients` are the function's Taylor coefficients at the polynomial's
/// value, `powers` those of [`powers`].
fn series(coefficients: [f64; 5], powers: &[Jet; 4]) -> Jet {
    let mut sum = quadratic(coefficients[0], [0.0; 3], 0.0);
    powers.iter().zip(&coefficients[1..]).for_each(|(power, coefficient)| sum.add(power, *coefficient));
    sum
}

/// The wave of transducer i around a point in Pa, without its response: real and imaginary part.
fn jet(sources: &Sources, i: usize, point: [f64; 3]) -> [Jet; 2] {
    let transducer = sources.array.transducer();
    let (from, normal) = (sources.array.positions()[i], sources.array.normals()[i]);
    let ray = [0, 1, 2].map(|axis| point[axis] - from[axis]);
    let r = distance(from, point);
    // r as the square root of the polynomial r^2.
    let square = powers(&quadratic(r * r, ray.map(|x| 2.0 * x), 1.0));
    let root = [1.0, 0.5, -0.125, 0.0625, -5.0 / 128.0];
    let root: [f64; 5] = core::array::from_fn(|n| root[n] * r.powi(1 - 2 * n as i32));
    let root = powers(&series(root, &square));
    // The wave e^{ur}/r with u = jk - alpha, for r + h: the coefficients of e^{u (r + h)} are e^{ur} u^n/n!, those of 1/(r + h)
    // are (-1/r)^n/r.
    let u = Complex64::new(-sources.medium.absorption, sources.medium.wavenumber());
    let wave = math::exp(u.re * r) * transducer.source_pressure / r;
    let wave = Complex64::new(wave * math::cos(u.im * r), wave * math::sin(u.im * r));
    let [a, b] = [u, Complex64::new(-1.0 / r, 0.0)];
    let second = a * a / 2.0 + a * b + b * b;
    let third = a * a * a / 6.0 + a * a * b / 2.0 + a * b * b + b * b * b;
    let fourth = a * a * a * a / 24.0 + b * third;
    let terms = [wave, wave * (a + b), wave * second, wave * third, wave * fourth];
    let parts = [terms.map(|c| c.re), terms.map(|c| c.im)].map(|part| series(part, &root));
    // The cosine of the angle, cos(theta) = ray . normal/r.
    let inverse = series([0, 1, 2, 3, 4].map(|n| (-1.0 / r).powi(n) / r), &root);
    let height = (0..3).map(|axis| ray[axis] * normal[axis]).sum::<f64>();
    let cosine = quadratic(height, normal, 0.0).times(&inverse);
    let slopes = transducer.directivity.taylor(cosine.value(), sources.medium.wavenumber());
    if slopes == [1.0, 0.0, 0.0, 0.0, 0.0] {
        return parts;
    }
    let directivity = series(slopes, &powers(&cosine));
    parts.map(|part| part.times(&directivity))
}

/// Returns 13 transducers with random positions and normals, and a random factor for each; one factor is 0.
fn sources(directivity: Directivity, absorption: f64) -> (Sources, Vec<Complex64>) {
    let mut rng = Rng::new(11);
    let mut vector = |size: f64| [(); 3].map(|()| size * (2.0 * rng.uniform() - 1.0));
    let positions = (0..13).map(|_| vector(0.1)).collect();
    let normals = (0..13).map(|_| vector(1.0)).collect();
    let array = Array::new(positions, Some(normals)).expect("an array");
    let array = array.with_transducer(Transducer { directivity, ..Transducer::default() }).expect("a directivity");
    let factors = (0..13).map(|_| Complex64::from_polar(rng.uniform(), 6.3 * rng.uniform()));
    let mut factors: Vec<_> = factors.collect();
    factors[4] = Complex64::ZERO;
    (Sources::new(&array, Medium { absorption, ..Medium::default() }), factors)
}

#[test]
fn each_wave_and_their_sum_are_those_of_multiplied_polynomials() {
    let laws = Directivity::all().chain([Directivity::piston(11e-3), Directivity::cos(0.5), Directivity::sinc(2e-3)]);
    for (law, absorption) in laws.flat_map(|law| [(law, 0.0), (law, 0.15)]) {
        let (sources, factors) = sources(law, absorption);
        let point = [0.013, -0.02, 0.17];
        let mut total = [Jet::ZERO; 2];
        let mut all = vec![];
        for (i, q) in factors.iter().enumerate() {
            let [re, im] = jet(&sources, i, point);
            let mut wave = [Jet::ZERO; 2];
            for (part, [to_re, to_im]) in wave.iter_mut().zip([[q.re, -q.im], [q.im, q.re]]) {
                part.add(&re, to_re);
                part.add(&im, to_im);
            }
            total.iter_mut().zip(&wave).for_each(|(sum, wave)| sum.add(wave, 1.0));
            all.push(wave);
        }
        let near = |value: &[f64], exact: &Jet| {
            for (term, (value, exact)) in value.iter().zip(exact.coefficients()).enumerate() {
                let unit = 300.0 * f64::powi(740.0, crate::propagation::jet::degree(term));
                assert!((value - exact).abs() < 1e-12 * unit, "{law:?}, term {term}: {value} {exact}");
            }
        };
        let mut bits = None;
        for set in InstructionSet::all() {
            let taylor = Taylor::new(set, &sources, |i| factors[i]);
            let mut value = [Jet::ZERO; 2];
            taylor.add(point, &mut value, &mut Control::none()).expect("it is not stopped");
            value.iter().zip(&total).for_each(|(value, exact)| near(value.coefficients(), exact));
            let pattern = value.each_ref().map(|part| part.coefficients().map(f64::to_bits));
            assert_eq!(*bits.get_or_insert(pattern), pattern, "every set has the same bits");
            let mut count = 0;
            let take = |i: usize, wave: [[f64; TERMS]; 2]| {
                count += 1;
                wave.iter().zip(&all[i]).for_each(|(value, exact)| near(value, exact));
            };
            taylor.each(point, &mut Control::none(), take).expect("it is not stopped");
            assert_eq!(count, 12);
        }
    }
}

#[test]
fn values_are_those_of_eq_5() {
    for (law, absorption) in Directivity::all().flat_map(|law| [(law, 0.0), (law, 0.15)]) {
        let (sources, _) = sources(law, absorption);
        let [x, y, z] = sources.array.positions()[3];
        // Points in front of the array, behind it, and within a hundredth of a wavelength of a transducer.
        let points = [[0.013, -0.02, 0.17], [0.3, 0.1, -0.2], [x, y + 2e-5, z]];
        let mut rows = vec![vec![Complex64::ONE; sources.array.len()]; points.len()];
        add_exact(&sources, &points, &mut rows);
        for (point, row) in points.into_iter().zip(&rows) {
            for (i, value) in row.iter().enumerate() {
                let exact = Complex64::ONE + sources.exact(i, point);
                assert!((value - exact).norm() < 1e-12 * exact.norm().max(1.0), "{law:?} {i}: {value} {exact}");
            }
        }
    }
}
