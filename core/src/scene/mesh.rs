//! Mesh: the closed surface of a body as triangles, checked once.

use alloc::collections::BTreeMap;

use crate::prelude::*;
use crate::scene::geometry::{bounds, vector};
use crate::scene::surface::Surface;

/// The cure in the error for a face whose corners lie on one line.
const FLAT: &str = "it has no area: leave it out";

/// The three corners of a triangle, counterclockwise as seen from the air.
pub(crate) type Triangle = [Vec3; 3];

/// A body that waves cannot enter, given by a closed surface of triangles: a hand, a cup, or another shape from a 3D modeller.
///
/// ```
/// use midair::{Mesh, Surface};
///
/// // A tetrahedron of 20 mm; each face is counterclockwise as seen from outside.
/// let corners = vec![[0.0, 0.0, 0.1], [0.02, 0.0, 0.1], [0.0, 0.02, 0.1], [0.0, 0.0, 0.12]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let mesh = Mesh::new(corners.clone(), faces.clone(), Surface::Rigid)?;
/// assert!((mesh.volume() - 0.02_f64.powi(3) / 6.0).abs() < 1e-18);
/// assert!(Mesh::new(corners, faces[1..].to_vec(), Surface::Rigid).is_err());
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    kind: Surface,
    bounds: [[f64; 2]; 3],
    volume: f64,
}

impl Mesh {
    /// Returns the surface of `vertices` (V, 3) in m and `faces` (F, 3). A face lists the indices of three vertices,
    /// counterclockwise as seen from outside.
    ///
    /// # Errors
    /// No face, an index beyond the vertices, numbers that are not finite, a face of no area; a hole, an edge of more than two
    /// faces, neighbouring faces with opposite orders of their corners, or all faces clockwise as seen from outside.
    pub fn new(vertices: Vec<[f64; 3]>, faces: Vec<[u32; 3]>, kind: Surface) -> Result<Self> {
        for (v, vertex) in vertices.iter().enumerate() {
            vector(&format!("mesh.vertices[{v}]"), vertex)?;
        }
        if faces.is_empty() {
            return Err(Error::missing("mesh.faces", "empty", "give triangles, three indices of vertices each"));
        }
        let name = |f: usize| format!("mesh.faces[{f}]");
        for (f, face) in faces.iter().enumerate() {
            if face.iter().any(|&v| v as usize >= vertices.len()) {
                let cure = format!("give indices below the {} vertices", vertices.len());
                return Err(Error::invalid(name(f), format!("{face:?}"), cure));
            }
            if face[0] == face[1] || face[1] == face[2] || face[2] == face[0] {
                return Err(Error::invalid(name(f), format!("{face:?}"), FLAT));
            }
        }
        closed(&faces, name)?;
        let bounds = bounds(&vertices);
        let mut mesh = Self { vertices, faces, kind, bounds, volume: 0.0 };
        for (f, triangle) in mesh.triangles().enumerate() {
            let twice = area_vector(triangle);
            refuse_if!(twice.dot(twice) == 0.0, Error::invalid(name(f), format!("{:?}", mesh.faces[f]), FLAT));
        }
        // Computes the volume by the divergence theorem. Coordinates are relative to a vertex, so that rounding errors
        // stay small.
        let origin = mesh.vertices[0];
        let volume = |[a, b, c]: Triangle| (a - origin).dot((b - origin).cross(c - origin)) / 6.0;
        mesh.volume = mesh.triangles().map(volume).sum();
        if mesh.volume <= 0.0 {
            let value = format!("inside out (volume {:.3e} m^3)", mesh.volume);
            return Err(Error::invalid("mesh", value, "swap two corners of every face: faces[:, ::-1]"));
        }
        Ok(mesh)
    }

    /// The distance in m from a place to the surface.
    pub(crate) fn distance(&self, place: [f64; 3]) -> f64 {
        self.triangles().map(|triangle| away(triangle, Vec3(place))).fold(f64::INFINITY, f64::min)
    }

    /// Whether a place is inside the surface: only there do the solid angles of the faces add up to 4 pi.
    pub(crate) fn contains(&self, place: [f64; 3]) -> bool {
        if (0..3).any(|axis| place[axis] < self.bounds[axis][0] || place[axis] > self.bounds[axis][1]) {
            return false;
        }
        self.winding(place) > 0.5
    }

    /// The winding number of the surface at a place: 1 inside, 0 outside. It is the sum of the faces' solid angles over 4 pi.
    pub(crate) fn winding(&self, place: [f64; 3]) -> f64 {
        let angle = |corners: Triangle| solid_angle(corners.map(|corner| corner - place));
        self.triangles().map(angle).sum::<f64>() / (2.0 * TAU)
    }
}

getters! {
    Mesh:

    /// The vertices (V, 3) in m.
    pub vertices(self) -> &[[f64; 3]] = &self.vertices;

    /// The faces (F, 3): three vertex indices for each.
    pub faces(self) -> &[[u32; 3]] = &self.faces;

    /// The acoustic boundary condition of the surface.
    pub kind(self) -> Surface = self.kind;

    /// The enclosed volume in m^3.
    pub volume(self) -> f64 = self.volume;

    /// The faces as triangles.
    pub(crate) triangles(self) -> impl Iterator<Item = Triangle> + Clone =
        self.faces.iter().map(|face| face.map(|v| Vec3(self.vertices[v as usize])));

    /// The lowest and highest coordinate along each axis.
    pub(crate) bounds(self) -> [[f64; 2]; 3] = self.bounds;

    /// The size of the bounding box along each axis in m.
    pub(crate) extent(self) -> [f64; 3] = self.bounds.map(|[low, high]| high - low);
}

/// Checks that the surface has no hole, and that neighbouring faces list their corners in the same sense.
fn closed(faces: &[[u32; 3]], name: impl Fn(usize) -> String) -> Result<()> {
    // Each edge belongs to two faces, which pass it in opposite directions: each direction occurs once.
    let mut edges: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for (f, &[a, b, c]) in faces.iter().enumerate() {
        for edge in [[a, b], [b, c], [c, a]] {
            if let Some(other) = edges.insert(edge, f) {
                let value = format!("turned against faces[{other}], or doubles its edge {edge:?}");
                let cure = "list the corners of each face counterclockwise as seen from outside, each face once";
                return Err(Error::invalid(name(f), value, cure));
            }
        }
    }
    for ([a, b], f) in &edges {
        if !edges.contains_key(&[*b, *a]) {
            let value = format!("beside a hole, along its edge [{a}, {b}]");
            let cure = "close the surface, or merge vertices that are the same; for a sheet give a thin box, or a wall if it is large";
            return Err(Error::invalid(name(*f), value, cure));
        }
    }
    Ok(())
}

/// The vector along the triangle's normal whose length is twice the area.
pub(crate) fn area_vector([a, b, c]: Triangle) -> Vec3 {
    (b - a).cross(c - a)
}

/// Splits a triangle into parts of at most `area` in m^2, with edges of at most `edge` in m, and calls `each` on them. A larger
/// triangle is halved across its longest edge.
pub(crate) fn halved(triangle: Triangle, area: f64, edge: f64, each: &mut impl FnMut(Triangle)) {
    let [a, b, c] = triangle;
    let lengths = [a.distance(b), b.distance(c), c.distance(a)];
    let longest = (0..3).fold(0, |best, k| if lengths[k] > lengths[best] { k } else { best });
    if lengths[longest] <= edge && 0.5 * area_vector(triangle).norm() <= area {
        return each(triangle);
    }
    let [p, q, r] = [0, 1, 2].map(|k| triangle[(longest + k) % 3]);
    let middle = 0.5 * (p + q);
    halved([p, middle, r], area, edge, each);
    halved([middle, q, r], area, edge, each);
}

/// The distance in m from a place to a triangle.
fn away([a, b, c]: Triangle, place: Vec3) -> f64 {
    let normal = area_vector([a, b, c]);
    let edges = [[a, b], [b, c], [c, a]];
    if edges.iter().all(|&[from, to]| (to - from).cross(place - from).dot(normal) >= 0.0) {
        return ((place - a).dot(normal) / normal.norm()).abs();
    }
    let edge = |[from, to]: [Vec3; 2]| {
        let along = to - from;
        let part = ((place - from).dot(along) / along.dot(along)).clamp(0.0, 1.0);
        place.distance(from + part * along)
    };
    edges.map(edge).into_iter().fold(f64::INFINITY, f64::min)
}

/// The solid angle of a triangle as seen from the origin. It is above 0 if the origin is behind the triangle, and below 0 in
/// front of it (A. Van Oosterom and J. Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30, 125,
/// 1983).
fn solid_angle([a, b, c]: Triangle) -> f64 {
    let [x, y, z] = [a, b, c].map(Vec3::norm);
    let across = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    2.0 * math::atan2(a.dot(b.cross(c)), across)
}
