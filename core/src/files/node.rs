//! Node: a document in TOML or JSON as a tree of values, before they are interpreted.

use crate::prelude::*;

/// A value of a document.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// JSON's null.
    Null,
    /// True or false.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// A whole number above the range of `i64`.
    Large(u64),
    /// Any other number.
    Real(f64),
    /// A text; in TOML also a date.
    Text(String),
    /// A list of numbers that are not all whole. It is compact, because it may contain a million positions.
    Numbers(Vec<f64>),
    /// Any other list.
    List(Vec<Node>),
    /// A table; each key occurs once.
    Table(Vec<(String, Node)>),
}

impl Node {
    /// The nearest f64 of a number; `None` for other values.
    pub(super) fn real(&self) -> Option<f64> {
        match *self {
            Self::Integer(value) => Some(value as f64),
            Self::Large(value) => Some(value as f64),
            Self::Real(value) => Some(value),
            _ => None,
        }
    }

    /// The value of a key; `None` if this is no table or has no such key.
    pub(super) fn get(&self, key: &str) -> Option<&Self> {
        let Self::Table(entries) = self else { return None };
        entries.iter().find(|(name, _)| name == key).map(|(_, node)| node)
    }

    /// The numbers of a list that contains only numbers.
    pub(super) fn reals(&self) -> Option<Cow<'_, [f64]>> {
        match self {
            Self::Numbers(list) => Some(list.into()),
            Self::List(list) => list.iter().map(Self::real).collect::<Option<Vec<_>>>().map(Cow::Owned),
            _ => None,
        }
    }

    /// Returns a list, in the compact form if it contains only numbers and not all are whole.
    pub fn list(items: Vec<Self>) -> Self {
        let short = items.iter().any(|item| matches!(item, Self::Real(_)));
        let numbers = short.then(|| items.iter().map(Self::real).collect()).flatten();
        numbers.map_or(Self::List(items), Self::Numbers)
    }
}

/// Writes the value in short form on one line, for error messages.
impl fmt::Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("null"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Large(value) => write!(f, "{value}"),
            Self::Real(value) => write!(f, "{value:?}"),
            Self::Text(text) if text.chars().count() > 40 => {
                write!(f, "\"{}...\"", text.chars().take(37).collect::<String>())
            }
            Self::Text(text) => write!(f, "\"{text}\""),
            Self::Numbers(list) => numbers(list, f),
            Self::List(list) => match self.reals() {
                Some(reals) => numbers(&reals, f),
                None if list.len() == 1 && (list[0].reals().is_some() || !matches!(list[0], Self::List(_))) => {
                    write!(f, "[{}]", list[0])
                }
                None => write!(f, "a list of {} values", list.len()),
            },
            Self::Table(table) if table.is_empty() => f.write_str("an empty table"),
            Self::Table(table) => {
                let keys = table.iter().take(4).map(|(key, _)| key.as_str()).collect::<Vec<_>>().join(", ");
                write!(f, "a table of {keys}{}", if table.len() > 4 { ", ..." } else { "" })
            }
        }
    }
}

fn numbers(list: &[f64], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    if list.len() > 8 {
        return write!(f, "a list of {} numbers", list.len());
    }
    write!(f, "[{}]", list.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
}
