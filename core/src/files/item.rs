//! Items: nodes with their paths, read by kind; and faults, errors with the places to which they belong.

use crate::error::nearest;
use crate::files::{Format, Node, Source, place, schema};
use crate::prelude::*;
use crate::scene::Key;
use crate::solvers::{Entry, SOLVERS};

/// A value in a document, with its path, such as `points[3].pressure`.
pub(super) struct Item<'a> {
    pub(super) path: String,
    pub(super) node: &'a Node,
}

/// A table in a document. All its keys have been checked to be known.
pub(super) struct Table<'a> {
    pub(super) path: String,
    pub(super) entries: &'a [(String, Node)],
}

impl<'a> Item<'a> {
    /// The whole document.
    pub(super) fn root(node: &'a Node) -> Self {
        Self { path: String::new(), node }
    }

    /// Returns an error about this value.
    pub(super) fn refused(&self, cure: &str) -> Fault {
        let name = if self.path.is_empty() { "the document" } else { &self.path };
        Fault::at(self.path.as_str(), Error::wrong_type(name, self.node, cure))
    }

    /// Converts an error of the drawing function, such as `radius is -0.03: give a number above 0`, to an error about that key
    /// of this table. Another error keeps its parts, and gets the place of the table.
    pub(super) fn reported(&self, error: Error) -> Fault {
        // A key such as `am.frequency` is one of an inner table, an item such as `samples[2]` one of a list.
        let known = schema::keys(&self.path).any(|known| error.item.split(['.', '[']).next() == Some(known));
        if error.item.is_empty() {
            return self.refused(&error.to_string());
        }
        if !known {
            return Fault::at(self.path.as_str(), error);
        }
        let path = format!("{}.{}", self.path, error.item);
        match error.code {
            ErrorCode::Unknown => Fault::at(path, error),
            _ => Fault::at(path.as_str(), error.about(path.as_str())),
        }
    }

    pub(super) fn real(&self) -> Read<f64> {
        self.node.real().ok_or_else(|| self.refused("give a number"))
    }

    /// Returns a whole number. A number beyond i64 becomes the largest i64, which range checks reject later.
    pub(super) fn integer(&self) -> Read<i64> {
        match *self.node {
            Node::Integer(value) => Ok(value),
            Node::Large(_) => Ok(i64::MAX),
            _ => Err(self.refused("give a whole number")),
        }
    }

    /// A count. A negative number is an error here; the caller rejects 0.
    pub(super) fn count(&self) -> Read<usize> {
        usize::try_from(self.integer()?).map_err(|_| self.refused("give at least 1"))
    }

    pub(super) fn text(&self) -> Read<&'a str> {
        match self.node {
            Node::Text(text) => Ok(text),
            _ => Err(self.refused("give a name in quotes")),
        }
    }

    /// A list of exactly N numbers.
    pub(super) fn numbers<const N: usize>(&self) -> Read<[f64; N]> {
        self.some(N).map(|list| core::array::from_fn(|k| list[k]))
    }

    /// A list of exactly `count` numbers.
    pub(super) fn some(&self, count: usize) -> Read<Vec<f64>> {
        let numbers = self.node.reals().filter(|list| list.len() == count);
        numbers.map(Cow::into_owned).ok_or_else(|| self.refused(&format!("give {count} numbers")))
    }

    /// Returns the value as a list of numbers.
    pub(super) fn reals(&self) -> Read<Vec<f64>> {
        let numbers = self.node.reals().ok_or_else(|| self.refused("give a list of numbers"))?;
        Ok(numbers.into_owned())
    }

    /// A list of lists of N numbers.
    pub(super) fn vectors<const N: usize>(&self) -> Read<Vec<[f64; N]>> {
        self.each(Item::numbers, &format!("give a list of lists of {N} numbers"))
    }

    /// A finite number of at least 0.
    pub(super) fn least_zero(&self) -> Read<f64> {
        let number = self.real()?;
        if number >= 0.0 && number.is_finite() { Ok(number) } else { Err(self.refused("give a number of at least 0")) }
    }

    pub(super) fn flag(&self) -> Read<bool> {
        match self.node {
            Node::Bool(flag) => Ok(*flag),
            _ => Err(self.refused("give true or false")),
        }
    }

    /// A list of truth values.
    pub(super) fn flags(&self) -> Read<Vec<bool>> {
        self.each(Item::flag, "give a list of true and false")
    }

    /// A list of whole numbers of 0 or above.
    pub(super) fn indices(&self) -> Read<Vec<usize>> {
        let cure = "give a list of whole numbers of 0 or above";
        let index = |number: f64| (number.fract() == 0.0 && (0.0..1e9).contains(&number)).then_some(number as usize);
        let numbers = self.node.reals().ok_or_else(|| self.refused(cure))?;
        numbers.iter().map(|&number| index(number).ok_or_else(|| self.refused(cure))).collect()
    }

    /// Reads every value of a list; `cure` is the cure in the error if the value is not a list.
    pub(super) fn each<T>(&self, read: impl Fn(&Item<'a>) -> Read<T>, cure: &str) -> Read<Vec<T>> {
        let list = match self.node {
            Node::List(list) if list.is_empty() || self.node.reals().is_none() => list,
            _ => return Err(self.refused(cure)),
        };
        let item = |index: usize| Item { path: format!("{}[{index}]", self.path), node: &list[index] };
        (0..list.len()).map(|index| read(&item(index))).collect()
    }

    /// A table whose keys must be in the schema.
    pub(super) fn table(&self) -> Read<Table<'a>> {
        self.table_of(&schema::keys(&self.path).collect::<Vec<_>>())
    }

    /// A table whose keys must be among `known`.
    pub(super) fn table_of(&self, known: &[&str]) -> Read<Table<'a>> {
        let table = self.open_table()?;
        for (key, _) in table.entries {
            if !known.contains(&key.as_str()) {
                let kind = if self.path.is_empty() { "key".into() } else { format!("key of {}", self.path) };
                let mut error = Error::unknown(kind, key, known.iter().copied());
                if let Some(now) = schema::renamed(&self.path, key) {
                    error.hint = format!("it is called {now}; ");
                }
                return Err(Fault::key(self.path.as_str(), key, error));
            }
        }
        Ok(table)
    }

    /// A table with any keys.
    pub(super) fn open_table(&self) -> Read<Table<'a>> {
        match self.node {
            Node::Table(entries) => Ok(Table { path: self.path.clone(), entries }),
            _ => Err(self.refused("give a table")),
        }
    }
}

impl<'a> Table<'a> {
    /// The value of a key; `None` if it is missing or null.
    pub(super) fn get(&self, key: &str) -> Option<Item<'a>> {
        let (_, node) = self.entries.iter().find(|(name, node)| name == key && *node != Node::Null)?;
        Some(Item { path: self.path_of(key), node })
    }

    /// Reads the value of a key as a type; `None` if it is missing.
    pub(super) fn read<T>(&self, key: &str, read: impl FnOnce(&Item<'a>) -> Read<T>) -> Read<Option<T>> {
        self.get(key).map(|item| read(&item)).transpose()
    }

    /// The numbers of the given keys among `keys`, each with its name.
    pub(super) fn reals(&self, keys: &[Key]) -> Read<Vec<(&'static str, f64)>> {
        let items = keys.iter().filter_map(|key| self.get(key.name).map(|item| (key.name, item)));
        items.map(|(name, item)| Ok((name, item.real()?))).collect()
    }

    /// The value of a required key.
    pub(super) fn need(&self, key: &str) -> Read<Item<'a>> {
        self.get(key).ok_or_else(|| {
            let path = self.path_of(key);
            Fault::at(path.as_str(), Error::missing(path.as_str(), "left out", "give one"))
        })
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.into() } else { format!("{}.{key}", self.path) }
    }
}

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

/// What is read of an item, or its fault.
pub(super) type Read<T> = Result<T, Fault>;

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

/// A kind: its name, its required keys, and its optional keys.
pub(super) type Kind = (&'static str, &'static [&'static str], &'static [&'static str]);

/// Returns the kind of a table, and the table. All its keys must belong to the kind or be `common` to all kinds.
pub(super) fn of_kind<'a>(item: &Item<'a>, kinds: &[Kind], common: &[&str]) -> Read<(&'static str, Table<'a>)> {
    let table = item.table()?;
    let names = || kinds.iter().map(|(name, ..)| *name).collect::<Vec<_>>().join(", ");
    let Some(kind) = table.get("kind") else { return Err(left_out(item, "kind", format!("give one of {}", names()))) };
    let name = kind.text()?;
    let Some(&(name, needed, others)) = kinds.iter().find(|(known, ..)| *known == name) else {
        return Err(kind.refused(&format!("give one of {}", names())));
    };
    let keys: Vec<&str> = needed.iter().chain(others).copied().collect();
    for (key, _) in table.entries.iter().filter(|(_, node)| *node != Node::Null) {
        if key != "kind" && !common.contains(&&**key) && !keys.contains(&&**key) {
            let cure = format!("{name} has {}, leave it out", [&keys, common].concat().join(", "));
            return Err(table.need(key)?.refused(&cure));
        }
    }
    match needed.iter().find(|key| table.get(key).is_none()) {
        Some(key) => Err(left_out(item, key, format!("{name} needs {}", needed.join(", ")))),
        None => Ok((name, table)),
    }
}

fn left_out(item: &Item<'_>, key: &str, cure: String) -> Fault {
    let path = format!("{}.{key}", item.path);
    Fault::at(path.as_str(), Error::missing(path.as_str(), "left out", cure))
}
