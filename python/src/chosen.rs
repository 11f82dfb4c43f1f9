//! The solver of a call: its name, its options, balance and aim, from keywords, a scene file or a Python function.

use midair::solvers::{self as registry, Configured, Info};
use midair::{Options, Quantization};

use crate::function::{Function, Objective, Raised};
use crate::prelude::*;

/// The keywords of a call that choose a solver, besides the solver's own options.
#[derive(Clone, Copy)]
pub(crate) struct Naming<'a, 'py> {
    pub(crate) solver: Argument<'a, 'py>,
    pub(crate) balance: Argument<'a, 'py>,
    pub(crate) aim: Argument<'a, 'py>,
}

impl Naming<'_, '_> {
    /// Writes balance and aim over those of a scene file.
    fn write(self, choice: &mut Choice) -> PyResult<()> {
        choice.balance = self.balance.map(|value| read::flag("balance", value)).transpose()?.or(choice.balance);
        choice.aim = self.aim.map(read::aim).transpose()?.or(choice.aim);
        Ok(())
    }
}

/// A solver's name with all its options, and its entry in the registry.
pub(crate) struct Chosen {
    pub(crate) choice: Arc<Choice>,
    pub(crate) info: &'static Info,
}

impl PartialEq for Chosen {
    fn eq(&self, other: &Self) -> bool {
        self.choice == other.choice
    }
}

impl Chosen {
    /// Reads the keywords of a call. What they leave out, `file` gives: the choice of a scene file, for its own solver.
    /// Also returns the solver, for an array of this quantization.
    pub(crate) fn read(
        file: Option<&Choice>,
        board: Option<&Quantization>,
        naming: Naming<'_, '_>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<(Self, Configured)> {
        let named = naming.solver.map(read::name).transpose()?;
        let keywords = read::options(options)?;
        // The file's options apply only if the solver is the file's. Keywords replace them.
        let named = named.as_deref().map(registry::find).transpose().map_err(refused)?.map(|entry| entry.info.name);
        let file = file.filter(|choice| named.is_none_or(|name| name == choice.name));
        let name = named.or(file.map(|choice| choice.name.as_str())).unwrap_or(registry::DEFAULT);
        let new = || Choice::new(name.into(), Options::new());
        let mut choice = file.cloned().map_or_else(new, Ok).map_err(refused)?;
        choice.options.extend(registry::find(name).and_then(|entry| entry.spelled(&keywords)).map_err(refused)?);
        naming.write(&mut choice)?;
        let configured = registry::configure(&choice, board).map_err(refused)?;
        Ok(Self::of(choice, configured))
    }

    /// Does the same for a call that also takes Python functions, as a solver or as its objective. Also returns where such a
    /// function stores an exception.
    pub(crate) fn read_with_functions(
        py: Python<'_>,
        file: Option<&Choice>,
        board: Option<&Quantization>,
        naming: Naming<'_, '_>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<(Self, Configured, Raised)> {
        let function = naming.solver.map(|solver| Function::read(solver, options)).transpose()?.flatten();
        if let Some(function) = function {
            let (mut choice, raised) = (function.choice(py)?, function.raised.clone());
            naming.write(&mut choice)?;
            let configured = function.configured(&choice)?;
            let (chosen, configured) = Self::of(choice, configured);
            return Ok((chosen, configured, raised));
        }
        let (energy, options) = Objective::take(options)?;
        let (chosen, configured) = Self::read(file, board, naming, options.as_ref())?;
        let Some(energy) = energy else { return Ok((chosen, configured, Raised::default())) };
        let (choice, raised) = (Arc::unwrap_or_clone(chosen.choice), energy.raised.clone());
        let (chosen, configured) = Self::of(choice, energy.configured(py, configured)?);
        Ok((chosen, configured, raised))
    }

    fn of(mut choice: Choice, configured: Configured) -> (Self, Configured) {
        choice.balance.get_or_insert(configured.info.balance);
        choice.options.clone_from(&configured.options);
        (Self { choice: Arc::new(choice), info: configured.info }, configured)
    }

    /// Whether the targets are balanced.
    pub(crate) fn balances(&self) -> bool {
        self.choice.balance == Some(true)
    }

    /// Refuses a start, if one is given, for a solver that uses none.
    pub(crate) fn check_start(&self, has_start: bool) -> PyResult<()> {
        if has_start && !self.info.uses_start {
            return Err(refused(registry::unused("start", &self.choice.name, |info| info.uses_start)));
        }
        Ok(())
    }

    /// Returns the choice for a solution's record, with the problem's aim if the method uses one.
    pub(crate) fn answered(&self, problem: &Problem) -> Arc<Choice> {
        if !self.info.uses_aim {
            return Arc::clone(&self.choice);
        }
        Arc::new(Choice { aim: Some(problem.aim()), ..Choice::clone(&self.choice) })
    }
}
