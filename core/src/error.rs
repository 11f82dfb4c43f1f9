//! Errors and warnings: each is one line that names the item, its value and the cure. Programs read its code and its parts.

use alloc::boxed::Box;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt::{self, Display};
use core::ops::{Deref, DerefMut};

/// Declares the codes, each with its text and its meaning.
macro_rules! codes {
    ($($name:ident $text:literal $meaning:literal)*) => {
        /// What an error or a warning is about. Its text never changes, and `docs/errors.md` lists it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum ErrorCode {
            $(#[doc = $meaning] $name,)*
        }

        impl ErrorCode {
            /// All codes, each with its text and its meaning.
            pub const ALL: &[(Self, &str, &str)] = &[$((Self::$name, $text, $meaning)),*];
        }
    };
}

codes! {
    Invalid "invalid" "A value that is not allowed, and that has no code of its own."
    Unknown "unknown" "A name that midair does not know."
    Type "type" "A value of another type, such as text instead of a number."
    Shape "shape" "A list, an array or a frame of another shape or length."
    NotFinite "not-finite" "A number that is NaN or infinite."
    OutOfRange "out-of-range" "A number that is too small or too large."
    Missing "missing" "A value or a package that is needed and not there."
    Conflict "conflict" "Two values that do not go together."
    Unreadable "unreadable" "A text or a file that cannot be read."
    Unwritable "unwritable" "A file that cannot be written."
    Memory "memory" "More memory than the limit, or than the machine has."
    Stopped "stopped" "The caller requested a stop before there was a result."
    Fault "fault" "An error of midair itself; please report it."
    TooNear "too-near" "A point too close to a transducer."
    Unreached "unreached" "A point with a pressure above 0 that no transducer reaches."
    Blocked "blocked" "A point inside an obstacle or behind a wall."
    Behind "behind" "A point behind every transducer."
    InPlane "in-plane" "A point in the plane of the transducers."
    TooFar "too-far" "A point or an obstacle far beyond the array."
    Contrary "contrary" "Two points that are too close together for their different pressures."
    Silent "silent" "A request whose pressures are all 0."
    CrossesArray "crosses-array" "An obstacle that contains or touches a transducer."
    SphereAmong "sphere-among" "A sphere beside other obstacles."
    SphereSize "sphere-size" "A sphere that is too large."
    Doubtful "doubtful" "A value that midair computes with, and that is probably a mistake."
    BeyondReach "beyond-reach" "A pressure that the array cannot make at its point."
    BeyondTogether "beyond-together" "Pressures that no drive makes at the same time."
    Missed "missed" "Pressures that the answer misses by more than 1 %."
    Weak "weak" "Pressures far below the level that the array can make."
    PhasesUnused "phases-unused" "Phases of pressures that the method ignores."
    Leak "leak" "Quiet points that are louder than the method's tolerance."
    Harmonic "harmonic" "A pressure at which the second harmonic counts."
    Scaled "scaled" "Drives weaker than the board can play: supply voltage or modulation must scale them."
    Fallen "fallen" "Traps whose beads fall."
    Still "still" "A limit of phase changes that is smaller than a step of the board's phases."
}

impl ErrorCode {
    /// The code as text: `too-near`.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    /// The code of a text; `None` for an unknown one.
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, text, _)| *text == name).map(|(code, ..)| *code)
    }
}

/// The parts of an error or a warning. Its text is `place: item verb value: hint cure; for example example`, without the
/// parts that are empty. The text of [`ErrorCode::Unknown`] is `place: unknown item "value": hint cure`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Notice {
    /// What it is about.
    pub code: ErrorCode,
    /// Where it was found: `bowl.toml, line 3, column 5`, `problems[2]`.
    pub place: String,
    /// The name of the value, as in a scene file: `points[3].pressure`.
    pub item: String,
    /// The verb between item and value, in most cases `is`.
    pub verb: String,
    /// The value.
    pub value: String,
    /// A guess at what was meant. It ends with a space.
    pub hint: String,
    /// How to correct it.
    pub cure: String,
    /// A correct line of a document.
    pub example: String,
    /// A second number or name in the text, such as the highest pressure that is possible, or the name that was meant.
    pub other: String,
    /// The number of the problem of a batch or of the frame of a sequence, else the first number in the item.
    pub index: Option<usize>,
}

/// A request that cannot be fulfilled, as a [`Notice`]. Its text is one line for users.
///
/// ```
/// use midair::{Array, ErrorCode};
///
/// let error = Array::grid(0, 3, 0.01).unwrap_err();
/// assert_eq!(error.to_string(), "array.grid.nx is 0: give at least 1 transducer");
/// assert_eq!((error.code, &*error.item, &*error.value), (ErrorCode::OutOfRange, "array.grid.nx", "0"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Error(Box<Notice>);

/// The result of a call that may be refused.
pub type Result<T, E = Error> = core::result::Result<T, E>;

impl Deref for Error {
    type Target = Notice;

    fn deref(&self) -> &Notice {
        &self.0
    }
}

impl DerefMut for Error {
    fn deref_mut(&mut self) -> &mut Notice {
        &mut self.0
    }
}

impl core::error::Error for Error {}

impl Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, item, verb, value, hint, cure, example, .. } = self;
        if !place.is_empty() {
            write!(f, "{place}: ")?;
        }
        match self.code {
            ErrorCode::Unknown => write!(f, "unknown {item} \"{value}\"")?,
            _ if item.is_empty() => f.write_str(value)?,
            _ => write!(f, "{item} {verb} {value}")?,
        }
        if !cure.is_empty() {
            write!(f, ": {hint}{cure}")?;
        }
        if example.is_empty() { Ok(()) } else { write!(f, "; for example {example}") }
    }
}

impl Notice {
    /// Returns `item is value: cure`.
    pub fn new(code: ErrorCode, item: impl Into<String>, value: impl Display, cure: impl Into<String>) -> Self {
        Self::of(code, &item.into(), &value.to_string(), cure.into())
    }

    fn of(code: ErrorCode, item: &str, value: &str, cure: String) -> Self {
        let (item, value) = (one_line(item), one_line(value));
        let [place, hint, example, other] = [const { String::new() }; 4];
        let index = first_index(&item);
        Self { code, place, item, verb: "is".into(), value, hint, cure, example, other, index }
    }

    /// Replaces the verb.
    #[must_use]
    pub fn verb(self, verb: &str) -> Self {
        Self { verb: verb.into(), ..self }
    }

    /// Sets the second number or name in the text.
    #[must_use]
    pub fn other(self, other: impl Display) -> Self {
        Self { other: other.to_string(), ..self }
    }
}

/// Returns the number in the first brackets of an item.
fn first_index(item: &str) -> Option<usize> {
    item.split_once('[')?.1.split([',', ']']).next()?.parse().ok()
}

/// Declares functions that return `item is value: cure` with a code.
macro_rules! errors {
    ($($name:ident $code:ident)*) => {
        impl Error {
            $(
                #[doc = concat!("Returns `item is value: cure`, with the code [`ErrorCode::", stringify!($code), "`].")]
                pub fn $name(item: impl Into<String>, value: impl Display, cure: impl Into<String>) -> Self {
                    Self::new(ErrorCode::$code, item, value, cure)
                }
            )*
        }
    };
}

errors! {
    invalid Invalid
    wrong_type Type
    shape Shape
    out_of_range OutOfRange
    missing Missing
    conflict Conflict
    unreadable Unreadable
}

impl Error {
    /// Returns an error of these parts.
    pub fn of(notice: Notice) -> Self {
        Self(notice.into())
    }

    /// Returns `item is value: cure` with a code.
    pub fn new(code: ErrorCode, item: impl Into<String>, value: impl Display, cure: impl Into<String>) -> Self {
        Self::of(Notice::new(code, item, value, cure))
    }

    /// The error for a number that is NaN or infinite; it has the usual cure.
    pub fn not_finite(item: impl Into<String>, value: impl Display) -> Self {
        Self::new(ErrorCode::NotFinite, item, value, "give finite numbers")
    }

    /// The error for a stop by the caller before there was a result.
    pub fn stopped() -> Self {
        Self::new(ErrorCode::Stopped, "", "stopped before there was an answer", "")
    }

    /// The error for a result that is not finite, because numbers exceeded the range of f32.
    pub(crate) fn lost() -> Self {
        let cure = "G and the pressures span too many orders of magnitude for this solver: \
                    leave out the points it hardly reaches (weight 0), or choose another";
        Self::new(ErrorCode::NotFinite, "drive", "not finite", cure)
    }

    /// The error for points beside a user's own propagation matrix G, which belongs to fixed points.
    pub(crate) fn given_points() -> Self {
        let cure = "a matrix of your own belongs to its points: leave them out";
        Self::new(ErrorCode::Conflict, "points", "given", cure)
    }

    /// Returns the error about an unknown name; it lists the known names.
    pub fn unknown<'a>(
        kind: impl Into<String>,
        name: impl Into<String>,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        Self::of_name(&kind.into(), &name.into(), &known.into_iter().collect::<Vec<_>>())
    }

    fn of_name(kind: &str, name: &str, known: &[&str]) -> Self {
        let cure = format!("known are {}", known.join(", "));
        let mut error = Self::of(Notice::of(ErrorCode::Unknown, kind, name, cure));
        if let Some(near) = nearest(name, known) {
            error.hint = format!("did you mean {near}? ");
            error.other = near.into();
        }
        error
    }

    /// Returns whether the caller requested a stop.
    pub fn is_stop(&self) -> bool {
        self.code == ErrorCode::Stopped
    }

    /// Returns the same error about another item.
    #[must_use]
    pub fn about(mut self, item: impl Into<String>) -> Self {
        self.item = item.into();
        self
    }

    /// Returns the same error, found in a place: a file, or a part of a request.
    #[must_use]
    pub fn inside(mut self, place: impl Into<String>) -> Self {
        let inner = core::mem::replace(&mut self.place, place.into());
        if !inner.is_empty() {
            self.place = format!("{}: {inner}", self.place);
        }
        self
    }

    /// Returns the same error of one of many: of `problems[3]` or `frames[3]`. A stop concerns all of them.
    #[must_use]
    pub fn of_one(self, many: &str, index: usize) -> Self {
        if self.is_stop() {
            return self;
        }
        let mut error = self.inside(format!("{many}[{index}]"));
        error.index = Some(index);
        error
    }
}

/// How many characters of the beginning and of the end are kept if a text is too long.
const KEPT: [usize; 2] = [240, 160];

/// Returns a text on one line, without its middle if it is very long, and without characters that reverse the order of a
/// line's letters.
pub(crate) fn one_line(text: &str) -> String {
    let turns = |c: char| matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let words = text.split(|c: char| c.is_whitespace() || c.is_control() || turns(c)).filter(|word| !word.is_empty());
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
pub(crate) fn find<'a, T>(kind: &str, name: &str, list: &'a [T], of: impl Fn(&T) -> &str) -> Result<&'a T> {
    let entry = list.iter().find(|entry| same_name(of(entry), name));
    entry.ok_or_else(|| Error::unknown(kind, name, list.iter().map(of)))
}

/// Checks that there are `count` entries, one for each of `owners`; `found` is their number.
pub(crate) fn one_each(item: &str, length: usize, entries: &str, count: usize, owners: &str) -> Result<()> {
    if length == count {
        return Ok(());
    }
    let cure = format!("give one for each of the {count} {owners}");
    Err(Error::new(ErrorCode::Shape, item, format!("{length} {entries}"), cure))
}

/// Returns a number of frames per second, if it is a plausible one: at 0.01, a frame is a rest of 100 s; at 1e7, a period of
/// ultrasound has 250 frames.
///
/// # Errors
/// A rate that is not finite, and one outside of 0.01 to 1e7.
pub fn frame_rate(rate: f64) -> Result<f64> {
    match real("rate", rate, 0.0, true)? {
        rate @ 0.01..=1e7 => Ok(rate),
        _ => {
            Err(Error::new(ErrorCode::OutOfRange, "rate", format_args!("{rate:?}"), "give 0.01 to 1e7 frames a second"))
        }
    }
}

/// Returns `value` if it is finite and at least `least` (above it if `strict`); else an error that names `item`.
pub(crate) fn real(item: &str, value: f64, least: f64, strict: bool) -> Result<f64> {
    if !value.is_finite() {
        return Err(Error::new(ErrorCode::NotFinite, item, format_args!("{value:?}"), "give a finite number"));
    }
    if value < least || (strict && value == least) {
        let cure = format!("give a number {} {least}", if strict { "above" } else { "of at least" });
        return Err(Error::new(ErrorCode::OutOfRange, item, format_args!("{value:?}"), cure));
    }
    Ok(value)
}
