//! Errors: one line that names the item, its value and the cure.

use alloc::boxed::Box;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt::Display;

/// A request that cannot be answered. The text of each is one line for a person.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value that cannot be meant.
    #[error("{item} is {value}: {cure}")]
    Invalid {
        /// The item, as in the scene file: `points[3].pressure`.
        item: String,
        /// The value found.
        value: String,
        /// The cure.
        cure: String,
    },
    /// An unknown name.
    #[error("unknown {kind} \"{name}\": {hint}known are {known}")]
    Unknown {
        /// The kind of name that is wrong: `solver`, `preset`, `option of greedy`.
        kind: String,
        /// The name given.
        name: String,
        /// A suggestion that ends in a blank, or an empty text if no known name is near.
        hint: String,
        /// The names that would have done, separated by commas.
        known: String,
    },
    /// A point closer to a transducer than a hundredth of the wavelength, where 1/r has no meaning.
    #[error(
        "points[{point}] is {distance:.3e} m from transducer {transducer}: move it at least {least:.3e} m (a hundredth of the wavelength) away"
    )]
    TooNear {
        /// Index of the point.
        point: usize,
        /// Index of the transducer.
        transducer: usize,
        /// Their distance in metres.
        distance: f64,
        /// The smallest distance allowed, in metres.
        least: f64,
    },
    /// A point with a pressure above 0 at which no transducer has any effect.
    #[error("points[{point}] is reached by no transducer: {cure}")]
    Unreached {
        /// Index of the point.
        point: usize,
        /// The cure.
        cure: &'static str,
    },
    /// One problem of a batch that cannot be answered.
    #[error("problems[{index}]: {error}")]
    InBatch {
        /// Which one.
        index: usize,
        /// Why.
        error: Box<Error>,
    },
    /// One frame of a sequence that cannot be answered.
    #[error("frames[{index}]: {error}")]
    InFrame {
        /// Which one.
        index: usize,
        /// Why.
        error: Box<Error>,
    },
    /// More memory than allowed, or than the machine has.
    #[error(
        "{what} of N = {transducers} transducers and M = {points} points needs {:.3} GB, the limit is {:.3} GB: give fewer points or transducers, a method without it, or a higher limit",
        *bytes as f64 * 1e-9,
        *limit as f64 * 1e-9
    )]
    Memory {
        /// Its purpose.
        what: String,
        /// N.
        transducers: usize,
        /// M.
        points: usize,
        /// Bytes wanted.
        bytes: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// The caller requested a stop before there was an answer.
    #[error("stopped before there was an answer")]
    Stopped,
    /// A scene file, or one that it names, that cannot be read as one.
    #[error("{place}: {reason}")]
    File {
        /// Its name, and the line and column where they are known.
        place: String,
        /// The fault there and its cure.
        reason: String,
    },
}

impl Error {
    /// An [`Error::Invalid`].
    pub fn invalid(item: impl Into<String>, value: impl Display, cure: impl Into<String>) -> Self {
        Self::of_value(&item.into(), &value, cure.into())
    }

    fn of_value(item: &str, value: &dyn Display, cure: String) -> Self {
        Self::Invalid { item: one_line(item), value: one_line(&value.to_string()), cure }
    }

    /// An answer that f32 has lost.
    pub(crate) fn lost() -> Self {
        let cure = "G and the pressures span too many orders of magnitude for this solver: \
                    leave out the points it hardly reaches (weight 0), or choose another";
        Self::invalid("drive", "not finite", cure)
    }

    /// Points for a given G, which has its own points.
    pub(crate) fn given_points() -> Self {
        Self::invalid("points", "given", "a matrix of your own belongs to its points: leave them out")
    }

    /// An [`Error::Unknown`] that lists the names known.
    pub fn unknown<'a>(
        kind: impl Into<String>,
        name: impl Into<String>,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        Self::of_name(kind.into(), &name.into(), &known.into_iter().collect::<Vec<_>>())
    }

    fn of_name(kind: String, name: &str, known: &[&str]) -> Self {
        let hint = nearest(name, known).map_or_else(String::new, |near| format!("did you mean {near}? "));
        Self::Unknown { kind, name: one_line(name), hint, known: known.join(", ") }
    }
}

/// Characters kept of the beginning and the end of a text too long to be read.
const KEPT: [usize; 2] = [240, 160];

/// Text on one line, whatever a user typed: without its middle, where that would fill a page.
pub(crate) fn one_line(text: &str) -> String {
    let words = text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty());
    let line = words.collect::<Vec<_>>().join(" ");
    let [head, tail] = KEPT;
    if line.chars().count() <= head + tail {
        return line;
    }
    let head: String = line.chars().take(head).collect();
    let skipped = line.char_indices().rev().nth(tail - 1).map_or(0, |(start, _)| start);
    format!("{head}...{}", &line[skipped..])
}

/// The letters of a name that tell it from others: case, "-" and "_" do not.
fn letters(name: &str) -> impl Iterator<Item = char> {
    name.chars().filter(|letter| !matches!(letter, '-' | '_')).map(|letter| letter.to_ascii_lowercase())
}

/// Whether two names differ at most in case, "-" and "_".
#[must_use]
pub fn same_name(a: &str, b: &str) -> bool {
    letters(a).eq(letters(b))
}

/// Names in other packages, and the names here.
const ELSEWHERE: [(&str, &str); 11] = [
    ("method", "solver"),
    ("algorithm", "solver"),
    ("iterations", "steps"),
    ("iteration", "steps"),
    ("iters", "steps"),
    ("maxiter", "steps"),
    ("niter", "steps"),
    ("speed_of_sound", "sound_speed"),
    ("spacing", "pitch"),
    ("resolution", "pixels"),
    ("px", "pixels"),
];

/// The known name that a mistyped one probably means: one with at most a third of its letters different, one that
/// begins with it, or the name in other packages.
pub(crate) fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let called_so = |ours: &str| ELSEWHERE.iter().any(|(theirs, other)| *other == ours && same_name(theirs, name));
    if let Some(ours) = known.iter().find(|ours| called_so(ours)) {
        return Some(ours);
    }
    let typed: Vec<char> = letters(name).take(64).collect();
    let distance = |other: &str| {
        let other: Vec<char> = letters(other).collect();
        if typed.len() > 2 && other.starts_with(&typed) { 1 } else { edits(&typed, &other) }
    };
    let (least, near) = known.iter().map(|other| (distance(other), *other)).min_by_key(|(distance, _)| *distance)?;
    (least <= ((typed.len() + 1) / 3).max(1)).then_some(near)
}

/// Letters to insert, remove, replace or swap with their neighbour (optimal string alignment distance).
fn edits(a: &[char], b: &[char]) -> usize {
    let mut rows: Vec<Vec<usize>> = (0..=a.len()).map(|i| (0..=b.len()).map(|j| i.max(j)).collect()).collect();
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            rows[i][j] = replaced.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                rows[i][j] = rows[i][j].min(rows[i - 2][j - 2] + 1);
            }
        }
    }
    rows[a.len()][b.len()]
}

/// The entry of a list that has this name, whatever its case, "-" and "_".
pub(crate) fn find<'a, T>(kind: &str, name: &str, list: &'a [T], of: impl Fn(&T) -> &str) -> Result<&'a T, Error> {
    let found = list.iter().find(|entry| same_name(of(entry), name));
    found.ok_or_else(|| Error::unknown(kind, name, list.iter().map(of)))
}

/// Refuses a list of `found` entries where `count` are needed, one for each of `owners`.
pub(crate) fn one_each(item: &str, found: usize, entries: &str, count: usize, owners: &str) -> Result<(), Error> {
    if found == count {
        return Ok(());
    }
    Err(Error::invalid(item, format!("{found} {entries}"), format!("give one for each of the {count} {owners}")))
}

/// `value` if it is finite and at least `least` (or above it when `strict`), else an error naming `item`.
pub(crate) fn real(item: &str, value: f64, least: f64, strict: bool) -> Result<f64, Error> {
    if !value.is_finite() {
        return Err(Error::invalid(item, format_args!("{value:?}"), "give a finite number"));
    }
    if value < least || (strict && value == least) {
        let bound = if strict { "above" } else { "of at least" };
        return Err(Error::invalid(item, format_args!("{value:?}"), format!("give a number {bound} {least}")));
    }
    Ok(value)
}
