//! The reader of a scene's file of positions: any bytes are refused in one line or are an array.

use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;

use crate::one_line;
use midair::files::{Format, Source, read_from};

const SCENE: &[u8] = b"[array]\npositions = { file = \"bowl.csv\" }\n[[points]]\nposition = [0.0, 0.0, 0.15]\n";

/// A folder of this process alone, in memory.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = PathBuf::from(format!("/dev/shm/midair-fuzz-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    folder
});

/// Check what the bytes make.
pub fn check(bytes: &[u8]) {
    fs::write(FOLDER.join("bowl.csv"), bytes).expect("a file");
    let source = Source { folder: Some(&FOLDER), ..Source::default() };
    if let Some(scene) = one_line(read_from(SCENE, Format::Toml, source)) {
        let rows = bytes.split(|&byte| byte == b'\n' || byte == b'\r').count();
        assert!(scene.array().len() <= rows, "{} transducers of {rows} rows", scene.array().len());
    }
}
