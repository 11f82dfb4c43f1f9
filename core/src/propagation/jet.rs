//! Jet: a function of position as its Taylor polynomial of degree 4 around a point, for exact derivatives.

pub(crate) use crate::kernels::derivatives::MORE_TERMS as TERMS;

/// The exponents (x, y, z) of the monomials up to degree 4, sorted by degree.
pub(crate) const EXPONENTS: [[u8; 3]; TERMS] = {
    let mut exponents = [[0; 3]; TERMS];
    let (mut next, mut degree) = (0, 0);
    while degree <= 4 {
        let mut a = degree + 1;
        while a > 0 {
            a -= 1;
            let mut b = degree - a + 1;
            while b > 0 {
                b -= 1;
                exponents[next] = [a, b, degree - a - b];
                next += 1;
            }
        }
        degree += 1;
    }
    exponents
};

/// The degree of a monomial.
pub(crate) fn degree(term: usize) -> i32 {
    EXPONENTS[term].iter().map(|&exponent| i32::from(exponent)).sum()
}

/// The index of a monomial in [`EXPONENTS`].
pub(crate) const fn place(of: [u8; 3]) -> usize {
    let mut at = 0;
    while EXPONENTS[at][0] != of[0] || EXPONENTS[at][1] != of[1] || EXPONENTS[at][2] != of[2] {
        at += 1;
    }
    at
}

/// The number of pairs of monomials whose product has degree 4 or less.
const PAIRS: usize = 210;

/// The pairs of monomials whose product has degree 4 or less: the index of each factor and of the product.
const PRODUCTS: [[usize; 3]; PAIRS] = {
    let mut products = [[0; 3]; PAIRS];
    let (mut next, mut i) = (0, 0);
    while i < TERMS {
        let mut j = 0;
        while j < TERMS {
            let (a, b) = (EXPONENTS[i], EXPONENTS[j]);
            let sum = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
            if sum[0] + sum[1] + sum[2] <= 4 {
                products[next] = [i, j, place(sum)];
                next += 1;
            }
            j += 1;
        }
        i += 1;
    }
    products
};

/// The factorial of each exponent of a monomial, multiplied: a derivative is this number times its Taylor coefficient.
pub(crate) fn factorial(term: usize) -> f64 {
    EXPONENTS[term].iter().map(|&exponent| f64::from((1..=u32::from(exponent)).product::<u32>())).product()
}

/// The coefficients of the monomials in the displacement from the point, the constant first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet([f64; TERMS]);

impl Jet {
    pub(crate) const ZERO: Self = Self([0.0; TERMS]);

    /// Returns the jet with these coefficients.
    pub(crate) fn of(coefficients: &[f64; TERMS]) -> Self {
        Self(*coefficients)
    }

    /// The linear function `slope` . x.
    pub(crate) fn linear(slope: [f64; 3]) -> Self {
        let mut jet = Self::ZERO;
        jet.0[1..4].copy_from_slice(&slope);
        jet
    }

    /// The quadratic function |x|^2.
    pub(crate) fn square() -> Self {
        let mut jet = Self::ZERO;
        for exponents in [[2, 0, 0], [0, 2, 0], [0, 0, 2]] {
            jet.0[place(exponents)] = 1.0;
        }
        jet
    }

    /// The monomial with this index.
    pub(crate) fn monomial(term: usize) -> Self {
        let mut jet = Self::ZERO;
        jet.0[term] = 1.0;
        jet
    }

    /// The coefficients of the monomials.
    pub(crate) fn coefficients(&self) -> &[f64; TERMS] {
        &self.0
    }

    /// Adds `factor` times another jet.
    pub(crate) fn add(&mut self, other: &Self, factor: f64) {
        self.0.iter_mut().zip(&other.0).for_each(|(sum, other)| *sum += factor * other);
    }

    /// The product of two jets, up to degree 4.
    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut product = Self::ZERO;
        for [i, j, at] in PRODUCTS {
            product.0[at] += self.0[i] * other.0[j];
        }
        product
    }

    /// The value at the point.
    pub(crate) fn value(&self) -> f64 {
        self.0[0]
    }

    /// The gradient at the point.
    pub(crate) fn gradient(&self) -> [f64; 3] {
        [self.0[1], self.0[2], self.0[3]]
    }
}
