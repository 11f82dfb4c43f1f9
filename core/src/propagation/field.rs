//! Field p = G q of a drive, at any points or at those of a problem; the loop is `kernels/propagate/field.rs`.

use crate::kernels;
use crate::kernels::{ControlPoints, InstructionSet, Rows, padded};
use crate::linalg::Planar;
use crate::prelude::*;
use crate::propagation::scattering::bodies::Bodies;
use crate::propagation::{Model, Propagation};
use crate::scene::{check_drive, check_places};
use crate::workspace::Workspace;

/// How many points a thread computes together.
const CHUNK: usize = 256;

/// How many entries of the propagation matrix G a thread computes between two reports of progress: some milliseconds of work.
const STRETCH: usize = 1 << 21;

/// Returns the complex pressures (P,) in Pa (peak) of a drive (N,) at any `points` (P, 3) in m: p = G q.
///
/// A point nearer to a transducer than a hundredth of the wavelength counts as that far away, so that a picture is always
/// finite. Inside an obstacle the pressure is 0. The threads of `control` share the points; the result does not depend on
/// their number.
///
/// # Errors
/// A drive that does not fit the array, no points, a coordinate that is not finite or too far away; more memory than
/// allowed; a stop by the caller.
///
/// ```
/// use midair::{Array, Complex32, Control, InstructionSet, Medium, Model, Plane};
///
/// let model = Model::new(&Array::grid(1, 1, 10e-3)?, Medium::default(), InstructionSet::best())?;
/// let plane = Plane::new(0.1, 0.04, 3, [0.0, 0.0])?;
/// let pressure = midair::field(&model, &[Complex32::ONE], &plane.points(), &mut Control::none())?;
/// assert!((pressure[4].norm() - 4.386 / 0.1).abs() < 1e-4);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn field(model: &Model, drive: &[Complex32], points: &[[f64; 3]], control: &mut Control) -> Result<Vec<Complex32>> {
    let (array, medium) = (model.array(), model.medium());
    check_drive(drive, array.len())?;
    refuse_if!(points.is_empty(), Error::missing("field points", "empty", "give at least one point"));
    check_places(array.centre(), medium, "field points", "", points)?;
    if let Some(scattering) = &model.scattering {
        scattering.check()?;
    }
    control.room("the field", [array.len(), points.len()], bytes(8, &[points.len()]))?;
    let mut pressures = vec![Complex32::ZERO; points.len()];
    let cost = model.scattering.as_ref().map_or(1, |scattering| scattering.cost());
    let share = CHUNK * (STRETCH / (CHUNK * array.len() * cost)).max(1);
    let stretch = share * control.threads();
    let bodies = model.scattering.as_ref().and_then(|scattering| scattering.bodies.as_deref());
    let bodies = bodies.map(|bodies| (bodies, bodies.driven(&model.sources, drive)));
    let bodies = bodies.as_ref().map(|(bodies, driven)| (*bodies, &driven[..]));
    let steps = points.len().div_ceil(stretch);
    for (step, (out, points)) in pressures.chunks_mut(stretch).zip(points.chunks(stretch)).enumerate() {
        let parts = out.chunks_mut(share).zip(points.chunks(share)).collect();
        control.each(parts, &|(out, points): (&mut [Complex32], &[[f64; 3]]), control| {
            let chunks = out.chunks_mut(CHUNK).zip(points.chunks(CHUNK));
            chunks.into_iter().try_for_each(|(out, points)| chunk(model, drive, bodies, points, out, control))
        })?;
        refuse_if!(control.step(step + 1, steps, || 0.0).is_break(), Error::stopped());
    }
    Ok(pressures)
}

/// The propagation matrix G at fixed points, stored for many drives: each field is then a matrix product, much faster than
/// [`field`].
#[derive(Clone, Debug)]
pub struct FieldMatrix {
    /// Real and imaginary part of the padded rows, one row for each transducer, in units of `reference`.
    planes: [Vec<f32>; 2],
    points: usize,
    transducers: usize,
    reference: f64,
    set: InstructionSet,
}

impl FieldMatrix {
    /// Computes and stores the propagation matrix G (N, P), 8 bytes for each entry, at any `points` (P, 3) in m of a model
    /// without obstacles.
    ///
    /// # Errors
    /// The errors of [`field`]; a model with obstacles, which add other waves.
    ///
    /// ```
    /// use midair::{Array, Complex32, Control, InstructionSet, FieldMatrix, Medium, Model, Plane};
    ///
    /// let model = Model::new(&Array::grid(2, 1, 10e-3)?, Medium::default(), InstructionSet::best())?;
    /// let plane = Plane::new(0.1, 0.04, 3, [0.0, 0.0])?;
    /// let matrix = FieldMatrix::new(&model, &plane.points(), &mut Control::none())?;
    /// let drive = [Complex32::ONE, Complex32::I];
    /// let pressure = midair::field(&model, &drive, &plane.points(), &mut Control::none())?;
    /// for (product, p) in matrix.field(&drive, &mut Control::none())?.iter().zip(pressure) {
    ///     assert!((product - p).norm() < 1e-3);
    /// }
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn new(model: &Model, points: &[[f64; 3]], control: &mut Control) -> Result<Self> {
        if model.scattering.is_some() {
            return Err(Error::conflict("obstacles", "given", "ask for the field of each drive"));
        }
        refuse_if!(points.is_empty(), Error::missing("field points", "empty", "give at least one point"));
        let (array, set) = (model.array(), model.set);
        check_places(array.centre(), model.medium(), "field points", "", points)?;
        let propagation = Propagation::at(Arc::clone(&model.sources), points.into(), set);
        let (transducers, lanes) = (array.len(), propagation.lanes());
        control.room("the matrix G", [transducers, points.len()], bytes(8, &[transducers, lanes]))?;
        let [mut re, mut im] = [(); 2].map(|()| vec![0.0; transducers * lanes]);
        for (i, (re, im)) in re.chunks_mut(lanes).zip(im.chunks_mut(lanes)).enumerate() {
            control.pulse()?;
            propagation.row(i, re, im);
        }
        let reference = propagation.reference();
        Ok(Self { planes: [re, im], points: points.len(), transducers, reference, set })
    }

    /// Complex pressures (P,) in Pa of a drive (N,).
    ///
    /// # Errors
    /// A drive that does not fit the array; a stop by the caller.
    pub fn field(&self, drive: &[Complex32], control: &mut Control) -> Result<Vec<Complex32>> {
        check_drive(drive, self.transducers)?;
        let [all_re, all_im] = &self.planes;
        let lanes = all_re.len() / self.transducers;
        let [mut re, mut im] = [(); 2].map(|()| vec![0.0; lanes]);
        let rows = Rows::Stored { re: all_re, im: all_im };
        kernels::add_waves(self.set, rows, drive, [&mut re, &mut im], control)?;
        let scale = |x: f32| (f64::from(x) * self.reference) as f32;
        Ok(re.iter().zip(&im).take(self.points).map(|(re, im)| Complex32::new(scale(*re), scale(*im))).collect())
    }
}

/// Computes the field at one chunk of points.
fn chunk(
    model: &Model,
    drive: &[Complex32],
    bodies: Option<(&Bodies, &[Complex64])>,
    points: &[[f64; 3]],
    out: &mut [Complex32],
    control: &mut Control,
) -> Result<()> {
    let [mut re, mut im] = [(); 2].map(|()| vec![0.0; padded(points.len())]);
    let images = model.scattering.as_ref().map_or(&[][..], |scattering| &scattering.images);
    for sources in core::iter::once(&*model.sources).chain(images) {
        let [x, y, z] = &sources.frame(points);
        let control_points = ControlPoints { coordinates: [x, y, z], count: points.len() };
        let (transducers, into) = (&sources.transducers, [&mut re[..], &mut im[..]]);
        kernels::add_field(model.set, &sources.radiation, transducers, drive, control_points, into, control)?;
    }
    let scale = |x: f32| (f64::from(x) * model.sources.reference()) as f32;
    for (out, (re, im)) in out.iter_mut().zip(re.iter().zip(&im)) {
        *out = Complex32::new(scale(*re), scale(*im));
    }
    let Some(scattering) = &model.scattering else { return Ok(()) };
    let mut row = Vec::new();
    for (out, &point) in out.iter_mut().zip(points) {
        if scattering.obstacles.around(point).is_some() {
            *out = Complex32::ZERO;
        } else if let Some((bodies, driven)) = bodies {
            control.pulse()?;
            let p = bodies.pressure(driven, point, &mut row);
            *out += Complex32::new(p.re as f32, p.im as f32);
        }
    }
    Ok(())
}

/// Returns the field p = G q of a drive at the points of a problem: one padded row, in units of the reference. Rows of the
/// propagation matrix G are computed on the way and not stored.
pub(crate) fn field_of<'w>(
    propagation: &Propagation,
    drive: &[Complex32],
    work: &'w Workspace,
    control: &mut Control,
) -> Result<Planar<'w>> {
    let mut field = Planar::zeros(1, propagation.lanes(), work);
    let into = [&mut field.re[..], &mut field.im[..]];
    kernels::add_waves(propagation.instruction_set(), propagation.rows(), drive, into, control)?;
    Ok(field)
}
