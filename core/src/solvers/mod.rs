//! The methods: one file each, one line each in the registry.

pub(crate) mod amplitude_limit;
pub(crate) mod best;
pub(crate) mod common;
pub(crate) mod evd;
pub(crate) mod even_field;
pub(crate) mod fast;
pub(crate) mod greedy;
pub(crate) mod gs;
pub(crate) mod gspat;
pub(crate) mod iterate;
pub(crate) mod lm;
pub(crate) mod naive;
pub(crate) mod options;
pub(crate) mod sdp;
pub(crate) mod tikhonov;
pub(crate) mod uniform;
pub(crate) mod wgs;

use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

pub use crate::solvers::amplitude_limit::AmplitudeLimit;
pub use crate::solvers::best::Best;
pub use crate::solvers::common::refinement::refine;
pub use crate::solvers::evd::Evd;
pub use crate::solvers::fast::Fast;
pub use crate::solvers::greedy::{Greedy, Objective, Order};
pub use crate::solvers::gs::Gs;
pub use crate::solvers::gspat::Gspat;
pub use crate::solvers::lm::Lm;
pub use crate::solvers::naive::Naive;
pub use crate::solvers::sdp::{Moduli, Sdp};
pub use crate::solvers::tikhonov::Tikhonov;
pub use crate::solvers::uniform::Uniform;
pub use crate::solvers::wgs::Wgs;

use crate::control::Control;
use crate::device::quantization::Quantization;
use crate::error::{Error, real};
use crate::problem::Problem;
use crate::problem::solution::Solution;
use crate::solvers::options::{Configure, OptionInfo, Options};
use crate::workspace::Workspace;

/// Declares [`SOLVERS`]; one line adds a solver.
macro_rules! registry {
    ($($method:path,)*) => {
        /// Every solver, in the order of tables.
        pub static SOLVERS: &[Entry] = &[$(Entry::of::<$method>()),*];
    };
}

registry! {
    uniform::Uniform,
    best::Best,
    greedy::Greedy,
    fast::Fast,
    lm::Lm,
    gspat::Gspat,
    gs::Gs,
    wgs::Wgs,
    evd::Evd,
    sdp::Sdp,
    tikhonov::Tikhonov,
    naive::Naive,
}

/// The solver used where none is named.
pub const DEFAULT: &str = "uniform";

/// A method that finds a drive.
pub trait Solve {
    /// Solves `problem` as it stands: its targets are met or missed, no drive exceeds 1. Buffers come from
    /// `work` and go back there; `control` is called once a step. A solver does not balance: [`solve`] does.
    ///
    /// # Errors
    /// Options that this problem cannot be solved with.
    fn solve(
        &self,
        problem: &Problem,
        work: &mut Workspace,
        control: &mut Control,
    ) -> Result<Solution, Error>;

    /// Solves several problems of one model at once, each bit for bit as [`Solve::solve`] does without a control,
    /// where it knows how to share the work.
    #[doc(hidden)]
    fn solve_together(&self, _problems: &[Problem], _work: &mut Workspace) -> Option<Vec<Solution>> {
        None
    }

    /// Whether it brings its answer to the problem's level by itself, so that there is nothing to balance.
    fn finds_level(&self) -> bool {
        false
    }
}

/// What the registry knows of a method beside its options.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::exhaustive_structs, reason = "each solver writes one out in full")]
pub struct Info {
    /// Its name.
    pub name: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    /// Paper and equation.
    pub source: &'static str,
    /// Whether [`solve`] balances the targets unless told otherwise.
    pub balance: bool,
    /// By how much permuting, moving or mirroring a scene may change a metric (in the mean over 20 scenes).
    pub tolerance: f64,
    /// Whether it uses a start (a drive or point phases).
    pub uses_start: bool,
    /// Whether it uses a level ("target" or "max").
    pub uses_aim: bool,
}

/// A registered method: options, what is known of it, and [`Solve`].
pub trait Method: Configure + Solve + Send + Sync + 'static {
    /// What is known of it.
    const INFO: Info;

    /// Defaults that follow from a device's quantization.
    #[must_use]
    fn device_defaults(_quantization: &Quantization) -> Options {
        Options::new()
    }

    /// Checks the options against each other and their ranges.
    ///
    /// # Errors
    /// A value out of range.
    fn check(&self) -> Result<(), Error>;
}

/// A line of the registry.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// What is known of the method.
    pub info: &'static Info,
    list: fn() -> Vec<OptionInfo>,
    make: fn(&Options) -> Result<Configured, Error>,
    device: fn(&Quantization) -> Options,
}

/// A solver with its options, all of them in full.
#[allow(missing_debug_implementations, reason = "a solver of a user's own need not have one")]
pub struct Configured {
    /// The registry's line.
    pub info: &'static Info,
    /// The value of every option.
    pub options: Options,
    /// The solver itself.
    pub solver: Box<dyn Solve + Send + Sync>,
}

impl Entry {
    /// The registry's line for a method.
    #[must_use]
    pub const fn of<M: Method>() -> Self {
        Self { info: &M::INFO, list: M::list, make: make::<M>, device: M::device_defaults }
    }

    /// Every option with its default.
    #[must_use]
    pub fn options(&self) -> Vec<OptionInfo> {
        (self.list)()
    }

    /// The method with some options set.
    ///
    /// # Errors
    /// An unknown option or a value that does not fit.
    pub fn configure(&self, options: &Options) -> Result<Configured, Error> {
        (self.make)(options)
    }

    /// The same for an array that may have quantization: they give the defaults of options that choose a grid.
    ///
    /// # Errors
    /// As [`Entry::configure`].
    pub fn configure_for(
        &self,
        options: &Options,
        quantization: Option<&Quantization>,
    ) -> Result<Configured, Error> {
        let mut all = quantization.map(self.device).unwrap_or_default();
        all.extend(options.clone());
        self.configure(&all)
    }
}

fn make<M: Method>(options: &Options) -> Result<Configured, Error> {
    let mut solver = M::default();
    for (name, value) in options {
        solver.set(name, value).map_err(|error| match error {
            Error::Unknown { name, known, .. } => {
                Error::Unknown { kind: format!("option of {}", M::INFO.name), name, known }
            }
            other => other,
        })?;
    }
    solver.check()?;
    Ok(Configured { info: &M::INFO, options: solver.options(), solver: Box::new(solver) })
}

/// Refuses an iterative method's steps and tolerance out of range.
fn check_iteration(steps: u32, tolerance: f64) -> Result<(), Error> {
    if steps == 0 {
        return Err(Error::invalid("steps", steps, "give at least 1"));
    }
    real("tolerance", tolerance, 0.0, false).map(|_| ())
}

/// The registry's line of that name.
///
/// # Errors
/// An unknown name; the error lists the known ones.
pub fn find(name: &str) -> Result<&'static Entry, Error> {
    SOLVERS
        .iter()
        .find(|entry| entry.info.name == name)
        .ok_or_else(|| Error::unknown("solver", name, SOLVERS.iter().map(|entry| entry.info.name)))
}

/// The error for an argument that `name` does not use, listing the solvers that do.
#[must_use]
pub fn unused(argument: &str, name: &str, uses: fn(&Info) -> bool) -> Error {
    let users: Vec<&str> =
        SOLVERS.iter().map(|entry| entry.info).filter(|info| uses(info)).map(|i| i.name).collect();
    let cure = if users.is_empty() {
        String::from("leave it out, no solver here uses it")
    } else {
        format!("leave it out, or take one that uses it: {}", users.join(", "))
    };
    Error::invalid(argument, format!("given to \"{name}\""), cure)
}

/// Solves a problem, balancing it first if asked to.
///
/// Balancing multiplies the targets by [`Problem::balance`] when that is above 1, and divides the drives by it
/// afterwards: the cure of the paper's section V, where foci much weaker than the array can make come out
/// smeared. Metrics, trace and progress speak of the final drive and the caller's targets.
///
/// Where the array has [`crate::Quantization`], every drive of the answer lies on them, rounded to the nearest phase and
/// amplitude. Balancing then reduces to the nearest amplitude; where that would be below the least one above 0, the
/// drives are brought there and [`Solution::scale`] says what is left to supply or modulation.
///
/// # Errors
/// What the solver refuses.
///
/// ```
/// use midair::{Array, Control, Medium, Problem, Request, Scene, Workspace, solvers};
///
/// let points = vec![[-0.02, 0.0, 0.15], [0.02, 0.0, 0.15]];
/// let scene = Scene::new(Array::grid(20, 20, 10e-3)?, Medium::default(), points, Request::default())?;
/// let greedy = solvers::find("greedy")?.configure(&[("seed".into(), midair::Value::Integer(1))].into())?;
/// let problem = Problem::new(&scene)?;
/// let solution = midair::solve(&problem, &*greedy.solver, false, &mut Workspace::new(), &mut Control::none())?;
/// assert!(solution.metrics().accuracy > 0.8);
/// # Ok::<(), midair::Error>(())
/// ```
pub fn solve(
    problem: &Problem,
    solver: &dyn Solve,
    balance: bool,
    work: &mut Workspace,
    control: &mut Control,
) -> Result<Solution, Error> {
    let factor = factor(problem, solver, balance);
    let mut solution = if factor > 1.0 {
        let targets = work.floats.take(problem.propagation().lanes());
        let balanced = problem.rescaled(factor, targets);
        let solution = solver.solve(&balanced, work, control);
        work.floats.give(balanced.into_targets());
        solution?
    } else {
        solver.solve(problem, work, control)?
    };
    if solution.settle(factor, work) {
        control.correct(|| solution.metrics().residual);
    }
    Ok(solution)
}

/// As [`solve`], several problems at once, where the solver knows how.
pub(crate) fn solve_together(
    problems: &[Problem],
    solver: &dyn Solve,
    balance: bool,
    work: &mut Workspace,
) -> Option<Vec<Solution>> {
    let factor = |problem: &Problem| factor(problem, solver, balance);
    if problems.iter().all(|problem| factor(problem) <= 1.0) {
        let mut solutions = solver.solve_together(problems, work);
        for solution in solutions.iter_mut().flatten() {
            solution.settle(1.0, work);
        }
        return solutions;
    }
    let rescaled = |problem: &Problem| {
        let targets = work.floats.take(problem.propagation().lanes());
        problem.rescaled(factor(problem), targets)
    };
    let balanced: Vec<Problem> = problems.iter().map(rescaled).collect();
    let mut solutions = solver.solve_together(&balanced, work);
    for (solution, problem) in solutions.iter_mut().flatten().zip(problems) {
        solution.settle(factor(problem), work);
    }
    work.floats.give_all(balanced.into_iter().map(Problem::into_targets));
    solutions
}

/// What the targets are multiplied by before solving, and the answer divided by afterwards.
fn factor(problem: &Problem, solver: &dyn Solve, balance: bool) -> f64 {
    if balance && !solver.finds_level() { problem.balance().max(1.0) } else { 1.0 }
}
