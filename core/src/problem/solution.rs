//! Solution: a drive that the board can play, its pressures, status and metrics.

use crate::error::{one_each, real};
use crate::linalg::Planar;
use crate::prelude::*;
use crate::problem::Problem;
use crate::problem::array_request::ArrayRequest;
use crate::problem::metrics::Metrics;
use crate::problem::setup::Setup;
use crate::problem::status::Status;
use crate::propagation::{Propagation, field_of};
use crate::scene::{Extras, Request, Scene, check_drive};
use crate::workspace::Workspace;

/// Returns z / factor. Multiplies by the reciprocal in double precision.
pub(super) fn divided(z: Complex32, factor: f64) -> Complex32 {
    let reciprocal = 1.0 / factor;
    let part = |x: f32| (f64::from(x) * reciprocal) as f32;
    Complex32::new(part(z.re), part(z.im))
}

/// A drive and its pressures at the points.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solution {
    /// Drives q (N,), |q| <= 1, after [`crate::solve`]. Within a solver there is one for each column of the propagation matrix
    /// G.
    pub drive: Vec<Complex32>,
    /// Complex pressures (M,) in Pa (peak) at all of the caller's points, computed in f32. With a signature they are the
    /// pressures sum G s q of the foci before they become traps; [`crate::field()`] computes the real ones.
    pub pressures: Vec<Complex32>,
    /// The status at the end of the solve.
    pub status: Status,
    /// The number of steps taken.
    pub steps: usize,
    /// The factor, at most 1, that the supply voltage or a modulation must apply to all drives. It is below 1 if the device has
    /// no amplitude for the solution. The pressures include it, the drives do not.
    pub scale: f64,
    /// Whether all drives are known to be ones that the board can play.
    pub(super) on_grid: bool,
    pub(super) request: Arc<ArrayRequest>,
}

impl Solution {
    /// Restores a solution from a file, another process or a batch. `targets` (M,) in Pa replace the targets that this machine
    /// computes.
    ///
    /// # Errors
    /// Lists of another length, a value that is not finite, |q| above 1 + 1e-6, a scale outside of 0 to 1; pressures that the
    /// drive does not give; a stop by the caller.
    pub fn restored(
        problem: &Problem,
        drive: Vec<Complex32>,
        pressures: Vec<Complex32>,
        (status, steps, scale): (Status, usize, f64),
        targets: Option<Vec<f64>>,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let mut request = Arc::clone(&problem.targets);
        let points = request.pascals.len();
        let columns = request.setup.columns(&drive, request.propagation.transducers())?;
        one_each("pressures", pressures.len(), "values", points, "points")?;
        real("scale", scale, 0.0, true)?;
        if scale > 1.0 {
            return Err(Error::out_of_range("scale", scale, "give at most 1"));
        }
        if let Some(targets) = targets {
            Request { pressures: Some(targets.clone()), ..Request::default() }.check(points)?;
            Arc::make_mut(&mut request).pascals = targets;
        }
        let work = Workspace::new();
        let field = field_of(&request.propagation, &columns, &work, control)?;
        let unit = request.propagation.reference();
        let mut reach = vec![f64::INFINITY; points];
        request.active.iter().zip(&problem.reach).for_each(|(&j, &most)| reach[j] = most * unit);
        for (j, &pressure) in pressures.iter().enumerate() {
            let gap = math::modulus(pressure - pascals(field.re[j], field.im[j], unit * scale));
            // The tolerance is far above the differences between orders of summation, kernels and instruction sets.
            if !gap.is_finite() || gap > 1e-3 * reach[j] {
                return Err(Error::invalid(format!("pressures[{j}]"), pressure, "the drive gives another one"));
            }
        }
        Ok(Self { drive, pressures, status, steps, scale, on_grid: false, request })
    }

    /// Returns the solution with this drive. A solver calls this at its end, with its status, the number of its last step and
    /// the number of `steps`. Computes the pressures and reports the last step.
    ///
    /// # Errors
    /// A stop by the caller, unless it was noticed before.
    pub fn new(
        problem: &Problem,
        drive: Vec<Complex32>,
        (status, step): (Status, usize),
        steps: usize,
        work: &Workspace,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let request = Arc::clone(&problem.targets);
        let field = field_of(&request.propagation, &drive, work, control)?;
        let mut solution = Self::with_pressures(request, drive, &field, status, step, work);
        solution.tell(problem, steps, control);
        Ok(solution)
    }

    /// Does the same as [`Solution::new`] for a drive that has not been checked; the solution counts one step. Transducers
    /// without effect get drive 0.
    ///
    /// # Errors
    /// A drive of another length, a value that is not finite, |q| above 1 + 1e-6; a stop by the caller.
    pub fn checked(
        problem: &Problem,
        mut drive: Vec<Complex32>,
        work: &Workspace,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let propagation = problem.propagation();
        let [mut re, mut im] = [(); 2].map(|()| work.floats.take(propagation.lanes()));
        for (i, q) in drive.iter_mut().enumerate().take(propagation.transducers()) {
            control.pulse()?;
            propagation.row(i, &mut re, &mut im);
            if re.iter().chain(&*im).all(|&g| g == 0.0) {
                *q = Complex32::ZERO;
            }
        }
        check_drive(&drive, propagation.transducers())?;
        Self::new(problem, drive, (Status::Done, 1), 1, work, control)
    }

    /// The all-zero solution, returned when stopped before the first result.
    pub(crate) fn silent(problem: &Problem, work: &Workspace) -> Self {
        let request = Arc::clone(&problem.targets);
        let drive = work.complexes.take(request.propagation.transducers()).into_vec();
        let field = Planar::zeros(1, request.propagation.lanes(), work);
        Self::with_pressures(request, drive, &field, Status::Stopped, 0, work)
    }

    /// Does the same as [`Solution::new`] with a known field at the problem's points, one padded row.
    pub(crate) fn of_field(
        problem: &Problem,
        drive: Vec<Complex32>,
        field: &Planar,
        status: Status,
        steps: usize,
        work: &Workspace,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let request = Arc::clone(&problem.targets);
        if problem.is_stretched() {
            // The solver's field belongs to rescaled rows of the propagation matrix G, so it is computed again.
            let field = field_of(&request.propagation, &drive, work, control)?;
            return Ok(Self::with_pressures(request, drive, &field, status, steps, work));
        }
        if request.active.len() == request.pascals.len() {
            return Ok(Self::with_pressures(request, drive, field, status, steps, work));
        }
        // The solver's field lacks the points of weight 0, so the field is computed again.
        let all = field_of(&request.propagation, &drive, work, control)?;
        let mut solution = Self::with_pressures(request, drive, &all, status, steps, work);
        let reference = problem.propagation().reference();
        for (k, &j) in solution.request.active.iter().enumerate() {
            solution.pressures[j] = pascals(field.re[k], field.im[k], reference);
        }
        Ok(solution)
    }

    pub(super) fn with_pressures(
        request: Arc<ArrayRequest>,
        drive: Vec<Complex32>,
        field: &Planar,
        status: Status,
        steps: usize,
        work: &Workspace,
    ) -> Self {
        let pressures = work.complexes.take(request.propagation.points()).into_vec();
        let mut solution = Self { drive, pressures, status, steps, scale: 1.0, on_grid: false, request };
        solution.set_pressures(field);
        solution
    }

    /// Sets the pressures to a field in units of the reference.
    pub(super) fn set_pressures(&mut self, field: &Planar) {
        let reference = self.request.propagation.reference() * self.scale;
        for ((pressure, re), im) in self.pressures.iter_mut().zip(&field.re).zip(&field.im) {
            *pressure = pascals(*re, *im, reference);
        }
    }

    /// Returns the solution with one drive for each transducer (N,) instead of each channel.
    pub(crate) fn spread(mut self) -> Self {
        if let Some(channels) = &self.request.setup.channels {
            self.drive = channels.spread(&self.drive);
        }
        self
    }

    /// Returns the solution with a further factor `scale`, which supply or modulation must apply.
    pub(crate) fn scaled(mut self, scale: f64) -> Self {
        self.scale *= scale;
        self.pressures.iter_mut().for_each(|p| *p = divided(*p, 1.0 / scale));
        self
    }

    /// Returns the metrics of the pressures for the caller's targets, computed in f64.
    pub fn metrics(&self) -> Metrics {
        self.request.metrics(self.pressures.iter().map(|&p| math::modulus(p)))
    }

    /// The relative error of the complex pressures, sqrt(sum w |p_j - target_j|^2 / sum w |target_j|^2) over the points of
    /// weight above 0; `None` if the phases of the targets are free.
    pub fn complex_error(&self) -> Option<f64> {
        self.request.complex_error(&self.pressures)
    }

    /// Reports the last of `steps` steps to `control`, with the residual of the solution itself: the steps of a solver may have
    /// reported only estimates. A request to stop that arrives now still changes the status. Without steps, nothing is
    /// reported.
    pub(crate) fn tell(&mut self, problem: &Problem, steps: usize, control: &mut Control) {
        if self.status == Status::Stopped {
            control.correct(|| self.residual_for(problem));
        } else if self.steps > 0 && control.step(self.steps, steps, || self.residual_for(problem)).is_break() {
            self.status = Status::Stopped;
        }
    }

    /// Replaces the residual of the last reported step by that of the solution itself.
    pub(crate) fn correct(&self, problem: &Problem, control: &mut Control) {
        control.correct(|| self.residual_for(problem));
    }

    /// The drives (N,) times `scale`, as the transducers play them.
    pub fn played(&self) -> Vec<Complex32> {
        self.drive.iter().map(|&q| divided(q, 1.0 / self.scale)).collect()
    }

    /// Returns the memory to the workspace for the next solve.
    pub fn recycle(self, work: &Workspace) {
        work.complexes.give(self.drive);
        work.complexes.give(self.pressures);
    }

    /// The residual against the targets of `problem`, which may be balanced.
    fn residual_for(&self, problem: &Problem) -> f64 {
        if problem.is_stretched() {
            return self.request.metrics(self.pressures.iter().map(|&p| math::modulus(p) / problem.factor())).residual;
        }
        let unit = self.request.propagation.reference();
        problem.residual_of(self.request.active.iter().map(|&j| math::modulus(self.pressures[j]) / unit))
    }

    /// Returns the propagation matrix G, the setup of its array, and the request.
    pub fn requested(&self) -> (&Propagation, &Setup, Request) {
        (&self.request.propagation, &self.request.setup, self.request.request())
    }

    /// Returns the scene of the solution, without a file's solver and plane. `None` if the user gave the propagation matrix G.
    pub fn scene(&self) -> Option<Scene> {
        let ArrayRequest { propagation, setup, .. } = &*self.request;
        let (array, points, recipe) = propagation.origin()?;
        let scene = Scene::new(array.clone(), setup.medium, points.to_vec(), self.request.request()).ok()?;
        let obstacles = recipe.and_then(|from| from.scattering.as_ref()).map_or(&[][..], |all| all.obstacles.list());
        let extras = Extras {
            signature: recipe.and_then(|recipe| recipe.signature.clone()),
            bead: setup.bead,
            obstacles: obstacles.to_vec(),
            solver: None,
            plane: None,
        };
        scene.with_extras(extras).ok()
    }

    /// The targets (M,) in Pa that the metrics refer to.
    pub fn targets(&self) -> &[f64] {
        &self.request.pascals
    }

    /// Radiation pressure in Pa at point `j`, |p|^2/(rho c^2).
    ///
    /// # Panics
    /// If there is no such point.
    pub fn radiation(&self, j: usize) -> f64 {
        self.request.setup.medium.radiation(math::modulus(self.pressures[j]))
    }

    /// The amplitude |q_i|, 0 to 1.
    ///
    /// # Panics
    /// If there is no such transducer.
    pub fn amplitude(&self, i: usize) -> f64 {
        math::modulus(self.drive[i]).min(1.0)
    }

    /// The phase of q_i in rad in [0, 2 pi); 0 where q_i = 0.
    ///
    /// # Panics
    /// If there is no such transducer.
    pub fn phase(&self, i: usize) -> f64 {
        math::phase(self.drive[i])
    }
}

/// Compares the values of requests and results.
impl PartialEq for Solution {
    fn eq(&self, other: &Self) -> bool {
        let reported = |solution: &Self| (solution.status, solution.steps, solution.scale);
        let (request, others) = (&self.request, &other.request);
        reported(self) == reported(other)
            && self.drive == other.drive
            && self.pressures == other.pressures
            && request.pascals == others.pascals
            && request.phases == others.phases
            && request.weights == others.weights
            && request.propagation == others.propagation
            && request.setup == others.setup
    }
}

/// Converts a pressure from units of the reference to Pa.
fn pascals(re: f32, im: f32, reference: f64) -> Complex32 {
    Complex32::new((f64::from(re) * reference) as f32, (f64::from(im) * reference) as f32)
}
