//! A document of TOML or JSON as a tree of values, before anybody asks what they mean.

use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;

/// A value of a document.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Null,
    Bool(bool),
    Integer(i64),
    Large(u64),
    Real(f64),
    Text(String),
    /// A list of nothing but numbers, which may be a million positions' coordinates.
    Numbers(Vec<f64>),
    List(Vec<Node>),
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

    /// A list, in its short form where it has nothing but numbers.
    pub(super) fn list(items: Vec<Self>) -> Self {
        let numbers: Option<Vec<f64>> = items.iter().map(Self::real).collect();
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
            Self::Numbers(list) if list.len() <= 8 => {
                write!(f, "[{}]", list.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
            }
            Self::Numbers(list) => write!(f, "a list of {} numbers", list.len()),
            Self::List(list) if list.is_empty() => f.write_str("[]"),
            Self::List(list) if list.len() == 1 && !matches!(list[0], Self::List(_)) => write!(f, "[{}]", list[0]),
            Self::List(list) => write!(f, "a list of {} values", list.len()),
            Self::Table(table) if table.is_empty() => f.write_str("an empty table"),
            Self::Table(table) => {
                let keys = table.iter().take(4).map(|(key, _)| key.as_str()).collect::<Vec<_>>().join(", ");
                write!(f, "a table of {keys}{}", if table.len() > 4 { ", ..." } else { "" })
            }
        }
    }
}
