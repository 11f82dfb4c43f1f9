//! Tests the reader of sweep files: any bytes give an error of one line, or tables whose keys have a line in the text.

use crate::one_line;
use midair::Error;
use midair::files::{Format, Node, Source, placed, read_sweep};

/// Runs the test with these bytes as the text of a file.
pub fn check(bytes: &[u8]) {
    for format in [Format::Toml, Format::Json] {
        let Some(tables) = one_line(read_sweep(bytes, format, Source::default())) else { continue };
        let Node::Table(entries) = tables else { panic!("a sweep is a table") };
        for (key, _) in entries {
            let refusal = placed(bytes, format, Source::default(), &Error::invalid(key, "wrong", "give another"));
            let line = refusal.expect("a place").to_string();
            assert!(line.starts_with("scene file, line "), "{line}");
        }
    }
}
