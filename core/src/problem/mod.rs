//! Problem: G, targets and weights of the points with a weight above 0, in units of the reference.

pub(crate) mod array_request;
pub(crate) mod complex_targets;
pub(crate) mod feasibility;
pub(crate) mod judgement;
pub(crate) mod metrics;
pub(crate) mod mix;
pub(crate) mod optimum;
pub(crate) mod range;
pub(crate) mod rounding;
pub(crate) mod setup;
pub(crate) mod solution;
pub(crate) mod status;
pub(crate) mod upper_bound;

pub use feasibility::{Beyond, Reach};
pub use judgement::Precision;
pub use metrics::Metrics;
pub use setup::Setup;
pub use solution::Solution;
pub use status::Status;
pub use upper_bound::bound;

use alloc::borrow::Cow;
use alloc::format;
use alloc::sync::Arc;
use alloc::vec::Vec;

use num_complex::Complex32;

use crate::control::Control;
use crate::device::quantization::Quantization;
use crate::error::{Error, one_each};
use crate::kernels::{InstructionSet, Rows};
use crate::problem::array_request::ArrayRequest;
use crate::propagation::reach::Amplitudes;
use crate::propagation::{Model, Propagation};
use crate::scene::{Aim, Request, Scene, Start};
use crate::workspace::Workspace;

/// A checked problem: it can be solved.
///
/// Cloning is cheap but for the targets: all else is shared.
#[derive(Clone, Debug)]
pub struct Problem {
    /// G at the points of weight above 0, unless those are all and it is as it was.
    selected: Option<Propagation>,
    /// The same as the caller gave it, where rows of it were brought into f32's range.
    plain: Option<Propagation>,
    /// The request of all points, in Pa.
    targets: Arc<ArrayRequest>,
    start: Option<Arc<Start>>,
    pub(crate) aim: Option<Aim>,
    /// The factor of the caller's targets: 1 unless this is the balanced problem.
    factor: f64,
    /// Targets of the points of weight above 0 in units of the reference, padded with zeros.
    scaled: Vec<f32>,
    /// p1_j of the points of weight above 0 in units of the reference.
    pub(crate) reach: Vec<f64>,
    /// The rows of G that these sums have computed, if they are stored.
    amplitudes: Amplitudes,
}

impl Problem {
    /// The problem of a scene.
    ///
    /// # Errors
    /// A point on a transducer, or one with a pressure above 0 that no transducer reaches.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        Self::with_instruction_set(scene, InstructionSet::best())
    }

    /// The problem of a scene, by the kernels of another instruction set than the machine's best.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn with_instruction_set(scene: &Scene, set: InstructionSet) -> Result<Self, Error> {
        Self::of_scene(scene, set, &mut Control::none())
    }

    /// Like [`Problem::with_instruction_set`], with a control for long computations: the sums of |G| are O(N M).
    ///
    /// # Errors
    /// The same, and a stop.
    pub fn of_scene(scene: &Scene, set: InstructionSet, control: &mut Control) -> Result<Self, Error> {
        Self::of_model(&Model::of(scene, set), scene.points(), scene.request(), control)
    }

    /// Like [`Problem::of_scene`], for a prepared array and medium.
    ///
    /// # Errors
    /// The same, and what [`Scene::new`] refuses of points and request.
    pub fn of_model(
        model: &Model,
        points: &[[f64; 3]],
        request: &Request,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let setup = Setup::of(model.array(), model.medium());
        Self::read(model.driven(points)?, setup.into(), request, control)
    }

    /// The problem of any G, computed or given, and the array behind it.
    ///
    /// # Errors
    /// As [`Problem::new`] and [`Request::check`]; another number of positions than transducers, a medium out of range.
    pub fn with_propagation(
        propagation: Propagation,
        setup: impl Into<Arc<Setup>>,
        request: &Request,
    ) -> Result<Self, Error> {
        Self::watched(propagation, setup, request, &mut Control::none())
    }

    /// Like [`Problem::with_propagation`], with a control.
    ///
    /// # Errors
    /// The same, and a stop.
    pub fn watched(
        propagation: Propagation,
        setup: impl Into<Arc<Setup>>,
        request: &Request,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let setup = setup.into();
        let propagation = propagation.driven(setup.channels.as_ref())?;
        setup.check(&propagation)?;
        Self::read(propagation, setup, request, control)
    }

    /// A request of checked parts.
    fn read(
        propagation: Propagation,
        setup: Arc<Setup>,
        request: &Request,
        control: &mut Control,
    ) -> Result<Self, Error> {
        let mut problem = Self::unasked(propagation, setup);
        problem.replace(None, request)?;
        problem.measure(control)?;
        Ok(problem)
    }

    /// The problem of other points and requests with the same array, in the memory of this one: if no solution of it
    /// is left, the number of points is the same and all have a weight, nothing is allocated. Without points G stays
    /// as it is.
    ///
    /// # Errors
    /// As [`crate::Model::propagation`] and [`Problem::with_propagation`], and points for a given G; the problem is then
    /// lost.
    pub fn renewed(mut self, points: Option<&[[f64; 3]]>, request: &Request) -> Result<Self, Error> {
        self.replace(points, request)?;
        self.measure(&mut Control::none())?;
        Ok(self)
    }

    /// A problem without a request.
    pub(crate) fn unasked(propagation: Propagation, setup: Arc<Setup>) -> Self {
        Self::of(Arc::new(ArrayRequest::new(propagation, setup)))
    }

    /// A problem of which only this is known.
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

    /// Reads other points and another request: [`Problem::measure`] comes next.
    pub(crate) fn replace(&mut self, points: Option<&[[f64; 3]]>, request: &Request) -> Result<(), Error> {
        let targets = Arc::make_mut(&mut self.targets);
        if let Some(points) = points {
            targets.propagation.carry(points)?;
        }
        self.selected = targets.read(request)?;
        (self.start, self.aim) = (None, None);
        Ok(())
    }

    /// Sums |G| at the points and computes the targets.
    pub(crate) fn measure(&mut self, control: &mut Control) -> Result<(), Error> {
        self.sum_moduli(control)?;
        self.balance_targets()
    }

    /// Sums |G| at the points of weight above 0.
    pub(crate) fn sum_moduli(&mut self, control: &mut Control) -> Result<(), Error> {
        let propagation = self.selected.as_ref().unwrap_or(&self.targets.propagation);
        propagation.reach(&mut self.reach, Some(&mut self.amplitudes), control).map_err(|error| match error {
            // The selection renumbered the points.
            Error::TooNear { point, transducer, distance, least } => {
                Error::TooNear { point: self.targets.active[point], transducer, distance, least }
            }
            other => other,
        })
    }

    /// Sets the sums of |G| to 0.
    pub(crate) fn clear_reach(&mut self) {
        self.amplitudes.clear();
        self.reach.clear();
        self.reach.resize(self.propagation().points(), 0.0);
    }

    /// Computes the balanced level from the sums of |G|, and the targets in units of the reference.
    pub(crate) fn balance_targets(&mut self) -> Result<(), Error> {
        Arc::make_mut(&mut self.targets).balance(&self.reach)?;
        self.scaled.clear();
        self.scaled.resize(self.propagation().lanes(), 0.0);
        self.targets.scaled(1.0, &mut self.scaled);
        Ok(())
    }

    /// The same problem with a start for the methods that use one.
    ///
    /// # Errors
    /// A drive or phases of another length, a value that is not finite, |q| above 1 + 1e-6.
    pub fn with_start(mut self, start: Start) -> Result<Self, Error> {
        self.begin(start)?;
        Ok(self)
    }

    /// Like [`Problem::with_start`].
    pub(crate) fn begin(&mut self, mut start: Start) -> Result<(), Error> {
        match &mut start {
            Start::Drive(drive) => {
                if let Cow::Owned(columns) = self.setup().columns(drive, self.propagation().transducers())? {
                    *drive = columns;
                }
            }
            Start::Phases(phases) => {
                one_each("start", phases.len(), "phases", self.targets.pascals.len(), "points")?;
                if let Some(j) = phases.iter().position(|phase| !phase.is_finite()) {
                    return Err(Error::invalid(format!("start[{j}]"), phases[j], "give finite numbers"));
                }
            }
        }
        self.start = Some(Arc::new(start));
        Ok(())
    }

    /// The same problem with another aim for the methods that use one.
    #[must_use]
    pub fn with_aim(mut self, aim: Aim) -> Self {
        self.aim = Some(aim);
        self
    }

    /// Level of the points: by default the targets if pressures were given, else as loud as
    /// the array can make them.
    #[must_use]
    pub fn aim(&self) -> Aim {
        self.aim.unwrap_or(if self.targets.given { Aim::Target } else { Aim::Max })
    }

    /// Whether there is a start, a drive or point phases.
    pub(crate) fn has_start(&self) -> bool {
        self.start.is_some()
    }

    /// The drive to start from, if one was given: one of each column of G.
    #[must_use]
    pub fn start_drive(&self) -> Option<&[Complex32]> {
        match self.start.as_deref() {
            Some(Start::Drive(drive)) => Some(drive),
            _ => None,
        }
    }

    /// The point phases in rad to start from, if they were given: over the points of weight above 0.
    #[must_use]
    pub fn start_phases(&self) -> Option<impl Iterator<Item = f64> + '_> {
        match self.start.as_deref() {
            Some(Start::Phases(phases)) => Some(self.targets.active.iter().map(|&j| phases[j])),
            _ => None,
        }
    }

    /// Whether the caller gave pressures.
    pub(crate) fn asks_pressures(&self) -> bool {
        self.targets.given
    }

    /// Gives the memory of a prepared problem back.
    pub(crate) fn recycle(self, work: &Workspace) {
        work.floats.give(self.scaled);
    }

    /// Rows of G over the points of weight above 0.
    #[must_use]
    pub fn propagation(&self) -> &Propagation {
        self.selected.as_ref().unwrap_or(&self.targets.propagation)
    }

    /// The same as the kernels of a sweep read them.
    pub(crate) fn rows(&self) -> Rows<'_> {
        self.propagation().rows_of(&self.amplitudes)
    }

    /// Rows of G over the points of weight above 0, none of them multiplied by a power of two for f32's sake.
    #[must_use]
    pub fn plain_propagation(&self) -> &Propagation {
        self.plain.as_ref().unwrap_or_else(|| self.propagation())
    }

    /// Targets |p_j| in units of the reference, padded with zeros.
    #[must_use]
    pub fn targets(&self) -> &[f32] {
        &self.scaled
    }

    /// The same in Pa, without padding: targets |p_j| of the points of weight above 0, balanced if that was requested.
    pub fn active_targets_in_pascals(&self) -> impl Iterator<Item = f64> + '_ {
        self.targets.active.iter().map(|&j| self.targets.pascals[j] * self.factor)
    }

    /// Weights, the largest 1, padded with zeros.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.targets.relative_weights
    }

    /// The array behind G: medium, quantization, positions, channels.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.targets.setup
    }

    /// The board's grid; `None` for any drive.
    #[must_use]
    pub fn quantization(&self) -> Option<&Quantization> {
        self.targets.setup.quantization.as_deref()
    }

    /// Targets (M,) of all points in Pa, as the caller gave them or at the balanced level.
    #[must_use]
    pub fn targets_in_pascals(&self) -> &[f64] {
        &self.targets.pascals
    }

    /// Weights (M,) of all points, as the caller gave them.
    #[must_use]
    pub fn point_weights(&self) -> &[f64] {
        &self.targets.weights
    }

    /// The factor s that brings the targets to the balanced level: `sum_j (s target_j / p1_j)^2 = 1` with
    /// `p1_j = sum_i |G_ji|`. 1 where pressures were left out.
    #[must_use]
    pub fn balance(&self) -> f64 {
        self.targets.balance
    }

    /// The points with a pressure and a weight above 0.
    pub(crate) fn targeted(&self) -> Vec<usize> {
        self.targets.active.iter().copied().filter(|&j| self.targets.pascals[j] > 0.0).collect()
    }

    /// Whether every given target is below half the balanced level: solved without balancing, greedy drives
    /// every transducer all the same and smears such foci (the paper's section V).
    #[must_use]
    pub fn is_weak(&self) -> bool {
        self.targets.given && self.targets.balance > 2.0
    }
}
