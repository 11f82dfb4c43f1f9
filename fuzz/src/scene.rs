//! The scene reader: any bytes are refused in one line or are a motion or a scene, which survives being written and read.

use crate::one_line;
use midair::files::{Drawing, Format, Provenance, Source, read, read_motion, write};
use midair::{Request, Scene};

/// Larger arrays are read, but not written in two formats: a few bytes of a grid make millions.
const MOST: usize = 4096;

/// The table without which a document is no motion.
const MOTION: &[u8] = b"motion";

/// Check what the bytes make.
pub fn check(bytes: &[u8]) {
    for format in [Format::Toml, Format::Json] {
        if let Some(scene) = one_line(read(bytes, format))
            && scene.array().len() <= MOST
        {
            survives(&scene);
        }
        if bytes.windows(MOTION.len()).any(|word| word == MOTION) {
            let mut start = |_: &str, _: &str| Ok(Drawing::Points(vec![[0.0, 0.0, 0.15]], Request::default()));
            one_line(read_motion(bytes, format, Source::default(), &mut start));
        }
    }
}

fn survives(scene: &Scene) {
    let provenance = Provenance { version: Some("1".into()), status: None };
    // TOML has no integers above 2^63 - 1.
    for format in [Format::Toml, Format::Json] {
        if let Some(text) = one_line(write(scene, format, &provenance)) {
            let again = read(text.as_bytes(), format);
            assert_eq!(again.as_ref(), Ok(scene), "{text}");
        } else {
            assert_eq!(format, Format::Toml, "JSON can hold every scene");
        }
    }
}
