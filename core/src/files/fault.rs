//! Fault: an error in a document, reported with the document's name, the line and column, and a correct line as an example.

use crate::error::{nearest, same_name};
use crate::files::source::{Format, Source};
use crate::files::{place, schema};
use crate::prelude::*;
use crate::solvers::{Entry, SOLVERS};

/// An error, and the item of the document that caused it.
pub(super) struct Fault {
    error: Error,
    at: At,
}

enum At {
    /// The item that the error itself names.
    Own,
    /// The value at a path.
    Value(String),
    /// A key of the table at a path.
    Key(String, String),
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self { error, at: At::Own }
    }
}

impl Fault {
    /// Returns an error about the value at a path.
    pub(super) fn at(path: impl Into<String>, error: Error) -> Self {
        Self { error, at: At::Value(path.into()) }
    }

    /// Returns an error about a key of the table at a path.
    pub(super) fn key(table: impl Into<String>, key: impl Into<String>, error: Error) -> Self {
        Self { error, at: At::Key(table.into(), key.into()) }
    }

    /// Returns the error about the same item within another table than `table`, unless its place is known already.
    pub(super) fn within(self, table: &str, other: &str) -> Self {
        let inner = |item: &str| item.strip_prefix(table).map(|rest| format!("{other}{rest}"));
        let at = match self.at {
            At::Value(path) if !path.starts_with(other) => At::Value(inner(&path).unwrap_or(path)),
            at => at,
        };
        match inner(&self.error.item) {
            Some(item) if !self.error.item.starts_with(other) => Self { error: self.error.about(item), at },
            _ => Self { error: self.error, at },
        }
    }

    /// Returns the error about a key of a table that stands in no document: without the table's path.
    pub(super) fn bare(self, table: &str) -> Error {
        let key = self.error.item.strip_prefix(table).and_then(|key| key.strip_prefix('.')).map(String::from);
        match key {
            Some(key) => self.error.about(key),
            None => self.error,
        }
    }

    /// Returns the complete error: `bowl.toml, line 12, column 12: points[1].pressure is "loud": give a number; for example
    /// pressure = 500.0`.
    pub(super) fn reported(self, text: &str, format: Format, source: Source<'_>) -> Error {
        let mut error = self.error;
        if !error.place.is_empty() {
            return error;
        }
        let (offset, example) = match &self.at {
            At::Key(table, key) => {
                (Some(place::find_key(text, format, table, key)), example_of_key(table, key, format))
            }
            At::Value(path) => (Some(place::find(text, format, path)), example(path, format)),
            At::Own => {
                let path = in_document(text, format, &error.item);
                let offset = path.as_ref().map(|path| place::find(text, format, path));
                (offset, path.and_then(|path| example(&path, format)))
            }
        };
        error.example = example.unwrap_or_default();
        source.fault(offset.map(|offset| (text, offset)), error)
    }
}

/// Returns the path in the document for the item that an error of the core names. For `phases` it is the solver's
/// option, for `pressures` the pressure of a point.
fn in_document(text: &str, format: Format, item: &str) -> Option<String> {
    let item = match item {
        "pressures" => "points[0].pressure",
        "weights" => "points[0].weight",
        // Items such as "array.grid nx * ny" begin with the path.
        other => other.split(' ').next().unwrap_or(other),
    };
    let tables = ["", "array.", "solver.", "medium.", "plane."];
    let paths = tables.map(|table| format!("{table}{item}"));
    let written = paths.iter().find(|path| place::whole(text, format, path).is_some());
    // A key that is missing has no place in the text; its path is known from the schema.
    let known = || paths.iter().find(|path| schema::example(path, format).is_some());
    written.or_else(known).cloned()
}

fn example(path: &str, format: Format) -> Option<String> {
    let option = path.strip_prefix("solver.").filter(|key| schema::keys("solver").all(|known| known != *key));
    option.map_or_else(|| schema::example(path, format), |option| example_of_option(option, format))
}

/// Returns an example for the key that was probably meant by an unknown key.
fn example_of_key(table: &str, key: &str, format: Format) -> Option<String> {
    let known = schema::keys(table);
    let meant = schema::renamed(table, key).or_else(|| nearest(key, &known.collect::<Vec<_>>()));
    let has = |entry: &&Entry| entry.options().iter().any(|option| same_name(option.name, key));
    match (meant, table) {
        (Some(meant), _) => schema::example(&format!("{table}.{meant}"), format),
        // The option belongs to another solver: the example names that solver.
        (None, "solver") => match SOLVERS.iter().find(has) {
            Some(owner) => Some(schema::line("solver", "name", &format!("\"{}\"", owner.info.name), format)),
            None => example_of_option(key, format),
        },
        _ => None,
    }
}

/// Returns an example for an option of a solver, or for the most similar one.
fn example_of_option(key: &str, format: Format) -> Option<String> {
    let options: Vec<_> = SOLVERS.iter().flat_map(Entry::options).collect();
    let names: Vec<_> = options.iter().map(|option| option.name).collect();
    let name = nearest(key, &names)?;
    let option = options.iter().find(|option| option.name == name)?;
    Some(schema::line("solver", name, &option.default.to_string(), format))
}
