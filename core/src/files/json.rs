//! JSON, read as a tree of values; and where a value of it is written.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::ops::ControlFlow;

use crate::files::node::Node;
use crate::files::step::{Place, Step};
use crate::files::syntax::Flaw;

/// Tables and lists within each other at most.
const DEPTH: usize = 128;

/// The value of a text.
pub(super) fn read(text: &str) -> Result<Node, Flaw> {
    let foreign = !text.trim_start().starts_with(['{', '[']);
    Reader::new(text)
        .document()
        .map_err(|flaw| flaw.or_foreign(foreign, "no JSON, but TOML as it looks: name it .toml"))
}

/// How deep some steps lead into a text that was read.
pub(super) fn find(text: &str, steps: &[Step<'_>]) -> Place {
    let mut reader = Reader::new(text);
    reader.pass_space();
    let mut place = Place { value: reader.at, key: reader.at, steps: 0 };
    for step in steps {
        if !matches!(reader.next(), Some(b'{' | b'[')) {
            break;
        }
        let (mut index, mut found) = (0, None);
        let looked = reader.each(&mut |reader, key, name| {
            let wanted = match (step, name) {
                (Step::Key(wanted), Some(name)) => *wanted == name,
                (Step::Index(wanted), None) => *wanted == index,
                _ => false,
            };
            index += 1;
            reader.pass_space();
            if wanted {
                found = Some((reader.at, key));
                return Ok(ControlFlow::Break(()));
            }
            reader.value().map(|_| ControlFlow::Continue(()))
        });
        let (Ok(()), Some((value, key))) = (looked, found) else { break };
        place = Place { value, key, steps: place.steps + 1 };
    }
    place
}

/// What is called with the place of each key or value of a table or list, and with the key: it reads the value.
type Visit<'v, 'a> = dyn FnMut(&mut Reader<'a>, usize, Option<String>) -> Result<ControlFlow<()>, Flaw> + 'v;

/// A text, and how far it is read.
struct Reader<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, at: 0, depth: 0 }
    }

    fn next(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or_default()
    }

    fn pass_space(&mut self) {
        self.at = self.text.len() - self.rest().trim_start_matches([' ', '\n', '\r', '\t']).len();
    }

    /// A fault of what comes next.
    fn flaw(&self, reason: &str) -> Flaw {
        let last = || self.text.char_indices().next_back().map_or(0, |(at, _)| at);
        let (at, reason) = match self.next() {
            Some(_) => (self.at, reason),
            None => (last(), "the text ends before its last bracket, brace or quote is closed"),
        };
        Flaw::new(at, format!("no JSON here ({reason})"))
    }

    fn document(&mut self) -> Result<Node, Flaw> {
        let node = self.value()?;
        self.pass_space();
        if self.next().is_some() {
            return Err(self.flaw("text after the end of the table"));
        }
        Ok(node)
    }

    fn value(&mut self) -> Result<Node, Flaw> {
        self.pass_space();
        for (word, node) in [("true", Node::Bool(true)), ("false", Node::Bool(false)), ("null", Node::Null)] {
            if self.rest().starts_with(word) {
                self.at += word.len();
                return Ok(node);
            }
        }
        match self.next() {
            Some(b'{') => self.table(),
            Some(b'[') => self.list(),
            Some(b'"') => Ok(Node::Text(self.string()?)),
            Some(b'-' | b'0'..=b'9') => self.number(),
            _ => Err(self.flaw(
                "a value is missing, or not a number, \"text\" in double quotes, true, false, [list] or {table}",
            )),
        }
    }

    fn table(&mut self) -> Result<Node, Flaw> {
        let mut entries: Vec<(String, Node)> = Vec::new();
        self.each(&mut |reader, key, name| {
            let name = name.unwrap_or_default();
            Flaw::check_key(key, &name, &entries)?;
            entries.push((name, reader.value()?));
            Ok(ControlFlow::Continue(()))
        })?;
        Ok(Node::Table(entries))
    }

    fn list(&mut self) -> Result<Node, Flaw> {
        let mut items = Vec::new();
        self.each(&mut |reader, _, _| {
            items.push(reader.value()?);
            Ok(ControlFlow::Continue(()))
        })?;
        Ok(Node::list(items))
    }

    /// Goes through the table or list that comes next.
    fn each(&mut self, visit: &mut Visit<'_, 'a>) -> Result<(), Flaw> {
        if self.depth == DEPTH {
            return Err(Flaw::nested(self.at));
        }
        self.depth += 1;
        let is_table = self.next() == Some(b'{');
        let close = if is_table { b'}' } else { b']' };
        self.at += 1;
        self.pass_space();
        let mut more = self.next() != Some(close);
        while more {
            let start = self.at;
            let key = if is_table { Some(self.key()?) } else { None };
            if visit(self, start, key)?.is_break() {
                return Ok(());
            }
            self.pass_space();
            more = match self.next() {
                Some(b',') => true,
                Some(other) if other == close => false,
                _ => return Err(self.flaw("a comma or a closing bracket is missing")),
            };
            if more {
                self.at += 1;
                self.pass_space();
                if self.next() == Some(close) {
                    return Err(self.flaw("a comma before a closing bracket"));
                }
            }
        }
        self.at += 1;
        self.depth -= 1;
        Ok(())
    }

    /// A key and its colon.
    fn key(&mut self) -> Result<String, Flaw> {
        if self.next() != Some(b'"') {
            return Err(self.flaw("a key without double quotes"));
        }
        let key = self.string()?;
        self.pass_space();
        if self.next() != Some(b':') {
            return Err(self.flaw("a colon is missing after a key"));
        }
        self.at += 1;
        Ok(key)
    }

    fn string(&mut self) -> Result<String, Flaw> {
        let mut string = String::new();
        self.at += 1;
        loop {
            let rest = self.rest();
            let plain = rest.find(|letter| matches!(letter, '"' | '\\' | '\0'..='\x1f')).unwrap_or(rest.len());
            string.push_str(&rest[..plain]);
            self.at += plain;
            match self.next() {
                Some(b'"') => break,
                Some(b'\\') => string.push(self.escaped()?),
                _ => return Err(self.flaw("a line break or tab within quotes")),
            }
        }
        self.at += 1;
        Ok(string)
    }

    /// The letter that a backslash and what follows it stand for.
    fn escaped(&mut self) -> Result<char, Flaw> {
        let mut letters = self.rest().chars().skip(1);
        let (letter, length) = match letters.next() {
            Some(letter @ ('"' | '\\' | '/')) => (Some(letter), 2),
            Some('b') => (Some('\x08'), 2),
            Some('f') => (Some('\x0c'), 2),
            Some('n') => (Some('\n'), 2),
            Some('r') => (Some('\r'), 2),
            Some('t') => (Some('\t'), 2),
            Some('u') => {
                // Beyond U+FFFF it is written as two halves.
                let (half, other) = (self.half(0), self.half(6));
                let pair = half.zip(other).and_then(|(half, other)| char::decode_utf16([half, other]).next()?.ok());
                let lone = half.and_then(|half| char::decode_utf16([half]).next()?.ok());
                (lone.or(pair), if lone.is_some() { 6 } else { 12 })
            }
            _ => (None, 2),
        };
        let letter = letter.ok_or_else(|| self.flaw("a backslash that escapes nothing"))?;
        self.at += length;
        Ok(letter)
    }

    /// The number in `\u12ab`, so many bytes on.
    fn half(&self, from: usize) -> Option<u16> {
        let digits = self.rest().get(from..from + 6)?.strip_prefix("\\u")?;
        let hexadecimal = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        hexadecimal.then(|| u16::from_str_radix(digits, 16).ok()).flatten()
    }

    fn number(&mut self) -> Result<Node, Flaw> {
        let rest = self.rest();
        let end = rest.find(|letter| !matches!(letter, '0'..='9' | '+' | '-' | '.' | 'e' | 'E'));
        let written = &rest[..end.unwrap_or(rest.len())];
        let node = number(written)
            .ok_or_else(|| self.flaw("a number that JSON does not know: a digit before and after the point"))?;
        self.at += written.len();
        Ok(node)
    }
}

/// A number as JSON writes it, whole where it has neither point nor exponent and 64 bits hold it.
fn number(written: &str) -> Option<Node> {
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|digit| digit.is_ascii_digit());
    let unsigned = written.strip_prefix('-').unwrap_or(written);
    let (mantissa, exponent) =
        unsigned.split_once(['e', 'E']).map_or((unsigned, None), |(mantissa, exponent)| (mantissa, Some(exponent)));
    let (whole, fraction) =
        mantissa.split_once('.').map_or((mantissa, None), |(whole, fraction)| (whole, Some(fraction)));
    let exponent = exponent.map(|exponent| exponent.strip_prefix(['+', '-']).unwrap_or(exponent));
    let good = digits(whole)
        && (whole == "0" || !whole.starts_with('0'))
        && fraction.is_none_or(digits)
        && exponent.is_none_or(digits);
    let real = || written.parse().ok().filter(|value: &f64| value.is_finite()).map(Node::Real);
    match (good, fraction.is_none() && exponent.is_none() && written != "-0") {
        (true, true) => match (written.parse(), written.parse()) {
            (Ok(value), _) => Some(Node::Integer(value)),
            (_, Ok(value)) => Some(Node::Large(value)),
            _ => real(),
        },
        (true, false) => real(),
        _ => None,
    }
}
