//! Syntax errors of TOML and JSON, with messages for users of scene files.

use crate::files::{Format, Node, Source, schema};
use crate::prelude::*;

/// The most keys of a table, far more than any table needs. Each key is compared with all others of its table; the limit keeps
/// this fast.
const MOST_KEYS: usize = 256;

/// A syntax error, and its offset in the text if known.
pub(super) struct Flaw {
    at: Option<usize>,
    reason: String,
}

impl Flaw {
    pub(super) fn new(at: impl Into<Option<usize>>, reason: impl Into<String>) -> Self {
        Self { at: at.into(), reason: reason.into() }
    }

    /// The error for a document that exceeds the depth limit of a parser.
    pub(super) fn nested(at: impl Into<Option<usize>>) -> Self {
        Self::new(at, "nested too deep: give at most four levels of brackets")
    }

    pub(super) fn too_large(at: impl Into<Option<usize>>) -> Self {
        Self::new(at, "a number too large for any computer: give fewer digits")
    }

    pub(super) fn twice(at: impl Into<Option<usize>>, key: &str) -> Self {
        Self::new(at, format!("the key \"{key}\" is written twice: keep one of them"))
    }

    /// Checks that a table does not have the key already, and that it has not too many keys.
    pub(super) fn check_key(at: usize, key: &str, entries: &[(String, Node)]) -> Result<(), Self> {
        refuse_if!(entries.iter().any(|(known, _)| known == key), Self::twice(at, key));
        if entries.len() == MOST_KEYS {
            let reason = "a table has more keys than a scene file knows: remove what is none of its keys";
            return Err(Self::new(at, reason));
        }
        Ok(())
    }

    /// Replaces the reason if the text seems to be in the other format.
    pub(super) fn or_foreign(self, foreign: bool, reason: &str) -> Self {
        if foreign { Self::new(self.at, reason) } else { self }
    }

    /// Returns the complete error. If the key near the error is known, the example is a correct line for it.
    pub(super) fn reported(self, text: &str, format: Format, source: Source<'_>) -> Error {
        let before = self.at.and_then(|at| text.get(..at));
        let key = |word: &str| schema::example_of_key(word, format);
        let example = before.and_then(|before| match format {
            // In TOML, a line begins with its key.
            Format::Toml => {
                let line = text.get(before.rfind('\n').map_or(0, |end| end + 1)..)?.lines().next()?;
                let line = line.trim_start_matches(['[', ' ', '\t']);
                key(line.split(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_')).next()?)
            }
            Format::Json => before.rsplit('"').take(64).find_map(key),
        });
        let example = example.or_else(|| schema::example("array", format)).unwrap_or_default();
        let mut error = Error::unreadable("", self.reason, "");
        error.example = example;
        source.fault(self.at.map(|at| (text, at)), error)
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}

/// Where a path leads in the text of a document: the offset of the last value that exists, the offset of its key, and how many
/// steps of the path lead there.
pub(super) struct Place {
    pub(super) value: usize,
    pub(super) key: usize,
    pub(super) steps: usize,
}

/// One step of a path: a key of a table or an index of a list.
#[derive(Clone, Copy)]
pub(super) enum Step<'a> {
    Key(&'a str),
    Index(usize),
}
