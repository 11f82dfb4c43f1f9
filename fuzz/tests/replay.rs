//! Runs the stored inputs of all targets, first inputs and past crashes, so that repaired errors stay repaired.

use std::fs;
use std::path::{Path, PathBuf};

use midair_fuzz::TARGETS;

/// Returns the files of a folder, none if it does not exist.
fn inputs(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut files: Vec<PathBuf> =
        entries.map(|entry| entry.expect("an entry").path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

#[test]
fn seeds_and_past_crashes_pass() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (name, check) in TARGETS {
        let mut files = inputs(&root.join("corpus").join(name));
        if let "scene" | "sweep" = name {
            files.extend(inputs(&root.join(format!("../docs/{name}s"))));
        }
        check(b"");
        for file in files {
            println!("{name}: {}", file.display());
            check(&fs::read(file).expect("a file"));
        }
    }
}
