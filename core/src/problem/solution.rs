//! Solution: a drive that the board can play, its pressures, status and metrics; how it is judged, lowered and rounded.

use crate::kernels;
use crate::linalg::Planar;
use crate::prelude::*;
use crate::problem::array_request::ArrayRequest;
use crate::problem::mix::{ALIKE, mix};
use crate::problem::{Metrics, Problem, Setup, Status};
use crate::propagation::forces::rest::trapped;
use crate::propagation::{Model, Propagation, field_of};
use crate::scene::{Extras, Request, Scene, Signature, check_drive, words};
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
    ) -> Result<Self> {
        let mut request = Arc::clone(&problem.targets);
        let points = request.pascals.len();
        let columns = request.setup.columns(&drive, request.propagation.transducers())?;
        one_each("pressures", pressures.len(), "values", points, "points")?;
        real("scale", scale, 0.0, true)?;
        refuse_if!(scale > 1.0, Error::out_of_range("scale", scale, "give at most 1"));
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
    ) -> Result<Self> {
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
    ) -> Result<Self> {
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
    ) -> Result<Self> {
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

    /// Returns how many traps hold their bead, as [`crate::rest`] judges it, and the number of traps. `None` without named
    /// traps, for a user's own propagation matrix G, and where the force on a bead is unknown.
    ///
    /// # Errors
    /// More memory than allowed; a stop by the caller.
    pub fn beads(&self, control: &mut Control) -> Result<Option<[usize; 2]>> {
        let ArrayRequest { propagation, setup, active, pascals, .. } = &*self.request;
        let kept = propagation.origin().and_then(|(.., kept)| kept);
        let Some((kept, signature)) = kept.and_then(|kept| Some((kept, kept.signature.as_ref()?))) else {
            return Ok(None);
        };
        let named = |&j: &usize| !matches!(signature.of(j), Signature::Focus | Signature::Given(_));
        let mut traps: Vec<usize> = active.iter().copied().filter(named).collect();
        // Traps beside foci have the target 0; beside other traps a target of 0 is silence.
        if traps.iter().any(|&j| pascals[j] > 0.0) {
            traps.retain(|&j| pascals[j] > 0.0);
        }
        let places: Vec<[f64; 3]> = traps.iter().map(|&j| kept.points[j]).collect();
        match trapped(&Model::of_recipe(kept), &self.played(), &places, setup.bead, control) {
            Ok(all) => Ok(Some([all.iter().filter(|&&one| one).count(), all.len()])),
            Err(error) if error.is_stop() || error.code == ErrorCode::Memory => Err(error),
            Err(_) => Ok(None),
        }
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

getters! {
    Solution:

    /// Returns the metrics of the pressures for the caller's targets, computed in f64.
    pub metrics(self) -> Metrics = self.request.metrics(self.pressures.iter().map(|&p| math::modulus(p)));

    /// The relative error of the complex pressures, sqrt(sum w |p_j - target_j|^2 / sum w |target_j|^2) over the points of
    /// weight above 0; `None` if the phases of the targets are free.
    pub complex_error(self) -> Option<f64> = self.request.complex_error(&self.pressures);

    /// The drives (N,) times `scale`, as the transducers play them.
    pub played(self) -> Vec<Complex32> = self.drive.iter().map(|&q| divided(q, 1.0 / self.scale)).collect();

    /// Returns the propagation matrix G, the setup of its array, and the request.
    pub requested(self) -> (&Propagation, &Setup, Request) =
        (&self.request.propagation, &self.request.setup, self.request.request());

    /// The targets (M,) in Pa that the metrics refer to.
    pub targets(self) -> &[f64] = &self.request.pascals;
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

impl Solution {
    /// Lowers the full drives of a problem to the part `factor` by a mix of two amplitudes of its board, if that is more
    /// accurate than one amplitude; else returns `None`. `field` is the field of the drives at the problem's points, if it is
    /// known.
    pub(crate) fn mixed<'w>(
        problem: &Problem,
        drive: &mut Vec<Complex32>,
        (factor, field): (f64, Option<Planar<'w>>),
        (status, steps): (Status, usize),
        work: &'w Workspace,
        control: &mut Control,
    ) -> Option<Self> {
        let request = Arc::clone(&problem.targets);
        let whole = !problem.is_stretched() && request.active.len() == request.pascals.len();
        let field = mix(&request, drive, 1.0, factor, field.filter(|_| whole), work, control)?;
        Some(Self::with_pressures(request, core::mem::take(drive), &field, status, steps, work))
    }

    /// Marks all drives as drives that the board can play. Boards with ticks of unequal length are an exception: their pulses
    /// are still rounded at the end.
    pub(crate) fn on_grid(self) -> Self {
        let on_grid = self.request.setup.quantization.as_deref().is_none_or(|board| board.uneven().is_none());
        Self { on_grid, ..self }
    }

    /// Divides drives and pressures by `factor`, which is at least 1, and rounds each drive to one that the board can play.
    /// Returns whether a drive changed.
    ///
    /// # Errors
    /// A stop by the caller, unless it was noticed before.
    pub(crate) fn quantize(&mut self, factor: f64, work: &Workspace, control: &mut Control) -> Result<bool> {
        let Some(quantization) = self.request.setup.quantization.as_deref() else {
            if factor > 1.0 {
                for list in [&mut self.drive, &mut self.pressures] {
                    for z in list {
                        *z = divided(*z, factor);
                    }
                }
            }
            return Ok(false);
        };
        if self.on_grid && factor == 1.0 {
            return Ok(false);
        }
        let set = self.request.propagation.instruction_set();
        let [least, largest] = kernels::grid::range(set, &self.drive);
        let of_one = self.request.given && least > largest * (1.0 - ALIKE);
        let largest = f64::from(largest) / factor;
        let scale = quantization.scale(largest);
        // Pulses of equal ticks include all phases and amplitudes of the grid. If full drives are lowered, they are rounded to
        // the grid below, because its phases are possible at every amplitude.
        let lowered = self.on_grid || of_one && quantization.between(largest).is_some();
        if let Some(pulses) = if lowered { quantization.uneven() } else { quantization.pulses() } {
            let stayed = pulses.round((factor * scale) as f32, &mut self.drive);
            self.scale *= scale;
            if !stayed {
                self.set_pressures(&field_of(&self.request.propagation, &self.drive, work, control)?);
            }
            return Ok(!stayed);
        }
        // If all drives had full amplitude and phases of the board, they now have one common amplitude: the field is only
        // scaled.
        let most = (largest / scale) as f32;
        let common = quantization.nearest(Complex32::new(most, 0.0)).re;
        let alike = quantization.grid().round(set, (factor * scale) as f32, [most, common], &mut self.drive);
        let q = f64::from(common);
        let known = (alike && of_one).then(|| self.field(q, work));
        self.scale *= scale;
        let mixed = if of_one { mix(&self.request, &mut self.drive, q, largest, known, work, control) } else { None };
        if let Some(field) = &mixed {
            self.set_pressures(field);
        } else if !alike {
            self.set_pressures(&field_of(&self.request.propagation, &self.drive, work, control)?);
        } else if common != 1.0 || scale != 1.0 {
            let change = f64::from(common) * scale;
            self.pressures.iter_mut().for_each(|p| *p = divided(*p, 1.0 / change));
        }
        Ok(mixed.is_some() || !alike || common != 1.0)
    }

    /// Returns the field of the solution's pressures multiplied by `times`, in units of the reference: one padded row.
    fn field<'w>(&self, times: f64, work: &'w Workspace) -> Planar<'w> {
        let propagation = &self.request.propagation;
        let mut field = Planar::zeros(1, propagation.lanes(), work);
        let unit = propagation.reference() * self.scale / times;
        for (pressure, (re, im)) in self.pressures.iter().zip(field.re.iter_mut().zip(&mut *field.im)) {
            let relative = divided(*pressure, unit);
            (*re, *im) = (relative.re, relative.im);
        }
        field
    }
}

/// Quiet points are reported if their leak exceeds the allowed leak by this factor. A solver checks only some points
/// of a crowd of quiet points. Between the checked points, the leak is up to three times as large.
const LOUD: f64 = 4.0;

/// Targets count as missed from this relative error on.
pub(crate) const MISS: f64 = 0.01;

/// The precision in which metrics are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Single precision, the rows of the solvers: |p| is accurate to 1e-4 of the pressure of all transducers at a point.
    #[default]
    Single,
    /// Double precision: a hundred times as slow.
    Double,
}

words!(Precision: "single" = Self::Single, "double" = Self::Double);

impl Problem {
    /// Returns the relative error of a solution if it exceeds 1 %. Returns `None` if targets were not given or are not the
    /// aim, or if the solve was stopped. Quiet points may leak the part `quiet` of the largest target.
    pub(crate) fn missed(&self, quiet: Option<f64>, solution: &Solution) -> Option<f64> {
        let requested = self.holds_pressures() && solution.status != Status::Stopped;
        let miss = if requested { self.miss(solution, quiet.unwrap_or(0.0)) } else { 0.0 };
        (miss > MISS).then_some(miss)
    }

    /// Returns the leak at quiet points, see [`Problem::weighted_leak`], if it is much larger than the allowed part `quiet`.
    pub(crate) fn leaks(&self, quiet: f64, solution: &Solution) -> Option<f64> {
        let leak = self.weighted_leak(&solution.pressures);
        (solution.status != Status::Stopped && leak >= LOUD * quiet && leak > 0.0).then_some(leak)
    }

    /// Returns the relative error of a solution, sqrt(sum w (target - |p|)^2 / sum w target^2) over the points of weight above
    /// 0. At a quiet point only the leak above `quiet` times the largest target counts.
    pub(crate) fn miss(&self, solution: &Solution, quiet: f64) -> f64 {
        let ArrayRequest { active, pascals, weights, .. } = &*self.targets;
        // Pressures are divided by the largest target, so that no square of a finite number overflows.
        let largest = active.iter().fold(0.0, |most: f64, &j| most.max(pascals[j]));
        let heaviest = active.iter().fold(0.0, |most: f64, &j| most.max(weights[j]));
        let (mut miss, mut all) = (0.0, 0.0);
        for &j in active {
            let (weight, target) = (self.targets.counted(j) / heaviest, pascals[j] / largest);
            let gap = (math::modulus(solution.pressures[j]) / largest - target).abs();
            let gap = if target > 0.0 { gap } else { (gap - quiet).max(0.0) };
            miss += weight * gap * gap;
            all += weight * target * target;
        }
        if all > 0.0 { math::sqrt(miss / all) } else { 0.0 }
    }

    /// Returns the largest leak of a quiet point, times its weight over the largest weight of a target, relative to the loudest
    /// point with a target. `pressures` are those at all points of the caller.
    pub(crate) fn weighted_leak(&self, pressures: &[Complex32]) -> f64 {
        let ArrayRequest { active, pascals, weights, .. } = &*self.targets;
        let modulus = |j: &&usize| math::modulus(pressures[**j]);
        let quiet = active.iter().filter(|&&j| pascals[j] == 0.0);
        let targeted = active.iter().filter(|&&j| pascals[j] > 0.0);
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let leak = most(&mut quiet.map(|j| modulus(&j) * self.targets.counted(*j)));
        let heaviest = most(&mut targeted.clone().map(|j| weights[*j]));
        let loudest = most(&mut targeted.map(|j| modulus(&j)));
        if leak == 0.0 { 0.0 } else { leak / heaviest / loudest }
    }

    /// Returns the residual of a field against this problem's targets. `moduli` are |p| in units of the reference.
    pub fn residual(&self, moduli: &[f32]) -> f64 {
        self.residual_of(moduli.iter().map(|&modulus| f64::from(modulus)))
    }

    /// Does the same as [`Problem::residual`] for moduli in double precision.
    pub(crate) fn residual_of(&self, moduli: impl Iterator<Item = f64> + Clone) -> f64 {
        let requested = self.scaled.iter().zip(self.weights());
        Metrics::of(moduli.zip(requested).map(|(p, (&t, &w))| (p, f64::from(t), f64::from(w)))).residual
    }

    /// Returns the metrics of a drive (N,) over the caller's points.
    ///
    /// # Errors
    /// A drive of another length, a value that is not finite, |q| above 1 + 1e-6, two different drives on one channel; a stop.
    pub fn judge(&self, drive: &[Complex32], precision: Precision, control: &mut Control) -> Result<Metrics> {
        match precision {
            Precision::Single => {
                let drive = self.setup().columns(drive, self.propagation().transducers())?;
                let work = Workspace::new();
                let field = field_of(self.propagation(), &drive, &work, control)?;
                Ok(self.metrics_of(field.re.iter().zip(&field.im)))
            }
            Precision::Double => Ok(self.targets.metrics(self.pressures(drive, control)?.iter().map(|p| p.norm()))),
        }
    }

    /// Returns the metrics of a field at the points of weight above 0, in units of the reference.
    pub(crate) fn metrics_of<'a>(&self, field: impl Iterator<Item = (&'a f32, &'a f32)> + Clone) -> Metrics {
        let ArrayRequest { active, pascals, propagation, .. } = &*self.targets;
        let unit = propagation.reference();
        let point = |((&re, &im), &j): ((&f32, &f32), &usize)| {
            (math::modulus(Complex32::new(re, im)) * unit, pascals[j], self.targets.counted(j))
        };
        Metrics::of(field.zip(active).map(point))
    }

    /// Returns the pressures (M,) in Pa of a drive (N,) at the caller's points, in double precision. With a signature they are
    /// those of its foci, as in a solution.
    ///
    /// # Errors
    /// A drive of another length, a value that is not finite, |q| above 1 + 1e-6, two different drives on one channel; a stop.
    pub fn pressures(&self, drive: &[Complex32], control: &mut Control) -> Result<Vec<Complex64>> {
        let drive = self.setup().columns(drive, self.propagation().transducers())?;
        let all = &self.targets.propagation;
        let wide = |q: Complex32| Complex64::new(f64::from(q.re), f64::from(q.im));
        let pressure = |j: usize| {
            let mut sum = Complex64::ZERO;
            for (i, &q) in drive.iter().enumerate() {
                control.pulse()?;
                sum += all.exact(j, i) * wide(q);
            }
            Ok(sum)
        };
        (0..all.points()).map(pressure).collect()
    }
}
