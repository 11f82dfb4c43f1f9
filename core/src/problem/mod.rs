//! Problem: propagation matrix G, targets and weights of the points of weight above 0, relative to the reference pressure.

pub(crate) mod array_request;
pub(crate) mod complex_targets;
pub(crate) mod feasibility;
pub(crate) mod metrics;
pub(crate) mod mix;
pub(crate) mod optimum;
pub(crate) mod range;
pub(crate) mod solution;
pub(crate) mod status;
pub(crate) mod upper_bound;

pub use array_request::Setup;
pub use feasibility::{Beyond, Reach};
pub use metrics::Metrics;
pub use solution::{Precision, Solution};
pub use status::Status;
pub use upper_bound::bound;

use crate::device::quantization::Quantization;
use crate::kernels::{InstructionSet, Rows};
use crate::prelude::*;
use crate::problem::array_request::ArrayRequest;
use crate::propagation::reach::Amplitudes;
use crate::propagation::{Model, Propagation};
use crate::scene::{Aim, Request, Scene, Start};
use crate::workspace::Workspace;

/// A checked problem, which can be solved.
///
/// A clone copies only the targets; all other data are shared.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The propagation matrix G at the points of weight above 0. `None` if all points have such a weight and no row of G is
    /// rescaled.
    selected: Option<Propagation>,
    /// The propagation matrix G at these points before rows were rescaled to the range of f32; `None` if no row was rescaled.
    plain: Option<Propagation>,
    /// Targets and weights of all points, in Pa.
    targets: Arc<ArrayRequest>,
    start: Option<Arc<Start>>,
    pub(crate) aim: Option<Aim>,
    /// The ratio of this problem's targets to the caller's targets: 1 except for the balanced problem.
    factor: f64,
    /// Targets of the points of weight above 0, in units of the reference, padded with zeros.
    scaled: Vec<f32>,
    /// p1_j, the sum of |G_ji| over all transducers, for the points of weight above 0, in units of the reference.
    pub(crate) reach: Vec<f64>,
    /// The amplitudes of the propagation matrix G that were computed for `reach`, if they are stored.
    amplitudes: Amplitudes,
}

impl Problem {
    /// Returns the problem of a scene.
    ///
    /// # Errors
    /// A point on a transducer, or one with a pressure above 0 that no transducer reaches.
    pub fn new(scene: &Scene) -> Result<Self> {
        Self::with_instruction_set(scene, InstructionSet::best())
    }

    /// Returns the problem of a scene, whose kernels use this instruction set instead of the machine's best.
    ///
    /// # Errors
    /// The errors of [`Problem::new`].
    pub fn with_instruction_set(scene: &Scene, set: InstructionSet) -> Result<Self> {
        Self::of_scene(scene, set, &mut Control::none())
    }

    /// Does the same as [`Problem::with_instruction_set`], with a control for long computations: the sums of |G| take time O(N
    /// M).
    ///
    /// # Errors
    /// The errors of [`Problem::new`], and a stop by the caller.
    pub fn of_scene(scene: &Scene, set: InstructionSet, control: &mut Control) -> Result<Self> {
        Self::of_model(&Model::of(scene, set), scene.points(), scene.request(), control)
    }

    /// Does the same as [`Problem::of_scene`] for a prepared model and other points.
    ///
    /// # Errors
    /// The errors of [`Problem::of_scene`], and those of [`Scene::new`] for points and request.
    pub fn of_model(model: &Model, points: &[[f64; 3]], request: &Request, control: &mut Control) -> Result<Self> {
        Self::read(model.driven(points)?, Setup::of_model(model).into(), request, control)
    }

    /// Returns the problem of any propagation matrix G, computed or given by the user, and the setup of its array.
    ///
    /// # Errors
    /// The errors of [`Problem::new`] and [`Request::check`]; another number of positions than transducers, a medium out of
    /// range.
    pub fn with_propagation(propagation: Propagation, setup: impl Into<Arc<Setup>>, request: &Request) -> Result<Self> {
        Self::watched(propagation, setup, request, &mut Control::none())
    }

    /// Does the same as [`Problem::with_propagation`], with a control.
    ///
    /// # Errors
    /// The errors of [`Problem::with_propagation`], and a stop by the caller.
    pub fn watched(
        propagation: Propagation,
        setup: impl Into<Arc<Setup>>,
        request: &Request,
        control: &mut Control,
    ) -> Result<Self> {
        let setup = setup.into();
        let propagation = propagation.driven(setup.channels.as_ref())?;
        setup.check(&propagation)?;
        Self::read(propagation, setup, request, control)
    }

    /// Makes a problem from parts that have been checked.
    fn read(propagation: Propagation, setup: Arc<Setup>, request: &Request, control: &mut Control) -> Result<Self> {
        let mut problem = Self::unasked(propagation, setup);
        problem.replace(None, request)?;
        problem.measure(control)?;
        Ok(problem)
    }

    /// Returns the problem with other points and another request, in the memory of this one. Nothing is allocated if no
    /// solution of this problem exists any more, the number of points is the same and all have a weight. Without points, G
    /// stays the same.
    ///
    /// # Errors
    /// The errors of [`crate::Model::propagation`] and [`Problem::with_propagation`], and points for a propagation matrix G
    /// that the user gave. After an error the problem is lost.
    pub fn renewed(mut self, points: Option<&[[f64; 3]]>, request: &Request) -> Result<Self> {
        self.replace(points, request)?;
        self.measure(&mut Control::none())?;
        Ok(self)
    }

    /// Returns a problem without a request.
    pub(crate) fn unasked(propagation: Propagation, setup: Arc<Setup>) -> Self {
        Self::of(Arc::new(ArrayRequest::new(propagation, setup)))
    }

    /// Returns a problem with this request; all other fields are empty.
    fn of(targets: Arc<ArrayRequest>) -> Self {
        Self {
            selected: None,
            plain: None,
            targets,
            start: None,
            aim: None,
            factor: 1.0,
            scaled: Vec::new(),
            reach: Vec::new(),
            amplitudes: Amplitudes::default(),
        }
    }

    /// Reads other points and another request. [`Problem::measure`] must follow.
    pub(crate) fn replace(&mut self, points: Option<&[[f64; 3]]>, request: &Request) -> Result<()> {
        let targets = Arc::make_mut(&mut self.targets);
        if let Some(points) = points {
            targets.propagation.carry(points)?;
        }
        self.selected = targets.read(request)?;
        (self.start, self.aim) = (None, None);
        Ok(())
    }

    /// Computes the sums of |G| at the points, and then the targets.
    pub(crate) fn measure(&mut self, control: &mut Control) -> Result<()> {
        self.sum_moduli(control)?;
        self.balance_targets()
    }

    /// Computes the sums of |G| at the points of weight above 0.
    pub(crate) fn sum_moduli(&mut self, control: &mut Control) -> Result<()> {
        let propagation = self.selected.as_ref().unwrap_or(&self.targets.propagation);
        // The error names a point by its index among the selected points; callers know the index among all points.
        propagation.reach(&mut self.reach, Some(&mut self.amplitudes), control).map_err(|error| match error.index {
            Some(point) => error.about(format!("points[{}]", self.targets.active[point])),
            None => error,
        })
    }

    /// Sets the sums of |G| to 0.
    pub(crate) fn clear_reach(&mut self) {
        self.amplitudes.clear();
        self.reach.clear();
        self.reach.resize(self.propagation().points(), 0.0);
    }

    /// Computes the balanced level from the sums of |G|, and the targets in units of the reference.
    pub(crate) fn balance_targets(&mut self) -> Result<()> {
        Arc::make_mut(&mut self.targets).balance(&self.reach)?;
        self.scaled.clear();
        self.scaled.resize(self.propagation().lanes(), 0.0);
        self.targets.scaled(1.0, &mut self.scaled);
        Ok(())
    }

    /// Returns a copy of this problem with a start, for the methods that use one.
    ///
    /// # Errors
    /// A drive or phases of another length, a value that is not finite, |q| above 1 + 1e-6.
    pub fn with_start(mut self, start: Start) -> Result<Self> {
        self.begin(start)?;
        Ok(self)
    }

    /// Sets the start, as [`Problem::with_start`] does.
    pub(crate) fn begin(&mut self, mut start: Start) -> Result<()> {
        match &mut start {
            Start::Drive(drive) => {
                if let Cow::Owned(columns) = self.setup().columns(drive, self.propagation().transducers())? {
                    *drive = columns;
                }
            }
            Start::Phases(phases) => {
                one_each("start", phases.len(), "phases", self.targets.pascals.len(), "points")?;
                if let Some(j) = phases.iter().position(|phase| !phase.is_finite()) {
                    return Err(Error::not_finite(format!("start[{j}]"), phases[j]));
                }
            }
        }
        self.start = Some(Arc::new(start));
        Ok(())
    }

    /// Returns a copy of this problem with another aim, for the methods that use one. `None` leaves it as it is.
    #[must_use]
    pub fn with_aim(mut self, aim: impl Into<Option<Aim>>) -> Self {
        self.aim = aim.into().or(self.aim);
        self
    }

    /// The aim: by default the targets if pressures were given, else the highest level of the array. It is the highest level
    /// if traps have a pressure of 0 beside foci.
    pub fn aim(&self) -> Aim {
        if self.targets.frees_traps() {
            return Aim::Max;
        }
        self.aim.unwrap_or(if self.targets.given { Aim::Target } else { Aim::Max })
    }

    /// The drive to start from, one value for each column of the propagation matrix G; `None` if none was given.
    pub fn start_drive(&self) -> Option<&[Complex32]> {
        match self.start.as_deref() {
            Some(Start::Drive(drive)) => Some(drive),
            _ => None,
        }
    }

    /// The phases in rad to start from, at the points of weight above 0; `None` if none were given.
    pub fn start_phases(&self) -> Option<impl Iterator<Item = f64> + '_> {
        match self.start.as_deref() {
            Some(Start::Phases(phases)) => Some(self.targets.active.iter().map(|&j| phases[j])),
            _ => None,
        }
    }

    /// Returns the memory of a prepared problem to the workspace.
    pub(crate) fn recycle(self, work: &Workspace) {
        work.floats.give(self.scaled);
    }
}

getters! {
    Problem:

    /// Whether pressures are requested in Pa, not only their ratios.
    pub(crate) holds_pressures(self) -> bool = self.targets.given && self.aim.unwrap_or(Aim::Target) == Aim::Target;

    /// Whether there are traps of pressure 0 beside foci that have a pressure: such traps are as stiff as possible.
    pub(crate) frees_traps(self) -> bool = self.targets.frees_traps();

    /// Whether a start was given, as a drive or as phases at the points.
    pub(crate) has_start(self) -> bool = self.start.is_some();

    /// Whether the caller gave pressures.
    pub(crate) asks_pressures(self) -> bool = self.targets.given;

    /// The propagation matrix G at the points of weight above 0.
    pub propagation(self) -> &Propagation = self.selected.as_ref().unwrap_or(&self.targets.propagation);

    /// The rows of the propagation matrix G in the form that the kernels of a sweep read.
    pub(crate) rows(self) -> Rows<'_> = self.propagation().rows_of(&self.amplitudes);

    /// The propagation matrix G at the points of weight above 0, before any row was multiplied by a power of two for the range
    /// of f32.
    pub plain_propagation(self) -> &Propagation = self.plain.as_ref().unwrap_or_else(|| self.propagation());

    /// Targets |p_j| of the points of weight above 0, in units of the reference, padded with zeros.
    pub targets(self) -> &[f32] = &self.scaled;

    /// Targets |p_j| of the points of weight above 0 in Pa, at the balanced level if that was requested.
    pub active_targets_in_pascals(self) -> impl Iterator<Item = f64> + '_ =
        self.targets.active.iter().map(|&j| self.targets.target(j) * self.factor);

    /// Weights of the points of weight above 0, divided by the largest, padded with zeros.
    pub weights(self) -> &[f32] = &self.targets.relative_weights;

    /// The setup of the array: medium, quantization, positions, channels.
    pub setup(self) -> &Setup = &self.targets.setup;

    /// The phases and amplitudes that the board can play; `None` for any drive.
    pub quantization(self) -> Option<&Quantization> = self.targets.setup.quantization.as_deref();

    /// Targets (M,) of all points in Pa, as the caller gave them or at the balanced level.
    pub targets_in_pascals(self) -> &[f64] = &self.targets.pascals;

    /// Weights (M,) of all points, as the caller gave them.
    pub point_weights(self) -> &[f64] = &self.targets.weights;

    /// The factor s that scales the targets to the balanced level: `sum_j (s target_j / p1_j)^2 = 1` with
    /// `p1_j = sum_i |G_ji|`. It is 1 if no pressures were given.
    pub balance(self) -> f64 = self.targets.balance;

    /// The indices of the points with a pressure and a weight above 0.
    pub(crate) targeted(self) -> Vec<usize> =
        self.targets.active.iter().copied().filter(|&j| self.targets.pascals[j] > 0.0).collect();

    /// Whether every given target is below half the balanced level. Without balancing, greedy then gives all transducers the
    /// same drive, which smears such weak foci (Suzuki et al. 2021, section V).
    pub is_weak(self) -> bool = self.targets.given && self.targets.balance > 2.0;
}
