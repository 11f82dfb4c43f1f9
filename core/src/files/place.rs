//! Line and column of an item in a document, found again from its name once there is an error to tell.

use alloc::borrow::Cow;
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::vec::Vec;

use serde_json::value::RawValue;
use toml::de::{DeTable, DeValue};

use crate::files::source::Format;

/// Where the value at a path such as `points[3].pressure` begins, as deep as the path leads in this document: its offset,
/// and how many steps of the path led there.
pub(super) fn find(text: &str, format: Format, path: &str) -> (usize, usize) {
    let steps: Vec<Step<'_>> = steps(path);
    match format {
        Format::Toml => in_toml(text, &steps),
        Format::Json => in_json(text, &steps),
    }
}

/// Where a key of the table at a path is written.
pub(super) fn find_key(text: &str, format: Format, path: &str, key: &str) -> usize {
    let mut steps = steps(path);
    match format {
        Format::Toml => toml_key(text, &steps, key).unwrap_or_else(|| in_toml(text, &steps).0),
        Format::Json => {
            let (table, _) = in_json(text, &steps);
            steps.push(Step::Key(key));
            // The value is found; its key stands in front of it.
            let (value, _) = in_json(text, &steps);
            let quoted = text.get(table..value).and_then(|between| between.rfind(&format!("\"{key}\"")));
            quoted.map_or(value, |start| table + start)
        }
    }
}

/// One step into a document.
#[derive(Clone, Copy)]
enum Step<'a> {
    Key(&'a str),
    Index(usize),
}

fn steps(path: &str) -> Vec<Step<'_>> {
    let parts = path.split(['.', '[']).filter(|part| !part.is_empty());
    parts
        .map(|part| match part.strip_suffix(']').map(str::parse) {
            Some(Ok(index)) => Step::Index(index),
            _ => Step::Key(part),
        })
        .collect()
}

fn in_toml(text: &str, steps: &[Step<'_>]) -> (usize, usize) {
    let Ok(root) = DeTable::parse(text) else { return (0, 0) };
    let (_, offset, depth) = descend(&DeValue::Table(root.into_inner()), steps);
    (offset, depth)
}

/// The value as deep as the steps lead, its offset, and how many steps that were.
fn descend<'a, 'i>(root: &'a DeValue<'i>, steps: &[Step<'_>]) -> (&'a DeValue<'i>, usize, usize) {
    let (mut value, mut offset) = (root, 0);
    for (depth, step) in steps.iter().enumerate() {
        let next = match (value, step) {
            (DeValue::Table(table), Step::Key(key)) => table.get(*key),
            (DeValue::Array(list), Step::Index(index)) => list.get(*index),
            _ => None,
        };
        let Some(next) = next else { return (value, offset, depth) };
        (value, offset) = (next.get_ref(), next.span().start);
    }
    (value, offset, steps.len())
}

/// The offset of a key of the table at a path.
fn toml_key(text: &str, steps: &[Step<'_>], key: &str) -> Option<usize> {
    let root = DeValue::Table(DeTable::parse(text).ok()?.into_inner());
    let (DeValue::Table(table), ..) = descend(&root, steps) else { return None };
    table.keys().find(|known| known.get_ref() == key).map(|known| known.span().start)
}

fn in_json(text: &str, steps: &[Step<'_>]) -> (usize, usize) {
    let offset = |part: &str| part.as_ptr() as usize - text.as_ptr() as usize;
    let mut value = text.trim_start();
    for (depth, step) in steps.iter().enumerate() {
        let next: Option<&RawValue> = match step {
            Step::Key(key) => serde_json::from_str::<BTreeMap<Cow<'_, str>, &RawValue>>(value)
                .ok()
                .and_then(|table| table.get(*key).copied()),
            Step::Index(index) => {
                serde_json::from_str::<Vec<&RawValue>>(value).ok().and_then(|list| list.get(*index).copied())
            }
        };
        let Some(next) = next else { return (offset(value), depth) };
        value = next.get();
    }
    (offset(value), steps.len())
}
