//! Gradient: derivatives of a quantity of the field by the drive, the points, the array and the sound speed.
//!
//! This is reverse-mode differentiation, written by hand. A caller has a scalar L and gives its cotangent dL/dvalue at each
//! point. One forward pass computes the values, one backward pass the derivatives of L by all that the values depend on.
//!
//! For a function of the pressure p at its point, `kernels::backward` computes the derivatives by drive, transducers, point and
//! wavenumber from the cotangent of p, w = dL/dRe p + j dL/dIm p. A quantity of a particle is a function of the field's Taylor
//! coefficients around the point; `kernels::contraction` does the same from their cotangents. The gradient of an image in a
//! wall is that of the mirrored transducer, mirrored back.

use crate::kernels::InstructionSet;
use crate::kernels::backward::{Pull, Senders, Sent, back, forth};
use crate::kernels::contraction::contract;
use crate::kernels::simd::doubles::{EIGHT, Eight};
use crate::prelude::*;
use crate::propagation::forces::quantity::{Quantity, weights};
use crate::propagation::forces::response::Response;
use crate::propagation::jet::Jet;
use crate::propagation::scattering::reflection::reflections;
use crate::propagation::taylor::Taylor;
use crate::propagation::{Model, Sources};
use crate::scene::{Medium, Obstacle, check_places};

/// How many points share one sum of gradients by transducers. These sums are added in the order of the points, so that the
/// result does not depend on the threads.
const BLOCK: usize = 32;

/// The most sums of blocks that wait to be added, for each thread.
const WAITING: usize = 4;

/// From this many pairs of a transducer and a point on, a second thread saves more time than its start takes.
const SPREAD: usize = 1 << 17;

/// The step of the differences for the gradient of a stiffness, in wavelengths. It is small, because the second derivatives of
/// measured directivities jump.
const STEP: f64 = 1.0 / 20_000.0;

/// The unit vectors along x, y and z.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The values of a quantity, and the gradients of L = sum of cotangent times value.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gradient {
    /// The quantity at each point: [`Quantity::width`] numbers for each.
    pub value: Vec<f64>,
    /// dL/dRe q + j dL/dIm q for each drive q (N,): the direction in which L rises fastest.
    pub drive: Vec<Complex64>,
    /// The derivatives of L by each point (M, 3), in 1/m.
    pub points: Vec<[f64; 3]>,
    /// The derivatives of L by each transducer's position (N, 3), in 1/m.
    pub positions: Vec<[f64; 3]>,
    /// The derivatives of L by each transducer's unit normal (N, 3); only the part perpendicular to the normal.
    pub normals: Vec<[f64; 3]>,
    /// The derivative of L by the sound speed, in s/m, at constant frequency, absorption and density.
    pub sound_speed: f64,
}

/// Returns the gradients of a quantity at `points` (M, 3) in m, in the field of a drive (N,). The `cotangent` dL/dvalue has
/// [`Quantity::width`] numbers for each point.
///
/// The field is that of [`crate::gorkov`]: in double precision, with walls and without a signature. All parameters without a
/// field in [`Gradient`] are constant: source pressure, directivity, responses, absorption.
///
/// # Errors
/// A drive or cotangent of another length or not finite; no points, one that is not finite, too far away, behind a wall, within
/// lambda/100 of a transducer, or in the plane of a transducer whose directivity is discontinuous there; spheres and meshes;
/// more memory than allowed; a particle of no size, density or sound speed; a stop by the caller.
///
/// ```
/// use midair::{Array, Complex64, Control, InstructionSet, Medium, Model, Quantity};
///
/// let model = Model::new(&Array::grid(1, 1, 10e-3)?, Medium::default(), InstructionSet::best())?;
/// let (drive, point) = ([Complex64::ONE], [[0.0, 0.0, 0.1]]);
/// let by = midair::gradient(&model, &drive, &point, Quantity::Amplitude, &[1.0], &mut Control::none())?;
/// // |p| = P0 |q|/r.
/// assert!((by.value[0] - 43.86).abs() < 1e-9 && (by.drive[0].re - 43.86).abs() < 1e-9);
/// assert!((by.points[0][2] + 438.6).abs() < 1e-6 && (by.positions[0][2] - 438.6).abs() < 1e-6);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn gradient(
    model: &Model,
    drive: &[Complex64],
    points: &[[f64; 3]],
    quantity: Quantity,
    cotangent: &[f64],
    control: &mut Control,
) -> Result<Gradient> {
    let width = points.len() * quantity.width();
    one_each("cotangent", cotangent.len(), "numbers", width, "numbers of the value")?;
    if let Some(k) = cotangent.iter().position(|x| !x.is_finite()) {
        return Err(Error::not_finite(format!("cotangent[{k}]"), cotangent[k]));
    }
    Pass::new(model, drive, points, quantity)?.run(points, Some(cotangent), control)
}

impl Quantity {
    /// Returns only the values of the quantity, [`Quantity::width`] numbers for each point: the forward pass of [`gradient`].
    ///
    /// # Errors
    /// The errors of [`gradient`].
    pub fn value(
        self,
        model: &Model,
        drive: &[Complex64],
        points: &[[f64; 3]],
        control: &mut Control,
    ) -> Result<Vec<f64>> {
        Ok(Pass::new(model, drive, points, self)?.run(points, None, control)?.value)
    }
}

/// The transducers, or their images in one wall or in several.
struct Seen<'a> {
    sources: &'a Sources,
    waves: Taylor,
    drives: Vec<[Eight; 2]>,
    /// The waves times the drive, for a quantity of a particle.
    driven: Option<Taylor>,
    /// The unit vectors as mirrored by the walls.
    axes: [[f64; 3]; 3],
}

impl Seen<'_> {
    fn senders(&self) -> Senders<'_> {
        Senders { waves: &self.waves.waves, emitters: &self.waves.emitters, drives: &self.drives }
    }
}

/// The field of a drive, prepared for the points.
struct Pass<'a> {
    set: InstructionSet,
    medium: Medium,
    quantity: Quantity,
    /// For a quantity of a particle, its response and the derivative of the response by the sound speed.
    responses: Option<[Response; 2]>,
    all: Vec<Seen<'a>>,
}

/// A point, and its share of a block's results.
struct Spot<'a> {
    /// The index of the point in errors.
    index: usize,
    point: [f64; 3],
    /// The place of its values in those of the block.
    values: Range<usize>,
    cotangent: Option<&'a [f64]>,
}

/// Results at one block of points.
struct Part {
    value: Vec<f64>,
    points: Vec<[f64; 3]>,
    /// Gradients by transducer: one list for the array and one for each of its images.
    pulls: Vec<Vec<Pull>>,
    by_k: f64,
    by_speed: f64,
}

impl<'a> Pass<'a> {
    fn new(model: &'a Model, drive: &[Complex64], points: &[[f64; 3]], quantity: Quantity) -> Result<Self> {
        let (array, medium) = (model.array(), model.medium());
        one_each("drive", drive.len(), "values", array.len(), "transducers")?;
        if let Some(i) = drive.iter().position(|q| !q.re.is_finite() || !q.im.is_finite()) {
            return Err(Error::not_finite(format!("drive[{i}]"), drive[i]));
        }
        if points.is_empty() {
            return Err(Error::missing("points", "empty", "give at least one point"));
        }
        check_places(array.centre(), medium, "points", "", points)?;
        quantity.particle().map_or(Ok(()), |particle| particle.in_range())?;
        let seen = |sources: &'a Sources, axes: [[f64; 3]; 3]| {
            let waves = Taylor::new(model.set, sources, |i| sources.array.effect(i));
            let mut drives = vec![[[0.0; EIGHT]; 2]; waves.emitters.len()];
            for (lane, &i) in waves.members.iter().enumerate() {
                let [re, im] = &mut drives[lane / EIGHT];
                (re[lane % EIGHT], im[lane % EIGHT]) = (drive[i].re, drive[i].im);
            }
            let played = |i: usize| sources.array.effect(i) * drive[i];
            let driven = quantity.particle().map(|_| Taylor::new(model.set, sources, played));
            Seen { sources, waves, drives, driven, axes }
        };
        let mut all = vec![seen(&model.sources, AXES)];
        if let Some(scattering) = &model.scattering {
            let body = scattering.obstacles.list().iter().position(|body| !matches!(body, Obstacle::Wall { .. }));
            if let Some(k) = body {
                let noun = scattering.obstacles.list()[k].noun();
                let cure = "gradients are known beside walls alone: leave it out";
                return Err(Error::invalid(format!("obstacles[{k}]"), format!("a {noun}"), cure));
            }
            scattering.obstacles.check_points(points)?;
            let mirrors = reflections(array, &scattering.obstacles);
            let turned = mirrors.iter().map(|mirror| AXES.map(|axis| mirror.direction(Vec3(axis)).0));
            all.extend(scattering.images.iter().zip(turned).map(|(sources, axes)| seen(sources, axes)));
        }
        let responses =
            quantity.particle().map(|particle| [Response::new(particle, medium), Response::by_speed(particle, medium)]);
        Ok(Self { set: model.set, medium, quantity, responses, all })
    }

    /// Returns the values and, with a cotangent, the gradients. Blocks of points are computed in parallel and added in their
    /// order.
    fn run(&self, points: &[[f64; 3]], cotangent: Option<&[f64]>, control: &mut Control) -> Result<Gradient> {
        let (width, count) = (self.quantity.width(), self.all[0].sources.array.len());
        let blocks: usize = self.all.iter().map(|seen| seen.drives.len()).sum();
        let waiting = WAITING * control.threads();
        let stored = bytes(size_of::<Pull>() + size_of::<Sent>(), &[waiting, blocks]);
        control.room("the gradients", [count, points.len()], stored)?;
        let mut gradient = Gradient {
            value: Vec::with_capacity(width * points.len()),
            drive: vec![Complex64::ZERO; count],
            points: Vec::with_capacity(points.len()),
            positions: vec![[0.0; 3]; count],
            normals: vec![[0.0; 3]; count],
            sound_speed: 0.0,
        };
        let mut sum = Part::none(self);
        for (stretch, all) in points.chunks(BLOCK * waiting).enumerate() {
            let first = stretch * BLOCK * waiting;
            let mut parts: Vec<Option<Part>> = all.chunks(BLOCK).map(|_| None).collect();
            let mut work = parts.iter_mut().zip(all.chunks(BLOCK)).enumerate();
            let run = |(k, (part, points)): (usize, (&mut Option<Part>, &[[f64; 3]])), control: &mut Control| {
                let first = first + k * BLOCK;
                let cotangent = cotangent.map(|all| &all[first * width..(first + points.len()) * width]);
                *part = Some(self.part(first, points, cotangent, control)?);
                Ok(())
            };
            // A quantity of a particle needs derivatives of the field, which take ten times as long.
            let cost = if self.quantity.particle().is_some() { 10 } else { 1 };
            if count * all.len() * cost < SPREAD {
                work.try_for_each(|work| run(work, control))?;
            } else {
                control.each(work.collect(), &run)?;
            }
            for part in parts.into_iter().flatten() {
                sum.add(&part);
                gradient.value.extend(part.value);
                gradient.points.extend(part.points);
            }
        }
        for (seen, pulls) in self.all.iter().zip(&sum.pulls) {
            let back = |v: [f64; 3]| seen.axes.map(|axis| Vec3(axis).dot(v));
            for (lane, &i) in seen.waves.members.iter().enumerate() {
                let (pull, lane) = (&pulls[lane / EIGHT], lane % EIGHT);
                gradient.drive[i] += Complex64::new(pull.drive[0][lane], pull.drive[1][lane]);
                let [position, normal] =
                    [&pull.position, &pull.normal].map(|all| back([0, 1, 2].map(|k| all[k][lane])));
                (0..3).for_each(|k| gradient.positions[i][k] += position[k]);
                (0..3).for_each(|k| gradient.normals[i][k] += normal[k]);
            }
        }
        gradient.sound_speed = sum.by_speed - sum.by_k * self.medium.wavenumber() / self.medium.sound_speed;
        Ok(gradient)
    }

    /// Computes one block of points; `first` is the index of its first point.
    fn part(
        &self,
        first: usize,
        points: &[[f64; 3]],
        cotangent: Option<&[f64]>,
        control: &mut Control,
    ) -> Result<Part> {
        let width = self.quantity.width();
        let mut part = Part::none(self);
        part.value.resize(width * points.len(), 0.0);
        let mut sent: Vec<Vec<Sent>> = self.all.iter().map(|seen| vec![Sent::ZERO; seen.drives.len()]).collect();
        for (j, &point) in points.iter().enumerate() {
            let values = j * width..(j + 1) * width;
            let cotangent = cotangent.map(|cotangent| &cotangent[values.clone()]);
            let spot = Spot { index: first + j, point, values: values.clone(), cotangent };
            let by_point = match &self.responses {
                None => self.of_pressure(spot, &mut sent, &mut part, control)?,
                Some(responses) => self.of_particle(spot, responses, &mut part, control)?,
            };
            let finite = |all: &[f64]| all.iter().all(|x| x.is_finite());
            if !(finite(&by_point) && finite(&part.value[values])) {
                let cure = "the gradient has no bound there: move it off the plane of a transducer's face";
                return Err(Error::invalid(format!("points[{}]", first + j), format!("{point:?}"), cure));
            }
            part.points.push(by_point);
        }
        Ok(part)
    }

    /// Computes a function of the pressure at one point. Writes its value into `part` and, with a cotangent, adds its gradients
    /// there. Returns the gradient by the point.
    fn of_pressure(
        &self,
        Spot { index, point, values, cotangent }: Spot<'_>,
        sent: &mut [Vec<Sent>],
        part: &mut Part,
        control: &mut Control,
    ) -> Result<[f64; 3]> {
        let least = self.medium.wavelength() / 100.0;
        let mut p = Complex64::ZERO;
        for (seen, sent) in self.all.iter().zip(&mut *sent) {
            let ([re, im], near) = forth(self.set, seen.senders(), point, sent, control)?;
            if near * least >= 1.0 {
                (0..seen.sources.array.len()).try_for_each(|i| seen.sources.check_distance(i, index, point))?;
            }
            p += Complex64::new(re, im);
        }
        let value = &mut part.value[values];
        self.quantity.write(self.medium, p, value);
        let Some(cotangent) = cotangent else { return Ok([0.0; 3]) };
        let (w, by_speed) = self.quantity.back(self.medium, p, value, cotangent);
        part.by_speed += by_speed;
        let mut by_point = [0.0; 3];
        for ((seen, sent), pulls) in self.all.iter().zip(&*sent).zip(&mut part.pulls) {
            let by_place = back(self.set, seen.senders(), point, w, sent, pulls, control)?;
            (0..3).for_each(|axis| by_point[axis] += by_place[axis]);
            part.by_k += by_place[3];
        }
        Ok(by_point)
    }

    /// Does the same as [`Pass::of_pressure`] for a quantity of a particle.
    fn of_particle(
        &self,
        Spot { index, point, values, cotangent }: Spot<'_>,
        responses: &[Response; 2],
        part: &mut Part,
        control: &mut Control,
    ) -> Result<[f64; 3]> {
        let pressure = self.expanded(index, point, control)?;
        self.quantity.write_of_particle(&pressure, &responses[0], &mut part.value[values]);
        let Some(cotangent) = cotangent else { return Ok([0.0; 3]) };
        let Quantity::Stiffness(particle) = self.quantity else {
            return self.pull(self.quantity, responses, (point, &pressure), cotangent, part, control);
        };
        // The stiffness contains fourth derivatives of the field, and its gradient would need the fifth. So the gradient is the
        // difference, of fourth order, of that of the force.
        let step = STEP * self.medium.wavelength();
        let mut by_point = [0.0; 3];
        for (axis, share) in cotangent.iter().enumerate() {
            for (steps, weight) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
                let (mut beside, mut cotangent) = (point, [0.0; 3]);
                beside[axis] += steps * step;
                cotangent[axis] = -weight * share / (12.0 * step);
                let pressure = self.expanded(index, beside, control)?;
                let force = Quantity::Force(particle);
                let by_place = self.pull(force, responses, (beside, &pressure), &cotangent, part, control)?;
                (0..3).for_each(|axis| by_point[axis] += by_place[axis]);
            }
        }
        Ok(by_point)
    }

    /// The Taylor polynomials of the pressure around a point, real and imaginary part.
    fn expanded(&self, index: usize, point: [f64; 3], control: &mut Control) -> Result<[Jet; 2]> {
        let mut pressure = [Jet::ZERO; 2];
        for seen in &self.all {
            (0..seen.sources.array.len()).try_for_each(|i| seen.sources.check_distance(i, index, point))?;
            seen.driven.iter().try_for_each(|waves| waves.add(point, &mut pressure, control))?;
        }
        Ok(pressure)
    }

    /// Adds the gradients of a quantity of a particle, without fourth derivatives, at a point with this pressure. Returns the
    /// gradient by the point.
    fn pull(
        &self,
        quantity: Quantity,
        responses: &[Response; 2],
        (point, pressure): ([f64; 3], &[Jet; 2]),
        cotangent: &[f64],
        part: &mut Part,
        control: &mut Control,
    ) -> Result<[f64; 3]> {
        let (pulled, by_speed) = quantity.back_of_particle(responses, pressure, cotangent);
        part.by_speed += by_speed;
        let weights = weights(&pulled);
        let mut by_point = [0.0; 3];
        for (seen, pulls) in self.all.iter().zip(&mut part.pulls) {
            let by_place = contract(self.set, seen.senders(), point, &weights, pulls, control)?;
            (0..3).for_each(|axis| by_point[axis] += by_place[axis]);
            part.by_k += by_place[3];
        }
        Ok(by_point)
    }
}

impl Part {
    fn none(pass: &Pass) -> Self {
        let pulls = pass.all.iter().map(|seen| vec![Pull::ZERO; seen.drives.len()]).collect();
        Self { value: Vec::new(), points: Vec::new(), pulls, by_k: 0.0, by_speed: 0.0 }
    }

    /// Adds the sums of another block.
    fn add(&mut self, other: &Self) {
        let all = self.pulls.iter_mut().zip(&other.pulls);
        all.for_each(|(pulls, others)| pulls.iter_mut().zip(others).for_each(|(pull, other)| pull.add(other)));
        self.by_k += other.by_k;
        self.by_speed += other.by_speed;
    }
}

#[cfg(test)]
#[path = "tests/gradient.rs"]
mod tests;
