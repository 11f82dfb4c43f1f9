//! Choice: a solver by its name and its options, as in a scene file or a binding.

use crate::prelude::*;
use crate::scene::{Aim, OptionValue, Options, Value};

/// The solver in a scene file: its name, its options, whether to balance, and the aim.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The solver's name in the registry.
    pub name: String,
    /// The given options; all others keep their defaults.
    pub options: Options,
    /// Whether to balance the levels of the points; `None` stands for the method's default.
    pub balance: Option<bool>,
    /// The aim, for a method that has one; `None` stands for the aim of the problem.
    pub aim: Option<Aim>,
}

impl Choice {
    /// Splits a table of options: `balance` and `aim` are read here, all others belong to the solver.
    ///
    /// # Errors
    /// A `balance` that is not true or false, an `aim` that is unknown. [`crate::solvers::configure`] checks the name and the
    /// options.
    pub fn new(name: String, options: Options) -> Result<Self> {
        let (mut rest, mut balance, mut aim) = (Options::new(), None, None);
        for (key, value) in options {
            match &key {
                key if balance.is_none() && same_name(key, "balance") => balance = Some(value),
                key if aim.is_none() && same_name(key, "aim") => aim = Some(value),
                _ => {
                    rest.insert(key, value);
                }
            }
        }
        let balance = match balance {
            None => None,
            Some(Value::Bool(balance)) => Some(balance),
            Some(other) => return Err(Error::invalid("solver.balance", other, "give true or false")),
        };
        let aim = aim.map(|aim| Aim::read("solver.aim", &aim)).transpose()?;
        Ok(Self { name, options: rest, balance, aim })
    }

    /// Returns the table of options, with `balance` and `aim` if they are given: the inverse of [`Self::new`].
    pub fn table(&self) -> Options {
        let mut table = self.options.clone();
        if let Some(balance) = self.balance {
            table.insert("balance".into(), Value::Bool(balance));
        }
        if let Some(aim) = self.aim {
            table.insert("aim".into(), aim.show());
        }
        table
    }
}
