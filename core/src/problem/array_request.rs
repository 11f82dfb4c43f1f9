//! ArrayRequest: targets and weights of all points in Pa, scaled to the balanced level; Setup: what is needed of an array.

use crate::device::channels::Channels;
use crate::device::quantization::Quantization;
use crate::kernels::padded;
use crate::prelude::*;
use crate::problem::metrics::Metrics;
use crate::propagation::{Model, Propagation};
use crate::scene::{Array, Bead, Medium, Request, Signature, check_drive, check_positions};

/// The range of targets, in units of the reference pressure. Targets outside of it are near the limits of f32, and
/// probably in a wrong unit.
const MOST_TARGET: f64 = 1e15;
const LEAST_TARGET: f64 = 1e-30;

/// Least part of the square of the balanced level that is left to traps of pressure 0, however high the pressures of
/// the foci are.
const LEAST_LEFT: f64 = 0.05;

/// The least pressure in Pa of all transducers together at a point. A point with a lower pressure counts as not reached: a
/// division by this pressure would overflow.
const LEAST_REACH: f64 = 1e-200;

/// The targets and weights of a request at all points of an array.
#[derive(Clone, Debug)]
pub(crate) struct ArrayRequest {
    /// The propagation matrix G at all points.
    pub(crate) propagation: Propagation,
    /// The medium, quantization and channels of the array.
    pub(crate) setup: Arc<Setup>,
    /// Targets (M,) in Pa.
    pub(crate) pascals: Vec<f64>,
    /// Phases of the targets (M,) in rad; empty if they are free.
    pub(crate) phases: Vec<f64>,
    /// Weights (M,).
    pub(crate) weights: Vec<f64>,
    /// Weights of the active points, divided by the largest weight, padded with zeros.
    pub(crate) relative_weights: Vec<f32>,
    /// The active points: the indices of those with a weight above 0.
    pub(crate) active: Vec<usize>,
    /// Whether each point is a trap of pressure 0 beside foci that have a pressure (M,); empty if there is no such
    /// trap.
    free: Vec<bool>,
    /// The strength of these traps in Pa before they are made stiff: what the foci leave of the balanced level.
    left: f64,
    /// Whether the caller gave pressures, and whether the caller gave weights.
    pub(crate) given: bool,
    pub(crate) weighted: bool,
    /// The factor that scales the targets to the balanced level.
    pub(crate) balance: f64,
    /// The first point whose target exceeds the pressure of all transducers there, with that pressure in Pa.
    pub(crate) overasked: Option<(usize, f64)>,
}

impl ArrayRequest {
    /// Returns the state before a request is read.
    pub(crate) fn new(propagation: Propagation, setup: Arc<Setup>) -> Self {
        Self {
            propagation,
            setup,
            pascals: Vec::new(),
            phases: Vec::new(),
            weights: Vec::new(),
            relative_weights: Vec::new(),
            active: Vec::new(),
            free: Vec::new(),
            left: 0.0,
            given: false,
            weighted: false,
            balance: 1.0,
            overasked: None,
        }
    }

    /// Checks a request and stores it. Returns the propagation matrix G at the active points, or `None` if all points are
    /// active. A second call allocates memory only for that G.
    pub(crate) fn read(&mut self, request: &Request) -> Result<Option<Propagation>> {
        let all = 0..self.propagation.points();
        request.check(all.end)?;
        (self.given, self.weighted) = (request.pressures.is_some(), request.weights.is_some());
        self.pascals.clear();
        self.pascals.extend(all.clone().map(|j| request.pressure(j)));
        self.phases.clear();
        self.phases.extend(request.phases.iter().flatten());
        self.weights.clear();
        self.weights.extend(all.clone().map(|j| request.weight(j)));
        self.active.clear();
        self.active.extend(all.clone().filter(|&j| self.weights[j] > 0.0));
        self.free.clear();
        if self.given
            && let Some(signature) = self.propagation.signature().filter(|signature| signature.traps())
            && all.clone().all(|j| *signature.of(j) != Signature::Trap || self.pascals[j] == 0.0)
        {
            self.free.extend(all.clone().map(|j| *signature.of(j) == Signature::Trap));
        }
        let heaviest = self.weights.iter().copied().fold(0.0, f64::max);
        self.relative_weights.clear();
        self.relative_weights.resize(padded(self.active.len()), 0.0);
        for (relative, &j) in self.relative_weights.iter_mut().zip(&self.active) {
            *relative = (self.weights[j] / heaviest) as f32;
        }
        Ok((self.active.len() < all.end).then(|| self.propagation.select(&self.active)))
    }

    /// Whether there are traps without a pressure of their own.
    pub(crate) fn frees_traps(&self) -> bool {
        !self.free.is_empty()
    }

    fn is_free(&self, j: usize) -> bool {
        self.free.get(j) == Some(&true)
    }

    /// The target in Pa with which a point is solved.
    pub(crate) fn target(&self, j: usize) -> f64 {
        if self.is_free(j) { self.left } else { self.pascals[j] }
    }

    /// The weight of a point in metrics; 0 for a trap without a pressure.
    pub(crate) fn counted(&self, j: usize) -> f64 {
        if self.is_free(j) { 0.0 } else { self.weights[j] }
    }

    /// Whether the targets have phases.
    pub(crate) fn phased(&self) -> bool {
        !self.phases.is_empty()
    }

    /// Returns the request as it was given.
    pub(crate) fn request(&self) -> Request {
        Request {
            pressures: self.given.then(|| self.pascals.clone()),
            phases: self.phased().then(|| self.phases.clone()),
            weights: self.weighted.then(|| self.weights.clone()),
        }
    }

    /// Computes the balanced level. `reach` contains p1_j of the active points in units of the reference. If no pressures were
    /// given, the targets are set to this level.
    ///
    /// # Errors
    /// A target at a point that no transducer reaches; a target so large or small that it must have a wrong unit.
    pub(crate) fn balance(&mut self, reach: &[f64]) -> Result<()> {
        let reference = self.propagation.reference();
        self.overasked = None;
        let within = LEAST_TARGET..=MOST_TARGET;
        for (&j, &reach) in self.active.iter().zip(reach) {
            let target = self.pascals[j];
            let alone = reach * reference;
            if target > 0.0 && alone < LEAST_REACH {
                let (item, cure) = (format!("points[{j}]"), self.propagation.cure_of_silence());
                return Err(Error::new(ErrorCode::Unreached, item, "reached by no transducer", cure));
            }
            if self.given && target > 0.0 && !within.contains(&(target / reference)) {
                let cure = "no array comes near it: give the pressure in Pa, or 0 for a quiet point";
                return Err(Error::out_of_range(format!("points[{j}].pressure"), format!("{target:e}"), cure));
            }
            // The tolerance covers the sums of f32 values, which are exact to 1e-4 of the reach.
            if self.given && target > (1.0 + 1e-4) * alone {
                self.overasked = self.overasked.or(Some((j, alone)));
            }
        }
        // The loads (target over reach) are divided by the largest load, so that no square overflows or underflows.
        let pairs = self.active.iter().zip(reach);
        let loads = pairs.map(|(&j, &reach)| self.pascals[j] / (reach * reference)).filter(|load| *load > 0.0);
        let load = loads.clone().fold(0.0, f64::max);
        self.balance = 1.0 / (load * math::sqrt(loads.map(|each| (each / load) * (each / load)).sum()));
        if self.frees_traps() {
            // The balanced level is defined by a sum of (target/p1)^2 over all points of 1. The foci have 1/balance^2 of
            // this sum, and the traps get the rest.
            let rest = (1.0 - 1.0 / (self.balance * self.balance)).max(LEAST_LEFT);
            let traps = self.active.iter().zip(reach).filter(|(j, _)| self.free[**j]);
            let loads = traps.map(|(_, reach)| 1.0 / (reach * reference)).fold(0.0, math::hypot);
            self.left = math::sqrt(rest) / loads;
            self.balance = self.balance.min(1.0);
        }
        if !self.given {
            if self.balance < LEAST_TARGET * reference {
                let weakest = self.active.iter().zip(reach).min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(&j, _)| j);
                let cure =
                    "with pressures left out all points would be as silent: give pressures, or this point weight 0";
                return Err(Error::invalid(format!("points[{weakest}]"), "reached by hardly anything", cure));
            }
            self.pascals.iter_mut().for_each(|target| *target *= self.balance);
            self.balance = 1.0;
        }
        Ok(())
    }

    /// Writes the targets of the active points times `factor`, in units of the reference, padded with zeros.
    pub(crate) fn scaled(&self, factor: f64, out: &mut [f32]) {
        for (out, &j) in out.iter_mut().zip(&self.active) {
            *out = (self.target(j) * factor / self.propagation.reference()) as f32;
        }
        out[self.active.len()..].fill(0.0);
    }

    /// Returns the relative error of complex pressures (M,) in Pa, sqrt(sum w |p - target|^2 / sum w |target|^2); `None` if the
    /// phases are free.
    pub(crate) fn complex_error(&self, pressures: &[Complex32]) -> Option<f64> {
        if !self.phased() {
            return None;
        }
        let largest = self.pascals.iter().copied().fold(0.0, f64::max);
        let heaviest = self.weights.iter().copied().fold(0.0, f64::max);
        let (mut miss, mut all) = (0.0, 0.0);
        for &j in &self.active {
            // Pressures are divided by the largest target, so that no square of a finite number overflows.
            let (weight, target) = (self.counted(j) / heaviest, self.pascals[j] / largest);
            let pressure = Complex64::new(f64::from(pressures[j].re), f64::from(pressures[j].im)) / largest;
            miss += weight * (pressure - target * math::phasor(self.phases[j])).norm_sqr();
            all += weight * target * target;
        }
        Some(math::sqrt(miss / all))
    }

    /// Returns the metrics of pressures |p| (M,) in Pa.
    pub(crate) fn metrics(&self, pressures: impl Iterator<Item = f64> + Clone) -> Metrics {
        Metrics::of(pressures.enumerate().map(|(j, pressure)| (pressure, self.pascals[j], self.counted(j))))
    }
}

/// The inputs of a problem besides the propagation matrix G and the request. They are useful with any G, also a measured one:
/// the quantization of a board, positions for methods that order the transducers, and a medium for radiation pressures.
///
/// ```
/// use midair::{Complex64, Control, Problem, Propagation, Quantization, Request, Setup, Workspace, solvers::Greedy};
///
/// // A measured matrix of 2 points and 3 transducers, played by a board of 8 phases.
/// let matrix = [1.0, 2.0, 3.0, 3.0, 2.0, 1.0].map(|re| Complex64::new(re, 0.0));
/// let setup = Setup { quantization: Some(Quantization::new(Some(8), None)?.into()), ..Setup::default() };
/// let problem = Problem::with_propagation(Propagation::from_matrix(&matrix, 2)?, setup, &Request::default())?;
/// let greedy = Greedy { phases: 8, ..Greedy::default() };
/// let solution = midair::solve(&problem, &greedy, false, &mut Workspace::new(), &mut Control::none())?;
/// assert!(solution.metrics().accuracy > 0.9);
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setup {
    /// The air; its density and sound speed give radiation pressures.
    pub medium: Medium,
    /// The phases and amplitudes that the board can play; `None` for any drive.
    pub quantization: Option<Arc<Quantization>>,
    /// The position in m of each column of the propagation matrix G, if known, for methods that order the columns. For a
    /// channel it is the middle of its transducers.
    pub positions: Option<Arc<[[f64; 3]]>>,
    /// The bead that traps are made for.
    pub bead: Bead,
    /// The channels, if each column of the propagation matrix G is a channel; `None` if each column is a transducer.
    pub channels: Option<Channels>,
}

impl Setup {
    /// Returns the setup of a model: its array in its medium, and its bead.
    pub fn of_model(model: &Model) -> Self {
        Self { bead: model.bead(), ..Self::of(model.array(), model.medium()) }
    }

    /// Returns the setup of an array in a medium, with the default bead.
    pub fn of(array: &Array, medium: Medium) -> Self {
        let (positions, quantization) = array.shared();
        let channels = array.wiring().cloned();
        let middles = channels.as_ref().map(|channels| channels.middles(&positions).into());
        Self { medium, quantization, positions: middles.or(Some(positions)), bead: Bead::default(), channels }
    }

    /// Checks that the parts fit the propagation matrix G.
    pub(crate) fn check(&self, propagation: &Propagation) -> Result<()> {
        self.medium.check()?;
        let columns = propagation.transducers();
        if let Some(channels) = &self.channels {
            one_each("columns of G", columns, "of them", channels.count(), "channels")?;
        }
        self.positions.as_ref().map_or(Ok(()), |positions| check_positions(positions, columns))
    }

    /// The number of transducers N, for a propagation matrix G with this many columns.
    pub(crate) fn transducers(&self, columns: usize) -> usize {
        self.channels.as_ref().map_or(columns, |channels| channels.of().len())
    }

    /// Checks a drive (N,), and returns the value of each column of the propagation matrix G.
    ///
    /// # Errors
    /// A drive that the array cannot play.
    pub(crate) fn columns<'a>(&self, drive: &'a [Complex32], columns: usize) -> Result<Cow<'a, [Complex32]>> {
        match &self.channels {
            None => check_drive(drive, columns).map(|()| Cow::Borrowed(drive)),
            Some(channels) => {
                check_drive(drive, channels.of().len())?;
                channels.drives(drive).map(Cow::Owned)
            }
        }
    }
}
