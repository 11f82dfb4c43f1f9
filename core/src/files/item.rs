//! Item: a value of a document with its path, and its conversion to a type. Errors name the path.

use alloc::borrow::Cow;

use crate::error::ErrorCode;
use crate::files::fault::Fault;
use crate::files::node::Node;
use crate::files::schema;
use crate::prelude::*;
use crate::scene::Key;

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

    pub(super) fn real(&self) -> Result<f64, Fault> {
        self.node.real().ok_or_else(|| self.refused("give a number"))
    }

    /// Returns a whole number. A number beyond i64 becomes the largest i64, which range checks reject later.
    pub(super) fn integer(&self) -> Result<i64, Fault> {
        match *self.node {
            Node::Integer(value) => Ok(value),
            Node::Large(_) => Ok(i64::MAX),
            _ => Err(self.refused("give a whole number")),
        }
    }

    /// A count. A negative number is an error here; the caller rejects 0.
    pub(super) fn count(&self) -> Result<usize, Fault> {
        usize::try_from(self.integer()?).map_err(|_| self.refused("give at least 1"))
    }

    pub(super) fn text(&self) -> Result<&'a str, Fault> {
        match self.node {
            Node::Text(text) => Ok(text),
            _ => Err(self.refused("give a name in quotes")),
        }
    }

    /// A list of exactly N numbers.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N], Fault> {
        self.some(N).map(|list| core::array::from_fn(|k| list[k]))
    }

    /// A list of exactly `count` numbers.
    pub(super) fn some(&self, count: usize) -> Result<Vec<f64>, Fault> {
        let numbers = self.node.reals().filter(|list| list.len() == count);
        numbers.map(Cow::into_owned).ok_or_else(|| self.refused(&format!("give {count} numbers")))
    }

    /// Returns the value as a list of numbers.
    pub(super) fn reals(&self) -> Result<Vec<f64>, Fault> {
        let numbers = self.node.reals().ok_or_else(|| self.refused("give a list of numbers"))?;
        Ok(numbers.into_owned())
    }

    /// A list of lists of N numbers.
    pub(super) fn vectors<const N: usize>(&self) -> Result<Vec<[f64; N]>, Fault> {
        self.each(Item::numbers, &format!("give a list of lists of {N} numbers"))
    }

    /// A finite number of at least 0.
    pub(super) fn least_zero(&self) -> Result<f64, Fault> {
        let number = self.real()?;
        if number >= 0.0 && number.is_finite() { Ok(number) } else { Err(self.refused("give a number of at least 0")) }
    }

    pub(super) fn flag(&self) -> Result<bool, Fault> {
        match self.node {
            Node::Bool(flag) => Ok(*flag),
            _ => Err(self.refused("give true or false")),
        }
    }

    /// A list of truth values.
    pub(super) fn flags(&self) -> Result<Vec<bool>, Fault> {
        self.each(Item::flag, "give a list of true and false")
    }

    /// A list of whole numbers of 0 or above.
    pub(super) fn indices(&self) -> Result<Vec<usize>, Fault> {
        let cure = "give a list of whole numbers of 0 or above";
        let index = |number: f64| (number.fract() == 0.0 && (0.0..1e9).contains(&number)).then_some(number as usize);
        let numbers = self.node.reals().ok_or_else(|| self.refused(cure))?;
        numbers.iter().map(|&number| index(number).ok_or_else(|| self.refused(cure))).collect()
    }

    /// Reads every value of a list; `cure` is the cure in the error if the value is not a list.
    pub(super) fn each<T>(&self, read: impl Fn(&Item<'a>) -> Result<T, Fault>, cure: &str) -> Result<Vec<T>, Fault> {
        let list = match self.node {
            Node::List(list) if list.is_empty() || self.node.reals().is_none() => list,
            _ => return Err(self.refused(cure)),
        };
        let item = |index: usize| Item { path: format!("{}[{index}]", self.path), node: &list[index] };
        (0..list.len()).map(|index| read(&item(index))).collect()
    }

    /// A table whose keys must be in the schema.
    pub(super) fn table(&self) -> Result<Table<'a>, Fault> {
        self.table_of(&schema::keys(&self.path).collect::<Vec<_>>())
    }

    /// A table whose keys must be among `known`.
    pub(super) fn table_of(&self, known: &[&str]) -> Result<Table<'a>, Fault> {
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
    pub(super) fn open_table(&self) -> Result<Table<'a>, Fault> {
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
    pub(super) fn read<T>(
        &self,
        key: &str,
        read: impl FnOnce(&Item<'a>) -> Result<T, Fault>,
    ) -> Result<Option<T>, Fault> {
        self.get(key).map(|item| read(&item)).transpose()
    }

    /// The numbers of the given keys among `keys`, each with its name.
    pub(super) fn reals(&self, keys: &[Key]) -> Result<Vec<(&'static str, f64)>, Fault> {
        let items = keys.iter().filter_map(|key| self.get(key.name).map(|item| (key.name, item)));
        items.map(|(name, item)| Ok((name, item.real()?))).collect()
    }

    /// The value of a required key.
    pub(super) fn need(&self, key: &str) -> Result<Item<'a>, Fault> {
        self.get(key).ok_or_else(|| {
            let path = self.path_of(key);
            Fault::at(path.as_str(), Error::missing(path.as_str(), "left out", "give one"))
        })
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.into() } else { format!("{}.{key}", self.path) }
    }
}
