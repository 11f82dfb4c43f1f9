//! TOML, parsed into a tree of values; and the place of a value in the text.

use ::toml::Spanned;
use ::toml::de::{DeInteger, DeTable, DeValue, Error};

use crate::error::one_line;
use crate::files::node::Node;
use crate::files::syntax::{Flaw, Place, Step};
use crate::prelude::*;

/// Whole numbers from 1e38 on are rejected as too large.
const MOST: f64 = 1e38;

/// Parses a TOML text.
pub(super) fn read(text: &str) -> Result<Node, Flaw> {
    let root = DeTable::parse(text).map_err(|error| refused(&error, text))?;
    table(root.into_inner())
}

/// Follows the keys and indices `steps` into a text that has been parsed. Stops at the first one that does not exist.
pub(super) fn find(text: &str, steps: &[Step<'_>]) -> Place {
    let mut place = Place { value: 0, key: 0, steps: 0 };
    let Ok(root) = DeTable::parse(text) else { return place };
    let root = DeValue::Table(root.into_inner());
    let mut value = &root;
    for step in steps {
        let next = match (value, step) {
            (DeValue::Table(table), Step::Key(key)) => {
                table.get_key_value(*key).map(|(key, value)| (key.span(), value))
            }
            (DeValue::Array(list), Step::Index(index)) => list.get(*index).map(|value| (value.span(), value)),
            _ => None,
        };
        let Some((key, next)) = next else { break };
        value = next.get_ref();
        place = Place { value: next.span().start, key: key.start, steps: place.steps + 1 };
    }
    place
}

fn table(table: DeTable<'_>) -> Result<Node, Flaw> {
    // The parser sorts keys by name; this restores the order of the document.
    let mut pairs: Vec<_> = table.into_iter().collect();
    pairs.sort_by_key(|(key, _)| key.span().start);
    let mut entries = Vec::new();
    for (key, value) in pairs {
        let at = key.span().start;
        let key = key.into_inner().into_owned();
        Flaw::check_key(at, &key, &entries)?;
        entries.push((key, node(value)?));
    }
    Ok(Node::Table(entries))
}

fn node(value: Spanned<DeValue<'_>>) -> Result<Node, Flaw> {
    let at = value.span().start;
    let too_large = || Flaw::too_large(at);
    Ok(match value.into_inner() {
        DeValue::String(text) => Node::Text(text.into_owned()),
        DeValue::Integer(value) => integer(&value).ok_or_else(too_large)?,
        DeValue::Float(value) => {
            let (written, value) = (value.as_str(), value.as_str().parse::<f64>().ok());
            let fits = |value: &f64| !value.is_infinite() || written.contains("inf");
            Node::Real(value.filter(fits).ok_or_else(too_large)?)
        }
        DeValue::Boolean(value) => Node::Bool(value),
        DeValue::Datetime(value) => Node::Text(value.to_string()),
        DeValue::Array(list) => Node::list(list.into_iter().map(node).collect::<Result<_, _>>()?),
        DeValue::Table(entries) => table(entries)?,
    })
}

/// A whole number if it fits into 64 bits, else the nearest f64.
fn integer(value: &DeInteger<'_>) -> Option<Node> {
    let (digits, radix) = (value.as_str(), value.radix());
    let large = |_| u64::from_str_radix(digits, radix).map(Node::Large);
    let real = || digits.parse().ok().filter(|value: &f64| radix == 10 && value.abs() < MOST).map(Node::Real);
    i64::from_str_radix(digits, radix).map(Node::Integer).or_else(large).ok().or_else(real)
}

/// Converts an error of the parser to plain words.
fn refused(error: &Error, text: &str) -> Flaw {
    let span = error.span();
    let at = span.as_ref().map(|span| span.start);
    match error.message() {
        message if message.starts_with("duplicate key") => {
            Flaw::twice(at, &span.and_then(|span| text.get(span)).map(one_line).unwrap_or_default())
        }
        message if message.contains("recurs") => Flaw::nested(at),
        message => {
            let what = if message.contains("escape") || message.contains("unicode") {
                // Usually a path of Windows.
                "a backslash in double quotes: take single ones".into()
            } else {
                message.split(", expected").next().unwrap_or(message).replace("unexpected", "stray")
            };
            let flaw = Flaw::new(at, format!("no TOML here ({what})"));
            flaw.or_foreign(text.starts_with('{'), "no TOML, but JSON as it looks: name it .json")
        }
    }
}
