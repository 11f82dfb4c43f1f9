//! The registry: every solver by name, one line for each.

use crate::error;
use crate::scene::{Choice, Options, Value};
use crate::solvers::options::{Configure, OptionInfo};
use crate::solvers::prelude::*;
use crate::solvers::{
    Best, Bounded, Descent, Energy, Evd, Fast, Glide, Greedy, GreedyBy, Gs, Gspat, Lm, Naive, Sdp, Tikhonov, Uniform,
    Wgs,
};

/// Every solver, in the order of printed tables. One more line adds a solver.
pub static SOLVERS: &[Entry] = &[
    Entry::of::<Uniform>(),
    Entry::of::<Best>(),
    Entry::of::<Greedy>(),
    Entry::of::<Fast>(),
    Entry::of::<Glide>(),
    Entry::of::<Descent>(),
    Entry::of::<Lm>(),
    Entry::of::<Gspat>(),
    Entry::of::<Gs>(),
    Entry::of::<Wgs>(),
    Entry::of::<Evd>(),
    Entry::of::<Sdp>(),
    Entry::of::<Bounded>(),
    Entry::of::<Tikhonov>(),
    Entry::of::<Naive>(),
];

/// Name of the solver that is used if none is given.
pub const DEFAULT: &str = "uniform";

/// A line of the registry.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name, summary and properties of the method.
    pub info: &'static Info,
    list: fn() -> Vec<OptionInfo>,
    make: fn(&Options) -> Result<Configured>,
    device: fn(&Quantization) -> Options,
}

/// A solver with the values of all its options.
pub struct Configured {
    /// The method's entry in the registry.
    pub info: &'static Info,
    /// The value of every option.
    pub options: Options,
    /// The solver itself.
    pub solver: Box<dyn Solve + Send + Sync>,
}

impl Configured {
    /// Returns `greedy` with an energy of the caller's in place of its objective. `name` is the energy's name in the options.
    ///
    /// # Errors
    /// Any other solver.
    pub fn by_energy(mut self, energy: Box<dyn Energy>, name: String) -> Result<Self> {
        if self.info.name != Greedy::INFO.name {
            let cure = format!("{} alone takes one: name it, or leave this out", Greedy::INFO.name);
            return Err(Error::invalid("objective", "a function", cure));
        }
        let mut greedy = Greedy::default();
        set_all(self.info.name, &self.options, &mut |name, value| greedy.set(name, value))?;
        self.options.insert("objective".into(), Value::Text(name));
        Ok(Self { info: &GreedyBy::INFO, solver: Box::new(GreedyBy::new(greedy, energy)), ..self })
    }
}

impl Entry {
    /// Creates the registry's line for a method.
    pub const fn of<M: Method>() -> Self {
        Self { info: &M::INFO, list: M::list, make: make::<M>, device: M::device_defaults }
    }

    /// Returns every option with its default.
    pub fn options(&self) -> Vec<OptionInfo> {
        (self.list)()
    }

    /// Returns whether the method uses the phases of the targets.
    pub fn uses_phases(&self) -> bool {
        (self.make)(&Options::new()).is_ok_and(|made| made.solver.uses_phases())
    }

    /// Creates the solver with some options set.
    ///
    /// # Errors
    /// An unknown option, an option given twice, or a value that does not fit.
    pub fn configure(&self, options: &Options) -> Result<Configured> {
        (self.make)(&self.spelled(options)?)
    }

    /// Returns the options under the names of [`Entry::options`]. Upper and lower case, "-" and "_" make no difference.
    ///
    /// # Errors
    /// An option given under two spellings.
    pub fn spelled(&self, options: &Options) -> Result<Options> {
        let known = self.options();
        let mut spelled = Options::new();
        for (name, value) in options {
            let name = known.iter().map(|option| option.name).find(|known| same_name(known, name)).unwrap_or(name);
            if spelled.insert(name.into(), value.clone()).is_some() {
                return Err(Error::invalid(name, "given twice", "give it once"));
            }
        }
        Ok(spelled)
    }

    /// Creates the solver for an array that may have a quantization; options that choose a grid get their defaults from
    /// it.
    ///
    /// # Errors
    /// The errors of [`Entry::configure`].
    pub fn configure_for(&self, options: &Options, quantization: Option<&Quantization>) -> Result<Configured> {
        let mut all = quantization.map(self.device).unwrap_or_default();
        all.extend(self.spelled(options)?);
        (self.make)(&all)
    }
}

fn make<M: Method>(options: &Options) -> Result<Configured> {
    let mut solver = M::default();
    set_all(M::INFO.name, options, &mut |name, value| solver.set(name, value))?;
    solver.check()?;
    Ok(Configured { info: &M::INFO, options: solver.options(), solver: Box::new(solver) })
}

/// Sets the options of the method of this name.
fn set_all(method: &str, options: &Options, set: &mut dyn FnMut(&str, &Value) -> Result<()>) -> Result<()> {
    for (name, value) in options {
        set(name, value).map_err(|mut error| {
            if error.code == ErrorCode::Unknown {
                error.hint = hint_of_owners(name).unwrap_or_else(|| core::mem::take(&mut error.hint));
                error.item = format!("option of {method}");
            }
            error
        })?;
    }
    Ok(())
}

/// Returns a hint with the methods that have an option which a solver lacks; `None` if there are none.
fn hint_of_owners(option: &str) -> Option<String> {
    let has = |entry: &&Entry| entry.options().iter().any(|known| same_name(known.name, option));
    let owners: Vec<&str> = SOLVERS.iter().filter(has).map(|entry| entry.info.name).collect();
    let verb = if owners.len() == 1 { "has" } else { "have" };
    (!owners.is_empty()).then(|| format!("{} {verb} it; ", owners.join(", ")))
}

/// Returns the registry's entry of this name. Upper and lower case, "-" and "_" make no difference.
///
/// # Errors
/// An unknown name; the error lists the known ones.
pub fn find(name: &str) -> Result<&'static Entry> {
    error::find("solver", name, SOLVERS, |entry| entry.info.name)
}

/// Returns the error for an argument that the solver `name` does not use; it lists the solvers that do.
pub fn unused(argument: &str, name: &str, uses: fn(&Info) -> bool) -> Error {
    let users: Vec<&str> = SOLVERS.iter().map(|entry| entry.info).filter(|info| uses(info)).map(|i| i.name).collect();
    let cure = if users.is_empty() {
        String::from("leave it out, no solver here uses it")
    } else {
        format!("leave it out, or take one that uses it: {}", users.join(", "))
    };
    Error::invalid(argument, format!("given to \"{name}\""), cure)
}

/// Creates the solver of a choice, for an array of some quantization, which may give options their defaults.
///
/// # Errors
/// An unknown name or option, a value out of range, or an aim for a solver that uses none.
pub fn configure(choice: &Choice, quantization: Option<&Quantization>) -> Result<Configured> {
    let made = find(&choice.name)?.configure_for(&choice.options, quantization)?;
    refuse_if!(choice.aim.is_some() && !made.info.uses_aim, unused("aim", made.info.name, |info| info.uses_aim));
    Ok(made)
}
