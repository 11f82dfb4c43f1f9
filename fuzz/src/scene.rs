//! Tests the scene reader: any bytes give an error of one line, or a motion, or a scene that can be written and read again.

use crate::one_line;
use midair::Scene;
use midair::files::{Drawing, Format, Provenance, Source, read, read_motion, write};

/// Larger arrays are read but not written: a few bytes can describe a grid of millions of transducers.
const MOST: usize = 4096;

/// Only documents with this word can be a motion.
const MOTION: &[u8] = b"motion";

/// Runs the test with these bytes as the text of a file.
pub fn check(bytes: &[u8]) {
    for format in [Format::Toml, Format::Json] {
        if let Some(scene) = one_line(read(bytes, format))
            && scene.array().len() <= MOST
        {
            survives(&scene);
        }
        if bytes.windows(MOTION.len()).any(|word| word == MOTION) {
            let mut draw = |_: &str, _: &str| Ok(Drawing::Outline(vec![[0.0, 0.0, 0.15], [0.1, 0.0, 0.15]], true));
            one_line(read_motion(bytes, format, Source::default(), &mut draw));
        }
    }
}

fn survives(scene: &Scene) {
    let provenance = Provenance { version: Some("1".into()), status: None };
    // TOML cannot write integers above 2^63 - 1.
    for format in [Format::Toml, Format::Json] {
        if let Some(text) = one_line(write(scene, format, &provenance)) {
            let again = read(text.as_bytes(), format);
            assert_eq!(again.as_ref(), Ok(scene), "{text}");
        } else {
            assert_eq!(format, Format::Toml, "JSON can hold every scene");
        }
    }
}
