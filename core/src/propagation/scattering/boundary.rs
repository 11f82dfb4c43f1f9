//! Boundary: the sound on the surfaces of meshes, by the boundary element method.
//!
//! The unknown u is constant on each flat element: u = p on a rigid element, u = (dp/dn)/k on a soft one. With the Green's
//! function g = e^{jkR}/(4 pi R) and the incident wave p_i, the pressure at a place x in the air is
//!
//! ```text
//! p(x) = p_i(x) + sum_rigid u int dg/dn_y dS - sum_soft k u int g dS
//! ```
//!
//! There are E equations for the E unknowns, one for the middle of each element. Each is the equation above plus j/k
//! times its derivative along the element's normal. The sum has no spurious resonances of the inside (A. J. Burton
//! and G. F. Miller, Proc. R. Soc. A 323, 201, 1971).
//!
//! The integral over an element is hypersingular at the element's own middle. It is known in closed form except for
//! one integral over the angle. A six-point rule computes all other integrals; near elements are first cut into
//! quarters.

use crate::kernels::InstructionSet;
use crate::kernels::panels::{self, Panels};
use crate::kernels::simd::doubles::EIGHT;
use crate::prelude::*;
use crate::propagation::scattering::element::{Element, influence};
use crate::propagation::scattering::reflection::{Reflection, reflections};
use crate::propagation::sources::Sources;
use crate::scene::{Array, Medium, Obstacle, Obstacles, check_array, element_size};

/// The step along a normal for numerical derivatives, in wavelengths. The truncation error, proportional to the square of the
/// step, and the rounding error are both below 1e-7.
const STEP: f64 = 1e-4;

/// How many matrix entries a thread computes between two checks whether to stop.
const STRETCH: usize = 1 << 14;

/// The surfaces of meshes as boundary elements for an array in a medium: the equations A u = b.
///
/// This type computes A and b; any library for linear equations computes u (E, N). [`crate::Model::with_sound`] then takes u.
/// After that, points can move without a new solution. The elements are the faces, halved until there are 2.5 of them per
/// wavelength.
///
/// ```
/// use std::sync::Arc;
/// use midair::{Array, Boundary, Control, Medium, Mesh, Obstacle, Surface};
///
/// let corners = vec![[0.0, 0.0, 0.1], [0.02, 0.0, 0.1], [0.0, 0.02, 0.1], [0.0, 0.0, 0.12]];
/// let mesh = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], Surface::Rigid)?;
/// let array = Array::grid(4, 4, 10e-3)?;
/// let boundary = Boundary::new(&array, Medium::default(), vec![Obstacle::Mesh(Arc::new(mesh))])?;
/// let elements = boundary.elements();
/// assert_eq!(boundary.matrix(&mut Control::none())?.len(), elements * elements);
/// assert_eq!(boundary.incident(&mut Control::none())?.len(), elements * 16);
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Boundary {
    pub(crate) obstacles: Obstacles,
    /// The array and its images in walls, all with response 1.
    pub(super) sources: Vec<Sources>,
    pub(super) elements: Vec<Element>,
    /// The mirror images of the elements in walls, each set with its factor.
    images: Vec<(f64, Vec<Element>)>,
    /// The elements and then their images in the form of the kernels, eight in each panel.
    panels: Vec<Vec<Panels>>,
}

impl Boundary {
    /// Returns the boundary of the meshes among these obstacles.
    ///
    /// # Errors
    /// The errors of [`crate::Scene::with_obstacles`]; obstacles without a mesh.
    pub fn new(array: &Array, medium: Medium, obstacles: Vec<Obstacle>) -> Result<Self> {
        check_array(array, medium)?;
        let obstacles = Obstacles::new(obstacles, array, medium)?;
        let size = element_size(medium);
        let elements: Vec<Element> = obstacles.meshes().flat_map(|mesh| Element::all(mesh, size)).collect();
        if elements.is_empty() {
            return Err(Error::invalid("obstacles", "without a mesh", "walls and spheres need no boundary solved"));
        }
        let bare = array.clone().with_response(None)?.with_mask(None)?;
        let reflections = reflections(array, &obstacles);
        let seen = |reflection: &Reflection| elements.iter().map(|element| reflection.element(element)).collect();
        let images: Vec<_> = reflections.iter().map(|reflection| (reflection.factor(), seen(reflection))).collect();
        let each = core::iter::once(&elements).chain(images.iter().map(|(_, images)| images));
        let panels = each.map(|elements| Element::panels(elements, medium.wavenumber())).collect();
        let arrays = reflections.iter().map(|reflection| reflection.array(&bare));
        let sources = core::iter::once(bare.clone()).chain(arrays).map(|array| Sources::new(&array, medium)).collect();
        Ok(Self { obstacles, sources, elements, images, panels })
    }

    /// The parameters that the sound on the boundary depends on, as bytes: the key for a cache of solutions.
    pub fn content(&self) -> Vec<u8> {
        let (array, medium) = (&self.sources[0].array, self.medium());
        // {:?} writes the shortest text that reads as the same f64.
        let medium = [medium.frequency, medium.sound_speed, medium.absorption];
        let placed = (array.positions(), array.normals(), array.transducer(), medium);
        format!("{placed:?} {:?}", self.obstacles.list()).into_bytes()
    }

    /// Whether the boundary belongs to this array and medium. Responses do not matter.
    pub(crate) fn fits(&self, array: &Array, medium: Medium) -> bool {
        let solved = &self.sources[0].array;
        let placed = solved.positions() == array.positions() && solved.normals() == array.normals();
        placed && solved.transducer() == array.transducer() && self.medium() == medium
    }

    /// Returns the matrix A (E, E), row by row.
    ///
    /// # Errors
    /// Bodies that coincide, cross or contain each other, or that are too thin for the size of the elements; more memory than
    /// allowed; a stop by the caller.
    pub fn matrix(&self, control: &mut Control) -> Result<Vec<Complex32>> {
        let count = self.elements.len();
        control.room("the boundary of the meshes", [self.transducers(), count], bytes(8, &[count, count]))?;
        self.enclosed(control)?;
        let mut matrix = vec![Complex32::ZERO; count * count];
        let share = STRETCH.div_ceil(count);
        let steps = count.div_ceil(share);
        let threads = control.threads();
        for (step, rows) in matrix.chunks_mut(share * count * threads).enumerate() {
            let first = step * share * threads;
            let parts = rows.chunks_mut(count).enumerate().collect();
            control.each(parts, &|(k, row): (usize, &mut [Complex32]), control| {
                self.fill(first + k, row);
                control.pulse()
            })?;
            refuse_if!(control.step(((step + 1) * threads).min(steps), steps, || 0.0).is_break(), Error::stopped());
        }
        Ok(matrix)
    }

    /// Writes the equation at the middle of element `e`, row `e` of A.
    fn fill(&self, e: usize, row: &mut [Complex32]) {
        let element = &self.elements[e];
        let (wave, eta) = (self.medium().complex_wavenumber(), self.eta());
        for (f, (entry, other)) in row.iter_mut().zip(&self.elements).enumerate() {
            let mut sum = if e == f {
                element.own_influence(wave, eta) - element.jump()
            } else {
                influence(wave, (element.center(), Some((element.normal, eta))), other)
            };
            for (sign, images) in &self.images {
                sum += *sign * influence(wave, (element.center(), Some((element.normal, eta))), &images[f]);
            }
            *entry = Complex32::new(-sum.re as f32, -sum.im as f32);
        }
    }

    /// Returns b (E, N) in Pa, row by row: the incident wave p_i + j/k dp_i/dn of each transducer alone at the middle of each
    /// element.
    ///
    /// # Errors
    /// More memory than allowed; a stop by the caller.
    pub fn incident(&self, control: &mut Control) -> Result<Vec<Complex32>> {
        let (count, transducers) = (self.elements.len(), self.transducers());
        control.room("sound that meets the meshes", [transducers, count], bytes(8, &[count, transducers]))?;
        let mut incident = vec![Complex32::ZERO; count * transducers];
        let step = STEP * self.medium().wavelength();
        let parts = incident.chunks_mut(transducers).zip(&self.elements).collect();
        control.each(parts, &|(row, element): (&mut [Complex32], &Element), control| {
            let beside = |by: f64| (element.center() + by * element.normal).0;
            let sent = |i: usize, place| self.sources.iter().map(|sources| sources.exact(i, place)).sum::<Complex64>();
            for (i, entry) in row.iter_mut().enumerate() {
                let slope = (sent(i, beside(step)) - sent(i, beside(-step))) / (2.0 * step);
                let met = sent(i, element.center().0) + self.eta() * slope;
                *entry = Complex32::new(met.re as f32, met.im as f32);
            }
            control.pulse()
        })?;
        Ok(incident)
    }

    /// Writes the wave of each element at a point, for u = 1 on the element.
    pub(crate) fn row(&self, point: [f64; 3], row: &mut Vec<Complex64>) {
        let wave = self.medium().complex_wavenumber();
        row.clear();
        row.resize(self.elements.len(), Complex64::ZERO);
        let images = self.images.iter().map(|(sign, elements)| (*sign, elements));
        for ((sign, elements), panels) in core::iter::once((1.0, &self.elements)).chain(images).zip(&self.panels) {
            let mut parts = row.chunks_mut(EIGHT).zip(elements.chunks(EIGHT));
            // The best instruction set can be used, because all sets give the same bits.
            panels::each(InstructionSet::best(), [wave.re, wave.im], panels, point, |[re, im]| {
                let Some((row, elements)) = parts.next() else { return };
                for ((sum, element), (&re, &im)) in row.iter_mut().zip(elements).zip(re.iter().zip(im)) {
                    let near = element.is_near(Vec3(point)).then(|| influence(wave, (Vec3(point), None), element));
                    *sum += sign * near.unwrap_or(Complex64::new(re, im));
                }
            });
        }
    }

    /// Checks that `sound` (E, N) has the size of this boundary and is finite.
    pub(crate) fn check_sound(&self, sound: &[Complex32]) -> Result<()> {
        let count = self.elements.len() * self.transducers();
        if sound.len() != count {
            let cure = format!("give {count}, one for each of {} elements and transducer", self.elements.len());
            return Err(Error::shape("sound", format!("{} numbers", sound.len()), cure));
        }
        if let Some(k) = sound.iter().position(|u| !(u.re.is_finite() && u.im.is_finite())) {
            return Err(Error::not_finite(format!("sound[{k}]"), sound[k]));
        }
        Ok(())
    }
}

getters! {
    Boundary:

    /// The number of elements E.
    pub elements(self) -> usize = self.elements.len();

    /// The number of transducers N.
    pub transducers(self) -> usize = self.sources[0].array.len();

    pub(crate) medium(self) -> Medium = self.sources[0].medium;

    /// The factor j/k of the derivative in the equations. A factor with an imaginary part excludes the resonances; the modulus
    /// 1/k gives the best condition number (A. J. Burton and G. F. Miller).
    eta(self) -> Complex64 = Complex64::new(0.0, 1.0 / self.medium().wavenumber());
}
