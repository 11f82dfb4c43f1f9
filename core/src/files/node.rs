//! A document of TOML or JSON as a tree of values, before anybody asks what they mean.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde::ser::{Serialize, Serializer};

/// What a table's date is called by the TOML reader.
const DATE: &str = "$__toml_private_datetime";

/// The begin of the error for a key written twice; the key follows.
pub(super) const TWICE: &str = "written twice: ";

/// More keys than any table has; comparing each with each stays cheap.
pub(super) const MOST_KEYS: usize = 256;

/// The error for more.
pub(super) const TOO_MANY: &str = "too many keys";

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

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;

        impl<'de> Visitor<'de> for Any {
            type Value = Node;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a value")
            }

            fn visit_unit<E>(self) -> Result<Node, E> {
                Ok(Node::Null)
            }

            fn visit_bool<E>(self, value: bool) -> Result<Node, E> {
                Ok(Node::Bool(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Node, E> {
                Ok(Node::Integer(value))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Node, E> {
                Ok(i64::try_from(value).map_or(Node::Large(value), Node::Integer))
            }

            fn visit_i128<E>(self, value: i128) -> Result<Node, E> {
                Ok(Node::Real(value as f64))
            }

            fn visit_u128<E>(self, value: u128) -> Result<Node, E> {
                Ok(Node::Real(value as f64))
            }

            fn visit_f64<E>(self, value: f64) -> Result<Node, E> {
                Ok(Node::Real(value))
            }

            fn visit_str<E>(self, text: &str) -> Result<Node, E> {
                Ok(Node::Text(text.into()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Node, A::Error> {
                let (mut numbers, mut list) = (Vec::new(), Vec::new());
                while let Some(node) = items.next_element::<Node>()? {
                    match node.real() {
                        Some(number) if list.is_empty() => numbers.push(number),
                        _ => {
                            list.extend(numbers.drain(..).map(Node::Real));
                            list.push(node);
                        }
                    }
                }
                Ok(if list.is_empty() { Node::Numbers(numbers) } else { Node::List(list) })
            }

            fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Node, A::Error> {
                let mut table: Vec<(String, Node)> = Vec::new();
                while let Some((key, node)) = entries.next_entry::<String, Node>()? {
                    if key == DATE {
                        return Ok(node);
                    }
                    if table.iter().any(|(other, _)| *other == key) {
                        return Err(A::Error::custom(format!("{TWICE}{key}")));
                    }
                    if table.len() == MOST_KEYS {
                        return Err(A::Error::custom(TOO_MANY));
                    }
                    table.push((key, node));
                }
                Ok(Node::Table(table))
            }
        }

        deserializer.deserialize_any(Any)
    }
}

/// As the document that it was read from says it; what is null is left out of a table.
impl Serialize for Node {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Null => serializer.serialize_unit(),
            Self::Bool(value) => serializer.serialize_bool(*value),
            Self::Integer(value) => serializer.serialize_i64(*value),
            Self::Large(value) => serializer.serialize_u64(*value),
            Self::Real(value) => serializer.serialize_f64(*value),
            Self::Text(text) => serializer.serialize_str(text),
            Self::Numbers(list) => serializer.collect_seq(list),
            Self::List(list) => serializer.collect_seq(list),
            Self::Table(entries) => {
                let given = entries.iter().filter(|(_, node)| *node != Self::Null);
                serializer.collect_map(given.map(|(key, node)| (key, node)))
            }
        }
    }
}
