//! Place: the line and column of an item in a document, for error messages.

use crate::files::syntax::{Place, Step};
use crate::files::{Format, json, toml};
use crate::prelude::*;

/// The offset of the value at a path such as `points[3].pressure`. If the document has no such value, the offset of the nearest
/// one around it.
pub(super) fn find(text: &str, format: Format, path: &str) -> usize {
    follow(text, format, &steps(path)).value
}

/// The offset of the value at a path; `None` if the document has no such value.
pub(super) fn whole(text: &str, format: Format, path: &str) -> Option<usize> {
    let steps = steps(path);
    let place = follow(text, format, &steps);
    (!steps.is_empty() && place.steps == steps.len()).then_some(place.value)
}

/// The offset of a key of the table at a path.
pub(super) fn find_key(text: &str, format: Format, path: &str, key: &str) -> usize {
    let mut steps = steps(path);
    steps.push(Step::Key(key));
    let place = follow(text, format, &steps);
    if place.steps == steps.len() { place.key } else { place.value }
}

fn follow(text: &str, format: Format, steps: &[Step<'_>]) -> Place {
    match format {
        Format::Toml => toml::find(text, steps),
        Format::Json => json::find(text, steps),
    }
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
