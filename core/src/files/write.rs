//! Writes a tree of values as TOML or JSON.

use core::fmt::Write;
use core::slice;

use crate::files::node::Node;
use crate::prelude::*;

/// Writes a value as JSON, each level indented by two more spaces. `line` is a line break with the indentation of this level.
pub(super) fn json(node: &Node, line: &str, text: &mut String) {
    let inner = format!("{line}  ");
    let mut before = "";
    let mut item = |open: &str, key: Option<&str>, node: &Node, text: &mut String| {
        text.push_str(if before.is_empty() { open } else { before });
        before = ",";
        text.push_str(&inner);
        if let Some(key) = key {
            quoted(key, text);
            text.push_str(": ");
        }
        json(node, &inner, text);
    };
    let (empty, close) = match node {
        Node::Table(entries) => {
            for (key, node) in without_nulls(entries) {
                item("{", Some(key), node, text);
            }
            ("{}", "}")
        }
        Node::List(list) => {
            for node in list {
                item("[", None, node, text);
            }
            ("[]", "]")
        }
        Node::Numbers(numbers) => {
            for &number in numbers {
                item("[", None, &Node::Real(number), text);
            }
            ("[]", "]")
        }
        Node::Real(value) if !value.is_finite() => return text.push_str("null"),
        _ => return scalar(node, text),
    };
    if before.is_empty() {
        return text.push_str(empty);
    }
    text.push_str(line);
    text.push_str(close);
}

/// Writes the entries of a table as TOML: first plain values, then tables and lists of tables under their names. Returns `None`
/// for a list with a null, which TOML cannot express.
pub(super) fn toml(path: &str, table: &Node, text: &mut String) -> Option<()> {
    let Node::Table(entries) = table else { return None };
    let (sections, lines): (Vec<_>, Vec<_>) = without_nulls(entries).partition(|(_, node)| is_section(node));
    for (key, node) in lines {
        name(key, text);
        text.push_str(" = ");
        inline(node, text)?;
        text.push('\n');
    }
    for (key, node) in sections {
        let mut path = if path.is_empty() { String::new() } else { format!("{path}.") };
        name(key, &mut path);
        let (tables, header) = match node {
            Node::List(tables) => (&tables[..], format!("[[{path}]]\n")),
            table => (slice::from_ref(table), format!("[{path}]\n")),
        };
        for table in tables {
            if !text.is_empty() {
                text.push('\n');
            }
            text.push_str(&header);
            toml(&path, table, text)?;
        }
    }
    Some(())
}

/// Writes a value as TOML on one line.
fn inline(node: &Node, text: &mut String) -> Option<()> {
    let mut between = "";
    match node {
        Node::Null => return None,
        Node::Table(entries) => {
            text.push('{');
            for (key, node) in without_nulls(entries) {
                text.push_str(if between.is_empty() { " " } else { between });
                name(key, text);
                text.push_str(" = ");
                inline(node, text)?;
                between = ", ";
            }
            text.push_str(if between.is_empty() { "}" } else { " }" });
        }
        Node::List(list) => {
            text.push('[');
            for node in list {
                text.push_str(between);
                inline(node, text)?;
                between = ", ";
            }
            text.push(']');
        }
        Node::Numbers(numbers) => {
            text.push('[');
            for &number in numbers {
                text.push_str(between);
                scalar(&Node::Real(number), text);
                between = ", ";
            }
            text.push(']');
        }
        _ => scalar(node, text),
    }
    Some(())
}

/// Whether TOML writes a value as a section, under a header with its name.
fn is_section(node: &Node) -> bool {
    match node {
        Node::Table(_) => true,
        Node::List(list) => !list.is_empty() && list.iter().all(|node| matches!(node, Node::Table(_))),
        _ => false,
    }
}

/// The entries of a table that are not null; null values are not written.
fn without_nulls(entries: &[(String, Node)]) -> impl Iterator<Item = &(String, Node)> {
    entries.iter().filter(|(_, node)| *node != Node::Null)
}

/// Writes a key in TOML, in quotes if necessary.
fn name(key: &str, text: &mut String) {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
    if !key.is_empty() && key.chars().all(plain) { text.push_str(key) } else { quoted(key, text) }
}

/// Writes a value that both formats write alike.
fn scalar(node: &Node, text: &mut String) {
    match node {
        Node::Text(words) => quoted(words, text),
        Node::Real(value) if value.is_nan() => text.push_str("nan"),
        other => text.push_str(&other.to_string()),
    }
}

fn quoted(words: &str, text: &mut String) {
    text.push('"');
    for letter in words.chars() {
        match letter {
            '"' | '\\' => text.extend(['\\', letter]),
            '\n' => text.push_str("\\n"),
            '\t' => text.push_str("\\t"),
            '\0'..='\x1f' | '\x7f' => {
                let _ = write!(text, "\\u{:04x}", u32::from(letter));
            }
            _ => text.push(letter),
        }
    }
    text.push('"');
}

#[cfg(test)]
#[path = "tests/write.rs"]
mod tests;
