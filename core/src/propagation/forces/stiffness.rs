//! Stiffness of traps as a quadratic form of the field's Taylor coefficients at each point, for methods that optimise it.
//!
//! ```text
//! c_jt  = sum_i C_jti q_i               coefficient t of p at point j, of degree n_t, times k^-n_t
//! H_jab = sum_tu Re(F_abtu c_jt* c_ju)  -(dF_a/dx_b + dF_b/dx_a)/2
//! K_j   = the eigenvalues of H_j        -dF/ds along the axes of the trap
//! f_ja  = sum_tu Re(S_atu c_jt* c_ju)   the force
//! ```
//!
//! C, F and S are constant, q is the drive. F and S are those of `response`. K contains eigenvalues and not the stiffness along
//! x, y and z: all three of these can be above 0 although the trap is open in a direction between two axes.
//!
//! Foci beside the traps have rows of C, too. Only the first coefficient of a focus, its pressure, is used.

use crate::device::channels::Channels;
use crate::kernels::{InstructionSet, padded};
use crate::linalg::symmetric::eigen;
use crate::prelude::*;
use crate::propagation::forces::response::{Form, Product, Response};
use crate::propagation::jet::{TERMS, degree};
use crate::propagation::local::Local;
use crate::propagation::scattering::Scattering;
use crate::propagation::sources::Sources;
use crate::propagation::taylor::Taylor;
use crate::scene::{Bead, Medium, Particle};

/// The entries (a, b) of the symmetric matrix H.
const ENTRIES: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];

/// [`Stiffness::balance`] divides by the stiffness along each axis, but by at least this part of the largest stiffness.
const LEAST_STIFFNESS: f64 = 1e-3;

/// C, F and S of some points, for a particle: traps, and after them foci. See the module's head.
pub(crate) struct Stiffness {
    /// C column by column, one column for each transducer or channel; the rows of point j begin at j [`TERMS`]. Padded, real
    /// and imaginary part, in units of the reference.
    planes: [Vec<f32>; 2],
    /// The indices of the traps and of the foci among the points.
    chosen: [Vec<usize>; 2],
    /// F in N/m for each of [`ENTRIES`], and S in N for each axis, for coefficients in the units of `planes`.
    forms: Vec<Form>,
    /// The forces in N on the particle at each point besides the sound: weight less buoyancy, minus the forces of
    /// [`Stiffness::pull_by`].
    load: Vec<[f64; 3]>,
    particle: Particle,
    medium: Medium,
}

impl Stiffness {
    /// Computes the coefficients for some sources at some points, with obstacles, summed by channels. Returns `None` where the
    /// field has no derivatives.
    ///
    /// # Errors
    /// More memory than allowed, a stop by the caller.
    pub(crate) fn of(
        Bead { particle, gravity }: Bead,
        sources: &Sources,
        scattering: Option<&Scattering>,
        channels: Option<&Channels>,
        places: &[[f64; 3]],
        chosen: [Vec<usize>; 2],
        control: &mut Control,
    ) -> Result<Option<Self>> {
        let points: Vec<[f64; 3]> = chosen.iter().flatten().map(|&j| places[j]).collect();
        // The best instruction set can be used, because all sets give the same bits.
        let (set, transducers) = (InstructionSet::best(), sources.array.len());
        let columns = channels.map_or(transducers, Channels::count);
        let lanes = padded(points.len() * TERMS);
        control.room("the stiffness of traps", [transducers, points.len()], bytes(8, &[transducers, lanes]))?;
        let [mut re, mut im] = [(); 2].map(|()| vec![0.0; columns * lanes]);
        let units = units(sources.medium, 1.0 / sources.reference());
        let mut add = |j: usize, i: usize, wave: &[[f64; TERMS]; 2]| {
            let first = channels.map_or(i, |channels| channels.of()[i]) * lanes + j * TERMS;
            for (plane, part) in [&mut re, &mut im].into_iter().zip(wave) {
                for (entry, (c, unit)) in plane[first..].iter_mut().zip(part.iter().zip(&units)) {
                    *entry += (c * unit) as f32;
                }
            }
        };
        for sources in core::iter::once(sources).chain(scattering.map_or(&[][..], |all| &all.images)) {
            let waves = Taylor::new(set, sources, |i| sources.array.effect(i));
            for (j, &point) in points.iter().enumerate() {
                waves.each(point, control, |i, wave| add(j, i, &wave))?;
            }
        }
        if let Some((all, bodies)) = scattering.and_then(|all| Some((all, all.bodies.as_ref()?))) {
            for (j, &point) in points.iter().enumerate() {
                let Some(local) = Local::beside(sources.medium, all.obstacles.clearance(point)) else {
                    return Ok(None);
                };
                for (i, sent) in bodies.expanded(&local, point, control)?.iter().enumerate() {
                    let wave = sent.map(|c| c * sources.array.effect(i));
                    add(j, i, &[wave.map(|c| c.re), wave.map(|c| c.im)]);
                }
            }
        }
        let finite = re.iter().chain(&im).all(|c| c.is_finite());
        let made = Self {
            planes: [re, im],
            forms: forms(&Response::new(particle, sources.medium), &units),
            load: vec![particle.weight(sources.medium, gravity); chosen[0].len()],
            chosen,
            particle,
            medium: sources.medium,
        };
        Ok(finite.then_some(made))
    }

    /// Subtracts forces (M, 3) in N from the load: the net force is then 0 where the sound also gives these forces.
    pub(crate) fn pull_by(&mut self, forces: &[[f64; 3]]) {
        for (load, force) in self.load.iter_mut().zip(forces) {
            load.iter_mut().zip(force).for_each(|(load, x)| *load -= x);
        }
    }

    /// The force in N that a particle with this velocity in m/s and acceleration in m/s^2 needs against inertia and the drag of
    /// air.
    pub(crate) fn needed(&self, velocity: [f64; 3], acceleration: [f64; 3]) -> [f64; 3] {
        self.particle.needed(self.medium, velocity, acceleration)
    }

    /// The matrix C (see the module's head), as real and imaginary parts for the kernels.
    pub(crate) fn planes(&self) -> [&[f32]; 2] {
        self.planes.each_ref().map(|plane| &plane[..])
    }

    /// The coefficients c = C q of a drive (N,), real and imaginary part.
    pub(crate) fn field(&self, drive: &[Complex32]) -> [Vec<f32>; 2] {
        let lanes = padded(self.rows());
        let mut field = [(); 2].map(|()| vec![0.0; lanes]);
        for (i, q) in drive.iter().enumerate() {
            let [re, im] = self.column(i);
            for k in 0..lanes {
                field[0][k] += re[k] * q.re - im[k] * q.im;
                field[1][k] += re[k] * q.im + im[k] * q.re;
            }
        }
        field
    }

    /// Returns sum_k (a_k - j b_k) C_ki over the coefficients k of point j, for column i: real and imaginary part.
    pub(crate) fn correlated(&self, i: usize, j: usize, [a, b]: &[[f32; TERMS]; 2]) -> [f64; 2] {
        let [re, im] = self.column(i).map(|column| coefficients(column, j));
        let mut sum = [0.0; 2];
        for k in 0..TERMS {
            let [a, b] = [a[k], b[k]].map(f64::from);
            sum[0] += a * re[k] + b * im[k];
            sum[1] += a * im[k] - b * re[k];
        }
        sum
    }

    fn column(&self, i: usize) -> [&[f32]; 2] {
        let lanes = padded(self.rows());
        self.planes.each_ref().map(|plane| &plane[i * lanes..(i + 1) * lanes])
    }

    /// The number of rows of C.
    pub(crate) fn rows(&self) -> usize {
        self.chosen.iter().map(Vec::len).sum::<usize>() * TERMS
    }

    /// The indices of the traps and of the foci among the points.
    pub(crate) fn chosen(&self) -> [&[usize]; 2] {
        self.chosen.each_ref().map(|chosen| &chosen[..])
    }

    fn traps(&self) -> usize {
        self.chosen[0].len()
    }

    /// Returns for each focus its index in the order of C, and its pressure in units of the reference: real and
    /// imaginary part.
    pub(crate) fn foci(&self, field: [&[f32]; 2]) -> impl Iterator<Item = (usize, [f64; 2])> {
        (self.traps()..self.traps() + self.chosen[1].len())
            .map(move |j| (j, field.map(|plane| f64::from(plane[j * TERMS]))))
    }

    /// The eigenvalues K (3 M,) for coefficients c, given as real and imaginary part.
    pub(crate) fn at(&self, field: [&[f32]; 2]) -> impl Iterator<Item = f64> {
        (0..self.traps()).flat_map(move |j| eigen(self.hessian(field, j)).0)
    }

    /// Returns, for coefficients c, the net force (M, 3) on the particles and the inverse of each |H|. Their product is the
    /// distance to the place where the force is 0.
    pub(crate) fn balance(&self, field: [&[f32]; 2]) -> (Vec<[f64; 3]>, Vec<[[f64; 3]; 3]>) {
        let each = |j: usize| {
            let (values, vectors) = eigen(self.hessian(field, j));
            let least = values.iter().fold(0.0_f64, |most, k| most.max(k.abs())) * LEAST_STIFFNESS;
            let entry =
                |a: usize, b: usize| values.iter().zip(&vectors).map(|(k, v)| v[a] * v[b] / k.abs().max(least)).sum();
            (self.net(field, j), [0, 1, 2].map(|a| [0, 1, 2].map(|b| entry(a, b))))
        };
        (0..self.traps()).map(each).unzip()
    }

    fn net(&self, field: [&[f32]; 2], j: usize) -> [f64; 3] {
        let parts = field.map(|plane| coefficients(plane, j));
        [0, 1, 2].map(|axis| self.load[j][axis] + self.forms[ENTRIES.len() + axis].value(parts.each_ref()))
    }

    /// Writes the gradient of sum_k w_k K_k + sum_j v_j . f_j by the coefficients c: by Re c into `re`, by Im c into `im`. The
    /// weights w are (3 M,), v is (M, 3).
    pub(crate) fn pull(&self, field: [&[f32]; 2], weights: &[f64], forces: &[[f64; 3]], [re, im]: [&mut [f32]; 2]) {
        for (j, (weights, forces)) in weights.chunks_exact(3).zip(forces).enumerate() {
            if weights.iter().chain(forces).all(|&share| share == 0.0) {
                for pulls in [&mut *re, &mut *im] {
                    pulls[j * TERMS..(j + 1) * TERMS].fill(0.0);
                }
                continue;
            }
            // The change of an eigenvalue with eigenvector v is dK = v^T dH v.
            let (_, vectors) = eigen(self.hessian(field, j));
            let shares = ENTRIES.map(|[a, b]| {
                let both = if a == b { 1.0 } else { 2.0 };
                weights.iter().zip(&vectors).map(|(w, v)| both * w * v[a] * v[b]).sum::<f64>()
            });
            let parts = field.map(|plane| coefficients(plane, j));
            let mut sum = [[0.0; TERMS]; 2];
            for (form, share) in self.forms.iter().zip(shares.iter().chain(forces)) {
                form.pull(*share, parts.each_ref(), &mut sum);
            }
            for (pulls, sum) in [&mut *re, &mut *im].into_iter().zip(sum) {
                pulls[j * TERMS..].iter_mut().zip(sum).for_each(|(pull, sum)| *pull = sum as f32);
            }
        }
    }

    /// The matrix H of trap j.
    fn hessian(&self, field: [&[f32]; 2], j: usize) -> [[f64; 3]; 3] {
        let parts = field.map(|plane| coefficients(plane, j));
        let mut hessian = [[0.0; 3]; 3];
        for ([a, b], form) in ENTRIES.into_iter().zip(&self.forms) {
            hessian[a][b] = form.value(parts.each_ref());
            hessian[b][a] = hessian[a][b];
        }
        hessian
    }
}

/// Units for the coefficients in which all of them have a similar size.
fn units(medium: Medium, pressure: f64) -> [f64; TERMS] {
    core::array::from_fn(|term| pressure / (0..degree(term)).map(|_| medium.wavenumber()).product::<f64>())
}

/// Returns F and S for coefficients in `units`.
fn forms(response: &Response, units: &[f64; TERMS]) -> Vec<Form> {
    let scaled = |form: &Form| {
        let each = form.0.iter().map(|&Product { terms: [t, u], weight }| Product {
            terms: [t, u],
            weight: weight / (units[t] * units[u]),
        });
        Form(each.collect())
    };
    let hessian = ENTRIES.iter().map(|&[a, b]| &response.hessian[a][b]);
    hessian.chain(&response.force).map(scaled).collect()
}

/// The coefficients of point j.
fn coefficients(plane: &[f32], j: usize) -> [f64; TERMS] {
    core::array::from_fn(|term| f64::from(plane[j * TERMS + term]))
}

#[cfg(test)]
#[path = "tests/stiffness.rs"]
mod tests;
