//! A solver by its name and options, as a scene file or a door writes it down.

use alloc::string::String;

use crate::error::{Error, same_name};
use crate::scene::aim::Aim;
use crate::scene::value::{OptionValue, Options, Value};

/// The solver of a scene file: its name, its options, whether to balance, and the aim.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The name in the registry.
    pub name: String,
    /// The options set; the others keep their defaults.
    pub options: Options,
    /// Whether to balance; left out it is the method's own habit.
    pub balance: Option<bool>,
    /// The aim, for a method that uses one; left out it is the problem's own.
    pub aim: Option<Aim>,
}

impl Choice {
    /// A choice from a table of options, in which `balance` and `aim` are the entry point's, all else the solver's.
    ///
    /// # Errors
    /// A `balance` that is neither true nor false, an `aim` that is none. Name and options are checked by
    /// [`crate::solvers::configure`].
    pub fn new(name: String, mut options: Options) -> Result<Self, Error> {
        let mut take = |name: &str| {
            let key = options.keys().find(|key| same_name(key, name))?.clone();
            options.remove(&key)
        };
        let (balance, aim) = (take("balance"), take("aim"));
        let balance = match balance {
            None => None,
            Some(Value::Bool(balance)) => Some(balance),
            Some(other) => return Err(Error::invalid("solver.balance", other, "give true or false")),
        };
        let aim = aim.map(|aim| Aim::read("solver.aim", &aim)).transpose()?;
        Ok(Self { name, options, balance, aim })
    }

    /// The table it came from.
    #[must_use]
    pub fn table(&self) -> Options {
        let balance = self.balance.map(|balance| ("balance".into(), Value::Bool(balance)));
        let aim = self.aim.map(|aim| ("aim".into(), aim.show()));
        self.options.clone().into_iter().chain(balance).chain(aim).collect()
    }
}
