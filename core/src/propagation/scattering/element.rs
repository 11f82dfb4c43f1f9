//! Element: a flat triangle of a surface, on which the sound is constant, and the wave that it sends.

use crate::kernels::panels::{NODES, Panels};
use crate::kernels::phasor::TAYLOR;
use crate::kernels::simd::doubles::EIGHT;
use crate::prelude::*;
use crate::scene::mesh::{Triangle, area_vector, halved};
use crate::scene::{Mesh, Surface};

/// Nodes and weights of a six-point rule on a triangle, exact for polynomials of degree 4 (D. A. Dunavant, Int. J. Numer. Meth.
/// Eng. 21, 1129, 1985). Each row stands for three nodes: the barycentric coordinate of two corners, that of the third corner,
/// and the weight.
const RULE: [[f64; 3]; 2] = [
    [0.445_948_490_915_965, 0.108_103_018_168_070, 0.223_381_589_678_011],
    [0.091_576_213_509_771, 0.816_847_572_980_459, 0.109_951_743_655_322],
];

/// An element is near a place if their distance is below this many times the element's reach, the distance from its
/// middle to its farthest corner. A near element is cut into quarters.
const NEAR: f64 = 3.5;

/// How often a near element is cut into quarters, at most. At distances below an eighth of the edge, the rule is inaccurate.
const MOST_CUTS: u32 = 3;

/// Nodes and weights of the Gauss rule with 8 nodes on [-1, 1]; each row stands for the nodes x and -x.
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

/// A flat triangle and the nodes of its integrals.
#[derive(Clone, Copy, Debug)]
struct Patch {
    corners: Triangle,
    center: Vec3,
    /// The distance of the farthest corner from the middle.
    reach: f64,
    /// The nodes of [`RULE`], each with its weight in m^2 over 4 pi.
    nodes: [(Vec3, f64); NODES],
}

impl Patch {
    fn new(corners: Triangle) -> Self {
        let [a, b, c] = corners;
        let center = (a + b + c) / 3.0;
        let scale = 0.5 * area_vector(corners).norm() / (4.0 * PI);
        let nodes = [0, 1, 2, 3, 4, 5].map(|k| {
            let ([share, rest, weight], corner) = (RULE[k / 3], k % 3);
            let [x, y, z] = [0, 1, 2].map(|other| if other == corner { rest } else { share });
            (x * a + y * b + z * c, weight * scale)
        });
        let reach = corners.map(|corner| corner.distance(center)).into_iter().fold(0.0, f64::max);
        Self { corners, center, reach, nodes }
    }

    fn quarters(&self) -> [Self; 4] {
        let [a, b, c] = self.corners;
        let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(Self::new)
    }
}

/// A boundary element: a flat triangle with constant sound on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Element {
    patch: Patch,
    /// The unit normal, which points into the air.
    pub(crate) normal: Vec3,
    pub(crate) kind: Surface,
}

/// A place; and, if it is the middle of an element, the normal there and the factor of the derivative along this normal.
pub(crate) type Place = (Vec3, Option<(Vec3, Complex64)>);

impl Element {
    /// Splits the faces of a mesh into elements of at most this area in m^2, with edges of at most this length in m.
    pub(crate) fn all(mesh: &Mesh, [area, edge]: [f64; 2]) -> Vec<Self> {
        let mut all = Vec::new();
        for triangle in mesh.triangles() {
            halved(triangle, area, edge, &mut |part| all.push(Self::new(part, mesh.kind())));
        }
        all
    }

    fn new(corners: Triangle, kind: Surface) -> Self {
        Self { patch: Patch::new(corners), normal: area_vector(corners).unit(), kind }
    }

    /// The element with its corners and its normal mapped, as in a mirror.
    pub(crate) fn moved(&self, place: impl Fn(Vec3) -> Vec3, direction: impl Fn(Vec3) -> Vec3) -> Self {
        Self { patch: Patch::new(self.patch.corners.map(place)), normal: direction(self.normal), kind: self.kind }
    }

    /// The middle of the element.
    pub(crate) fn center(&self) -> Vec3 {
        self.patch.center
    }

    /// The distance of the farthest corner from the middle.
    pub(crate) fn reach(&self) -> f64 {
        self.patch.reach
    }

    /// Whether a place is so near that the integral over the element is cut into quarters.
    pub(crate) fn is_near(&self, place: Vec3) -> bool {
        place.distance(self.patch.center) < NEAR * self.patch.reach
    }

    /// Packs elements for [`crate::kernels::panels::each`], with the wavenumber in rad/m.
    pub(crate) fn panels(elements: &[Self], wavenumber: f64) -> Vec<Panels> {
        elements.chunks(EIGHT).map(|chunk| Self::panel(chunk, wavenumber)).collect()
    }

    fn panel(chunk: &[Self], wavenumber: f64) -> Panels {
        let mut panels = Panels::NONE;
        for lane in 0..EIGHT {
            // Unused lanes of the last panel repeat the last element.
            let element = &chunk[lane.min(chunk.len() - 1)];
            for axis in 0..3 {
                panels.center[axis][lane] = element.patch.center[axis];
                panels.normal[axis][lane] = element.normal[axis];
            }
            for (k, (node, weight)) in element.patch.nodes.iter().enumerate() {
                node.iter().zip(&mut panels.nodes[k]).for_each(|(x, lanes)| lanes[lane] = *x);
                panels.weights[k][lane] = *weight;
            }
            [panels.beside[lane], panels.along[lane]] = match element.kind {
                Surface::Rigid => [0.0, 1.0],
                Surface::Soft => [-wavenumber, 0.0],
            };
        }
        panels
    }

    /// The term that the equation at the element's middle has besides integrals: half of p, or half of j/k dp/dn.
    pub(crate) fn jump(&self) -> Complex64 {
        match self.kind {
            Surface::Rigid => Complex64::new(0.5, 0.0),
            Surface::Soft => Complex64::new(0.0, 0.5),
        }
    }

    /// Returns [`influence`] at the element's own middle. The integral over the distance is in closed form. Over a flat element
    ///
    /// ```text
    /// int g dS = 1/(4 pi jk) int (e^{jkR} - 1) dtheta,   int d2g/dn2 dS = jk/2 - 1/(4 pi) int e^{jkR}/R dtheta
    /// ```
    ///
    /// where R(theta) is the distance from the middle to the edge. The second integral is the finite part of a divergent one.
    /// The integrals of dg/dn are 0.
    pub(crate) fn own_influence(&self, wave: Complex64, eta: Complex64) -> Complex64 {
        let turned = Complex64::I * wave;
        let mut sum = Complex64::ZERO;
        for k in 0..3 {
            let [a, b] = [k, (k + 1) % 3].map(|corner| self.patch.corners[corner] - self.patch.center);
            let side = b - a;
            let length = side.norm();
            // The length of the perpendicular from the middle to this side, and the angles from it to the corners.
            let height = a.cross(b).norm() / length;
            let [first, last] = [a, b].map(|corner| math::atan2(corner.dot(side) / length, height));
            for [node, weight] in GAUSS.into_iter().flat_map(|[node, weight]| [[-node, weight], [node, weight]]) {
                let angle = 0.5 * (first + last) + 0.5 * (last - first) * node;
                let reach = height / math::cos(angle);
                let grown = phasor(turned * reach);
                let value = match self.kind {
                    Surface::Rigid => grown / reach,
                    Surface::Soft => (grown - 1.0) / turned,
                };
                sum += value * (0.5 * (last - first) * weight / (4.0 * PI));
            }
        }
        match self.kind {
            Surface::Rigid => eta * (turned * 0.5 - sum),
            Surface::Soft => -wave.re * sum,
        }
    }
}

/// Returns the wave of an element with u = 1 at another place: int dg/dn_y dS for a rigid element, -k int g dS for a soft one.
/// If the place has a normal, the wave's derivative along it is added, times the factor.
pub(crate) fn influence(wave: Complex64, place: Place, element: &Element) -> Complex64 {
    let sum = integral(wave, place, element, &element.patch, MOST_CUTS);
    match element.kind {
        Surface::Rigid => sum,
        Surface::Soft => -wave.re * sum,
    }
}

fn integral(wave: Complex64, place: Place, element: &Element, patch: &Patch, cuts: u32) -> Complex64 {
    let away = place.0.distance(patch.center);
    if cuts > 0 && away < NEAR * patch.reach {
        return patch.quarters().iter().map(|part| integral(wave, place, element, part, cuts - 1)).sum();
    }
    let turned = Complex64::I * wave;
    let at_center = phasor(turned * away);
    // The six nodes go through each step together, so that the CPU can overlap their computations.
    let rays = patch.nodes.map(|(node, _)| place.0 - node);
    let distances = rays.map(|ray| ray.norm().max(1e-3 * patch.reach));
    let phasors = near_phasors(turned, distances.map(|r| r - away));
    let mut sum = Complex64::ZERO;
    for k in 0..6 {
        let near = 1.0 / distances[k];
        let g = phasors[k] * (patch.nodes[k].1 * near);
        sum += kernel(turned, rays[k], near, g, place.1, element);
    }
    sum * at_center
}

/// Returns g (soft) or dg/dn_y (rigid) at a node. `ray` is the vector from the node to the place, 1/`near` its length. With a
/// `derivative`, adds the factor times the derivative along the normal n_x.
fn kernel(
    turned: Complex64,
    ray: Vec3,
    near: f64,
    g: Complex64,
    derivative: Option<(Vec3, Complex64)>,
    element: &Element,
) -> Complex64 {
    let slope = g * (turned - near);
    let from = -ray.dot(element.normal) * near;
    let Some((normal, factor)) = derivative else {
        return match element.kind {
            Surface::Rigid => slope * from,
            Surface::Soft => g,
        };
    };
    let to = ray.dot(normal) * near;
    match element.kind {
        Surface::Soft => g + factor * slope * to,
        Surface::Rigid => {
            let curve = slope * (turned - near) + g * (near * near);
            let mixed = -(normal.dot(element.normal) + to * from) * near;
            slope * from + factor * (curve * (to * from) + slope * mixed)
        }
    }
}

/// The exponential e^z of a complex number.
fn phasor(z: Complex64) -> Complex64 {
    math::phasor(z.im) * math::exp(z.re)
}

/// Returns e^{turned d} for distances d within an element, by Taylor polynomials: all six cost about as much as one call of the
/// library.
fn near_phasors(turned: Complex64, distances: [f64; 6]) -> [Complex64; 6] {
    // The error of cosine and sine is 1e-7 at an angle of 2.5 rad, a distance of 0.4 wavelengths, and falls towards 0.
    const TERMS: usize = 8;
    let angles = distances.map(|d| turned.im * d);
    let squares = angles.map(|angle| angle * angle);
    let [mut cos, mut sin] = [[0.0; 6]; 2];
    for term in (0..TERMS).rev() {
        let [even, odd] = [TAYLOR[2 * term], TAYLOR[2 * term + 1]];
        for k in 0..6 {
            cos[k] = cos[k] * squares[k] + even;
            sin[k] = sin[k] * squares[k] + odd;
        }
    }
    core::array::from_fn(|k| {
        let x = turned.re * distances[k];
        let grown = 1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x / 24.0)));
        Complex64::new(cos[k] * grown, angles[k] * sin[k] * grown)
    })
}
