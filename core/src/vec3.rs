//! Vec3: a place or a direction in space, with the usual operations.

use core::ops::{Add, Deref, Div, Mul, Neg, Sub};

use crate::math;

/// The coordinates x, y, z. Sums run from x to z. Public functions take and return `[f64; 3]`; both convert freely.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Vec3(pub(crate) [f64; 3]);

impl Vec3 {
    /// The dot product.
    pub(crate) fn dot(self, other: impl Into<Self>) -> f64 {
        let other = other.into();
        (0..3).map(|axis| self[axis] * other[axis]).sum()
    }

    /// The cross product.
    pub(crate) fn cross(self, other: impl Into<Self>) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.into().0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// The length.
    pub(crate) fn norm(self) -> f64 {
        math::sqrt(self.dot(self))
    }

    /// The direction, of length 1.
    pub(crate) fn unit(self) -> Self {
        self / self.norm()
    }

    /// The distance to another place.
    pub(crate) fn distance(self, other: impl Into<Self>) -> f64 {
        (self - other).norm()
    }
}

impl From<[f64; 3]> for Vec3 {
    fn from(coordinates: [f64; 3]) -> Self {
        Self(coordinates)
    }
}

impl From<Vec3> for [f64; 3] {
    fn from(vector: Vec3) -> Self {
        vector.0
    }
}

impl Deref for Vec3 {
    type Target = [f64; 3];

    fn deref(&self) -> &[f64; 3] {
        &self.0
    }
}

impl<T: Into<Self>> Add<T> for Vec3 {
    type Output = Self;

    fn add(self, other: T) -> Self {
        let other = other.into();
        Self([0, 1, 2].map(|axis| self[axis] + other[axis]))
    }
}

impl<T: Into<Self>> Sub<T> for Vec3 {
    type Output = Self;

    fn sub(self, other: T) -> Self {
        let other = other.into();
        Self([0, 1, 2].map(|axis| self[axis] - other[axis]))
    }
}

impl Neg for Vec3 {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Mul<Vec3> for f64 {
    type Output = Vec3;

    fn mul(self, vector: Vec3) -> Vec3 {
        Vec3(vector.0.map(|x| self * x))
    }
}

impl Div<f64> for Vec3 {
    type Output = Self;

    fn div(self, divisor: f64) -> Self {
        Self(self.0.map(|x| x / divisor))
    }
}
