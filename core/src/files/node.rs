//! A document of TOML or JSON as a tree of values, not yet interpreted.

use alloc::borrow::Cow;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;

/// A value of a document.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::exhaustive_enums, reason = "the values of TOML and JSON")]
pub enum Node {
    /// JSON's null.
    Null,
    /// True or false.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// A whole number beyond `i64`.
    Large(u64),
    /// Any other number.
    Real(f64),
    /// Text, in TOML also a date.
    Text(String),
    /// A list of numbers that are not all whole; it may be a million positions' coordinates.
    Numbers(Vec<f64>),
    /// Any other list.
    List(Vec<Node>),
    /// A table, each key once.
    Table(Vec<(String, Node)>),
}

impl Node {
    /// A number as the nearest f64.
    pub(super) fn real(&self) -> Option<f64> {
        match *self {
            Self::Integer(value) => Some(value as f64),
            Self::Large(value) => Some(value as f64),
            Self::Real(value) => Some(value),
            _ => None,
        }
    }

    /// A key's value, where this is a table that has it.
    pub(super) fn get(&self, key: &str) -> Option<&Self> {
        let Self::Table(entries) = self else { return None };
        entries.iter().find(|(name, _)| name == key).map(|(_, node)| node)
    }

    /// The numbers of a list that has nothing else.
    pub(super) fn reals(&self) -> Option<Cow<'_, [f64]>> {
        match self {
            Self::Numbers(list) => Some(list.into()),
            Self::List(list) => list.iter().map(Self::real).collect::<Option<Vec<_>>>().map(Cow::Owned),
            _ => None,
        }
    }

    /// A list, in its short form if it contains only numbers. Whole numbers stay whole.
    pub(super) fn list(items: Vec<Self>) -> Self {
        let short = items.iter().any(|item| matches!(item, Self::Real(_)));
        let numbers = short.then(|| items.iter().map(Self::real).collect()).flatten();
        numbers.map_or(Self::List(items), Self::Numbers)
    }
}

/// Short, on one line, as the reader of an error may recognise it.
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
