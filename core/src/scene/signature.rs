//! Signature: factors of modulus 1 for each transducer and point that turn a focus into a trap.

use crate::error::find;
use crate::prelude::*;
use crate::scene::Array;

/// Factors s_ji that turn foci into traps. While a scene is solved, they multiply the responses; the played drive does not
/// contain them. If the drive q makes `sum_i G_ji s_ji q_i` a strong focus at point j, the real field `sum_i G_ji q_i` is a
/// trap there.
///
/// The axis a of the array is the leading eigenvector of the sum of n n^T over its normals n. Seen from a point x, a transducer
/// at x_i is below it if (x - x_i) a > 0, else above it. Sides and azimuths are relative to each point.
///
/// Twin traps and vortices are those of Marzo et al., Nature Communications 6, 8661 (2015).
///
/// ```
/// use midair::{Array, Control, Medium, Problem, Request, Scene, Signature, Workspace, solvers::Uniform};
///
/// let point = [0.0, 0.0, 0.1];
/// let array = Array::grid(16, 16, 10.5e-3)?;
/// let scene = Scene::new(array, Medium::default(), vec![point], Request::default())?;
/// let scene = scene.with_signature(Some(Signature::Twin))?;
/// let problem = Problem::new(&scene)?;
/// let solution = midair::solve(&problem, &Uniform::default(), true, &mut Workspace::new(), &mut Control::none())?;
/// // A loud focus at the point in the solver's model with the factors, silence there in the real field.
/// let model = midair::Model::of(&scene, midair::InstructionSet::best());
/// let field = midair::field(&model, &solution.drive, &[point], &mut Control::none())?;
/// assert!(solution.pressures[0].norm() > 5e3 && field[0].norm() < 1.0);
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Signature {
    /// The strongest known trap for this array at a point. If waves come from above and from below, and the weaker side
    /// gives at least half the pressure of the stronger one, it is a standing wave with a node at the point: phase pi for
    /// the side above. The waves are those of transducers, of their images in walls, and of bodies. Otherwise it is
    /// [`Signature::Vortex`], whose least stiffness is the best of the known ones.
    Trap,
    /// A twin trap: phase pi for the half of the array whose x is below the x of the point (whose y, for an array
    /// along x). The two halves cancel in a plane through the point.
    Twin,
    /// A vortex: the phase of each transducer is its azimuth around the array's axis through the point.
    Vortex,
    /// Factor 1: the point stays a focus, while other points are traps.
    Focus,
    /// Given factors of modulus 1: (N,) for all points, or (M, N), point by point.
    Given(Arc<[Complex64]>),
    /// A named signature for each point (M,).
    Each(Arc<[Signature]>),
}

/// The signatures with a name. The last applies only to single points.
const KNOWN: [(&str, Signature); 4] =
    [("trap", Signature::Trap), ("twin", Signature::Twin), ("vortex", Signature::Vortex), ("focus", Signature::Focus)];

/// A standing wave traps better than a vortex if the weaker side gives at least this part of the stronger side's pressure.
/// Found for two boards of 16 x 16 at 10.5 mm, 236.5 mm apart, and points from the middle to one board.
const FACING: f64 = 0.5;

/// The allowed deviation of a modulus from 1, after rounding to f32.
const ROUNDING: f64 = 1e-6;

impl Signature {
    /// Returns the signature of this name.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self> {
        find("signature", name, &KNOWN[..3], |known| known.0).map(|known| known.1.clone())
    }

    /// Returns the signature of this name for one point of several; "focus" is allowed here.
    ///
    /// # Errors
    /// An unknown name.
    pub fn of_point(name: &str) -> Result<Self> {
        find("signature", name, &KNOWN, |known| known.0).map(|known| known.1.clone())
    }

    /// The name; `None` for given factors and for a list.
    pub fn name(&self) -> Option<&'static str> {
        KNOWN.iter().find(|(_, known)| known == self).map(|known| known.0)
    }

    /// The signature of point `j`.
    pub(crate) fn of(&self, j: usize) -> &Self {
        match self {
            Self::Each(each) => &each[j],
            one => one,
        }
    }

    /// Whether there are traps, and all other points are foci.
    pub(crate) fn traps(&self) -> bool {
        match self {
            Self::Each(each) => {
                each.contains(&Self::Trap) && each.iter().all(|one| matches!(one, Self::Trap | Self::Focus))
            }
            one => *one == Self::Trap,
        }
    }

    /// The signature for the points with these indices.
    pub(crate) fn select(&self, chosen: &[usize]) -> Self {
        match self {
            Self::Each(each) => Self::Each(chosen.iter().map(|&j| each[j].clone()).collect()),
            one => one.clone(),
        }
    }

    /// Returns the signature of the points of `times` scenes in a row, for arrays of `transducers`.
    pub(crate) fn repeated(&self, transducers: usize, times: usize) -> Self {
        match self {
            Self::Each(each) => Self::Each(each.iter().cycle().take(times * each.len()).cloned().collect()),
            Self::Given(factors) if factors.len() > transducers => Self::Given(factors.repeat(times).into()),
            one => one.clone(),
        }
    }

    /// Checks that given factors have modulus 1 and the right number, and that a list names one signature for each point.
    pub(crate) fn check(&self, transducers: usize, points: usize) -> Result<()> {
        if let Self::Each(each) = self {
            one_each("signature", each.len(), "names", points, "points")?;
            let nested = |one: &Self| matches!(one, Self::Each(_) | Self::Given(_));
            return match each.iter().position(nested) {
                None => Ok(()),
                Some(j) => Err(Error::invalid(format!("signature[{j}]"), "a list", "give a name for each point")),
            };
        }
        let Self::Given(factors) = self else { return Ok(()) };
        if factors.len() != transducers && factors.len() != transducers * points {
            let cure =
                format!("give one for each of the {transducers} transducers, or as many for each of {points} points");
            return Err(Error::invalid("signature", format!("{} factors", factors.len()), cure));
        }
        let refused = |s: &Complex64| !(1.0 - ROUNDING..=1.0 + ROUNDING).contains(&math::hypot(s.re, s.im));
        match factors.iter().position(refused) {
            None => Ok(()),
            Some(at) => {
                let item = format!("signature[{}, {}]", at / transducers, at % transducers);
                Err(Error::invalid(item, factors[at], "give factors of modulus 1, e^{j phase}"))
            }
        }
    }

    /// The factors (N,) of point `j` at `point`. `waves` (N,) are the columns of G there, `above` (N,) the parts of them that
    /// come from above the point, along the axis of `frame`.
    pub(crate) fn factors(
        &self,
        (array, frame): (&Array, &[Vec3; 3]),
        (j, point): (usize, [f64; 3]),
        [waves, above]: [&[Complex64]; 2],
    ) -> Vec<Complex64> {
        let (n, one) = (array.len(), self.of(j));
        if *one == Self::Focus {
            return vec![Complex64::ONE; n];
        }
        if let Self::Given(factors) = one {
            let of_point = if factors.len() == n { 0..n } else { j * n..(j + 1) * n };
            return factors[of_point].to_vec();
        }
        let unit = |z: Complex64| if z == Complex64::ZERO { Complex64::ONE } else { z / math::hypot(z.re, z.im) };
        let from = array.positions().iter().map(|&from| Vec3(from) - point);
        let [across, third, _] = *frame;
        if *one == Self::Twin {
            return from.map(|from| Complex64::from(if from.dot(across) < 0.0 { -1.0 } else { 1.0 })).collect();
        }
        if *one == Self::Trap {
            let pairs = waves.iter().zip(above);
            let [below, upper] =
                [pairs.clone().map(|(g, a)| (g - a).norm()).sum::<f64>(), above.iter().map(|a| a.norm()).sum()];
            if below.min(upper) >= FACING * below.max(upper) {
                return pairs.map(|(g, a)| unit((g - 2.0 * a) * g.conj())).collect();
            }
        }
        from.map(|from| unit(Complex64::new(from.dot(across), from.dot(third)))).collect()
    }
}

/// Returns three unit vectors: across the array (as near to x as possible, or to y for an array along x), the third axis of the
/// right-handed frame, and the array's axis. The largest component of the axis is above 0.
pub(crate) fn frame(normals: &[[f64; 3]]) -> [Vec3; 3] {
    let mut scatter = [[0.0; 3]; 3];
    for n in normals {
        for (row, x) in scatter.iter_mut().zip(n) {
            row.iter_mut().zip(n).for_each(|(entry, y)| *entry += x * y);
        }
    }
    // Repeated squaring: the matrix tends to the projection on its leading eigenvector.
    for _ in 0..40 {
        let trace = scatter[0][0] + scatter[1][1] + scatter[2][2];
        let old = scatter.map(|row| row.map(|entry| entry / trace));
        scatter = [0, 1, 2].map(|x| [0, 1, 2].map(|y| (0..3).map(|k| old[x][k] * old[k][y]).sum()));
    }
    let largest = (0..3).fold(0, |best, x| if scatter[x][x] > scatter[best][best] { x } else { best });
    let axis = Vec3(scatter[largest]).unit();
    let near = Vec3(if axis[0].abs() > 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] });
    let across = (near - near.dot(axis) * axis).unit();
    [across, axis.cross(across), axis]
}
