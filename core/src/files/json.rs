//! JSON, parsed by `serde_json` into a tree of values; and the place of a value in the text.

use alloc::collections::BTreeMap;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;
use serde_json::{Error, from_str};

use crate::files::node::Node;
use crate::files::syntax::{Flaw, Place, Step};
use crate::prelude::*;

/// How each message of the parser begins, and the reason that users read instead.
const REASONS: [(&str, &str); 13] = [
    ("EOF", "the text ends before its last bracket, brace or quote is closed"),
    ("expected value", NO_VALUE),
    ("expected ident", NO_VALUE),
    ("expected `:`", "a colon is missing after a key"),
    ("expected `,`", "a comma or a closing bracket is missing"),
    ("trailing comma", "a comma before a closing bracket"),
    ("trailing characters", "text after the end of the table"),
    ("key must be a string", "a key without double quotes"),
    ("control character", "a line break or tab within quotes"),
    ("invalid number", "a number that JSON does not know: a digit before and after the point"),
    ("invalid escape", NO_ESCAPE),
    ("lone leading surrogate", NO_ESCAPE),
    ("unexpected end of hex escape", NO_ESCAPE),
];
const NO_VALUE: &str = "a value is missing, or not a number, \"text\" in double quotes, true, false, [list] or {table}";
const NO_ESCAPE: &str = "a backslash that escapes nothing";

/// Parses a JSON text.
pub(super) fn read(text: &str) -> Result<Node, Flaw> {
    from_str(text).map_err(|error| {
        let foreign = !text.trim_start().starts_with(['{', '[']);
        refused(&error, text).or_foreign(foreign, "no JSON, but TOML as it looks: name it .toml")
    })
}

/// Parses a list of rows of numbers: lists without names, or tables of the names of the first; else the reason. A value that
/// is no number is NaN.
pub(super) fn rows(text: &str) -> Result<(Vec<String>, Vec<Vec<f64>>), String> {
    let node = read(text).map_err(|flaw| flaw.to_string())?;
    let Node::List(list) = &node else { return Err("no list of rows".into()) };
    let Some(Node::Table(first)) = list.first() else {
        let rows = list.iter().map(|row| row.reals().map(Cow::into_owned)).collect::<Option<_>>();
        return Ok((Vec::new(), rows.ok_or("no list of rows of numbers")?));
    };
    let names: Vec<String> = first.iter().map(|(key, _)| key.clone()).collect();
    let number = |row: &Node, name: &String| row.get(name).and_then(Node::real).unwrap_or(f64::NAN);
    let rows = list.iter().map(|row| names.iter().map(|name| number(row, name)).collect()).collect();
    Ok((names, rows))
}

/// Follows the keys and indices `steps` into a text that has been parsed. Stops at the first one that does not exist.
pub(super) fn find(text: &str, steps: &[Step<'_>]) -> Place {
    let start = text.len() - text.trim_start().len();
    let (mut place, mut rest) = (Place { value: start, key: start, steps: 0 }, text);
    for step in steps {
        let value: Option<&RawValue> = match *step {
            Step::Key(key) => from_str::<BTreeMap<String, _>>(rest).ok().and_then(|mut table| table.remove(key)),
            Step::Index(index) => from_str::<Vec<_>>(rest).ok().and_then(|list| list.get(index).copied()),
        };
        let Some(value) = value else { break };
        rest = value.get();
        let value = rest.as_ptr().addr() - text.as_ptr().addr();
        let key = match step {
            Step::Key(_) => opening(text[..value].trim_end().trim_end_matches(':')),
            Step::Index(_) => value,
        };
        place = Place { value, key, steps: place.steps + 1 };
    }
    place
}

/// The offset of the key at the end of a text: the last quote before the closing quote that is not escaped by a backslash.
fn opening(text: &str) -> usize {
    let key = text.trim_end().strip_suffix('"').unwrap_or_default();
    let escaped = |at: usize| (at - key[..at].trim_end_matches('\\').len()) % 2 == 1;
    key.rmatch_indices('"').find(|(at, _)| !escaped(*at)).map_or(0, |(at, _)| at)
}

/// Converts an error of the parser, with the byte that the parser read last.
fn refused(error: &Error, text: &str) -> Flaw {
    let line = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum::<usize>();
    let mut at = (line + error.column()).saturating_sub(1).min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    let said = error.to_string();
    let said = said.rsplit_once(" at line ").map_or(&*said, |(said, _)| said);
    if said.contains("number") {
        at = text[..at].trim_end_matches(|letter: char| letter.is_ascii_digit() || "+-.eE".contains(letter)).len();
    }
    match REASONS.iter().find(|(words, _)| said.starts_with(words)) {
        Some((_, reason)) => Flaw::new(at, format!("no JSON here ({reason})")),
        None if said.starts_with("number out of range") => Flaw::too_large(at),
        None if said.starts_with("recursion") => Flaw::nested(at),
        // Any other message is the error of [`Flaw::check_key`], about the key that was read last.
        None => Flaw::new(opening(text.get(..=at).unwrap_or(text)), said),
    }
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Tree)
    }
}

/// Builds a tree of values from the events of the parser.
struct Tree;

impl<'de> Visitor<'de> for Tree {
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

    fn visit_f64<E>(self, value: f64) -> Result<Node, E> {
        Ok(Node::Real(value))
    }

    fn visit_str<E>(self, text: &str) -> Result<Node, E> {
        Ok(Node::Text(text.into()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Node, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = list.next_element()? {
            items.push(item);
        }
        Ok(Node::list(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<Node, A::Error> {
        let mut entries = Vec::new();
        while let Some(key) = table.next_key::<String>()? {
            Flaw::check_key(0, &key, &entries).map_err(A::Error::custom)?;
            entries.push((key, table.next_value()?));
        }
        Ok(Node::Table(entries))
    }
}

#[cfg(test)]
#[path = "tests/json.rs"]
mod tests;
