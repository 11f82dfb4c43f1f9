//! Syntax errors of TOML and JSON, in words for users of scene files.

use alloc::format;
use alloc::string::String;
use core::fmt;

use crate::error::Error;
use crate::files::node::Node;
use crate::files::schema;
use crate::files::source::{Format, Source};

/// More keys than any table has; comparing each with each stays cheap.
const MOST_KEYS: usize = 256;

/// The fault in a text, and its place if known.
pub(super) struct Flaw {
    at: Option<usize>,
    reason: String,
}

impl Flaw {
    pub(super) fn new(at: impl Into<Option<usize>>, reason: impl Into<String>) -> Self {
        Self { at: at.into(), reason: reason.into() }
    }

    /// The parsers stop at some such depth.
    pub(super) fn nested(at: impl Into<Option<usize>>) -> Self {
        Self::new(at, "nested too deep: a scene file needs four levels of brackets at most")
    }

    pub(super) fn too_large(at: impl Into<Option<usize>>) -> Self {
        Self::new(at, "a number too large for any computer: give fewer digits")
    }

    pub(super) fn twice(at: impl Into<Option<usize>>, key: &str) -> Self {
        Self::new(at, format!("the key \"{key}\" is written twice: keep one of them"))
    }

    /// Refuses a key that a table has already, or one too many.
    pub(super) fn check_key(at: usize, key: &str, entries: &[(String, Node)]) -> Result<(), Self> {
        if entries.iter().any(|(known, _)| known == key) {
            return Err(Self::twice(at, key));
        }
        if entries.len() == MOST_KEYS {
            let reason = "a table has more keys than a scene file knows: remove what is none of its keys";
            return Err(Self::new(at, reason));
        }
        Ok(())
    }

    /// The same of a text that may be of the other format.
    pub(super) fn or_foreign(self, foreign: bool, reason: &str) -> Self {
        if foreign { Self::new(self.at, reason) } else { self }
    }

    /// The fault with a line as it would be correct, of the key where the text goes wrong, where it is known.
    pub(super) fn reported(self, text: &str, format: Format, source: Source<'_>) -> Error {
        let before = self.at.and_then(|at| text.get(..at));
        let key = |word: &str| schema::example_of_key(word, format);
        let example = before.and_then(|before| match format {
            // A line of TOML begins with its key.
            Format::Toml => {
                let line = text.get(before.rfind('\n').map_or(0, |end| end + 1)..)?.lines().next()?;
                let line = line.trim_start_matches(['[', ' ', '\t']);
                key(line.split(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_')).next()?)
            }
            Format::Json => before.rsplit('"').take(64).find_map(key),
        });
        let example = example.or_else(|| schema::example("array", format)).unwrap_or_default();
        source.fault(self.at.map(|at| (text, at)), &format!("{}; for example {example}", self.reason))
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}
