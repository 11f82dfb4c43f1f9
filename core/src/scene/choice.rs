//! A solver by its name and options, as in a scene file or a binding.

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
    /// Whether to balance; left out it is the method's default.
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
    pub fn new(name: String, options: Options) -> Result<Self, Error> {
        let (mut own, mut balance, mut aim) = (Options::new(), None, None);
        for (key, value) in options {
            match &key {
                key if balance.is_none() && same_name(key, "balance") => balance = Some(value),
                key if aim.is_none() && same_name(key, "aim") => aim = Some(value),
                _ => {
                    own.insert(key, value);
                }
            }
        }
        let balance = match balance {
            None => None,
            Some(Value::Bool(balance)) => Some(balance),
            Some(other) => return Err(Error::invalid("solver.balance", other, "give true or false")),
        };
        let aim = aim.map(|aim| Aim::read("solver.aim", &aim)).transpose()?;
        Ok(Self { name, options: own, balance, aim })
    }

    /// The table it came from.
    #[must_use]
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
