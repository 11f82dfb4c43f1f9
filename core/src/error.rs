//! Errors: each is one line that names the item, its value and the cure.

use alloc::boxed::Box;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt::Display;

/// A request that cannot be fulfilled. Its text is one line for users.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An invalid value.
    #[error("{item} is {value}: {cure}")]
    Invalid {
        /// The name of the value, as in a scene file: `points[3].pressure`.
        item: String,
        /// The value itself.
        value: String,
        /// How to correct it.
        cure: String,
    },
    /// An unknown name.
    #[error("unknown {kind} \"{name}\": {hint}known are {known}")]
    Unknown {
        /// The kind of the name: `solver`, `preset`, `option of greedy`.
        kind: String,
        /// The unknown name.
        name: String,
        /// A suggestion that ends in a space, or an empty text if no known name is similar.
        hint: String,
        /// The known names, separated by commas.
        known: String,
    },
    /// A point closer to a transducer than a hundredth of the wavelength, where a pressure proportional to 1/r has no meaning.
    #[error(
        "points[{point}] is {distance:.3e} m from transducer {transducer}: move it at least {least:.3e} m (a hundredth of the wavelength) away"
    )]
    TooNear {
        /// Index of the point.
        point: usize,
        /// Index of the transducer.
        transducer: usize,
        /// The distance from the point to the transducer in metres.
        distance: f64,
        /// The smallest distance allowed, in metres.
        least: f64,
    },
    /// A point with a pressure above 0 at which no transducer has any effect.
    #[error("points[{point}] is reached by no transducer: {cure}")]
    Unreached {
        /// Index of the point.
        point: usize,
        /// How to correct it.
        cure: &'static str,
    },
    /// A problem of a batch that cannot be solved.
    #[error("problems[{index}]: {error}")]
    InBatch {
        /// Index of the problem.
        index: usize,
        /// The error of this problem.
        error: Box<Error>,
    },
    /// A frame of a sequence that cannot be solved.
    #[error("frames[{index}]: {error}")]
    InFrame {
        /// Index of the frame.
        index: usize,
        /// The error of this frame.
        error: Box<Error>,
    },
    /// More memory than the limit, or than the machine has.
    #[error(
        "{what} of N = {transducers} transducers and M = {points} points needs {:.3} GB, the limit is {:.3} GB: give fewer points or transducers, a method without it, or a higher limit",
        *bytes as f64 * 1e-9,
        *limit as f64 * 1e-9
    )]
    Memory {
        /// What the memory is for.
        what: String,
        /// The number of transducers N.
        transducers: usize,
        /// The number of points M.
        points: usize,
        /// The bytes that are needed.
        bytes: u64,
        /// The limit in bytes.
        limit: u64,
    },
    /// The caller requested a stop before there was a result.
    #[error("stopped before there was an answer")]
    Stopped,
    /// A scene file, or a file that it names, that cannot be read.
    #[error("{place}: {reason}")]
    File {
        /// The name of the file, with line and column if they are known.
        place: String,
        /// The error there and how to correct it.
        reason: String,
    },
}

impl Error {
    /// Returns an [`Error::Invalid`].
    pub fn invalid(item: impl Into<String>, value: impl Display, cure: impl Into<String>) -> Self {
        Self::of_value(&item.into(), &value, cure.into())
    }

    fn of_value(item: &str, value: &dyn Display, cure: String) -> Self {
        Self::Invalid { item: one_line(item), value: one_line(&value.to_string()), cure }
    }

    /// The error for a result that is not finite, because numbers exceeded the range of f32.
    pub(crate) fn lost() -> Self {
        let cure = "G and the pressures span too many orders of magnitude for this solver: \
                    leave out the points it hardly reaches (weight 0), or choose another";
        Self::invalid("drive", "not finite", cure)
    }

    /// The error for points beside a user's own propagation matrix G, which belongs to fixed points.
    pub(crate) fn given_points() -> Self {
        Self::invalid("points", "given", "a matrix of your own belongs to its points: leave them out")
    }

    /// Returns an [`Error::Unknown`] that lists the known names.
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

/// How many characters of the beginning and of the end are kept if a text is too long.
const KEPT: [usize; 2] = [240, 160];

/// Returns a text on one line, without its middle if it is very long.
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

/// The letters of a name that are compared, in lower case; "-" and "_" are ignored.
fn letters(name: &str) -> impl Iterator<Item = char> {
    name.chars().filter(|letter| !matches!(letter, '-' | '_')).map(|letter| letter.to_ascii_lowercase())
}

/// Whether two names are the same except for case, "-" and "_".
#[must_use]
pub fn same_name(a: &str, b: &str) -> bool {
    letters(a).eq(letters(b))
}

/// Names in other packages, each with the name that midair has for it.
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

/// Returns the known name that a mistyped name probably means. Either at most a third of the letters are different, or the
/// known name begins with the typed one, or other packages use the typed name.
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

/// The number of letters to insert, remove, replace or swap with their neighbour (optimal string alignment distance).
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

/// Returns the entry with this name from a list; case, "-" and "_" do not matter.
pub(crate) fn find<'a, T>(kind: &str, name: &str, list: &'a [T], of: impl Fn(&T) -> &str) -> Result<&'a T, Error> {
    let found = list.iter().find(|entry| same_name(of(entry), name));
    found.ok_or_else(|| Error::unknown(kind, name, list.iter().map(of)))
}

/// Checks that there are `count` entries, one for each of `owners`; `found` is their number.
pub(crate) fn one_each(item: &str, found: usize, entries: &str, count: usize, owners: &str) -> Result<(), Error> {
    if found == count {
        return Ok(());
    }
    Err(Error::invalid(item, format!("{found} {entries}"), format!("give one for each of the {count} {owners}")))
}

/// Returns `value` if it is finite and at least `least` (above it if `strict`); else an error that names `item`.
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
