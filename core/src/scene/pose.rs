//! Pose: a rotation and a translation, by which an array is moved.

use crate::linalg::symmetric::eigen;
use crate::prelude::*;
use crate::scene::geometry::{middle, vector};

/// The largest deviation of the rows of a rotation matrix from orthonormal ones.
const ROUNDING: f64 = 1e-6;

/// A rotation R about the origin, then a translation t: x becomes R x + t.
///
/// ```
/// use core::f64::consts::FRAC_PI_2;
/// use midair::{Array, Pose};
///
/// let upright = Pose::new(&[0.0, FRAC_PI_2, 0.0], [-0.1, 0.0, 0.1])?;
/// let board = Array::preset("autd3", [1, 1])?.moved(&upright)?;
/// assert!((board.normals()[0][0] - 1.0).abs() < 1e-15 && (board.positions()[0][0] + 0.1).abs() < 1e-15);
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    rows: [[f64; 3]; 3],
    translation: [f64; 3],
}

impl Pose {
    /// The pose that moves nothing.
    pub const NONE: Self = Self { rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// Returns the pose of a rotation and a translation in m. The rotation has 3 numbers: the axis times the angle in rad; or
    /// 4: a quaternion w, x, y, z of any length; or 9: a matrix, row by row. Without numbers nothing is rotated.
    ///
    /// # Errors
    /// Another number of numbers, one that is not finite, an angle above 2 pi, as one in degrees is, a matrix that is no
    /// rotation, a quaternion of length 0.
    pub fn new(rotation: &[f64], translation: [f64; 3]) -> Result<Self> {
        vector("translation", &translation)?;
        if let Some(x) = rotation.iter().find(|x| !x.is_finite()) {
            return Err(Error::not_finite("rotation", x));
        }
        let rows = match *rotation {
            [] => Self::NONE.rows,
            [x, y, z] => {
                let half = 0.5 * Vec3([x, y, z]).norm();
                if half > PI + ROUNDING {
                    let (degrees, radians) = (2.0 * half, 2.0 * half / 180.0 * PI);
                    let cure = format!("give at most 2 pi rad ({degrees:.1} degrees are {radians:.4} rad)");
                    return Err(Error::out_of_range("rotation", format!("{rotation:?}"), cure));
                }
                let part = if half > 0.0 { 0.5 * math::sin(half) / half } else { 0.0 };
                of_quaternion([math::cos(half), part * x, part * y, part * z])
            }
            [w, x, y, z] => {
                let largest = rotation.iter().fold(0.0_f64, |most, part| most.max(part.abs()));
                if largest == 0.0 {
                    return Err(Error::invalid("rotation", format!("{rotation:?}"), "give a quaternion of length 1"));
                }
                let scaled = [w, x, y, z].map(|part| part / largest);
                let length = math::sqrt(scaled.iter().map(|part| part * part).sum());
                of_quaternion(scaled.map(|part| part / length))
            }
            [a, b, c, d, e, f, g, h, i] => {
                let rows = [[a, b, c], [d, e, f], [g, h, i]];
                let [x, y, z] = rows.map(Vec3);
                let off = [x.dot(y), y.dot(z), z.dot(x), x.norm() - 1.0, y.norm() - 1.0, x.cross(y).dot(z) - 1.0];
                if off.iter().any(|off| off.is_nan() || off.abs() > ROUNDING) {
                    let cure = "give orthonormal rows of determinant 1: a rotation keeps lengths and mirrors nothing";
                    return Err(Error::invalid("rotation", format!("{rows:?}"), cure));
                }
                rows
            }
            _ => {
                let cure = "give 3 of axis times angle in rad, 4 of a quaternion w, x, y, z, or a 3 x 3 matrix";
                return Err(Error::shape("rotation", format!("{} numbers", rotation.len()), cure));
            }
        };
        Ok(Self { rows, translation })
    }

    /// Returns the rows of the rotation's matrix.
    pub fn rows(&self) -> [[f64; 3]; 3] {
        self.rows
    }

    /// Returns the pose that brings places nearest to others in least squares (Horn 1987, "Closed-form solution of absolute
    /// orientation using unit quaternions", J. Opt. Soc. Am. A 4, 629).
    pub(crate) fn between(places: &[[f64; 3]], others: &[[f64; 3]]) -> Self {
        let middles = [middle(places), middle(others)].map(Vec3);
        let mut s = [[0.0; 3]; 3];
        for (&place, &other) in places.iter().zip(others) {
            let [from, to] = [Vec3(place) - middles[0], Vec3(other) - middles[1]];
            for (row, x) in s.iter_mut().zip(*from) {
                row.iter_mut().zip(*to).for_each(|(sum, y)| *sum += x * y);
            }
        }
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = s;
        let (values, vectors) = eigen([
            [xx + yy + zz, yz - zy, zx - xz, xy - yx],
            [yz - zy, xx - yy - zz, xy + yx, zx + xz],
            [zx - xz, xy + yx, yy - xx - zz, yz + zy],
            [xy - yx, zx + xz, yz + zy, zz - xx - yy],
        ]);
        let largest = (1..4).fold(0, |best, k| if values[k] > values[best] { k } else { best });
        let turned = Self { rows: of_quaternion(vectors[largest]), translation: [0.0; 3] };
        Self { translation: *(middles[1] - turned.place(*middles[0])), ..turned }
    }

    /// The place to which a place moves.
    pub(crate) fn place(&self, place: [f64; 3]) -> [f64; 3] {
        *(Vec3(self.direction(place)) + self.translation)
    }

    /// The direction to which a direction turns.
    pub(crate) fn direction(&self, direction: [f64; 3]) -> [f64; 3] {
        self.rows.map(|row| Vec3(row).dot(direction))
    }

    /// The cosine of the angle of the rotation.
    pub(crate) fn cosine(&self) -> f64 {
        0.5 * ((0..3).map(|k| self.rows[k][k]).sum::<f64>() - 1.0)
    }

    /// The places to which places move.
    pub(crate) fn places(&self, places: &[[f64; 3]]) -> Vec<[f64; 3]> {
        places.iter().map(|&place| self.place(place)).collect()
    }
}

/// The rows of the rotation of a unit quaternion w, x, y, z.
fn of_quaternion([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}
