//! Text that is no TOML or no JSON: what the parsers say of it, in the words of somebody who writes a scene file.

use alloc::format;
use alloc::string::{String, ToString};

use crate::error::{Error, one_line};
use crate::files::node::{TOO_MANY, TWICE};
use crate::files::schema;
use crate::files::source::{Format, Source};

/// The parsers stop at some such depth.
const NESTED: &str = "nested too deep: a scene file needs four levels of brackets at most";

/// A fault of TOML.
pub(super) fn toml(error: &toml::de::Error, text: &str, source: Source<'_>) -> Error {
    let span = error.span();
    let offset = span.as_ref().map(|span| span.start);
    let written = span.and_then(|span| text.get(span)).map(one_line).unwrap_or_default();
    let reason = match error.message() {
        message if message.starts_with("duplicate key") => twice(&written),
        message if message.contains("recurs") => NESTED.into(),
        message if message.contains(TOO_MANY) => too_many(),
        message if message.contains("overflow") => "a number too large for any computer: give fewer digits".into(),
        _ if text.starts_with('{') => "no TOML, but JSON as it looks: name it .json".into(),
        message => {
            let what = message.split(", expected").next().unwrap_or(message).replace("unexpected", "stray");
            format!("no TOML here ({what})")
        }
    };
    let line_of = |offset: usize| {
        let start = text.get(..offset)?.rfind('\n').map_or(0, |end| end + 1);
        text.get(start..)?.lines().next()
    };
    // A line of TOML begins with its key.
    let line = offset.and_then(line_of).unwrap_or_default().trim_start_matches(['[', ' ', '\t']);
    let key = line.split(|letter: char| !(letter.is_alphanumeric() || letter == '_')).next();
    let example = key.and_then(|key| schema::example_of_key(key, Format::Toml));
    told(source, offset.map(|offset| (text, offset)), &reason, example, Format::Toml)
}

/// A fault of JSON.
pub(super) fn json(error: &serde_json::Error, text: &str, source: Source<'_>) -> Error {
    let message = error.to_string();
    let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message);
    let before: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
    // A column counts bytes and may be one past the end.
    let mut offset = (before + error.column().saturating_sub(1)).min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    let reason = match message {
        message if message.starts_with(TWICE) => twice(&message[TWICE.len()..]),
        message if message.contains(TOO_MANY) => too_many(),
        message if message.contains("recursion") => NESTED.into(),
        _ if !text.trim_start().starts_with(['{', '[']) => "no JSON, but TOML as it looks: name it .toml".into(),
        message => format!("no JSON here ({})", fault_of_json(message)),
    };
    let words = text[..offset].rsplit('"').take(64);
    let example = words.into_iter().find_map(|word| schema::example_of_key(word, Format::Json));
    told(source, Some((text, offset)), &reason, example, Format::Json)
}

fn fault_of_json(message: &str) -> &'static str {
    match message {
        _ if message.starts_with("EOF") => "the text ends before its last bracket, brace or quote is closed",
        _ if message.starts_with("trailing comma") => "a comma before a closing bracket",
        _ if message.starts_with("trailing") => "text after the end of the table",
        _ if message.starts_with("key must be") => "a key without double quotes",
        _ if message.contains("`:`") => "a colon is missing after a key",
        _ if message.contains("`,`") => "a comma or a closing bracket is missing",
        _ if message.contains("number") => "a number that JSON does not know: a digit before and after the point",
        _ if message.contains("control") => "a line break or tab within quotes",
        _ if message.contains("escape") || message.contains("surrogate") => "a backslash that escapes nothing",
        _ => "a value is missing, or not a number, \"text\" in double quotes, true, false, [list] or {table}",
    }
}

fn twice(key: &str) -> String {
    format!("the key \"{key}\" is written twice: keep one of them")
}

fn too_many() -> String {
    "a table has more keys than a scene file knows: remove what is none of its keys".into()
}

/// The fault with a line as it would be correct, of the key where the text goes wrong, where it is known.
fn told(source: Source<'_>, at: Option<(&str, usize)>, reason: &str, example: Option<String>, format: Format) -> Error {
    let example = example.or_else(|| schema::example("array", format)).unwrap_or_default();
    source.fault(at, &format!("{reason}; for example {example}"))
}
